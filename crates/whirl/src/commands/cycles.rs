//! `whirl cycles`: exact self-excited limit cycles of the balanced rotor, branch by branch over speed.

use rotor::circular::{self, Curve, ENUMERATED_FREE, End, Orbit};
use serde::Serialize;

use super::orbits::{
    CompletenessDocument, JudgedDocument, PointDocument, SweepArgs, completeness, contact, deadband_text, heading,
    headings, is_stable, points, radii, speeds_text, stability, unjudged,
};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Format, Table};
use crate::units::{CommandUnits, UnitsDocument};

/// Options of `whirl cycles`.
#[derive(Debug, clap::Args)]
pub(crate) struct CyclesArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    sweep: SweepArgs,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    deadband: &'a [f64],
    completeness: CompletenessDocument,
    points: Vec<PointDocument<BranchDocument>>,
    /// Every branch as the threshold speed of a given amplitude: where whirl of that size neither grows nor decays.
    thresholds: Vec<ThresholdDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct BranchDocument {
    /// Positive forward.
    frequency: f64,
    radius: Vec<f64>,
    #[serde(flatten)]
    stability: JudgedDocument,
    /// The control force `|u|`.
    force: f64,
    /// Masses that press on their support bearing, counted from 1.
    contact: Vec<usize>,
}

/// One branch from end to end.
#[derive(Debug, Serialize)]
struct ThresholdDocument {
    ends: [End; 2],
    /// Largest radius of any mass.
    amplitude: Vec<f64>,
    speed: Vec<f64>,
    frequency: Vec<f64>,
    stable: Vec<Option<bool>>,
    /// Speeds at which cycles appear or vanish in pairs.
    folds: Vec<f64>,
}

impl From<&Orbit> for BranchDocument {
    fn from(orbit: &Orbit) -> Self {
        Self {
            frequency: orbit.frequency,
            radius: orbit.radii(),
            stability: orbit.into(),
            force: orbit.force,
            contact: contact(orbit),
        }
    }
}

impl From<&Curve> for ThresholdDocument {
    fn from(curve: &Curve) -> Self {
        Self {
            ends: curve.ends,
            amplitude: curve.orbits.iter().map(Orbit::largest_radius).collect(),
            speed: curve.orbits.iter().map(|o| o.speed).collect(),
            frequency: curve.orbits.iter().map(|o| o.frequency).collect(),
            stable: curve.orbits.iter().map(is_stable).collect(),
            folds: curve.folds.iter().map(|&i| curve.orbits[i].speed).collect(),
        }
    }
}

/// Prints the cycles.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &CyclesArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    let (machine, speeds) = args.sweep.prepare(&args.machine)?;
    let (Machine { rotor, settings, .. }, units) = (&machine, machine.units());
    let found = circular::cycles(rotor, &settings.feedback, &settings.deadband, &speeds)?;

    let first = [heading("speed", units, "rpm"), "branch".into(), heading("frequency", units, "Hz")];
    let mut table = Table::new(&headings(&first, rotor.len(), &["stability".into()], units));
    for (speed, orbits) in found.speeds.iter().zip(&found.orbits) {
        for (k, orbit) in orbits.iter().enumerate() {
            // The sign tells the sense of whirl.
            let head = [units.speed(*speed).into(), Cell::from(&(k + 1)), Cell::from(units.frequency(orbit.frequency))];
            table.row(head.into_iter().chain(radii(orbit, units)).chain([Cell::from(&stability(orbit))]));
        }
    }
    let mut footer: Vec<String> = found.curves.iter().filter_map(|curve| describe(curve, units)).collect();
    if found.orbits.iter().all(Vec::is_empty) {
        footer.push("no self-excited circular limit cycle found at any of these speeds".into());
    }
    // With a delay the frequencies of cycles are no roots of a polynomial: they are sought.
    let enumerated = if settings.feedback.delay() > 0.0 { 0 } else { ENUMERATED_FREE };
    let (completeness, proven) = completeness(&machine, &found, enumerated);
    footer.push(proven);
    footer.extend(unjudged(&found));
    let document = Document {
        rotor: rotor.name(),
        deadband: &settings.deadband,
        completeness,
        points: points(&found),
        thresholds: found.curves.iter().map(Into::into).collect(),
        units: units.document(),
    };
    let dimensionless = units.pick("; radii in e_t, frequency in radians per tau", "");
    let heading =
        format!("{}: exact limit cycles without unbalance, {}{dimensionless}", rotor.name(), deadband_text(&machine));
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer.join("\n")))
}

/// One branch in a sentence.
fn describe(curve: &Curve, units: CommandUnits) -> Option<String> {
    let end = |orbit: &Orbit, end: End| {
        let speed = speeds_text(&[orbit.speed], units);
        match end {
            End::Range => format!("{speed} (end of the range)"),
            End::Unbounded => format!("{speed} (amplitude without bound)"),
            End::ContactLost => format!("{speed} (last contact lost)"),
            End::Closed => format!("{speed} (closed)"),
            End::Limit => format!("{speed} (actuator at its limit)"),
            End::Lost => format!("{speed} (followed no further)"),
        }
    };
    let (first, last) = (curve.orbits.first()?, curve.orbits.last()?);
    let folds: Vec<f64> = curve.folds.iter().map(|&i| curve.orbits[i].speed).collect();
    let turning =
        if folds.is_empty() { String::new() } else { format!(", turning back at {}", speeds_text(&folds, units)) };
    Some(format!(
        "threshold speed over amplitude: {} to {}{turning}",
        end(first, curve.ends[0]),
        end(last, curve.ends[1])
    ))
}
