//! The gain of one loop over frequency: `L(j w) = - C (j w - A)^-1 B exp(-j w T)` of a loop opened where its delay acts, or
//! `- C (z - A)^-1 B` at `z = exp(j w h)` of a sampled one.
//!
//! `A` is brought to Hessenberg form once, so that a frequency costs a few hundred operations and nothing is approximated.

use nalgebra::{DMatrix, DVector, Hessenberg};

use crate::balance::balance_matrix;
use crate::{C64, DelayError, DelaySystem, eigenvalues};

/// What frequency means.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plane {
    /// `s = j w`, late by a delay.
    Continuous { delay: f64 },
    /// `z = exp(j w h)`.
    Sampled { period: f64 },
}

/// The gain of one loop.
#[derive(Clone, Debug)]
pub struct LoopGain {
    /// Upper Hessenberg, row by row.
    a: Vec<C64>,
    b: Vec<C64>,
    c: Vec<C64>,
    plane: Plane,
    poles: Vec<C64>,
    /// `|A|` and `|B| |C|`.
    sizes: [f64; 2],
}

/// A loop's gain at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyGain {
    /// Frequency in radians per unit of time; negative for backward whirl.
    pub frequency: f64,
    /// `L`.
    pub value: C64,
    /// `dL / dw`.
    pub slope: C64,
}

impl FrequencyGain {
    /// The sensitivity `S = 1 / (1 + L)`.
    #[must_use]
    pub fn sensitivity(&self) -> C64 {
        (self.value + 1.0).inv()
    }

    /// The complementary sensitivity `L / (1 + L)`.
    #[must_use]
    pub fn complementary(&self) -> C64 {
        self.value / (self.value + 1.0)
    }
}

impl LoopGain {
    /// The loop of `x' = A x + B C x(t - T)`, opened between `C` and `B`.
    ///
    /// # Errors
    /// None or several loops, or eigenvalues that cannot be had.
    pub fn of(system: &DelaySystem) -> Result<Self, DelayError> {
        let plane = Plane::Continuous { delay: system.delay() };
        Self::new(system.a().clone(), system.b(), system.c(), plane)
    }

    /// The loop of `x <- A x + B w`, `w = C x`, sampled every `period`.
    ///
    /// # Errors
    /// None or several loops, or eigenvalues that cannot be had.
    pub fn sampled(a: DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, period: f64) -> Result<Self, DelayError> {
        Self::new(a, b, c, Plane::Sampled { period })
    }

    fn new(mut a: DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, plane: Plane) -> Result<Self, DelayError> {
        if b.ncols() != 1 || c.nrows() != 1 {
            return Err(DelayError::Several(b.ncols()));
        }
        if !a.iter().chain(b).chain(c).all(|z| z.is_finite()) {
            return Err(DelayError::NotFinite);
        }
        let scales = balance_matrix(&mut a);
        let b = DVector::from_fn(a.nrows(), |i, _| b[i] / scales[i]);
        let c = DVector::from_fn(a.nrows(), |i, _| c[i] * scales[i]);
        let sizes = [a.norm(), b.norm() * c.norm()];
        let poles = eigenvalues(a.clone())?;
        let (q, h) = if a.nrows() > 1 { Hessenberg::new(a).unpack() } else { (DMatrix::identity(1, 1), a) };
        Ok(Self {
            a: h.transpose().as_slice().to_vec(),
            b: (q.adjoint() * b).as_slice().to_vec(),
            c: (q.transpose() * c).as_slice().to_vec(),
            plane,
            poles,
            sizes,
        })
    }

    /// Poles of the open loop: of `A`, in `s`, or in `z`.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// The delay that is in it.
    #[must_use]
    pub fn delay(&self) -> f64 {
        if let Plane::Continuous { delay } = self.plane { delay } else { 0.0 }
    }

    /// The sampling period; 0 of a continuous loop.
    #[must_use]
    pub fn period(&self) -> f64 {
        if let Plane::Sampled { period } = self.plane { period } else { 0.0 }
    }

    /// Frequency and half width of each resonance of the open loop.
    pub(crate) fn resonances(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.poles.iter().filter(|p| **p != C64::ZERO).map(|pole| match self.plane {
            Plane::Continuous { .. } => [pole.im, pole.re.abs()],
            Plane::Sampled { period } => [pole.arg() / period, pole.norm().ln().abs() / period],
        })
    }

    /// A frequency beyond which `|L|` is less than `least`; of a sampled loop, half the sampling rate.
    #[must_use]
    pub fn beyond(&self, least: f64) -> f64 {
        match self.plane {
            Plane::Continuous { .. } => self.sizes[0] + self.sizes[1] / least,
            Plane::Sampled { period } => std::f64::consts::PI / period,
        }
    }

    /// `L` at a frequency; not finite at a pole on the axis.
    #[must_use]
    pub fn at(&self, frequency: f64) -> FrequencyGain {
        let s = C64::new(0.0, frequency);
        let [value, slope] = match self.plane {
            Plane::Continuous { delay } => {
                let [value, by_s] = self.solve(s);
                let late = (-s * delay).exp();
                [value * late, (by_s - value * delay) * late * C64::I]
            }
            Plane::Sampled { period } => {
                let z = (s * period).exp();
                let [value, by_z] = self.solve(z);
                [value, by_z * z * C64::I * period]
            }
        };
        FrequencyGain { frequency, value, slope }
    }

    /// `- c (s - A)^-1 b` and its derivative by `s`, by elimination with rows exchanged.
    fn solve(&self, s: C64) -> [C64; 2] {
        let n = self.b.len();
        let mut m: Vec<C64> = self.a.iter().map(|a| -a).collect();
        (0..n).for_each(|i| m[i * n + i] += s);
        // (s - A) x = b; then (s - A) y = x. Row operations are kept to be done to x too.
        let mut x = self.b.clone();
        let mut steps: Vec<(bool, C64)> = Vec::with_capacity(n);
        for i in 0..n.saturating_sub(1) {
            let swap = m[(i + 1) * n + i].l1_norm() > m[i * n + i].l1_norm();
            if swap {
                let (above, below) = m.split_at_mut((i + 1) * n);
                above[i * n + i..].swap_with_slice(&mut below[i..n]);
                x.swap(i, i + 1);
            }
            let factor = m[(i + 1) * n + i] / m[i * n + i];
            if factor != C64::ZERO {
                let (above, below) = m.split_at_mut((i + 1) * n);
                for (to, from) in below[i..n].iter_mut().zip(&above[i * n + i..]) {
                    *to -= factor * from;
                }
                let from = x[i];
                x[i + 1] -= factor * from;
            }
            steps.push((swap, factor));
        }
        let back = |x: &mut [C64]| {
            for i in (0..n).rev() {
                let row = &m[i * n..(i + 1) * n];
                let known: C64 = row[i + 1..].iter().zip(&x[i + 1..]).map(|(m, x)| m * x).sum();
                x[i] = (x[i] - known) / row[i];
            }
        };
        back(&mut x);
        let mut y = x.clone();
        for (i, (swap, factor)) in steps.iter().enumerate() {
            if *swap {
                y.swap(i, i + 1);
            }
            let from = y[i];
            y[i + 1] -= factor * from;
        }
        back(&mut y);
        let read = |x: &[C64]| self.c.iter().zip(x).map(|(c, x)| c * x).sum::<C64>();
        [-read(&x), read(&y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(delay: f64) -> DelaySystem {
        let n = 5;
        let a = DMatrix::from_fn(n, n, |i, k| C64::new((1.0 + i as f64 * 1.7 + k as f64).sin(), (i * k) as f64 * 0.1));
        let b = DMatrix::from_fn(n, 1, |i, _| C64::new(0.3 * i as f64, 1.0));
        let c = DMatrix::from_fn(1, n, |_, k| C64::new(1.0, -0.2 * k as f64));
        DelaySystem::new(a, b, c, delay).unwrap()
    }

    #[test]
    fn the_gain_is_that_of_the_matrices_and_its_slope_that_of_differences() {
        for delay in [0.0, 0.7] {
            let system = system(delay);
            let gain = LoopGain::of(&system).unwrap();
            for w in [-30.0, -2.0, 0.1, 0.3, 5.0] {
                let s = C64::new(0.0, w);
                let mut m = -system.a().clone();
                (0..5).for_each(|i| m[(i, i)] += s);
                let expected = -(system.c() * m.lu().solve(system.b()).unwrap())[0] * (-s * delay).exp();
                let here = gain.at(w);
                assert!((here.value - expected).norm() < 1e-12 * (1.0 + expected.norm()), "{w}");
                let h = 1e-6;
                let difference = (gain.at(w + h).value - gain.at(w - h).value) / (2.0 * h);
                assert!(
                    (here.slope - difference).norm() < 1e-7 * (1.0 + difference.norm()),
                    "{w}: {} {difference}",
                    here.slope
                );
            }
        }
    }

    #[test]
    fn a_sampled_gain_is_that_of_its_step() {
        let system = system(0.0);
        let gain = LoopGain::sampled(system.a().clone(), system.b(), system.c(), 0.1).unwrap();
        let z = C64::cis(0.2);
        let mut m = -system.a().clone();
        (0..5).for_each(|i| m[(i, i)] += z);
        let expected = -(system.c() * m.lu().solve(system.b()).unwrap())[0];
        assert!((gain.at(2.0).value - expected).norm() < 1e-12 * expected.norm());
        let difference = (gain.at(2.0 + 1e-6).value - gain.at(2.0 - 1e-6).value) / 2e-6;
        assert!((gain.at(2.0).slope - difference).norm() < 1e-7 * (1.0 + difference.norm()));
    }
}
