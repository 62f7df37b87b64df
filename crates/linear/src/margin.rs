//! How long a delay may be before a root reaches the axis.

use nalgebra::DMatrix;

use crate::inverse::invert;
use crate::loci::borne;
use crate::{C64, DelayError, DelaySystem, eigenvalues};

/// The smallest delay that puts a root on the imaginary axis, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayMargin {
    /// The delay.
    pub delay: f64,
    /// The frequency of the root there; negative for backward whirl.
    pub frequency: f64,
}

impl DelaySystem {
    /// The smallest delay that puts a root on the axis, whatever delay the system has now: over all `w` of both signs with
    /// `|H(j w)| = 1`, `H(s) = C (s I - A)^-1 B`, the least `T >= 0` with `exp(j w T) = H(j w)`. `None` if no delay does.
    ///
    /// The frequencies are eigenvalues on the axis of `[A, B B*; -C* C, -A*]`: there a gain of `H` is 1.
    ///
    /// # Errors
    /// More than one loop, or eigenvalues that cannot be had.
    pub fn delay_margin(&self) -> Result<Option<DelayMargin>, DelayError> {
        let system = &self.balanced;
        if system.b.ncols() != 1 {
            return Err(DelayError::Several(system.b.ncols()));
        }
        let n = system.size();
        let mut hamiltonian = DMatrix::zeros(2 * n, 2 * n);
        hamiltonian.view_mut((0, 0), (n, n)).copy_from(&system.a);
        hamiltonian.view_mut((0, n), (n, n)).copy_from(&(&system.b * system.b.adjoint()));
        hamiltonian.view_mut((n, 0), (n, n)).copy_from(&(-(system.c.adjoint() * &system.c)));
        hamiltonian.view_mut((n, n), (n, n)).copy_from(&(-system.a.adjoint()));
        let size = hamiltonian.norm();
        let mut least: Option<DelayMargin> = None;
        for s in eigenvalues(hamiltonian)? {
            // A pair that touches the axis leaves it by the root of rounding.
            if s.re.abs() > 1e-6 * size {
                continue;
            }
            let Some((w, gain)) = self.crossing_near(s.im) else { continue };
            // exp(j w T) = H.
            let delay = borne(-gain, w);
            if delay.is_finite() && least.is_none_or(|least| delay < least.delay) {
                least = Some(DelayMargin { delay, frequency: w });
            }
        }
        Ok(least)
    }

    /// Newton's method on `log |H(j w)|^2 = 0`, and `H` there.
    fn crossing_near(&self, w: f64) -> Option<(f64, C64)> {
        let mut w = w;
        for _ in 0..20 {
            let (gain, slope) = self.response(w)?;
            // d log |H|^2 / dw = 2 Re(j H' / H).
            let rate = 2.0 * (C64::I * slope / gain).re;
            let step = gain.norm_sqr().ln() / rate;
            // At a gain that only touches 1 there is no slope: it is as good as it gets.
            if !step.is_finite() || step.abs() > 1e-3 * (1.0 + w.abs()) {
                break;
            }
            w -= step;
            if step.abs() <= 1e-15 * (1.0 + w.abs()) {
                break;
            }
        }
        let gain = self.response(w)?.0;
        ((gain.norm() - 1.0).abs() < 1e-6).then_some((w, gain))
    }

    /// `H(j w)` and `dH / ds` there.
    fn response(&self, w: f64) -> Option<(C64, C64)> {
        let system = &self.balanced;
        let mut m = -system.a.clone();
        (0..system.size()).for_each(|i| m[(i, i)] += C64::new(0.0, w));
        let inverse = invert(m)?.inverse;
        let moved = &inverse * &system.b;
        let gain = (&system.c * &moved)[0];
        let slope = -(&system.c * &inverse * &moved)[0];
        Some((gain, slope))
    }
}
