//! One simulation from rest, offline, as fast as it goes.

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{Machine, PolesError, Program, ProgramError, default_step};
use rotor::{C64, ControlMasses, Feedback, Peaks, PoleError, Rotor, Settings};

use crate::disturbance::{self, DisturbanceGrowth};
use crate::settle::{Detector, Stretch};

pub use crate::settle::Settled;

/// An orbit this wide is taken for divergence, in `e_t`, beside a thousand times the largest clearance.
const DIVERGED: f64 = 1e6;
/// More steps than this are refused: a quarter of an hour of computing.
pub const MOST_STEPS: f64 = 1e10;

/// A sudden change of velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Which mass, counted from 0.
    pub mass: usize,
    /// The change, in `e_t` per unit of `tau`.
    pub change: C64,
    /// When, in `tau` from the start.
    pub at: f64,
}

/// From where on maxima and means are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settle {
    /// From this `tau` on.
    From(f64),
    /// From where transients have died, see [`Settled`]; the run goes on to its end all the same.
    Detect,
    /// The same, and the run ends there.
    DetectAndStop,
}

/// What to simulate.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The machine and what it does, compiled for steps of `dtau`.
    pub program: Program,
    /// Displacement and velocity of every place where it begins; `None` is rest.
    pub start: Option<[Vec<C64>; 2]>,
    /// Impulses, in any order; those after the end are never felt.
    pub impulses: Vec<Impulse>,
    /// The longest step, no longer than the program's. Steps are even between impulses, so a little shorter where they would not fit.
    pub dtau: f64,
    /// Length of the run in `tau`.
    pub duration: f64,
    /// From where on maxima are taken.
    pub settle: Settle,
}

/// Where the rotor is when a run ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Final {
    /// Dimensionless time.
    pub tau: f64,
    /// Spin speed `R`.
    pub speed: f64,
    /// Displacement of every mass, in `e_t`.
    pub displacement: Vec<C64>,
    /// Velocity of every mass, in `e_t` per unit of `tau`.
    pub velocity: Vec<C64>,
}

/// What came out. Every number in it is finite, but for the final state of a run that overflowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Steps taken.
    pub steps: u64,
    /// At how many of them the actuator was at its limit of force or of rate.
    pub saturated_steps: u64,
    /// When the orbit left all bounds; the run ends there.
    pub diverged_at: Option<f64>,
    /// The longest and the shortest of the steps taken: they are even between impulses. Zero without any.
    pub step: (f64, f64),
    /// Whether transients had died.
    pub settled: Settled,
    /// Whether the motion at the end would stay, if it is steady: settled, or on a circular orbit.
    pub stability: Option<DisturbanceGrowth>,
    /// Whether the rotor at rest in its centre would stay, support bearings with clearance out of action; `None` where amplifiers differ along
    /// the axes.
    pub centre: Option<DisturbanceGrowth>,
    /// From where on maxima and means are taken. If nothing settled, from the middle of the run.
    pub maxima_from: f64,
    /// Largest `|u|`, in `w0^2 e_t`; of several control bearings as that of the first ([`rotor::ControlMasses`]).
    pub max_force: f64,
    /// The larger of the largest `|u_y|` and `|u_z|`.
    pub max_force_component: f64,
    /// Largest radius of every mass, in `e_t`.
    pub max_displacement: Vec<f64>,
    /// Mean radius of every mass, in `e_t`.
    pub mean_radius: Vec<f64>,
    /// The last state.
    pub last: Final,
}

/// Looks at every sample of a run: at the start, after every step, and before and after every impulse.
pub trait Observer {
    /// One sample: the machine as it is.
    ///
    /// # Errors
    /// Whatever keeps it from going on; the run ends there.
    fn sample(&mut self, machine: &Machine) -> std::io::Result<()>;

    /// An impulse comes, of which the next sample is the first to show. After the last of several at once there is one sample.
    ///
    /// # Errors
    /// As [`Observer::sample`].
    fn impulse(&mut self, _: &Impulse) -> std::io::Result<()> {
        Ok(())
    }

    /// A stretch of even steps begins, of [`Machine::dtau`] each.
    ///
    /// # Errors
    /// As [`Observer::sample`].
    fn stretch(&mut self, _: &Machine) -> std::io::Result<()> {
        Ok(())
    }
}

/// Why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// It would take too long.
    #[error("{0:.1e} steps are too many: at most {MOST_STEPS:.0e}")]
    TooLong(f64),
    /// An observer failed.
    #[error(transparent)]
    Observer(#[from] std::io::Error),
    /// The eigenvalues that tell stability could not be found.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// The poles of a loop with states of its own could not be found.
    #[error(transparent)]
    LoopPoles(#[from] PolesError),
}

/// Simulates `plan` from its start, showing every sample to `observers`. `stop` is looked at now and then.
///
/// # Errors
/// A plan of too many steps, an observer that fails, eigenvalues that do not converge, or `stop`.
pub fn run(plan: &Plan, observers: &mut [&mut dyn Observer], stop: &AtomicBool) -> Result<Outcome, RunError> {
    let (mut rotor, watch) = simulate(plan, observers, stop)?;
    let centre = disturbance::of_centre(&plan.program, rotor.sample().speed)?;
    let mut outcome = watch.outcome(&rotor, centre);
    if outcome.diverged_at.is_none() {
        outcome.stability = stability(&plan.program, &mut rotor, outcome.settled, outcome.step.0, stop)?;
    }
    Ok(outcome)
}

/// Whether the motion that a run has ended in would stay, if it is steady.
pub(crate) fn stability(
    program: &Program,
    rotor: &mut Machine,
    settled: Settled,
    dtau: f64,
    stop: &AtomicBool,
) -> Result<Option<DisturbanceGrowth>, RunError> {
    if !rotor.motion().is_finite() {
        return Ok(None);
    }
    let on_circle = disturbance::of_orbit(program, rotor)?;
    if on_circle.is_some() || !matches!(settled, Settled::Steady | Settled::Beating) {
        return Ok(on_circle);
    }
    Ok(Some(disturbance::of_beat(rotor, dtau, stop).ok_or(RunError::Interrupted)?))
}

/// How large a motion gets: what a map has of a run, without asking whether it would stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Whether transients had died.
    pub settled: Settled,
    /// When the orbit left all bounds.
    pub diverged_at: Option<f64>,
    /// Largest `|u|`, in `w0^2 e_t`.
    pub max_force: f64,
    /// Largest radius of any mass, in `e_t`.
    pub max_displacement: f64,
}

/// Simulates `plan` from its start, and says how large its motion is.
///
/// # Errors
/// A plan of too many steps, or `stop`.
pub fn extent(plan: &Plan, stop: &AtomicBool) -> Result<Extent, RunError> {
    let (_, watch) = simulate(plan, &mut [], stop)?;
    let (diverged_at, masses) = (watch.diverged_at, watch.masses);
    let (settled, kept) = watch.kept();
    Ok(Extent::of(settled, diverged_at, &kept, masses))
}

impl Extent {
    pub(crate) fn of(settled: Settled, diverged_at: Option<f64>, kept: &Stretch, masses: usize) -> Self {
        Self {
            settled,
            diverged_at,
            max_force: kept.maxima[0].sqrt(),
            max_displacement: kept.maxima[3..3 + masses].iter().copied().fold(0.0, f64::max).sqrt(),
        }
    }
}

/// The radius beyond which a run has diverged, in `e_t`.
pub(crate) fn orbit_limit(plan: &Plan) -> f64 {
    DIVERGED + 1e3 * plan.program.clearances().iter().copied().fold(0.0, f64::max)
}

/// How long the windows are in which a run is looked at: whole turns.
pub(crate) fn window_of(plan: &Plan) -> f64 {
    let turn = std::f64::consts::TAU / plan.program.speed().abs();
    // Rest needs no turns; a crawling spin is cut off.
    let window = if turn.is_finite() { (turn * (8.0 / turn).ceil()).min(200.0) } else { 8.0 };
    window.max(8.0)
}

/// Whether transients had died, and the stretch that maxima are of, which `rest` ends.
pub(crate) fn kept(settle: Settle, detector: &Detector, rest: Stretch, has_diverged: bool) -> (Settled, Stretch) {
    let (settled, kept) = match settle {
        Settle::From(from) => (Settled::Given, Stretch { from, ..rest }),
        Settle::Detect | Settle::DetectAndStop => {
            let (settled, windows) = detector.result();
            (settled, windows.map_or(rest, |windows| windows.joined(&rest)))
        }
    };
    (if has_diverged && settled != Settled::Given { Settled::No } else { settled }, kept)
}

fn simulate(plan: &Plan, observers: &mut [&mut dyn Observer], stop: &AtomicBool) -> Result<(Machine, Watch), RunError> {
    let steps = plan.duration / plan.dtau;
    if steps.is_nan() || steps > MOST_STEPS {
        return Err(RunError::TooLong(steps));
    }
    let mut rotor = Machine::new(plan.program.clone());
    if let Some([displacement, velocity]) = &plan.start {
        rotor.place(displacement, velocity);
    }
    let mut watch = Watch::new(plan);
    let mut impulses: Vec<Impulse> = plan.impulses.iter().copied().filter(|i| i.at <= plan.duration).collect();
    impulses.sort_by(|a, b| a.at.total_cmp(&b.at));
    let mut impulses = impulses.into_iter().peekable();

    while let Some(impulse) = impulses.next_if(|i| i.at <= 0.0) {
        observers.iter_mut().try_for_each(|observer| observer.impulse(&impulse))?;
        rotor.kick(impulse.mass, impulse.change);
    }
    let mut going = watch.see(&rotor, observers)?;
    let mut now = 0.0;
    while going && now < plan.duration {
        let until = impulses.peek().map_or(plan.duration, |i| i.at);
        let (count, dtau) = plan.even_steps(until - now);
        watch.step = if watch.steps == 0 { (dtau, dtau) } else { (watch.step.0.max(dtau), watch.step.1.min(dtau)) };
        watch.peaks.break_off();
        rotor.pace(dtau);
        observers.iter_mut().try_for_each(|observer| observer.stretch(&rotor))?;
        for i in 0..count as u64 {
            if i % 4096 == 0 && stop.load(Ordering::Relaxed) {
                return Err(RunError::Interrupted);
            }
            rotor.step_by(dtau);
            watch.steps += 1;
            going = watch.see(&rotor, observers)?;
            if !going {
                break;
            }
        }
        now = until;
        let mut kicked = false;
        while let Some(impulse) = impulses.next_if(|i| going && i.at <= now) {
            observers.iter_mut().try_for_each(|observer| observer.impulse(&impulse))?;
            rotor.kick(impulse.mass, impulse.change);
            kicked = true;
        }
        if kicked {
            watch.peaks.break_off();
            going = watch.see(&rotor, observers)?;
        }
    }
    Ok((rotor, watch))
}

impl Plan {
    /// `rotor` under `feedback` at a steady speed, with one clearance a mass (missing ones count as none), for `duration`
    /// without impulses, in steps that are accurate.
    ///
    /// # Errors
    /// Feedback that does not fit, or modes that cannot be found.
    pub fn steady(
        rotor: &Rotor,
        feedback: &Feedback,
        speed: f64,
        clearances: &[f64],
        duration: f64,
        settle: Settle,
    ) -> Result<Self, ProgramError> {
        let mut settings = Settings::new(rotor, speed, feedback.clone());
        let given = clearances.iter().copied().chain(std::iter::repeat(0.0));
        settings.deadband.iter_mut().zip(given).for_each(|(place, clearance)| *place = clearance);
        let dtau = default_step(rotor, &settings)?;
        let program = Program::in_substeps(rotor, &settings, dtau, 1)?;
        Ok(Self { program, start: None, impulses: Vec::new(), dtau, duration, settle })
    }

    /// How many even steps of at most [`Plan::dtau`] make up a stretch of time, and how long each is.
    pub(crate) fn even_steps(&self, stretch: f64) -> (f64, f64) {
        let count = (stretch / self.dtau - 1e-9).ceil().max(1.0);
        (count, stretch / count)
    }

    /// The longest step that is taken: [`Plan::dtau`], or a little less where that does not fit.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        let mut ends: Vec<f64> =
            self.impulses.iter().map(|i| i.at).filter(|at| (0.0..self.duration).contains(at)).collect();
        ends.push(self.duration);
        ends.sort_by(f64::total_cmp);
        let mut from = 0.0;
        let mut longest = 0.0_f64;
        for end in ends {
            if end > from {
                longest = longest.max(self.even_steps(end - from).1);
            }
            from = end;
        }
        longest
    }
}

/// Keeps the books of a run.
struct Watch {
    masses: usize,
    control_masses: ControlMasses,
    settle: Settle,
    window: f64,
    limit_squared: f64,
    stretch: Stretch,
    peaks: Peaks,
    detector: Detector,
    steps: u64,
    saturated_steps: u64,
    step: (f64, f64),
    diverged_at: Option<f64>,
}

impl Watch {
    fn new(plan: &Plan) -> Self {
        let masses = plan.program.order();
        Self {
            masses,
            control_masses: *plan.program.control_masses(),
            settle: plan.settle,
            window: window_of(plan),
            limit_squared: orbit_limit(plan).powi(2),
            stretch: Stretch::new(0.0),
            peaks: Peaks::new(3 + masses),
            detector: Detector::new(masses),
            steps: 0,
            saturated_steps: 0,
            step: (0.0, 0.0),
            diverged_at: None,
        }
    }

    /// Takes one sample; whether the run goes on.
    fn see(&mut self, rotor: &Machine, observers: &mut [&mut dyn Observer]) -> std::io::Result<bool> {
        let motion = rotor.motion();
        let outputs = rotor.outputs();
        self.saturated_steps += u64::from(outputs.iter().any(|output| output.saturated));
        let mut samples = [0.0; 3 + rotor::MAX_MASSES];
        for (bearing, output) in outputs.iter().enumerate() {
            let u = output.delivered * self.control_masses.as_of_first(bearing, 1.0);
            // Of several control bearings the largest; what is not a number must not be lost in it.
            for (place, square) in samples.iter_mut().zip([u.norm_sqr(), u.re * u.re, u.im * u.im]) {
                *place = if square.is_nan() { square } else { place.max(square) };
            }
        }
        let mut widest = 0.0_f64;
        for (sample, p) in samples[3..].iter_mut().zip(motion.displacement) {
            *sample = p.norm_sqr();
            widest = if sample.is_nan() { f64::INFINITY } else { widest.max(*sample) };
        }
        let bounded = widest <= self.limit_squared && samples[0].is_finite();
        if !bounded {
            self.diverged_at = Some(motion.tau);
        }
        if bounded && !matches!(self.settle, Settle::From(from) if motion.tau < from - 1e-9) {
            let all = 3 + self.masses;
            self.peaks.push(&samples[..all], &mut self.stretch.maxima[..all]);
            for (sum, squared) in self.stretch.radius_sum.iter_mut().zip(&samples[3..all]) {
                *sum += squared.sqrt();
            }
            self.stretch.samples += 1;
        }
        if !observers.is_empty() && motion.is_finite() {
            observers.iter_mut().try_for_each(|observer| observer.sample(rotor))?;
        }
        if !matches!(self.settle, Settle::From(_)) && motion.tau >= self.stretch.from + self.window {
            let window = std::mem::replace(&mut self.stretch, Stretch::new(motion.tau));
            let settled = self.detector.push(window);
            if settled && self.settle == Settle::DetectAndStop {
                return Ok(false);
            }
        }
        Ok(bounded)
    }

    /// Whether transients had died, and the stretch that maxima are of.
    fn kept(&self) -> (Settled, Stretch) {
        kept(self.settle, &self.detector, self.stretch, self.diverged_at.is_some())
    }

    fn outcome(&self, rotor: &Machine, centre: Option<DisturbanceGrowth>) -> Outcome {
        let motion = rotor.motion();
        let (steps, saturated_steps, step) = (self.steps, self.saturated_steps, self.step);
        let (masses, diverged_at) = (self.masses, self.diverged_at);
        let (settled, kept) = self.kept();
        Outcome {
            steps,
            saturated_steps,
            step,
            diverged_at,
            settled,
            stability: None,
            centre,
            maxima_from: kept.from,
            max_force: kept.maxima[0].sqrt(),
            // Each maximum is that of a curve through samples: where one bends sharply, a part must not pass the whole.
            max_force_component: kept.maxima[1].max(kept.maxima[2]).min(kept.maxima[0]).sqrt(),
            max_displacement: kept.maxima[3..3 + masses].iter().map(|m| m.sqrt()).collect(),
            mean_radius: (0..masses).map(|k| kept.mean_radius(k)).collect(),
            last: Final {
                tau: motion.tau,
                speed: rotor.sample().speed,
                displacement: motion.displacement.to_vec(),
                velocity: motion.velocity.to_vec(),
            },
        }
    }
}
