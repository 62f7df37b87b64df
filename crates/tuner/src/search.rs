//! Multistart: many climbs from random gains, the best of them polished, checked and proven.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use rotor::Feedback;

use crate::certify::{self, Certificate, certify};
use crate::conditions::{counts, hardest_places, tightest_places, worst_margins, worst_places};
use crate::evaluate::{EXCESS, Evaluator, worst_at};
use crate::limits::force_at;
use crate::minimax::{Stationarity, polish, stationarity};
use crate::proven_peak::peak_below;
use crate::stop::Stop;
use crate::{Family, LoopMargins, Problem, ProblemError, powell, smooth};

/// How a climb goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Smoothing continuation with slopes, then sequential convex steps: see [`crate::smooth`] and [`crate::minimax`].
    #[default]
    Nonsmooth,
    /// Powell's direction sets, as in the report.
    Powell,
}

/// How much is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// How a climb goes.
    pub method: Method,
    /// How many climbs; at least 1.
    pub starts: usize,
    /// What random numbers start from. The same seed gives the same answer, whatever the number of threads.
    pub seed: u64,
    /// Random gains are drawn evenly from `-spread` to `spread`, of shaft elements around the template's, never beyond the bound.
    pub spread: f64,
    /// How sharply the worst over a continuous family is to be bounded, see [`Certificate::tolerance`].
    pub tolerance: f64,
    /// Gains to start from beside the random ones: the first climbs.
    pub first: Vec<Vec<f64>>,
    /// Whether the worst is to be proven; otherwise the answer has the worst that was found.
    pub prove: bool,
    /// How many threads climb; all cores if not said. The answer does not depend on it.
    pub threads: Option<usize>,
}

impl Options {
    /// What suits a problem: more starts and wider ones the more there is to get wrong. Over a range of speeds every start with
    /// four gains ends at the same value; with eight gains, one in two or three does.
    #[must_use]
    pub fn for_problem(problem: &Problem) -> Self {
        let conditions = problem.family.varying().count();
        let starts = match (conditions, problem.structure.variables()) {
            (0, 0..=4) => 8,
            (0, _) => 24,
            (1, 0..=4) => 4,
            (1, _) => 32,
            _ => 16,
        };
        let own = problem.structure.own();
        if !problem.structure.is_chain() {
            // What there is comes first, and the others begin around it.
            return Self { starts: STARTS_OF_SHAFTS, spread: 0.5, first: vec![own], ..Self::plain(starts) };
        }
        let spread = if problem.structure.variables() <= 4 { 1.0 } else { problem.bound.min(5.0) };
        Self { spread, ..Self::plain(starts) }
    }

    fn plain(starts: usize) -> Self {
        Self {
            method: Method::Nonsmooth,
            starts,
            seed: 1,
            spread: 1.0,
            tolerance: 1e-4,
            first: Vec::new(),
            prove: true,
            threads: None,
        }
    }
}

/// How a search is going.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Climbs that have ended.
    pub done: usize,
    /// Climbs in all.
    pub starts: usize,
    /// The best worst value so far.
    pub best: f64,
    /// Since the search began.
    pub elapsed: Duration,
}

impl Progress {
    /// How long the rest will take if it goes on like this.
    #[must_use]
    pub fn left(&self) -> Option<Duration> {
        (self.done > 0).then(|| self.elapsed.mul_f64((self.starts - self.done) as f64 / self.done as f64))
    }
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The gains: the variables of the structure.
    pub gains: Vec<f64>,
    /// The feedback with those gains.
    pub feedback: Feedback,
    /// The worst over the family: what, where, and whether that is proven.
    pub worst: Certificate,
    /// The largest steady control force of the linear rotor under its unbalance found in the family, in `w0^2 e_t`.
    pub force: f64,
    /// Where it is, in the coordinates of the family's axes.
    pub force_at: Vec<f64>,
    /// Where margins are asked for: those where the peak of the sensitivity is largest, and those where the delay margin is smallest,
    /// each with its condition.
    pub margins: Option<[(LoopMargins, Vec<f64>); 2]>,
    /// Where the peak of the sensitivity is limited: what no condition of the whole family exceeds. `None` where that is not proven.
    pub peak_below: Option<f64>,
    /// How near to a local optimum they are.
    pub stationarity: Stationarity,
    /// The modes that hold the value, at their conditions.
    pub active: Vec<Active>,
    /// What every climb ended with, best first.
    pub values: Vec<f64>,
    /// How many eigenvalue problems were solved.
    pub evaluations: u64,
    /// How long it took.
    pub elapsed: Duration,
    /// Whether it was stopped before its end.
    pub interrupted: bool,
}

impl Tuned {
    /// The largest peak of the sensitivity, where margins were asked for.
    #[must_use]
    pub fn peak_sensitivity(&self) -> Option<f64> {
        self.margins.as_ref().map(|[(margins, _), _]| margins.sensitivity.0)
    }

    /// The largest magnitude of any gain.
    #[must_use]
    pub fn largest_gain(&self) -> f64 {
        self.gains.iter().fold(0.0, |most, gain| gain.abs().max(most))
    }
}

/// A mode near the worst value.
#[derive(Clone, Debug, PartialEq)]
pub struct Active {
    /// The condition, in the coordinates of the family's axes.
    pub point: Vec<f64>,
    /// The pole.
    pub pole: rotor::C64,
    /// What it is worth.
    pub value: f64,
}

/// Points of the first grid, of the scan for what it has missed, and of the last scan.
pub(crate) const COARSE: usize = 30;
pub(crate) const FINE: usize = 300;
const FINEST: usize = 4000;
/// Of the last scan where the loop is more than gains: its poles take ten to a thousand times as long, and what lies between
/// two points is walked down to.
const FINEST_AROUND: usize = 600;
/// Climbs of a rotor of shaft elements: one from the template's gains, others from around them.
const STARTS_OF_SHAFTS: usize = 4;
/// Rounds of adding conditions that turned out to be worse.
const ROUNDS: usize = 8;
/// Poles nearer than this, relative to their size, are treated as a merging pair.
const MERGE: f64 = 0.02;
/// How near the worst, relative to it, a value counts as active.
const ACTIVE: f64 = 1e-6;

/// One climb: what it ended with.
struct Climb {
    value: f64,
    gains: Vec<f64>,
    points: Vec<Vec<f64>>,
}

/// Searches.
///
/// # Errors
/// A problem that makes no sense.
pub fn tune(
    problem: &Problem,
    options: &Options,
    progress: &(dyn Fn(&Progress) + Sync),
    stop: Stop,
) -> Result<Tuned, ProblemError> {
    problem.check()?;
    // Threads of its own, if they can be had: what cannot be made is no reason not to search.
    match options.threads.map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build()) {
        Some(Ok(pool)) => Ok(pool.install(|| search(problem, options, progress, stop))),
        _ => Ok(search(problem, options, progress, stop)),
    }
}

fn search(problem: &Problem, options: &Options, progress: &(dyn Fn(&Progress) + Sync), stop: Stop) -> Tuned {
    let begun = Instant::now();
    let evaluations = AtomicU64::new(0);
    let so_far =
        Mutex::new(Progress { done: 0, starts: options.starts, best: f64::NEG_INFINITY, elapsed: Duration::ZERO });
    let climb = |start: usize| {
        // Once stopped, only the first climb still counts: there must be an answer.
        if stop.is_set() && start > 0 {
            return None;
        }
        let climb = climb(problem, options, start, &evaluations, &stop);
        if let Ok(mut so_far) = so_far.lock() {
            so_far.done += 1;
            so_far.best = so_far.best.max(climb.value);
            so_far.elapsed = begun.elapsed();
            progress(&so_far);
        }
        Some(climb)
    };
    // In place on one thread: a single climb is not worth waking others for.
    let mut climbs: Vec<Climb> = if options.starts == 1 {
        climb(0).into_iter().collect()
    } else {
        (0..options.starts).into_par_iter().map(climb).collect::<Vec<_>>().into_iter().flatten().collect()
    };
    climbs.sort_by(|a, b| b.value.total_cmp(&a.value));
    let values = climbs.iter().map(|climb| climb.value).collect();
    let best = climbs.swap_remove(0);
    let mut tuned = prove(problem, options, best, &evaluations, &stop, options.method == Method::Nonsmooth);
    tuned.values = values;
    tuned.evaluations = evaluations.into_inner();
    tuned.elapsed = begun.elapsed();
    tuned
}

/// Judges given gains as if a search had found them: the worst over the family, and how near to an optimum they are.
///
/// # Errors
/// A problem that makes no sense.
pub fn evaluate(problem: &Problem, options: &Options, gains: &[f64], stop: Stop) -> Result<Tuned, ProblemError> {
    problem.check()?;
    let begun = Instant::now();
    let evaluations = AtomicU64::new(0);
    let points = problem.family.grid(&counts(&problem.family, problem.points(COARSE)));
    let climb = Climb { value: 0.0, gains: gains.to_vec(), points };
    let mut tuned = prove(problem, options, climb, &evaluations, &stop, false);
    tuned.evaluations = evaluations.into_inner();
    tuned.elapsed = begun.elapsed();
    Ok(tuned)
}

/// Bounds the worst over the family for given gains, from `point` on, which is known to be bad: looks at up to `budget` boxes of
/// conditions. Nothing is searched beside what boxes show.
///
/// # Errors
/// A problem that makes no sense.
pub fn bound(
    problem: &Problem,
    gains: &[f64],
    point: &[f64],
    tolerance: f64,
    budget: u64,
    stop: Stop,
) -> Result<Certificate, ProblemError> {
    problem.check()?;
    Ok(certify(problem, gains, point, tolerance, budget, &stop))
}

/// The gains that climb `start` begins with.
fn first_gains(problem: &Problem, options: &Options, start: usize) -> Vec<f64> {
    if let Some(gains) = options.first.get(start) {
        return gains.clone();
    }
    // Each climb has a stream of its own, so that it does not matter who runs it.
    let mut random =
        fastrand::Rng::with_seed(options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(start as u64));
    let spread = options.spread.min(problem.bound);
    // Every knot of a gain begins alike: a schedule departs from constant gains.
    let knots = problem.structure.schedule().knots();
    let gains = problem.structure.gains();
    let around = match problem.structure.is_chain() {
        true => vec![0.0; gains * knots],
        false => problem.structure.own(),
    };
    let mut draw = |around: &[f64]| {
        let by = spread * (2.0 * random.f64() - 1.0);
        around.iter().map(|gain| (gain + by).clamp(-problem.bound, problem.bound)).collect::<Vec<f64>>()
    };
    around.chunks_exact(knots).flat_map(&mut draw).collect()
}

fn climb(problem: &Problem, options: &Options, start: usize, evaluations: &AtomicU64, stop: &Stop) -> Climb {
    let mut gains = first_gains(problem, options, start);
    let family = &problem.family;
    let mut points = family.grid(&counts(family, problem.points(COARSE)));
    let mut evaluator = Evaluator::new(problem, &points).until(*stop);
    match options.method {
        Method::Powell => powell::climb(&mut evaluator, &mut gains, stop),
        Method::Nonsmooth => {
            smooth::climb(&mut evaluator, &mut gains, stop);
            improve(&mut evaluator, &mut gains, 0.05, stop);
        }
    }
    let fine = counts(family, problem.points(FINE));
    let mut value = exchange(&mut evaluator, &mut points, &mut gains, &fine, options.method, stop);
    if family.varying().next().is_none() {
        value = value.min(evaluator.merit(&gains));
    }
    evaluations.fetch_add(evaluator.evaluations, Ordering::Relaxed);
    Climb { value, gains, points }
}

/// The end phase: plain, then with merging pairs.
pub(crate) fn improve(evaluator: &mut Evaluator, gains: &mut Vec<f64>, radius: f64, stop: &Stop) {
    polish(evaluator, gains, [radius, 1e-6], 0.0, stop);
    polish(evaluator, gains, [0.2 * radius, 1e-11], MERGE, stop);
}

/// Adds the worst places between the conditions and improves the gains at all, until there are no worse places. Gives the
/// worst value over the scan.
pub(crate) fn exchange(
    evaluator: &mut Evaluator,
    points: &mut Vec<Vec<f64>>,
    gains: &mut Vec<f64>,
    scan: &[usize],
    method: Method,
    stop: &Stop,
) -> f64 {
    let problem = evaluator.problem;
    if problem.family.varying().next().is_none() {
        return f64::INFINITY;
    }
    let mut best = (f64::NEG_INFINITY, gains.clone());
    for round in 0..ROUNDS {
        let known = evaluator.merit(gains);
        let places = worst_places(problem, gains, scan, 6, stop);
        evaluator.evaluations += scanned(scan, stop);
        let mut value = places.first().map_or(known, |(value, _)| value.min(known));
        let mut missed: Vec<Vec<f64>> = places
            .into_iter()
            .filter(|(value, _)| *value < known - 1e-6 * known.abs() - 1e-9)
            .map(|(_, point)| point)
            .collect();
        if let Some(limit) = problem.force_limit {
            let hardest = hardest_places(problem, gains, scan, 3, stop);
            let largest = hardest.first().map_or(0.0, |(force, _)| force / limit);
            value -= EXCESS * (largest - 1.0 - 1e-6).max(0.0);
            let over = evaluator.largest_relative_force(gains).max(1.0) * limit * (1.0 + 1e-6);
            missed.extend(hardest.into_iter().filter(|(force, _)| *force > over).map(|(_, point)| point));
        }
        if problem.asks_margins() {
            // Margins change little from one condition to the next, and are dear: what lies between is walked down to.
            let fewer = counts(&problem.family, Family::points(scan).min(problem.points(FINE)));
            let tightest = tightest_places(problem, gains, &fewer, 4, stop);
            let least = tightest.first().map_or(0.0, |(in_hand, _)| *in_hand);
            value -= EXCESS * (-least - 1e-6).max(0.0);
            let short = evaluator.shortfall(gains) + 1e-6;
            missed.extend(tightest.into_iter().filter(|(in_hand, _)| -in_hand > short).map(|(_, point)| point));
        }
        if value > best.0 {
            best = (value, gains.clone());
        }
        if missed.is_empty() || stop.is_set() || method == Method::Powell || round + 1 == ROUNDS {
            break;
        }
        for point in missed {
            evaluator.push(&point);
            points.push(point);
        }
        improve(evaluator, gains, 0.02, stop);
    }
    *gains = best.1;
    best.0
}

/// How many points a scan has looked at.
fn scanned(counts: &[usize], stop: &Stop) -> u64 {
    if stop.is_set() { 0 } else { Family::points(counts) as u64 }
}

/// Bounds the worst, improving the gains wherever the proof shows a place that was missed if `improving`.
fn prove(
    problem: &Problem,
    options: &Options,
    best: Climb,
    evaluations: &AtomicU64,
    stop: &Stop,
    improving: bool,
) -> Tuned {
    let Climb { mut gains, mut points, .. } = best;
    let mut evaluator = Evaluator::new(problem, &points).until(*stop);
    let family = &problem.family;
    let varies = family.varying().next().is_some();
    let finest = counts(family, if problem.is_ideal() { FINEST } else { problem.points(FINEST_AROUND) });
    if improving && varies && !stop.is_set() {
        exchange(&mut evaluator, &mut points, &mut gains, &finest, options.method, stop);
    }
    let mut kept: Option<(Certificate, Vec<f64>)> = None;
    for _ in 0..4 {
        let known = if stop.is_set() {
            // No time for a scan: the worst of what the climb has looked at.
            evaluator = Evaluator::new(problem, &points);
            evaluator.evaluate(&gains);
            let least = evaluator.readings.iter().min_by(|a, b| a.value.total_cmp(&b.value));
            least.map(|reading| (reading.value, evaluator.conditions[reading.condition].point.clone()))
        } else {
            worst_places(problem, &gains, &finest, 3, stop).into_iter().next()
        };
        evaluator.evaluations += scanned(&finest, stop);
        let point = known.map_or_else(|| points[0].clone(), |(_, point)| point);
        let budget = if options.prove { certify::BUDGET } else { 0 };
        let mut found = certify(problem, &gains, &point, options.tolerance, budget, stop);
        found.checked = if stop.is_set() { points.len() as u64 } else { Family::points(&finest) as u64 };
        evaluator.evaluations += found.boxes;
        let before = worst_at(problem, &gains, &point).value;
        let missed = found.value < before - options.tolerance;
        let place = found.point.clone();
        if kept.as_ref().is_none_or(|(kept, _)| found.value > kept.value) {
            kept = Some((found, gains.clone()));
        }
        if !(missed && improving) || stop.is_set() {
            break;
        }
        evaluator.push(&place);
        points.push(place);
        improve(&mut evaluator, &mut gains, 0.02, stop);
    }
    let (worst, mut gains) = kept.expect("at least one round");
    // A gain that the last step left beside its bound is at it: the difference is rounding, and reads badly.
    for gain in gains.iter_mut().filter(|gain| (problem.bound - gain.abs()).abs() < 1e-10 * problem.bound) {
        *gain = problem.bound.copysign(*gain);
    }
    evaluator = evaluator.until(Stop::NEVER);
    if stop.is_set() {
        // Thousands of conditions take longer than whoever asked to stop waits: the modes of the worst are told.
        let solved = evaluator.evaluations;
        evaluator = Evaluator::new(problem, std::slice::from_ref(&worst.point));
        evaluator.evaluations = solved;
    } else if varies {
        evaluator.push(&worst.point);
    }
    let within = ACTIVE * worst.value.abs().max(1e-3);
    let stationarity = stationarity(&mut evaluator, &gains, within, MERGE);
    evaluator.evaluate(&gains);
    let mut active: Vec<Active> = evaluator
        .readings
        .iter()
        .filter(|reading| reading.value <= worst.value + within)
        .map(|r| Active { point: evaluator.conditions[r.condition].point.clone(), pole: r.pole, value: r.value })
        .collect();
    active.sort_by(|a, b| a.value.total_cmp(&b.value));
    let hardest = hardest_places(problem, &gains, &finest, 1, stop).into_iter().next();
    let (force, force_at) = hardest.unwrap_or_else(|| (force_at(problem, &gains, &worst.point), worst.point.clone()));
    let margins = match problem.asks_margins() {
        true => worst_margins(problem, &gains, &counts(family, problem.points(FINE)), stop),
        false => None,
    };
    let peak_below = match (&margins, problem.max_sensitivity) {
        (Some([(highest, _), _]), Some(_)) if options.prove && worst.value > 0.0 => {
            peak_below(problem, &gains, highest.sensitivity.0, stop)
        }
        _ => None,
    };
    evaluations.fetch_add(evaluator.evaluations, Ordering::Relaxed);
    Tuned {
        margins,
        peak_below,
        force,
        force_at,
        feedback: problem.structure.feedback(&gains),
        gains,
        worst,
        stationarity,
        active,
        values: Vec::new(),
        evaluations: 0,
        elapsed: Duration::ZERO,
        interrupted: stop.is_set(),
    }
}
