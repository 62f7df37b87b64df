//! The chain of masses: each is joined to its two neighbours alone, so its forces need no matrices.

use nalgebra::{DMatrix, DVector};

use super::{Contact, Direction, Form, Plant, Station};
use crate::{C64, Rotor};

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

impl Plant {
    pub(super) fn of_chain(rotor: &Rotor) -> Self {
        let (masses, shafts) = (rotor.masses(), rotor.shafts());
        let count = masses.len();
        let shaft = |i: Option<usize>| i.and_then(|i| shafts.get(i)).copied().unwrap_or(0.0);
        let mut chain = Chain { damping: vec![], stiffness: vec![], before: vec![], after: vec![] };
        let mut contacts = Vec::new();
        for (i, m) in masses.iter().enumerate() {
            let (before, after) = (shaft(i.checked_sub(1)), shaft(Some(i)));
            chain.damping.push(C64::new(-2.0 * m.damping, 2.0 * m.cross_damping));
            let own = C64::from(-(m.seal_stiffness + before + after) / m.mass);
            chain.stiffness.push([own, C64::new(0.0, m.damping)]);
            chain.before.push(before / m.mass);
            chain.after.push(after / m.mass);
            contacts.push(Contact {
                station: i,
                column: Direction::Unit(i),
                stiffness: m.bearing_stiffness / m.mass,
                is_touchdown: false,
            });
        }
        Self {
            order: count,
            form: Form::Chain(chain),
            stations: (0..count)
                .map(|i| Station { name: format!("mass {}", i + 1), row: Direction::Unit(i) })
                .collect(),
            contacts,
            unbalance: masses.iter().map(|m| C64::from(m.unbalance)).collect(),
            moment: masses.iter().map(|m| C64::from(m.mass * m.unbalance)).collect(),
            columns: (0..count).map(Direction::Unit).collect(),
            tabulated: vec![],
            is_unit: true,
            free: vec![],
        }
    }
}
