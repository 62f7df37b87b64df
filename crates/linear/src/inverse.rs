//! What one factorisation of a matrix tells.

use nalgebra::DMatrix;

use crate::C64;

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
