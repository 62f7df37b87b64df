//! Arithmetic on a register of trajectories.

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;

/// One number a trajectory. Every operation rounds as it does on one number, so that a trajectory is the same to the last bit in
/// registers of any width: nothing is fused into one rounding, and nothing is summed across trajectories.
#[derive(Clone, Copy)]
pub(super) struct V<S: Simd> {
    simd: S,
    of: S::f64s,
}

/// One bit a trajectory.
#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd> {
    simd: S,
    of: S::m64s,
}

impl<S: Simd> V<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, of: S::f64s) -> Self {
        Self { simd, of }
    }

    #[inline(always)]
    pub(super) fn all(simd: S, number: f64) -> Self {
        Self { simd, of: simd.splat_f64s(number) }
    }

    #[inline(always)]
    pub(super) fn raw(self) -> S::f64s {
        self.of
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self { of: self.simd.sqrt_f64s(self.of), ..self }
    }

    /// The larger of both, neither of which may be NaN.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Self { of: self.simd.max_f64s(self.of, other.of), ..self }
    }

    /// False where either is NaN, as are the others.
    #[inline(always)]
    pub(super) fn above(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.greater_than_f64s(self.of, other.of) }
    }

    #[inline(always)]
    pub(super) fn at_least(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.greater_than_or_equal_f64s(self.of, other.of) }
    }

    #[inline(always)]
    pub(super) fn at_most(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.less_than_or_equal_f64s(self.of, other.of) }
    }

    /// The numbers of `of` where `mask` is set, its own elsewhere.
    #[inline(always)]
    pub(super) fn replaced(self, mask: Mask<S>, of: Self) -> Self {
        Self { of: self.simd.select_f64s(mask.of, of.of, self.of), ..self }
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        Self { of: self.simd.and_m64s(self.of, other.of), ..self }
    }

    #[inline(always)]
    pub(super) fn not(self) -> Self {
        Self { of: self.simd.not_m64s(self.of), ..self }
    }

    #[inline(always)]
    pub(super) fn any(self) -> bool {
        pulp::bytemuck::bytes_of(&self.of).iter().fold(0, |all, byte| all | byte) != 0
    }
}

impl<S: Simd> Add for V<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { of: self.simd.add_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Sub for V<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { of: self.simd.sub_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Mul for V<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { of: self.simd.mul_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Div for V<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { of: self.simd.div_f64s(self.of, other.of), ..self }
    }
}
