//! Which bearing moves which mode, and which sensor sees it: modal controllability and observability.
//!
//! The report picks bearing and sensors by looking at mode shapes. The numbers behind the look: the cosine of the angle
//! between a mode's left eigenvector `y` and the input `b_i` of a bearing at mass i, and between its right eigenvector `x`
//! and the row `c_i` of a sensor there (Hamdan & Nayfeh 1989); and the least singular value of `[A - lambda I, b_i]`, which
//! is zero exactly if that bearing leaves some mode of this pole alone (Popov, Belevitch, Hautus).

use nalgebra::{DMatrix, DVector};

use crate::modes::scale_to_largest;
use crate::quadratic::Quadratic;
use crate::{C64, ClosedLoop, PoleError, poles};

/// Below this share of the size of `A`, the least singular value of the Hautus test counts as zero.
pub const PBH_LIMIT: f64 = 1e-10;

/// One mode, with the influence of a bearing and a sensor at each mass.
#[derive(Clone, Debug, PartialEq)]
pub struct Influence {
    /// The mode's pole.
    pub pole: C64,
    /// Its shape, scaled so that the largest component is 1.
    pub shape: Vec<C64>,
    /// Per mass, from 0 to 1: how directly a control force there drives this mode, `|y b_i| / (|y| |b_i|)`.
    pub controllability: Vec<f64>,
    /// Per mass, from 0 to 1: how much of this mode a displacement sensor there sees, `|c_i x| / (|c_i| |x|)`. A velocity
    /// sensor sees `|lambda|` times that.
    pub observability: Vec<f64>,
    /// Per mass: least singular value of `[A - lambda I, b_i]` over the norm of `A`, to about a hundredth. Below [`PBH_LIMIT`] this pole stays
    /// where it is whatever a bearing at that mass does.
    pub pbh: Vec<f64>,
}

/// The influence of every position on every mode, least damped mode first.
///
/// # Errors
/// Coefficients that are not finite, or an eigenvalue iteration that does not converge.
pub fn influence(closed_loop: &ClosedLoop) -> Result<Vec<Influence>, PoleError> {
    let quadratic = Quadratic::of(closed_loop);
    let n = closed_loop.masses();
    let matrix = closed_loop.state_matrix();
    let made = poles(closed_loop)?.into_iter().map(|pole| {
        let (mut shape, mut q, mut first) = (vec![C64::ZERO; n], vec![C64::ZERO; n], vec![C64::ZERO; n]);
        quadratic.vectors(pole, &mut shape, &mut q);
        quadratic.row_times_damping(&q, &mut first);
        first.iter_mut().zip(&q).for_each(|(f, q)| *f = q * pole - *f);
        let length = |v: &[C64]| v.iter().map(C64::norm_sqr).sum::<f64>();
        let left = (length(&first) + length(&q)).sqrt();
        let right = (length(&shape) * (1.0 + pole.norm_sqr())).sqrt();
        let controllability = q.iter().map(|y| y.norm() / left).collect();
        let observability = shape.iter().map(|p| p.norm() / right).collect();
        let pbh = (0..n).map(|bearing| hautus(&matrix, pole, bearing)).collect();
        scale_to_largest(&mut shape);
        Influence { pole, shape, controllability, observability, pbh }
    });
    Ok(made.collect())
}

/// The least singular value of `[A - lambda I, b]` over the norm of `A`.
fn hautus(matrix: &DMatrix<C64>, pole: C64, bearing: usize) -> f64 {
    let size = matrix.nrows();
    let mut wide = matrix.clone().insert_column(size, C64::ZERO);
    (0..size).for_each(|i| wide[(i, i)] -= pole);
    wide[(size / 2 + bearing, size)] = C64::ONE;
    // Inverse iteration on the triangle of its QR decomposition: nalgebra's singular values are not to be had of every
    // singular matrix, and these are singular whenever it matters.
    let triangle = wide.adjoint().qr().r();
    let mut vector = DVector::from_fn(size, |i, _| C64::cis(i as f64 * 1.618_033_988_75));
    vector.normalize_mut();
    let mut least = f64::INFINITY;
    for _ in 0..16 {
        let Some(half) = triangle.ad_solve_upper_triangular(&vector) else { return 0.0 };
        let Some(next) = triangle.solve_upper_triangular(&half) else { return 0.0 };
        let grown = next.norm();
        if !grown.is_finite() {
            return 0.0;
        }
        least = grown.sqrt().recip();
        vector = next / C64::from(grown);
    }
    least / matrix.norm()
}
