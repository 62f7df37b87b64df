//! The rotor of the cases on two magnetic bearings under control: PI with lead and the lag of an amplifier.

use beam::{C64, Drawing, FullModel, Reduced};
use nalgebra::{DMatrix, RowDVector};
use serde_json::Value;

/// What a model is to a controller: `M`, `D`, `S`, and the displacement at each bearing.
pub(crate) struct Plant {
    matrices: (DMatrix<C64>, DMatrix<C64>, DMatrix<C64>),
    bearings: Vec<RowDVector<C64>>,
}

impl Plant {
    pub(crate) fn full(full: &FullModel, drawing: &Drawing, speed: f64) -> Self {
        let size = full.mass.nrows();
        let row = |station: usize| {
            RowDVector::from_fn(size, |_, column| C64::from(f64::from(column == 2 * full.station_nodes[station])))
        };
        Self {
            matrices: full.at(speed),
            bearings: drawing.magnetics.iter().map(|magnetic| row(magnetic.station)).collect(),
        }
    }

    pub(crate) fn reduced(reduced: &Reduced, full: &FullModel, drawing: &Drawing, speed: f64) -> Self {
        let row = |station: usize| reduced.displacement(full.station_nodes[station]).map(C64::from);
        Self {
            matrices: reduced.at(&full.springs, speed),
            bearings: drawing.magnetics.iter().map(|magnetic| row(magnetic.station)).collect(),
        }
    }

    /// The poles with the case's controller at every bearing, each pulling with `force` N/A.
    pub(crate) fn closed_loop(&self, case: &Value, force: f64) -> Vec<C64> {
        let number = |key: &str| case[key].as_f64().expect("a number");
        let (gain, wi, wz, wp, wa) = (number("Kp"), number("wi"), number("wz"), number("wp"), number("wa"));
        // Kp (1 + wi / s) (s / wz + 1) / (s / wp + 1) / (s / wa + 1), rising powers, the denominator monic.
        let lead = gain * wp * wa;
        let numerator = [lead * wi, lead * (1.0 + wi / wz), lead / wz];
        let denominator = [0.0, wp * wa, wp + wa];

        let (mass, damping, stiffness) = &self.matrices;
        let n = mass.nrows();
        let size = 2 * n + 3 * self.bearings.len();
        let mut a = DMatrix::from_element(size, size, C64::ZERO);
        let mut e = DMatrix::from_diagonal_element(size, size, C64::ONE);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&-stiffness);
        a.view_mut((n, n), (n, n)).copy_from(&-damping);
        e.view_mut((n, n), (n, n)).copy_from(mass);
        for (i, row) in self.bearings.iter().enumerate() {
            let x = 2 * n + 3 * i;
            for k in 0..3 {
                let push = row.transpose() * C64::from(-force * numerator[k]);
                a.view_mut((n, x + k), (n, 1)).copy_from(&push);
                a[(x + 2, x + k)] = C64::from(-denominator[k]);
            }
            a[(x, x + 1)] = C64::ONE;
            a[(x + 1, x + 2)] = C64::ONE;
            a.view_mut((x + 2, 0), (1, n)).copy_from(row);
        }
        // About a point near the slow poles, which would drown in rounding otherwise.
        let z = C64::new(300.0, 400.0);
        let inverse = (a - &e * z).lu().solve(&e).expect("no pole at z");
        let poles = linear::eigenvalues(inverse).expect("eigenvalues");
        poles.into_iter().map(|u| z + u.inv()).filter(|pole| pole.is_finite()).collect()
    }
}
