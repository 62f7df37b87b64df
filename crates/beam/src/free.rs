//! Motions of a rotor as a whole that nothing resists: of one that is free in space, or held at one place alone.
//!
//! Stiffness of fine elements is so large that rounding of it leaves a slow frequency, or a slow growth, where there is neither. So these
//! motions are known by what they are, and not found among eigenvalues.

use nalgebra::{DMatrix, DVector};

use crate::modes::{scale, undamped};
use crate::{Coefficient, FullModel};

/// What is left of terms that cancel, beside their size.
const CANCELS: f64 = 1e-12;
/// How near to zero, beside the square of the first bending frequency, motions are sought in matrices of another program.
const NEAR: f64 = 1e-9;

impl FullModel {
    /// The lowest frequency in rad/s at which the shaft bends at rest while nothing holds it; 1 of what does not bend.
    #[must_use]
    pub fn bending_frequency(&self) -> f64 {
        scale(&self.mass, &self.stiffness)
    }

    /// The motions of all coordinates, at most two, that meet no stiffness: orthonormal over `M`, moving sideways first. Empty where the
    /// rotor is held at two places or more. Damping may resist them.
    #[must_use]
    pub fn free_motions(&self) -> Vec<DVector<f64>> {
        let acts = |of: &Coefficient| of.values().any(|value| value != 0.0);
        let holds = self.springs.iter().filter(|spring| !spring.is_touchdown());
        let holds = holds.filter(|spring| acts(&spring.stiffness) || acts(&spring.cross_stiffness));
        let mut held: Vec<usize> = holds.map(|spring| self.displacements[spring.node]).collect();
        held.sort_unstable();
        held.dedup();
        let whole = match held[..] {
            [] | [_] => self.motions_as_a_whole(),
            _ => return Vec::new(),
        };
        let free = match (&held[..], &whole[..]) {
            ([], _) => whole,
            // About the place that is held.
            ([at], [along, tilt]) => vec![tilt * along[*at] - along * tilt[*at]],
            _ => Vec::new(),
        };
        let mut apart: Vec<DVector<f64>> = Vec::new();
        for mut motion in free.into_iter().filter(|motion| self.is_unresisted(motion)) {
            for other in &apart {
                motion -= other * other.dot(&(&self.mass * &motion));
            }
            let size = motion.dot(&(&self.mass * &motion)).sqrt();
            apart.push(motion / size);
        }
        apart
    }

    fn motions_as_a_whole(&self) -> Vec<DVector<f64>> {
        let size = self.mass.nrows();
        if self.inside.is_empty() {
            return self.slowest_two().unwrap_or_default();
        }
        let shaft = self.first_pedestal();
        let along = DVector::from_fn(size, |i, _| f64::from(i < shaft && i % 2 == 0));
        let tilt = DVector::from_fn(size, |i, _| match i {
            _ if i >= shaft => 0.0,
            _ if i % 2 == 0 => self.nodes[i / 2].position,
            _ => 1.0,
        });
        vec![self.carried(&along), self.carried(&tilt)]
    }

    /// Of matrices whose coordinates have no meaning that is known here: what bends least.
    fn slowest_two(&self) -> Option<Vec<DVector<f64>>> {
        let scale = self.bending_frequency();
        let modes = undamped(&self.mass, &self.stiffness, scale)?;
        let near = (&self.stiffness + &self.mass * (NEAR * scale * scale)).lu();
        // Of inverse iteration the residual is as small as rounding lets it be.
        let sharper = |mode: DVector<f64>| {
            let solved = near.solve(&(&self.mass * mode))?;
            let size = solved.amax();
            Some(solved / size)
        };
        modes.column_iter().take(2).map(|mode| sharper(mode.into_owned())).collect()
    }

    fn is_unresisted(&self, motion: &DVector<f64>) -> bool {
        let size = motion.abs();
        let cancels = |matrix: &DMatrix<f64>| (matrix * motion).amax() <= CANCELS * (matrix.abs() * &size).amax();
        [&self.stiffness, &self.cross_stiffness, &self.internal].into_iter().all(cancels)
    }
}
