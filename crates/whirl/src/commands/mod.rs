//! One file a command: its options, and the glue that carries it out.

pub(crate) mod assign;
mod linear;
pub(crate) mod modes;
pub(crate) mod poles;
pub(crate) mod thresholds;
pub(crate) mod trace;

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
        Some(Command::Trace(args)) => trace::run(&args),
        Some(Command::Thresholds(args)) => thresholds::run(&args),
        Some(Command::Modes(args)) => modes::run(&args),
        Some(Command::Assign(args)) => assign::run(&args),
    }
}
