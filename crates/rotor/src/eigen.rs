//! Eigenvalues of small dense complex matrices: balancing, Householder reduction to Hessenberg form, shifted QR.
//!
//! The matrices here have 2 to 64 rows and only their eigenvalues are wanted, so the routine keeps neither the unitary
//! factor nor anything outside the active block, and allocates nothing: about half the work of a full Schur
//! decomposition. The algorithm is the classical one (Francis; Wilkinson, *The Algebraic Eigenvalue Problem*, ch. 8;
//! Golub & Van Loan, ch. 7), with Wilkinson's shift and a bounded number of sweeps. Eigenvectors are not its job: see
//! [`crate::quadratic`].

use nalgebra::DMatrix;

use crate::C64;

/// Bound on the QR sweeps for one eigenvalue. Two to three are usual; LAPACK gives up after 30 as well.
const SWEEPS_PER_EIGENVALUE: usize = 30;

/// Rows and columns smaller than this are not balanced.
const LEAST: f64 = 1e-120;

/// Sweeps for one eigenvalue after which rounding of the whole matrix is good enough.
const PATIENCE: usize = 15;

/// Why there are no eigenvalues.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleError {
    /// The matrix holds a value that is not finite: checked first, because no iteration can end on one.
    #[error("the system matrix is not finite at row {row}, column {column}")]
    NotFinite {
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
    },
    /// The iteration did not converge within its bound.
    #[error("the eigenvalues did not converge in {SWEEPS_PER_EIGENVALUE} sweeps each")]
    NoConvergence,
    /// A pole or its shape left the range of numbers.
    #[error("the poles are beyond the range of numbers: the values of this machine lie too far apart")]
    OutOfRange,
}

/// Eigenvalues of a square complex matrix, in no particular order.
///
/// Backward stable: they are the exact eigenvalues of a matrix within a few rounding errors of `matrix` in norm.
///
/// # Errors
/// A matrix that is not finite, or an iteration that does not converge.
///
/// # Panics
/// If the matrix is not square.
pub fn eigenvalues(matrix: DMatrix<C64>) -> Result<Vec<C64>, PoleError> {
    assert!(matrix.is_square(), "only square matrices have eigenvalues");
    let size = matrix.nrows();
    // Column by column in memory: row by row it is the transpose, which has the same eigenvalues.
    let mut rows: Vec<C64> = matrix.data.into();
    let mut values = vec![C64::ZERO; size];
    eigenvalues_in_place(&mut rows, &mut values).map_err(|error| match error {
        PoleError::NotFinite { row, column } => PoleError::NotFinite { row: column, column: row },
        PoleError::NoConvergence | PoleError::OutOfRange => error,
    })?;
    Ok(values)
}

/// The same for a matrix stored row by row in `rows`, which is destroyed, into `values`. Allocates nothing.
///
/// # Errors
/// A matrix that is not finite, or an iteration that does not converge.
pub(crate) fn eigenvalues_in_place(rows: &mut [C64], values: &mut [C64]) -> Result<(), PoleError> {
    let size = values.len();
    debug_assert_eq!(rows.len(), size * size);
    let scale = normalise(rows, size)?;
    if scale == 0.0 {
        values.fill(C64::ZERO);
        return Ok(());
    }
    // The same code with the size of small rotors known to the compiler: a third of the time for n = 3.
    match size {
        2 => solve(rows, values, 2),
        4 => solve(rows, values, 4),
        6 => solve(rows, values, 6),
        8 => solve(rows, values, 8),
        _ => solve(rows, values, size),
    }?;
    values.iter_mut().for_each(|value| *value *= scale);
    Ok(())
}

#[inline(always)]
fn solve(rows: &mut [C64], values: &mut [C64], size: usize) -> Result<(), PoleError> {
    let (rows, values) = (&mut rows[..size * size], &mut values[..size]);
    balance(rows, size);
    reduce(rows, size);
    iterate(rows, values, size)
}

/// `|re| + |im|`: as good a size as the modulus where a factor of 1.4 does not matter, and much cheaper.
fn size_of(z: C64) -> f64 {
    z.re.abs() + z.im.abs()
}

/// Checks that everything is finite and divides by the power of two that brings the largest entry near 1, so that no
/// square can overflow later on. Gives that power; 0 for the zero matrix.
fn normalise(rows: &mut [C64], size: usize) -> Result<f64, PoleError> {
    let mut largest = 0.0_f64;
    for (at, value) in rows.iter().enumerate() {
        if !(value.re.is_finite() && value.im.is_finite()) {
            return Err(PoleError::NotFinite { row: at / size + 1, column: at % size + 1 });
        }
        largest = largest.max(value.re.abs()).max(value.im.abs());
    }
    if largest == 0.0 {
        return Ok(0.0);
    }
    if (1e-60..1e60).contains(&largest) {
        return Ok(1.0);
    }
    // Clamped away from the powers whose inverse is not a normal number.
    let scale = 2.0_f64.powf(largest.log2().floor().clamp(-1000.0, 1000.0));
    rows.iter_mut().for_each(|value| *value /= scale);
    Ok(scale)
}

/// Scales rows and columns by powers of two until their sizes agree within a factor of about two (Parlett & Reinsch 1969):
/// exact, and it keeps the rounding error of a badly scaled matrix that of its small part.
#[inline(always)]
fn balance(rows: &mut [C64], size: usize) {
    // Scaling only ever lowers the norm; the bound is for matrices that have no balanced form (triangular ones).
    for _ in 0..16 {
        let mut settled = true;
        for i in 0..size {
            let mut in_column = 0.0;
            let mut in_row = 0.0;
            for k in (0..size).filter(|&k| k != i) {
                in_column += size_of(rows[k * size + i]);
                in_row += size_of(rows[i * size + k]);
            }
            // A triangle has no balanced form: what is this small is left alone, before its squares are nothing.
            if in_column < LEAST || in_row < LEAST {
                continue;
            }
            let ratio: f64 = in_row / in_column;
            if (0.25..=4.0).contains(&ratio) {
                continue;
            }
            let factor = 2.0_f64.powf((0.5 * ratio.log2()).round().clamp(-500.0, 500.0));
            if in_column * factor + in_row / factor < 0.95 * (in_column + in_row) {
                settled = false;
                for k in 0..size {
                    rows[k * size + i] *= factor;
                }
                for k in 0..size {
                    rows[i * size + k] /= factor;
                }
            }
        }
        if settled {
            break;
        }
    }
}

/// Householder reflections to upper Hessenberg form: zeros below the first subdiagonal.
#[inline(always)]
fn reduce(rows: &mut [C64], size: usize) {
    let mut vector = [C64::ZERO; 64];
    let mut wide = Vec::new();
    // The stack holds every rotor; only larger matrices, which the library's users may bring, pay for an allocation.
    let vector: &mut [C64] = if size <= vector.len() {
        &mut vector
    } else {
        wide.resize(size, C64::ZERO);
        &mut wide
    };
    for column in 0..size.saturating_sub(2) {
        let first = column + 1;
        let below: f64 = (first + 1..size).map(|i| rows[i * size + column].norm_sqr()).sum();
        if below == 0.0 {
            continue;
        }
        let head = rows[first * size + column];
        let norm = (head.norm_sqr() + below).sqrt();
        // Away from the head's own phase, so that nothing cancels.
        let size_of_head = modulus(head);
        let phase = if size_of_head == 0.0 { C64::ONE } else { head / size_of_head };
        let reflector = &mut vector[first..size];
        for (k, v) in reflector.iter_mut().enumerate() {
            *v = rows[(first + k) * size + column];
        }
        reflector[0] += phase * norm;
        let weight = 1.0 / (norm * (norm + size_of_head));
        rows[first * size + column] = -phase * norm;
        for i in first + 1..size {
            rows[i * size + column] = C64::ZERO;
        }
        // From the left, on the columns to the right...
        for j in column + 1..size {
            let dot: C64 = reflector.iter().enumerate().map(|(k, v)| v.conj() * rows[(first + k) * size + j]).sum();
            let dot = dot * weight;
            for (k, v) in reflector.iter().enumerate() {
                rows[(first + k) * size + j] -= v * dot;
            }
        }
        // ...and from the right, on every row.
        for row in rows.chunks_exact_mut(size) {
            let row = &mut row[first..];
            let dot: C64 = row.iter().zip(&*reflector).map(|(r, v)| r * v).sum();
            let dot = dot * weight;
            for (r, v) in row.iter_mut().zip(&*reflector) {
                *r -= dot * v.conj();
            }
        }
    }
}

/// Shifted QR on a Hessenberg matrix, deflating from the lower end.
#[inline(always)]
fn iterate(rows: &mut [C64], values: &mut [C64], size: usize) -> Result<(), PoleError> {
    let mut end = size;
    let mut sweeps = 0;
    let mut largest = 0.0;
    while end > 0 {
        let last = end - 1;
        // The active block begins below the lowest subdiagonal entry that is negligible beside its neighbours.
        let mut begin = last;
        while begin > 0 {
            let below = size_of(rows[begin * size + begin - 1]);
            let beside = size_of(rows[begin * size + begin]) + size_of(rows[(begin - 1) * size + begin - 1]);
            // Neighbours may be nothing but rounding themselves, as with several poles at the origin: where sweeps do not help,
            // what is negligible beside the whole matrix is.
            let beside = if sweeps > PATIENCE { beside.max(largest) } else { beside };
            if below <= f64::EPSILON * beside || below < f64::MIN_POSITIVE {
                break;
            }
            begin -= 1;
        }
        // For good: the rows above are not brought along with this block, so it must not become one with them again when
        // its diagonal has changed.
        if begin > 0 {
            rows[begin * size + begin - 1] = C64::ZERO;
        }
        if begin == last {
            values[last] = rows[last * size + last];
            end -= 1;
            sweeps = 0;
        } else if begin + 1 == last {
            let (near, far) = eigenvalues_of_two(rows, size, begin);
            (values[last], values[begin]) = (near, far);
            end -= 2;
            sweeps = 0;
        } else {
            if sweeps == SWEEPS_PER_EIGENVALUE {
                return Err(PoleError::NoConvergence);
            }
            sweeps += 1;
            if sweeps == PATIENCE {
                largest = rows.iter().map(|z| size_of(*z)).fold(0.0, f64::max);
            }
            // Now and then a shift out of step with the rest, for the rare matrix on which Wilkinson's goes in circles.
            let shift = if sweeps % 10 == 0 {
                rows[last * size + last] + 0.75 * size_of(rows[last * size + last - 1])
            } else {
                eigenvalues_of_two(rows, size, last - 1).0
            };
            sweep(rows, size, begin, last, shift);
        }
    }
    Ok(())
}

/// Both eigenvalues of the 2 x 2 block whose upper left corner is `(at, at)`: first the one nearer its lower right
/// entry, which is Wilkinson's shift.
#[inline(always)]
fn eigenvalues_of_two(rows: &[C64], size: usize, at: usize) -> (C64, C64) {
    let (a, b) = (rows[at * size + at], rows[at * size + at + 1]);
    let (c, d) = (rows[(at + 1) * size + at], rows[(at + 1) * size + at + 1]);
    let half = (a - d) * 0.5;
    let product = b * c;
    let root = square_root(half * half + product);
    // The larger of half +- root, so that the small distance from d comes from a quotient and not a difference.
    let larger = if half.re * root.re + half.im * root.im >= 0.0 { half + root } else { half - root };
    if larger == C64::ZERO { (d, a) } else { (d - product / larger, d + larger) }
}

/// The modulus of numbers known to be of ordinary size: no care for overflow, a third of the price.
fn modulus(z: C64) -> f64 {
    z.norm_sqr().sqrt()
}

/// The square root in the right half plane, likewise, and without a detour over angles.
fn square_root(z: C64) -> C64 {
    let larger = (0.5 * (modulus(z) + z.re.abs())).sqrt();
    if larger == 0.0 {
        C64::ZERO
    } else if z.re >= 0.0 {
        C64::new(larger, 0.5 * z.im / larger)
    } else {
        C64::new(0.5 * z.im.abs() / larger, larger.copysign(z.im))
    }
}

/// One implicit QR sweep with `shift` over the block `begin..=last`: a bulge of one entry is chased to the lower end by
/// plane rotations.
#[inline(always)]
fn sweep(rows: &mut [C64], size: usize, begin: usize, last: usize, shift: C64) {
    let mut x = rows[begin * size + begin] - shift;
    let mut y = rows[(begin + 1) * size + begin];
    for k in begin..last {
        // [c s; -s* c] takes (x, y) to (r, 0), c real.
        let (x_square, y_square) = (x.norm_sqr(), y.norm_sqr());
        let norm = (x_square + y_square).sqrt();
        if norm == 0.0 {
            break;
        }
        let (c, s, r) = if x_square == 0.0 {
            (0.0, C64::ONE, y)
        } else {
            let x_norm = x_square.sqrt();
            let inverse = 1.0 / (x_norm * norm);
            (x_square * inverse, x * y.conj() * inverse, x * (norm * norm * inverse))
        };
        let (upper, lower) = rows.split_at_mut((k + 1) * size);
        let upper = &mut upper[k * size..];
        let first = if k > begin {
            (upper[k - 1], lower[k - 1]) = (r, C64::ZERO);
            k
        } else {
            k
        };
        for (u, l) in upper[first..=last].iter_mut().zip(&mut lower[first..=last]) {
            let (a, b) = (*u, *l);
            *u = a * c + s * b;
            *l = b * c - s.conj() * a;
        }
        let bottom = (k + 2).min(last);
        for row in rows[begin * size..(bottom + 1) * size].chunks_exact_mut(size) {
            let [a, b] = [row[k], row[k + 1]];
            row[k] = a * c + s.conj() * b;
            row[k + 1] = b * c - s * a;
        }
        if k + 1 < last {
            x = rows[(k + 1) * size + k];
            y = rows[(k + 2) * size + k];
        }
    }
}
