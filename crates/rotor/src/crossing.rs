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
    /// How far rounding may move it.
    pub(crate) noise: f64,
    /// Whether the quantity rises there.
    pub(crate) rising: bool,
}

/// Evaluations allowed: ordinary walks need a few hundred.
const EVALUATIONS: usize = 40_000;

/// Steps that a walk over the whole range is cut into at least.
const STEPS: usize = 48;

/// Where the walk has a branch: the sign that its quantity had last, and since when it rests on zero.
#[derive(Clone)]
struct Memory {
    sign: f64,
    /// The node at which it had that sign.
    node: Node,
    /// The first and the last speed at which it was zero since.
    zero: Option<(f64, f64)>,
}

impl Memory {
    /// Whether the branch has stayed on zero for longer than a passage takes, as rounding sees it.
    fn rests(&self, noise: f64) -> bool {
        let Some((since, last)) = self.zero else { return false };
        last - since > Self::passage(last, noise)
    }

    /// How long a passage takes at most.
    fn passage(speed: f64, noise: f64) -> f64 {
        1e-6 * (1.0 + speed.abs()) + 8.0 * noise.sqrt()
    }

    /// Where a branch that rested left zero: at rest or where the piece begins, if rounding may have held it until it was seen.
    fn left(&self, noise: f64, piece: f64) -> f64 {
        let last = self.zero.map_or(self.node.speed, |(_, last)| last);
        [0.0, piece].into_iter().find(|at| (last - at).abs() <= Self::passage(last, noise)).unwrap_or(last)
    }
}

/// All changes of sign over `from..=to`, in no particular order. Branches are followed; a step is halved until no branch
/// can change sign twice on it unseen. `cuts` are speeds to stop at in any case.
///
/// A branch changes sign where it leaves zero for a side other than the one that it came from. One that has rested on zero
/// over a range of speeds came from neither side: of stability, leaving then counts, whichever way it goes, and so does
/// leaving zero at rest, `R = 0`, where a machine starts; of a line of the Campbell diagram, which means nothing at rest,
/// neither does. What comes to zero and stays there has not left, and what touches it has not
/// changed. This depends on the machine next to the speed alone, never on the range: beyond an end that is on zero, the
/// machine just outside is asked.
///
/// # Errors
/// An eigenvalue iteration that does not converge, or more halving than is allowed.
pub(crate) fn crossings(
    pieces: &[Piece],
    cuts: &[f64],
    beyond: &dyn Fn(f64, f64) -> Option<Piece>,
    quantity: Quantity,
) -> Result<Vec<Crossing>, TraceError> {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return Ok(Vec::new()) };
    let size = first.at(first.from).masses();
    let budget = Cell::new(EVALUATIONS / (1 + size * size / 64));
    let mut at = Node::of(first, first.from, &budget)?.listed();
    let below = outside(&at, -1.0, beyond, &budget)?;
    let mut found = Vec::new();
    let mut memory: Vec<Memory> = (0..at.len())
        .map(|k| {
            let zero = quantity.sign(&at, k) == 0.0;
            let sign =
                if zero { below.as_ref().map_or(0.0, |node| quantity.sign(node, k)) } else { quantity.sign(&at, k) };
            // On zero on both sides of the end: it has been there for as long as can be said.
            let since = if sign == 0.0 { f64::NEG_INFINITY } else { at.speed };
            Memory { sign, node: at.clone(), zero: zero.then_some((since, at.speed)) }
        })
        .collect();
    let rest = [0.0];
    for piece in pieces {
        at = at.entering(piece)?;
        let walk = Walk { piece, budget: &budget };
        for speed in stops(piece, (last.to - first.from) / STEPS as f64, cuts.iter().chain(&rest)) {
            let mut failure = None;
            if at.speed == 0.0 {
                start_from_rest(quantity, &at, &mut memory);
            }
            at = walk.to(&at, speed, &|a, b| settled(quantity, a, b), &mut |a, b| {
                for (k, was) in memory.iter_mut().enumerate() {
                    let now = quantity.sign(b, k);
                    if now == 0.0 {
                        was.zero = Some((was.zero.map_or(b.speed, |(since, _)| since), b.speed));
                        continue;
                    }
                    if quantity == Quantity::Growth && was.rests(a.noise[k]) {
                        let left = was.left(a.noise[k], piece.from);
                        let there = if was.node.speed == left { &was.node } else { a };
                        found.push(Crossing {
                            branch: k,
                            speed: left,
                            pole: there.poles[k],
                            noise: there.noise[k],
                            rising: now > 0.0,
                        });
                    } else if now * was.sign < 0.0 {
                        // The zero may lie on an earlier piece than this step if the branch stayed on zero in between.
                        let from = if was.node.speed < piece.from { a } else { &was.node };
                        match root(&walk, quantity, from, b, k) {
                            Ok(crossing) => found.push(crossing),
                            Err(error) => failure = Some(error),
                        }
                    }
                    *was = Memory { sign: now, node: b.clone(), zero: None };
                }
            })?;
            if let Some(error) = failure {
                return Err(error.into());
            }
        }
    }
    // A zero on the very last speed is a change if the branch is on its way through, or leaves there.
    if at.speed == 0.0 {
        start_from_rest(quantity, &at, &mut memory);
    }
    if let Some(above) = outside(&at, 1.0, beyond, &budget)? {
        for (k, was) in memory.iter().enumerate().filter(|(_, was)| was.zero.is_some()) {
            let next = quantity.sign(&above, k);
            let rests = quantity == Quantity::Growth && was.rests(at.noise[k]);
            if next != 0.0 && (rests || next * was.sign < 0.0) {
                found.push(Crossing {
                    branch: k,
                    speed: at.speed,
                    pole: at.poles[k],
                    noise: at.noise[k],
                    rising: next > 0.0,
                });
            }
        }
    }
    Ok(found)
}

/// A branch that is on zero at rest came from nowhere.
fn start_from_rest(quantity: Quantity, at: &Node, memory: &mut [Memory]) {
    for (_, was) in memory.iter_mut().enumerate().filter(|(k, _)| quantity.sign(at, *k) == 0.0) {
        *was = Memory { sign: 0.0, node: at.clone(), zero: Some((f64::NEG_INFINITY, at.speed)) };
    }
}

/// The node just outside of an end of the range, `side` -1 below it and 1 above, with modes in the order of those at the
/// end; none if there are no coefficients.
fn outside(
    end: &Node,
    side: f64,
    beyond: &dyn Fn(f64, f64) -> Option<Piece>,
    budget: &Cell<usize>,
) -> Result<Option<Node>, TraceError> {
    let speed = end.speed + side * OUTSIDE * (1.0 + end.speed.abs());
    let Some(piece) = beyond(end.speed.min(speed), end.speed.max(speed)) else { return Ok(None) };
    let node = Node::of(&piece, speed, budget)?;
    let from = end.clone().entering(&piece)?;
    let (order, _) = pair(&from, &node);
    Ok(Some(node.reordered(&order)))
}

/// How far outside of the range the machine is asked which way a branch goes, in speeds.
const OUTSIDE: f64 = 1e-5;

/// Speeds to stop at on `piece`: its own end, an even grid, and the cuts.
fn stops<'a>(piece: &Piece, step: f64, cuts: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let count = ((piece.to - piece.from) / step).ceil().max(1.0) as usize;
    let inside = |speed: &f64| piece.from < *speed && *speed < piece.to;
    let mut stops: Vec<f64> = (1..count)
        .map(|i| piece.from + (piece.to - piece.from) * (i as f64 / count as f64))
        .chain(cuts.copied())
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
            // Its other part may well change: that of an undamped mode does.
            let slack = noise + (a.rate_noise(k) + b.rate_noise(k)) * step;
            return d0.abs() <= slack && d1.abs() <= slack;
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
    Ok(Crossing { branch: k, speed: best.speed, pole: best.poles[k], noise: best.noise[k], rising })
}
