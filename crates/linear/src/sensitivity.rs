//! What a root does when the system changes.

use nalgebra::{DMatrix, DVector};

use crate::inverse::Factored;
use crate::motions::unit;
use crate::system::Balanced;
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

/// A root made as sharp as the coefficients allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharpRoot {
    /// The root.
    pub root: C64,
    /// By how much it moves when every coefficient is off by its last place, all in the worst way: `eps |left| (|s| + |A| + |B| |C| |exp(-s T)|)
    /// |right| / |give|`, with sizes entry by entry. Where the system is stiff in a place that the motion leaves at rest this is far less
    /// than what the norm of the system allows. Infinite at a root that is several.
    pub last_place: f64,
}

/// Steps of Newton's method with the vectors of a root: each doubles the digits.
const SHARPENINGS: usize = 2;

impl DelaySystem {
    /// A root that is known but for rounding, sharpened: eigenvalues of a matrix are as sharp as its norm allows, which drowns the slow
    /// ones where another place is very stiff. `None` if its vectors cannot be had.
    #[must_use]
    pub fn sharpened(&self, s: C64) -> Option<SharpRoot> {
        let Balanced { a, b, c, delay, .. } = &self.balanced;
        let balanced =
            Self { a: a.clone(), b: b.clone(), c: c.clone(), delay: *delay, balanced: self.balanced.clone() };
        let sizes = |m: &DMatrix<C64>| m.map(|z| z.norm());
        let through = b * c;
        let mut root = s;
        let mut vectors = balanced.sensitivity(root)?;
        for _ in 0..SHARPENINGS {
            let late = (-root * *delay).exp();
            let residual = &vectors.right * root - a * &vectors.right - &through * &vectors.right * late;
            let step = (vectors.left.transpose() * residual)[0] / vectors.give;
            if !step.is_finite() {
                break;
            }
            root -= step;
            vectors = balanced.sensitivity(root)?;
        }
        let [left, right] = [&vectors.left, &vectors.right].map(|vector| vector.map(|z| z.norm()));
        let late = (-root * *delay).exp().norm();
        let moved = &right * root.norm() + (sizes(a) + sizes(b) * sizes(c) * late) * &right;
        let last_place = f64::EPSILON * left.dot(&moved) / vectors.give.norm();
        Some(SharpRoot { root, last_place: if last_place.is_nan() { f64::INFINITY } else { last_place } })
    }

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
        let factored = Factored::of(matrix(s)).or_else(|| Factored::of(matrix(beside)))?;
        // From a start that no symmetry makes orthogonal to a mode.
        let start = DVector::from_fn(n, |i, _| C64::new(1.0 + 0.37 * i as f64, 0.61 - 0.23 * i as f64));
        let (mut right, mut left) = (start.clone(), start);
        for _ in 0..2 {
            right = unit(factored.solve(&right)?)?;
            left = unit(factored.solve_turned(&left)?)?;
        }
        let through = (left.transpose() * self.b() * self.c() * &right)[0];
        let give = left.dot(&right) + through * late * self.delay();
        Some(Sensitivity { right, left, give })
    }
}
