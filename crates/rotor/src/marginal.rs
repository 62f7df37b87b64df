//! What stands on the limit of stability: the one noise level that tells a real part from rounding.
//!
//! Arithmetic in double precision knows `K` and `D` of `Q(s) = s^2 I - s D - K` no better than to a few last places of
//! the fastest rate in them, `S = max(|D|, sqrt |K|)`. So every computed pole is a pole of equations that differ from those
//! meant by up to `L = 16 n eps S^2`, in the units of `Q`. A pole with the vectors `q Q = 0`, `Q p = 0` of norm 1 moves with
//! such a difference by the `delta` of
//!
//! ```text
//! delta^2 + |q (2 lambda I - D) p| delta = L
//! ```
//!
//! which is `L` times the pole's condition for one that stands alone, and `sqrt L` for a double pole with one shape, as of a
//! rotor free in space. A real part no larger than that has no sign: the pole is **marginal**. It is told as exactly zero,
//! so that nothing downstream can judge rounding; likewise the imaginary part of a real pole, which does not whirl.

use crate::quadratic::Quadratic;
use crate::{C64, ClosedLoop, MAX_MASSES, PoleError, poles};

/// How a pole, or a rotor, stands to stability. In the order of what is worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stability {
    /// It decays.
    Stable,
    /// Neither can be said: the real part is zero but for rounding.
    Marginal,
    /// It grows.
    Unstable,
}

impl Stability {
    /// How a pole of [`poles`] or [`crate::Modes`] stands, where a marginal one has a real part of exactly zero. A
    /// real part that is not a number is not stable.
    #[must_use]
    pub fn of(pole: C64) -> Self {
        if pole.re < 0.0 {
            Self::Stable
        } else if pole.re == 0.0 {
            Self::Marginal
        } else {
            Self::Unstable
        }
    }

    /// Whether it decays; nothing where that cannot be said.
    #[must_use]
    pub fn is_stable(self) -> Option<bool> {
        match self {
            Self::Stable => Some(true),
            Self::Marginal => None,
            Self::Unstable => Some(false),
        }
    }
}

impl std::fmt::Display for Stability {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Stable => "stable",
            Self::Marginal => "marginal",
            Self::Unstable => "unstable",
        })
    }
}

/// How the linear rotor at one operating point stands: as its least damped pole does, every support bearing at its full
/// stiffness.
///
/// # Errors
/// Coefficients that are not finite, or an eigenvalue iteration that does not converge.
pub fn stability(closed_loop: &ClosedLoop) -> Result<Stability, PoleError> {
    Ok(poles(closed_loop)?.first().map_or(Stability::Unstable, |pole| Stability::of(*pole)))
}

/// Last places a mass that rounding may cost: measured on rotors without damping, whose poles have no real part, with a
/// factor of seven to spare.
const LAST_PLACES: f64 = 16.0;

impl Quadratic {
    /// The noise level `L` of these equations, in the units of `K`: see the module `marginal`.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        let square = |all: &[C64]| all.iter().map(C64::norm_sqr).sum::<f64>();
        let fastest = square(self.damping()).max(square(self.stiffness()).sqrt());
        LAST_PLACES * self.masses() as f64 * f64::EPSILON * fastest
    }

    /// How far rounding may move a pole whose vectors have the product `q (2 lambda I - D) p` of size `product`.
    pub(crate) fn reach(rounding: f64, product: f64) -> f64 {
        if rounding == 0.0 { 0.0 } else { 2.0 * rounding / (product + (product * product + 4.0 * rounding).sqrt()) }
    }

    /// Sets to zero what of each of these poles is rounding: the real part of a marginal one, the imaginary part of a real
    /// one.
    pub fn settle(&self, poles: &mut [C64]) {
        self.settle_by(poles, &|pole| self.condition(pole));
    }

    /// The same for poles of these equations closed in another way, such as after a delay: `condition` is the size of
    /// `q Q'(lambda) p` at a pole, with its vectors in norm 1.
    pub fn settle_by(&self, poles: &mut [C64], condition: &dyn Fn(C64) -> f64) {
        let rounding = self.rounding();
        let furthest = rounding.sqrt();
        for pole in poles {
            // No pole moves further than that, so most need no more than this comparison.
            if pole.re.abs().min(pole.im.abs()) > furthest {
                continue;
            }
            let reach = Self::reach(rounding, condition(*pole));
            for part in [&mut pole.re, &mut pole.im] {
                if part.abs() <= reach {
                    *part = 0.0;
                }
            }
        }
    }

    /// `|q (2 lambda I - D) p|` with the vectors of `pole` in norm 1: the smaller, the further the pole moves.
    fn condition(&self, pole: C64) -> f64 {
        let n = self.masses();
        let (mut p, mut q, mut times) = ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]);
        let (p, q, times) = (&mut p[..n], &mut q[..n], &mut times[..n]);
        self.vectors(pole, p, q);
        self.row_times_damping(q, times);
        p.iter().zip(q).zip(times).map(|((p, q), d)| (pole * 2.0 * *q - *d) * p).sum::<C64>().norm()
    }
}
