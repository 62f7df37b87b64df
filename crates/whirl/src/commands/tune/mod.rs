//! `whirl tune`: the gains that damp the worst mode best, over a family of operating conditions.

mod answer;
mod corners;
mod criteria;
mod follow;
mod front;
mod gain_table;
mod places;
mod question;
mod shafts;
mod shared;
mod summary;
mod typed;

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rotor::Feedback;
use rotor::file::write_feedback_for;
use tuner::{Method, Options, Price, Problem, Progress};
use units::Dimension;

use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::BelowArgs;
use crate::output::{Format, rounded};
use crate::place::Force;
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::varied::Varied;

use corners::Freed;
use question::Asked;
pub(crate) use shared::{finish, task};
use typed::{Criterion, Gains, MeasureName, Places, Robust, Signal, Span, TypedCost, TypedRegion};

/// Options of `whirl tune`. What it finds is feedback, for `--feedback` and for files.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("range").required(true).args(["over", "speed"]))]
#[command(group = clap::ArgGroup::new("written").multiple(true).args(["out", "plot"]))]
pub(crate) struct TuneArgs {
    /// The rotor: jeffcott, three-mass, rig, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    rotor: String,
    /// Every spin speed of a range, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: Option<QuantityRange>,
    /// One spin speed R alone (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,

    /// What drives a bearing: the sum of all sensors with four gains, or four gains for each sensor [default: composite; with shaft
    /// elements the law of the drawing]
    #[arg(long, value_enum, help_heading = "Structure")]
    signal: Option<Signal>,
    /// The masses with sensors, such as 1,2; or any:2 to compare every choice of two [default: the bearing's and its neighbour's].
    /// With shaft elements: places by name or number, such as left,right, read by every magnetic bearing [default: each its own]
    #[arg(long, value_name = "N,N,..|any:N", help_heading = "Structure")]
    sensors: Option<Places>,
    /// The mass that carries the control bearing; or any, to compare all [default: 1; with shaft elements every magnetic bearing]
    #[arg(long, value_name = "N|any", help_heading = "Structure")]
    bearing: Option<Places>,
    /// Search the gains of this feedback: its bearings, signals, filters and loops are taken as they are
    #[arg(
        long,
        value_name = "NAME|FILE",
        conflicts_with_all = ["signal", "sensors", "bearing"],
        help_heading = "Structure"
    )]
    feedback: Option<String>,
    /// Search frequencies of filters too: all, or a corner such as left.filter.1.zero, or words of its name for several; from a fourth
    /// to four times what they are, or KEY=A..B in the units of the file, or KEY=P% either way (repeatable)
    #[arg(long, value_name = "all|KEY[=A..B|P%]", conflicts_with = "track", help_heading = "Structure")]
    corners: Vec<Freed>,
    /// A part of the loop, such as lag=0.02, sample=0.05 or delay=0.02 (repeatable)
    #[arg(long, value_name = "KEY=VALUE", help_heading = "Structure")]
    set: Vec<String>,
    /// How gains depend on speed: fixed, linear, or table:N for N values over the range
    #[arg(long, value_name = "fixed|linear|table:N", default_value = "fixed", help_heading = "Structure")]
    gains: Gains,
    /// The largest magnitude of any gain [default: 20]; with shaft elements in times of the largest gain that its signal has in the
    /// law that is searched [default: 4], or of the stiffness K_t where that has none
    #[arg(long, value_name = "G", allow_negative_numbers = true, help_heading = "Structure")]
    bound: Option<f64>,
    /// The largest steady control force of the linear rotor, in w0^2 e_t (SI rotors: in N)
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Force), help_heading = "Structure")]
    force_limit: Option<TypedQuantity>,
    /// The largest peak of the sensitivity |S| at the command of any control bearing, the others closed, at every condition
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = "Structure")]
    max_sensitivity: Option<f64>,
    /// The smallest delay margin at every condition, in tau (SI rotors: in s); of one delay in the commands of all bearings
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time), help_heading = "Structure")]
    min_delay: Option<TypedQuantity>,

    /// Hold for every stiffness that deadband can leave: of each support bearing by itself, or one factor for all
    #[arg(long, value_enum, help_heading = "Conditions")]
    robust: Option<Robust>,
    /// Hold for a delay between measurement and force, one or a range, in tau (SI rotors: in s)
    #[arg(long, value_name = "T|A..B", allow_negative_numbers = true, help_heading = "Conditions")]
    delay: Option<Span>,
    /// Hold for every value of a parameter: damping.1=0.2..0.3, shaft.2=10%; repeatable, dimensionless
    #[arg(long, value_name = "KEY=A..B|P%", help_heading = "Conditions")]
    vary: Vec<Varied>,

    /// What is made as good as can be
    #[arg(long, value_enum, default_value_t = MeasureName::Ratio, help_heading = "Objective")]
    measure: MeasureName,
    #[command(flatten, next_help_heading = "Objective")]
    below: BelowArgs,
    /// Weights of forward and backward whirl: a mode's damping ratio counts divided by its weight
    #[arg(
        long,
        value_name = "F,B",
        value_delimiter = ',',
        num_args = 1,
        allow_negative_numbers = true,
        help_heading = "Objective"
    )]
    mode_weights: Option<Vec<f64>>,
    /// The region of poles of --measure region: a damping ratio, a decay rate per tau (SI rotors: per s) and a largest |lambda| in radians
    /// per tau (SI rotors: in Hz), or some of them, with or without units (frequency=300Hz). A machine is worth t if its poles are in the region made t times as tight
    #[arg(long, value_name = "damping=Z,decay=D,frequency=W", allow_hyphen_values = true, help_heading = "Objective")]
    region: Option<TypedRegion>,
    /// What --measure cost weighs: the force beside the orbit, standard deviation of the sensors' noise in e_t (SI rotors: in m), and its
    /// corner in radians per tau (SI rotors: in Hz), with or without units (noise=2um,corner=1kHz) [default: force=0.1,noise=0.1,corner=10, dimensionless]
    #[arg(long, value_name = "force=F,noise=S,corner=W", allow_hyphen_values = true, help_heading = "Objective")]
    cost: Option<TypedCost>,

    /// How a climb goes
    #[arg(long, value_enum, default_value_t = MethodName::Nonsmooth, help_heading = "Search")]
    method: MethodName,
    /// How many climbs from random gains [default: 4 to 32, by how much there is to get wrong]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Search")]
    starts: Option<u32>,
    /// What random numbers start from; the same seed gives the same answer
    #[arg(long, value_name = "S", default_value_t = 1, help_heading = "Search")]
    seed: u64,
    /// Random gains are drawn from -W to W
    #[arg(long, value_name = "W", allow_negative_numbers = true, help_heading = "Search")]
    spread: Option<f64>,
    /// How sharply the worst over a continuous family is bounded
    #[arg(long, value_name = "T", default_value_t = 1e-4, allow_negative_numbers = true, help_heading = "Search")]
    tolerance: f64,

    /// Follow the gains over N speeds of the range: at each as good as can be, from one to the next with a penalty on jumps
    #[arg(long, value_name = "N", conflicts_with_all = ["speed", "pareto"], value_parser = clap::value_parser!(u32).range(2..=10_000), help_heading = "More than one answer")]
    track: Option<u32>,
    /// What a gain that changes by 1 per unit of speed costs, in damping at each speed
    #[arg(
        long,
        value_name = "P",
        default_value_t = 1e-3,
        requires = "track",
        allow_negative_numbers = true,
        help_heading = "More than one answer"
    )]
    stiffness: f64,
    /// Trade damping for control force, for the size of gains, or for the peak of the sensitivity
    #[arg(long, value_enum, help_heading = "More than one answer")]
    pareto: Option<PriceName>,
    /// Search for each of these by itself, and tell side by side what it buys, in simulation too; --out is a folder for the files
    #[arg(
        long,
        value_name = "all|NAME,..",
        value_enum,
        value_delimiter = ',',
        hide_possible_values = true,
        conflicts_with_all = ["pareto", "track", "measure"],
        help_heading = "More than one answer"
    )]
    criteria: Vec<Criterion>,
    /// Clearances of all support bearings to simulate with --criteria, in e_t (SI rotors: in m) [default: the rotor's own]
    #[arg(
        long,
        value_name = "G,G,..",
        value_delimiter = ',',
        requires = "criteria",
        allow_negative_numbers = true,
        value_parser = quantity::of(Dimension::Length),
        help_heading = "More than one answer"
    )]
    deadband: Vec<TypedQuantity>,
    /// How many points the trade has
    #[arg(long, value_name = "N", default_value_t = 8, requires = "pareto", value_parser = clap::value_parser!(u32).range(2..=1000), help_heading = "More than one answer")]
    points: u32,
    /// Draw the trade, or the gains over speed, as .svg or .png
    #[arg(long, value_name = "FILE", help_heading = "More than one answer")]
    plot: Option<PathBuf>,

    /// Write the feedback to a file; with --pareto, a file a point into this folder
    #[arg(long, value_name = "FILE|DIR")]
    out: Option<PathBuf>,
    /// Write it even if it does not hold the rotor
    #[arg(long, requires = "out")]
    write_unstable: bool,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// [`Method`], for the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum MethodName {
    /// Smoothing continuation with slopes, then convex steps on the modes that matter, and a proof
    Nonsmooth,
    /// Powell's direction sets, as in the report
    Powell,
}

/// [`Price`], for the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum PriceName {
    /// Steady control force of the linear rotor under its unbalance
    Force,
    /// The largest gain
    Gain,
    /// The largest peak of the sensitivity.
    Sensitivity,
}

impl From<PriceName> for Price {
    fn from(name: PriceName) -> Self {
        match name {
            PriceName::Force => Self::Force,
            PriceName::Gain => Self::Gain,
            PriceName::Sensitivity => Self::Sensitivity,
        }
    }
}

/// Searches, prints and writes what was found.
///
/// # Errors
/// A question that makes no sense, no gains that hold the rotor, a file that cannot be written, an interrupt.
pub(crate) fn run(args: &TuneArgs) -> Result<(), Failure> {
    let asked = Asked::of(args)?;
    // A search that cannot deliver does not start.
    match (&args.out, args.pareto) {
        (Some(folder), None) if !args.criteria.is_empty() => criteria::check(args, folder)?,
        (Some(path), None) => args.force.check(path)?,
        (Some(path), Some(_)) if path.exists() && !path.is_dir() => {
            return Err(Failure::Usage(format!("'{}' is a file: --pareto writes into a folder", path.display())));
        }
        (Some(folder), Some(_)) if folder.is_dir() => {
            (1..=args.points).try_for_each(|point| args.force.check(&front::point_file(folder, point as usize)))?;
        }
        _ => {}
    }
    if let Some(path) = &args.plot {
        if args.track.is_none() && args.pareto.is_none() {
            return Err(Failure::Usage("--plot draws what --track or --pareto finds".into()));
        }
        crate::picture::check(path, args.force)?;
    }
    let stop = interrupt::flag()?;
    if !args.criteria.is_empty() {
        criteria::run(args, &asked, &stop)
    } else if args.pareto.is_some() {
        front::run(args, &asked, &stop)
    } else if args.track.is_some() {
        follow::run(args, &asked, &stop)
    } else {
        answer::run(args, &asked, &stop)
    }
}

impl TuneArgs {
    /// How much is searched for `problem`.
    fn options(&self, problem: &Problem) -> Options {
        let mut options = Options::for_problem(problem);
        options.method = match self.method {
            MethodName::Nonsmooth => Method::Nonsmooth,
            MethodName::Powell => Method::Powell,
        };
        options.starts = self.starts.map_or(options.starts, |starts| starts as usize);
        options.spread = self.spread.unwrap_or(options.spread);
        options.seed = self.seed;
        options.tolerance = self.tolerance;
        options
    }
}

/// The line on a terminal that says how it goes.
struct Watch {
    shown: bool,
}

impl Watch {
    fn new() -> Self {
        Self { shown: std::io::stderr().is_terminal() }
    }

    /// Says how it goes, if somebody looks.
    fn say(&self, progress: &Progress) {
        if self.shown {
            let left = progress.left().filter(|left| *left > Duration::from_millis(500));
            let left = left.map_or(String::new(), |left| format!(", {:.0} s left", left.as_secs_f64().ceil()));
            let Progress { done, starts, best, .. } = progress;
            let left = if done == starts { ", looking between the conditions".to_owned() } else { left };
            // Progress that cannot be shown is not missed.
            let _ = write!(std::io::stderr(), "\r\x1b[K{done} of {starts} starts, best {}{left}", rounded(*best));
        }
    }

    /// Wipes the line.
    fn end(&self) {
        if self.shown {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

/// Writes a feedback file for a rotor: what was asked, what was found, the feedback.
fn write_file(
    path: &Path,
    force: Force,
    (feedback, rotor): (&Feedback, &rotor::Rotor),
    comments: &[String],
) -> Result<(), Failure> {
    let command: Vec<String> = std::env::args().skip(1).collect();
    let head = format!("# whirl {}\n", command.join(" "));
    let comments: String = comments.iter().map(|line| format!("# {line}\n")).collect();
    force.write(path, head + &comments + "\n" + &write_feedback_for(feedback, rotor))
}
