//! Complex numbers of several masses side by side.

use crate::C64;

/// The parts `y` and `z` of one complex number a mass, apart, so that the compiler works on several masses at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes<const L: usize> {
    pub(super) y: [f64; L],
    pub(super) z: [f64; L],
}

impl<const L: usize> Lanes<L> {
    pub(super) const ZERO: Self = Self { y: [0.0; L], z: [0.0; L] };

    pub(super) fn of(numbers: &[C64]) -> Self {
        let at = |k: usize| numbers.get(k).copied().unwrap_or_default();
        Self { y: std::array::from_fn(|k| at(k).re), z: std::array::from_fn(|k| at(k).im) }
    }

    /// `self + h * slope`, mass by mass.
    #[inline]
    pub(super) fn along(&self, h: f64, slope: &Self) -> Self {
        let mut sum = *self;
        for k in 0..L {
            sum.y[k] += slope.y[k] * h;
            sum.z[k] += slope.z[k] * h;
        }
        sum
    }

    /// `self + dtau / 6 (k0 + 2 k1 + 2 k2 + k3)`.
    #[inline]
    pub(super) fn combined(&self, sixth: f64, k: [&Self; 4]) -> Self {
        let mut sum = *self;
        for i in 0..L {
            sum.y[i] += (k[0].y[i] + (k[1].y[i] + k[2].y[i]) * 2.0 + k[3].y[i]) * sixth;
            sum.z[i] += (k[0].z[i] + (k[1].z[i] + k[2].z[i]) * 2.0 + k[3].z[i]) * sixth;
        }
        sum
    }
}
