//! All roots right of a line: guessed, refined by Newton's method, and counted.

use nalgebra::DMatrix;

use crate::count::NoCount;
use crate::guess::ATTEMPTS;
use crate::inverse::invert;
use crate::system::Balanced;
use crate::{C64, DelayError, DelaySystem, eigenvalues};

/// Steps of Newton's method for one root; three or four are usual.
const STEPS: usize = 40;
/// What a last step may be, relative to the size of the root and of the system: a root is within it, times the order.
const CLOSE: f64 = 1e-6;
/// Steps of it to see whether a root is one.
const POLISH: usize = 3;
/// Roots nearer each other than this, relative to the size of the system, are a cluster: Newton's method is no judge of them.
const CLUSTER: f64 = 1e-4;
/// Points that tell whether there is but one root in a circle, and how near to one they must come: off by 0.4 to the power of them, with
/// others as far outside.
const FEW_POINTS: usize = 12;
const ONE: f64 = 0.05;
/// Points on a circle around a cluster: with all others half as far again as it is wide, what is left out is far below rounding.
const POINTS: usize = 96;

/// All roots right of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Roots {
    /// The line: all roots with `Re s` above it are here. It is what was asked for, or a little left of it where a root
    /// would have been on it; minus infinity only without a delay.
    pub right_of: f64,
    /// The roots, the rightmost first, each as often as it is one; to 1e-10 of the size of the system, and as sharp as
    /// rounding leaves them where several coincide.
    pub roots: Vec<C64>,
}

impl DelaySystem {
    /// All roots with `Re s > line`, proven complete. Without a delay `line` may be minus infinity.
    ///
    /// # Errors
    /// A line that is no number, more roots than can be counted, or roots that cannot be found: then there is no answer,
    /// and none must be made up.
    pub fn roots_right_of(&self, line: f64) -> Result<Roots, DelayError> {
        self.roots_from(line, &[])
    }

    /// The same with roots that may be near, such as those of a loop that was a little different: with good ones, what is
    /// left to do is the count.
    ///
    /// # Errors
    /// As for [`Self::roots_right_of`].
    pub fn roots_from(&self, line: f64, near: &[C64]) -> Result<Roots, DelayError> {
        let system = &self.balanced;
        if line.is_nan() || (line == f64::NEG_INFINITY && self.delay() > 0.0) {
            return Err(DelayError::Line(line));
        }
        // Without a delay, or without a way for it to matter, roots are eigenvalues: nothing to count.
        let closed = system.b.norm() * system.c.norm();
        if self.delay() == 0.0 || closed == 0.0 {
            let matrix = if closed == 0.0 { system.a.clone() } else { &system.a + &system.b * &system.c };
            let mut roots = eigenvalues(matrix)?;
            roots.retain(|s| s.re > line);
            return Ok(Roots { right_of: line, roots: sorted(roots) });
        }
        let (line, counted) = self.count_beside(line)?;
        let mut found: Vec<C64> = Vec::new();
        for attempt in 0..=ATTEMPTS {
            if found.len() < counted {
                let guesses = match attempt {
                    0 => near.to_vec(),
                    _ => system.guesses(line, attempt - 1)?,
                };
                system.refine(guesses, line, counted, &mut found);
            }
            if found.len() == counted {
                return Ok(Roots { right_of: line, roots: sorted(found) });
            }
            if attempt > 0 {
                let split = system.split(&found, line);
                if split.len() == counted {
                    return Ok(Roots { right_of: line, roots: sorted(split) });
                }
            }
        }
        Err(DelayError::Missed { counted, found: found.len(), line })
    }

    /// How many roots have `Re s > line`, each as often as it is one.
    ///
    /// # Errors
    /// A line that is no number, a root on it, or more than can be counted.
    pub fn count_right_of(&self, line: f64) -> Result<usize, DelayError> {
        if !line.is_finite() {
            return Err(DelayError::Line(line));
        }
        self.balanced.count_right_of(line).map_err(|error| error.at(line, self.delay()))
    }

    /// The count, right of a line a little farther left if a root is on it.
    fn count_beside(&self, line: f64) -> Result<(f64, usize), DelayError> {
        let step = 1e-4 * (line.abs() + self.balanced.bound(line.max(0.0))).min(1.0 / self.delay());
        let mut moved = line;
        for k in 1..=6 {
            match self.balanced.count_right_of(moved) {
                Ok(counted) => return Ok((moved, counted)),
                Err(NoCount::TooLong) => return Err(NoCount::TooLong.at(line, self.delay())),
                Err(NoCount::OnTheLine) => moved = line - step * f64::from(k * k),
            }
        }
        Err(NoCount::OnTheLine.at(line, self.delay()))
    }
}

impl Balanced {
    /// What counts as one place.
    fn cluster(&self) -> f64 {
        CLUSTER * self.bound(0.0).min(1.0 / self.delay)
    }

    /// Takes `guesses` to roots, and those right of `line` that are not among `found` into it, as far as `counted`.
    fn refine(&self, guesses: Vec<C64>, line: f64, counted: usize, found: &mut Vec<C64>) {
        let apart = self.cluster();
        // The rightmost first: they are sure to count.
        for guess in sorted(guesses) {
            if found.len() == counted {
                return;
            }
            // Guesses far left are of roots that do not count.
            if guess.re < line - 0.5 / self.delay - 0.1 * line.abs() {
                continue;
            }
            if let Some(root) = self.root_near(guess, found).and_then(|root| self.polished(root))
                && root.re > line
                && found.iter().all(|known| (root - known).norm() > apart)
            {
                found.push(root);
            }
        }
    }

    /// `near` after some steps of Newton's method with no root divided out. Next to a root that is known the quotient's
    /// slope is a difference of two large numbers, and rounding makes up roots there: those fall back onto the known one.
    fn polished(&self, near: C64) -> Option<C64> {
        let mut s = near;
        for _ in 0..POLISH {
            let Some(slope) = self.slope(s) else { return Some(s) };
            let step = slope.inv();
            if !step.is_finite() {
                return None;
            }
            s -= step;
            if step.norm() <= 1e-15 * s.norm() {
                break;
            }
        }
        Some(s)
    }

    /// `found`, with as many in place of each as there are about it, from the sums of their powers
    /// `1 / (2 pi j) * integral of (s - c)^k f' / f ds` around a circle.
    fn split(&self, found: &[C64], line: f64) -> Vec<C64> {
        let mut made = Vec::new();
        for (i, &centre) in found.iter().enumerate() {
            let others = found.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, other)| (other - centre).norm());
            let radius = others.fold(20.0 * self.cluster(), |least, apart| least.min(0.4 * apart));
            match self.within(centre, radius) {
                Some(roots) if roots.len() > 1 => made.extend(roots.into_iter().filter(|root| root.re > line)),
                _ => made.push(centre),
            }
        }
        made
    }

    /// The roots in a circle; `None` if it runs too near a root to tell.
    fn within(&self, centre: C64, radius: f64) -> Option<Vec<C64>> {
        let around = |points: usize| -> Option<Vec<(C64, C64)>> {
            let at = |k: usize| {
                let out = C64::cis(std::f64::consts::TAU * k as f64 / points as f64);
                Some((out, self.slope(centre + out * radius)?))
            };
            (0..points).map(at).collect()
        };
        // Most are alone, and that takes few points to see.
        let few = around(FEW_POINTS)?;
        let count = few.iter().map(|(out, slope)| out * slope).sum::<C64>() * radius / FEW_POINTS as f64;
        if (count - 1.0).norm() < ONE {
            return Some(vec![centre]);
        }
        let slopes = around(POINTS)?;
        // In units of the radius.
        let power =
            |k: i32| slopes.iter().map(|(out, slope)| out.powi(k + 1) * slope).sum::<C64>() * radius / POINTS as f64;
        let count = power(0);
        let many = count.re.round();
        if (count - many).norm() > 1e-3 || !(1.0..=40.0).contains(&many) {
            return None;
        }
        let many = many as usize;
        let sums: Vec<C64> = (0..=many).map(|k| power(k as i32)).collect();
        // Newton's identities: k e_k = sum_{i=1..k} (-1)^(i-1) e_(k-i) p_i; the polynomial is sum (-1)^k e_k x^(n-k).
        let mut terms = vec![C64::ONE];
        for k in 1..=many {
            let sum: C64 = (1..=k).map(|i| terms[k - i] * sums[i] * if i % 2 == 1 { 1.0 } else { -1.0 }).sum();
            terms.push(sum / k as f64);
        }
        let companion = DMatrix::from_fn(many, many, |i, j| match (i, j) {
            (0, j) => terms[j + 1] * if j % 2 == 0 { 1.0 } else { -1.0 },
            (i, j) if i == j + 1 => C64::ONE,
            _ => C64::ZERO,
        });
        Some(eigenvalues(companion).ok()?.into_iter().map(|x| centre + x * radius).collect())
    }

    /// `f' / f = tr M^-1 M'` of `f = det M`, `M' = I + T exp(-s T) B C`; `None` at a root.
    fn slope(&self, s: C64) -> Option<C64> {
        let inverse = invert(self.at(s))?.inverse;
        let through = (&self.c * &inverse * &self.b).trace();
        Some(inverse.trace() + (-s * self.delay).exp() * self.delay * through)
    }

    /// Newton's method on `det M(s)` divided by `(s - r)` for every root `r` known, so that it does not come back to one.
    /// `None` if it goes astray.
    fn root_near(&self, guess: C64, known: &[C64]) -> Option<C64> {
        let mut s = guess;
        let mut before = f64::INFINITY;
        let size = self.bound(0.0);
        let farthest = 0.3 * (guess.norm() + size).min(guess.norm() + 3.0 / self.delay);
        for _ in 0..STEPS {
            let Some(mut slope) = self.slope(s) else { return Some(s) };
            for root in known {
                let apart = s - root;
                // Exactly on a known root there is no telling which way to go: any way will do.
                slope -= if apart == C64::ZERO { C64::from(1e12 / size) } else { apart.inv() };
            }
            let step = slope.inv();
            if !step.is_finite() {
                return None;
            }
            s -= step;
            if (s - guess).norm() > farthest || !s.is_finite() {
                return None;
            }
            let length = step.norm();
            let scale = s.norm() + 1e-3 * size;
            if length <= 1e-15 * scale || (length <= CLOSE * scale && length >= 0.5 * before) {
                return Some(s);
            }
            before = length;
        }
        (before <= CLOSE * (s.norm() + 1e-3 * size)).then_some(s)
    }
}

/// The rightmost first; of conjugates the upper one.
fn sorted(mut roots: Vec<C64>) -> Vec<C64> {
    roots.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    roots
}
