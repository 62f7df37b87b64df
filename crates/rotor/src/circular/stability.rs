//! Stability of a circular orbit: the motion linearised about it, in the frame that turns with it.

use nalgebra::DMatrix;

use super::whirl_equation::{Contact, Equation};
use crate::{C64, J, PoleError, eigenvalues};

/// How fast the fastest disturbance of an orbit grows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    /// The largest real part of an eigenvalue.
    pub rate: f64,
    /// A real part this small or smaller is rounding.
    pub noise: f64,
}

/// An eigenvalue this small, against the largest of its matrix, is the zero of a limit cycle's free phase.
const PHASE_ZERO: f64 = 1e-5;
/// Real parts below this part of the size of the matrix are rounding: some thousand rounding errors.
const NOISE: f64 = 1e-12;

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
/// # Errors
/// As for [`eigenvalues`].
pub(super) fn growth(
    equation: &Equation,
    c: &[C64],
    frequency: f64,
    contact: Contact,
    free_phase: bool,
) -> Result<Growth, PoleError> {
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
    let noise = NOISE * matrix.norm();
    let mut poles = eigenvalues(matrix)?;
    if free_phase {
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let nearest = (0..poles.len()).min_by(|&i, &k| poles[i].norm().total_cmp(&poles[k].norm()));
        if let Some(zero) = nearest.filter(|&i| poles[i].norm() <= PHASE_ZERO * largest) {
            poles.swap_remove(zero);
        }
    }
    Ok(Growth { rate: poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max), noise })
}
