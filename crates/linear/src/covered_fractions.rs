//! A bound of the sensitivity over all frequencies from the partial fractions of the closed loop, for machines whose matrices span decades.
//!
//! ```text
//! S(j w) = I + sum_k c_k b_k / (j w - p_k)
//! ```
//!
//! with the poles `p_k` of the closed loop. The axis is covered with stretches, halved until each is below the largest value that was
//! found. About the middle of one, with `d_k = j w - p_k`, what `S` changes by is known to first order, and what is left is no more than
//!
//! ```text
//! t^2 sum_k |c_k| |b_k| / (|d_k|^2 max(|d_k| - t, |Re p_k|))
//! ```
//!
//! Stretches are as long as the poles *near by* allow, and cost a number of operations that grows with the states and not with their cube.
//! The Hamiltonian of the same loop has eigenvalues that rounding moves by the last place of the stiffest state, off the axis or onto it.

use std::convert::Infallible;

use nalgebra::DMatrix;

use crate::certified_peak::largest_singular;
use crate::partial_fractions::PartialFractions;
use crate::system::Balanced;
use crate::{C64, least};

/// Stretches looked at, at most.
const STRETCHES: usize = 200_000;
/// A stretch is not halved to less than this part of where it is.
const NARROW: f64 = 1e-13;
/// How near a value from the fractions must be to that from the equations, beside it: a tenth of what a bound is above what was found.
const ALIKE: f64 = 1e-7;

/// What is known of a stretch.
struct Seen {
    /// The value in its middle.
    value: f64,
    /// None of it is larger.
    bound: f64,
}

impl Balanced {
    /// The largest value of `S`, at least `best`, where it is, and what no frequency exceeds, `tolerance` above it; without a delay. `None`
    /// where the poles have no fractions, one is on the axis, or it takes too many stretches.
    pub(crate) fn peak_by_fractions(
        &self,
        mut best: (f64, Option<f64>),
        tolerance: f64,
    ) -> Option<(f64, Option<f64>, f64)> {
        let closed = self.closed();
        let fractions = PartialFractions::of(&closed, ALIKE)?;
        let level = |best: f64| best * (1.0 + tolerance);
        let largest = fractions.poles.iter().map(|pole| pole.norm()).fold(f64::MIN_POSITIVE, f64::max);
        // Farther out |S - I| is less than what is left to the level.
        let end = largest + fractions.weights.iter().sum::<f64>() / (level(best.0) - 1.0);
        if !end.is_finite() {
            return None;
        }
        let mut stretches = Vec::new();
        let (mut from, mut to) = (0.0, end.min(1e-6 * largest));
        while from < end {
            stretches.extend([1.0, -1.0].map(|sign| (sign * 0.5 * (from + to), 0.5 * (to - from))));
            (from, to) = (to, (2.0 * to).min(end));
        }
        for _ in 0..STRETCHES {
            let Some((middle, half)) = stretches.pop() else { return Some((best.0, best.1, level(best.0))) };
            let seen = fractions.look(middle, half);
            if seen.value > best.0 {
                self.climb(&fractions, &mut best, middle, half)?;
            }
            if seen.bound <= level(best.0) {
                continue;
            }
            if half <= NARROW * (largest + middle.abs()) {
                return None;
            }
            stretches.extend([-0.5, 0.5].map(|part| (middle + part * half, 0.5 * half)));
        }
        None
    }

    /// The largest value in a stretch, so that little is left to halve for; `None` where fractions and equations disagree about it.
    fn climb(
        &self,
        fractions: &PartialFractions<'_>,
        best: &mut (f64, Option<f64>),
        middle: f64,
        half: f64,
    ) -> Option<()> {
        let look = |w: f64| Ok::<_, Infallible>(-largest_singular(&fractions.sensitivity(w)));
        let Ok((top, _)) = least([middle - half, middle + half], 1e-6 * half, look);
        for w in [middle, top] {
            let here = self.sensitivity_at(w)?;
            if (here - largest_singular(&fractions.sensitivity(w))).abs() > ALIKE * here {
                return None;
            }
            if here > best.0 {
                *best = (here, Some(w));
            }
        }
        Some(())
    }
}

impl PartialFractions<'_> {
    /// `S(j w)`, where the fractions are those of the closed loop.
    fn sensitivity(&self, w: f64) -> DMatrix<C64> {
        let mut sum = self.at(C64::new(0.0, w));
        (0..sum.nrows()).for_each(|k| sum[(k, k)] += C64::ONE);
        sum
    }

    fn look(&self, middle: f64, half: f64) -> Seen {
        let s = C64::new(0.0, middle);
        let here = self.sensitivity(middle);
        let mut slope = DMatrix::zeros(here.nrows(), here.ncols());
        let (mut rest, mut rounding) = (0.0, 0.0);
        for (k, (pole, weight)) in self.poles.iter().zip(&self.weights).enumerate() {
            let d = s - pole;
            let size = d.norm();
            slope.gemm(-C64::I / (d * d), &self.c.column(k), &self.b.row(k), C64::ONE);
            rest += weight / (size * size * (size - half).max(pole.re.abs()));
            rounding += weight / size;
        }
        slope *= C64::from(half);
        let ends = largest_singular(&(&here + &slope)).max(largest_singular(&(&here - &slope)));
        let bound = (ends + half * half * rest) * (1.0 + ALIKE) + f64::EPSILON * rounding;
        // What is not a number is no bound.
        Seen { value: largest_singular(&here), bound: if bound.is_nan() { f64::INFINITY } else { bound } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DelaySystem, PeakProof};

    /// Two proofs that share no step: levels of the Hamiltonian matrix, and stretches.
    #[test]
    fn val_both_ways_prove_the_same_peak() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut compared = 0;
        for _ in 0..60 {
            let (n, m) = (random.usize(2..8), random.usize(1..3));
            let mut entries = |rows, columns, by: f64| {
                DMatrix::from_fn(rows, columns, |_, _| C64::new(random.f64() - 0.5, random.f64() - 0.5) * by)
            };
            let (mut a, b, c) = (entries(n, n, 2.0), entries(n, m, 1.0), entries(m, n, 1.0));
            // Rates that span decades.
            (0..n).for_each(|i| a[(i, i)] += C64::new(-1.0, 3.0) * 10_f64.powi(i as i32 / 2));
            let system = DelaySystem::new(a, b, c, 0.0).unwrap();
            let Ok(levels) = system.certified_peak(1e-3) else { continue };
            let (amplitude, _, below) = system.balanced.peak_by_fractions((1.0, None), 1e-3).expect("a bound");
            if levels.proof == PeakProof::Hamiltonian {
                assert!(below >= levels.amplitude * (1.0 - 1e-9), "{below} {levels:?}");
                assert!(amplitude <= levels.below * (1.0 + 1e-9), "{amplitude} {levels:?}");
                compared += 1;
            }
        }
        assert!(compared > 40, "{compared}");
    }

    #[test]
    fn a_pole_on_the_axis_has_no_bound() {
        // A spring and a mass whose damper the loop takes away.
        let of = |rows, columns, of: &[f64]| DMatrix::from_fn(rows, columns, |i, k| C64::from(of[i * columns + k]));
        let (a, b, c) = (of(2, 2, &[0.0, 1.0, -1.0, -0.5]), of(2, 1, &[0.0, 1.0]), of(1, 2, &[0.0, 0.5]));
        let on_axis = DelaySystem::new(a, b, c, 0.0).unwrap();
        assert!(on_axis.balanced.peak_by_fractions((1.0, None), 1e-3).is_none());
    }
}
