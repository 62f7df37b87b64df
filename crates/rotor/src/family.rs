//! The linear machine as a function of spin speed: `A(R) = A0 + R A1`, exactly, between the points of gain tables.

use std::cell::Cell;

use crate::modes::{Whirl, damping_ratio};
use crate::quadratic::Quadratic;
use crate::{C64, ClosedLoop, Feedback, Gain, PoleError, Rotor};

/// A range of speeds over which the coefficients are linear in speed.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The equations at `from`, and their change per unit of speed.
    base: Quadratic,
    slope: Quadratic,
}

/// The pieces that make up `from..=to`, in order: one, but for gains that are tables over speed.
pub(crate) fn pieces(rotor: &Rotor, feedback: &Feedback, from: f64, to: f64) -> Vec<Piece> {
    let corners = feedback.signals().flat_map(|signal| &signal.gains).flat_map(Gain::corner_speeds);
    let mut cuts: Vec<f64> = corners.filter(|speed| from < *speed && *speed < to).chain([from, to]).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let at = |speed| Quadratic::of(&ClosedLoop::new(rotor, feedback, speed, &[]));
    cuts.windows(2)
        .map(|ends| {
            let (base, top) = (at(ends[0]), at(ends[1]));
            let slope = top.plus(-1.0, &base).times(1.0 / (ends[1] - ends[0]));
            Piece { from: ends[0], to: ends[1], base, slope }
        })
        .collect()
}

impl Piece {
    /// A single speed, where nothing changes.
    pub(crate) fn point(rotor: &Rotor, feedback: &Feedback, speed: f64) -> Self {
        let base = Quadratic::of(&ClosedLoop::new(rotor, feedback, speed, &[]));
        Self { from: speed, to: speed, slope: base.clone().times(0.0), base }
    }

    /// The equations of motion at `speed`.
    pub(crate) fn at(&self, speed: f64) -> Quadratic {
        self.base.plus(speed - self.from, &self.slope)
    }

    /// `A(R)` at `from` and `dA/dR`, row by row.
    pub(crate) fn state_rows(&self) -> (Vec<C64>, Vec<C64>) {
        let (n, size) = (self.base.masses(), 2 * self.base.masses());
        let mut both = [&self.base, &self.slope].map(|quadratic| {
            let mut rows = vec![C64::ZERO; size * size];
            quadratic.state_rows(&mut rows);
            rows
        });
        // The identity block does not change with speed.
        (0..n).for_each(|i| both[1][i * size + n + i] = C64::ZERO);
        let [base, slope] = both;
        (base, slope)
    }
}

/// Last places of the fastest rate that the mean of modes which are one may be off.
const MEAN: f64 = 16.0;

/// Half the width of the difference that gives the derivative of such a mean, in speeds.
const TWIN_STEP: f64 = 1e-4;

/// All eigenpairs at one speed, with the derivatives of the poles over speed. Entry `k` of each belongs to mode `k`.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) speed: f64,
    pub(crate) poles: Vec<C64>,
    /// `d lambda / dR = y A1 x / (y x)`.
    pub(crate) rates: Vec<C64>,
    /// How far rounding may move each pole: see the module `marginal`.
    pub(crate) noise: Vec<f64>,
    /// How far it may move each derivative.
    rate_noise: Vec<f64>,
    /// One mode of those that rounding alone tells from this one, the same for all of them: itself, where it stands alone.
    group: Vec<usize>,
    /// Right eigenvectors `x`, one after the other.
    right: Vec<C64>,
    /// Left eigenvectors as rows `y`, scaled so that `y x = 1`.
    left: Vec<C64>,
}

impl Node {
    /// The eigenpairs of `piece` at `speed`. `budget` counts evaluations down, for callers that refine.
    ///
    /// # Errors
    /// Coefficients that are not finite, or an eigenvalue iteration that does not converge.
    pub(crate) fn of(piece: &Piece, speed: f64, budget: &Cell<usize>) -> Result<Self, PoleError> {
        budget.set(budget.get().saturating_sub(1));
        let quadratic = piece.at(speed);
        let (n, size) = (quadratic.masses(), 2 * quadratic.masses());
        let poles = quadratic.poles()?;
        let rounding = quadratic.rounding();
        let mut made = Self {
            speed,
            rates: vec![C64::ZERO; size],
            noise: vec![0.0; size],
            rate_noise: vec![0.0; size],
            group: (0..size).collect(),
            right: vec![C64::ZERO; size * size],
            left: vec![C64::ZERO; size * size],
            poles,
        };
        for (k, &pole) in made.poles.iter().enumerate() {
            let right = &mut made.right[k * size..(k + 1) * size];
            let left = &mut made.left[k * size..(k + 1) * size];
            quadratic.vectors(pole, &mut right[..n], &mut left[n..]);
            let (shape, velocity) = right.split_at_mut(n);
            velocity.iter_mut().zip(&*shape).for_each(|(v, p)| *v = p * pole);
            // The left row [q (s I - D), q].
            let (first, q) = left.split_at_mut(n);
            quadratic.row_times_damping(q, first);
            first.iter_mut().zip(&*q).for_each(|(f, q)| *f = q * pole - *f);
            let product: C64 = left.iter().zip(&*right).map(|(y, x)| y * x).sum();
            let length = |v: &[C64]| v.iter().map(C64::norm_sqr).sum::<f64>().sqrt();
            // A defective mode has y x = 0: keep it finite, the noise tells that nothing is known.
            let lengths = length(left) * length(right);
            let scale = if product.norm() > f64::EPSILON * lengths { product.inv() } else { C64::ONE };
            left.iter_mut().for_each(|y| *y *= scale);
            made.noise[k] = Quadratic::reach(rounding, product.norm());
        }
        made.unite(rounding);
        made.rate(piece)?;
        Ok(made)
    }

    /// Gives modes that rounding alone tells apart one pole, their mean: it moves smoothly, and rounding moves it no more
    /// than a pole that stands alone, even where the modes have but one shape and each of them is off by the root of that.
    /// Then what is rounding of the parts of a pole is set to zero.
    fn unite(&mut self, rounding: f64) {
        let size = self.len();
        let mut group: Vec<usize> = (0..size).collect();
        for i in 0..size {
            for k in 0..i {
                if self.coincide(i, k) && group[i] != group[k] {
                    let (from, to) = (group[i], group[k]);
                    group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
                }
            }
        }
        for first in 0..size {
            let members: Vec<usize> = (0..size).filter(|&k| group[k] == first).collect();
            if members.len() > 1 {
                let mean = members.iter().map(|&k| self.poles[k]).sum::<C64>() / members.len() as f64;
                for &k in &members {
                    // In the units of a pole: `rounding` is in those of a stiffness.
                    (self.poles[k], self.noise[k]) = (mean, MEAN * rounding.sqrt() * f64::EPSILON.sqrt());
                }
            }
        }
        for (pole, noise) in self.poles.iter_mut().zip(&self.noise) {
            for part in [&mut pole.re, &mut pole.im] {
                if part.abs() <= *noise {
                    *part = 0.0;
                }
            }
        }
        self.group = group;
    }

    /// The derivatives of the poles as `piece` has them.
    fn rate(&mut self, piece: &Piece) -> Result<(), PoleError> {
        let size = self.len();
        if piece.slope.rounding() == 0.0 {
            self.rates.fill(C64::ZERO);
            self.rate_noise.fill(0.0);
            return Ok(());
        }
        for (k, rate) in self.rates.iter_mut().enumerate() {
            let (left, right) = (&self.left[k * size + size / 2..(k + 1) * size], &self.right[k * size..]);
            *rate = piece.slope.form(left, &right[..size / 2], self.poles[k]);
            self.rate_noise[k] = self.noise[k] * (1.0 + rate.norm());
        }
        self.rate_of_twins(piece)
    }

    /// The derivative of the mean of modes that are one: their vectors do not tell it, so it is a central difference.
    fn rate_of_twins(&mut self, piece: &Piece) -> Result<(), PoleError> {
        let size = self.len();
        let mut sides: Option<[Vec<C64>; 2]> = None;
        for first in 0..size {
            let members: Vec<usize> = (0..size).filter(|&k| self.group[k] == first).collect();
            if members.len() < 2 {
                continue;
            }
            let step = TWIN_STEP * (1.0 + self.speed.abs());
            if sides.is_none() {
                sides = Some([piece.at(self.speed - step).poles()?, piece.at(self.speed + step).poles()?]);
            }
            let mean = self.poles[first];
            let [below, above] = sides.as_mut().map_or([C64::ZERO; 2], |sides| {
                sides.each_mut().map(|poles| {
                    poles.sort_by(|a, b| (a - mean).norm_sqr().total_cmp(&(b - mean).norm_sqr()));
                    poles[..members.len()].iter().sum::<C64>() / members.len() as f64
                })
            });
            let rate = (above - below) / (2.0 * step);
            for &k in &members {
                (self.rates[k], self.rate_noise[k]) = (rate, TWIN_STEP * TWIN_STEP * (1.0 + rate.norm()));
            }
        }
        Ok(())
    }

    /// The same node as the start of `piece`: across a bend in a gain table the poles go on but their derivatives jump.
    ///
    /// # Errors
    /// An eigenvalue iteration that does not converge.
    pub(crate) fn entering(mut self, piece: &Piece) -> Result<Self, PoleError> {
        self.rate(piece)?;
        Ok(self)
    }

    /// How far rounding may move the derivative of mode `k`.
    pub(crate) fn rate_noise(&self, k: usize) -> f64 {
        self.rate_noise[k]
    }

    /// Whether rounding is all that may tell modes `i` and `k` apart.
    pub(crate) fn coincide(&self, i: usize, k: usize) -> bool {
        (self.poles[i] - self.poles[k]).norm() <= self.noise[i] + self.noise[k]
    }

    /// How many modes there are.
    pub(crate) fn len(&self) -> usize {
        self.poles.len()
    }

    /// Mode `k` of the result is mode `order[k]` of this one.
    pub(crate) fn reordered(self, order: &[usize]) -> Self {
        let size = self.len();
        let mut place = vec![0; size];
        order.iter().enumerate().for_each(|(now, &was)| place[was] = now);
        let rows =
            |all: &[C64]| order.iter().flat_map(|&k| all[k * size..(k + 1) * size].iter().copied()).collect::<Vec<_>>();
        Self {
            speed: self.speed,
            poles: order.iter().map(|&k| self.poles[k]).collect(),
            rates: order.iter().map(|&k| self.rates[k]).collect(),
            noise: order.iter().map(|&k| self.noise[k]).collect(),
            rate_noise: order.iter().map(|&k| self.rate_noise[k]).collect(),
            group: order.iter().map(|&k| place[self.group[k]]).collect(),
            right: rows(&self.right),
            left: rows(&self.left),
        }
    }

    /// The biorthogonal modal assurance `(y_i x_j')(y_j' x_i)` between mode `i` here and mode `j` of `other`: 1 for the same
    /// mode at the same speed, 0 for another, and its sum over all `j` is always 1.
    pub(crate) fn likeness(&self, i: usize, other: &Self, j: usize) -> f64 {
        let size = self.len();
        let product = |left: &Self, i: usize, right: &Self, j: usize| -> C64 {
            left.left[i * size..(i + 1) * size]
                .iter()
                .zip(&right.right[j * size..(j + 1) * size])
                .map(|(y, x)| y * x)
                .sum()
        };
        (product(self, i, other, j) * product(other, j, self, i)).norm()
    }

    /// Modes in the order in which branches are listed: forward ones by rising frequency, then backward ones likewise.
    pub(crate) fn listed(self) -> Self {
        let mut order: Vec<usize> = (0..self.len()).collect();
        let key = |k: usize| (self.poles[k].im < 0.0, self.poles[k].im.abs(), damping_ratio(self.poles[k]));
        order.sort_by(|&a, &b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1)).then_with(|| a.2.total_cmp(&b.2))
        });
        self.reordered(&order)
    }
}

/// The sense of whirl of a pole.
pub(crate) fn whirl_of(pole: C64) -> Whirl {
    if pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward }
}
