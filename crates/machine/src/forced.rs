//! A machine that is driven: what its coordinates do under forces that turn at one frequency.

use nalgebra::DMatrix;
use rotor::{C64, LinearForm};

/// The displacement of every coordinate over `exp(j w tau)` under accelerations of them that turn like that, a column each:
/// `(j w I - A - B C exp(-j w T)) x = [0; drive]`, of `x` the displacements.
///
/// `drive` is `form.coordinates` high, in `w0^2 e_t`; the answer is in `e_t`. Nothing of a sampled loop, whose answer is no circle, and
/// where the machine has a pole at this very frequency.
#[must_use]
pub fn forced_response(form: &LinearForm, frequency: f64, drive: &DMatrix<C64>) -> Option<DMatrix<C64>> {
    let [a, b, c] = form.continuous()?;
    let (n, s) = (form.coordinates, C64::new(0.0, frequency));
    let mut m = -(a + b * c * (-s * form.delay).exp());
    (0..m.nrows()).for_each(|i| m[(i, i)] += s);
    let mut forces = DMatrix::zeros(m.nrows(), drive.ncols());
    forces.view_mut((n, 0), drive.shape()).copy_from(drive);
    Some(m.lu().solve(&forces)?.rows(0, n).into_owned())
}
