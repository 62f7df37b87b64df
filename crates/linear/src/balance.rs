//! Balancing: rows and columns of a matrix brought to like sizes.

use nalgebra::DMatrix;

use crate::C64;
use crate::eigenvalues::size_of;

/// Rows and columns smaller than this are not balanced.
const LEAST: f64 = 1e-120;

/// Scales rows and columns by powers of two until their sizes agree within a factor of about two (Parlett & Reinsch 1969):
/// exact, and it keeps the rounding error of a badly scaled matrix that of its small part. `M`, row by row in `rows`, becomes
/// `D^-1 M D`; `scaled` is told of every factor that an entry of the diagonal `D` grows by.
#[inline(always)]
pub(crate) fn balance(rows: &mut [C64], size: usize, mut scaled: impl FnMut(usize, f64)) {
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
                scaled(i, factor);
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

/// The same for a matrix of the library; gives the diagonal of `D`.
pub(crate) fn balance_matrix(m: &mut DMatrix<C64>) -> Vec<f64> {
    let size = m.nrows();
    let mut scales = vec![1.0; size];
    // Column by column in memory: row by row it is the transpose, which `D` scales the other way round.
    balance(m.as_mut_slice(), size, |i, factor| scales[i] /= factor);
    scales
}
