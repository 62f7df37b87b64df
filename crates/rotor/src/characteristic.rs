//! The characteristic equation of a machine as it is, and its roots: `s` of a continuous loop, with or without a delay, or
//! `z` of a sampled one, where `s = ln(z) / h`.
//!
//! Whether the real part of a pole is rounding is asked twice. Eigenvalues are known to some last places of the norm of the matrix, which
//! is enough for nearly all. Where a bearing is so stiff that this drowns the slow modes, which leave it at rest, a pole is sharpened
//! and judged by what the last places of the coefficients can do to it alone ([`linear::SharpRoot`]).

use linear::{DelayError, DelaySystem};
use nalgebra::DMatrix;

use crate::{C64, LinearForm};

/// What is over within a sample is no motion: roots `z` smaller than this have no `s` to speak of.
const OVER_AT_ONCE: f64 = 1e-9;
/// Last places a state that rounding may cost.
const LAST_PLACES: f64 = 64.0;
/// A pole that moves by more than this part of itself when it is sharpened was not known well enough to be told from others.
const SAME: f64 = 0.1;

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
        let told = |root: C64| {
            let known = CharacteristicRoot { root, pole: pole(root) };
            if known.pole.re.abs() > self.rounding { known } else { self.settled(known, pole) }
        };
        roots.into_iter().filter(|root| self.period.is_none() || root.norm() > OVER_AT_ONCE).map(told).collect()
    }

    /// A pole whose real part may be rounding: sharper, or with none.
    fn settled(&self, known: CharacteristicRoot, pole: impl Fn(C64) -> C64) -> CharacteristicRoot {
        let marginal = CharacteristicRoot { pole: C64::new(0.0, known.pole.im), ..known };
        let Some(sharp) = self.system.sharpened(known.root) else { return marginal };
        let found = CharacteristicRoot { root: sharp.root, pole: pole(sharp.root) };
        // `ds = dz / (z h)`.
        let per_root = self.period.map_or(1.0, |period| 1.0 / (period * sharp.root.norm()));
        let rounding = LAST_PLACES * self.system.a().nrows() as f64 * sharp.last_place * per_root;
        let is_same = (sharp.root - known.root).norm() <= SAME * known.root.norm();
        if is_same && found.pole.re.abs() > rounding { found } else { marginal }
    }
}
