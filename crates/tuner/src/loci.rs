//! The loop of one bearing among several, and what its loci have to do with it.

use std::convert::Infallible;

use linear::least;
use nalgebra::DMatrix;
use rotor::C64;

/// How near a minimum is found, in parts of the stretch that it is on: it is flat to the last place after half the digits.
const NEAR: f64 = 3e-8;

/// The loop of one bearing with the others closed.
pub(crate) fn opened(gain: &DMatrix<C64>, bearing: usize) -> C64 {
    let m = gain.nrows();
    if m == 1 {
        return gain[0];
    }
    match (gain + DMatrix::<C64>::identity(m, m)).try_inverse() {
        Some(s) => s[(bearing, bearing)].inv() - C64::ONE,
        None => -C64::ONE,
    }
}

pub(crate) fn nearest(loci: &[C64], to: C64) -> C64 {
    let distance = |l: &C64| (l - to).norm_sqr();
    loci.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(to)
}

/// The adjugate of a square matrix: of a singular one, its right null vector times its left one.
pub(crate) fn adjugate(of: &DMatrix<C64>) -> DMatrix<C64> {
    let m = of.nrows();
    DMatrix::from_fn(m, m, |i, j| {
        let minor = of.clone().remove_row(j).remove_column(i).determinant();
        if (i + j) % 2 == 0 { minor } else { -minor }
    })
}

/// Where `of` is smallest between two places around one minimum.
pub(crate) fn minimum(low: f64, high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let Ok((at, _)) = least([low, high], NEAR * (high - low), |x| Ok::<_, Infallible>(of(x)));
    at
}
