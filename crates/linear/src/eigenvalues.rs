//! Eigenvalues of dense complex matrices: balancing, Householder reduction to Hessenberg form, shifted QR.
//!
//! The matrices here have 2 to some hundred rows and only their eigenvalues are wanted, so the routine keeps neither the unitary
//! factor nor anything outside the active block, and up to 64 rows allocates nothing: about half the work of a full Schur
//! decomposition. The algorithm is the classical one (Francis; Wilkinson, *The Algebraic Eigenvalue Problem*, ch. 8;
//! Golub & Van Loan, ch. 7), with Wilkinson's shift and a bounded number of sweeps. Eigenvectors are not its job.
//!
//! Ours, and not a library's, by measurement (`cargo bench -p linear --features faer`): beside faer 0.24 on one thread it
//! takes half the time at 4 and 8 rows, two thirds at 16, four fifths at 32, and as long from 48 to 128; beside
//! nalgebra a third to a seventh. faer costs two minutes of processor time in the first build, does not balance, and does not
//! tell when its iteration has not converged, so it is no second opinion either.

use nalgebra::DMatrix;

use crate::C64;
use crate::balance::balance;

/// Bound on the QR sweeps for one eigenvalue. Two to three are usual; LAPACK gives up after 30 as well.
const SWEEPS_PER_EIGENVALUE: usize = 30;

/// Rows up to which the columns of a matrix are near enough to one another in memory.
const NARROW: usize = 64;

/// Why there are no eigenvalues.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EigenvalueError {
    /// The matrix holds a value that is not finite: checked first, because no iteration can end on one.
    #[error("the system matrix is not finite at row {row}, column {column}")]
    NotFinite {
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
    },
    /// The iteration did not converge within its bound.
    #[error("the eigenvalues of a matrix with {0} rows did not converge in {SWEEPS_PER_EIGENVALUE} sweeps each")]
    NoConvergence(usize),
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
pub fn eigenvalues(matrix: DMatrix<C64>) -> Result<Vec<C64>, EigenvalueError> {
    assert!(matrix.is_square(), "only square matrices have eigenvalues");
    let size = matrix.nrows();
    // Column by column in memory: row by row it is the transpose, which has the same eigenvalues.
    let mut rows: Vec<C64> = matrix.data.into();
    let mut values = vec![C64::ZERO; size];
    eigenvalues_in_place(&mut rows, &mut values).map_err(|error| match error {
        EigenvalueError::NotFinite { row, column } => EigenvalueError::NotFinite { row: column, column: row },
        EigenvalueError::NoConvergence(_) => error,
    })?;
    Ok(values)
}

/// The same for a matrix stored row by row in `rows`, which is destroyed, into `values`. Allocates nothing.
///
/// # Errors
/// A matrix that is not finite, or an iteration that does not converge.
///
/// # Panics
/// If `rows` does not hold as many rows and columns as there are `values`.
pub fn eigenvalues_in_place(rows: &mut [C64], values: &mut [C64]) -> Result<(), EigenvalueError> {
    let size = values.len();
    assert_eq!(rows.len(), size * size, "a square matrix with a row for every value");
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
fn solve(rows: &mut [C64], values: &mut [C64], size: usize) -> Result<(), EigenvalueError> {
    let (rows, values) = (&mut rows[..size * size], &mut values[..size]);
    balance(rows, size, |_, _| ());
    reduce(rows, size);
    let Err(left) = iterate(rows, values, size) else { return Ok(()) };
    // Several eigenvalues at the origin, as of masses that nothing holds or of samples under way, are rounding beside
    // one another and then never negligible. Away from the origin all are beside the size of the matrix.
    let away = C64::from(rows[..left * size].iter().map(C64::norm_sqr).sum::<f64>().sqrt());
    rows.iter_mut().step_by(size + 1).for_each(|z| *z += away);
    iterate(rows, &mut values[..left], size).map_err(|_| EigenvalueError::NoConvergence(size))?;
    values[..left].iter_mut().for_each(|z| *z -= away);
    Ok(())
}

/// `|re| + |im|`: as good a size as the modulus where a factor of 1.4 does not matter, and much cheaper.
pub(crate) fn size_of(z: C64) -> f64 {
    z.re.abs() + z.im.abs()
}

/// Checks that everything is finite and divides by the power of two that brings the largest entry near 1, so that no
/// square can overflow later on. Gives that power; 0 for the zero matrix.
fn normalise(rows: &mut [C64], size: usize) -> Result<f64, EigenvalueError> {
    let mut largest = 0.0_f64;
    for (at, value) in rows.iter().enumerate() {
        if !(value.re.is_finite() && value.im.is_finite()) {
            return Err(EigenvalueError::NotFinite { row: at / size + 1, column: at % size + 1 });
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

/// Householder reflections to upper Hessenberg form: zeros below the first subdiagonal.
#[inline(always)]
fn reduce(rows: &mut [C64], size: usize) {
    let mut vector = [C64::ZERO; NARROW];
    let mut wide = Vec::new();
    // The stack holds every rotor in few coordinates; only larger matrices, such as those of all its elements, pay for an allocation.
    let (vector, dots): (&mut [C64], &mut [C64]) = if size <= NARROW {
        (&mut vector, &mut [])
    } else {
        wide.resize(2 * size, C64::ZERO);
        wide.split_at_mut(size)
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
        // From the left, on the columns to the right: of a large matrix row by row, as it lies in memory...
        if size > NARROW {
            let dots = &mut dots[first..size];
            dots.fill(C64::ZERO);
            for (k, v) in reflector.iter().enumerate() {
                let v = v.conj() * weight;
                let row = &rows[(first + k) * size + first..(first + k + 1) * size];
                dots.iter_mut().zip(row).for_each(|(dot, r)| *dot += v * r);
            }
            for (k, v) in reflector.iter().enumerate() {
                let row = &mut rows[(first + k) * size + first..(first + k + 1) * size];
                row.iter_mut().zip(&*dots).for_each(|(r, dot)| *r -= v * dot);
            }
        } else {
            for j in column + 1..size {
                let dot: C64 = reflector.iter().enumerate().map(|(k, v)| v.conj() * rows[(first + k) * size + j]).sum();
                let dot = dot * weight;
                for (k, v) in reflector.iter().enumerate() {
                    rows[(first + k) * size + j] -= v * dot;
                }
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

/// Shifted QR on the leading part of a Hessenberg matrix that is as large as there are `values`, deflating from its lower
/// end. Where it does not converge, how many of them are still to be found, in the part that leads now.
#[inline(always)]
fn iterate(rows: &mut [C64], values: &mut [C64], size: usize) -> Result<(), usize> {
    let mut end = values.len();
    let mut sweeps = 0;
    while end > 0 {
        let last = end - 1;
        // The active block begins below the lowest subdiagonal entry that is negligible beside its neighbours.
        let mut begin = last;
        while begin > 0 {
            let below = size_of(rows[begin * size + begin - 1]);
            let beside = size_of(rows[begin * size + begin]) + size_of(rows[(begin - 1) * size + begin - 1]);
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
                return Err(end);
            }
            sweeps += 1;
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
