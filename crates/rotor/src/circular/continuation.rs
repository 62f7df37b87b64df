//! All orbits over a range of speeds: those found speed by speed, and the branches that join them.

use nalgebra::DVector;

use super::judge::Judge;
use super::newton::Closing;
use super::orbit::Orbit;
use super::problem::Problem;
use super::response::AtSpeed;
use super::tracer::{End, Node, Tracer};
use super::{Circular, CircularError, cycle, response};

/// Orbits closer than this, relative to their size, are one.
const SAME: f64 = 1e-6;
/// At about how many speeds cycles are sought by homotopy.
const THOROUGH: usize = 8;

/// One branch over speed and amplitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Orbits along it, in order.
    pub orbits: Vec<Orbit>,
    /// Indices into `orbits` of the folds, where the speed turns back, smooth or at the edge of a clearance.
    pub folds: Vec<usize>,
    /// What is at its beginning and at its end.
    pub ends: [End; 2],
}

/// Every orbit at every speed, and the branches through them; without those where orbits `alone` are asked for and all of them are known.
pub(super) fn all(
    problem: &Problem<'_>,
    speeds: &[f64],
    alone: bool,
    stop: &dyn Fn() -> bool,
) -> Result<Circular, CircularError> {
    let judge = Judge::of(problem);
    let mut orbits: Vec<Vec<Orbit>> = Vec::with_capacity(speeds.len());
    let mut starts: Vec<Vec<Node>> = Vec::with_capacity(speeds.len());
    let mut complete = Vec::with_capacity(speeds.len());
    let mut beyond_limits = Vec::with_capacity(speeds.len());
    // The longest search at a few speeds: what it finds is followed to all others.
    let apart = speeds.len().div_ceil(THOROUGH).max(1);
    let mut are_all = true;
    for (i, &speed) in speeds.iter().enumerate() {
        if stop() {
            return Err(CircularError::Stopped);
        }
        let AtSpeed { found, complete: all } = if problem.forced {
            response::at_speed(problem, speed)
        } else {
            cycle::at_speed(problem, speed, i % apart == 0 || i + 1 == speeds.len())?
        };
        are_all &= all;
        // At its limits the actuator may hold other orbits.
        complete.push(all && !problem.is_limited());
        let (mut here, mut nodes): (Vec<Orbit>, Vec<Node>) = (Vec::new(), Vec::new());
        let mut beyond: Vec<Orbit> = Vec::new();
        for (x, contact) in found {
            let orbit = judge.orbit(&x, contact);
            if !problem.delivers(&orbit.forces, orbit.frequency) {
                if !beyond.iter().any(|o| o.is_same(&orbit, SAME)) {
                    beyond.push(orbit);
                }
            } else if !here.iter().any(|o| o.is_same(&orbit, SAME)) {
                here.push(orbit);
                nodes.push(Node { x, contact, fold: false });
            }
        }
        beyond_limits.push(beyond.len());
        orbits.push(here);
        starts.push(nodes);
    }

    let range = speeds.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &s| (a.min(s), b.max(s)));
    let mut curves = Vec::new();
    let mut covered: Vec<Vec<bool>> = orbits.iter().map(|here| vec![false; here.len()]).collect();
    // Branches lead to orbits that a search at one speed may have missed: where it cannot have, they are followed for their own sake.
    let from = if alone && are_all { speeds.len() } else { 0 };
    for i in from..speeds.len() {
        for k in 0..starts[i].len() {
            if stop() {
                return Err(CircularError::Stopped);
            }
            let start = &starts[i][k];
            // The resting centre is on a branch only as its end.
            if covered[i][k] || range.0 >= range.1 || orbits[i][k].largest_radius() == 0.0 {
                continue;
            }
            let (nodes, ends) = branch(problem, start, range);
            for pair in nodes.windows(2) {
                for (at, &speed) in speeds.iter().enumerate() {
                    let Some(x) = problem.between(&pair[0], &pair[1], speed) else { continue };
                    // Most are known, and their stability with them, which is what takes longest.
                    let equation = problem.at(problem.unpack(&x).2);
                    let orbit = judge.unjudged(&equation, &x, pair[1].contact);
                    if !problem.delivers(&orbit.forces, orbit.frequency) {
                        continue;
                    }
                    if let Some(known) = orbits[at].iter().position(|o| o.is_same(&orbit, SAME)) {
                        covered[at][known] = true;
                    } else {
                        orbits[at].push(judge.orbit(&x, pair[1].contact));
                        covered[at].push(true);
                    }
                }
            }
            covered[i][k] = true;
            let orbits: Vec<Orbit> = nodes.iter().map(|n| judge.orbit(&n.x, n.contact)).collect();
            curves.extend(within_limits(problem, &nodes, orbits, ends));
        }
    }
    for here in &mut orbits {
        here.sort_by(|a, b| a.largest_radius().total_cmp(&b.largest_radius()));
    }
    Ok(Circular { speeds: speeds.to_vec(), orbits, curves, complete, beyond_limits })
}

/// The parts of a branch on which the actuator delivers what it is asked for.
fn within_limits(problem: &Problem<'_>, nodes: &[Node], orbits: Vec<Orbit>, ends: [End; 2]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    let last = orbits.len().saturating_sub(1);
    let mut is_open = false;
    for (at, (orbit, node)) in orbits.into_iter().zip(nodes).enumerate() {
        if !problem.delivers(&orbit.forces, orbit.frequency) {
            is_open = false;
            continue;
        }
        if !is_open {
            let begin = if at == 0 { ends[0] } else { End::Limit };
            curves.push(Curve { orbits: Vec::new(), folds: Vec::new(), ends: [begin, End::Limit] });
            is_open = true;
        }
        if let Some(curve) = curves.last_mut() {
            if node.fold {
                curve.folds.push(curve.orbits.len());
            }
            curve.orbits.push(orbit);
            if at == last {
                curve.ends[1] = ends[1];
            }
        }
    }
    curves
}

impl Problem<'_> {
    /// Where the last unknown is `at` on the piece of branch between two neighbouring nodes, if it passes there; the set in
    /// contact is that of `b`.
    pub(super) fn between(&self, a: &Node, b: &Node, at: f64) -> Option<DVector<f64>> {
        let last = self.unknowns() - 1;
        let (from, to) = (a.x[last], b.x[last]);
        if !(from.min(to)..=from.max(to)).contains(&at) {
            return None;
        }
        let part = if from == to { 0.0 } else { (at - from) / (to - from) };
        let guess = &a.x + (&b.x - &a.x) * part;
        let reach = (&b.x - &a.x).norm() + 1e-6 * guess.norm();
        let near = |x: &DVector<f64>| (x - &guess).norm() <= reach;
        let x = self.solve(guess.clone(), b.contact, Closing::Speed(at)).filter(near)?;
        self.is_consistent(self.unpack(&x).0.as_slice(), b.contact, 1e-9).then_some(x)
    }
}

/// The whole branch through `start`, followed both ways.
fn branch(problem: &Problem<'_>, start: &Node, range: (f64, f64)) -> (Vec<Node>, [End; 2]) {
    let trace = |sign| Tracer::new(problem, range).follow(start, sign);
    let (forward, end) = trace(1.0);
    if end == End::Closed {
        return (forward, [End::Closed; 2]);
    }
    let (backward, begin) = trace(-1.0);
    // Contact is kept with the later node of each piece: it moves by one when the order turns.
    let mut nodes: Vec<Node> = Vec::with_capacity(backward.len() + forward.len());
    for (i, node) in backward.iter().enumerate().rev() {
        let contact = backward.get(i + 1).map_or(node.contact, |next| next.contact);
        nodes.push(Node { contact, ..node.clone() });
    }
    nodes.extend(forward.into_iter().skip(1));
    (nodes, [begin, end])
}
