//! Branches of circular orbits over speed: pseudo-arclength continuation of a piecewise smooth equation.
//!
//! Between two contact events the equation is smooth and a branch is followed along its tangent, through folds. Where a
//! mass reaches the edge of its clearance the branch has a corner: the edge is located exactly, and the branch goes on
//! with the new set of bearings in contact along the tangent that moves the mass to the side it now belongs to; this
//! may reverse the speed, a fold at a corner.

use nalgebra::{DMatrix, DVector};

use super::newton::Closing;
use super::problem::{Contact, Problem};
use crate::C64;

const FIRST_STEP: f64 = 0.02;
const LONGEST_STEP: f64 = 0.2;
const SHORTEST_STEP: f64 = 1e-7;
const MOST_STEPS: usize = 4_000;
/// A radius this many clearances wide counts as unbounded.
const UNBOUNDED: f64 = 1e4;

/// Where a branch ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// At the end of the range of speeds.
    Range,
    /// The amplitude grows without bound: at a threshold (limit cycle) or an undamped resonance (response) of the rotor with the bearings in
    /// contact at full stiffness.
    Unbounded,
    /// The last bearing loses contact: at a threshold of the rotor with those bearings out of action.
    ContactLost,
    /// The branch closes on itself: an isolated loop.
    Closed,
    /// The actuator reaches its limit of force or of the rate of force.
    Limit,
    /// The continuation could go no further.
    Lost,
}

/// One point of a branch, with the set in contact on the way to it.
#[derive(Clone)]
pub(super) struct Node {
    pub x: DVector<f64>,
    pub contact: Contact,
    /// The speed turns back here.
    pub fold: bool,
}

/// Follows one branch one way.
pub(super) struct Tracer<'p, 'a> {
    problem: &'p Problem<'a>,
    range: (f64, f64),
}

impl<'p, 'a> Tracer<'p, 'a> {
    /// Within a range of speeds.
    pub(super) fn new(problem: &'p Problem<'a>, range: (f64, f64)) -> Self {
        Self { problem, range }
    }

    /// Everything from `start` on towards higher (`sign` 1) or lower (-1) speeds, and where that ends.
    pub(super) fn follow(&self, start: &Node, sign: f64) -> (Vec<Node>, End) {
        let last = self.problem.unknowns() - 1;
        let mut nodes = vec![start.clone()];
        let (mut x, mut contact) = (start.x.clone(), start.contact);
        let mut towards = DVector::zeros(last + 1);
        towards[last] = sign;
        let Some(mut tangent) = self.tangent(&x, contact, &towards) else { return (nodes, End::Lost) };
        if tangent[last] * sign < 0.0 {
            tangent.neg_mut();
        }
        let mut step = FIRST_STEP;
        let mut corners: Vec<(DVector<f64>, Contact)> = Vec::new();
        for _ in 0..MOST_STEPS {
            if step < SHORTEST_STEP {
                return (nodes, End::Lost);
            }
            let Some((next, next_tangent)) = self.advance(&x, contact, &tangent, step) else {
                step *= 0.5;
                continue;
            };
            let straightness = tangent.dot(&next_tangent);
            if straightness < 0.9 && step > 1e-4 {
                step *= 0.5;
                continue;
            }
            if !self.problem.is_consistent(self.amplitudes(&next).as_slice(), contact, 1e-12) {
                let Some(edge) = self.edge(&x, &next, contact) else {
                    step *= 0.5;
                    continue;
                };
                let (turned, outcome) = self.corner(&edge, contact, &tangent);
                nodes.push(Node { x: edge.clone(), contact, fold: false });
                let Some((set, direction)) = outcome else { return (nodes, turned) };
                if let Some(node) = nodes.last_mut() {
                    node.fold = direction[last] * tangent[last] < 0.0;
                }
                if self.is_outside(edge[last]) {
                    return (nodes, End::Range);
                }
                // A loop that hangs on a stem never meets its start again, but its corners.
                if corners.iter().any(|(x, s)| *s == set && self.distance(x, &edge) < 1e-6) {
                    return (nodes, End::Closed);
                }
                corners.push((edge.clone(), set));
                (x, contact, tangent, step) = (edge, set, direction, FIRST_STEP.min(step * 2.0));
                continue;
            }
            if next_tangent[last] * tangent[last] < 0.0
                && let Some(fold) = self.fold(&x, contact, &tangent, step)
            {
                nodes.push(Node { x: fold, contact, fold: true });
            }
            if self.is_outside(next[last]) {
                let limit = if next[last] < self.range.0 { self.range.0 } else { self.range.1 };
                let part = (limit - x[last]) / (next[last] - x[last]);
                let guess = &x + (&next - &x) * part;
                if let Some(x) = self.problem.solve(guess, contact, Closing::Speed(limit)) {
                    nodes.push(Node { x, contact, fold: false });
                }
                return (nodes, End::Range);
            }
            nodes.push(Node { x: next.clone(), contact, fold: false });
            let widest = self.amplitudes(&next).iter().map(|c| c.norm()).fold(0.0, f64::max);
            if widest > UNBOUNDED * self.problem.largest_clearance().max(1.0) {
                return (nodes, End::Unbounded);
            }
            if nodes.len() > 6 && contact == start.contact {
                let reach = 1.1 * self.distance(&x, &next);
                if self.distance(&x, &start.x) <= reach && self.distance(&next, &start.x) <= reach {
                    nodes.push(start.clone());
                    return (nodes, End::Closed);
                }
            }
            (x, tangent) = (next, next_tangent);
            step = (step * 1.4).min(LONGEST_STEP);
        }
        (nodes, End::Lost)
    }

    fn amplitudes(&self, x: &DVector<f64>) -> DVector<C64> {
        self.problem.unpack(x).0
    }

    fn is_outside(&self, speed: f64) -> bool {
        speed < self.range.0 || speed > self.range.1
    }

    /// Units in which a step of length 1 is large: the amplitude itself, a tenth of the range of speeds, frequency 1.
    fn units(&self, x: &DVector<f64>) -> DVector<f64> {
        let n = self.problem.masses;
        let size = self.amplitudes(x).iter().map(|c| c.norm()).fold(0.0, f64::max);
        let amplitude = size.max(0.1 * self.problem.largest_clearance()).max(1e-9);
        let speed = ((self.range.1 - self.range.0) / 10.0).min(1.0);
        DVector::from_fn(x.len(), |i, _| {
            if i < 2 * n {
                amplitude
            } else if i == x.len() - 1 {
                speed
            } else {
                1.0
            }
        })
    }

    /// How far apart two points are, whatever their phase, in those units.
    fn distance(&self, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
        let n = self.problem.masses;
        let units = self.units(a);
        let (c, d) = (self.amplitudes(a), self.amplitudes(b));
        let radii: f64 = (0..n).map(|k| ((c[k].norm() - d[k].norm()) / units[k]).powi(2)).sum();
        let rest: f64 = (2 * n..a.len()).map(|i| ((a[i] - b[i]) / units[i]).powi(2)).sum();
        (radii + rest).sqrt()
    }

    /// Unit tangent of the branch at `x`, in scaled unknowns, on the side of `towards`.
    fn tangent(&self, x: &DVector<f64>, contact: Contact, towards: &DVector<f64>) -> Option<DVector<f64>> {
        let phase = self.amplitudes(x);
        let (_, slope, scale) = self.problem.linearise(x, contact, &phase);
        let units = self.units(x);
        let size = x.len();
        let scaled = slope * DMatrix::from_diagonal(&units) / scale.max(f64::MIN_POSITIVE);
        // The border must not be normal to the tangent; a second one of no special direction is tried if it is.
        let askew = DVector::from_fn(size, |i, _| (1.0 + i as f64).sin());
        for border in [towards, &askew] {
            let mut matrix = scaled.clone().insert_row(size - 1, 0.0);
            matrix.row_mut(size - 1).copy_from(&border.transpose());
            let mut unit = DVector::zeros(size);
            unit[size - 1] = 1.0;
            if let Some(tangent) = matrix.lu().solve(&unit) {
                let norm = tangent.norm();
                if norm.is_finite() && norm < 1e9 {
                    let tangent = tangent / norm;
                    return Some(if tangent.dot(towards) < 0.0 { -tangent } else { tangent });
                }
            }
        }
        None
    }

    /// One step of length `step` along `tangent`: the point reached and the tangent there.
    fn advance(
        &self,
        x: &DVector<f64>,
        contact: Contact,
        tangent: &DVector<f64>,
        step: f64,
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        let units = self.units(x);
        let at = x + tangent.component_mul(&units) * step;
        let row = tangent.component_div(&units);
        let next = self.problem.solve(at.clone(), contact, Closing::Plane { at: &at, row: &row })?;
        if (&next - &at).component_div(&units).norm() > 0.5 * step {
            return None;
        }
        let next_tangent = self.tangent(&next, contact, tangent)?;
        Some((next, next_tangent))
    }

    /// The first edge of a clearance between `x`, which agrees with `contact`, and `next`, which does not.
    fn edge(&self, x: &DVector<f64>, next: &DVector<f64>, contact: Contact) -> Option<DVector<f64>> {
        let problem = self.problem;
        let (before, after) = (self.amplitudes(x), self.amplitudes(next));
        let mut crossed: Vec<(f64, usize)> = problem
            .contacts(problem.gapped)
            .filter_map(|k| {
                let g = problem.clearance(k);
                let (a, b) = (before[k].norm() - g, after[k].norm() - g);
                let is_in = contact >> k & 1 == 1;
                (is_in != (b > 0.0)).then(|| (if a == b { 0.0 } else { (a / (a - b)).clamp(0.0, 1.0) }, k))
            })
            .collect();
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let reach = 2.0 * self.distance(x, next);
        crossed.into_iter().find_map(|(part, k)| {
            let edge = problem.solve(x + (next - x) * part, contact, Closing::Edge(k))?;
            let near = self.distance(x, &edge) <= reach;
            (near && problem.is_consistent(self.amplitudes(&edge).as_slice(), contact, 1e-9)).then_some(edge)
        })
    }

    /// How the branch goes on from the edge of one or more clearances: the new set in contact and the tangent.
    fn corner(
        &self,
        edge: &DVector<f64>,
        contact: Contact,
        tangent: &DVector<f64>,
    ) -> (End, Option<(Contact, DVector<f64>)>) {
        let problem = self.problem;
        let n = problem.masses;
        let c = self.amplitudes(edge);
        let on_edge: Vec<usize> = problem
            .contacts(problem.gapped)
            .filter(|&k| (c[k].norm() / problem.clearance(k) - 1.0).abs() <= 1e-8)
            .collect();
        // A cycle needs one bearing in contact: where all let go at once it ends.
        if !problem.forced && on_edge.iter().fold(contact, |set, k| set & !(1 << k)) == 0 {
            return (End::ContactLost, None);
        }
        let units = self.units(edge);
        // Several masses meet their edges at once when the rotor is symmetric: every way to flip them is tried,
        // all at once first.
        for pick in (1..1_u32 << on_edge.len().min(8)).rev() {
            let flips = on_edge.iter().enumerate().fold(0, |set, (i, k)| set | (pick >> i & 1) << k);
            let set = contact ^ flips;
            let Some(along) = self.tangent(edge, set, tangent) else { continue };
            for direction in [along.clone(), -along] {
                let goes_there = on_edge.iter().all(|&k| {
                    let radial = (c[k].re * direction[k] * units[k] + c[k].im * direction[n + k] * units[n + k])
                        / (c[k].norm() * units[k]);
                    if set >> k & 1 == 1 { radial > -1e-9 } else { radial < 1e-9 }
                });
                if goes_there {
                    return (End::Lost, Some((set, direction)));
                }
            }
        }
        (End::Lost, None)
    }

    /// The fold between `x` and the point `step` further: where the tangent has no part along the speed.
    fn fold(&self, x: &DVector<f64>, contact: Contact, tangent: &DVector<f64>, step: f64) -> Option<DVector<f64>> {
        let last = x.len() - 1;
        let (mut low, mut high) = (0.0, step);
        let mut best = None;
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let (point, slope) = self.advance(x, contact, tangent, middle)?;
            if slope[last] * tangent[last] > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
            best = Some(point);
            if high - low < 1e-12 {
                break;
            }
        }
        best
    }
}
