//! `whirl trace`: every pole as a continuous branch over speed, and the Campbell diagram.

use rotor::{CriticalSpeed, Mode, Trace, Whirl};
use serde::Serialize;

use super::linear::{PoleDocument, swept};
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, rounded};
use crate::range::Range;

/// The most points that a trace can have: beyond it, the document no longer fits into 200 MB.
const MOST_POINTS: u64 = 20_000;

/// Lines of the Campbell diagram, in multiples of the spin speed.
const ORDERS: [f64; 2] = [0.5, 1.0];

/// Options of `whirl trace`.
#[derive(Debug, clap::Args)]
pub(crate) struct TraceArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speeds R, both ends included
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    over: Range,
    /// How many speeds, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u64).range(2..=MOST_POINTS))]
    points: u64,
    /// Print the Campbell diagram instead: frequencies, and critical speeds where a branch meets 0.5X or 1X
    #[arg(long)]
    campbell: bool,
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
}

#[derive(Debug, Serialize)]
struct Campbell {
    lines: Vec<Line>,
    critical_speeds: Vec<Critical>,
}

/// A straight line of the diagram, by its multiple of the spin speed.
#[derive(Debug, Serialize)]
struct Line {
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
    let (rotor, feedback) = swept(&args.machine, args.over)?;
    let points = usize::try_from(args.points).map_err(|_| Failure::Usage("too many points".into()))?;
    let trace = rotor::trace(&rotor, &feedback, &args.over.points(points))?;
    let critical = rotor::critical_speeds(&rotor, &feedback, args.over.from, args.over.to, &ORDERS)?;
    let name = rotor.name();
    let heading =
        |what: &str| format!("{name}: {what} for R in {}, deadband neglected; per unit of tau = w0 t", args.over);
    let document = || document(name, &trace, &critical);
    if !args.campbell {
        return args.format.print(&document(), &heading("poles"), &poles_table(&trace), &least(&trace));
    }
    if args.format.json {
        return crate::output::print_json(&document());
    }
    args.format.print(&(), &heading("critical speeds"), &critical_table(&critical), "1X and 0.5X: |Im| = R and R / 2")
}

fn document<'a>(rotor: &'a str, trace: &'a Trace, critical: &[CriticalSpeed]) -> Document<'a> {
    let points = 0..trace.speeds.len();
    let mode = |c: &CriticalSpeed| Mode { pole: c.pole, shape: vec![] };
    Document {
        rotor,
        speeds: &trace.speeds,
        min_damping: trace.min_damping(),
        modes: trace.branches.iter().map(|b| points.clone().map(|at| (&b.mode(at)).into()).collect()).collect(),
        campbell: Campbell {
            lines: ORDERS
                .iter()
                .map(|&order| Line { order, frequency: trace.speeds.iter().map(|speed| order * speed).collect() })
                .collect(),
            critical_speeds: critical
                .iter()
                .map(|c| Critical { order: c.order, mode: c.branch, speed: c.speed, pole: (&mode(c)).into() })
                .collect(),
        },
    }
}

/// One row a speed and branch: the long form that spreadsheets pivot.
fn poles_table(trace: &Trace) -> Table {
    let mut table = Table::new(&["speed", "mode", "re", "im", "damping", "log dec", "frequency", "whirl"]);
    for (at, &speed) in trace.speeds.iter().enumerate() {
        for (k, branch) in trace.branches.iter().enumerate() {
            let mode = branch.mode(at);
            table.row([
                speed.into(),
                Cell::from(&(k + 1)),
                mode.pole.re.into(),
                mode.pole.im.into(),
                mode.damping().into(),
                mode.log_decrement().into(),
                mode.frequency().into(),
                Cell::from(&mode.whirl()),
            ]);
        }
    }
    table
}

fn critical_table(critical: &[CriticalSpeed]) -> Table {
    let mut table = Table::new(&["line", "speed", "mode", "frequency", "damping", "whirl"]);
    for c in critical {
        let mode = Mode { pole: c.pole, shape: vec![] };
        let whirl: Whirl = c.whirl;
        table.row([
            Cell::from(&format!("{}X", c.order)),
            c.speed.into(),
            Cell::from(&(c.branch + 1)),
            mode.frequency().into(),
            mode.damping().into(),
            Cell::from(&whirl),
        ]);
    }
    table
}

fn least(trace: &Trace) -> String {
    let worst = trace.min_damping().into_iter().zip(&trace.speeds).min_by(|a, b| a.0.total_cmp(&b.0));
    worst.map_or(String::new(), |(zeta, speed)| {
        format!("least minimum damping {} at R = {}", rounded(zeta), rounded(*speed))
    })
}
