//! Multistart: many climbs from random gains, the best of them polished, checked and proven.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::certify::{Certificate, certify};
use crate::conditions::counts;
use crate::evaluate::Evaluator;
use crate::exchange::{COARSE, FINE, exchange, improve};
use crate::finish::{Candidate, prove};
use crate::stop::Stop;
use crate::{Method, Options, Problem, ProblemError, Progress, Tuned, powell, smooth};

/// One climb: what it ended with.
struct Climb {
    value: f64,
    end: Candidate,
}

/// What the climb from one start ended with, before anything is proven.
#[derive(Clone, Debug, PartialEq)]
pub struct Climbed {
    /// The worst value over the conditions that it looked at.
    pub value: f64,
    /// The variables of the structure.
    pub gains: Vec<f64>,
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
    let best = climbs.swap_remove(0).end;
    finished(problem, options, best, values, (evaluations, begun), stop)
}

/// Climbs from one start alone, counted from 0: what [`tune()`] does from each of its starts. It is the same whoever climbs it, so that
/// starts can be shared out; see [`finish()`].
///
/// # Errors
/// A problem that makes no sense.
pub fn climb_from(problem: &Problem, options: &Options, start: usize, stop: Stop) -> Result<Climbed, ProblemError> {
    problem.check()?;
    let Climb { value, end } = climb(problem, options, start, &AtomicU64::new(0), &stop);
    Ok(Climbed { value, gains: end.gains })
}

/// What [`tune()`] makes of its climbs, from the `values` that [`climb_from`] ended with, by start: climbs the best once more, and polishes,
/// checks and proves it. The answer is that of [`tune()`] with as many starts; evaluations are of what was done here.
///
/// # Errors
/// A problem that makes no sense.
///
/// # Panics
/// No values.
pub fn finish(problem: &Problem, options: &Options, values: &[f64], stop: Stop) -> Result<Tuned, ProblemError> {
    problem.check()?;
    let begun = Instant::now();
    let evaluations = AtomicU64::new(0);
    let best = best_start(values).expect("at least one start");
    let Climb { end, .. } = climb(problem, options, best, &evaluations, &stop);
    let mut values = values.to_vec();
    values.sort_by(|a, b| b.total_cmp(a));
    Ok(finished(problem, options, end, values, (evaluations, begun), stop))
}

/// The start whose climb ended best: of equal ones the first, as [`tune()`] has it. `None` of none.
#[must_use]
pub fn best_start(values: &[f64]) -> Option<usize> {
    (0..values.len()).reduce(|best, next| if values[next].total_cmp(&values[best]).is_gt() { next } else { best })
}

/// Polishes, checks and proves where the best climb ended.
fn finished(
    problem: &Problem,
    options: &Options,
    best: Candidate,
    values: Vec<f64>,
    (evaluations, begun): (AtomicU64, Instant),
    stop: Stop,
) -> Tuned {
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
    let given = Candidate { gains: gains.to_vec(), points };
    let mut tuned = prove(problem, options, given, &evaluations, &stop, false);
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
    let (structure, reach) = (&problem.structure, problem.reach());
    let spread = options.spread.min(problem.bound);
    // Every knot of a gain begins alike: a schedule departs from constant gains.
    let (knots, gains) = (structure.schedule().knots(), structure.gain_variables());
    let is_chain = structure.is_chain();
    let around = if is_chain { vec![0.0; structure.variables()] } else { structure.own() };
    let mut drawn = Vec::with_capacity(around.len());
    for around in around[..gains].chunks_exact(knots) {
        let by = spread * (2.0 * random.f64() - 1.0);
        drawn.extend(around.iter().map(|gain| (gain + by).clamp(-problem.bound, problem.bound)));
    }
    // Of a chain nothing is known beforehand: a corner may begin anywhere.
    for (around, reach) in around[gains..].iter().zip(&reach[gains..]) {
        let by = if is_chain { *reach } else { spread } * (2.0 * random.f64() - 1.0);
        drawn.push((around + by).clamp(-reach, *reach));
    }
    drawn
}

fn climb(problem: &Problem, options: &Options, start: usize, evaluations: &AtomicU64, stop: &Stop) -> Climb {
    let mut gains = first_gains(problem, options, start);
    let family = &problem.family;
    let mut points = family.grid(&counts(family, problem.points(COARSE)));
    let mut evaluator = Evaluator::new(problem, &points).until(*stop);
    match options.method {
        Method::Powell => powell::climb(&mut evaluator, &mut gains, stop),
        Method::Nonsmooth => {
            // The rough stages lead nearly every start to one place. With corners there are others, a little better or worse.
            let is_near = start % 2 == 1 && !problem.structure.corners().is_empty();
            smooth::climb(&mut evaluator, &mut gains, if is_near { smooth::ROUGH } else { 0 }, stop);
            improve(&mut evaluator, &mut gains, 0.05, stop);
        }
    }
    let fine = counts(family, problem.points(FINE));
    let mut value = exchange(&mut evaluator, &mut points, &mut gains, &fine, options.method, stop);
    if family.varying().next().is_none() {
        value = value.min(evaluator.merit(&gains));
    }
    evaluations.fetch_add(evaluator.evaluations, Ordering::Relaxed);
    Climb { value, end: Candidate { gains, points } }
}
