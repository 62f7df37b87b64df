//! Improving gains at the conditions looked at, and adding those between them that turn out to be worse.

use crate::conditions::{counts, hardest_places, tightest_places, worst_places};
use crate::evaluate::{EXCESS, Evaluator};
use crate::minimax::polish;
use crate::stop::Stop;
use crate::{Family, Method};

/// Points of the first grid, and of the scan for what it has missed.
pub(crate) const COARSE: usize = 30;
pub(crate) const FINE: usize = 300;
/// Rounds of adding conditions that turned out to be worse.
const ROUNDS: usize = 8;
/// Poles nearer than this, relative to their size, are treated as a merging pair.
pub(crate) const MERGE: f64 = 0.02;

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
pub(crate) fn scanned(counts: &[usize], stop: &Stop) -> u64 {
    if stop.is_set() { 0 } else { Family::points(counts) as u64 }
}
