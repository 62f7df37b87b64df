//! Modes of the rotor at rest, without damping and without what holds it.

use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, Dyn};

/// `L` of `M = L L^T`, unless `M` is not positive definite.
fn factor(mass: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    if mass.iter().any(|m| !m.is_finite()) {
        return None;
    }
    Cholesky::new(mass.clone())
}

/// A frequency among the slow modes in rad/s: the third, which is the first to bend a free rotor. For shifts, not for people.
pub(crate) fn scale(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>) -> f64 {
    let squares = factor(mass).and_then(|factor| {
        let half = factor.l_dirty().solve_lower_triangular(stiffness)?;
        let whole = factor.l_dirty().solve_lower_triangular(&half.transpose())?;
        let even = (&whole + whole.transpose()) * 0.5;
        even.iter().all(|entry| entry.is_finite()).then(|| even.symmetric_eigenvalues())
    });
    let mut squares: Vec<f64> = squares.map_or_else(Vec::new, |squares| squares.iter().copied().collect());
    squares.sort_by(f64::total_cmp);
    let third = squares.get(2).or(squares.last()).copied().unwrap_or(0.0);
    if third > 0.0 { third.sqrt() } else { 1.0 }
}

/// The shapes of all modes of `K v = w^2 M v`, a column each, the slowest first, with `V^T M V = 1`; `None` where `M` is not positive
/// definite.
///
/// Of the inverse about `-scale^2`, so that slow modes do not drown in the rounding of fast ones.
pub(crate) fn undamped(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>, scale: f64) -> Option<DMatrix<f64>> {
    let lower = factor(mass)?.l();
    let held = Cholesky::new(stiffness + mass * (scale * scale))?;
    let inverse = lower.transpose() * held.solve(&lower);
    let even = (&inverse + inverse.transpose()) * 0.5;
    if even.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let found = even.symmetric_eigen();
    let mut order: Vec<usize> = (0..found.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
    let vectors = DMatrix::from_fn(mass.nrows(), mass.nrows(), |row, k| found.eigenvectors[(row, order[k])]);
    lower.transpose().solve_upper_triangular(&vectors)
}
