//! `whirl measure`: the sensitivity of a running bench's loop as it is measured on a machine: tones are added to the command, and
//! what the command does is taken apart; beside it what is computed.

mod answer;
mod collect;
mod plan;

use std::io::{IsTerminal, Write as _};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use machine::MachineLoop;
use rotor::{Rotor, Settings};
use units::Dimension;
use wire::{BenchName, Change, Commander, HostState, Listener, SharedListener, SharedMemory, Step, WireError};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{self, Format, rounded};
use crate::picture;
use crate::place::Force;
use crate::quantity::{self, QuantityRange};
use crate::units::CommandUnits;
use collect::Collector;
use plan::{Amplitude, Bounds, Plan};

/// How long the bench may take to answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Silence after which we look whether the simulation still lives.
const SILENCE: Duration = Duration::from_millis(300);
/// How long, and how many steps, the motion is looked at before it is excited.
const LOOK: (Duration, u64) = (Duration::from_millis(300), 100);

/// Options of `whirl measure`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("written").multiple(true).args(["out"]))]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    bench: BenchArgs,
    /// Frequencies, each forward and backward, in radians per tau (SI rotors: in Hz) [default: up to twice the fastest mode]
    #[arg(long, value_name = "A..B", value_parser = quantity::range(Dimension::Frequency))]
    band: Option<QuantityRange>,
    /// How many tones of each direction, at most, evenly over the logarithm of frequency
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=32))]
    tones: u32,
    /// Amplitude of each tone, in w0^2 e_t (SI rotors: in N); or all of them together as a share of the present force, such as 2%
    #[arg(long, value_name = "U", default_value = "5%")]
    amplitude: Amplitude,
    /// How many periods are measured, after the machine has settled
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(2..=100))]
    periods: u32,
    /// Which phases: the same seed gives the same tones
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Draw it into a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// The bench that is measured, as it stood before.
struct Subject {
    rotor: Rotor,
    settings: Settings,
    units: CommandUnits,
    dtau: f64,
    rate_hz: f64,
    revision: u64,
    machine: MachineLoop,
    /// Largest orbit and mean force of late.
    radius: f64,
    present_force: f64,
}

impl Subject {
    /// Mass ratio of the mass that carries the first control bearing: the one that is excited and measured.
    fn bearing_mass(&self) -> f64 {
        self.rotor.control_mass(self.settings.feedback.first().station)
    }
}

/// Measures, and prints what came of it.
///
/// # Errors
/// No such bench, an excitation that is refused, a machine that changes or trips meanwhile, or too many steps lost.
pub(crate) fn run(args: &MeasureArgs) -> Result<(), Failure> {
    if let Some(path) = &args.out {
        picture::check(path, args.force)?;
    }
    let bench = args.bench.name()?;
    let stop = interrupt::flag()?;
    let carrier = attach::carrier("measure")?;
    let mut listener = attach::listen(&carrier, &bench)?;
    let mut commander = attach::command(&carrier, &bench)?;
    let subject = look(&mut listener, &bench, &stop)?;
    let bounds = Bounds { band: args.band, tones: args.tones, periods: args.periods, seed: args.seed };
    let plan = Plan::of(&subject, &bounds, args.amplitude)?;
    plan.warn(&subject);
    let change = Change::Excite(plan.multisine.clone());
    let who = format!("measure:{}", std::process::id());
    let request = change.request(&who, "to measure the loop")?;
    let asked = commander.ask(&request, PATIENCE)?;
    if !asked.is_accepted() {
        return Err(Failure::Work(format!("not measured: {}", asked.reason.as_str())));
    }
    let mut collector = Collector::new(&plan, &subject, asked.applied_at_step);
    let progress = Progress::new(&plan, &subject);
    let collected = collect(&mut listener, &mut collector, &bench, &stop, &progress);
    progress.end();
    if let Err(failure) = collected {
        end(&mut commander, &who);
        return Err(failure);
    }
    let measured = collector.finish(&plan, &subject, asked.tau).map_err(Failure::Work)?;
    if let Some(path) = &args.out {
        picture::draw(path, args.force, &answer::charts(&subject, &measured)?)?;
    }
    answer::print(&subject, &plan, &measured, args.format)
}

/// Ends the excitation; where that fails it ends by itself.
fn end(commander: &mut <SharedMemory as wire::Carrier>::Commander, who: &str) {
    if let Ok(request) = Change::EndExcitation.request(who, "given up") {
        let _ = commander.ask(&request, PATIENCE);
    }
}

/// How the bench stands, and how far it moves, over a moment.
fn look(listener: &mut SharedListener, bench: &BenchName, stop: &AtomicBool) -> Result<Subject, Failure> {
    let status = attach::first_bench_status(listener, bench)?;
    let work = |error: &dyn std::fmt::Display| Failure::Work(error.to_string());
    let rotor = status.rotor().map_err(|error| work(&error))?;
    let settings = status.settings.get().clone();
    let machine = MachineLoop::at(&rotor, &settings, settings.speed)?;
    let (mut seen, mut radius, mut forces) = (0, 0.0_f64, 0.0);
    let see = |state: &wire::StepRow<'_>| {
        radius = radius.max(state.largest_radius());
        let [y, z] = state.force_delivered();
        forces += y.hypot(z);
    };
    attach::look_at_motion(listener, see, |passed, steps| {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        if steps == 0 && passed > PATIENCE {
            return Err(WireError::NoAnswer(bench.clone()).into());
        }
        seen = steps;
        Ok(passed < LOOK.0 || steps < LOOK.1)
    })?;
    Ok(Subject {
        units: CommandUnits::with(status.scales()),
        dtau: status.dtau,
        rate_hz: status.rate_hz,
        revision: status.revision,
        present_force: forces / seen as f64,
        rotor,
        settings,
        machine,
        radius,
    })
}

/// Takes in steps until all are there.
fn collect(
    listener: &mut SharedListener,
    collector: &mut Collector,
    bench: &BenchName,
    stop: &AtomicBool,
    progress: &Progress,
) -> Result<(), Failure> {
    let mut heard = Instant::now();
    while !collector.is_full() {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        let mut changed = Ok(());
        let came = listener.drain(|state| {
            if changed.is_ok() {
                changed = collector.take(&state);
            }
        })?;
        changed.map_err(Failure::Work)?;
        if came > 0 {
            heard = Instant::now();
            progress.say(collector.seen());
        } else if heard.elapsed() > SILENCE {
            if listener.host() == HostState::Gone {
                return Err(WireError::NoBench(bench.clone()).into());
            }
            heard = Instant::now();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(())
}

/// How far it has come, for people who look at it.
struct Progress {
    is_shown: bool,
    steps: u64,
    rate_hz: f64,
}

impl Progress {
    /// Says how long it takes.
    fn new(plan: &Plan, subject: &Subject) -> Self {
        let made = Self { is_shown: std::io::stderr().is_terminal(), steps: plan.steps(), rate_hz: subject.rate_hz };
        if made.is_shown {
            output::warn(&format!(
                "measuring for {} s: {} tones, {} s until the machine has settled",
                rounded(plan.steps() as f64 / subject.rate_hz),
                plan.tones.len(),
                rounded(plan.settle as f64 / subject.rate_hz)
            ));
        }
        made
    }

    fn say(&self, seen: u64) {
        if self.is_shown {
            let [seen, all] = [seen, self.steps].map(|steps| steps as f64 / self.rate_hz);
            // Progress that cannot be shown is not missed.
            let _ = write!(std::io::stderr(), "\r\x1b[K{seen:.0} of {all:.0} s");
        }
    }

    /// Wipes the line.
    fn end(&self) {
        if self.is_shown {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}
