//! Stability of a circular orbit: the motion linearised about it, in the frame that turns with it.

use nalgebra::{DMatrix, DVector};

use super::CircularError;
use super::problem::Contact;
use super::whirl_equation::Equation;
use crate::quadratic::Quadratic;
use crate::{C64, J, PoleError, eigenvalues};

/// An eigenvalue this small, against the largest of its matrix, is the zero of a limit cycle's free phase.
pub(super) const PHASE_ZERO: f64 = 1e-5;

/// The largest real part among the eigenvalues of the disturbance `q` in `p = (c + q) exp(j w tau)`:
///
/// ```text
/// q'' + (C + 2 j w) q' + A q + B conj(q) = 0
/// ```
///
/// with `(A, B)` the slope of the whirl equation. In `q` and `conj(q)` this is a complex `4n x 4n` matrix, similar to
/// the real one in the parts of `q` and `q'`. With `free_phase` the eigenvalue nearest to zero is left out if it is below
/// `1e-5` of the largest: turning the whole orbit costs nothing.
///
/// Zero where it is rounding, by the noise level that tells marginal poles everywhere (the module `marginal`).
///
/// # Errors
/// Eigenvalues that cannot be had.
pub(super) fn growth(
    equation: &Equation,
    c: &[C64],
    frequency: f64,
    contact: Contact,
    free_phase: bool,
) -> Result<f64, CircularError> {
    if let Some(around) = equation.around() {
        let (factors, turned) = equation.bearings_about(c, contact);
        let pushed: Vec<_> = turned.iter().enumerate().map(|(k, by)| equation.push(k) * *by).collect();
        return Ok(around.growth(factors, &pushed, frequency, free_phase)?);
    }
    let n = c.len();
    let (a, b) = equation.slope(c, frequency, contact);
    let mut matrix = DMatrix::<C64>::zeros(4 * n, 4 * n);
    // Order: q, conj(q), q', conj(q').
    matrix.view_mut((0, 2 * n), (2 * n, 2 * n)).fill_with_identity();
    for i in 0..n {
        matrix[(2 * n + i, n + i)] = -b[i];
        matrix[(3 * n + i, i)] = -b[i].conj();
        for k in 0..n {
            let mut damping = equation.damping()[(i, k)];
            if i == k {
                damping += J * (2.0 * frequency);
            }
            matrix[(2 * n + i, k)] = -a[(i, k)];
            matrix[(3 * n + i, n + k)] = -a[(i, k)].conj();
            matrix[(2 * n + i, 2 * n + k)] = -damping;
            matrix[(3 * n + i, 3 * n + k)] = -damping.conj();
        }
    }
    let (k, d) = (matrix.view((2 * n, 0), (2 * n, 2 * n)), matrix.view((2 * n, 2 * n), (2 * n, 2 * n)));
    let disturbed = Disturbed { k: k.into_owned(), d: d.into_owned() };
    let mut poles = eigenvalues(matrix).map_err(PoleError::from)?;
    if free_phase {
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let nearest = (0..poles.len()).min_by(|&i, &k| poles[i].norm().total_cmp(&poles[k].norm()));
        if let Some(zero) = nearest.filter(|&i| poles[i].norm() <= PHASE_ZERO * largest) {
            poles.swap_remove(zero);
        }
    }
    disturbed.settle(&mut poles);
    Ok(poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max))
}

/// The disturbance `x = (q, conj(q))` as `x'' = K x + D x'`.
struct Disturbed {
    k: DMatrix<C64>,
    d: DMatrix<C64>,
}

impl Disturbed {
    /// Sets to zero what of each pole is rounding.
    fn settle(&self, poles: &mut [C64]) {
        let rows = |m: &DMatrix<C64>| m.transpose().as_slice().to_vec();
        let equations = Quadratic::of_rows(self.k.nrows(), rows(&self.k), rows(&self.d));
        equations.settle_by(poles, &|pole| self.condition(pole));
    }

    /// `|q (2 lambda I - D) p|` with the vectors of `pole` in norm 1; 0, the worst, where they cannot be had.
    fn condition(&self, pole: C64) -> f64 {
        let size = self.k.nrows();
        // A little off the pole, where the matrix can be solved with.
        let near = pole + 1e-9 * (1.0 + pole.norm());
        let q = DMatrix::identity(size, size) * (near * near) - &self.d * near - &self.k;
        let null = |q: DMatrix<C64>| -> Option<DVector<C64>> {
            let lu = q.lu();
            let mut x = DVector::from_fn(size, |k, _| C64::cis(k as f64 * 1.618_033_988_75));
            for _ in 0..2 {
                x = lu.solve(&x)?;
                let norm = x.norm();
                x.unscale_mut(norm);
            }
            Some(x)
        };
        let (Some(right), Some(left)) = (null(q.clone()), null(q.transpose())) else { return 0.0 };
        let product = left.dot(&(&right * (pole * 2.0) - &self.d * &right)).norm();
        if product.is_finite() { product } else { 0.0 }
    }
}
