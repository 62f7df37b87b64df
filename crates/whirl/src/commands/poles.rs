//! `whirl poles`: eigenvalues and minimum damping at one speed.

use machine::MachinePoles;
use rotor::{C64, Mode};
use serde::Serialize;
use units::Dimension;

use super::linear::{self, ComplexDocument, PoleDocument, StabilityDocument, word};
use crate::catalog;
use crate::commands::sim::LiveArgs;
use crate::failure::Failure;
use crate::machine_args::{BelowArgs, MachineArgs, Whole, counted};
use crate::output::{Cell, Format, Table, rounded};
use crate::quantity::{self, TypedQuantity};
use crate::units::UnitsDocument;

/// Options of `whirl poles`.
#[derive(Debug, clap::Args)]
pub(crate) struct PolesArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    whole: Whole,
    /// Spin speed R = w / w0 (SI rotors: in rpm) [default: that of `up`, R = 2.5]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    #[command(flatten)]
    below: BelowArgs,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    #[serde(flatten)]
    stability: StabilityDocument,
    min_damping: f64,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    /// Where there are infinitely many: all with a greater real part are listed.
    #[serde(skip_serializing_if = "Option::is_none")]
    count_right_of: Option<f64>,
    modes: Vec<ModeDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// One mode, as scripts read it.
#[derive(Debug, Serialize)]
struct ModeDocument {
    #[serde(flatten)]
    pole: PoleDocument,
    /// Of a sampled loop, what a sample multiplies the mode by.
    #[serde(skip_serializing_if = "Option::is_none")]
    z: Option<ComplexDocument>,
    shape: Vec<ComplexDocument>,
}

impl ModeDocument {
    fn of(mode: &Mode, z: Option<C64>) -> Self {
        Self {
            pole: mode.into(),
            z: z.map(ComplexDocument::from),
            shape: mode.shape.iter().map(|&c| c.into()).collect(),
        }
    }
}

/// Prints the poles.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &PolesArgs) -> Result<(), Failure> {
    let machine = catalog::Machine::open(&args.machine, args.speed, catalog::Default::Analysis)?;
    let mut machine = machine.whole(args.whole)?;
    let takes_speed_of_up = args.speed.is_none() && !args.machine.sets("speed");
    if takes_speed_of_up {
        machine.settings.speed = LiveArgs::SPEED;
        machine.settings.check(&machine.rotor)?;
    }
    linear::neglects(&args.machine);
    let (rotor, units) = (&machine.rotor, machine.units());
    let poles = MachinePoles::of(rotor, &machine.settings)?;
    let (z, right_of) = (poles.z.clone(), poles.right_of);
    let linear = poles.into_modes();
    let known = linear.modes.iter().map(|mode| mode.pole);
    let modes = args.below.among(rotor, known, machine.settings.speed)?;
    let min_damping = modes.min_damping(linear.modes.iter().map(|mode| mode.pole));
    if linear.modes.is_empty() {
        let line = rounded(units.rate(right_of.unwrap_or(f64::NEG_INFINITY)));
        return Err(Failure::Work(format!("no pole has a real part greater than {line}: every motion dies at once")));
    }

    let mut table = Table::new(units.pick(
        &["re", "im", "damping", "log dec", "frequency", "whirl", "stands"],
        &["re (1/s)", "im (rad/s)", "damping", "log dec", "frequency (Hz)", "whirl", "stands"],
    ));
    for mode in &linear.modes {
        let pole = [mode.pole.re, mode.pole.im].map(|part| units.rate(part));
        let numbers = [pole[0], pole[1], mode.damping(), mode.log_decrement(), units.frequency(mode.frequency())];
        table
            .row(numbers.map(Cell::from).into_iter().chain([Cell::from(&mode.whirl()), Cell::from(&mode.stability())]));
    }
    let speed = machine.settings.speed;
    let document = Document {
        rotor: rotor.name(),
        speed,
        stability: linear.stability().into(),
        min_damping,
        below: modes.below(),
        count_right_of: right_of,
        modes: (linear.modes.iter().enumerate())
            .map(|(k, mode)| ModeDocument::of(mode, z.as_ref().map(|z| z[k])))
            .collect(),
        units: units.document(),
    };
    let mut taken = Vec::new();
    if takes_speed_of_up {
        taken.push(format!("the speed of `up`, {} (--speed)", units.speed_text(speed)));
    }
    taken.extend(machine.taken());
    let taken = if taken.is_empty() { String::new() } else { format!("\nnot said, so taken: {}", taken.join("; ")) };
    let per = units.pick("; per unit of tau = w0 t", "");
    args.format.print(
        &document,
        &format!("{} at {}, deadband neglected{per}", rotor.name(), units.speed_text(speed)),
        &table,
        &format!(
            "{}, minimum damping {}{}{}{taken}",
            word(linear.stability()),
            rounded(min_damping),
            counted(&modes, units).map_or(String::new(), |told| format!("\n{told}")),
            remark(&machine, right_of)
        ),
    )
}

/// What else must be known of the poles of a loop that is not ideal.
fn remark(machine: &catalog::Machine, right_of: Option<f64>) -> String {
    let (units, sample) = (machine.units(), machine.settings.feedback.sample());
    if let Some(line) = right_of {
        let line = rounded(units.rate(line));
        return format!(
            "\nwith a delay there are infinitely many poles: all with a real part greater than {line} are here"
        );
    }
    if sample > 0.0 {
        return format!("\nsampled every {}: s = ln(z) / h", units.time_text(sample));
    }
    String::new()
}
