//! `whirl force`: the largest steady control force over speed and clearance, by simulation.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicUsize, Ordering};

use rotor::Stability;
use serde::Serialize;
use study::disturbance::{self, DisturbanceGrowth, Means};
use study::force::{ForceError, ForcePoint};
use study::run::Settled;
use units::Dimension;

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Format, Table, rounded};
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::units::UnitsDocument;

/// Options of `whirl force`.
#[derive(Debug, clap::Args)]
pub(crate) struct ForceArgs {
    /// The rotor: jeffcott, three-mass, rig, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    rotor: String,
    /// The feedback: off; cancel (jeffcott); composite, individual (three-mass); or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    feedback: Option<String>,
    /// Clearances of all support bearings to try, in e_t (SI rotors: in m) [default: the rotor's own]
    #[arg(long, value_name = "G,G,..", value_delimiter = ',', allow_negative_numbers = true, value_parser = quantity::of(Dimension::Length))]
    deadband: Vec<TypedQuantity>,
    /// Spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: QuantityRange,
    /// How many speeds, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    points: u32,
    #[command(flatten)]
    format: Format,
}

/// The JSON document; the lists are `[deadband][speed]`.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speeds: &'a [f64],
    deadbands: &'a [f64],
    /// `null` where the motion diverged, see `diverged_at`; where it had not settled, the largest of the last half of
    /// the run, see `settled`.
    max_force: Vec<Vec<Option<f64>>>,
    settled: Vec<Vec<Settled>>,
    /// Whether a small disturbance of the steady motion dies away; `null` on the margin, and where no motion is steady, see
    /// `stability`.
    stable: Vec<Vec<Option<bool>>>,
    /// `stable`, `marginal` or `unstable`; `null` where no motion is steady: it diverged, or has not settled.
    stability: Vec<Vec<Option<Stability>>>,
    /// How fast the fastest disturbance grows, per unit of tau.
    growth: Vec<Vec<Option<f64>>>,
    /// By `eigenvalues` on a circular orbit and at rest, by `simulation` on any other: that sees growth above `growth_seen`.
    stability_by: Vec<Vec<Option<Means>>>,
    growth_seen: f64,
    /// The same for the rotor at rest in its centre, support bearings with clearance out of action.
    centre_stability: Vec<Vec<Option<Stability>>>,
    centre_growth: Vec<Vec<Option<f64>>>,
    diverged_at: Vec<Vec<Option<f64>>>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Sweeps, and prints the forces.
///
/// # Errors
/// A machine that cannot be made, or an interrupt.
pub(crate) fn run(args: &ForceArgs) -> Result<(), Failure> {
    if let Some(twice) = (1..args.deadband.len()).find(|&i| args.deadband[..i].contains(&args.deadband[i])) {
        return Err(Failure::Usage(format!("deadband {} is given twice: expected each once", args.deadband[twice])));
    }
    let mut opened = None;
    let mut clearances = Vec::with_capacity(args.deadband.len());
    let to_try: Vec<Option<TypedQuantity>> =
        if args.deadband.is_empty() { vec![None] } else { args.deadband.iter().copied().map(Some).collect() };
    // Every speed and clearance is checked like a setting before anything starts.
    for deadband in to_try {
        let machine = MachineArgs { rotor: args.rotor.clone(), feedback: args.feedback.clone(), deadband, set: vec![] };
        let (machine, over) = Machine::open_over(&machine, args.over)?;
        clearances.push(machine.settings.deadband.clone());
        opened = Some((machine, over));
    }
    let Some((machine, over)) = opened else {
        return Err(Failure::Usage("deadband: expected one or more clearances, such as 0,1,10".into()));
    };
    let (rotor, units) = (&machine.rotor, machine.units());
    let speeds = over.points(args.points as usize);
    let stop = interrupt::flag()?;
    let total = speeds.len() * clearances.len();
    // Of clearances that differ the largest stands for them, as it does among settings.
    let deadbands: Vec<f64> = clearances.iter().map(|all| all.iter().copied().fold(0.0, f64::max)).collect();
    let (done, watched) = (AtomicUsize::new(0), std::io::stderr().is_terminal());
    let report = || {
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        if watched {
            // Progress that cannot be shown is not missed.
            let end = if count == total { "\r\x1b[K" } else { "" };
            let _ = write!(std::io::stderr(), "\r{count} of {total} points{end}");
        }
    };
    let points = study::force::sweep(rotor, &machine.settings.feedback, &speeds, &clearances, &stop, &report)?;

    let mut table = Table::new(units.pick(
        &["speed", "deadband", "max force", "motion", "stability", "centre"],
        &["speed (rpm)", "deadband (m)", "max force (N)", "motion", "stability", "centre"],
    ));
    for (i, speed) in speeds.iter().enumerate() {
        for (deadband, points) in deadbands.iter().zip(&points) {
            let word = match points[i] {
                ForcePoint { diverged_at: Some(_), .. } => "diverged",
                ForcePoint { settled: Settled::Steady | Settled::Given, .. } => "steady",
                ForcePoint { settled: Settled::Beating, .. } => "beating",
                ForcePoint { settled: Settled::No, .. } => "NOT settled",
            };
            let force = steady_force(&points[i])
                .map_or_else(|| Cell::from(&""), |u| units.force(u, machine.bearing_mass()).into());
            let growth = points[i].stability.map_or("", |growth| growth.word());
            let words = [word, growth, points[i].centre.map_or("", |growth| growth.word())];
            let numbers = [units.speed(*speed).into(), units.length(*deadband).into(), force];
            table.row(numbers.into_iter().chain(words.iter().map(Cell::from)));
        }
    }
    let differ = clearances.iter().any(|all| all.iter().any(|one| *one != all[0]));
    let footer = footer(points.iter().flatten(), rotor.is_balanced(), differ);
    let document = Document {
        rotor: rotor.name(),
        speeds: &speeds,
        deadbands: &deadbands,
        max_force: of(&points, steady_force),
        settled: of(&points, |p| p.settled),
        stable: of(&points, |p| p.stability.and_then(|growth| growth.stability.is_stable())),
        stability: of(&points, |p| p.stability.map(|growth| growth.stability)),
        growth: of(&points, |p| p.stability.map(|growth| growth.growth)),
        stability_by: of(&points, |p| p.stability.map(|growth| growth.by)),
        growth_seen: disturbance::slowest_seen(),
        centre_stability: of(&points, |p| p.centre.map(|growth| growth.stability)),
        centre_growth: of(&points, |p| p.centre.map(|growth| growth.growth)),
        diverged_at: of(&points, |point| point.diverged_at),
        units: units.document(),
    };
    let dimensionless = units.pick(", in w0^2 e_t; deadbands in e_t", "");
    let heading = format!("{}: largest steady control force from rest{dimensionless}", rotor.name());
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer))
}

/// One value a point, `[deadband][speed]`.
fn of<T>(points: &[Vec<ForcePoint>], value: impl Fn(&ForcePoint) -> T) -> Vec<Vec<T>> {
    points.iter().map(|row| row.iter().map(&value).collect()).collect()
}

/// What the words of the table do not say.
fn footer<'a>(points: impl Iterator<Item = &'a ForcePoint> + Clone, balanced: bool, differ: bool) -> String {
    let growth = points.filter_map(|p| p.stability);
    let total = growth.clone().count();
    let mut lines = Vec::new();
    if differ {
        lines.push("the bearings have clearances of their own: the largest is shown".to_owned());
    }
    if balanced {
        lines.push("nothing drives this rotor: every unbalance is zero".to_owned());
    }
    let unstable = |j: &DisturbanceGrowth| j.stability == Stability::Unstable;
    if let Some(fastest) = growth.clone().filter(unstable).map(|j| j.growth).max_by(f64::total_cmp) {
        lines.push(format!(
            "{} of {total} steady values belong to motion that is NOT stable: disturbances that neither start nor unbalance \
             excite grow, as fast as exp({} tau)",
            growth.clone().filter(unstable).count(),
            rounded(fastest)
        ));
    }
    if growth.clone().any(|j| j.by == Means::Simulation) {
        lines.push(format!(
            "stability of a motion that beats is by simulation: growth slower than exp({} tau) is not seen",
            rounded(disturbance::slowest_seen())
        ));
    }
    lines.join("\n")
}

fn steady_force(point: &ForcePoint) -> Option<f64> {
    let has_one = point.diverged_at.is_none() && point.max_force.is_finite();
    has_one.then_some(point.max_force)
}

impl From<ForceError> for Failure {
    fn from(error: ForceError) -> Self {
        match error {
            ForceError::Program(error) => error.into(),
            ForceError::Run(error) => error.into(),
        }
    }
}
