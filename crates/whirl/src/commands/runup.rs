//! `whirl runup`: the transient response while the speed changes, and the critical speeds that it passes.

mod draw;
mod recorder;

use std::path::{Path, PathBuf};
use std::time::Instant;

use rotor::profile::Profile;
use rotor::{C64, Settings};
use serde::Serialize;
use study::runup::{Critical, ResonancePeak, RunUp, RunUpError, RunUpPlan, RunUpPoint};
use units::Dimension;

use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Format, Table, print_text, rounded};
use crate::picture;
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};
use crate::units::{CommandUnits, UnitsDocument};

use recorder::Recorder;

/// Options of `whirl runup`.
///
/// The drive is taken to hold the profile, whatever torque that needs, but for legs of a profile that have a torque. A critical speed is a peak of the first order (what turns with the
/// spin, turn by turn) that stands out by 0.293 of its height; its amplification is N / (N2 - N1) between the half-power points.
#[derive(Debug, clap::Args)]
pub(crate) struct RunupArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speed R at the beginning, in the steady orbit there (SI rotors: in rpm)
    #[arg(long, value_name = "R", default_value = "0", allow_negative_numbers = true, conflicts_with = "profile", value_parser = quantity::of(Dimension::Speed))]
    from: TypedQuantity,
    /// Spin speed R at the end; below --from for a coast-down (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, required_unless_present = "profile", value_parser = quantity::of(Dimension::Speed))]
    to: Option<TypedQuantity>,
    /// Rate of change of R per unit of tau, more than 0 (SI rotors: rpm per second)
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, required_unless_present = "profile", value_parser = quantity::of(Dimension::SpeedRate))]
    rate: Option<TypedQuantity>,
    /// Legs of speed from a file instead
    #[arg(long, value_name = "FILE", conflicts_with_all = ["to", "rate"])]
    profile: Option<String>,
    /// How many points of the response, evenly over time
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    points: u64,
    /// Draw amplitude and phase over speed into FILE.svg or FILE.png, or keep every step of it as a recording, FILE.rrd
    #[arg(long, value_name = "FILE", group = "written")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Draw amplitude and phase over speed in the terminal, above the table of critical speeds
    #[arg(long, conflicts_with_all = ["json", "csv"])]
    draw: bool,
    #[command(flatten)]
    format: Format,
}

/// The JSON document. Dimensionless throughout.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    legs: Vec<LegDocument>,
    /// Whether it began on the steady orbit of its first speed; otherwise from rest in the centre.
    began_steady: bool,
    points: Vec<PointDocument<'a>>,
    criticals: Vec<CriticalDocument>,
    /// The largest of everything, and where.
    largest: LargestDocument,
    steps: u64,
    dtau: f64,
    seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tripped: Option<TripDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Each with the speed where it is.
#[derive(Debug, Serialize)]
struct LargestDocument {
    radius: PlaceDocument,
    subsynchronous: PlaceDocument,
    force: PlaceDocument,
}

#[derive(Debug, Serialize)]
struct PlaceDocument {
    value: f64,
    speed: f64,
}

impl From<(f64, f64)> for PlaceDocument {
    fn from((value, speed): (f64, f64)) -> Self {
        Self { value, speed }
    }
}

#[derive(Debug, Serialize)]
struct LegDocument {
    tau: [f64; 2],
    speed: [f64; 2],
}

#[derive(Debug, Serialize)]
struct PointDocument<'a> {
    tau: f64,
    speed: f64,
    /// Largest in the turn, per mass.
    radius: &'a [f64],
    first_order: Vec<FirstOrder>,
    /// Root mean square of all but the first order.
    rest: &'a [f64],
    /// Root mean square of what whirls more slowly than the spin; `null` in the first eight turns.
    subsynchronous: Option<&'a [f64]>,
    force: f64,
}

#[derive(Debug, Serialize)]
struct FirstOrder {
    amplitude: f64,
    /// Angle by which it runs ahead of the spin's, in radians.
    phase: f64,
}

impl From<&C64> for FirstOrder {
    fn from(first: &C64) -> Self {
        Self { amplitude: first.norm(), phase: first.arg() }
    }
}

/// A critical speed, as scripts read it.
#[derive(Debug, Serialize)]
pub(super) struct CriticalDocument {
    speed: f64,
    /// `null` where the leg has not both half-power points.
    amplification: Option<f64>,
    peak: f64,
    /// The mass, counted from 1.
    station: usize,
    /// The leg, counted from 1.
    leg: usize,
    half_power: [Option<f64>; 2],
    /// The peak of the steady response at this mass that belongs to it; `null` where there is none.
    steady: Option<SteadyDocument>,
}

#[derive(Debug, Serialize)]
struct SteadyDocument {
    speed: f64,
    amplification: Option<f64>,
    peak: f64,
}

impl From<&Critical> for CriticalDocument {
    fn from(critical: &Critical) -> Self {
        let Critical { leg, station, peak, .. } = critical;
        let steady =
            |p: ResonancePeak| SteadyDocument { speed: p.speed, amplification: p.amplification(), peak: p.height };
        Self {
            speed: peak.speed,
            amplification: peak.amplification(),
            peak: peak.height,
            station: station + 1,
            leg: leg + 1,
            half_power: peak.half_power,
            steady: critical.steady.map(steady),
        }
    }
}

#[derive(Debug, Serialize)]
struct TripDocument {
    tau: f64,
    speed: f64,
    station: usize,
    radius: f64,
}

/// Runs it, and prints what came out.
///
/// # Errors
/// A machine or a profile that cannot be made or stepped, a picture that cannot be written, an interrupt; a trip, once all is told.
pub(crate) fn run(args: &RunupArgs) -> Result<(), Failure> {
    args.machine.leaves_speed_alone(if args.profile.is_some() { "--profile" } else { "--to and --rate" })?;
    let machine = Machine::open(&args.machine, None, catalog::Default::Trips)?;
    let tape_path = args.out.as_deref().filter(|path| path.extension().is_some_and(|end| end == "rrd"));
    match (&args.out, tape_path) {
        (Some(path), None) => check_picture(path, args.force)?,
        (_, Some(path)) => {
            tape::available()?;
            args.force.check(path)?;
        }
        _ => {}
    }
    let (Machine { rotor, settings, .. }, units) = (&machine, machine.units());
    let profile = profile(args, &machine)?;
    let stop = interrupt::flag()?;
    let began = Instant::now();
    let plan = RunUpPlan::new(rotor.clone(), settings.clone(), profile, args.points as usize)?;
    let told = |error| match (error, &args.profile) {
        (RunUpError::Interrupted, _) => Failure::Interrupted,
        (error, Some(path)) => Failure::Usage(format!("{path}: {error}")),
        (error, None) => Failure::Usage(error.to_string()),
    };
    let mut recorder = match tape_path {
        Some(path) => Some(Recorder::create(path, args.force, &plan, plan.program().map_err(told)?.0)?),
        None => None,
    };
    let mut see = |machine: &machine::Machine| recorder.iter_mut().for_each(|recorder| recorder.see(machine));
    let found = plan.run(&mut see, &stop).map_err(told)?;
    let seconds = began.elapsed().as_secs_f64();
    if let Some(recorder) = recorder {
        recorder.finish(&found)?;
    }
    let picture_path = args.out.as_deref().filter(|_| tape_path.is_none());
    if picture_path.is_some() || args.draw {
        let steady = study::runup::steady_response(&plan, &stop);
        if stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        let charts = draw::charts(&plan, &found, steady.as_ref(), units);
        if let Some(path) = picture_path {
            picture::draw(path, args.force, &charts)?;
        }
        if args.draw {
            print_text(&picture::in_terminal(&charts))?;
        }
    }
    print(args, &machine, &plan, &found, seconds)?;
    match found.tripped {
        Some(_) => Err(Failure::Work(trip_text(&found, units))),
        None => Ok(()),
    }
}

/// Refuses a file that is neither a picture nor a recording, or one that is there.
fn check_picture(path: &Path, force: Force) -> Result<(), Failure> {
    if picture::is_picture(path) {
        return picture::check(path, force);
    }
    Err(Failure::Usage(format!("'{}': expected a file name that ends in .svg, .png or .rrd", path.display())))
}

/// The profile that was asked for.
fn profile(args: &RunupArgs, machine: &Machine) -> Result<Profile, Failure> {
    let (Machine { rotor, settings, .. }, units) = (machine, machine.units());
    if let Some(path) = &args.profile {
        return catalog::profile(rotor, path);
    }
    let (Some(to), Some(rate)) = (args.to, args.rate) else {
        return Err(Failure::Usage("expected --to and --rate, or --profile".into()));
    };
    if !(rate.number().is_finite() && rate.number() > 0.0) {
        return Err(Failure::Usage(format!("rate = {rate}: expected a finite number greater than 0, up or down")));
    }
    // The same limits as the setting has.
    let speed = |typed: TypedQuantity| {
        let mut at = Settings { ..settings.clone() };
        units.set(rotor, &mut at, "speed".parse()?, typed.typed).map(|()| at.speed)
    };
    let (from, to) = (speed(args.from)?, speed(to)?);
    if from == to {
        return Err(Failure::Usage(format!("--from {} --to {}: expected two speeds", args.from, args.from)));
    }
    Ok(Profile::ramp(from, to, units.read("--rate", rate)?))
}

fn trip_text(found: &RunUp, units: CommandUnits) -> String {
    found.tripped.map_or(String::new(), |(trip, tau, speed)| {
        format!(
            "tripped at {}, {}: mass {} reached {} {}, past the limit of {}",
            units.time_text(tau),
            units.speed_text(crate::output::rounded(speed).parse().unwrap_or(speed)),
            trip.station + 1,
            crate::output::rounded(units.length(trip.radius)),
            units.length_unit(),
            crate::output::rounded(units.length(trip.limit))
        )
    })
}

fn print(args: &RunupArgs, machine: &Machine, plan: &RunUpPlan, found: &RunUp, seconds: f64) -> Result<(), Failure> {
    let (Machine { rotor, settings, .. }, units) = (machine, machine.units());
    let course = &found.course;
    let table = if args.format.csv { points_table(machine, found) } else { criticals_table(found, units) };
    let document = Document {
        rotor: rotor.name(),
        legs: course.windows(2).map(|w| LegDocument { tau: [w[0].0, w[1].0], speed: [w[0].1, w[1].1] }).collect(),
        began_steady: found.began_steady,
        points: found.points.iter().map(point).collect(),
        criticals: found.criticals.iter().map(CriticalDocument::from).collect(),
        largest: LargestDocument {
            radius: found.largest.radius.into(),
            subsynchronous: found.largest.subsynchronous.into(),
            force: found.largest.force.into(),
        },
        steps: found.steps,
        dtau: plan.dtau,
        seconds,
        tripped: found.tripped.map(|(trip, tau, speed)| TripDocument {
            tau,
            speed,
            station: trip.station + 1,
            radius: trip.radius,
        }),
        units: units.document(),
    };
    // What a torque has led to has digits that nobody typed.
    let told = |speed: f64| units.speed_cell(rounded(speed).parse().unwrap_or(speed));
    let speeds: Vec<String> = course.iter().map(|(_, speed)| told(*speed)).collect();
    let per = units.pick("; peaks in e_t", "; peaks in m");
    let heading = format!("{}: critical speeds of a run {}{per}", rotor.name(), speeds.join(" to "));
    let none = match found.criticals.is_empty() {
        true if settings.unbalanced(rotor).is_balanced() => "the rotor has no unbalance: nothing drives it\n",
        true => "no peak stands out\n",
        false => "",
    };
    let start = if found.began_steady {
        ""
    } else {
        "began at rest in the centre: no steady orbit is known to be stable there\n"
    };
    let levels = levels(machine, found);
    args.format.print(&document, &heading, &table, &machine.with_taken(&format!("{none}{start}{levels}")))
}

fn point(point: &RunUpPoint) -> PointDocument<'_> {
    let turn = &point.turn;
    PointDocument {
        tau: turn.tau,
        speed: turn.speed,
        radius: &turn.radius,
        first_order: turn.first_order.iter().map(FirstOrder::from).collect(),
        rest: &turn.rest,
        subsynchronous: point.subsynchronous.as_deref(),
        force: turn.force,
    }
}

fn criticals_table(found: &RunUp, units: CommandUnits) -> Table {
    let mut table = Table::new(units.pick(
        &["leg", "mass", "speed", "peak", "amplification", "steady speed", "steady peak", "steady amplification"],
        &[
            "leg",
            "mass",
            "speed (rpm)",
            "peak (m)",
            "amplification",
            "steady speed (rpm)",
            "steady peak (m)",
            "steady amplification",
        ],
    ));
    for Critical { leg, station, peak, steady } in &found.criticals {
        let of = |peak: Option<ResonancePeak>| {
            let number = |value: Option<f64>, without| value.map_or(Cell::Without(without), Cell::from);
            [
                number(peak.map(|p| units.speed(p.speed)), "none"),
                number(peak.map(|p| units.length(p.height)), "none"),
                number(peak.and_then(|p| p.amplification()), if peak.is_some() { "one side only" } else { "none" }),
            ]
        };
        let head = [Cell::from(&(leg + 1)), Cell::from(&(station + 1))];
        table.row(head.into_iter().chain(of(Some(*peak))).chain(of(*steady)));
    }
    table
}

/// A row a point, for spreadsheets.
fn points_table(machine: &Machine, found: &RunUp) -> Table {
    let (units, mass) = (machine.units(), machine.bearing_mass());
    let mut names = vec!["tau".to_owned(), "speed".into(), "force".into()];
    for k in 1..=machine.rotor.len() {
        names.extend(["amplitude", "phase", "radius", "rest", "subsynchronous"].map(|name| format!("{name}{k}")));
    }
    let mut table = Table::new(&names);
    for RunUpPoint { turn, subsynchronous } in &found.points {
        let mut row: Vec<Cell> =
            [turn.tau, units.speed(turn.speed), units.force(turn.force, mass)].map(Cell::from).into();
        for (k, first) in turn.first_order.iter().enumerate() {
            row.extend(
                [units.length(first.norm()), first.arg(), units.length(turn.radius[k]), units.length(turn.rest[k])]
                    .map(Cell::from),
            );
            let slow = subsynchronous.as_ref().map(|slow| units.length(slow[k]));
            row.push(slow.map_or(Cell::Without("not yet"), Cell::from));
        }
        table.row(row);
    }
    table
}

/// The largest of everything, in words.
fn levels(machine: &Machine, found: &RunUp) -> String {
    let units = machine.units();
    let rounded = crate::output::rounded;
    let line = |what: &str, (value, speed): (f64, f64), unit: &str| {
        format!("{what} {} {unit} at {}\n", rounded(value), units.speed_text(rounded(speed).parse().unwrap_or(speed)))
    };
    let length = |(value, speed)| (units.length(value), speed);
    let study::runup::Largest { radius, subsynchronous, force: (force, at) } = found.largest;
    let force = (units.force(force, machine.bearing_mass()), at);
    line("largest orbit", length(radius), units.length_unit())
        + &line("largest subsynchronous whirl (rms)", length(subsynchronous), units.length_unit())
        + &line("largest force", force, units.force_unit())
}
