//! `whirl poles`: eigenvalues and minimum damping at one speed.

use rotor::{Mode, Spectrum};
use serde::Serialize;

use super::linear::{self, Part, PoleDocument, StandingDocument, word};
use crate::catalog;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Format, Table, rounded};
use crate::units::UnitsDocument;

/// Options of `whirl poles`.
#[derive(Debug, clap::Args)]
pub(crate) struct PolesArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speed R = w / w0 (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    speed: f64,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    #[serde(flatten)]
    standing: StandingDocument,
    min_damping: f64,
    modes: Vec<ModeDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// One mode, as scripts read it.
#[derive(Debug, Serialize)]
struct ModeDocument {
    #[serde(flatten)]
    pole: PoleDocument,
    shape: Vec<Part>,
}

impl From<&Mode> for ModeDocument {
    fn from(mode: &Mode) -> Self {
        Self { pole: mode.into(), shape: mode.shape.iter().map(|&c| c.into()).collect() }
    }
}

/// Prints the poles.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &PolesArgs) -> Result<(), Failure> {
    let machine = catalog::Machine::open(&args.machine, Some(args.speed), catalog::Default::Analysis)?;
    linear::neglects(&args.machine);
    let (rotor, units) = (&machine.rotor, machine.units());
    let spectrum = Spectrum::of(&machine.settings.closed_loop(rotor))?;

    let mut table = Table::new(units.pick(
        &["re", "im", "damping", "log dec", "frequency", "whirl", "stands"],
        &["re (1/s)", "im (rad/s)", "damping", "log dec", "frequency (Hz)", "whirl", "stands"],
    ));
    for mode in &spectrum.modes {
        let pole = [mode.pole.re, mode.pole.im].map(|part| units.rate(part));
        let numbers = [pole[0], pole[1], mode.damping(), mode.log_decrement(), units.frequency(mode.frequency())];
        table.row(numbers.map(Cell::from).into_iter().chain([Cell::from(&mode.whirl()), Cell::from(&mode.standing())]));
    }
    let speed = machine.settings.speed;
    let document = Document {
        rotor: rotor.name(),
        speed,
        standing: spectrum.standing().into(),
        min_damping: spectrum.min_damping(),
        modes: spectrum.modes.iter().map(ModeDocument::from).collect(),
        units: units.document(),
    };
    let per = units.pick("; per unit of tau = w0 t", "");
    args.format.print(
        &document,
        &format!("{} at {}, deadband neglected{per}", rotor.name(), units.speed_text(speed)),
        &table,
        &format!("{}, minimum damping {}", word(spectrum.standing()), rounded(spectrum.min_damping())),
    )
}
