//! The characteristic equation of a machine as it is, and its roots: `s` of a continuous loop, with or without a delay, or
//! `z` of a sampled one, where `s = ln(z) / h`.

use linear::{DelayError, DelaySystem};
use nalgebra::DMatrix;

use crate::{C64, LinearForm};

/// What is over within a sample is no motion: roots `z` smaller than this have no `s` to speak of.
const OVER_AT_ONCE: f64 = 1e-9;
/// Last places a state that rounding may cost.
const LAST_PLACES: f64 = 64.0;

/// A root of a machine's characteristic equation, and the pole that it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharacteristicRoot {
    /// `s`, or `z` of a sampled loop: what moves continuously when the machine does.
    pub root: C64,
    /// `s`; its real part is exactly 0 where it is rounding.
    pub pole: C64,
}

/// A machine's characteristic equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Characteristic {
    system: DelaySystem,
    period: Option<f64>,
    rounding: f64,
}

impl Characteristic {
    /// That of a machine's matrices.
    ///
    /// # Errors
    /// Matrices that are not finite.
    pub fn of(form: &LinearForm) -> Result<Self, DelayError> {
        if let Some(step) = form.sampled() {
            return Self::new([step.a, DMatrix::zeros(0, 0), DMatrix::zeros(0, 0)], 0.0, Some(step.period));
        }
        let Some(matrices) = form.continuous() else { unreachable!("a loop is sampled or continuous") };
        Self::new(matrices, form.delay, None)
    }

    /// That of `x' = A x + B C x(t - delay)`, or, with a sampling period, of the step `x <- A x`, `B` and `C` being empty.
    ///
    /// # Errors
    /// Matrices that do not fit or are not finite.
    pub fn new([a, b, c]: [DMatrix<C64>; 3], delay: f64, period: Option<f64>) -> Result<Self, DelayError> {
        let n = a.nrows();
        let (b, c) = if b.is_empty() { (DMatrix::zeros(n, 0), DMatrix::zeros(0, n)) } else { (b, c) };
        let rounding = LAST_PLACES * f64::EPSILON * n as f64 * (&a + &b * &c).norm() / period.unwrap_or(1.0);
        Ok(Self { system: DelaySystem::new(a, b, c, delay)?, period, rounding })
    }

    /// The equation itself; of a sampled loop in `z`.
    #[must_use]
    pub fn system(&self) -> &DelaySystem {
        &self.system
    }

    /// The sampling period, if its roots are `z`.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// The line right of which its roots are found, where there are infinitely many.
    #[must_use]
    pub fn right_of(&self) -> Option<f64> {
        (self.system.delay() > 0.0).then(|| self.system.echo_line())
    }

    /// What a real part may be by rounding alone.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Its roots, all of them, or all right of the line.
    ///
    /// # Errors
    /// Roots that cannot be had.
    pub fn roots(&self) -> Result<Vec<CharacteristicRoot>, DelayError> {
        Ok(self.told(self.system.roots_right_of(self.right_of().unwrap_or(f64::NEG_INFINITY))?.roots))
    }

    /// Roots with the poles that they are, without those of a sampled loop that are over at once.
    #[must_use]
    pub fn told(&self, roots: Vec<C64>) -> Vec<CharacteristicRoot> {
        let pole = |root: C64| match self.period {
            Some(period) => root.ln() / period,
            None => root,
        };
        let settled = |s: C64| C64::new(if s.re.abs() <= self.rounding { 0.0 } else { s.re }, s.im);
        roots
            .into_iter()
            .filter(|root| self.period.is_none() || root.norm() > OVER_AT_ONCE)
            .map(|root| CharacteristicRoot { root, pole: settled(pole(root)) })
            .collect()
    }
}
