//! `whirl up`: a simulation process and a dashboard on it; quitting the dashboard ends both.

use std::path::PathBuf;
use std::time::Duration;

use telemetry::processes::{OpaqueError, SimulationProcess};

use crate::attach;
use crate::child_process::ChildProcess;
use crate::commands::dash::{ScreenArgs, ended};
use crate::commands::sim::LiveArgs;
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
    let (rotor, settings) = live.machine()?;
    let options = live.options(&rotor)?;
    options.check(&rotor, &settings)?;
    let screen = args.screen.options()?;
    let bench = options.bench;
    if let Some(path) = &args.record {
        tape::available()?;
        args.force.check(path)?;
    }
    let carrier = attach::dashboard_carrier()?;
    // A recorder hears the very first step: it is there before it is made.
    let when_told = args.record.is_some().then(|| "--when-told".to_owned());
    let arguments = live.to_arguments().into_iter().chain(when_told).collect();
    let mut simulation = Simulation(ChildProcess::start("simulation", FAREWELL, arguments)?);
    let mut recorder = Recordings::of(bench.clone());
    if let Some(path) = &args.record
        && let Err(failure) = recorder.begin(path, args.force)
    {
        simulation.0.end()?;
        return Err(failure);
    }
    simulation.0.tell()?;
    let shown = dashboard::run(carrier, &bench, Some(&mut simulation), Some(&mut recorder), &screen);
    // The simulation first, so that its end is in the recording.
    simulation.0.end()?;
    let recorded = recorder.finish();
    ended(shown?)?;
    recorded
}

/// The simulation that the dashboard shows, and can start again.
struct Simulation(ChildProcess);

impl SimulationProcess for Simulation {
    fn ended(&mut self) -> Option<String> {
        self.0.has_ended().then(|| self.0.words())
    }

    fn restart(&mut self) -> Result<(), OpaqueError> {
        self.0 = self.0.start_again().map_err(OpaqueError::new)?;
        self.0.tell().map_err(OpaqueError::new)
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
        let (trip, coast_down) = (("trip", self.trip), ("coast-down", self.coast_down));
        for (name, value) in [("speed", self.speed), trip, coast_down, ("deadband", self.machine.deadband)] {
            if let Some(value) = value {
                option(name, value.to_string());
            }
        }
        for (name, value) in [("feedback", &self.machine.feedback), ("profile", &self.profile)] {
            if let Some(value) = value {
                option(name, value.clone());
            }
        }
        self.machine.set.iter().for_each(|typed| option("set", typed.clone()));
        arguments
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use crate::cli::{Cli, Command};

    #[test]
    fn every_option_of_a_live_bench_reaches_its_simulation() {
        // `--set` once did not. An option that is added and forgotten here makes the list below short.
        let typed = [
            "rotor.toml",
            "--feedback=feedback.toml",
            "--deadband=0.5",
            "--set=delay=0.02",
            "--set=kd=-0.1",
            "--bench=other",
            "--rate=500",
            "--dtau=0.02",
            "--trip=7",
            "--coast-down=0.5",
            "--profile=run-up.toml",
        ];
        let known = {
            let command = <Cli as clap::CommandFactory>::command();
            let sim = command.find_subcommand("sim").expect("there").clone();
            let names = sim.get_arguments().filter_map(|argument| argument.get_long().map(str::to_owned));
            names
                .filter(|name| !["as-child", "when-told", "help", "lockstep"].contains(&name.as_str()))
                .collect::<Vec<_>>()
        };
        for name in known {
            // Two that exclude each other are tried apart.
            assert!(name == "speed" || typed.iter().any(|typed| typed.starts_with(&format!("--{name}="))), "{name}");
        }
        let with_units = ["rotor.toml", "--speed=3000rpm", "--trip=4 mm", "--deadband=2e_t"];
        for typed in [&typed[..], &["rotor.toml", "--speed=3"], &with_units] {
            let up = Cli::try_parse_from(["whirl", "up"].iter().chain(typed)).expect("parses");
            let Command::Up(up) = up.command() else { panic!("{typed:?}") };
            let passed = up.live.to_arguments();
            let sim = Cli::try_parse_from(std::iter::once("whirl".to_owned()).chain(passed)).expect("parses");
            let Command::Sim(sim) = sim.command() else { panic!("{typed:?}") };
            assert_eq!(format!("{:?}", up.live), format!("{:?}", sim.live));
        }
    }
}
