//! `whirl response`: the exact synchronous response under unbalance, every branch over speed.

use rotor::circular::{self, Circular, Curve, End, Orbit};
use rotor::{Rotor, Settings};
use serde::Serialize;

use crate::catalog::{self, Machine};
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table};
use crate::range::Range;
use crate::units::Units;

/// Options of `whirl response`.
#[derive(Debug, clap::Args)]
pub(crate) struct ResponseArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    pub(super) sweep: SweepArgs,
    #[command(flatten)]
    format: Format,
}

/// The speeds, and settings that have no option of their own.
#[derive(Debug, clap::Args)]
pub(super) struct SweepArgs {
    /// Range of spin speeds
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    over: Range,
    /// How many speeds
    #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    points: u32,
    /// Any other setting, such as deadband.2=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl SweepArgs {
    /// The machine, and the speeds, all of them in range.
    pub(super) fn prepare(&self, machine: &MachineArgs) -> Result<(Rotor, Settings, Vec<f64>), Failure> {
        Machine::open(machine, Some(self.over.from), catalog::Default::Analysis)?;
        let Machine { rotor, mut settings } = Machine::open(machine, Some(self.over.to), catalog::Default::Analysis)?;
        for assignment in &self.set {
            if assignment.starts_with("speed=") {
                return Err(Failure::Usage(format!("{assignment}: the speeds are those of --over")));
            }
            catalog::assign(&rotor, Units::of(&rotor), &mut settings, assignment)?;
        }
        settings.check(&rotor)?;
        Ok((rotor, settings, self.over.points(self.points as usize)))
    }
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    deadband: &'a [f64],
    points: Vec<PointDocument>,
    /// Where a branch turns back: the jumps of a run-up and a coast-down.
    folds: Vec<FoldDocument>,
    curves: Vec<CurveDocument>,
}

#[derive(Debug, Serialize)]
struct PointDocument {
    speed: f64,
    branches: Vec<BranchDocument>,
}

#[derive(Debug, Serialize)]
struct BranchDocument {
    radius: Vec<f64>,
    /// Angle by which each mass runs ahead of the unbalance, in radians.
    phase: Vec<f64>,
    force: f64,
    stable: bool,
    /// Largest real part of the linearised motion in the rotating frame.
    growth: f64,
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
    stable: Vec<bool>,
}

impl From<&Orbit> for BranchDocument {
    fn from(orbit: &Orbit) -> Self {
        Self {
            radius: orbit.radii(),
            phase: orbit.amplitude.iter().map(|c| c.arg()).collect(),
            force: orbit.force,
            stable: orbit.is_stable(),
            growth: orbit.growth,
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
            stable: curve.orbits.iter().map(Orbit::is_stable).collect(),
        }
    }
}

/// Masses in contact, counted from 1.
pub(super) fn contact(orbit: &Orbit) -> Vec<usize> {
    (0..orbit.amplitude.len()).filter(|k| orbit.contact >> k & 1 == 1).map(|k| k + 1).collect()
}

/// Headings of the radii, mass by mass.
pub(super) fn radius_headings(masses: usize) -> &'static [&'static str] {
    const HEADINGS: [&str; rotor::MAX_MASSES] =
        ["r1", "r2", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16"];
    &HEADINGS[..masses.min(HEADINGS.len())]
}

/// `stable` or `unstable`.
pub(super) fn stability(orbit: &Orbit) -> &'static str {
    if orbit.is_stable() { "stable" } else { "unstable" }
}

/// Prints the response.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &ResponseArgs) -> Result<(), Failure> {
    let (rotor, settings, speeds) = args.sweep.prepare(&args.machine)?;
    let found = circular::synchronous(&rotor, &settings.feedback, &settings.deadband, &speeds)?;

    let headings = [&["speed", "branch"], radius_headings(rotor.len()), &["force", "stability"]].concat();
    let mut table = Table::new(&headings);
    for (speed, orbits) in found.speeds.iter().zip(&found.orbits) {
        for (k, orbit) in orbits.iter().enumerate() {
            let head = [Cell::from(*speed), Cell::from(&(k + 1))];
            let tail = [Cell::from(orbit.force), Cell::from(&stability(orbit))];
            table.row(head.into_iter().chain(orbit.radii().into_iter().map(Cell::from)).chain(tail));
        }
    }
    let document = document(&rotor, &settings, &found);
    let heading = format!(
        "{}: exact synchronous response, deadband {} e_t; radii in e_t, force in w0^2 e_t",
        rotor.name(),
        listed(&settings.deadband)
    );
    let footer = match document.folds.len() {
        0 => String::new(),
        _ => {
            let speeds: Vec<f64> = document.folds.iter().map(|f| f.speed).collect();
            format!("branches turn back at R = {}", listed(&speeds))
        }
    };
    args.format.print(&document, &heading, &table, &footer)
}

/// Numbers for people, separated by commas.
pub(super) fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|n| crate::output::rounded(*n)).collect::<Vec<_>>().join(", ")
}

fn document<'a>(rotor: &'a Rotor, settings: &'a Settings, found: &Circular) -> Document<'a> {
    let folds = found.curves.iter().flat_map(|curve| curve.folds.iter().map(|&i| &curve.orbits[i]));
    Document {
        rotor: rotor.name(),
        deadband: &settings.deadband,
        points: found
            .speeds
            .iter()
            .zip(&found.orbits)
            .map(|(&speed, orbits)| PointDocument { speed, branches: orbits.iter().map(Into::into).collect() })
            .collect(),
        folds: folds.map(|orbit| FoldDocument { speed: orbit.speed, radius: orbit.radii() }).collect(),
        curves: found.curves.iter().map(Into::into).collect(),
    }
}
