//! What a root does when the system changes.

use nalgebra::DVector;

use crate::inverse::invert;
use crate::{C64, DelaySystem};

/// The vectors of a root `s`: `M(s) right = 0`, `left M(s) = 0`, with `M(s) = s I - A - B C exp(-s T)`.
///
/// A simple root moves by `ds = left (dA + d(B C) exp(-s T)) right / give`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The state in the motion `exp(s t)`, in norm 1.
    pub right: DVector<C64>,
    /// The row, not conjugated, in norm 1.
    pub left: DVector<C64>,
    /// `left M'(s) right`, `M' = I + T B C exp(-s T)`: 0 at a root that is several, whose slope is infinite.
    pub give: C64,
}

impl DelaySystem {
    /// The vectors of the root `s`; `None` if they cannot be had.
    #[must_use]
    pub fn sensitivity(&self, s: C64) -> Option<Sensitivity> {
        let n = self.a().nrows();
        let late = (-s * self.delay()).exp();
        let matrix = |s: C64| {
            let mut m = -(self.a() + self.b() * self.c() * late);
            (0..n).for_each(|i| m[(i, i)] += s);
            m
        };
        // Singular to the last bit: a last bit farther it is not.
        let beside = s + C64::new(1.0, 1.0) * f64::EPSILON * (s.norm() + self.a().norm());
        let inverse = invert(matrix(s)).or_else(|| invert(matrix(beside)))?.inverse;
        // From a start that no symmetry makes orthogonal to a mode.
        let start = DVector::from_fn(n, |i, _| C64::new(1.0 + 0.37 * i as f64, 0.61 - 0.23 * i as f64));
        let (mut right, mut left) = (start.clone(), start);
        let turned = inverse.transpose();
        for _ in 0..2 {
            right = unit(&inverse * right)?;
            left = unit(&turned * left)?;
        }
        let through = (left.transpose() * self.b() * self.c() * &right)[0];
        let give = left.dot(&right) + through * late * self.delay();
        Some(Sensitivity { right, left, give })
    }
}

/// Norm 1; inverse iteration ends on numbers whose squares may overflow.
fn unit(vector: DVector<C64>) -> Option<DVector<C64>> {
    let largest = vector.iter().map(|z| z.re.abs().max(z.im.abs())).fold(0.0, f64::max);
    if !(largest.is_finite() && largest > 0.0) {
        return None;
    }
    let vector = vector / C64::from(largest);
    let norm = vector.norm();
    Some(vector / C64::from(norm))
}
