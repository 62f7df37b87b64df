//! What one factorisation of a matrix tells.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::C64;

/// The inverse of a matrix, and the angle of its determinant.
#[derive(Clone, Debug)]
pub(crate) struct Inverted {
    pub(crate) inverse: DMatrix<C64>,
    /// In radians, up to whole turns.
    pub(crate) angle: f64,
}

/// A matrix as what solves equations with it, at a third of what its inverse costs.
#[derive(Clone, Debug)]
pub(crate) struct Factored {
    factors: LU<C64, Dyn, Dyn>,
    upper: DMatrix<C64>,
    lower: DMatrix<C64>,
}

impl Factored {
    /// `None` where it is singular to the last bit.
    pub(crate) fn of(m: DMatrix<C64>) -> Option<Self> {
        let factors = m.lu();
        let (lower, upper) = (factors.l(), factors.u());
        let is_regular = upper.diagonal().iter().all(|z| *z != C64::ZERO && z.is_finite());
        is_regular.then_some(Self { factors, upper, lower })
    }

    /// `M^-1 v`; `None` where that is not finite.
    pub(crate) fn solve(&self, v: &DVector<C64>) -> Option<DVector<C64>> {
        self.factors.solve(v).filter(|x| x.iter().all(|z| z.is_finite()))
    }

    /// The same with the matrix turned about its diagonal, not conjugated.
    pub(crate) fn solve_turned(&self, v: &DVector<C64>) -> Option<DVector<C64>> {
        // P M = L U, so M^T = U^T L^T P.
        let mut x = self.upper.tr_solve_upper_triangular(v)?;
        self.lower.tr_solve_lower_triangular_mut(&mut x).then_some(())?;
        self.factors.p().inv_permute_rows(&mut x);
        x.iter().all(|z| z.is_finite()).then_some(x)
    }
}

/// `None` where it is singular to the last bit.
pub(crate) fn invert(m: DMatrix<C64>) -> Option<Inverted> {
    let lu = m.lu();
    let odd = lu.p().determinant::<f64>() < 0.0;
    let angle = lu.lu_internal().diagonal().iter().map(|z| z.arg()).sum::<f64>();
    let inverse = lu.try_inverse().filter(|inverse| inverse.iter().all(|z| z.is_finite()))?;
    Some(Inverted { inverse, angle: angle + if odd { std::f64::consts::PI } else { 0.0 } })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_solves_with_a_matrix_and_with_it_turned_is_its_inverse() {
        let m = DMatrix::from_fn(5, 5, |i, k| {
            C64::new((1.3 * (i * i + 2 * k) as f64).sin(), if i == k { 2.0 } else { 0.1 })
        });
        let inverse = invert(m.clone()).unwrap().inverse;
        let factored = Factored::of(m).unwrap();
        let v = DVector::from_fn(5, |i, _| C64::new(1.0 + i as f64, 0.5 - i as f64));
        assert!((factored.solve(&v).unwrap() - &inverse * &v).norm() < 1e-12);
        assert!((factored.solve_turned(&v).unwrap() - inverse.transpose() * &v).norm() < 1e-12);
        assert!(Factored::of(DMatrix::zeros(2, 2)).is_none());
    }
}
