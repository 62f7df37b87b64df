//! The real-time process: it paces, steps, applies changes and publishes.
//!
//! Two threads. The **stepping thread**, which is the caller of [`run`], allocates nothing, locks nothing, formats
//! nothing and serves no request: it waits for a deadline, steps, and fills the sample that readers will see. The
//! **request thread** ([`request_thread`]) checks requests, hands them over through a bounded queue, computes poles, keeps the
//! statistics and publishes bench statuses.
//!
//! ```
//! use sim::Options;
//! use std::sync::atomic::{AtomicBool, Ordering};
//! use wire::{Carrier, Memory};
//!
//! let rotor = rotor::builtin::rotor("jeffcott").ok_or("built in")?;
//! let gains = rotor::builtin::feedback(&rotor, "cancel").ok_or("built in")?;
//! let settings = rotor::Settings::new(&rotor, 3.0, gains);
//! let options = Options { bench: "demo".parse()?, ..Options::default() };
//! // Readers find it under its name once it is ready; this one ends it at once.
//! let (carrier, stop) = (Memory::default(), AtomicBool::new(false));
//! let summary = sim::run(&carrier, &rotor, settings, &options, &stop, || {
//!     assert!(carrier.glance(&options.bench).is_ok());
//!     stop.store(true, Ordering::Relaxed);
//! })?;
//! assert!(!summary.trip.is_tripped());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Catch-up policy: deadlines are absolute. After a stall the steps that are due run at once, back to back, and count
//! as late; a stall of more than [`pacer::CATCH_UP_LIMIT`] is not caught up: its deadlines are given up and counted as
//! missed. Steps themselves are never skipped, so `tau` falls behind the wall clock by what was missed.
//!
//! A step that is published is made of as many Runge-Kutta steps as [`rotor::step`] asks for under the settings in force;
//! settings for which there is no time to make so many are refused, as at the start.

#[cfg(test)]
mod accuracy;
mod clock;
mod engine;
mod excitation;
mod external;
mod health;
mod lockstep;
mod log;
pub mod pacer;
mod request_thread;

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use machine::{Pace, Program};
use rotor::profile::Profile;
use rotor::{Rotor, Settings};
use wire::message::{Health, Trip};
use wire::{BenchName, Carrier, ControlHost, Host, MAX_BURST, StateSender, StepLayout, WireError};

use crate::engine::{Engine, Exchange};
use crate::external::{External, Ready};
pub use crate::external::{ExternalCounts, ExternalError};
use crate::pacer::Pacer;
use crate::request_thread::RequestThread;

/// How a simulation runs, apart from what it simulates.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The name under which readers find it.
    pub bench: BenchName,
    /// Steps a second, 1 to 100 000.
    pub rate_hz: f64,
    /// Advance of `tau` per published step, more than 0 and at most 1.
    pub dtau: f64,
    /// What the speed does from the start on, until somebody sets it; the settings have the speed at which it ends.
    pub profile: Option<Profile>,
    /// Not in real time: the machine waits for the command of a controller outside at every sample, and goes as fast as that.
    pub lockstep: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            bench: BenchName::default(),
            rate_hz: Self::DEFAULT_RATE_HZ,
            dtau: Self::DEFAULT_DTAU,
            profile: None,
            lockstep: false,
        }
    }
}

impl Options {
    /// The default rate, steps a second.
    pub const DEFAULT_RATE_HZ: f64 = 1000.0;
    /// The default step in `tau`.
    pub const DEFAULT_DTAU: f64 = 0.01;

    /// What runs `rotor` like this under `settings`, with as many substeps a step as it takes: see [`rotor::step`].
    ///
    /// # Errors
    /// Options or settings out of range, or too fast a machine for the substeps that there is time for.
    pub fn check(&self, rotor: &Rotor, settings: &Settings) -> Result<Program, SimError> {
        if !(1.0..=100_000.0).contains(&self.rate_hz) {
            return Err(SimError::Rate(self.rate_hz));
        }
        if !(self.dtau > 0.0 && self.dtau <= 1.0) {
            return Err(SimError::Step(self.dtau));
        }
        settings.check(rotor).map_err(machine::ProgramError::from)?;
        external::check(settings, self)?;
        let pace = Pace { dtau: self.dtau, rate_hz: self.rate_hz };
        Ok(match &self.profile {
            Some(profile) => Program::compile_profile(rotor, settings, profile, pace)?,
            None => Program::compile(rotor, settings, [settings.speed; 2], pace)?,
        })
    }
}

/// Why a simulation did not start, or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// The rate is out of range.
    #[error("rate = {0}: expected 1 to 100000 steps a second")]
    Rate(f64),
    /// The step is out of range.
    #[error("dtau = {0}: expected more than 0 and at most 1")]
    Step(f64),
    /// A controller outside cannot work like this.
    #[error(transparent)]
    External(#[from] ExternalError),
    /// The settings do not fit the rotor, or cannot be stepped at this pace.
    #[error(transparent)]
    Program(#[from] machine::ProgramError),
    /// The profile cannot be stepped at this pace.
    #[error(transparent)]
    Profile(#[from] machine::ProfileError),
    /// The bench's name is taken, or its ports fail.
    #[error(transparent)]
    Wire(#[from] WireError),
}

/// How a simulation went, told in one line when it ends.
#[derive(Clone, Debug)]
pub struct Summary {
    /// The bench's name.
    pub bench: BenchName,
    /// The rotor's name.
    pub rotor: String,
    /// How long it ran.
    pub elapsed: Duration,
    /// Its pace.
    pub health: Health,
    /// Whether it had tripped at the end, and why.
    pub trip: Trip,
    /// How a controller outside did, if there was one.
    pub external: Option<ExternalCounts>,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bench, rotor, elapsed, health, trip, external } = self;
        let seconds = elapsed.as_secs_f64();
        write!(
            f,
            "bench {bench}: {rotor}, {} steps in {seconds:.1} s ({:.1}/s), {} late, {} missed, \
             lateness {:.0} us median, {:.0} us at the 99th percentile, {:.0} us at worst; {trip}",
            health.steps,
            health.steps as f64 / seconds,
            health.late,
            health.missed,
            health.lateness_p50_us,
            health.lateness_p99_us,
            health.lateness_max_us,
        )?;
        external.map_or(Ok(()), |counts| write!(f, "; {counts}"))
    }
}

/// Simulates `rotor` under `settings` until `stop` becomes true. `ready` is called once the bench's name is ours.
///
/// # Errors
/// Options or settings out of range, a name that is taken, or ports that fail.
pub fn run<C: Carrier>(
    carrier: &C,
    rotor: &Rotor,
    settings: Settings,
    options: &Options,
    stop: &AtomicBool,
    ready: impl FnOnce(),
) -> Result<Summary, SimError> {
    let program = options.check(rotor, &settings)?;
    let substeps = program.substeps();
    let host = carrier.host(&options.bench)?;
    let states = host.states(StepLayout::new(rotor.len()).with_bearings(settings.feedback.bearings.len()))?;
    ready();

    let started = Instant::now();
    let started_ns = wall_ns();
    // Two processes started in the same nanosecond would still differ by their id.
    let run_id = started_ns.rotate_left(20) ^ u64::from(std::process::id());
    let exchange = Exchange::new(program.words_at_most());
    // A snapshot a second.
    let engine = Engine::new(program, run_id, options.rate_hz.ceil() as u64);
    exchange.counters.speed_bits.store(engine.speed().to_bits(), Ordering::Relaxed);
    let requests = RequestThread::new(rotor, settings, substeps, options, (run_id, started_ns), &exchange);

    std::thread::scope(|scope| {
        let answering = std::thread::Builder::new().name("requests".into()).spawn_scoped(scope, || {
            let _stop_at_end = StopAtEnd(stop);
            requests.run(&host, stop)
        });
        let answering = answering.map_err(|error| WireError::Internal(format!("no thread for requests: {error}")))?;
        let stepped = host.control().and_then(|control| {
            let external = External::new(control, run_id, options);
            if options.lockstep {
                lockstep::step_until(stop, states, engine, external, &exchange, answering.thread())
            } else {
                step_until(stop, states, engine, external, &exchange, options, answering.thread())
            }
        });
        let elapsed = started.elapsed();
        stop.store(true, Ordering::Relaxed);
        answering.thread().unpark();
        let (health, trip) = answering.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        stepped?;
        Ok(Summary {
            bench: options.bench.clone(),
            rotor: rotor.name().to_owned(),
            elapsed,
            health,
            trip,
            external: exchange.counters.external.told(),
        })
    })
}

/// Ends the stepping thread when the request thread ends, however it ends: half a simulation must not live on.
struct StopAtEnd<'a>(&'a AtomicBool);

impl Drop for StopAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The wall clock, nanoseconds since 1970.
fn wall_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64
}

/// The stepping thread.
fn step_until(
    stop: &AtomicBool,
    mut states: impl StateSender,
    mut engine: Engine,
    mut external: External<impl ControlHost>,
    exchange: &Exchange,
    options: &Options,
    answering: &std::thread::Thread,
) -> Result<(), WireError> {
    clock::precise_sleep();
    let (clock, started_ns) = (clock::Monotonic::start(), wall_ns());
    let mut pacer = Pacer::new(options.rate_hz);
    while !stop.load(Ordering::Relaxed) {
        let deadline = pacer.deadline_ns();
        if !clock.sleep_until(deadline) {
            // Woken early, by a signal or to look at `stop`.
            continue;
        }
        let begun = clock.now_ns();
        let wake = pacer.wake(begun);
        exchange.counters.missed.fetch_add(wake.missed, Ordering::Relaxed);
        let mut sent = 0;
        let mut failed = Ok(());
        while sent < wake.steps {
            let burst = (wake.steps - sent).min(MAX_BURST as u32);
            states.send(burst as usize, |place, row| {
                let ordered = engine.take_orders(exchange);
                engine.save(ordered, exchange);
                let due_ns = started_ns + wake.due_ns(sent + place as u32);
                // In real time it waits for nobody; what the carrier fails with is told below.
                let begun = match external.before_step(&mut engine, exchange, due_ns) {
                    Ok(Ready::Tripped(trip)) => Some(trip),
                    Ok(Ready::Yes | Ready::NotYet) => None,
                    Err(error) => {
                        failed = Err(error);
                        None
                    }
                };
                let tripped = begun.or(engine.step());
                engine.fill(row, due_ns, wake.is_late);
                if let Some(trip) = tripped {
                    exchange.report_trip(trip, engine.tau());
                }
                if ordered || tripped.is_some() {
                    answering.unpark();
                }
            })?;
            std::mem::replace(&mut failed, Ok(()))?;
            sent += burst;
        }
        exchange.counters.count(&wake, engine.tau(), engine.speed());
        exchange.counters.reach(engine.largest_radius());
        exchange.measure(wake.lateness_ns, (clock.now_ns() - begun) / u64::from(wake.steps));
    }
    Ok(())
}
