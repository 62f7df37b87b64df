//! A plant of dense matrices, checked.

use nalgebra::{DMatrix, DVector};

use super::dense::Dense;
use super::{Contact, Direction, Form, MAX_ORDER, Plant, Station, Tabulated};
use crate::C64;

/// A plant of its coordinates' matrices, as they are given to [`Plant::of_matrices`].
#[derive(Clone, Debug, PartialEq)]
pub struct Matrices {
    /// Mass matrix `M`.
    pub mass: DMatrix<C64>,
    /// `D0` and `D1` of `M q'' = (D0 + R D1) q' + ...`.
    pub damping: [DMatrix<C64>; 2],
    /// `S0` and `S1` of `... + (S0 + R S1) q`.
    pub stiffness: [DMatrix<C64>; 2],
    /// The stations, in order.
    pub stations: Vec<Station>,
    /// Contacts: station, column of force and stiffness.
    pub contacts: Vec<Contact>,
    /// Mass times eccentricity per coordinate.
    pub unbalance: Vec<C64>,
    /// What the force of each control bearing does to the coordinates.
    pub columns: Vec<Direction>,
    /// What holds the rotor over speed.
    pub tabulated: Vec<Tabulated>,
}

/// Why matrices are no plant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// None, or more than fit.
    #[error("{0} coordinates: expected 1 to {MAX_ORDER}")]
    Order(usize),
    /// Something of another size than the mass matrix.
    #[error("{what} does not fit {order} coordinates")]
    Size {
        /// What.
        what: &'static str,
        /// How many coordinates there are.
        order: usize,
    },
    /// A number that is not finite.
    #[error("{0} has an entry that is not finite")]
    NotFinite(&'static str),
    /// A mass matrix that cannot be inverted.
    #[error("the mass matrix is singular: every coordinate needs a mass")]
    Massless,
}

impl Plant {
    /// A plant of dense matrices.
    ///
    /// # Errors
    /// Sizes that do not fit each other, numbers that are not finite, or a mass matrix that cannot be inverted.
    pub fn of_matrices(given: Matrices) -> Result<Self, PlantError> {
        let order = given.mass.nrows();
        if !(1..=MAX_ORDER).contains(&order) {
            return Err(PlantError::Order(order));
        }
        let [d0, d1] = &given.damping;
        let [s0, s1] = &given.stiffness;
        for (what, matrix) in
            [("mass", &given.mass), ("damping", d0), ("damping", d1), ("stiffness", s0), ("stiffness", s1)]
        {
            if matrix.shape() != (order, order) {
                return Err(PlantError::Size { what, order });
            }
            if !matrix.iter().all(|z| z.is_finite()) {
                return Err(PlantError::NotFinite(what));
            }
        }
        let fits = |direction: &Direction| match direction {
            Direction::Unit(i) => *i < order,
            Direction::Dense(weights) => weights.len() == order && weights.iter().all(|w| w.is_finite()),
        };
        let stations_fit = given.stations.iter().all(|station| fits(&station.row));
        let contact_fits = |c: &Contact| c.station < given.stations.len() && fits(&c.column) && c.stiffness.is_finite();
        for (what, is_fit) in [
            ("a station", stations_fit),
            ("a contact", given.contacts.iter().all(contact_fits)),
            ("an unbalance", given.unbalance.len() == order && given.unbalance.iter().all(|u| u.is_finite())),
            ("a control bearing", given.columns.iter().all(fits)),
            ("what holds it over speed", given.tabulated.iter().all(|of| fits(&of.row) && fits(&of.column))),
        ] {
            if !is_fit {
                return Err(PlantError::Size { what, order });
            }
        }
        let inverse =
            given.mass.try_inverse().filter(|m| m.iter().all(|z| z.is_finite())).ok_or(PlantError::Massless)?;
        let through =
            |direction: &Direction| Direction::Dense((&inverse * direction.dense(order)).iter().copied().collect());
        let contacts = given.contacts.iter().map(|c| Contact { column: through(&c.column), ..c.clone() }).collect();
        Ok(Self {
            order,
            form: Form::Dense(Dense::new(given.damping.map(|d| &inverse * d), given.stiffness.map(|s| &inverse * s))),
            is_unit: given.stations.len() == order
                && given.stations.iter().enumerate().all(|(k, station)| station.row == Direction::Unit(k)),
            tabulated: (given.tabulated.iter())
                .map(|of| Tabulated { column: through(&of.column), ..of.clone() })
                .collect(),
            stations: given.stations,
            contacts,
            moment: given.unbalance.clone(),
            unbalance: (&inverse * DVector::from_vec(given.unbalance)).iter().copied().collect(),
            columns: given.columns.iter().map(through).collect(),
            free: vec![],
        })
    }
}
