//! `whirl poles`: eigenvalues and minimum damping at one speed.

use rotor::{Mode, Spectrum};
use serde::Serialize;

use super::linear::{Part, PoleDocument};
use crate::catalog;
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, rounded};

/// Options of `whirl poles`.
#[derive(Debug, clap::Args)]
pub(crate) struct PolesArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speed R = w / w0
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
    stable: bool,
    min_damping: f64,
    modes: Vec<ModeDocument>,
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
    let (rotor, settings) = catalog::machine(&args.machine, args.speed, catalog::Default::Analysis)?;
    let spectrum = Spectrum::of(&settings.closed_loop(&rotor))?;

    let mut table = Table::new(&["re", "im", "damping", "log dec", "frequency", "whirl"]);
    for mode in &spectrum.modes {
        let numbers = [mode.pole.re, mode.pole.im, mode.damping(), mode.log_decrement(), mode.frequency()];
        table.row(numbers.map(Cell::from).into_iter().chain([Cell::from(&mode.whirl())]));
    }
    let document = Document {
        rotor: rotor.name(),
        speed: settings.speed,
        stable: spectrum.is_stable(),
        min_damping: spectrum.min_damping(),
        modes: spectrum.modes.iter().map(ModeDocument::from).collect(),
    };
    let word = if spectrum.is_stable() { "stable" } else { "UNSTABLE" };
    args.format.print(
        &document,
        &format!("{} at R = {}, deadband neglected; per unit of tau = w0 t", rotor.name(), settings.speed),
        &table,
        &format!("{word}, minimum damping {}", rounded(spectrum.min_damping())),
    )
}
