//! Where a quantity of a branch changes sign over speed: the real part of its pole, or its distance from a line.

use std::cell::Cell;

use crate::family::{Node, Piece};
use crate::follow::{TraceError, Walk, defect, pair};
use crate::{C64, PoleError};

/// What changes sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Quantity {
    /// `Re lambda`: stability.
    Growth,
    /// `Im lambda - slope R`: a line of the Campbell diagram.
    Order { slope: f64 },
}

impl Quantity {
    /// Its value for mode `k`, and its derivative over speed.
    fn of(self, node: &Node, k: usize) -> (f64, f64) {
        match self {
            Self::Growth => (node.poles[k].re, node.rates[k].re),
            Self::Order { slope } => (node.poles[k].im - slope * node.speed, node.rates[k].im - slope),
        }
    }

    /// -1, 0 or 1: zero where rounding could turn the sign.
    fn sign(self, node: &Node, k: usize) -> f64 {
        let value = self.of(node, k).0;
        if value.abs() <= node.noise[k] { 0.0 } else { value.signum() }
    }
}

/// One change of sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) branch: usize,
    pub(crate) speed: f64,
    pub(crate) pole: C64,
    /// Whether the quantity rises there.
    pub(crate) rising: bool,
}

/// Evaluations allowed: ordinary walks need a few hundred.
const EVALUATIONS: usize = 40_000;

/// Steps that a walk over the whole range is cut into at least.
const STEPS: usize = 48;

/// All changes of sign over `pieces`, in no particular order. Branches are followed; a step is halved until no branch can
/// change sign twice on it unseen. `cuts` are speeds to stop at in any case.
///
/// A branch on which the quantity is zero but for rounding, as for an undamped mode, has no sign and so no change of it.
/// Both ends belong to the range: what is zero there and moves away counts.
///
/// # Errors
/// An eigenvalue iteration that does not converge, or more halving than is allowed.
pub(crate) fn crossings(pieces: &[Piece], cuts: &[f64], quantity: Quantity) -> Result<Vec<Crossing>, TraceError> {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return Ok(Vec::new()) };
    let budget = Cell::new(EVALUATIONS);
    let mut at = Node::of(first, first.from, &budget)?.listed();
    let mut found = Vec::new();
    // Per branch, the sign it had last and the node at which it had it; a start on zero counts as the side it comes from.
    let mut memory: Vec<(f64, Node)> = (0..at.len()).map(|k| (entry_sign(quantity, &at, k), at.clone())).collect();
    for piece in pieces {
        at = at.entering(piece);
        let walk = Walk { piece, budget: &budget };
        for speed in stops(piece, (last.to - first.from) / STEPS as f64, cuts) {
            let mut failure = None;
            at = walk.to(&at, speed, &|a, b| settled(quantity, a, b), &mut |a, b| {
                for (k, (sign, node)) in memory.iter_mut().enumerate() {
                    let now = quantity.sign(b, k);
                    if now == 0.0 {
                        continue;
                    }
                    if now * *sign < 0.0 {
                        // The zero may lie on an earlier piece than this step if the branch stayed on zero in between.
                        let from = if node.speed < piece.from { a } else { &*node };
                        match root(&walk, quantity, from, b, k) {
                            Ok(crossing) => found.push(crossing),
                            Err(error) => failure = Some(error),
                        }
                    }
                    (*sign, *node) = (now, b.clone());
                }
            })?;
            if let Some(error) = failure {
                return Err(error.into());
            }
        }
    }
    // A zero on the very last speed is a change if the branch is on its way through.
    for (k, (sign, _)) in memory.iter().enumerate() {
        let rate = quantity.of(&at, k).1;
        if quantity.sign(&at, k) == 0.0 && rate.abs() > at.rate_noise(k) && rate * sign > 0.0 {
            continue;
        }
        if quantity.sign(&at, k) == 0.0 && rate.abs() > at.rate_noise(k) && *sign != 0.0 {
            found.push(Crossing { branch: k, speed: at.speed, pole: at.poles[k], rising: rate > 0.0 });
        }
    }
    Ok(found)
}

/// The sign at the lower end; on zero, the sign just below it.
fn entry_sign(quantity: Quantity, node: &Node, k: usize) -> f64 {
    let rate = quantity.of(node, k).1;
    match quantity.sign(node, k) {
        0.0 if rate.abs() > node.rate_noise(k) => -rate.signum(),
        sign => sign,
    }
}

/// Speeds to stop at on `piece`: its own end, an even grid, and the cuts.
fn stops(piece: &Piece, step: f64, cuts: &[f64]) -> Vec<f64> {
    let count = ((piece.to - piece.from) / step).ceil().max(1.0) as usize;
    let inside = |speed: &f64| piece.from < *speed && *speed < piece.to;
    let mut stops: Vec<f64> = (1..count)
        .map(|i| piece.from + (piece.to - piece.from) * (i as f64 / count as f64))
        .chain(cuts.iter().copied())
        .filter(inside)
        .chain([piece.to])
        .collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    stops
}

/// Whether every branch keeps its sign between `a` and `b`, or changes it once and steadily.
fn settled(quantity: Quantity, a: &Node, b: &Node) -> bool {
    let step = b.speed - a.speed;
    (0..a.len()).all(|k| {
        let ((f0, d0), (f1, d1)) = (quantity.of(a, k), quantity.of(b, k));
        let (d0, d1) = (d0 * step, d1 * step);
        let error = defect(a, b, k);
        let noise = a.noise[k] + b.noise[k];
        if f0.abs() <= noise && f1.abs() <= noise {
            // On zero all the way, or too near for anything to be seen.
            return error <= noise && d0.abs() <= noise + a.rate_noise(k) * step;
        }
        if f0 * f1 < 0.0 {
            let change = f1 - f0;
            return d0 * change > 0.0 && d1 * change > 0.0 && error < 0.5 * d0.abs().min(d1.abs());
        }
        // Same sign: the cubic through both ends stays clear of zero by its error.
        let clearance = f0.abs().min(f1.abs());
        if clearance > d0.abs() + d1.abs() + error {
            return true;
        }
        let value = |s: f64| {
            let rest = 1.0 - s;
            f0 * rest * rest * (1.0 + 2.0 * s) + d0 * s * rest * rest + f1 * s * s * (3.0 - 2.0 * s) - d1 * s * s * rest
        };
        let sign = (f0 + f1).signum();
        let least = (0..=16).map(|i| sign * value(f64::from(i) / 16.0)).fold(f64::INFINITY, f64::min);
        // Sixteen samples miss the minimum of a cubic by less than a fiftieth of its slopes.
        least > error + 0.02 * (d0.abs() + d1.abs()) || (least > 0.0 && d0 * d1 > 0.0 && error < d0.abs().min(d1.abs()))
    })
}

/// The zero of `quantity` on branch `k` between two nodes where its signs differ: Newton's method, kept within the bracket
/// by bisection.
fn root(walk: &Walk<'_>, quantity: Quantity, from: &Node, to: &Node, k: usize) -> Result<Crossing, PoleError> {
    let rising = quantity.of(to, k).0 > 0.0;
    let unlimited = Cell::new(usize::MAX);
    let (mut low, mut high) = (from.clone(), to.clone());
    let mut best = if quantity.of(from, k).0.abs() < quantity.of(to, k).0.abs() { from.clone() } else { to.clone() };
    for _ in 0..200 {
        let (value, rate) = quantity.of(&best, k);
        let newton = best.speed - value / rate;
        let inside = low.speed < newton && newton < high.speed;
        let speed = if inside { newton } else { 0.5 * (low.speed + high.speed) };
        if !(low.speed < speed && speed < high.speed) || (speed - best.speed).abs() <= 2.0 * f64::EPSILON * speed.abs()
        {
            break;
        }
        let node = Node::of(walk.piece, speed, &unlimited)?;
        let nearer = if speed - low.speed < high.speed - speed { &low } else { &high };
        let (order, _) = pair(nearer, &node);
        let node = node.reordered(&order);
        let value = quantity.of(&node, k).0;
        if (value > 0.0) == rising {
            high = node.clone();
        } else {
            low = node.clone();
        }
        let halved = speed != newton;
        best = node;
        if value == 0.0 || (!halved && (value / rate).abs() <= 1e-15 * speed.abs().max(1e-3)) {
            break;
        }
    }
    Ok(Crossing { branch: k, speed: best.speed, pole: best.poles[k], rising })
}
