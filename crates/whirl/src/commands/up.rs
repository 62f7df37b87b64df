//! `whirl up`: a simulation process and a dashboard on it; quitting the dashboard ends both.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use dash::Keeper;

use crate::attach;
use crate::commands::dash::{ScreenArgs, ended};
use crate::commands::sim::{LiveArgs, READY};
use crate::failure::Failure;

/// How long a simulation may take to end before it is killed.
const FAREWELL: Duration = Duration::from_secs(2);

/// Options of `whirl up`.
#[derive(Debug, clap::Args)]
pub(crate) struct UpArgs {
    #[command(flatten)]
    live: LiveArgs,
    #[command(flatten)]
    screen: ScreenArgs,
}

/// Starts the simulation, shows it, and ends it.
///
/// # Errors
/// A machine that cannot be made, a bench that is taken, or no terminal.
pub(crate) fn run(args: &UpArgs) -> Result<(), Failure> {
    let UpArgs { live: args, screen } = args;
    // What is wrong with the command line is said here, not by the child.
    args.machine()?;
    let screen = screen.options()?;
    let bench = args.options()?.bench;
    let carrier = attach::dashboard_carrier()?;
    let mut simulation = Simulation::start(args.to_arguments())?;
    let shown = dash::run(carrier, &bench, Some(&mut simulation), None, &screen);
    simulation.end()?;
    ended(shown?)
}

/// The simulation process that we started. It ends with us, however we end: its standard input is a pipe from us.
struct Simulation {
    arguments: Vec<String>,
    child: Child,
    /// What it says goes to a file, because the screen is not its to write on.
    said: File,
    ended: Option<ExitStatus>,
}

impl Simulation {
    /// Starts it and waits until the bench's name is its own, or it ends for lack of that: another's bench of the same
    /// name must not be taken for it.
    fn start(arguments: Vec<String>) -> Result<Self, Failure> {
        let (child, said) = spawn(&arguments)?;
        let mut simulation = Self { arguments, child, said, ended: None };
        let mut word = String::new();
        if let Some(stdout) = &mut simulation.child.stdout {
            // Reads to the end of the line, or of the process.
            let _ = BufReader::new(stdout).read_line(&mut word);
        }
        if word == READY {
            return Ok(simulation);
        }
        simulation.ended = simulation.child.wait().ok();
        Err(simulation.failure())
    }

    fn has_ended(&mut self) -> bool {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().ok().flatten();
        }
        self.ended.is_some()
    }

    /// Why it ended, with its own exit code.
    fn failure(&mut self) -> Failure {
        let words = self.words();
        match self.ended.and_then(|status| status.code()) {
            Some(2) => Failure::Usage(words),
            Some(3) => Failure::Bench(words),
            _ => Failure::Work(words),
        }
    }

    /// What it said last, or how it ended.
    fn words(&mut self) -> String {
        let mut said = String::new();
        let _ = self.said.rewind().and_then(|()| self.said.read_to_string(&mut said));
        let last = said.lines().last().map(|line| line.trim_start_matches("whirl: ").to_owned());
        last.unwrap_or_else(|| self.ended.map_or_else(|| "it still runs".to_owned(), |status| status.to_string()))
    }

    /// Asks it to end, and kills it if it does not.
    fn end(&mut self) -> Result<(), Failure> {
        if self.has_ended() {
            return Ok(());
        }
        // Closing its input is the request.
        drop(self.child.stdin.take());
        let start = Instant::now();
        while !self.has_ended() && start.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(2));
        }
        if !self.has_ended() {
            self.child
                .kill()
                .and_then(|()| self.child.wait())
                .map_err(|error| Failure::Work(format!("the simulation does not end: {error}")))?;
        }
        Ok(())
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // After a panic: nobody is left to tell.
        let _ = self.end();
    }
}

impl Keeper for Simulation {
    fn ended(&mut self) -> Option<String> {
        self.has_ended().then(|| self.words())
    }

    fn revive(&mut self) -> Result<(), String> {
        *self = Self::start(self.arguments.clone()).map_err(|failure| failure.to_string())?;
        Ok(())
    }
}

fn spawn(arguments: &[String]) -> Result<(Child, File), Failure> {
    let failed = |error: std::io::Error| Failure::Work(format!("the simulation cannot be started: {error}"));
    let program = std::env::current_exe().map_err(failed)?;
    let said = tempfile::tempfile().map_err(failed)?;
    let child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(said.try_clone().map_err(failed)?)
        .spawn()
        .map_err(failed)?;
    Ok((child, said))
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
