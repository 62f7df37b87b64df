//! Run-ups and coast-downs: the transient response over speed, and the critical speeds that it shows beside those of the steady
//! response.
//!
//! The speed follows a profile, whatever torque that takes. What the stations do is read turn by turn ([`OrderTracker`]); critical
//! speeds are the peaks of the first order over each leg on which the speed changes ([`peaks`]).

mod criticals;
mod peaks;
mod recorded;

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{Machine, Pace, Program, ProgramError, Trip};
use rotor::circular::{self, Orbit};
use rotor::profile::{Leg, Profile};
use rotor::{C64, J, Rotor, Settings};

pub use criticals::Critical;
pub use peaks::{ResonancePeak, peaks};
pub use recorded::{RecordedCourse, RecordedLeg};
pub use spectrum::{OrderSample, OrderTracker, Revolution};

use spectrum::PER_TURN;

use criticals::{Course, Passed, Readings, followed, steady_grid};

use crate::run::MOST_STEPS;

/// A turn is read again after so many readings at least, an eighth of it: more would show nothing new.
const LEAST_APART: u64 = PER_TURN as u64 / 8;
/// Readings of the first order that are kept for the search of peaks; beyond, only one in so many.
const MOST_READINGS: f64 = 2e5;

/// What to run.
#[derive(Clone, Debug)]
pub struct RunUpPlan {
    /// The rotor.
    pub rotor: Rotor,
    /// Its settings but for the speed.
    pub settings: Settings,
    /// What the speed does.
    pub profile: Profile,
    /// Step of the integration, in `tau`.
    pub dtau: f64,
    /// How many points of the response are wanted, evenly over time.
    pub points: usize,
}

/// One point of the response.
#[derive(Clone, Debug, PartialEq)]
pub struct RunUpPoint {
    /// The last turn before it.
    pub turn: Revolution,
    /// Root mean square of what whirls more slowly than the spin, per station in `e_t`, over the last eight turns.
    pub subsynchronous: Option<Vec<f64>>,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct RunUp {
    /// The response, in order of time.
    pub points: Vec<RunUpPoint>,
    /// Critical speeds, leg by leg and rising in speed.
    pub criticals: Vec<Critical>,
    /// The largest of every turn of it.
    pub largest: Largest,
    /// Whether it began on the steady orbit of its first speed; otherwise from rest in the centre.
    pub began_steady: bool,
    /// When each leg began, in `tau`, and the speed then; and last, when all were over or it tripped.
    pub course: Vec<(f64, f64)>,
    /// Steps taken.
    pub steps: u64,
    /// What tripped it, when, and at which speed.
    pub tripped: Option<(Trip, f64, f64)>,
}

/// The largest of all turns: each with the speed at which it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// Radius of any station, in `e_t`.
    pub radius: (f64, f64),
    /// Root mean square of any station's whirl slower than the spin, in `e_t`.
    pub subsynchronous: (f64, f64),
    /// Control force, in `w0^2 e_t`; of several control bearings as that of the first ([`rotor::ControlMasses`]).
    pub force: (f64, f64),
}

impl Largest {
    fn see(&mut self, turn: &Revolution, subsynchronous: Option<Vec<f64>>) {
        let most = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
        let slow = subsynchronous.map_or(0.0, |slow| most(&slow));
        for (largest, value) in
            [(&mut self.radius, most(&turn.radius)), (&mut self.subsynchronous, slow), (&mut self.force, turn.force)]
        {
            if value > largest.0 {
                *largest = (value, turn.speed);
            }
        }
    }
}

/// Why there is no run-up.
#[derive(Debug, thiserror::Error)]
pub enum RunUpError {
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// It would take too long.
    #[error("{0:.1e} steps are too many: at most {MOST_STEPS:.0e}; a greater rate takes less time")]
    TooLong(f64),
    /// The profile cannot be stepped.
    #[error(transparent)]
    Profile(#[from] machine::ProfileError),
    /// The machine cannot be stepped.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

impl RunUpPlan {
    /// A plan with the step that suits all speeds of the profile.
    ///
    /// # Errors
    /// Settings that do not fit the rotor, or modes that cannot be found.
    pub fn new(rotor: Rotor, settings: Settings, profile: Profile, points: usize) -> Result<Self, ProgramError> {
        let dtau = machine::default_step_over(&rotor, &settings, profile.speeds())?;
        Ok(Self { rotor, settings, profile, dtau, points })
    }

    /// The settings while it runs: with the speed at which it ends, and a ramp that is no faster than it.
    #[must_use]
    pub fn settings_under_way(&self) -> Settings {
        Settings { speed: self.profile.ends_at(), ramp: self.profile.greatest_rate(), ..self.settings.clone() }
    }

    /// What is stepped, with an even step that ends with the profile, and how often.
    ///
    /// # Errors
    /// A profile that cannot be stepped, or takes too long.
    pub fn program(&self) -> Result<(Program, u64), RunUpError> {
        let duration = self.profile.duration();
        let steps = (duration / self.dtau).ceil();
        if steps.is_nan() || steps > MOST_STEPS {
            return Err(RunUpError::TooLong(steps));
        }
        let pace = Pace { dtau: duration / steps.max(1.0), rate_hz: 0.0 };
        let program = Program::compile_profile(&self.rotor, &self.settings_under_way(), &self.profile, pace)?;
        Ok((program, steps as u64))
    }

    /// Runs it, and looks at every sample; `stop` is looked at now and then.
    ///
    /// # Errors
    /// A profile that cannot be stepped, one that takes too long, or `stop`.
    pub fn run(&self, see: &mut dyn FnMut(&Machine), stop: &AtomicBool) -> Result<RunUp, RunUpError> {
        let Self { rotor, settings, profile, .. } = self;
        let (program, steps) = self.program()?;
        let dtau = profile.duration() / steps.max(1) as f64;
        let mut machine = Machine::new(program);
        let orbit = steady_orbit(rotor, settings, profile.from);
        if let Some(orbit) = &orbit {
            let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| J * profile.from * c).collect();
            machine.place(&orbit.amplitude, &velocity);
        }
        let mut book = Book::new(self, rotor.len());
        let mut tripped = None;
        let mut course = profile.course();
        let (mut leg, is_driven) = (0, profile.is_driven());
        see(&machine);
        book.see(&machine);
        let mut taken = 0;
        for step in 0..steps {
            if step % 4096 == 0 && stop.load(Ordering::Relaxed) {
                return Err(RunUpError::Interrupted);
            }
            let trip = machine.step();
            taken += 1;
            // Where a leg of a torque has led is known now.
            while is_driven && course.get(leg + 1).is_some_and(|(tau, _)| *tau <= machine.tau() + 0.5 * dtau) {
                leg += 1;
                course[leg].1 = machine.sample().speed;
            }
            see(&machine);
            if let Some(trip) = trip {
                let sample = machine.sample();
                tripped = Some((trip, sample.tau, sample.speed));
                break;
            }
            book.see(&machine);
        }
        if tripped.is_none() {
            book.end(&machine);
        }
        let criticals = book.readings.criticals(rotor, &passed(profile, &course), &|_| Some(settings), stop);
        if stop.load(Ordering::Relaxed) {
            return Err(RunUpError::Interrupted);
        }
        Ok(RunUp {
            criticals,
            course,
            largest: book.largest,
            points: book.points,
            began_steady: profile.from == 0.0 || orbit.is_some(),
            steps: taken,
            tripped,
        })
    }
}

/// The legs of a profile that went like this.
fn passed(profile: &Profile, course: &[(f64, f64)]) -> Vec<Passed> {
    let of = |(leg, ends): (&Leg, &[(f64, f64)])| Passed {
        until: ends[1].0,
        speed: [ends[0].1, ends[1].1],
        course: match leg {
            Leg::Dwell { .. } => Course::Rests,
            Leg::To { .. } | Leg::Decay { .. } => Course::Given,
            Leg::Drive { .. } => Course::Driven,
        },
    };
    profile.legs.iter().zip(course.windows(2)).map(of).collect()
}

/// The smallest stable steady orbit at a speed; none at rest, where the centre is.
fn steady_orbit(rotor: &Rotor, settings: &Settings, speed: f64) -> Option<Orbit> {
    if speed == 0.0 {
        return None;
    }
    let found = circular::synchronous(rotor, &settings.feedback, &settings.deadband, &[speed]).ok()?;
    found.orbits.into_iter().flatten().find(Orbit::is_stable)
}

/// Keeps what a run-up shows.
struct Book {
    tracker: OrderTracker,
    points: Vec<RunUpPoint>,
    /// When the next point is due, and how long it is between two.
    next: f64,
    apart: f64,
    readings: Readings,
    count: u64,
    largest: Largest,
}

impl Book {
    fn new(plan: &RunUpPlan, stations: usize) -> Self {
        let course = plan.profile.course();
        let turns: f64 = course.windows(2).map(|leg| (leg[1].0 - leg[0].0) * 0.5 * (leg[0].1 + leg[1].1)).sum::<f64>()
            / std::f64::consts::TAU;
        let apart = plan.profile.duration() / plan.points.max(1) as f64;
        Self {
            tracker: OrderTracker::new(stations),
            points: Vec::with_capacity(plan.points),
            next: apart,
            apart,
            readings: Readings::new(
                stations,
                ((turns * PER_TURN as f64 / MOST_READINGS).ceil() as u64).max(LEAST_APART),
            ),
            count: 0,
            largest: Largest::default(),
        }
    }

    /// Takes what has been since the last whole turn: what grows is largest at its end.
    fn end(&mut self, machine: &Machine) {
        let sample = machine.sample();
        if let Some(turn) = self.tracker.turn() {
            self.largest.see(&turn, self.tracker.subsynchronous());
        }
        let radius = sample.displacement.iter().map(|p| p.norm()).fold(0.0, f64::max);
        for (largest, value) in [(&mut self.largest.radius, radius), (&mut self.largest.force, machine.largest_force())]
        {
            if value > largest.0 {
                *largest = (value, sample.speed);
            }
        }
    }

    fn see(&mut self, machine: &Machine) {
        let sample = machine.sample();
        let Self { tracker, readings, count, largest, .. } = self;
        let read = OrderSample {
            tau: sample.tau,
            angle: sample.angle,
            speed: sample.speed,
            displacement: sample.displacement,
            velocity: sample.velocity,
            force: machine.largest_force(),
        };
        tracker.see(&read, |tracker| {
            *count += 1;
            let [ends_turn, is_kept] = [PER_TURN as u64, readings.every].map(|each| count.is_multiple_of(each));
            let Some(turn) = (ends_turn || is_kept).then(|| tracker.turn()).flatten() else { return };
            if ends_turn {
                largest.see(&turn, tracker.subsynchronous());
            }
            if is_kept {
                readings.push(&turn);
            }
        });
        if sample.tau >= self.next * (1.0 - 1e-12) {
            self.next += self.apart;
            if let Some(turn) = self.tracker.turn() {
                // A spin at rest shows nothing new.
                if self.points.last().is_none_or(|last| last.turn.tau < turn.tau) {
                    self.points.push(RunUpPoint { turn, subsynchronous: self.tracker.subsynchronous() });
                }
            }
        }
    }
}

/// The steady response over all speeds of a profile, as the way up finds it: speeds, and the radius of every station at each, not a
/// number where no orbit is stable. Nothing where it cannot be had, as of a sampled loop, and once `stop` is set.
#[must_use]
pub fn steady_response(plan: &RunUpPlan, stop: &AtomicBool) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let [low, high] = plan.profile.speeds();
    followed(&plan.rotor, &plan.settings, steady_grid(low, high), false, stop)
}
