//! `whirl response`: the exact synchronous response under unbalance, branch by branch over speed.

use rotor::circular::{self, Circular, Curve, ENUMERATED_FORCED, End, Orbit};
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
use crate::units::UnitsDocument;

/// Options of `whirl response`.
#[derive(Debug, clap::Args)]
pub(crate) struct ResponseArgs {
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
    /// Where a branch turns back: the jumps of a run-up and a coast-down.
    folds: Vec<FoldDocument>,
    curves: Vec<CurveDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct BranchDocument {
    radius: Vec<f64>,
    /// Angle by which each mass runs ahead of the unbalance, in radians.
    phase: Vec<f64>,
    force: f64,
    #[serde(flatten)]
    stability: JudgedDocument,
    /// Masses that press on their support bearing, counted from 1.
    contact: Vec<usize>,
}

#[derive(Debug, Serialize)]
struct FoldDocument {
    speed: f64,
    radius: Vec<f64>,
}

/// One branch from end to end.
#[derive(Debug, Serialize)]
struct CurveDocument {
    ends: [End; 2],
    speed: Vec<f64>,
    radius: Vec<Vec<f64>>,
    force: Vec<f64>,
    stable: Vec<Option<bool>>,
}

impl From<&Orbit> for BranchDocument {
    fn from(orbit: &Orbit) -> Self {
        Self {
            radius: orbit.radii(),
            phase: orbit.amplitude.iter().map(|c| c.arg()).collect(),
            force: orbit.force,
            stability: orbit.into(),
            contact: contact(orbit),
        }
    }
}

impl From<&Curve> for CurveDocument {
    fn from(curve: &Curve) -> Self {
        Self {
            ends: curve.ends,
            speed: curve.orbits.iter().map(|o| o.speed).collect(),
            radius: curve.orbits.iter().map(Orbit::radii).collect(),
            force: curve.orbits.iter().map(|o| o.force).collect(),
            stable: curve.orbits.iter().map(is_stable).collect(),
        }
    }
}

/// Prints the response.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &ResponseArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    let (machine, speeds) = args.sweep.prepare(&args.machine)?;
    let (Machine { rotor, settings, .. }, units) = (&machine, machine.units());
    let found = circular::synchronous(rotor, &settings.feedback, &settings.deadband, &speeds)?;

    let first = [heading("speed", units, "rpm"), "branch".into()];
    let last = [heading("force", units, "N"), "stability".into()];
    let mut table = Table::new(&headings(&first, rotor.len(), &last, units));
    let mass = machine.bearing_mass();
    for (speed, orbits) in found.speeds.iter().zip(&found.orbits) {
        for (k, orbit) in orbits.iter().enumerate() {
            let head = [Cell::from(units.speed(*speed)), Cell::from(&(k + 1))];
            let tail = [Cell::from(units.force(orbit.force, mass)), Cell::from(&stability(orbit))];
            table.row(head.into_iter().chain(radii(orbit, units)).chain(tail));
        }
    }
    let (completeness, proven) = completeness(&machine, &found, ENUMERATED_FORCED);
    let document = document(&machine, &found, completeness);
    let dimensionless = units.pick("; radii in e_t, force in w0^2 e_t", "");
    let heading = format!("{}: exact synchronous response, {}{dimensionless}", rotor.name(), deadband_text(&machine));
    let mut footer = vec![proven];
    footer.extend(unjudged(&found));
    if !document.folds.is_empty() {
        let speeds: Vec<f64> = document.folds.iter().map(|f| f.speed).collect();
        footer.push(format!("branches turn back at {}", speeds_text(&speeds, units)));
    }
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer.join("\n")))
}

fn document<'a>(machine: &'a Machine, found: &Circular, completeness: CompletenessDocument) -> Document<'a> {
    let folds = found.curves.iter().flat_map(|curve| curve.folds.iter().map(|&i| &curve.orbits[i]));
    Document {
        rotor: machine.rotor.name(),
        deadband: &machine.settings.deadband,
        completeness,
        points: points(found),
        folds: folds.map(|orbit| FoldDocument { speed: orbit.speed, radius: orbit.radii() }).collect(),
        curves: found.curves.iter().map(Into::into).collect(),
        units: machine.units().document(),
    }
}
