//! Following poles over speed, so that a branch stays one mode through crossings and near-crossings.
//!
//! A step from one speed to the next is believed only if three things agree: each pole lies where the derivative of its
//! predecessor predicts it, the eigenvectors at both ends belong to each other ([`Node::likeness`]), and on the way no two
//! branches come closer than the error of their interpolation. Otherwise the step is halved. Poles of a complex matrix
//! depend analytically on speed wherever they are distinct, and two of them meet only by accident or symmetry, so halving
//! ends; where it does not, within rounding of a true meeting, likeness decides.

use std::cell::Cell;

use crate::family::{Node, Piece};
use crate::{C64, PoleError};

/// A step is halved at most this often: a millionth of a millionth of its length, below which rounding decides.
const DEEPEST: u32 = 40;

/// Why there is no trace.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// The speeds are not finite, or do not rise.
    #[error("the speeds of a trace must be finite and rise")]
    Speeds,
    /// Modes come so close, or so often, that following them takes more evaluations than are allowed.
    #[error(
        "the modes near R = {speed} cannot be told apart in the evaluations allowed: try a narrower range of speeds"
    )]
    Unresolved {
        /// Where it came to an end.
        speed: f64,
    },
    /// The poles cannot be computed.
    #[error(transparent)]
    Poles(#[from] PoleError),
}

/// Walks along a piece, calling `visit` with both ends of every step that is believed.
pub(crate) struct Walk<'a> {
    pub(crate) piece: &'a Piece,
    /// Evaluations left for halving: cost is bounded.
    pub(crate) budget: &'a Cell<usize>,
}

impl Walk<'_> {
    /// Goes from `start` to `speed`, with the modes of the result in the order of `start`. A step is also halved while
    /// `settled` is not, so that callers can ask for as much detail as they need.
    ///
    /// # Errors
    /// An eigenvalue iteration that does not converge, or no evaluations left for a step in doubt.
    pub(crate) fn to(
        &self,
        start: &Node,
        speed: f64,
        settled: &dyn Fn(&Node, &Node) -> bool,
        visit: &mut dyn FnMut(&Node, &Node),
    ) -> Result<Node, TraceError> {
        let end = Node::of(self.piece, speed, self.budget)?;
        self.advance(start, end, DEEPEST, settled, visit)
    }

    fn advance(
        &self,
        start: &Node,
        end: Node,
        depth: u32,
        settled: &dyn Fn(&Node, &Node) -> bool,
        visit: &mut dyn FnMut(&Node, &Node),
    ) -> Result<Node, TraceError> {
        let (order, sure) = pair(start, &end);
        let end = end.reordered(&order);
        let middle = 0.5 * (start.speed + end.speed);
        let halvable = depth > 0 && start.speed < middle && middle < end.speed;
        if !halvable || (sure && no_meeting(start, &end) && settled(start, &end)) {
            visit(start, &end);
            return Ok(end);
        }
        if self.budget.get() == 0 {
            return Err(TraceError::Unresolved { speed: middle });
        }
        let middle = Node::of(self.piece, middle, self.budget)?;
        let middle = self.advance(start, middle, depth - 1, settled, visit)?;
        self.advance(&middle, end, depth - 1, settled, visit)
    }
}

/// Which mode of `end` continues each mode of `start`, and whether prediction and eigenvectors leave no doubt.
pub(crate) fn pair(start: &Node, end: &Node) -> (Vec<usize>, bool) {
    let size = start.len();
    let step = end.speed - start.speed;
    let mut taken = [false; 2 * crate::MAX_MASSES];
    let mut order = Vec::with_capacity(size);
    let mut sure = true;
    for i in 0..size {
        let predicted = start.poles[i] + start.rates[i] * step;
        let nearest = (0..size).map(|j| (j, (end.poles[j] - predicted).norm_sqr())).min_by(|a, b| a.1.total_cmp(&b.1));
        let nearest = nearest.map_or(i, |(j, _)| j);
        sure &= !std::mem::replace(&mut taken[nearest], true);
        order.push(nearest);
    }
    if sure {
        sure = (0..size).all(|i| start.likeness(i, end, order[i]) > 0.5);
        if sure {
            return (order, true);
        }
    }
    let order = best_first(start, end);
    let sure = (0..size).all(|i| {
        let predicted = start.poles[i] + start.rates[i] * step;
        let off = |j: usize| (end.poles[j] - predicted).norm();
        let own = order[i];
        let rival = (0..size).find(|&j| off(j) + end.noise[j] + end.noise[own] < off(own));
        // Modes that are one at both ends, by symmetry, are as good as each other.
        let twins = (0..size).filter(|&k| start.coincide(i, k) && end.coincide(own, order[k]));
        // Their vectors tell nothing if they have but one: then prediction alone decides.
        let mut twins = twins.peekable();
        let alone = twins.next().is_some() && twins.peek().is_none();
        rival.is_none() && (!alone || start.likeness(i, end, own) > 0.5)
    });
    (order, sure)
}

/// Pairs by prediction and likeness together, the clearest pair first.
fn best_first(start: &Node, end: &Node) -> Vec<usize> {
    let size = start.len();
    let step = end.speed - start.speed;
    let mut candidates = Vec::with_capacity(size * size);
    for i in 0..size {
        let predicted = start.poles[i] + start.rates[i] * step;
        for j in 0..size {
            let scale = start.poles[i].norm() + end.poles[j].norm() + f64::MIN_POSITIVE;
            let unlike = (1.0 - start.likeness(i, end, j)).abs().min(1.0);
            candidates.push(((end.poles[j] - predicted).norm() / scale + unlike, i, j));
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut order = vec![usize::MAX; size];
    let mut taken = vec![false; size];
    for (_, i, j) in candidates {
        if order[i] == usize::MAX && !taken[j] {
            (order[i], taken[j]) = (j, true);
        }
    }
    order
}

/// The error that interpolating pole `k` between both ends may have: what its end derivatives leave unexplained.
pub(crate) fn defect(start: &Node, end: &Node, k: usize) -> f64 {
    let step = end.speed - start.speed;
    (end.poles[k] - start.poles[k] - (start.rates[k] + end.rates[k]) * (0.5 * step)).norm()
}

/// Whether every two branches stay apart between `start` and `end`, by more than the interpolation may be wrong.
fn no_meeting(start: &Node, end: &Node) -> bool {
    let size = start.len();
    let step = end.speed - start.speed;
    for i in 0..size {
        let own = defect(start, end, i);
        for j in 0..i {
            let (w0, w1) = (start.poles[i] - start.poles[j], end.poles[i] - end.poles[j]);
            let (d0, d1) = ((start.rates[i] - start.rates[j]) * step, (end.rates[i] - end.rates[j]) * step);
            let apart = w0.norm().min(w1.norm());
            if (w1 - w0).norm() + (d0.norm() + d1.norm()) * 0.5 < 0.5 * apart {
                continue;
            }
            // Two that coincide at both ends, by symmetry: which is which has no meaning.
            if start.coincide(i, j) && end.coincide(i, j) {
                continue;
            }
            let error = own + defect(start, end, j);
            let closest = (1..16).map(|k| hermite(w0, d0, w1, d1, f64::from(k) / 16.0).norm()).fold(apart, f64::min);
            if closest < 3.0 * error || closest < 0.2 * (w1 - w0).norm() / 16.0 {
                return false;
            }
        }
    }
    true
}

/// The cubic with values `w0`, `w1` and derivatives `d0`, `d1` at 0 and 1.
pub(crate) fn hermite(w0: C64, d0: C64, w1: C64, d1: C64, s: f64) -> C64 {
    let rest = 1.0 - s;
    w0 * (rest * rest * (1.0 + 2.0 * s)) + d0 * (s * rest * rest) + w1 * (s * s * (3.0 - 2.0 * s)) - d1 * (s * s * rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::family::pieces;

    #[test]
    fn a_walk_that_may_not_look_as_often_as_it_must_says_where_it_ended() {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let feedback = builtin::feedback(&rotor, "off").expect("fits any");
        let pieces = pieces(&rotor, &feedback, 0.0, 6.0);
        let walk = |budget: usize| {
            let budget = Cell::new(budget);
            let start = Node::of(&pieces[0], 0.0, &budget)?;
            let never = |a: &Node, b: &Node| b.speed - a.speed < 0.01;
            Walk { piece: &pieces[0], budget: &budget }.to(&start, 6.0, &never, &mut |_, _| ()).map(|end| end.speed)
        };
        assert_eq!(walk(2_000), Ok(6.0));
        assert!(matches!(walk(20), Err(TraceError::Unresolved { speed }) if speed > 0.0 && speed < 6.0));
    }
}
