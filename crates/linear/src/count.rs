//! How many roots lie right of a line: the argument principle, with steps that cannot lose a turn.
//!
//! Around the half disc right of the line the angle of `f(s) = det M(s)` turns once for every root. Along the big arc, where
//! `|s|` is larger than everything else, `f = s^N det(I - X / s)` and the second factor stays in the right half plane: that
//! part is known without a step. Along the line each step is as long as can be *proven* to be safe. With
//! `M(s + j t) = M(s) (I + E(t))`, every eigenvalue `e` of `E` turns the angle by at most `asin |e|`, so that the whole turn
//! is at most `pi / 2` times the nuclear norm of `E`, and
//!
//! ```text
//! |E|_* <= t sqrt(N) |M^-1|_F + min(t T, 2) exp(-line T) |M^-1 B|_F |C|_F
//! ```
//!
//! Steps that keep this below 1 turn by less than a quarter, and no root is on them. What is left to trust is rounding.

use std::f64::consts::{PI, TAU};

use crate::inverse::invert;
use crate::system::Balanced;
use crate::{C64, DelayError};

/// What the bound on a step is kept below; 1 would do.
pub(crate) const SAFE: f64 = 0.95;
/// Rows of a matrix that is stepped as a whole: of more, each step costs too much and each is too short, see [`crate::partial_fractions`].
const WHOLE: usize = 10;
/// Steps that a count may take: of matrices as small as that, and of fractions, well below a second's worth.
pub(crate) const MOST_STEPS: usize = 60_000;
/// Of a matrix with more rows than this each step takes so long that only as many are taken as take no longer together.
const LARGE: f64 = 30.0;
/// A root nearer the line than this, relative to the size of the system or to `1 / T`, is on it.
const ON: f64 = 1e-8;

/// Why there is no count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoCount {
    /// A root is on the line, or next to it.
    OnTheLine,
    /// It would take too long.
    TooLong,
}

impl NoCount {
    /// The error that it is for `line`.
    pub(crate) fn at(self, line: f64, delay: f64) -> DelayError {
        match self {
            Self::OnTheLine => DelayError::OnTheLine(line),
            Self::TooLong => DelayError::TooMany { line, delay },
        }
    }
}

/// Between minus and plus half a turn.
pub(crate) fn principal(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl Balanced {
    /// The number of roots with `Re s > line`, each as often as it is one.
    pub(crate) fn count_right_of(&self, line: f64) -> Result<usize, NoCount> {
        if self.size() > WHOLE {
            match self.count_by_fractions(line) {
                Ok(Some(counted)) => return Ok(counted),
                Err(NoCount::OnTheLine) => return Err(NoCount::OnTheLine),
                // Motions that are much alike make fractions that are larger than what they add up to.
                Ok(None) | Err(NoCount::TooLong) => {}
            }
        }
        self.count_by_the_whole(line)
    }

    /// The same, whatever the size.
    pub(crate) fn count_by_the_whole(&self, line: f64) -> Result<usize, NoCount> {
        let n = self.size();
        let (root_n, late) = ((n as f64).sqrt(), (-line * self.delay).exp());
        let through = self.b.norm() * self.c.norm() * late;
        let all = root_n * self.a.norm() + if through.is_nan() { 0.0 } else { through };
        // Nothing larger than this is a root, and beyond 1 / SAFE of it the angle is known.
        let radius = all.max(f64::MIN_POSITIVE) / SAFE;
        if line >= radius {
            return Ok(0);
        }
        if !radius.is_finite() {
            return Err(NoCount::TooLong);
        }
        let [low, high] = [C64::new(line, -radius), C64::new(line, radius)];
        let mut s = low;
        let mut here = invert(self.at(s)).ok_or(NoCount::OnTheLine)?;
        let beside = |angle: f64, s: C64| principal(angle - n as f64 * s.arg());
        let first = beside(here.angle, low);
        let mut turned = 0.0;
        let most = MOST_STEPS as f64 * (LARGE / n as f64).powi(3).min(1.0);
        for _ in 0..most as usize {
            let own = root_n * here.inverse.norm();
            let echo = if through > 0.0 { (&here.inverse * &self.b).norm() * self.c.norm() * late } else { 0.0 };
            // The longest t with t own + min(t T, 2) echo <= SAFE.
            let far = (SAFE - 2.0 * echo) / own;
            let step = if far * self.delay > 2.0 { far } else { SAFE / (own + echo * self.delay) };
            if step < ON * all.min(1.0 / self.delay) {
                return Err(NoCount::OnTheLine);
            }
            let last = s.im + step >= high.im;
            s = if last { high } else { C64::new(line, s.im + step) };
            let there = invert(self.at(s)).ok_or(NoCount::OnTheLine)?;
            turned += principal(there.angle - here.angle);
            here = there;
            if last {
                let arc = 2.0 * n as f64 * high.arg() + beside(here.angle, high) - first;
                let turns = (arc - turned) / TAU;
                debug_assert!((turns - turns.round()).abs() < 1e-3, "{turns} turns");
                return Ok(turns.round().max(0.0) as usize);
            }
        }
        Err(NoCount::TooLong)
    }
}

const _: () = assert!(SAFE * PI / 2.0 < PI / 2.0);
