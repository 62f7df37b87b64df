//! The rotor without its control: equations of motion that know every speed, stored independently of it,
//!
//! ```text
//! q'' = (D0 + R D1) q' + (S0 + R S1) q + contacts + unbalance (R^2 - j R') exp(j theta) + columns u
//! ```
//!
//! with `q` complex coordinates, multiplied by the inverse of the mass matrix. What holds the rotor with coefficients that are tabulated
//! over speed acts along a row and a column. A contact pushes back along its column with
//! `stiffness s(|r|) r`, where `r` is the displacement that its row reads and `s` is (3.3): 0 within the clearance, then
//! `1 - g / |r|`. The chain of the report is one way to make it; dense matrices of up to 64 coordinates are the other.
//!
//! Not its business: who computes the force `u`, and how the speed comes about.

mod chain;
mod dense;
mod matrices;
mod parts;

use chain::Chain;
use dense::Dense;
use nalgebra::DMatrix;

use crate::{C64, Rotor};

pub use matrices::{Matrices, PlantError};
pub use parts::{Contact, Direction, OperatingPoint, Spin, Station, Tabulated};

/// The most coordinates of a plant.
pub const MAX_ORDER: usize = 512;

/// How the linear part is stored.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    Chain(Chain),
    Dense(Dense),
}

/// A rotor without control.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    order: usize,
    form: Form,
    stations: Vec<Station>,
    contacts: Vec<Contact>,
    unbalance: Vec<C64>,
    /// Mass times eccentricity per coordinate.
    moment: Vec<C64>,
    /// Per control bearing, or per station of a chain, any of which may carry it.
    columns: Vec<Direction>,
    tabulated: Vec<Tabulated>,
    is_unit: bool,
    free: Vec<Vec<C64>>,
}

impl Plant {
    /// That of a rotor. Of a chain of lumped masses coordinate, station and possible control bearing `i` are mass `i`; of shaft elements,
    /// the `i`-th of the places that are simulated.
    #[must_use]
    pub fn of(rotor: &Rotor) -> Self {
        rotor.beam().map_or_else(|| Self::of_chain(rotor), |beam| beam.plant().clone())
    }

    /// The same with displacements, of every coordinate, that are known to meet no restoring force: the two ways in which a rotor that
    /// nothing holds moves as a whole. Arithmetic leaves rounding where their force should be, and this says that it is none.
    #[must_use]
    pub(crate) fn free_in(self, shapes: Vec<Vec<C64>>) -> Self {
        Self { free: shapes, ..self }
    }

    /// Displacements that meet no restoring force at any speed: see [`LinearForm::free`](crate::LinearForm::free). None of a rotor that is held.
    #[must_use]
    pub fn free(&self) -> &[Vec<C64>] {
        &self.free
    }

    /// How many coordinates it has.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Where displacement is read.
    #[must_use]
    pub fn stations(&self) -> &[Station] {
        &self.stations
    }

    /// Its support bearings with clearance; clearances are settings.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Whether coordinate `i` is the displacement of station `i`, as in a chain.
    #[must_use]
    pub fn stations_are_coordinates(&self) -> bool {
        self.is_unit
    }

    /// What the force of a control bearing does to the coordinates; `None` if there is no such bearing.
    #[must_use]
    pub fn column(&self, bearing: usize) -> Option<&Direction> {
        self.columns.get(bearing)
    }

    /// What unbalance adds to the accelerations, per `R^2 - j R'` and direction of spin.
    #[must_use]
    pub fn unbalance(&self) -> &[C64] {
        &self.unbalance
    }

    /// The same with mass times eccentricity added at its stations, each of which is where the control bearing of the same number would be.
    pub(crate) fn with_unbalance(mut self, added: &[f64]) -> Self {
        for ((station, column), moment) in self.stations.iter().zip(&self.columns).zip(added) {
            column.add(C64::from(*moment), &mut self.unbalance);
            station.row.add(C64::from(*moment), &mut self.moment);
        }
        self
    }

    /// The torque that the unbalance, in the direction of spin, takes from the spin while the coordinates accelerate by `a` (without
    /// the unbalance's own `R^2 - j R'`): `sum_k Im(conj(m_k e_k exp(j theta)) a_k)`, in `K_t e_t^2`.
    #[must_use]
    pub fn torque(&self, direction: C64, a: &[C64]) -> f64 {
        self.moment.iter().zip(a).map(|(moment, a)| ((moment * direction).conj() * a).im).sum()
    }

    /// The accelerations of all coordinates without control, into `out`; `clearances` has one number a contact.
    pub fn acceleration(&self, spin: &Spin, clearances: &[f64], q: &[C64], v: &[C64], out: &mut [C64]) {
        match &self.form {
            Form::Chain(chain) => chain.acceleration(spin.speed, q, v, out),
            Form::Dense(dense) => dense.acceleration(spin.speed, q, v, out),
        }
        for (contact, clearance) in self.contacts.iter().zip(clearances) {
            if contact.stiffness == 0.0 {
                continue;
            }
            let r = self.stations[contact.station].row.read(q);
            let factor = if *clearance > 0.0 {
                let radius_squared = r.norm_sqr();
                if radius_squared > clearance * clearance { 1.0 - clearance / radius_squared.sqrt() } else { 0.0 }
            } else {
                1.0
            };
            if factor > 0.0 {
                contact.column.add(r * (-contact.stiffness * factor), out);
            }
        }
        for held in &self.tabulated {
            let [stiffness, damping] = held.at(spin.speed);
            held.column.add(-(stiffness * held.row.read(q) + damping * held.row.read(v)), out);
        }
        let drive = spin.direction * C64::new(spin.speed * spin.speed, -spin.acceleration);
        out.iter_mut().zip(&self.unbalance).for_each(|(out, u)| *out += u * drive);
    }

    /// `D` and `S` of `q'' = D q' + S q` at an operating point, control off.
    #[must_use]
    pub fn linear(&self, at: &OperatingPoint) -> [DMatrix<C64>; 2] {
        let speed = C64::from(at.speed);
        let [mut damping, mut stiffness] = match &self.form {
            Form::Chain(chain) => chain.matrices(at.speed),
            Form::Dense(Dense { damping: [d0, d1], stiffness: [s0, s1], .. }) => [d0 + d1 * speed, s0 + s1 * speed],
        };
        for (i, contact) in self.contacts.iter().enumerate() {
            let all = if contact.is_touchdown { 0.0 } else { 1.0 };
            let factor = at.contact_factors.get(i).copied().unwrap_or(all) * contact.stiffness;
            if factor == 0.0 {
                continue;
            }
            let (column, row) =
                (contact.column.dense(self.order), self.stations[contact.station].row.dense(self.order));
            stiffness -= column * row.transpose() * C64::from(factor);
        }
        for held in &self.tabulated {
            let [k, d] = held.at(at.speed);
            let square = held.column.dense(self.order) * held.row.dense(self.order).transpose();
            stiffness -= &square * k;
            damping -= square * d;
        }
        [damping, stiffness]
    }

    /// Speeds at which the coefficients of something that holds the rotor have a corner, rising.
    #[must_use]
    pub fn corner_speeds(&self) -> Vec<f64> {
        let mut speeds: Vec<f64> = self.tabulated.iter().flat_map(|of| of.table.iter().map(|(s, _)| *s)).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        speeds
    }
}

#[cfg(test)]
mod tests;
