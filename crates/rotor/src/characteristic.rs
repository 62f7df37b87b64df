//! The characteristic equation of a machine as it is, and its roots: `s` of a continuous loop, with or without a delay, or
//! `z` of a sampled one, where `s = ln(z) / h`.
//!
//! Whether the real part of a pole is rounding is asked twice. Eigenvalues are known to some last places of the norm of the matrix, which
//! is enough for nearly all. Where a bearing is so stiff that this drowns the slow modes, which leave it at rest, a pole is sharpened
//! and judged by what the last places of the coefficients can do to it alone ([`linear::SharpRoot`]).
//!
//! A rotor that nothing holds moves as a whole at a double pole of exactly 0, which rounding splits by its root, to either side. So motions
//! that are known to be free are taken out before eigenvalues are computed: with `A (T, 0) = 0` the others are those of `A` beside `T`.

use linear::{DelayError, DelaySystem};
use nalgebra::{DMatrix, DVector};

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
    /// Where free motions are taken out: what is beside them, and how many they are.
    without_free: Option<(DelaySystem, usize)>,
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
        let made = Self::new(matrices, form.delay, None)?;
        Ok(Self { without_free: made.without(&form.free, form.coordinates), ..made })
    }

    /// What is beside free motions of the first `n` states, and how many they are; `None` without any, or where the loop answers to one.
    fn without(&self, free: &[Vec<C64>], n: usize) -> Option<(DelaySystem, usize)> {
        let (a, through) = (self.system.a(), self.system.b() * self.system.c());
        let (size, count) = (a.nrows(), free.len());
        if count == 0 || (self.system.delay() > 0.0 && through.iter().any(|z| *z != C64::ZERO)) {
            return None;
        }
        // The plant's own answer, which is that of its coordinates' rates, is known to be none.
        let is_free = |motion: &Vec<C64>| {
            let moved = DVector::from_fn(size, |i, _| motion.get(i).copied().unwrap_or(C64::ZERO));
            let others = (a * &moved).into_iter().enumerate().any(|(i, z)| *z != C64::ZERO && !(n..2 * n).contains(&i));
            !others && (&through * moved).iter().all(|z| *z == C64::ZERO)
        };
        if !free.iter().all(is_free) {
            return None;
        }
        let joined = DMatrix::from_fn(n, count + n, |i, k| match k.checked_sub(count) {
            None => free[k][i],
            Some(k) => C64::from(f64::from(i == k)),
        });
        let mut basis = DMatrix::identity(size, size);
        basis.view_mut((0, 0), (n, n)).copy_from(&joined.qr().q());
        let others = basis.columns(count, size - count);
        let beside = others.adjoint() * (a + through) * others;
        let (b, c) = (DMatrix::zeros(size - count, 0), DMatrix::zeros(0, size - count));
        Some((DelaySystem::new(beside, b, c, 0.0).ok()?, count))
    }

    /// That of `x' = A x + B C x(t - delay)`, or, with a sampling period, of the step `x <- A x`, `B` and `C` being empty.
    ///
    /// # Errors
    /// Matrices that do not fit or are not finite.
    pub fn new([a, b, c]: [DMatrix<C64>; 3], delay: f64, period: Option<f64>) -> Result<Self, DelayError> {
        let n = a.nrows();
        let (b, c) = if b.is_empty() { (DMatrix::zeros(n, 0), DMatrix::zeros(0, n)) } else { (b, c) };
        let rounding = LAST_PLACES * f64::EPSILON * n as f64 * (&a + &b * &c).norm() / period.unwrap_or(1.0);
        Ok(Self { system: DelaySystem::new(a, b, c, delay)?, period, rounding, without_free: None })
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
        if let Some((beside, count)) = &self.without_free {
            let others = linear::eigenvalues(beside.a().clone())?.into_iter().map(|root| self.or_zero(root));
            let right_of = self.right_of().unwrap_or(f64::NEG_INFINITY);
            let all = std::iter::repeat_n(C64::ZERO, *count).chain(others);
            return Ok(self.told(all.filter(|root| root.re > right_of).collect()));
        }
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

    /// A root beside free motions, such as their drift, that may be 0 but for rounding.
    fn or_zero(&self, root: C64) -> C64 {
        if root.norm() > self.rounding {
            return root;
        }
        let sharp = self.judge().sharpened(root).filter(|sharp| is_same(sharp.root, root));
        sharp
            .filter(|sharp| sharp.root.norm() > self.last_places(sharp.last_place))
            .map_or(C64::ZERO, |sharp| sharp.root)
    }

    /// The equation without its free motions, which are double and never sharp.
    fn judge(&self) -> &DelaySystem {
        self.without_free.as_ref().map_or(&self.system, |(beside, _)| beside)
    }

    /// What rounding may cost where the last place of every coefficient costs so much.
    fn last_places(&self, one: f64) -> f64 {
        LAST_PLACES * self.system.a().nrows() as f64 * one
    }

    /// A pole whose real part may be rounding: sharper, or with none.
    fn settled(&self, known: CharacteristicRoot, pole: impl Fn(C64) -> C64) -> CharacteristicRoot {
        let marginal = CharacteristicRoot { pole: C64::new(0.0, known.pole.im), ..known };
        let Some(sharp) = self.judge().sharpened(known.root) else { return marginal };
        let found = CharacteristicRoot { root: sharp.root, pole: pole(sharp.root) };
        // `ds = dz / (z h)`.
        let per_root = self.period.map_or(1.0, |period| 1.0 / (period * sharp.root.norm()));
        let rounding = self.last_places(sharp.last_place) * per_root;
        if is_same(sharp.root, known.root) && found.pole.re.abs() > rounding { found } else { marginal }
    }
}

fn is_same(sharp: C64, known: C64) -> bool {
    (sharp - known).norm() <= SAME * known.norm()
}
