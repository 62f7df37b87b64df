//! The report's real state vectors and matrices, for checking and for those who expect them.
//!
//! For one mass the state is `[y z v_y v_z]` (3.23), for more it is `[y.. v_y.. z.. v_z..]` (4.13). The eigenvalues of
//! these `4n x 4n` matrices are those of the complex `2n x 2n` form together with their conjugates. The report's
//! misprints are corrected: the cross-coupled stiffness is `zeta R` without a division by `Rm`, (3.36) is `g22 = g11`,
//! and (3.33) is `B = [0; I]`.

use nalgebra::DMatrix;

use crate::{C64, Feedback, Rotor};

/// Where each coordinate stands in the report's state vector.
#[derive(Clone, Copy)]
struct Layout {
    masses: usize,
}

impl Layout {
    /// `[y, z, v_y, v_z]` of mass `i`.
    fn of(self, i: usize) -> [usize; 4] {
        let n = self.masses;
        if n == 1 { [0, 1, 2, 3] } else { [i, 2 * n + i, n + i, 3 * n + i] }
    }
}

/// Writes `row'' += factor * column` for a complex factor acting on the pair `(y, z)`: multiplication by `a + j b` is the
/// rotation-like block `[[a, -b], [b, a]]`.
fn add_block(matrix: &mut DMatrix<f64>, rows: [usize; 2], columns: [usize; 2], factor: C64) {
    matrix[(rows[0], columns[0])] += factor.re;
    matrix[(rows[0], columns[1])] -= factor.im;
    matrix[(rows[1], columns[0])] += factor.im;
    matrix[(rows[1], columns[1])] += factor.re;
}

/// `A`, the uncontrolled system matrix with the deadband neglected: (3.25), (4.15).
#[must_use]
pub fn system_matrix(rotor: &Rotor, speed: f64) -> DMatrix<f64> {
    let n = rotor.len();
    let at = Layout { masses: n };
    let mut a = DMatrix::zeros(4 * n, 4 * n);
    for (i, m) in rotor.masses().iter().enumerate() {
        let [y, z, vy, vz] = at.of(i);
        a[(y, vy)] = 1.0;
        a[(z, vz)] = 1.0;
        let shaft = |k: Option<usize>| k.and_then(|k| rotor.shafts().get(k)).copied().unwrap_or(0.0);
        let (before, after) = (shaft(i.checked_sub(1)), shaft(Some(i)));
        let stiffness = m.bearing_stiffness + m.seal_stiffness + before + after;
        add_block(&mut a, [vy, vz], [y, z], C64::new(-stiffness / m.mass, m.damping * speed));
        add_block(&mut a, [vy, vz], [vy, vz], C64::new(-2.0 * m.damping, 2.0 * m.cross_damping));
        for (neighbour, stiffness) in [(i.checked_sub(1), before), (Some(i + 1).filter(|&k| k < n), after)] {
            if let Some(k) = neighbour {
                let [yk, zk, ..] = at.of(k);
                add_block(&mut a, [vy, vz], [yk, zk], C64::from(stiffness / m.mass));
            }
        }
    }
    a
}

/// `B`, the control distribution matrix: the two forces enter the acceleration of the mass that carries the bearing.
#[must_use]
pub fn control_distribution(masses: usize, bearing: usize) -> DMatrix<f64> {
    let [_, _, vy, vz] = Layout { masses }.of(bearing);
    let mut b = DMatrix::zeros(4 * masses, 2);
    b[(vy, 0)] = 1.0;
    b[(vz, 1)] = 1.0;
    b
}

/// `G` of `u = -G x` at one speed: (3.29), and the product `G C` of (4.26) and (4.27).
#[must_use]
pub fn gain_matrix(feedback: &Feedback, masses: usize, speed: f64) -> DMatrix<f64> {
    let row = feedback.first().at(speed);
    let at = Layout { masses };
    let mut g = DMatrix::zeros(2, 4 * masses);
    for k in 0..masses {
        let [y, z, vy, vz] = at.of(k);
        add_block(&mut g, [0, 1], [y, z], row.displacement[k]);
        add_block(&mut g, [0, 1], [vy, vz], row.velocity[k]);
    }
    g
}

/// `A - B G`, the closed-loop system matrix: (3.34), (4.23).
#[must_use]
pub fn closed_loop_matrix(rotor: &Rotor, feedback: &Feedback, speed: f64) -> DMatrix<f64> {
    let n = rotor.len();
    system_matrix(rotor, speed) - control_distribution(n, feedback.first().station) * gain_matrix(feedback, n, speed)
}

/// The report's real state vector of a complex state.
#[must_use]
pub fn state_vector(displacement: &[C64], velocity: &[C64]) -> Vec<f64> {
    let n = displacement.len();
    let at = Layout { masses: n };
    let mut x = vec![0.0; 4 * n];
    for (i, (p, v)) in displacement.iter().zip(velocity).enumerate() {
        let [y, z, vy, vz] = at.of(i);
        (x[y], x[z], x[vy], x[vz]) = (p.re, p.im, v.re, v.im);
    }
    x
}
