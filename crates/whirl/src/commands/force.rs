//! `whirl force`: the largest steady control force over speed and clearance, by simulation.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use study::force::{ForceError, Point};
use study::run::Settled;

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Format, Table};
use crate::range::Range;
use crate::units::UnitsDocument;

/// Options of `whirl force`.
#[derive(Debug, clap::Args)]
pub(crate) struct ForceArgs {
    /// The rotor: jeffcott, three-mass, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    rotor: String,
    /// The feedback: off; cancel (jeffcott); composite, individual (three-mass); or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    feedback: Option<String>,
    /// Clearances of all support bearings to try, in e_t (SI rotors: in m)
    #[arg(long, value_name = "G,G,..", value_delimiter = ',', default_value = "0", allow_negative_numbers = true)]
    deadband: Vec<f64>,
    /// Spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    over: Range,
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
    diverged_at: Vec<Vec<Option<f64>>>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Sweeps, and prints the forces.
///
/// # Errors
/// A machine that cannot be made, or an interrupt.
pub(crate) fn run(args: &ForceArgs) -> Result<(), Failure> {
    let mut opened = None;
    let mut deadbands = Vec::with_capacity(args.deadband.len());
    // Every speed and clearance is checked like a setting before anything starts.
    for &deadband in &args.deadband {
        let machine =
            MachineArgs { rotor: args.rotor.clone(), feedback: args.feedback.clone(), deadband: Some(deadband) };
        let (machine, over) = Machine::open_over(&machine, args.over)?;
        deadbands.push(machine.units().length_from_typed(deadband));
        opened = Some((machine, over));
    }
    let Some((machine, over)) = opened else {
        return Err(Failure::Usage("deadband: expected one or more clearances, such as 0,1,10".into()));
    };
    let (rotor, units) = (&machine.rotor, machine.units());
    let speeds = over.points(args.points as usize);
    let stop = interrupt::flag()?;
    let total = speeds.len() * deadbands.len();
    let (done, watched) = (AtomicUsize::new(0), std::io::stderr().is_terminal());
    let report = || {
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        if watched {
            // Progress that cannot be shown is not missed.
            let end = if count == total { "\r\x1b[K" } else { "" };
            let _ = write!(std::io::stderr(), "\r{count} of {total} points{end}");
        }
    };
    let points = study::force::sweep(rotor, &machine.settings.feedback, &speeds, &deadbands, &stop, &report)?;

    let mut table = Table::new(units.pick(
        &["speed", "deadband", "max force", "motion"],
        &["speed (rpm)", "deadband (m)", "max force (N)", "motion"],
    ));
    for (i, speed) in speeds.iter().enumerate() {
        for (deadband, points) in deadbands.iter().zip(&points) {
            let word = match points[i] {
                Point { diverged_at: Some(_), .. } => "diverged",
                Point { settled: Settled::Steady | Settled::Given, .. } => "steady",
                Point { settled: Settled::Beating, .. } => "beating",
                Point { settled: Settled::No, .. } => "NOT settled",
            };
            let force = steady_force(&points[i])
                .map_or_else(|| Cell::from(&""), |u| units.force(u, machine.bearing_mass()).into());
            table.row([units.speed(*speed).into(), units.length(*deadband).into(), force, Cell::from(&word)]);
        }
    }
    let each = |of: &dyn Fn(&Point) -> Option<f64>| {
        points.iter().map(|row| row.iter().map(of).collect()).collect::<Vec<Vec<_>>>()
    };
    let document = Document {
        rotor: rotor.name(),
        speeds: &speeds,
        deadbands: &deadbands,
        max_force: each(&steady_force),
        settled: points.iter().map(|row| row.iter().map(|p| p.settled).collect()).collect(),
        diverged_at: each(&|point| point.diverged_at),
        units: units.document(),
    };
    let dimensionless = units.pick(", in w0^2 e_t; deadbands in e_t", "");
    let heading = format!("{}: largest steady control force from rest{dimensionless}", rotor.name());
    args.format.print(&document, &heading, &table, "")
}

fn steady_force(point: &Point) -> Option<f64> {
    let has_one = point.diverged_at.is_none() && point.max_force.is_finite();
    has_one.then_some(point.max_force)
}

impl From<ForceError> for Failure {
    fn from(error: ForceError) -> Self {
        match error {
            ForceError::Poles(error) => error.into(),
            ForceError::Run(error) => error.into(),
        }
    }
}
