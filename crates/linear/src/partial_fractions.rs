//! The count of roots right of a line where the part without delay has a motion for every eigenvalue: by partial fractions.
//!
//! ```text
//! det M(s) = det(s I - A) det G(s),   G(s) = I - exp(-s T) H(s),   H(s) = C (s I - A)^-1 B = sum_k c_k b_k / (s - lambda_k)
//! ```
//!
//! The roots right of a line are the eigenvalues of `A` there and the turns of `det G` around them. `G` has a row for each loop and
//! not one for each state, and a step is as long as the eigenvalues *near by* allow: those of a stiff shaft span decades, and a bound
//! on the matrix as a whole takes steps for the fastest of them everywhere. With `G(s + j t) = G(s) (I + E(t))`,
//!
//! ```text
//! |E|_* <= exp(-line T) ( sum_k |G^-1 c_k| |b_k| t / (d_k (d_k - t)) + min(t T, 2) sqrt(m) |G^-1 H|_F ),   d_k = |s - lambda_k|
//! ```
//!
//! and `d_k - t` is no less than the distance of `lambda_k` from the line. Steps that keep this below 1 turn by less than a quarter.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::count::{MOST_STEPS, NoCount, SAFE, principal};
use crate::inverse::{Inverted, invert};
use crate::motions::motions_of;
use crate::system::Balanced;
use crate::{C64, eigenvalues};

/// An eigenvalue or a root nearer the line than this, beside the largest, is on it: a controller's integrator may well be next to it.
const ON: f64 = 1e-12;
/// How near the fractions must come to what they stand for, beside it.
const ALIKE: f64 = 1e-8;
/// The direction in which they are compared beside an eigenvalue, in radians.
const ASIDE: f64 = 0.7;
/// What rounding may do to `G`, beside its own inverse, for turns to be trusted.
const ROUGH: f64 = 0.05;

/// `H` as a sum over the eigenvalues of `A`.
pub(crate) struct PartialFractions<'a> {
    of: &'a Balanced,
    pub(crate) poles: Vec<C64>,
    /// `c_k`, column by column.
    pub(crate) c: DMatrix<C64>,
    /// `b_k`, row by row.
    pub(crate) b: DMatrix<C64>,
    /// `|c_k| |b_k|`, as far as they are not turned by `G`.
    pub(crate) weights: Vec<f64>,
}

/// `G` at a point of the line.
struct Point {
    gain: Inverted,
    /// `sqrt(m) |G^-1 H|`.
    echo: f64,
    /// `|G^-1 c_k| |b_k|`.
    weights: Vec<f64>,
    distances: Vec<f64>,
}

impl<'a> PartialFractions<'a> {
    /// `None` where motions are missing or so much the same that fractions of them are no `H`, within `alike` of it.
    pub(crate) fn of(system: &'a Balanced, alike: f64) -> Option<Self> {
        let poles = eigenvalues(system.a.clone()).ok()?;
        let motions: Option<Vec<_>> = motions_of(&system.a, &poles)?.into_iter().collect();
        let motions = DMatrix::from_columns(&motions?);
        let (c, b) = (&system.c * &motions, motions.lu().solve(&system.b)?);
        let weights = (0..poles.len()).map(|k| c.column(k).norm() * b.row(k).norm()).collect();
        let made = Self { of: system, poles, c, b, weights };
        made.is_alike(alike).then_some(made)
    }

    pub(crate) fn at(&self, s: C64) -> DMatrix<C64> {
        let mut sum = DMatrix::zeros(self.c.nrows(), self.b.ncols());
        for (k, pole) in self.poles.iter().enumerate() {
            sum.gemm((s - pole).inv(), &self.c.column(k), &self.b.row(k), C64::ONE);
        }
        sum
    }

    /// Whether it is `H`, as a solution of the equations has it, beside every eigenvalue.
    fn is_alike(&self, alike: f64) -> bool {
        let system = self.of;
        let size = system.a.norm();
        self.poles.iter().all(|pole| {
            // As far to the side as it is long, where no other is likely to be.
            let s = pole + C64::from_polar(pole.norm().max(1e-3 * size), ASIDE);
            let mut matrix = -&system.a;
            (0..matrix.nrows()).for_each(|i| matrix[(i, i)] += s);
            let Some(x) = matrix.lu().solve(&system.b) else { return false };
            let direct = &system.c * x;
            (self.at(s) - &direct).norm() <= alike * direct.norm()
        })
    }

    fn point(&self, s: C64) -> Option<Point> {
        let h = self.at(s);
        let mut g = &h * -(-s * self.of.delay).exp();
        (0..g.nrows()).for_each(|i| g[(i, i)] += C64::ONE);
        let gain = invert(g)?;
        let echo = (self.c.nrows() as f64).sqrt() * (&gain.inverse * h).norm();
        let through = &gain.inverse * &self.c;
        let weights = (0..self.poles.len()).map(|k| through.column(k).norm() * self.b.row(k).norm()).collect();
        let distances = self.poles.iter().map(|pole| (s - pole).norm()).collect();
        Some(Point { gain, echo, weights, distances })
    }

    fn count_right_of(&self, line: f64) -> Result<Option<usize>, NoCount> {
        let (delay, loops) = (self.of.delay, self.c.nrows() as f64);
        let late = (-line * delay).exp();
        let aside: Vec<f64> = self.poles.iter().map(|pole| (pole.re - line).abs()).collect();
        let all = self.poles.iter().map(|pole| pole.norm()).fold(line.abs(), f64::max);
        if aside.iter().any(|aside| *aside < ON * all) {
            return Ok(None);
        }
        // Beyond it every eigenvalue of `exp(-s T) H` is so small that the angle of `det G` is the sum of theirs.
        let through = late * self.weights.iter().sum::<f64>();
        let radius = all + 2.0 * loops * through;
        if !radius.is_finite() {
            return Err(NoCount::TooLong);
        }
        let high = C64::new(line, radius);
        let mut s = C64::new(line, -radius);
        let Some(mut here) = self.point(s) else { return Ok(None) };
        let first = principal(here.gain.angle);
        let (mut turned, mut step) = (0.0, radius);
        for _ in 0..MOST_STEPS {
            let near = self.weights.iter().zip(&here.distances);
            let rounding = ALIKE * 1e-2 * near.map(|(weight, d)| weight / d).sum::<f64>();
            if here.gain.inverse.norm() * late * rounding > ROUGH {
                return Ok(None);
            }
            let turns_by = |t: f64| {
                let near = here.weights.iter().zip(&here.distances).zip(&aside);
                let moved: f64 = near.map(|((weight, d), aside)| weight * t / (d * (d - t).max(*aside))).sum();
                late * (moved + (t * delay).min(2.0) * here.echo)
            };
            step *= 4.0;
            while turns_by(step) > SAFE {
                step *= 0.5;
            }
            if step < ON * all.min(1.0 / delay) {
                return Err(NoCount::OnTheLine);
            }
            let last = s.im + step >= high.im;
            s = if last { high } else { C64::new(line, s.im + step) };
            let Some(there) = self.point(s) else { return Ok(None) };
            turned += principal(there.gain.angle - here.gain.angle);
            here = there;
            if last {
                let turns = (principal(here.gain.angle) - first - turned) / TAU;
                let own = self.poles.iter().filter(|pole| pole.re > line).count();
                let counted = own as f64 + turns;
                let is_whole = (turns - turns.round()).abs() < 1e-3 && counted > -0.5;
                return Ok(is_whole.then(|| counted.round() as usize));
            }
        }
        Err(NoCount::TooLong)
    }
}

impl Balanced {
    /// The number of roots with `Re s > line`, where it can be had this way.
    pub(crate) fn count_by_fractions(&self, line: f64) -> Result<Option<usize>, NoCount> {
        PartialFractions::of(self, ALIKE).map_or(Ok(None), |fractions| fractions.count_right_of(line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DelaySystem;

    /// Two ways to count that share no step: by the whole matrix, and by fractions.
    #[test]
    fn val_both_ways_count_the_same() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut counts = std::collections::BTreeSet::new();
        for _ in 0..150 {
            let (n, m) = (random.usize(1..7), random.usize(1..3));
            let mut entries = |rows, columns, by: f64| {
                DMatrix::from_fn(rows, columns, |_, _| C64::new(random.f64() - 0.5, random.f64() - 0.5) * by)
            };
            let (a, b, c) = (entries(n, n, 4.0), entries(n, m, 1.0), entries(m, n, 12.0));
            let delay = random.f64() * 2.0 + 0.01;
            let system = DelaySystem::new(a, b, c, delay).unwrap().balanced.clone();
            for line in [0.0, -0.5 / delay, -2.0 / delay] {
                let (Ok(whole), Ok(Some(found))) = (system.count_by_the_whole(line), system.count_by_fractions(line))
                else {
                    continue;
                };
                assert_eq!(found, whole, "n {n} m {m} delay {delay} line {line}");
                counts.insert(whole);
            }
        }
        assert!(counts.len() > 5, "{counts:?}");
    }

    #[test]
    fn motions_that_are_alike_are_left_to_the_other_way() {
        // A double integrator has one motion for two eigenvalues.
        let of = |rows, columns, of: &[f64]| DMatrix::from_fn(rows, columns, |i, k| C64::from(of[i * columns + k]));
        let (a, b, c) = (of(2, 2, &[0.0, 1.0, 0.0, 0.0]), of(2, 1, &[0.0, 1.0]), of(1, 2, &[-1.0, -1.0]));
        let system = DelaySystem::new(a, b, c, 0.1).unwrap();
        assert_eq!(system.balanced.count_by_fractions(-1e-3), Ok(None));
        assert_eq!(system.count_right_of(0.0), Ok(0));
    }
}
