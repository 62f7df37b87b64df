//! Run-ups and coast-downs: the transient response over speed, and the critical speeds that it shows beside those of the steady
//! response.
//!
//! The speed follows a profile, whatever torque that takes. What the stations do is read turn by turn ([`OrderTracker`]); critical
//! speeds are the peaks of the first order over each leg on which the speed changes ([`peaks`]).

mod peaks;

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{Machine, Pace, Program, ProgramError, Trip};
use rotor::circular::{self, Orbit};
use rotor::profile::{Leg, Profile};
use rotor::{C64, J, Rotor, Settings};

pub use peaks::{ResonancePeak, peaks};
pub use spectrum::{OrderTracker, Revolution};

use spectrum::{OrderSample, PER_TURN};

use crate::run::MOST_STEPS;

/// Readings of the first order that are kept for the search of peaks; beyond, only one in so many.
const MOST_READINGS: f64 = 2e5;
/// A beat is so many times as narrow as the critical speed whose passage it tells of.
const SHARPER: f64 = 2.0;
/// Peaks that are not so many turns wide are ripple.
const NARROW_TURNS: usize = 2;
/// Speeds at which the steady response is looked at over a leg, and then again about each of its peaks.
const STEADY_POINTS: usize = 400;

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

/// A critical speed: a peak of the first order at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct Critical {
    /// On which leg of the profile, counted from 0.
    pub leg: usize,
    /// At which station, counted from 0.
    pub station: usize,
    /// Where, how high and how sharp.
    pub peak: ResonancePeak,
    /// The peak of the steady response at this station that is nearest to it, if it is the nearest to that one too.
    pub steady: Option<ResonancePeak>,
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
    /// Control force, in `w0^2 e_t`.
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

    /// Runs it, and looks at every sample; `stop` is looked at now and then.
    ///
    /// # Errors
    /// A profile that cannot be stepped, one that takes too long, or `stop`.
    pub fn run(&self, see: &mut dyn FnMut(&Machine), stop: &AtomicBool) -> Result<RunUp, RunUpError> {
        let Self { rotor, settings, profile, dtau, .. } = self;
        let duration = profile.duration();
        let steps = (duration / dtau).ceil();
        if steps.is_nan() || steps > MOST_STEPS {
            return Err(RunUpError::TooLong(steps));
        }
        // An even step ends with the profile.
        let dtau = duration / steps.max(1.0);
        let ends = Settings { speed: profile.ends_at(), ..settings.clone() };
        let program = Program::compile_profile(rotor, &ends, profile, Pace { dtau, rate_hz: 0.0 })?;
        let mut machine = Machine::new(program);
        let orbit = steady_orbit(rotor, settings, profile.from);
        if let Some(orbit) = &orbit {
            let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| J * profile.from * c).collect();
            machine.place(&orbit.amplitude, &velocity);
        }
        let mut book = Book::new(self, rotor.len());
        let mut tripped = None;
        let mut course = profile.course();
        let mut leg = 0;
        see(&machine);
        book.see(&machine);
        let mut taken = 0;
        for step in 0..steps as u64 {
            if step % 4096 == 0 && stop.load(Ordering::Relaxed) {
                return Err(RunUpError::Interrupted);
            }
            let trip = machine.step();
            taken += 1;
            // Where a leg of a torque has led is known now.
            let sample = machine.sample();
            while profile.is_driven() && course.get(leg + 1).is_some_and(|(tau, _)| *tau <= sample.tau + 0.5 * dtau) {
                leg += 1;
                course[leg].1 = sample.speed;
            }
            see(&machine);
            if let Some(trip) = trip {
                let sample = machine.sample();
                tripped = Some((trip, sample.tau, sample.speed));
                break;
            }
            book.see(&machine);
        }
        Ok(RunUp {
            criticals: book.criticals(self, &course),
            course,
            largest: book.largest,
            points: book.points,
            began_steady: profile.from == 0.0 || orbit.is_some(),
            steps: taken,
            tripped,
        })
    }
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
    /// When each leg ends.
    ends: Vec<f64>,
    /// By leg.
    readings: Vec<Readings>,
    every: u64,
    count: u64,
    largest: Largest,
}

/// What was read over a leg: speeds, and of every station the first order and the rest.
#[derive(Clone, Debug, Default)]
struct Readings {
    speed: Vec<f64>,
    first: Vec<Vec<f64>>,
    rest: Vec<Vec<f64>>,
}

impl Readings {
    fn new(stations: usize) -> Self {
        let each = vec![Vec::new(); stations];
        Self { speed: Vec::new(), first: each.clone(), rest: each }
    }

    fn push(&mut self, turn: &Revolution) {
        self.speed.push(turn.speed);
        self.first.iter_mut().zip(&turn.first_order).for_each(|(to, first)| to.push(first.norm()));
        self.rest.iter_mut().zip(&turn.rest).for_each(|(to, rest)| to.push(*rest));
    }

    fn reverse(&mut self) {
        self.speed.reverse();
        self.first.iter_mut().chain(&mut self.rest).for_each(|of| of.reverse());
    }
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
            ends: course[1..].iter().map(|(tau, _)| *tau).collect(),
            readings: vec![Readings::new(stations); plan.profile.legs.len()],
            every: (turns * PER_TURN as f64 / MOST_READINGS).ceil().max(1.0) as u64,
            count: 0,
            largest: Largest::default(),
        }
    }

    fn see(&mut self, machine: &Machine) {
        let sample = machine.sample();
        let Self { tracker, readings, ends, every, count, largest, .. } = self;
        let read = OrderSample {
            tau: sample.tau,
            angle: sample.angle,
            speed: sample.speed,
            displacement: sample.displacement,
            velocity: sample.velocity,
            force: sample.outputs[0].delivered.norm(),
        };
        tracker.see(&read, |tracker| {
            *count += 1;
            let [ends_turn, is_kept] = [PER_TURN as u64, *every].map(|each| count.is_multiple_of(each));
            let Some(turn) = (ends_turn || is_kept).then(|| tracker.turn()).flatten() else { return };
            if ends_turn {
                largest.see(&turn, tracker.subsynchronous());
            }
            if is_kept {
                let leg = ends.iter().position(|end| turn.tau <= *end).unwrap_or(ends.len() - 1);
                readings[leg].push(&turn);
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

    fn criticals(&mut self, plan: &RunUpPlan, course: &[(f64, f64)]) -> Vec<Critical> {
        let mut criticals = Vec::new();
        // A whirl of its own ripples the first order from turn to turn: narrower than some turns, or less than the rest, is no
        // critical speed.
        let narrow = NARROW_TURNS * PER_TURN / self.every as usize;
        for (leg, readings) in self.readings.iter_mut().enumerate() {
            if matches!(plan.profile.legs[leg], Leg::Dwell { .. }) {
                continue;
            }
            let (from, to) = (course[leg].1, course[leg + 1].1);
            if from > to {
                readings.reverse();
            }
            // A drive that whirl holds back goes to and fro: there are no heights over speed.
            if matches!(plan.profile.legs[leg], Leg::Drive { .. }) && !readings.speed.is_sorted() {
                continue;
            }
            let steady = steady_peaks(plan, from, to);
            let first = criticals.len();
            for (station, height) in readings.first.iter().enumerate() {
                let mut found = peaks(&readings.speed, height);
                found.retain(|peak| peak.width >= narrow && readings.rest[station][peak.at] < peak.height);
                let steady = steady.get(station).map_or(&[][..], |peaks| peaks);
                drop_beats(&mut found, steady, from > to);
                for peak in &found {
                    // Each is the other's nearest.
                    let mine = nearest(steady, peak).filter(|s| nearest(&found, s).is_some_and(|p| p.at == peak.at));
                    criticals.push(Critical { leg, station, peak: *peak, steady: mine.copied() });
                }
            }
            criticals[first..].sort_by(|a, b| a.peak.speed.total_cmp(&b.peak.speed));
        }
        criticals
    }
}

/// Drops peaks that are the beat of a critical speed passed: no steady peak is theirs, and they are lower and much sharper than one before
/// them on the way.
fn drop_beats(found: &mut Vec<ResonancePeak>, steady: &[ResonancePeak], downward: bool) {
    let all = found.clone();
    let has_steady = |peak: &ResonancePeak| {
        nearest(steady, peak).and_then(|s| nearest(&all, s)).is_some_and(|mine| mine.at == peak.at)
    };
    let is_before = |a: &ResonancePeak, b: &ResonancePeak| if downward { a.speed > b.speed } else { a.speed < b.speed };
    let width = |peak: &ResonancePeak| peak.width as f64;
    found.retain(|peak| {
        has_steady(peak)
            || !all.iter().any(|other| {
                is_before(other, peak) && other.height > peak.height && width(other) > SHARPER * width(peak)
            })
    });
}

/// The one of `peaks` whose speed is nearest to that of `peak`.
fn nearest<'p>(peaks: &'p [ResonancePeak], peak: &ResonancePeak) -> Option<&'p ResonancePeak> {
    let distance = |p: &&ResonancePeak| (p.speed - peak.speed).abs();
    peaks.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Peaks of the steady response between two speeds, per station: along the stable orbits that lie nearest to each other in the
/// order in which the leg passes them. None where it cannot be had.
fn steady_peaks(plan: &RunUpPlan, from: f64, to: f64) -> Vec<Vec<ResonancePeak>> {
    let Some((speeds, heights)) = followed(plan, grid(from.min(to), from.max(to)), from > to) else {
        return Vec::new();
    };
    let refined = |station: usize, peak: ResonancePeak| {
        let [Some(low), Some(high)] = peak.half_power else { return peak };
        let margin = 0.5 * (high - low);
        let closer = followed(plan, grid((low - margin).max(0.0), high + margin), from > to);
        let found = closer.map(|(speeds, heights)| peaks(&speeds, &heights[station]));
        let near = |p: &ResonancePeak| (p.speed - peak.speed).abs();
        found.and_then(|found| found.into_iter().min_by(|a, b| near(a).total_cmp(&near(b)))).unwrap_or(peak)
    };
    let all = heights.iter().enumerate();
    all.map(|(station, height)| peaks(&speeds, height).into_iter().map(|peak| refined(station, peak)).collect())
        .collect()
}

/// The steady response over all speeds of a profile, as the way up finds it: speeds, and the radius of every station at each, not a
/// number where no orbit is stable. Nothing where it cannot be had, as of a sampled loop.
#[must_use]
pub fn steady_response(plan: &RunUpPlan) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let [low, high] = plan.profile.speeds();
    followed(plan, grid(low, high), false)
}

/// Evenly spaced speeds.
fn grid(low: f64, high: f64) -> Vec<f64> {
    (0..STEADY_POINTS).map(|k| low + (high - low) * k as f64 / (STEADY_POINTS - 1) as f64).collect()
}

/// Radii per station over rising `speeds`; `downward` says that the orbits are followed from the highest speed down. Not a number
/// where no orbit is stable.
fn followed(plan: &RunUpPlan, speeds: Vec<f64>, downward: bool) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let RunUpPlan { rotor, settings, .. } = plan;
    let found = circular::synchronous(rotor, &settings.feedback, &settings.deadband, &speeds).ok()?;
    let mut heights = vec![vec![f64::NAN; speeds.len()]; rotor.len()];
    let mut before: Option<Vec<f64>> = None;
    let mut order: Vec<usize> = (0..speeds.len()).collect();
    if downward {
        order.reverse();
    }
    for at in order {
        let stable = found.orbits[at].iter().filter(|orbit| orbit.is_stable()).map(Orbit::radii);
        let distance = |radii: &Vec<f64>| match &before {
            Some(before) => radii.iter().zip(before).map(|(a, b)| (a - b).powi(2)).sum::<f64>(),
            // The smallest comes first.
            None => 0.0,
        };
        let Some(radii) = stable.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { continue };
        heights.iter_mut().zip(&radii).for_each(|(height, radius)| height[at] = *radius);
        before = Some(radii);
    }
    Some((speeds, heights))
}
