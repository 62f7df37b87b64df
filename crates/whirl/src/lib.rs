//! The command line of Whirl: one file a command, each a few lines of glue over the other crates.
//!
//! * [`cli`] is the whole of it as clap sees it; `--help` is made from its doc comments.
//! * [`catalog`] turns the names and files that a person types into rotors and feedback.
//! * [`units`] is what their numbers are typed and shown in: dimensionless, or SI for a rotor that has scales.
//! * [`attach`] finds a running bench. [`child_process`] starts the processes behind a dashboard,
//!   [`recordings`] the one that records it.
//! * [`layouts`] are the screens of the dashboard, built in and a person's own; [`folders`] is where those are.
//! * [`amount`] reads durations and sizes as typed.
//! * [`place`] is where a result goes that is a file.
//! * [`output`] prints one result as a table, as CSV or as JSON.
//! * [`failure`] is every way to fail, with its exit code. [`interrupt`] is what ctrl-c does to a computation.
//! * [`range`] reads ranges as typed, `A..B`.

mod amount;
mod attach;
mod catalog;
mod child_process;
mod cli;
mod commands;
mod dispatch;
mod failure;
mod folders;
mod interrupt;
mod layouts;
mod logging;
mod machine_args;
mod output;
mod picture;
mod place;
mod range;
mod recordings;
mod units;

use std::process::ExitCode;

use clap::Parser;

/// Runs the command line that this process was started with, and says how it ended.
#[must_use]
pub fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    match dispatch::run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// The command line as data, for man pages, completions and the tests that keep the documents true.
#[must_use]
pub fn command() -> clap::Command {
    <cli::Cli as clap::CommandFactory>::command()
}
