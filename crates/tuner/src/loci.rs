//! The loci of a loop of one or several commands, and where along them something happens.

use std::convert::Infallible;
use std::f64::consts::TAU;

use linear::{eigenvalues_in_place, least};
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

/// The eigenvalues of a loop, the largest first.
pub(crate) fn loci(gain: &DMatrix<C64>) -> Vec<C64> {
    let m = gain.nrows();
    if m == 1 {
        return vec![gain[0]];
    }
    let (mut rows, mut values): (Vec<C64>, _) = (gain.transpose().as_slice().to_vec(), vec![C64::ZERO; m]);
    match eigenvalues_in_place(&mut rows, &mut values) {
        Ok(()) => {
            values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
            values
        }
        Err(_) => vec![C64::ZERO; m],
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

/// The delay that turns a gain at a frequency onto the negative real axis.
pub(crate) fn borne(gain: C64, frequency: f64) -> f64 {
    let angle = (-gain).arg();
    let turn = if angle * frequency < 0.0 { angle + TAU.copysign(frequency) } else { angle };
    if frequency == 0.0 { f64::INFINITY } else { turn / frequency }
}

/// Where `of` is smallest between two places around one minimum.
pub(crate) fn minimum(low: f64, high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let Ok((at, _)) = least([low, high], NEAR * (high - low), |x| Ok::<_, Infallible>(of(x)));
    at
}

/// Where `of` changes sign between two places, by halving.
pub(crate) fn zero(mut low: f64, mut high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let is_low = of(low) < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (of(middle) < 0.0) == is_low { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
