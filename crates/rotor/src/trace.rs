//! Pole traces: every mode as one continuous branch over spin speed, and the Campbell diagram that follows from them.

use std::cell::Cell;

use crate::crossing::{Quantity, crossings};
use crate::family::{Node, Piece, pieces, whirl_of};
use crate::follow::{TraceError, Walk};
use crate::{C64, Feedback, Mode, Rotor, Whirl, damping_ratio};

/// Poles over speed, branch by branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The speeds asked for, rising.
    pub speeds: Vec<f64>,
    /// The `2n` branches: at the lowest speed, forward modes by rising frequency, then backward ones likewise. A branch
    /// keeps its place over all speeds, even where it changes its sense of whirl.
    pub branches: Vec<Branch>,
}

/// One mode over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its pole at each speed of the trace.
    pub poles: Vec<C64>,
}

impl Branch {
    /// The mode at one speed of the trace, without its shape.
    #[must_use]
    pub fn mode(&self, at: usize) -> Mode {
        Mode { pole: self.poles[at], shape: Vec::new() }
    }
}

/// A meeting of a branch with a line of constant order in the Campbell diagram, `|Im lambda| = order R`: a critical speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalSpeed {
    /// The branch, by its place in [`Trace::branches`].
    pub branch: usize,
    /// Multiple of the spin speed: 1 for synchronous whirl, 0.5 for half speed.
    pub order: f64,
    /// The spin speed.
    pub speed: f64,
    /// The pole there.
    pub pole: C64,
    /// The sense of whirl: unbalance drives forward modes only.
    pub whirl: Whirl,
}

/// Follows every pole of the linear rotor over `speeds`, which must rise; a bend in a gain table may lie anywhere.
///
/// Between two of the speeds, as many more are looked at as it takes to tell which pole is which: see the crate's module
/// `follow`. The result does not depend on how fine `speeds` is.
///
/// # Errors
/// Speeds that do not rise, an eigenvalue iteration that does not converge, or modes that cannot be told apart.
pub fn trace(rotor: &Rotor, feedback: &Feedback, speeds: &[f64]) -> Result<Trace, TraceError> {
    let rising = speeds.windows(2).all(|w| w[0] < w[1]) && speeds.iter().all(|s| s.is_finite());
    let (Some(&from), Some(&to), true) = (speeds.first(), speeds.last(), rising) else {
        return Err(TraceError::Speeds);
    };
    let budget = Cell::new(evaluations(speeds.len()));
    let pieces = if from < to { pieces(rotor, feedback, from, to) } else { vec![Piece::point(rotor, feedback, from)] };

    let mut at = Node::of(&pieces[0], from, &budget)?.listed();
    let mut branches = vec![Branch { poles: Vec::with_capacity(speeds.len()) }; at.len()];
    let mut record =
        |node: &Node| branches.iter_mut().zip(&node.poles).for_each(|(branch, pole)| branch.poles.push(*pole));
    record(&at);
    let mut next = 1;
    for piece in &pieces {
        at = at.entering(piece)?;
        let walk = Walk { piece, budget: &budget };
        while let Some(&speed) = speeds.get(next).filter(|speed| **speed <= piece.to) {
            at = walk.to(&at, speed, &|_, _| true, &mut |_, _| ())?;
            record(&at);
            next += 1;
        }
        if at.speed < piece.to {
            at = walk.to(&at, piece.to, &|_, _| true, &mut |_, _| ())?;
        }
    }
    Ok(Trace { speeds: speeds.to_vec(), branches })
}

/// Evaluations allowed for a trace of `points` speeds: ordinary ones need a few more than `points`.
fn evaluations(points: usize) -> usize {
    20_000 + 20 * points
}

impl Trace {
    /// The smallest relative damping of any mode, per speed.
    #[must_use]
    pub fn min_damping(&self) -> Vec<f64> {
        (0..self.speeds.len())
            .map(|at| self.branches.iter().map(|b| damping_ratio(b.poles[at])).fold(f64::INFINITY, f64::min))
            .collect()
    }
}

/// Where the branches meet the lines `|Im lambda| = order R` for each of `orders`, by order and rising speed, over the
/// speeds `from..=to`; branches are numbered as [`trace`] from the same `from` does.
///
/// # Errors
/// Speeds that do not rise, an eigenvalue iteration that does not converge, or modes that cannot be told apart.
pub fn critical_speeds(
    rotor: &Rotor,
    feedback: &Feedback,
    from: f64,
    to: f64,
    orders: &[f64],
) -> Result<Vec<CriticalSpeed>, TraceError> {
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(TraceError::Speeds);
    }
    let beyond = |from, to| pieces(rotor, feedback, from, to).pop();
    let pieces = pieces(rotor, feedback, from, to);
    let mut found = Vec::new();
    for &order in orders {
        let mut on_line = Vec::new();
        // The forward half of the diagram, and the backward half mirrored.
        for sense in [1.0, -1.0] {
            let crossings = crossings(&pieces, &[], &beyond, Quantity::Order { slope: sense * order })?;
            // What does not whirl meets a line at rest only, where nothing is synchronous.
            on_line.extend(crossings.into_iter().filter(|c| c.pole.im.abs() > c.noise).map(|c| CriticalSpeed {
                branch: c.branch,
                order,
                speed: c.speed,
                pole: c.pole,
                whirl: whirl_of(c.pole),
            }));
        }
        on_line.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        found.extend(on_line);
    }
    Ok(found)
}
