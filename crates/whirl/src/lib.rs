//! Whirl, a terminal workbench for stabilising rotors with magnetic bearings: this page leads to the crate that you want.
//!
//! | you want | crate | to begin with |
//! |---|---|---|
//! | a rotor, built in or from a file; its poles under ideal feedback; exact whirl with deadband | [`rotor`] | [`rotor::builtin`], [`rotor::file`], [`rotor::Modes`], [`rotor::circular`] |
//! | a rotor drawn in sections, discs and bearings: its elements, eigenvalues and reduction | `beam` | `beam::Drawing`, `beam::read`, `beam::import_ross` |
//! | feedback: gains over speed, filters, sensors, sampling, delay, actuator | [`control`] | [`control::Feedback`], [`control::Controller`] |
//! | rotor and loop as one: stepped, or as poles, margins and responses | [`machine`] | [`machine::Machine`], [`machine::MachinePoles`]; `crates/machine/examples/poles.rs` |
//! | all roots of a loop with a delay, for any matrices | [`linear`] | [`linear::DelaySystem`] |
//! | gains | [`tuner`] | [`tuner::tune()`]; `crates/tuner/examples/search.rs` |
//! | how sure that is: slopes by every parameter, worst cases, samples | `variation` | `variation::Model`, `variation::sensitivities` |
//! | runs, forces over speed, run-ups, maps, the NASA report | [`study`] | [`study::run`] |
//! | to read a running bench, or to change it | [`wire`] | [`wire::SharedMemory`], [`wire::Carrier`]; `crates/wire/examples/watch.rs` |
//! | to run one | [`sim`] | [`sim::run()`] |
//! | to judge what it sends | [`alarms`] | [`alarms::Alarms`] |
//! | charts, as SVG and PNG | `plot` | `plot::Chart` |
//! | units of an SI rotor | `units` | `units::Units` |
//! | the full spectrum of an orbit | `spectrum` | `spectrum::welch` |
//! | to read a recording | [`tape`], with its cargo feature `rerun` | [`tape::Recording`]; `crates/tape/examples/read_back.rs` |
//! | what a console knows and asks, for a screen of your own | [`telemetry`] | `telemetry::feed` |
//! | the console | [`dashboard`] | |
//! | to read TOML files and tell every fault at its place | [`text`] | [`text::Reader`] |
//! | the book's pages, as text | `manual` | `manual::page` |
//! | to write files whole or not at all | [`files`] | [`files::Draft`] |
//!
//! Quantities are dimensionless unless a name says otherwise: displacements in `e_t`, time `tau = w0 t`, speed `R = w / w0`,
//! forces in `m_b w0^2 e_t`; [`rotor::Scales`] has an SI rotor's units. Errors are types of their own, one an operation. Every crate's
//! front page has an example that runs.
//!
//! ```
//! // The command line as data, for man pages and the like.
//! assert!(whirl::command().find_subcommand("poles").is_some());
//! ```
//!
//! This crate itself is the command line, and no library: one file a command, each a few lines of glue over the others. Inside of it,
//!
//! * [`cli`] is the whole of it as clap sees it; `--help` is made from its doc comments.
//! * [`catalog`] turns the names and files that a person types into rotors and feedback.
//! * [`units`] is what their numbers are typed and shown in: dimensionless, or SI for a rotor that has scales.
//! * [`attach`] finds a running bench; [`asking`] asks it for settings, anew while others change them. [`child_process`] starts the processes behind a dashboard,
//!   [`recordings`] the one that records it.
//! * [`layouts`] are the screens of the dashboard, built in and a person's own; [`folders`] is where those are.
//! * [`place`] is where a result goes that is a file.
//! * [`output`] prints one result as a table, as CSV or as JSON.
//! * [`failure`] is every way to fail, with its exit code. [`interrupt`] is what ctrl-c does to a computation.
//! * [`range`] reads ranges as typed, `A..B`; [`varied`] parameters over a range, `KEY=A..B` or `KEY=P%`.

mod asking;
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
mod quantity;
mod range;
mod recordings;
mod units;
mod varied;

use std::process::ExitCode;

pub use failure::{ENVIRONMENT, EXIT_CODES};

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
