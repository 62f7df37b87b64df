//! Pedestals: one coordinate each behind those of the shaft. Their bearings are springs between two coordinates of the model
//! ([`crate::Spring::pedestal`]); what holds a pedestal to the ground is in the matrices.

use nalgebra::{DMatrix, DVector};

use crate::drawing::Drawing;
use crate::model::{FullModel, Place};
use crate::{Coefficient, Spring};

impl FullModel {
    /// It with the pedestals of `drawing`, whose bearings are among its springs already.
    pub(crate) fn on_pedestals(mut self, drawing: &Drawing) -> Self {
        let (first, count) = (self.mass.nrows(), drawing.pedestals.len());
        if count == 0 {
            return self;
        }
        let size = first + count;
        let matrices = [
            &mut self.mass,
            &mut self.damping,
            &mut self.gyroscopic,
            &mut self.stiffness,
            &mut self.cross_stiffness,
            &mut self.internal,
        ];
        matrices.into_iter().for_each(|matrix| *matrix = std::mem::take(matrix).resize(size, size, 0.0));
        for (i, pedestal) in drawing.pedestals.iter().enumerate() {
            let at = first + i;
            self.mass[(at, at)] = pedestal.mass;
            self.damping[(at, at)] = pedestal.damping;
            self.stiffness[(at, at)] = pedestal.stiffness;
            self.cross_stiffness[(at, at)] = pedestal.cross_stiffness;
        }
        let position = |i: usize| {
            let bearing = drawing.bearings.iter().find(|bearing| bearing.pedestal == Some(i));
            bearing.map_or(0.0, |bearing| self.nodes[self.station_nodes[bearing.station]].position)
        };
        self.pedestals = (0..count).map(|i| Place::pedestal(position(i), i)).collect();
        for (spring, of) in self.springs.iter_mut().zip(&drawing.bearings) {
            spring.pedestal = of.pedestal.map(|i| first + i);
        }
        self
    }

    /// The coordinate of the first pedestal, which is the number of those of the shaft.
    pub(crate) fn first_pedestal(&self) -> usize {
        self.mass.nrows() - self.pedestals.len()
    }

    /// A motion of the shaft with that of the pedestals whose bearings carry it along.
    pub(crate) fn carried(&self, shaft: &DVector<f64>) -> DVector<f64> {
        let mut motion = shaft.clone();
        let acts = |of: &Coefficient| of.values().any(|value| value != 0.0);
        for spring in self.springs.iter().filter(|spring| acts(&spring.stiffness) || acts(&spring.cross_stiffness)) {
            if let Some(pedestal) = spring.pedestal {
                motion[pedestal] = shaft[self.displacements[spring.node]];
            }
        }
        motion
    }
}

impl Spring {
    /// What it is stretched by, in the coordinates of the full model.
    #[must_use]
    pub fn stretch(&self, full: &FullModel) -> DVector<f64> {
        let mut row = DVector::zeros(full.mass.nrows());
        row[full.displacements[self.node]] = 1.0;
        if let Some(pedestal) = self.pedestal {
            row[pedestal] = -1.0;
        }
        row
    }
}

/// What pedestals move by themselves, a column each of length 1 over `M`.
pub(crate) fn alone(full: &FullModel) -> impl Iterator<Item = DVector<f64>> + '_ {
    let unit = |at: usize, mass: &DMatrix<f64>| {
        let mut shape = DVector::zeros(mass.nrows());
        shape[at] = 1.0 / mass[(at, at)].sqrt();
        shape
    };
    (full.first_pedestal()..full.mass.nrows()).map(move |at| unit(at, &full.mass))
}
