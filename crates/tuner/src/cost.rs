//! The H2 cost of unbalance and of noise: the mean square of the motion and of the control force, exact, with its slope in each gain.
//!
//! Two things drive a stable machine: its unbalance, and noise `n` of the sensors, which the gains make a force of. Every sensor's
//! displacement and velocity has noise of its own, of standard deviation `sigma` in each component and of first order with the corner `omega`;
//! all together are one such noise `nu` in the force, of variance `2 sigma^2 |k|^2`, where `|k|^2` is the sum of the squares of the law's row. With
//! `u = -k p - d p' + nu`,
//!
//! ```text
//! J^2 = E sum_i |p_i|^2 + rho^2 E |u|^2
//!     = sum_i |c_i|^2 + rho^2 |u(j R)|^2  +  2 sigma^2 |k|^2 tr(C P C*),     A P + P A* + B B* = 0
//! ```
//!
//! where `c` is the synchronous whirl under the unbalance, `A` is that of `(p, p', nu)`, `B` drives `nu` to variance 1, and `C` gives
//! `(p, rho u)`. With `A* Q + Q A + C* C = 0` the trace is `B* Q B`, and its slope `2 Re tr(Q dA P) + 2 Re tr(C* dC P)`.
//! Both equations are solved by the Schur form of `A` (Bartels & Stewart 1972).

use nalgebra::{DMatrix, DVector, Schur};
use rotor::C64;

use crate::Problem;

/// What is weighed, and how noisy the sensors are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// `rho`: what a control force of 1 `w0^2 e_t` weighs, in displacement of 1 `e_t`; at least 0.
    pub force: f64,
    /// `sigma`: standard deviation of each component of a sensor's displacement, in `e_t`, and of its velocity, in `w0 e_t`; above 0.
    pub noise: f64,
    /// `omega`: the corner of that noise, in radians per `tau`; above 0.
    pub corner: f64,
}

impl Default for Cost {
    /// A force weighs a tenth, noise is a tenth of `e_t` up to 10 radians per `tau`.
    fn default() -> Self {
        Self { force: 0.1, noise: 0.1, corner: 10.0 }
    }
}

impl Cost {
    /// `J^2` of a stable machine at a condition; `None` if the equations cannot be solved.
    ///
    /// # Panics
    /// If the problem is not of gains alone at one bearing of a chain, which [`Problem::check`] refuses with a cost.
    #[must_use]
    pub fn square(self, problem: &Problem, gains: &[f64], point: &[f64]) -> Option<f64> {
        self.of(problem, gains, point, &mut [])
    }

    /// `1 / J^2` and its slope, if there is room for it.
    pub(crate) fn worth(self, problem: &Problem, gains: &[f64], point: &[f64], slope: &mut [f64]) -> Option<f64> {
        let square = self.of(problem, gains, point, slope)?;
        slope.iter_mut().for_each(|s| *s *= -(square * square).recip());
        Some(square.recip())
    }

    /// `J^2` and its slope, if there is room for it.
    fn of(self, problem: &Problem, gains: &[f64], point: &[f64], slope: &mut [f64]) -> Option<f64> {
        let (structure, speed) = (&problem.structure, point[0]);
        let mut closed = problem.family.open(point);
        let row = structure.row(gains, speed);
        closed.control(&row);
        let (n, bearing) = (closed.masses(), structure.bearing());
        let law: Vec<C64> = row.displacement[..n].iter().chain(&row.velocity[..n]).copied().collect();

        // Whirl under the unbalance, and under a unit of force at the bearing.
        let s = C64::new(0.0, speed);
        let read = |x: &[C64]| (0..n).map(|i| (law[i] + s * law[n + i]) * x[i]).sum::<C64>();
        let mut whirl = problem.family.unbalance(point);
        closed.respond(s, &mut whirl);
        let force = -read(&whirl);
        let weight = self.force * self.force;
        let of_unbalance = whirl.iter().map(C64::norm_sqr).sum::<f64>() + weight * force.norm_sqr();

        // Motion under noise of variance 1 in the force.
        let size = 2 * n + 1;
        let mut a = DMatrix::<C64>::zeros(size, size);
        let mut c = DMatrix::<C64>::zeros(n + 1, size);
        for i in 0..n {
            a[(i, n + i)] = C64::ONE;
            c[(i, i)] = C64::ONE;
            for j in 0..n {
                a[(n + i, j)] = closed.stiffness()[i * n + j];
                a[(n + i, n + j)] = closed.damping()[i * n + j];
            }
        }
        a[(n + bearing, 2 * n)] = C64::ONE;
        a[(2 * n, 2 * n)] = C64::from(-self.corner);
        (0..2 * n).for_each(|j| c[(n, j)] = -law[j] * self.force);
        c[(n, 2 * n)] = C64::from(self.force);
        let lyapunov = Lyapunov::of(a)?;
        let cost = lyapunov.observed(&(c.adjoint() * &c));
        let drive = 2.0 * self.corner;
        let of_noise = drive * cost[(2 * n, 2 * n)].re;
        let law_square: f64 = law.iter().map(C64::norm_sqr).sum();
        let noise = 2.0 * self.noise * self.noise;
        let square = of_unbalance + noise * law_square * of_noise;
        if !(square.is_finite() && square > 0.0) {
            return None;
        }
        if slope.is_empty() {
            return Some(square);
        }

        let mut driven = DMatrix::<C64>::zeros(size, size);
        driven[(2 * n, 2 * n)] = C64::from(drive);
        let variance = lyapunov.driven(&driven);
        let (through, out) = (&variance * &cost, &variance * c.adjoint());
        let mut unit = vec![C64::ZERO; n];
        unit[bearing] = C64::ONE;
        closed.respond(s, &mut unit);
        let back: C64 = whirl.iter().zip(&unit).map(|(p, g)| p.conj() * g).sum();
        let by_whirl = -back - force.conj() * weight * (C64::ONE - read(&unit));
        // What each entry of the row, real and imaginary part alike, changes J^2 by: twice the real part of it times the change.
        let by: Vec<C64> = (0..2 * n)
            .map(|j| {
                let moved = if j < n { whirl[j] } else { s * whirl[j - n] };
                let of_noise_by = -through[(j, n + bearing)] - out[(j, n)] * self.force;
                by_whirl * moved + (law[j].conj() * of_noise + of_noise_by * law_square) * noise
            })
            .collect();
        let mut one = vec![0.0; slope.len()];
        for k in 0..slope.len() {
            one[k] = 1.0;
            let change = structure.row(&one, speed);
            one[k] = 0.0;
            let changes = change.displacement[..n].iter().chain(&change.velocity[..n]);
            slope[k] = 2.0 * changes.zip(&by).map(|(d, by)| (d * by).re).sum::<f64>();
        }
        Some(square)
    }
}

/// `A = U T U*` with `T` upper triangular, for equations of Lyapunov.
struct Lyapunov {
    turn: DMatrix<C64>,
    upper: DMatrix<C64>,
}

impl Lyapunov {
    /// `None` if the Schur form cannot be had.
    fn of(a: DMatrix<C64>) -> Option<Self> {
        if a.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let (turn, upper) = Schur::try_new(a, f64::EPSILON, 10_000)?.unpack();
        Some(Self { turn, upper })
    }

    /// `P` of `A P + P A* + F = 0`.
    fn driven(&self, f: &DMatrix<C64>) -> DMatrix<C64> {
        let (t, size) = (&self.upper, self.upper.nrows());
        let g = self.turn.adjoint() * f * &self.turn;
        let mut y = DMatrix::<C64>::zeros(size, size);
        for j in (0..size).rev() {
            let mut right: DVector<C64> = -g.column(j);
            (j + 1..size).for_each(|k| right -= y.column(k) * t[(j, k)].conj());
            for i in (0..size).rev() {
                let known: C64 = (i + 1..size).map(|k| t[(i, k)] * y[(k, j)]).sum();
                y[(i, j)] = (right[i] - known) / (t[(i, i)] + t[(j, j)].conj());
            }
        }
        &self.turn * y * self.turn.adjoint()
    }

    /// `Q` of `A* Q + Q A + F = 0`.
    fn observed(&self, f: &DMatrix<C64>) -> DMatrix<C64> {
        let (t, size) = (&self.upper, self.upper.nrows());
        let g = self.turn.adjoint() * f * &self.turn;
        let mut y = DMatrix::<C64>::zeros(size, size);
        for j in 0..size {
            let mut right: DVector<C64> = -g.column(j);
            (0..j).for_each(|k| right -= y.column(k) * t[(k, j)]);
            for i in 0..size {
                let known: C64 = (0..i).map(|k| t[(k, i)].conj() * y[(k, j)]).sum();
                y[(i, j)] = (right[i] - known) / (t[(i, i)].conj() + t[(j, j)]);
            }
        }
        &self.turn * y * self.turn.adjoint()
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;
    use crate::{Family, Schedule, Structure};

    #[test]
    fn slopes_are_those_of_the_cost() {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let structure =
            Structure::new(&rotor, &Structure::individual(3, 0, &[0, 1]), Schedule::Linear { from: 0.0, to: 6.0 });
        let problem = Problem::new(Family::new(&rotor, 0.0, 6.0).expect("a range"), structure.expect("fits"), 20.0);
        let mut gains: Vec<f64> = (0..16).map(|k| 0.3 * f64::sin(k as f64)).collect();
        // Damped enough to be stable.
        gains[2..4].fill(2.0);
        let cost = Cost { force: 0.3, noise: 0.2, corner: 3.0 };
        for speed in [0.5, 1.5] {
            let mut slope = vec![0.0; gains.len()];
            cost.worth(&problem, &gains, &[speed], &mut slope).expect("stable");
            for k in 0..gains.len() {
                let there = |by: f64| {
                    let mut moved = gains.clone();
                    moved[k] += by;
                    cost.worth(&problem, &moved, &[speed], &mut []).expect("stable")
                };
                let difference = (there(1e-5) - there(-1e-5)) / 2e-5;
                let scale = slope.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
                assert!(
                    (difference - slope[k]).abs() < 1e-7 * scale,
                    "{k} at {speed}: {difference} beside {}",
                    slope[k]
                );
            }
        }
    }
}
