//! A filter at work: a transfer function of one input and one output in companion form,
//!
//! ```text
//! x_i' = x_{i+1},   x_m' = w - sum a_i x_i,   out = sum b_i x_i + d w
//! ```
//!
//! and the same by the trapezoidal rule, for a sampled loop.

use nalgebra::DMatrix;

use crate::C64;

/// The highest order of one filter.
pub const MAX_ORDER: usize = 8;

/// A filter, or a factor of one, with real coefficients but for the speed that it may follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) order: usize,
    a: [f64; MAX_ORDER],
    b: [f64; MAX_ORDER],
    d: f64,
    /// First order, and `s` stands for `s - j R`.
    pub(crate) follows_speed: bool,
    /// An integrator, which is held while the actuator is at its limit.
    pub(crate) winds_up: bool,
    /// The frequency at which the trapezoidal rule shall be exact; 0 for low ones.
    pub(crate) warped: f64,
}

impl Block {
    /// With denominator `s^m + a_{m-1} s^{m-1} ... + a_0` and numerator `b`, beside a direct path `d`.
    pub(crate) fn of(a: &[f64], b: &[f64], d: f64) -> Self {
        let mut block = Self {
            order: a.len(),
            a: [0.0; MAX_ORDER],
            b: [0.0; MAX_ORDER],
            d,
            follows_speed: false,
            winds_up: false,
            warped: 0.0,
        };
        block.a[..a.len()].copy_from_slice(a);
        block.b[..b.len()].copy_from_slice(b);
        block
    }

    /// The same with `s - j R` in place of `s`; of first order.
    pub(crate) fn following_speed(self) -> Self {
        Self { follows_speed: true, ..self }
    }

    /// The same, held while the actuator is at its limit.
    pub(crate) fn winding_up(self) -> Self {
        Self { winds_up: true, ..self }
    }

    /// The same, exact at this frequency in a sampled loop.
    pub(crate) fn exact_at(self, frequency: f64) -> Self {
        Self { warped: frequency, ..self }
    }

    /// What `s` is counted from: `j R` for a block that follows the speed.
    fn centre(&self, speed: f64) -> C64 {
        if self.follows_speed { C64::new(0.0, speed) } else { C64::ZERO }
    }

    /// Its response at `s`.
    pub(crate) fn at(&self, s: C64, speed: f64) -> C64 {
        let s = s - self.centre(speed);
        let polynomial = |c: &[f64]| c.iter().rev().fold(C64::ZERO, |sum, c| sum * s + *c);
        let (numerator, denominator) = (polynomial(&self.b[..self.order]), polynomial(&self.a[..self.order]));
        numerator / (s.powu(self.order as u32) + denominator) + self.d
    }

    /// Its output for input `w` in state `x`.
    #[inline]
    pub(crate) fn output(&self, x: &[C64], w: C64) -> C64 {
        x.iter().zip(&self.b).fold(w * self.d, |sum, (x, b)| sum + x * *b)
    }

    /// The rate of its state.
    #[inline]
    pub(crate) fn derivative(&self, x: &[C64], w: C64, speed: f64, dx: &mut [C64]) {
        let Some(last) = self.order.checked_sub(1) else { return };
        dx[..last].copy_from_slice(&x[1..=last]);
        dx[last] = x.iter().zip(&self.a).fold(w, |sum, (x, a)| sum - x * *a);
        if self.follows_speed {
            dx[0] += C64::new(0.0, speed) * x[0];
        }
    }

    /// The first of its states, the others being 0, under an input that never changes; `None` if it has no such state.
    pub(crate) fn at_rest(&self, w: C64, speed: f64) -> Option<C64> {
        let stiffness = C64::from(self.a[0]) - self.centre(speed);
        (self.order > 0 && stiffness != C64::ZERO).then(|| w / stiffness)
    }

    /// `A`, `B`, `C` and `D` of `x' = A x + B w`, `out = C x + D w`.
    pub(crate) fn matrices(&self, speed: f64) -> (DMatrix<C64>, DMatrix<C64>, DMatrix<C64>, C64) {
        let m = self.order;
        let mut a = DMatrix::zeros(m, m);
        let mut b = DMatrix::zeros(m, 1);
        let mut c = DMatrix::zeros(1, m);
        for i in 0..m {
            if i + 1 < m {
                a[(i, i + 1)] = C64::ONE;
            }
            a[(m - 1, i)] -= C64::from(self.a[i]);
            c[(0, i)] = C64::from(self.b[i]);
        }
        if m > 0 {
            b[(m - 1, 0)] = C64::ONE;
            a[(0, 0)] += self.centre(speed);
        }
        (a, b, c, C64::from(self.d))
    }
}

/// A block in a sampled loop: with `k` half the period (or what keeps the notch at its place), from one sample to the next
///
/// ```text
/// x = (1 - k A)^-1 (z + k B w),   out = C x + D w,   z <- x + k (A x + B w)
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    pub(crate) block: Block,
    half: f64,
    /// `(1 - k A)^-1`, row by row, at `speed`.
    inverse: Vec<C64>,
    speed: f64,
}

impl Sampled {
    pub(crate) fn new(block: Block, period: f64, speed: f64) -> Self {
        let half = if block.warped > 0.0 && block.warped * period < std::f64::consts::PI {
            (0.5 * block.warped * period).tan() / block.warped
        } else {
            0.5 * period
        };
        let (a, ..) = block.matrices(speed);
        let size = block.order;
        let to_invert = DMatrix::identity(size, size) - a * C64::from(half);
        // Singular for a pole at 1 / k, far right of everything: it is then held as it is.
        let inverse = to_invert.try_inverse().unwrap_or_else(|| DMatrix::identity(size, size));
        // nalgebra keeps columns together.
        let inverse = inverse.transpose().iter().copied().collect();
        Self { block, half, inverse, speed }
    }

    /// Follows the speed, which allocates nothing.
    pub(crate) fn follow(&mut self, speed: f64) {
        if self.block.follows_speed && speed != self.speed {
            self.speed = speed;
            self.inverse[0] = (1.0 - (self.block.centre(speed) - self.block.a[0]) * self.half).inv();
        }
    }

    /// Takes in one sample and gives the output for it; `held` keeps an integrator where it is.
    pub(crate) fn take(&self, z: &mut [C64], w: C64, held: impl Fn(C64) -> bool) -> C64 {
        let m = self.block.order;
        if m == 0 {
            return self.block.output(&[], w);
        }
        if self.block.winds_up && held(z[0] * w.conj()) {
            return self.block.output(z, w);
        }
        let mut driven = [C64::ZERO; MAX_ORDER];
        driven[..m].copy_from_slice(z);
        driven[m - 1] += w * self.half;
        let mut x = [C64::ZERO; MAX_ORDER];
        for (x, row) in x.iter_mut().zip(self.inverse.chunks_exact(m)) {
            *x = row.iter().zip(&driven).map(|(r, d)| r * d).sum();
        }
        let mut dx = [C64::ZERO; MAX_ORDER];
        self.block.derivative(&x[..m], w, self.speed, &mut dx[..m]);
        for ((z, x), dx) in z.iter_mut().zip(&x).zip(&dx) {
            *z = x + dx * self.half;
        }
        self.block.output(&x[..m], w)
    }

    /// `A`, `B`, `C` and `D` of `z <- A z + B w`, `out = C z + D w`.
    pub(crate) fn matrices(&self) -> (DMatrix<C64>, DMatrix<C64>, DMatrix<C64>, C64) {
        let (a, b, c, d) = self.block.matrices(self.speed);
        let size = self.block.order;
        let p = DMatrix::from_row_slice(size, size, &self.inverse);
        let k = C64::from(self.half);
        let forward = (DMatrix::identity(size, size) + &a * k) * &p;
        let input = &forward * &b * k + &b * k;
        let direct = if size == 0 { d } else { d + (&c * &p * &b)[(0, 0)] * k };
        (forward, input, c * p, direct)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Filter, J};

    #[test]
    fn val_a_sampled_block_has_the_response_of_the_bilinear_transform() {
        let (period, speed, w) = (0.05, 2.5, 3.7);
        for filter in [
            Filter::Lowpass { corner: 8.0, order: 1 },
            Filter::Lead { zero: 2.0, pole: 9.0 },
            Filter::SynchronousNotch { width: 0.3 },
            Filter::Integrator { rate: 0.4 },
            Filter::Transfer { numerator: vec![1.0, 2.0], denominator: vec![1.0, 3.0, 5.0, 7.0] },
        ] {
            let block = filter.blocks()[0];
            let sampled = Sampled::new(block, period, speed);
            // s = (2 / h) (z - 1) / (z + 1) on the circle is j (2 / h) tan(w h / 2).
            let expected = block.at(J * (2.0 / period * (0.5 * w * period).tan()), speed);
            let (a, b, c, d) = sampled.matrices();
            let z = (J * w * period).exp();
            let size = block.order;
            let solved = (DMatrix::identity(size, size) * z - a).lu().solve(&b).expect("no pole there");
            assert!(((c * solved)[(0, 0)] + d - expected).norm() < 1e-12, "{filter:?}");
            // The difference equation does what its matrices say.
            let (mut state, mut output) = (vec![C64::ZERO; size], C64::ZERO);
            let (mut linear, (a, b, c, d)) = (DMatrix::zeros(size, 1), sampled.matrices());
            for k in 0..40 {
                let input = (J * w * period * f64::from(k)).exp() * 0.3;
                output = sampled.take(&mut state, input, |_| false);
                assert!((output - ((&c * &linear)[(0, 0)] + d * input)).norm() < 1e-12);
                linear = &a * &linear + &b * input;
            }
            assert!(output.is_finite());
        }
        // A notch keeps its frequency.
        let notch = Sampled::new(Filter::Notch { frequency: 20.0, width: 1.0 }.blocks()[0], period, speed);
        let (a, b, c, d) = notch.matrices();
        let z = (J * 20.0 * period).exp();
        let solved = (DMatrix::identity(2, 2) * z - a).lu().solve(&b).expect("no pole there");
        assert!(((c * solved)[(0, 0)] + d).norm() < 1e-12);
    }

    #[test]
    fn following_the_speed_is_being_made_for_it() {
        let block = Filter::SynchronousNotch { width: 0.3 }.blocks()[0];
        let mut sampled = Sampled::new(block, 0.05, 1.0);
        sampled.follow(3.0);
        assert!((sampled.inverse[0] - Sampled::new(block, 0.05, 3.0).inverse[0]).norm() < 1e-15);
    }
}
