//! `whirl trace`: every pole as a continuous branch over speed, and the Campbell diagram.

use rotor::{CriticalSpeed, Mode, Trace, Whirl};
use serde::Serialize;
use units::Dimension;

use super::linear::{self, PoleDocument};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{BelowArgs, MachineArgs, counted};
use crate::output::{Cell, Format, Table, rounded};
use crate::quantity::{self, QuantityRange};
use crate::units::{CommandUnits, UnitsDocument};

/// The most points that a trace can have: beyond it, the document no longer fits into 200 MB.
const MOST_POINTS: u64 = 20_000;

/// The points of a trace if nobody says how many.
const POINTS: u64 = 101;

/// Lines of the Campbell diagram, in multiples of the spin speed.
const ORDERS: [f64; 2] = [0.5, 1.0];

/// Options of `whirl trace`.
#[derive(Debug, clap::Args)]
pub(crate) struct TraceArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: QuantityRange,
    /// How many speeds, evenly spaced [default: 101]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MOST_POINTS))]
    points: Option<u64>,
    /// Print the Campbell diagram instead: frequencies, and critical speeds where a branch meets 0.5X or 1X
    #[arg(long)]
    campbell: bool,
    #[command(flatten)]
    below: BelowArgs,
    #[command(flatten)]
    format: Format,
}

/// The JSON document. `--campbell` changes only what people and spreadsheets see: it is all in here.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speeds: &'a [f64],
    min_damping: Vec<f64>,
    modes: Vec<Vec<PoleDocument>>,
    campbell: Campbell,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct Campbell {
    lines: Vec<OrderLine>,
    critical_speeds: Vec<Critical>,
}

/// A straight line of the diagram, by its multiple of the spin speed.
#[derive(Debug, Serialize)]
struct OrderLine {
    order: f64,
    frequency: Vec<f64>,
}

/// Where branch `modes[mode]` meets a line.
#[derive(Debug, Serialize)]
struct Critical {
    order: f64,
    mode: usize,
    speed: f64,
    #[serde(flatten)]
    pole: PoleDocument,
}

/// Prints the trace.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    if args.campbell && args.points.is_some() && !args.format.json {
        return Err(Failure::Usage(
            "--points does nothing to the Campbell diagram: its critical speeds are exact. Leave one of the two out"
                .into(),
        ));
    }
    interrupt::end_at_once()?;
    let (machine, over) = Machine::open_over(&args.machine, args.over)?;
    linear::neglects(&args.machine);
    let (rotor, feedback, units) = (&machine.rotor, &machine.settings.feedback, machine.units());
    let points =
        usize::try_from(args.points.unwrap_or(POINTS)).map_err(|_| Failure::Usage("too many points".into()))?;
    args.below.typed(rotor)?;
    if !rotor::ClosedLoop::describes(rotor, feedback) {
        return of_loop(args, &machine, &over.points(points));
    }
    let trace = rotor::trace(rotor, feedback, &over.points(points))?;
    let critical = rotor::critical_speeds(rotor, feedback, over.from, over.to, &ORDERS)?;
    let (table, what, footer) = if args.campbell {
        (critical_table(&critical, units), "critical speeds", lines_text(units))
    } else if args.format.json {
        // A long table that nobody reads.
        (Table::default(), "poles", String::new())
    } else {
        (poles_table(&trace, units), "poles", least(&trace, units))
    };
    let per = units.pick("; per unit of tau = w0 t", "");
    let heading = format!("{}: {what} for {}, deadband neglected{per}", rotor.name(), units.range_text(args.over));
    args.format.print(&document(rotor.name(), &trace, &critical, units), &heading, &table, &machine.with_taken(&footer))
}

/// The JSON document of a loop that is not ideal: a branch is `null` where it is not among the poles that are found.
#[derive(Debug, Serialize)]
struct LoopDocument<'a> {
    rotor: &'a str,
    speeds: &'a [f64],
    min_damping: Vec<Option<f64>>,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    modes: Vec<Vec<Option<PoleDocument>>>,
    modes_null: &'static str,
    campbell: Campbell,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// The trace of a loop with states of its own, a delay or samples.
fn of_loop(args: &TraceArgs, machine: &Machine, speeds: &[f64]) -> Result<(), Failure> {
    let units = machine.units();
    let machine::Campbell { branches, critical_speeds } =
        machine::campbell(&machine.rotor, &machine.settings, speeds, &ORDERS)?;
    let mode = |pole: rotor::C64| Mode { pole, shape: vec![] };
    let counted_modes = args.below.modes(&machine.rotor, &machine.settings, speeds[speeds.len() - 1])?;
    let least = |at: usize| {
        let found = counted_modes.min_damping(branches.iter().filter_map(|branch| branch[at]));
        Some(found).filter(|found| !found.is_nan())
    };
    let mut table = if args.campbell {
        critical_table(&critical_speeds, units)
    } else {
        Table::new(units.pick(&POLE_COLUMNS, &POLE_COLUMNS_SI))
    };
    for (at, &speed) in speeds.iter().enumerate().filter(|_| !args.campbell) {
        for (k, branch) in branches.iter().enumerate() {
            if let Some(pole) = branch[at] {
                table.row(pole_row(speed, k, &mode(pole), units));
            }
        }
    }
    let document = LoopDocument {
        rotor: machine.rotor.name(),
        speeds,
        min_damping: (0..speeds.len()).map(least).collect(),
        below: counted_modes.below(),
        modes: branches.iter().map(|b| b.iter().map(|pole| pole.map(|pole| (&mode(pole)).into())).collect()).collect(),
        modes_null: "with a delay there are infinitely many poles: this one is left of the line up to which they are found",
        campbell: campbell_document(speeds, &critical_speeds),
        units: units.document(),
    };
    let worst = (0..speeds.len()).filter_map(|at| Some((least(at)?, speeds[at]))).min_by(|a, b| a.0.total_cmp(&b.0));
    let footer = match worst {
        _ if args.campbell => lines_text(units),
        Some((zeta, speed)) => {
            let least = least_text(zeta, speed, units);
            counted(&counted_modes, units).map_or(least.clone(), |told| format!("{least}\n{told}"))
        }
        None => String::new(),
    };
    let what = if args.campbell { "critical speeds" } else { "poles" };
    let per = units.pick("; per unit of tau = w0 t", "");
    let heading =
        format!("{}: {what} for {}, deadband neglected{per}", machine.rotor.name(), units.range_text(args.over));
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer))
}

const POLE_COLUMNS: [&str; 8] = ["speed", "mode", "re", "im", "damping", "log dec", "frequency", "whirl"];
const POLE_COLUMNS_SI: [&str; 8] =
    ["speed (rpm)", "mode", "re (1/s)", "im (rad/s)", "damping", "log dec", "frequency (Hz)", "whirl"];

fn pole_row(speed: f64, branch: usize, mode: &Mode, units: CommandUnits) -> [Cell; 8] {
    [
        units.speed(speed).into(),
        Cell::from(&(branch + 1)),
        units.rate(mode.pole.re).into(),
        units.rate(mode.pole.im).into(),
        mode.damping().into(),
        mode.log_decrement().into(),
        units.frequency(mode.frequency()).into(),
        Cell::from(&mode.whirl()),
    ]
}

fn document<'a>(rotor: &'a str, trace: &'a Trace, critical: &[CriticalSpeed], units: CommandUnits) -> Document<'a> {
    let points = 0..trace.speeds.len();
    Document {
        rotor,
        speeds: &trace.speeds,
        min_damping: trace.min_damping(),
        modes: trace.branches.iter().map(|b| points.clone().map(|at| (&b.mode(at)).into()).collect()).collect(),
        campbell: campbell_document(&trace.speeds, critical),
        units: units.document(),
    }
}

fn campbell_document(speeds: &[f64], critical: &[CriticalSpeed]) -> Campbell {
    let mode = |c: &CriticalSpeed| Mode { pole: c.pole, shape: vec![] };
    Campbell {
        lines: ORDERS
            .iter()
            .map(|&order| OrderLine { order, frequency: speeds.iter().map(|speed| order * speed).collect() })
            .collect(),
        critical_speeds: critical
            .iter()
            .map(|c| Critical { order: c.order, mode: c.branch, speed: c.speed, pole: (&mode(c)).into() })
            .collect(),
    }
}

/// What the lines of the Campbell diagram are.
fn lines_text(units: CommandUnits) -> String {
    units.pick("1X and 0.5X: |Im| = R and R / 2", "1X and 0.5X: whirl at and at half of the spin speed").to_owned()
}

/// One row a speed and branch: the long form that spreadsheets pivot.
fn poles_table(trace: &Trace, units: CommandUnits) -> Table {
    let mut table = Table::new(units.pick(&POLE_COLUMNS, &POLE_COLUMNS_SI));
    for (at, &speed) in trace.speeds.iter().enumerate() {
        for (k, branch) in trace.branches.iter().enumerate() {
            table.row(pole_row(speed, k, &branch.mode(at), units));
        }
    }
    table
}

fn critical_table(critical: &[CriticalSpeed], units: CommandUnits) -> Table {
    let mut table = Table::new(units.pick(
        &["line", "speed", "mode", "frequency", "damping", "whirl"],
        &["line", "speed (rpm)", "mode", "frequency (Hz)", "damping", "whirl"],
    ));
    for c in critical {
        let mode = Mode { pole: c.pole, shape: vec![] };
        let whirl: Whirl = c.whirl;
        table.row([
            Cell::from(&format!("{}X", c.order)),
            units.speed(c.speed).into(),
            Cell::from(&(c.branch + 1)),
            units.frequency(mode.frequency()).into(),
            mode.damping().into(),
            Cell::from(&whirl),
        ]);
    }
    table
}

fn least(trace: &Trace, units: CommandUnits) -> String {
    let worst = trace.min_damping().into_iter().zip(&trace.speeds).min_by(|a, b| a.0.total_cmp(&b.0));
    worst.map_or(String::new(), |(zeta, speed)| least_text(zeta, *speed, units))
}

fn least_text(zeta: f64, speed: f64, units: CommandUnits) -> String {
    let at = units.pick(format!("R = {}", rounded(speed)), units.speed_text(speed));
    format!("least minimum damping {} at {at}", rounded(zeta))
}
