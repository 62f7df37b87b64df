//! `whirl sim`: the simulation process alone.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rotor::Settings;
use rotor::profile::Profile;
use sim::Options;
use units::{Dimension, Typed};

use crate::attach::{self, BenchArgs};
use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::quantity::{self, TypedQuantity};
use crate::units::CommandUnits;
use crate::{interrupt, output};

/// What a child says once it has what it needs: the first word of its first line.
pub(crate) const READY: &str = "ready";

/// What a live bench simulates, and how fast: shared by `whirl sim` and `whirl up`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LiveArgs {
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Spin speed R = w / w0 at the start (SI rotors: in rpm) [default: R = 2.5]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    pub(crate) speed: Option<TypedQuantity>,
    /// Legs of speed from a file, from the start on, until somebody sets `speed` or `ramp`
    #[arg(long, value_name = "FILE", conflicts_with = "speed")]
    pub(crate) profile: Option<String>,
    /// Steps a second, also as 2kHz
    #[arg(long, value_name = "HZ", default_value_t = Options::DEFAULT_RATE_HZ, allow_negative_numbers = true, value_parser = steps_a_second)]
    pub(crate) rate: f64,
    /// Advance of tau = w0 t per step (of an SI rotor also 20us); it is made in as many substeps as keep numbers within 1e-4
    #[arg(long, value_name = "H", default_value_t = DTAU, allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time))]
    pub(crate) dtau: TypedQuantity,
    /// Orbit radius at which the machine trips, in e_t (SI rotors: in m) [default: 1000 e_t]
    #[arg(long, value_name = "RADIUS", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Length))]
    pub(crate) trip: Option<TypedQuantity>,
    /// Coast down after a trip, at first at this rate, in R per tau (SI rotors: rpm/s) [default: hold the machine where it is]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, value_parser = quantity::of(Dimension::SpeedRate))]
    pub(crate) coast_down: Option<TypedQuantity>,
}

/// Options of `whirl sim`.
#[derive(Debug, clap::Args)]
pub(crate) struct SimArgs {
    #[command(flatten)]
    pub(crate) live: LiveArgs,
    /// Not in real time: wait at every sample for the command of a controller outside (`external`), and go as fast as that, bit for
    /// bit repeatable
    #[arg(long, conflicts_with = "rate")]
    lockstep: bool,
    /// Serve a parent process: say `ready` once the bench is ours, and end when standard input closes, as it does when
    /// the parent dies
    #[arg(long, hide = true)]
    as_child: bool,
    /// Make no step before the parent has said something
    #[arg(long, hide = true, requires = "as_child")]
    when_told: bool,
}

/// The usual advance of a step.
const DTAU: TypedQuantity = TypedQuantity { dimension: Dimension::Time, typed: Typed::alone(Options::DEFAULT_DTAU) };

/// Reads steps a second, which are of the clock on the wall and so the same for any rotor.
fn steps_a_second(typed: &str) -> Result<f64, String> {
    let named = [("kHz", 1e3), ("Hz", 1.0), ("", 1.0)];
    let read = |(name, times): (&str, f64)| Some(times * typed.trim().strip_suffix(name)?.trim().parse::<f64>().ok()?);
    named.into_iter().find_map(read).ok_or_else(|| "expected a number, alone or in Hz, kHz".to_owned())
}

impl LiveArgs {
    /// Speed of a live bench if none is given: above the threshold that the three-mass rotor has without control.
    pub(crate) const SPEED: f64 = 2.5;
    /// Clearance of a built-in rotor's bearings if none is given, in `e_t`: enough for the deadband to show.
    const DEADBAND: f64 = 1.0;

    /// The rotor and the settings to start with.
    ///
    /// # Errors
    /// An unknown name, or a value out of range.
    pub(crate) fn machine(&self) -> Result<(rotor::Rotor, Settings), Failure> {
        let machine = Machine::open(&self.machine, self.speed, catalog::Default::Live)?;
        let units = machine.units();
        let Machine { rotor, mut settings, .. } = machine;
        if self.speed.is_none() {
            settings.speed = Self::SPEED;
        }
        if let Some(profile) = self.read_profile(&rotor)? {
            settings.speed = profile.ends_at();
            // Whoever takes the speed off its profile, or puts it back, does not make it jump.
            settings.ramp = profile.greatest_rate();
        }
        // A rotor from a file has clearances of its own, and so have the touchdown bearings of magnetic ones.
        let is_built_in = rotor::builtin::ROTORS.contains(&self.machine.rotor.as_str());
        if self.machine.deadband.is_none() && is_built_in && rotor.is_chain() {
            settings.deadband.fill(Self::DEADBAND);
        }
        let mut options = Vec::new();
        if let Some(trip) = self.trip {
            units.set(&rotor, &mut settings, "trip".parse()?, trip.typed)?;
            options.push(("--trip", "trip"));
        }
        if let Some(rate) = self.coast_down {
            units.set(&rotor, &mut settings, "coast_down".parse()?, rate.typed)?;
            options.push(("--coast-down", "coast_down"));
        }
        if self.speed.is_some() {
            options.push(("--speed", "speed"));
        }
        if self.profile.is_some() {
            options.extend([("--profile", "speed"), ("--profile", "ramp")]);
        }
        catalog::assign_all(&rotor, units, &mut settings, &self.machine.said(&options), &self.machine.set)?;
        settings.check(&rotor)?;
        Ok((rotor, settings))
    }

    fn read_profile(&self, rotor: &rotor::Rotor) -> Result<Option<Profile>, Failure> {
        self.profile.as_deref().map(|path| catalog::profile(rotor, path)).transpose()
    }

    /// How `rotor` runs.
    ///
    /// # Errors
    /// Not a bench name, or a profile that is none.
    pub(crate) fn options(&self, rotor: &rotor::Rotor) -> Result<Options, Failure> {
        let profile = self.read_profile(rotor)?;
        let dtau = CommandUnits::of(rotor).read_dimensionless("--dtau", self.dtau)?;
        Ok(Options { bench: self.bench.name()?, rate_hz: self.rate, dtau, profile, ..Options::default() })
    }
}

impl From<sim::SimError> for Failure {
    fn from(error: sim::SimError) -> Self {
        match error {
            sim::SimError::Wire(error) => error.into(),
            sim::SimError::Rate(_)
            | sim::SimError::Step(_)
            | sim::SimError::Program(_)
            | sim::SimError::Profile(_)
            | sim::SimError::External(_) => Self::Usage(error.to_string()),
        }
    }
}

/// Simulates until a signal ends it, and says in one line how it went.
///
/// # Errors
/// A machine that cannot be made, or a bench that is taken.
pub(crate) fn run(args: &SimArgs) -> Result<(), Failure> {
    let (rotor, settings) = args.live.machine()?;
    let options = Options { lockstep: args.lockstep, ..args.live.options(&rotor)? };
    let stop = interrupt::flag()?;
    let told = Arc::new(AtomicBool::new(false));
    if args.as_child {
        heed_stdin(stop.clone(), told.clone());
    }
    let carrier = attach::carrier("sim")?;
    let ready = || {
        if args.as_child {
            // A parent that does not listen will close our input too.
            let _ = output::print_text(&format!("{READY}\n"));
        }
        // Whoever is there by then hears the very first step.
        while args.when_told && !told.load(Ordering::Relaxed) && !stop.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    let summary = sim::run(&carrier, &rotor, settings, &options, &stop, ready)?;
    output::print_text(&format!("{summary}\n"))
}

/// A parent that is killed cannot end its child, but the pipe between them closes all the same: then `stop`. What it says before is `told`.
pub(crate) fn heed_stdin(stop: Arc<AtomicBool>, told: Arc<AtomicBool>) {
    std::thread::spawn(move || {
        let mut sink = [0; 64];
        let mut stdin = std::io::stdin().lock();
        while stdin.read(&mut sink).is_ok_and(|bytes| bytes > 0) {
            told.store(true, Ordering::Relaxed);
        }
        stop.store(true, Ordering::Relaxed);
    });
}
