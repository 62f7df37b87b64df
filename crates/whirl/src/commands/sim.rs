//! `whirl sim`: the simulation process alone.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rotor::Settings;
use sim::Options;

use crate::attach::{self, BenchArgs};
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::{catalog, interrupt, output};

/// What a live bench simulates, and how fast: shared by `whirl sim` and `whirl up`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LiveArgs {
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Spin speed R = w / w0 at the start
    #[arg(long, value_name = "R", default_value_t = 2.5, allow_negative_numbers = true)]
    pub(crate) speed: f64,
    /// Steps a second
    #[arg(long, value_name = "HZ", default_value_t = Options::DEFAULT_RATE_HZ, allow_negative_numbers = true)]
    pub(crate) rate: f64,
    /// Advance of tau = w0 t per step
    #[arg(long, value_name = "H", default_value_t = Options::DEFAULT_DTAU, allow_negative_numbers = true)]
    pub(crate) dtau: f64,
    /// Orbit radius at which the machine trips, in e_t
    #[arg(long, value_name = "RADIUS", default_value_t = Settings::DEFAULT_TRIP, allow_negative_numbers = true)]
    pub(crate) trip: f64,
}

/// Options of `whirl sim`.
#[derive(Debug, clap::Args)]
pub(crate) struct SimArgs {
    #[command(flatten)]
    live: LiveArgs,
    /// End when standard input closes, as it does when the parent process dies
    #[arg(long, hide = true)]
    until_stdin_closes: bool,
}

impl LiveArgs {
    /// Clearance of a live bench's bearings if none is given, in `e_t`: enough for the deadband to show.
    const DEADBAND: f64 = 1.0;

    /// The rotor and the settings to start with.
    ///
    /// # Errors
    /// An unknown name, or a value out of range.
    pub(crate) fn machine(&self) -> Result<(rotor::Rotor, Settings), Failure> {
        let mut args = self.machine.clone();
        args.deadband = args.deadband.or(Some(Self::DEADBAND));
        let (rotor, mut settings) = catalog::machine(&args, self.speed, catalog::Default::Live)?;
        settings.set("trip".parse()?, self.trip)?;
        Ok((rotor, settings))
    }

    /// How it runs.
    ///
    /// # Errors
    /// Not a bench name.
    pub(crate) fn options(&self) -> Result<Options, Failure> {
        Ok(Options { bench: self.bench.name()?, rate_hz: self.rate, dtau: self.dtau })
    }
}

impl From<sim::SimError> for Failure {
    fn from(error: sim::SimError) -> Self {
        match error {
            sim::SimError::Wire(error) => error.into(),
            sim::SimError::Rate(_) | sim::SimError::Step(_) | sim::SimError::Settings(_) => {
                Self::Usage(error.to_string())
            }
        }
    }
}

/// Simulates until a signal ends it, and says in one line how it went.
///
/// # Errors
/// A machine that cannot be made, or a bench that is taken.
pub(crate) fn run(args: &SimArgs) -> Result<(), Failure> {
    let (rotor, settings) = args.live.machine()?;
    let options = args.live.options()?;
    let stop = interrupt::flag()?;
    if args.until_stdin_closes {
        stop_when_stdin_closes(stop.clone());
    }
    let carrier = attach::carrier("sim")?;
    let summary = sim::run(&carrier, &rotor, settings, &options, &stop)?;
    output::print_text(&format!("{summary}\n"))
}

/// A parent that is killed cannot end its child, but the pipe between them closes all the same.
fn stop_when_stdin_closes(stop: Arc<AtomicBool>) {
    std::thread::spawn(move || {
        let mut sink = [0; 64];
        let mut stdin = std::io::stdin().lock();
        while stdin.read(&mut sink).is_ok_and(|bytes| bytes > 0) {}
        stop.store(true, Ordering::Relaxed);
    });
}
