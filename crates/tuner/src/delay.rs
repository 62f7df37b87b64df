//! Poles of a loop with delay `T`: roots of `det(s^2 I - s D - K + exp(-s T) e_b (g + s h)) = 0`.
//!
//! There are infinitely many. Those up to `|s| = pi / T` count: all that belong to the rotor as long as the delay is short
//! beside its motion, and the first that the delay brings. Beyond, the damping *ratio* of the chain of roots that every
//! delay has creeps towards 0 however fast they decay, which says nothing about the machine.
//!
//! A Pade approximation of the delay gives a matrix whose eigenvalues are near the roots, and Newton's method on the exact
//! equation takes them the rest of the way. So what is found is exact; what could be missed is a root that the
//! approximation does not have, which inside that circle would take an error of order 1 where it errs by 1e-6.

use nalgebra::DMatrix;
use rotor::{C64, ControlRow, MAX_MASSES, Quadratic, eigenvalues};

/// Order of the approximation.
const ORDER: usize = 5;
const NEWTON_STEPS: usize = 12;

/// A rotor with its control off, and a control law that acts late.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delayed<'a> {
    pub(crate) open: &'a Quadratic,
    pub(crate) row: &'a ControlRow,
    pub(crate) delay: f64,
}

impl Delayed<'_> {
    /// The equations of motion for whirl `exp(s tau)`, for which the delay is the factor `exp(-s T)`.
    pub(crate) fn seen_at(&self, s: C64) -> Quadratic {
        let late = (-s * self.delay).exp();
        let mut row = *self.row;
        row.displacement.iter_mut().chain(&mut row.velocity).for_each(|gain| *gain *= late);
        let mut seen = self.open.clone();
        seen.control(&row);
        seen
    }

    /// What the delay itself adds to `q (dM / ds) p`: `-T exp(-s T) q_b (g + s h) p`.
    pub(crate) fn slope(&self, s: C64, left: &[C64], right: &[C64]) -> C64 {
        let gains = self.row.displacement.iter().zip(&self.row.velocity);
        let asked: C64 = gains.zip(right).map(|((g, h), p)| (g + s * h) * p).sum();
        -(-s * self.delay).exp() * self.delay * left[self.row.bearing] * asked
    }

    /// The poles, `None` if the eigenvalues of the approximation cannot be had.
    pub(crate) fn poles(&self) -> Option<Vec<C64>> {
        let mut found: Vec<C64> = Vec::new();
        let farthest = std::f64::consts::PI / self.delay;
        for guess in eigenvalues(self.approximation()).ok()? {
            // A little beyond, as the guess is only near its root.
            if guess.norm() > 1.2 * farthest {
                continue;
            }
            let Some(pole) = self.root_near(guess) else { continue };
            let known = found.iter().any(|other| (other - pole).norm() < 1e-10 * (1.0 + pole.norm()));
            if pole.norm() <= farthest && !known {
                found.push(pole);
            }
        }
        Some(found)
    }

    /// Newton's method on the least factor of `M(s)`, by its left and right vectors.
    fn root_near(&self, guess: C64) -> Option<C64> {
        let n = self.open.masses();
        let (mut right, mut left, mut moved) =
            ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]);
        let mut s = guess;
        for _ in 0..NEWTON_STEPS {
            let seen = self.seen_at(s);
            seen.vectors(s, &mut right[..n], &mut left[..n]);
            seen.row_times_damping(&left[..n], &mut moved[..n]);
            let product: C64 = left[..n].iter().zip(&right).map(|(q, p)| q * p).sum();
            let value = s * s * product - seen.form(&left[..n], &right[..n], s);
            let slope: C64 = (0..n).map(|i| (left[i] * (s * 2.0) - moved[i]) * right[i]).sum();
            let step = value / (slope + self.slope(s, &left[..n], &right[..n]));
            s -= step;
            if !(s.re.is_finite() && s.im.is_finite()) || (s - guess).norm() > 0.5 * (1.0 + guess.norm()) {
                return None;
            }
            if step.norm() <= 1e-13 * (1.0 + s.norm()) {
                return Some(s);
            }
        }
        // Near a double root it creeps; good to the digits that such a root has.
        Some(s)
    }

    /// The state matrix `[p, p', z]` with the delay as the all-pass `P(-x) / P(x)`, `x = s T`, in companion form.
    fn approximation(&self) -> DMatrix<C64> {
        let n = self.open.masses();
        let (size, first) = (2 * n + ORDER, 2 * n);
        let mut rows = vec![C64::ZERO; 4 * n * n];
        self.open.state_rows(&mut rows);
        let mut a = DMatrix::zeros(size, size);
        for i in 0..2 * n {
            for j in 0..2 * n {
                a[(i, j)] = rows[i * 2 * n + j];
            }
        }
        // P(x) = sum c_k x^k, monic.
        let mut c = [1.0; ORDER + 1];
        for k in (0..ORDER).rev() {
            c[k] = c[k + 1] * ((2 * ORDER - k) * (k + 1)) as f64 / (ORDER - k) as f64;
        }
        let direct = if ORDER.is_multiple_of(2) { 1.0 } else { -1.0 };
        let b = n + self.row.bearing;
        // v = -(g p + h p'); z_k' = z_{k+1} / T; z_last' = (v - sum c_k z_k) / T; u = direct v + sum (n_k - direct c_k) z_k.
        for k in 0..n {
            for (column, gain) in [(k, self.row.displacement[k]), (n + k, self.row.velocity[k])] {
                a[(b, column)] -= gain * direct;
                a[(size - 1, column)] -= gain / self.delay;
            }
        }
        for k in 0..ORDER {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            a[(b, first + k)] += C64::from(c[k] * (sign - direct));
            a[(size - 1, first + k)] -= C64::from(c[k] / self.delay);
            if k + 1 < ORDER {
                a[(first + k, first + k + 1)] = C64::from(1.0 / self.delay);
            }
        }
        a
    }
}
