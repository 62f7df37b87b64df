//! Eigenvalues of `M p'' + D p' + S p = 0`.
//!
//! Fine elements have modes of 10^7 rad/s and more, and rounding beside their squares would drown the slow ones: in
//! `M^-1 S` an entry of 10^15 leaves nothing below 0.1. So eigenvalues are those of the inverse about a point `z` near the slow
//! ones. With `s = z (1 + 1 / u)` the equation becomes
//!
//! ```text
//! u^2 (S + z D + z^2 M) + u (z D + 2 z^2 M) + z^2 M = 0
//! ```
//!
//! where slow poles are the large `u`. Eigenvalues of that are backward stable beside 1, so what is lost is lost at the fast
//! end, where elements mean nothing anyway.

use linear::EigenvalueError;
use nalgebra::DMatrix;

use crate::C64;

/// Why there are no eigenvalues or no response.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleError {
    /// The equations have no one solution.
    #[error("the matrices of the rotor are singular, or not finite")]
    Singular,
    /// The iteration failed.
    #[error(transparent)]
    Eigenvalues(#[from] EigenvalueError),
}

/// The eigenvalues, least in size first; `scale` in rad/s is where the slow ones are.
pub(crate) fn eigenvalues(
    mass: &DMatrix<C64>,
    damping: &DMatrix<C64>,
    stiffness: &DMatrix<C64>,
    scale: f64,
) -> Result<Vec<C64>, PoleError> {
    let size = mass.nrows();
    // Off both axes: poles lie near the imaginary one, and those of magnets without control on the real one.
    for z in [C64::new(0.8, 0.6), C64::new(0.5, -0.7), C64::new(2.1, 1.3)].map(|z| z * scale) {
        let inertia = mass * (z * z);
        let drag = damping * z;
        let lu = (stiffness + &drag + &inertia).lu();
        let (Some(first), Some(second)) = (lu.solve(&(drag + &inertia * C64::from(2.0))), lu.solve(&inertia)) else {
            continue;
        };
        let mut companion = DMatrix::from_element(2 * size, 2 * size, C64::ZERO);
        companion.view_mut((0, 0), (size, size)).copy_from(&-first);
        companion.view_mut((0, size), (size, size)).copy_from(&-second);
        companion.view_mut((size, 0), (size, size)).fill_with_identity();
        if companion.iter().any(|entry| !entry.is_finite()) {
            continue;
        }
        let mut poles: Vec<C64> =
            linear::eigenvalues(companion)?.into_iter().map(|u| z * (C64::ONE + u.inv())).collect();
        poles.retain(|pole| pole.is_finite());
        poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        return Ok(poles);
    }
    Err(PoleError::Singular)
}
