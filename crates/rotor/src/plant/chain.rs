//! The chain of masses: each is joined to its two neighbours alone, so its forces need no matrices.

use nalgebra::{DMatrix, DVector};

use crate::C64;

/// Neighbours joined by shafts: three diagonals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    pub(super) damping: Vec<C64>,
    /// Own stiffness without bearings: at rest, and per unit of speed.
    pub(super) stiffness: Vec<[C64; 2]>,
    pub(super) before: Vec<f64>,
    pub(super) after: Vec<f64>,
}

impl Chain {
    #[inline]
    pub(super) fn acceleration(&self, speed: f64, q: &[C64], v: &[C64], out: &mut [C64]) {
        let last = q.len() - 1;
        for i in 0..=last {
            let [at_rest, per_speed] = self.stiffness[i];
            let mut a = self.damping[i] * v[i] + (at_rest + per_speed * speed) * q[i];
            if i > 0 {
                a += q[i - 1] * self.before[i];
            }
            if i < last {
                a += q[i + 1] * self.after[i];
            }
            out[i] = a;
        }
    }

    pub(super) fn matrices(&self, speed: f64) -> [DMatrix<C64>; 2] {
        let n = self.damping.len();
        let damping = DMatrix::from_diagonal(&DVector::from_column_slice(&self.damping));
        let mut stiffness = DMatrix::zeros(n, n);
        for i in 0..n {
            stiffness[(i, i)] = self.stiffness[i][0] + self.stiffness[i][1] * speed;
            if i > 0 {
                stiffness[(i, i - 1)] = C64::from(self.before[i]);
            }
            if i + 1 < n {
                stiffness[(i, i + 1)] = C64::from(self.after[i]);
            }
        }
        [damping, stiffness]
    }
}
