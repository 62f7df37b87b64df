//! One file a command: its options, and the glue that carries it out.

pub(crate) mod cycles;
pub(crate) mod force;
pub(crate) mod poles;
pub(crate) mod response;
pub(crate) mod run;

use crate::cli::{Cli, Command};
use crate::failure::Failure;

/// Carries out a command line.
///
/// # Errors
/// Whatever the command fails with.
pub(crate) fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => Err(Failure::Work("not there yet".into())),
        Some(Command::Poles(args)) => poles::run(&args),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Force(args)) => force::run(&args),
        Some(Command::Response(args)) => response::run(&args),
        Some(Command::Cycles(args)) => cycles::run(&args),
    }
}
