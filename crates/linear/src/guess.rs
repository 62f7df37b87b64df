//! Where roots could be: eigenvalues of matrices in which the delay is approximated.
//!
//! What the loop fed back over the last `T` is described by its first `q` Legendre coefficients, `T z' = L z + l C x`, with
//!
//! ```text
//! L_ij = (2 i + 1) * (-1 if i < j, else (-1)^(i - j + 1)),   l_i = (2 i + 1) (-1)^i,   C x(t - T) = sum_i z_i
//! ```
//!
//! which is Pade's approximation `[q - 1 / q]` of `exp(-s T)` in coordinates that are good to calculate with. It is right to
//! six digits as far as `|s T|` is less than `q` or so. Farther up it is laid out again about another point: with
//! `s = c + z` the system is one in `z`, with `A - c` and `B exp(-c T)`.

use nalgebra::DMatrix;

use crate::system::Balanced;
use crate::{C64, DelayError, eigenvalues};

/// `|s T|` that is reached with how many coefficients.
fn coefficients(reach: f64) -> usize {
    6 + (0.7 * reach).ceil() as usize
}

/// Half the height of a strip, in units of `1 / T`, at each of several attempts.
const REACH: [f64; 3] = [10.0, 6.0, 3.0];
/// Rows of a matrix that is still solved in one go.
const WHOLE: usize = 48;
/// Strips that are looked at, at most.
const MOST_STRIPS: f64 = 1500.0;

/// How many attempts there are, each more thorough.
pub(crate) const ATTEMPTS: usize = REACH.len() + 1;

impl Balanced {
    /// Guesses at the roots right of `line`, and at more.
    pub(crate) fn guesses(&self, line: f64, attempt: usize) -> Result<Vec<C64>, DelayError> {
        let m = self.b.ncols();
        let bound = self.bound(line);
        let reach = bound * self.delay;
        if attempt == 0 {
            // Most roots that matter are far below the bound. If some are not, the count tells.
            return self.near(C64::ZERO, coefficients(reach.min(4.0)));
        }
        if attempt == 1 && self.size() + m * coefficients(reach) <= WHOLE {
            return self.near(C64::ZERO, coefficients(reach));
        }
        let half = REACH[(attempt - 1).min(REACH.len() - 1)];
        let strips = (reach / half).ceil();
        if strips > MOST_STRIPS {
            return Err(DelayError::TooMany { line, delay: self.delay });
        }
        // Right of the line and of the axis the delay soon has no say: what is left there is near eigenvalues of A.
        let mut found = eigenvalues(self.a.clone())?;
        let count = strips as usize;
        for k in 0..count {
            let height = bound * ((2 * k + 1) as f64 / strips - 1.0);
            let centre = C64::new(line.max(-2.0 / self.delay), height);
            // Neighbours overlap: a root near an edge is seen from both sides.
            let seen = self.near(centre, coefficients(1.5 * half))?;
            found.extend(seen.into_iter().filter(|s| (s.im - height).abs() * self.delay <= 1.5 * half));
        }
        Ok(found)
    }

    /// Roots of the approximation about `centre` with `q` coefficients.
    fn near(&self, centre: C64, q: usize) -> Result<Vec<C64>, DelayError> {
        let here = self.about(centre);
        let (n, m) = (self.size(), self.b.ncols());
        let mut a = DMatrix::zeros(n + m * q, n + m * q);
        a.view_mut((0, 0), (n, n)).copy_from(&here.a);
        for k in 0..m {
            let own = n + k * q;
            for i in 0..q {
                a.view_mut((0, own + i), (n, 1)).copy_from(&here.b.column(k));
                let weight = (2 * i + 1) as f64 / self.delay;
                let sign = |odd: bool| if odd { -weight } else { weight };
                for j in 0..n {
                    a[(own + i, j)] = here.c[(k, j)] * sign(i % 2 == 1);
                }
                for j in 0..q {
                    a[(own + i, own + j)] = C64::from(sign(i < j || (i - j) % 2 == 0));
                }
            }
        }
        Ok(eigenvalues(a)?.into_iter().map(|z| z + centre).collect())
    }
}
