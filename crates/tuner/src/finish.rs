//! The end of a search: the worst over the whole family bounded, gains improved wherever that shows a place that was missed, and
//! all that is told of them.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use crate::certify::{self, Certificate, certify};
use crate::conditions::{counts, hardest_places, worst_margins, worst_places};
use crate::evaluate::Evaluator;
use crate::exchange::{FINE, MERGE, exchange, improve, scanned};
use crate::limits::force_at;
use crate::minimax::stationarity;
use crate::proven_peak::peak_below;
use crate::stop::Stop;
use crate::worst::worst_at;
use crate::{Active, Family, Options, Problem, Tuned};

/// Points of the last scan.
const FINEST: usize = 4000;
/// Of the last scan where the loop is more than gains: its poles take ten to a thousand times as long, and what lies between
/// two points is walked down to.
const FINEST_AROUND: usize = 600;
/// Of what a stopped search still looks at: whoever stopped it waits.
const HASTY: usize = 48;
/// The same where the loop is more than gains.
const HASTY_AROUND: usize = 3;
/// How near the worst, relative to it, a value counts as active.
const ACTIVE: f64 = 1e-6;

/// What `look` sees over the whole range: as closely as `closely` says, and once stopped, at whatever moment, as `hastily` says. What a look
/// that was broken off has seen is of a part of the range, and not told.
fn over_the_range<T>(closely: &[usize], hastily: &[usize], stop: &Stop, look: impl Fn(&[usize], &Stop) -> T) -> T {
    let seen = look(closely, stop);
    if stop.is_set() { look(hastily, &Stop::GLANCE) } else { seen }
}

/// Gains with the conditions that a climb has looked at.
pub(crate) struct Candidate {
    pub(crate) gains: Vec<f64>,
    pub(crate) points: Vec<Vec<f64>>,
}

/// Bounds the worst, improving the gains wherever the proof shows a place that was missed if `improving`.
pub(crate) fn prove(
    problem: &Problem,
    options: &Options,
    best: Candidate,
    evaluations: &AtomicU64,
    stop: &Stop,
    improving: bool,
) -> Tuned {
    let Candidate { mut gains, mut points } = best;
    let mut evaluator = Evaluator::new(problem, &points).until(*stop);
    let family = &problem.family;
    let varies = family.varying().next().is_some();
    let hasty = counts(family, if problem.is_ideal() { HASTY } else { HASTY_AROUND });
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
    for (gain, most) in gains.iter_mut().zip(problem.reach()).filter(|(x, most)| (most - x.abs()).abs() < 1e-10 * most)
    {
        *gain = most.copysign(*gain);
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
    let hardest =
        over_the_range(&finest, &hasty, stop, |counts, stop| hardest_places(problem, &gains, counts, 1, stop));
    let (force, force_at) =
        (hardest.into_iter().next()).unwrap_or_else(|| (force_at(problem, &gains, &worst.point), worst.point.clone()));
    let margins_over = |counts: &[usize], until: &Stop| {
        // Each takes a hundred times as long as a force.
        let is_too_long = stop.is_set() && Family::points(counts) > 4 * HASTY;
        if is_too_long { None } else { worst_margins(problem, &gains, counts, until) }
    };
    let finely = counts(family, problem.points(FINE));
    let margins = problem.asks_margins().then(|| over_the_range(&finely, &hasty, stop, margins_over)).flatten();
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
        corners: problem.structure.corner_values(&gains),
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
