//! Eigenvalues of a matrix, balanced first; and what one factorisation of a matrix tells.

use nalgebra::{DMatrix, Schur};

use crate::{C64, DelayError};

/// Iterations allowed for one row of a matrix: three or four are usual.
const ITERATIONS_PER_ROW: usize = 40;

/// Scales rows and columns by powers of two until their sizes agree within a factor of two or so (Parlett & Reinsch 1969),
/// `D^-1 M D` in place, and gives the diagonal of `D`. Exact, and it keeps rounding small where a matrix is.
pub(crate) fn balance(m: &mut DMatrix<C64>) -> Vec<f64> {
    let n = m.nrows();
    let mut scales = vec![1.0; n];
    for _ in 0..20 {
        let mut settled = true;
        for i in 0..n {
            let others = || (0..n).filter(|&k| k != i);
            let column: f64 = others().map(|k| m[(k, i)].l1_norm()).sum();
            let row: f64 = others().map(|k| m[(i, k)].l1_norm()).sum();
            if !(column > 0.0 && row > 0.0) {
                continue;
            }
            let factor = 2.0_f64.powf((0.5 * (row / column).log2()).round().clamp(-300.0, 300.0));
            if column * factor + row / factor < 0.95 * (column + row) {
                settled = false;
                scales[i] *= factor;
                for k in 0..n {
                    m[(k, i)] *= factor;
                }
                for k in 0..n {
                    m[(i, k)] /= factor;
                }
            }
        }
        if settled {
            break;
        }
    }
    scales
}

/// The eigenvalues of `m`, in no particular order.
pub(crate) fn eigenvalues(mut m: DMatrix<C64>) -> Result<Vec<C64>, DelayError> {
    let n = m.nrows();
    if n == 0 {
        return Ok(Vec::new());
    }
    // No iteration can end on what is not a number.
    if !m.iter().all(|z| z.is_finite()) {
        return Err(DelayError::NotFinite);
    }
    balance(&mut m);
    let schur = |m, tolerance: f64| Schur::try_new(m, tolerance, ITERATIONS_PER_ROW * n).map(|schur| schur.unpack().1);
    if let Some(triangle) = schur(m.clone(), f64::EPSILON) {
        return Ok(triangle.diagonal().iter().copied().collect());
    }
    // Now and then the iteration stands still a last place above its tolerance. Seen from the other side, or with a last
    // place more, it does not.
    for (is_turned, places) in [(true, 1.0), (false, 2.0), (true, 2.0), (false, 4.0), (true, 4.0)] {
        let seen = if is_turned { m.transpose() } else { m.clone() };
        if let Some(triangle) = schur(seen, places * f64::EPSILON) {
            return Ok(triangle.diagonal().iter().copied().collect());
        }
    }
    // Several poles at the origin, as samples under way are, are nothing but rounding beside one another, and then never
    // negligible: away from the origin all are beside the size of the matrix.
    let away = C64::from(m.norm());
    m.iter_mut().step_by(n + 1).for_each(|z| *z += away);
    let triangle = schur(m, f64::EPSILON).ok_or(DelayError::NoConvergence(n))?;
    Ok(triangle.diagonal().iter().map(|z| z - away).collect())
}

/// The inverse of a matrix, and the angle of its determinant.
#[derive(Clone, Debug)]
pub(crate) struct Inverted {
    pub(crate) inverse: DMatrix<C64>,
    /// In radians, up to whole turns.
    pub(crate) angle: f64,
}

/// `None` where it is singular to the last bit.
pub(crate) fn invert(m: DMatrix<C64>) -> Option<Inverted> {
    let lu = m.lu();
    let odd = lu.p().determinant::<f64>() < 0.0;
    let angle = lu.lu_internal().diagonal().iter().map(|z| z.arg()).sum::<f64>();
    let inverse = lu.try_inverse().filter(|inverse| inverse.iter().all(|z| z.is_finite()))?;
    Some(Inverted { inverse, angle: angle + if odd { std::f64::consts::PI } else { 0.0 } })
}
