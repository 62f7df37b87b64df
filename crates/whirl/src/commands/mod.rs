//! One file a command: its options, and the glue that carries it out.

pub(crate) mod clean;
pub(crate) mod poles;
pub(crate) mod set;
pub(crate) mod sim;
pub(crate) mod status;
pub(crate) mod tail;

use crate::cli::{Cli, Command};
use crate::failure::Failure;

/// Carries out a command line.
///
/// # Errors
/// Whatever the command fails with.
pub(crate) fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => Err(Failure::Work("not there yet".into())),
        Some(Command::Sim(args)) => sim::run(&args),
        Some(Command::Tail(args)) => tail::run(&args),
        Some(Command::Set(args)) => set::run(&args),
        Some(Command::Status(args)) => status::run(&args),
        Some(Command::Clean(args)) => clean::run(&args),
        Some(Command::Poles(args)) => poles::run(&args),
    }
}
