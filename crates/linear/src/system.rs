//! The system, its characteristic matrix, and what bounds its roots.

use nalgebra::{ComplexField, DMatrix};

use crate::C64;
use crate::balance::balance_matrix;
use crate::eigenvalues::EigenvalueError;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DelayError {
    /// Matrices that do not fit together.
    #[error(
        "A is {rows} x {columns}, B {b_rows} x {b_columns}, C {c_rows} x {c_columns}: expected N x N, N x m and m x N"
    )]
    Shape {
        /// Rows of `A`.
        rows: usize,
        /// Columns of `A`.
        columns: usize,
        /// Rows of `B`.
        b_rows: usize,
        /// Columns of `B`.
        b_columns: usize,
        /// Rows of `C`.
        c_rows: usize,
        /// Columns of `C`.
        c_columns: usize,
    },
    /// A coefficient that is not finite.
    #[error("a coefficient of the loop is not finite")]
    NotFinite,
    /// A delay that is none.
    #[error("delay {0}: expected a finite number, not negative")]
    Delay(f64),
    /// A line that is none: with a delay there are infinitely many roots right of minus infinity.
    #[error("roots right of {0}: expected a finite line where there is a delay")]
    Line(f64),
    /// The eigenvalues of a matrix cannot be had.
    #[error(transparent)]
    Eigenvalues(#[from] EigenvalueError),
    /// More than can be counted.
    #[error("too many roots to count right of {line}: {delay} is too long a delay, or the line too far left")]
    TooMany {
        /// The line.
        line: f64,
        /// The delay.
        delay: f64,
    },
    /// A root lies on the line, or so near that it cannot be said on which side, wherever the line was moved to.
    #[error("roots crowd on the line {0}: they cannot be counted")]
    OnTheLine(f64),
    /// The count and what was found do not agree.
    #[error("{counted} roots are right of {line}, but {found} were found")]
    Missed {
        /// How many there are.
        counted: usize,
        /// How many were found.
        found: usize,
        /// Right of which line.
        line: f64,
    },
    /// The delay margin is of one loop alone.
    #[error("a delay margin is that of one loop, but {0} are closed")]
    Several(usize),
    /// A root is on the axis, or as near as rounding: the sensitivity has no bound that could be told.
    #[error("a root is so near the imaginary axis that the sensitivity has no bound")]
    NoBound,
    /// A way to move that does not fit the matrix that is to move.
    #[error("a direction of {rows} x {columns}: expected {expected} x {expected}")]
    Direction {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Those of `A`.
        expected: usize,
    },
}

/// `x' = A x + B C x(t - T)`, time and delay in the same unit; `B C` carries the sign of the feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct DelaySystem {
    pub(crate) a: DMatrix<C64>,
    pub(crate) b: DMatrix<C64>,
    pub(crate) c: DMatrix<C64>,
    pub(crate) delay: f64,
    /// The same in balanced coordinates: roots are the same, norms are as small as scaling makes them.
    pub(crate) balanced: Balanced,
}

/// A system in coordinates in which its rows and columns are of like size.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Balanced {
    pub(crate) a: DMatrix<C64>,
    pub(crate) b: DMatrix<C64>,
    pub(crate) c: DMatrix<C64>,
    pub(crate) delay: f64,
    /// By which each coordinate is divided.
    scales: Vec<f64>,
}

impl DelaySystem {
    /// The loop with `a` (N x N), `b` (N x m), `c` (m x N) and `delay`.
    ///
    /// # Errors
    /// Shapes that do not fit, a coefficient or delay that is not finite, a negative delay.
    pub fn new(a: DMatrix<C64>, b: DMatrix<C64>, c: DMatrix<C64>, delay: f64) -> Result<Self, DelayError> {
        let n = a.nrows();
        if a.ncols() != n || b.nrows() != n || c.ncols() != n || b.ncols() != c.nrows() {
            return Err(DelayError::Shape {
                rows: n,
                columns: a.ncols(),
                b_rows: b.nrows(),
                b_columns: b.ncols(),
                c_rows: c.nrows(),
                c_columns: c.ncols(),
            });
        }
        if !(delay.is_finite() && delay >= 0.0) {
            return Err(DelayError::Delay(delay));
        }
        if !a.iter().chain(&b).chain(&c).all(|z| z.is_finite()) {
            return Err(DelayError::NotFinite);
        }
        // Both ways in at once: a scale that suits the one and not the other would be none.
        let mut sizes = DMatrix::from_fn(n, n, |i, j| {
            let through: f64 = (0..b.ncols()).map(|k| b[(i, k)].norm() * c[(k, j)].norm()).sum();
            C64::from(a[(i, j)].norm() + through)
        });
        let scales = balance_matrix(&mut sizes);
        let balanced = Balanced {
            a: DMatrix::from_fn(n, n, |i, j| a[(i, j)] * (scales[j] / scales[i])),
            b: DMatrix::from_fn(n, b.ncols(), |i, j| b[(i, j)] / scales[i]),
            c: DMatrix::from_fn(c.nrows(), n, |i, j| c[(i, j)] * scales[j]),
            delay,
            scales,
        };
        Ok(Self { a, b, c, delay, balanced })
    }

    /// `A`.
    #[must_use]
    pub fn a(&self) -> &DMatrix<C64> {
        &self.a
    }

    /// `B`.
    #[must_use]
    pub fn b(&self) -> &DMatrix<C64> {
        &self.b
    }

    /// `C`.
    #[must_use]
    pub fn c(&self) -> &DMatrix<C64> {
        &self.c
    }

    /// `T`.
    #[must_use]
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// A line that asks for all that matters, `-2 / T`: what fades to less than a seventh within one delay is an echo of the
    /// delay, not a motion of the machine. Minus infinity without a delay, where all roots can be had.
    ///
    /// Some line there must be: far left and ever faster a loop with delay has an endless chain of roots, whose damping
    /// *ratio* creeps to 0 however quickly they decay.
    #[must_use]
    pub fn echo_line(&self) -> f64 {
        -2.0 / self.delay
    }
}

impl Balanced {
    /// How many states.
    pub(crate) fn size(&self) -> usize {
        self.a.nrows()
    }

    /// The same with its loop closed, which is no way around it where there is a delay.
    pub(crate) fn closed(&self) -> Self {
        Self { a: &self.a + &self.b * &self.c, ..self.clone() }
    }

    /// What a coordinate is divided by in these.
    pub(crate) fn scale(&self, coordinate: usize) -> f64 {
        self.scales[coordinate]
    }

    /// A matrix on the states, in these coordinates.
    pub(crate) fn scaled(&self, a: &DMatrix<C64>) -> DMatrix<C64> {
        DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * (self.scales[j] / self.scales[i]))
    }

    /// `M(s) = s I - A - B C exp(-s T)`.
    pub(crate) fn at(&self, s: C64) -> DMatrix<C64> {
        let late = (-s * self.delay).exp();
        let mut m = -&self.a;
        for k in 0..self.b.ncols() {
            for j in 0..m.ncols() {
                let by = self.c[(k, j)] * late;
                if by != C64::ZERO {
                    for i in 0..m.nrows() {
                        m[(i, j)] -= self.b[(i, k)] * by;
                    }
                }
            }
        }
        for i in 0..m.nrows() {
            m[(i, i)] += s;
        }
        m
    }

    /// The same seen from `centre`: a system whose roots are less by that.
    pub(crate) fn about(&self, centre: C64) -> Self {
        let mut made = self.clone();
        for i in 0..made.size() {
            made.a[(i, i)] -= centre;
        }
        made.b *= (-centre * self.delay).exp();
        made
    }

    /// No root right of `line` is larger than this: `|s| <= |A| + |B C| exp(-line T)`, in the best of three norms.
    pub(crate) fn bound(&self, line: f64) -> f64 {
        let through = &self.b * &self.c;
        let size = |m: &DMatrix<C64>| [column_norm(m), row_norm(m), m.norm()];
        let (own, other) = (size(&self.a), size(&through));
        let late = (-line * self.delay).exp();
        (0..3).map(|k| own[k] + late * other[k]).fold(f64::INFINITY, f64::min)
    }
}

fn column_norm(m: &DMatrix<C64>) -> f64 {
    m.column_iter().map(|column| column.iter().map(|z| z.modulus()).sum()).fold(0.0, f64::max)
}

fn row_norm(m: &DMatrix<C64>) -> f64 {
    m.row_iter().map(|row| row.iter().map(|z| z.modulus()).sum()).fold(0.0, f64::max)
}
