//! Newton's method on the whirl equation, for a given set of bearings in contact and one closing condition.
//!
//! The unknowns are one real vector: real parts of `c`, imaginary parts of `c`, for a limit cycle the frequency, and last
//! the speed. The closing condition makes the count even: a given speed, a mass on the edge of its clearance, or a
//! point at a given arclength along a branch.

use nalgebra::{DMatrix, DVector};

use super::problem::{Contact, Problem};
use crate::C64;

/// What completes the equations.
#[derive(Clone, Copy)]
pub(super) enum Closing<'a> {
    /// The spin speed is given.
    Speed(f64),
    /// This mass is on the edge of its clearance.
    Edge(usize),
    /// On the plane through `at` normal to `row`.
    Plane { at: &'a DVector<f64>, row: &'a DVector<f64> },
}

const MAX_ITERATIONS: usize = 40;

impl Problem<'_> {
    /// How many unknowns there are, the speed included.
    pub(super) fn unknowns(&self) -> usize {
        2 * self.masses + if self.forced { 1 } else { 2 }
    }

    /// Packs the unknowns.
    pub(super) fn pack(&self, c: &[C64], frequency: f64, speed: f64) -> DVector<f64> {
        let own = (!self.forced).then_some(frequency);
        let parts = c.iter().map(|c| c.re).chain(c.iter().map(|c| c.im)).chain(own).chain([speed]);
        DVector::from_iterator(self.unknowns(), parts)
    }

    /// Unpacks amplitudes, frequency and speed.
    pub(super) fn unpack(&self, x: &DVector<f64>) -> (DVector<C64>, f64, f64) {
        let n = self.masses;
        let c = DVector::from_fn(n, |k, _| C64::new(x[k], x[n + k]));
        let speed = x[self.unknowns() - 1];
        (c, if self.forced { self.frequency(speed) } else { x[2 * n] }, speed)
    }

    /// Equations and their derivatives at `x`, without the closing condition; and the size of the terms in them.
    ///
    /// `phase` fixes the free phase of a limit cycle: `Im <phase, c> = 0`.
    pub(super) fn linearise(
        &self,
        x: &DVector<f64>,
        contact: Contact,
        phase: &DVector<C64>,
    ) -> (DVector<f64>, DMatrix<f64>, f64) {
        let (residual, mut slope, scale) = self.linearise_at(x, contact, phase);
        let (c, frequency, speed) = self.unpack(x);
        let by = self.by_last(&self.at(speed), &c, frequency, speed, contact);
        for (k, by) in by.iter().enumerate() {
            slope[(k, self.unknowns() - 1)] = by.re;
            slope[(self.masses + k, self.unknowns() - 1)] = by.im;
        }
        (residual, slope, scale)
    }

    /// The same at a speed that is given and stays: the derivative by it, which costs most, is left at 0.
    fn linearise_at(
        &self,
        x: &DVector<f64>,
        contact: Contact,
        phase: &DVector<C64>,
    ) -> (DVector<f64>, DMatrix<f64>, f64) {
        let n = self.masses;
        let unknowns = self.unknowns();
        let (c, frequency, speed) = self.unpack(x);
        let equation = self.at(speed);
        let f = equation.residual(&c, frequency, contact);
        let (a, b) = equation.slope(c.as_slice(), frequency, contact);

        let mut residual = DVector::zeros(unknowns - 1);
        let mut slope = DMatrix::zeros(unknowns - 1, unknowns);
        let column = |slope: &mut DMatrix<f64>, at: usize, by: &DVector<C64>| {
            for k in 0..n {
                slope[(k, at)] = by[k].re;
                slope[(n + k, at)] = by[k].im;
            }
        };
        for i in 0..n {
            residual[i] = f[i].re;
            residual[n + i] = f[i].im;
            for k in 0..n {
                let (a, b) = (a[(i, k)], if i == k { b[i] } else { C64::ZERO });
                slope[(i, k)] = (a + b).re;
                slope[(i, n + k)] = -(a - b).im;
                slope[(n + i, k)] = (a + b).im;
                slope[(n + i, n + k)] = (a - b).re;
            }
        }
        if !self.forced {
            column(&mut slope, 2 * n, &equation.by_frequency(&c, frequency));
            residual[2 * n] = phase.dotc(&c).im;
            for k in 0..n {
                slope[(2 * n, k)] = -phase[k].im;
                slope[(2 * n, n + k)] = phase[k].re;
            }
        }
        (residual, slope, equation.scale(&c, frequency))
    }

    /// Solves from `x` on; `None` if it does not converge to a finite solution.
    pub(super) fn solve(&self, x: DVector<f64>, contact: Contact, closing: Closing<'_>) -> Option<DVector<f64>> {
        self.iterate(x, Some(contact), closing)
    }

    /// The same with every bearing in contact whose clearance the iteration is beyond, whatever that is at the end.
    pub(super) fn solve_any(&self, x: DVector<f64>, closing: Closing<'_>) -> Option<(DVector<f64>, Contact)> {
        let x = self.iterate(x, None, closing)?;
        let contact = self.touching(&self.unpack(&x).0);
        Some((x, contact))
    }

    fn iterate(&self, mut x: DVector<f64>, given: Option<Contact>, closing: Closing<'_>) -> Option<DVector<f64>> {
        let (n, last) = (self.masses, self.unknowns() - 1);
        let phase = self.unpack(&x).0;
        let mut halvings = 0;
        let mut before: Option<(f64, DVector<f64>, DVector<f64>)> = None;
        for _ in 0..MAX_ITERATIONS {
            let contact = given.unwrap_or_else(|| self.touching(&self.unpack(&x).0));
            let (f, slope, scale) = match closing {
                Closing::Speed(speed) if x[last] == speed => self.linearise_at(&x, contact, &phase),
                _ => self.linearise(&x, contact, &phase),
            };
            let mut residual = f.push(0.0);
            let mut matrix = slope.insert_row(last, 0.0);
            let (unit, closing_residual) = match closing {
                Closing::Speed(speed) => {
                    matrix[(last, last)] = 1.0;
                    (1.0, x[last] - speed)
                }
                Closing::Edge(k) => {
                    let (re, im) = (x[k], x[n + k]);
                    let (r, g) = (re.hypot(im), self.clearance(k));
                    matrix[(last, k)] = re / r;
                    matrix[(last, n + k)] = im / r;
                    (g, r - g)
                }
                Closing::Plane { at, row } => {
                    matrix.row_mut(last).copy_from(&row.transpose());
                    (1.0, row.dot(&(&x - at)))
                }
            };
            residual[last] = closing_residual;
            let size = residual.rows(0, last).norm() / scale.max(f64::MIN_POSITIVE) + (closing_residual / unit).abs();
            if !size.is_finite() {
                return None;
            }
            // A full step that makes things worse is halved: the direction is right, the curvature was not.
            if let Some((best, from, step)) = &before
                && size > *best * 1.5
                && *best > 1e-9
                && halvings < 8
            {
                halvings += 1;
                x = from + step * 0.5_f64.powi(halvings);
                continue;
            }
            halvings = 0;
            let step = -matrix.lu().solve(&residual)?;
            if !step.iter().all(|d| d.is_finite()) {
                return None;
            }
            let tiny = (0..=last).all(|i| {
                let reference = if i < 2 * n { x.rows(0, 2 * n).norm() } else { x[i].abs().max(1e-3) };
                step[i].abs() <= 1e-13 * reference
            });
            let next = &x + &step;
            if tiny || size < 1e-15 {
                return (size < 1e-10).then_some(next);
            }
            before = Some((size, x, step));
            x = next;
        }
        // Rounding can keep the last digits moving; what counts is that the equations hold.
        before.filter(|(size, ..)| *size < 1e-12).map(|_| x)
    }
}
