//! Poles of the linear rotor (deadband neglected), and what they say about stability.

use nalgebra::{DMatrix, DVector, Schur};

use crate::{C64, ClosedLoop};

/// Bound on the iterations of the eigenvalue routine: well-posed 32 x 32 matrices need under 200.
const MAX_ITERATIONS: usize = 2_000;

/// Why there are no eigenvalues.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleError {
    /// The matrix holds a value that is not finite: checked first, because an unbounded iteration would never return.
    #[error("the system matrix is not finite at row {row}, column {column}")]
    NotFinite {
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
    },
    /// The iteration did not converge within its bound.
    #[error("the eigenvalues did not converge in {MAX_ITERATIONS} iterations")]
    NoConvergence,
}

/// Eigenvalues of a square complex matrix, in no particular order.
///
/// # Errors
/// A matrix that is not finite, or an iteration that does not converge.
pub fn eigenvalues(matrix: DMatrix<C64>) -> Result<Vec<C64>, PoleError> {
    for (at, value) in matrix.iter().enumerate() {
        if !(value.re.is_finite() && value.im.is_finite()) {
            let (column, row) = (at / matrix.nrows(), at % matrix.nrows());
            return Err(PoleError::NotFinite { row: row + 1, column: column + 1 });
        }
    }
    let schur = Schur::try_new(matrix, f64::EPSILON, MAX_ITERATIONS).ok_or(PoleError::NoConvergence)?;
    let (_, triangle) = schur.unpack();
    Ok(triangle.diagonal().iter().copied().collect())
}

/// Relative damping of a pole, `-Re / |lambda|` (3.42), (4.28): 1 is overdamped, 0 the threshold, negative unstable.
/// A pole at the origin counts as 0.
#[must_use]
pub fn damping_ratio(pole: C64) -> f64 {
    let size = pole.norm();
    if size > 0.0 { -pole.re / size } else { 0.0 }
}

/// The sense in which a mode whirls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Whirl {
    /// With the spin, `Im >= 0`. A pole on the real axis, which does not whirl, counts here.
    Forward,
    /// Against the spin, `Im < 0`.
    Backward,
}

impl std::fmt::Display for Whirl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
        })
    }
}

/// One mode: a pole of the complex form and its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The eigenvalue, per unit of `tau`.
    pub pole: C64,
    /// Complex displacement of each mass, scaled so that the largest is 1.
    pub shape: Vec<C64>,
}

impl Mode {
    /// Relative damping, see [`damping_ratio`].
    #[must_use]
    pub fn damping(&self) -> f64 {
        damping_ratio(self.pole)
    }

    /// Logarithmic decrement `2 pi zeta / sqrt(1 - zeta^2)`; infinite for a pole on the real axis.
    #[must_use]
    pub fn log_decrement(&self) -> f64 {
        // The same quotient in terms of the pole, which keeps its digits near zeta = 1.
        std::f64::consts::TAU * -self.pole.re / self.pole.im.abs()
    }

    /// Whirl frequency `|Im lambda|`, in radians per unit of `tau`.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.pole.im.abs()
    }

    /// Forward or backward.
    #[must_use]
    pub fn whirl(&self) -> Whirl {
        if self.pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward }
    }
}

/// All modes of the linear rotor at one operating point.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The `2n` modes, least damped first; of equally damped ones the highest `Im` first.
    pub modes: Vec<Mode>,
}

impl Spectrum {
    /// The modes of `closed_loop`, every support bearing at its full stiffness.
    ///
    /// # Errors
    /// Coefficients that are not finite, or an eigenvalue iteration that does not converge.
    pub fn of(closed_loop: &ClosedLoop) -> Result<Self, PoleError> {
        let matrix = closed_loop.state_matrix();
        let mut modes: Vec<Mode> =
            eigenvalues(matrix.clone())?.into_iter().map(|pole| Mode { pole, shape: shape(&matrix, pole) }).collect();
        modes.sort_by(|a, b| a.damping().total_cmp(&b.damping()).then_with(|| b.pole.im.total_cmp(&a.pole.im)));
        Ok(Self { modes })
    }

    /// The smallest relative damping of any mode: the rotor is stable where it is positive.
    #[must_use]
    pub fn min_damping(&self) -> f64 {
        self.modes.first().map_or(f64::NAN, Mode::damping)
    }

    /// Whether every mode decays.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.min_damping() > 0.0
    }
}

/// The displacement part of the eigenvector of `matrix` for `pole`, by inverse iteration from a shifted pole.
fn shape(matrix: &DMatrix<C64>, pole: C64) -> Vec<C64> {
    let size = matrix.nrows();
    let scale = matrix.iter().map(|z| z.norm()).fold(1.0, f64::max);
    // Off the pole by a little more than rounding, so that the solve stays regular and still picks out this mode.
    let mut shifted = matrix.clone();
    for i in 0..size {
        shifted[(i, i)] -= pole + C64::new(1.0, 1.0) * (scale * 1e-13);
    }
    let lu = shifted.lu();
    // No entry of a start of irrational phases is orthogonal to a mode by symmetry.
    let mut vector = DVector::from_fn(size, |i, _| C64::cis(i as f64 * 1.618_033_988_75));
    for _ in 0..3 {
        let Some(next) = lu.solve(&vector) else { break };
        let norm = next.norm();
        if !(norm.is_finite() && norm > 0.0) {
            break;
        }
        vector = next / C64::from(norm);
    }
    let displacement = vector.rows(0, size / 2);
    let largest =
        displacement.iter().copied().fold(C64::ZERO, |a, b| if b.norm() > a.norm() * (1.0 + 1e-9) { b } else { a });
    displacement.iter().map(|p| if largest == C64::ZERO { C64::ZERO } else { p / largest }).collect()
}
