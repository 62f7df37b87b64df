//! `whirl thresholds`: every speed at which a mode gains or loses stability.

use rotor::{Stability, Whirl};
use serde::Serialize;

use super::linear::swept;
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table};
use crate::range::Range;

/// Options of `whirl thresholds`.
#[derive(Debug, clap::Args)]
pub(crate) struct ThresholdsArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speeds R to search, both ends included
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    over: Range,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    thresholds: Vec<ThresholdDocument>,
}

#[derive(Debug, Serialize)]
struct ThresholdDocument {
    speed: f64,
    frequency: f64,
    whirl: Whirl,
    becomes: Stability,
}

/// Prints the thresholds.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &ThresholdsArgs) -> Result<(), Failure> {
    let (rotor, feedback) = swept(&args.machine, args.over)?;
    let found = rotor::thresholds(&rotor, &feedback, args.over.from, args.over.to)?;
    let mut table = Table::new(&["speed", "frequency", "whirl ratio", "whirl", "becomes"]);
    for t in &found {
        let ratio = t.frequency / t.speed;
        table.row([t.speed.into(), t.frequency.into(), ratio.into(), Cell::from(&t.whirl), Cell::from(&t.becomes)]);
    }
    let document = Document {
        rotor: rotor.name(),
        thresholds: found
            .iter()
            .map(|t| ThresholdDocument { speed: t.speed, frequency: t.frequency, whirl: t.whirl, becomes: t.becomes })
            .collect(),
    };
    let none = if found.is_empty() { "no mode changes stability" } else { "" };
    args.format.print(
        &document,
        &format!("{} for R in {}, deadband neglected; frequency per unit of tau = w0 t", rotor.name(), args.over),
        &table,
        none,
    )
}
