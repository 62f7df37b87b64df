//! `whirl up`: a simulation process and a dashboard on it; quitting the dashboard ends both.

use std::path::PathBuf;
use std::time::Duration;

use dash::Keeper;

use crate::attach;
use crate::commands::dash::{ScreenArgs, ended};
use crate::commands::sim::LiveArgs;
use crate::companion::Companion;
use crate::failure::Failure;
use crate::place::Force;
use crate::recordings::Recordings;

/// How long a simulation may take to end before it is killed.
const FAREWELL: Duration = Duration::from_secs(2);

/// Options of `whirl up`.
#[derive(Debug, clap::Args)]
pub(crate) struct UpArgs {
    #[command(flatten)]
    live: LiveArgs,
    #[command(flatten)]
    screen: ScreenArgs,
    /// Record the session in FILE.rrd, by a process of its own
    #[arg(long, value_name = "FILE.rrd", group = "written")]
    record: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
}

/// Starts the simulation, shows it, and ends it.
///
/// # Errors
/// A machine that cannot be made, a bench that is taken, no terminal, or a recording that failed.
pub(crate) fn run(args: &UpArgs) -> Result<(), Failure> {
    // What is wrong with the command line is said here, not by the child.
    let live = &args.live;
    let ((rotor, settings), options) = (live.machine()?, live.options()?);
    options.check(&rotor, &settings)?;
    let screen = args.screen.options()?;
    let bench = options.bench;
    if let Some(path) = &args.record {
        tape::available()?;
        args.force.check(path)?;
    }
    let carrier = attach::dashboard_carrier()?;
    let mut simulation = Simulation(Companion::start("simulation", FAREWELL, live.to_arguments())?);
    let mut scribe = Recordings::of(bench.clone());
    if let Some(path) = &args.record
        && let Err(failure) = scribe.begin(path, args.force)
    {
        simulation.0.end()?;
        return Err(failure);
    }
    let shown = dash::run(carrier, &bench, Some(&mut simulation), Some(&mut scribe), &screen);
    // The simulation first, so that its end is in the recording.
    simulation.0.end()?;
    let recorded = scribe.finish();
    ended(shown?)?;
    recorded
}

/// The simulation that the dashboard shows, and can start again.
struct Simulation(Companion);

impl Keeper for Simulation {
    fn ended(&mut self) -> Option<String> {
        self.0.has_ended().then(|| self.0.words())
    }

    fn revive(&mut self) -> Result<(), String> {
        self.0 = self.0.start_again().map_err(|failure| failure.to_string())?;
        Ok(())
    }
}

impl LiveArgs {
    /// The command line of the simulation process.
    fn to_arguments(&self) -> Vec<String> {
        let mut arguments = vec!["sim".to_owned(), self.machine.rotor.clone(), "--as-child".to_owned()];
        let mut option = |name: &str, value: String| arguments.push(format!("--{name}={value}"));
        option("bench", self.bench.bench.clone());
        option("rate", self.rate.to_string());
        option("dtau", self.dtau.to_string());
        for (name, value) in [("speed", self.speed), ("trip", self.trip), ("deadband", self.machine.deadband)] {
            if let Some(value) = value {
                option(name, value.to_string());
            }
        }
        if let Some(feedback) = &self.machine.feedback {
            option("feedback", feedback.clone());
        }
        arguments
    }
}
