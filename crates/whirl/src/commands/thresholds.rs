//! `whirl thresholds`: every speed at which a mode gains or loses stability. What counts as one is said at
//! [`rotor::thresholds`].

use rotor::{Stability, Whirl};
use serde::Serialize;
use units::Dimension;

use super::linear;
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{BelowArgs, MachineArgs, counted};
use crate::output::{Cell, Format, Table};
use crate::quantity::{self, QuantityRange};
use crate::units::UnitsDocument;

/// Options of `whirl thresholds`.
#[derive(Debug, clap::Args)]
pub(crate) struct ThresholdsArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speeds R to search, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: QuantityRange,
    #[command(flatten)]
    below: BelowArgs,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    thresholds: Vec<ThresholdDocument>,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct ThresholdDocument {
    speed: f64,
    frequency: f64,
    whirl: Whirl,
    becomes: Stability,
    /// Whether its damping counts; only where not all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<bool>,
}

/// Prints the thresholds.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &ThresholdsArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    let (machine, over) = Machine::open_over(&args.machine, args.over)?;
    linear::neglects(&args.machine);
    let (rotor, units) = (&machine.rotor, machine.units());
    let settings = &machine.settings;
    let found = if rotor::ClosedLoop::describes(rotor, &settings.feedback) {
        rotor::thresholds(rotor, &settings.feedback, over.from, over.to)?
    } else {
        machine::thresholds(rotor, settings, over.from, over.to)?
    };
    let modes = args.below.modes(rotor, settings, over.to)?;
    // On the axis a pole is as large as it turns fast.
    let counts = |t: &rotor::Threshold| modes.below().map(|below| t.frequency <= below);
    let columns = units.pick(
        ["speed", "frequency", "whirl ratio", "whirl", "becomes"],
        ["speed (rpm)", "frequency (Hz)", "whirl ratio", "whirl", "becomes"],
    );
    let some_count = modes.below().is_some();
    let mut table = Table::new(&[&columns[..], if some_count { &["counts"] } else { &[] }].concat());
    for t in &found {
        // At rest there is no spin to compare with.
        let ratio = if t.speed == 0.0 { Cell::from(&"none") } else { (t.frequency / t.speed).into() };
        let numbers = [units.speed(t.speed), units.frequency(t.frequency)].map(Cell::from);
        let cells = numbers.into_iter().chain([ratio, Cell::from(&t.whirl), Cell::from(&t.becomes)]);
        table.row(cells.chain(counts(t).map(|counts| Cell::from(&if counts { "yes" } else { "too fast" }))));
    }
    let document = Document {
        rotor: rotor.name(),
        thresholds: found
            .iter()
            .map(|t| ThresholdDocument {
                speed: t.speed,
                frequency: t.frequency,
                whirl: t.whirl,
                becomes: t.becomes,
                counts: counts(t),
            })
            .collect(),
        below: modes.below(),
        units: units.document(),
    };
    let per = units.pick("; frequency per unit of tau = w0 t", "");
    let none = if found.is_empty() { "no mode changes stability".to_owned() } else { String::new() };
    // Of a mode that is too fast its very frequency says more of the model than of the rotor.
    let too_fast = found.iter().any(|t| counts(t) == Some(false));
    let footer = if too_fast { counted(&modes, units).unwrap_or_default() } else { none };
    args.format.print(
        &document,
        &format!("{} for {}, deadband neglected{per}", rotor.name(), units.range_text(args.over)),
        &table,
        &machine.with_taken(&footer),
    )
}
