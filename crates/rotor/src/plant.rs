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

use chain::Chain;
use dense::Dense;
use nalgebra::{DMatrix, DVector};

use crate::{C64, Rotor};

/// The most coordinates of a plant.
pub const MAX_ORDER: usize = 512;

/// Where a plant is looked at by linear analysis.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct OperatingPoint {
    /// Spin speed `R`.
    pub speed: f64,
    /// The share of its stiffness that each contact has, 0 to 1; those that are missing have all of it, but touchdown bearings none.
    pub contact_factors: Vec<f64>,
}

impl OperatingPoint {
    /// Every contact at its full stiffness.
    #[must_use]
    pub fn at(speed: f64) -> Self {
        Self { speed, contact_factors: vec![] }
    }
}

/// How the spin drives a plant in one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Spin speed `R`.
    pub speed: f64,
    /// Its rate of change `R'`.
    pub acceleration: f64,
    /// `exp(j theta)`, with `theta` the angle of spin.
    pub direction: C64,
}

/// A row or a column over the coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// One coordinate, with weight 1.
    Unit(usize),
    /// A weight for every coordinate.
    Dense(Vec<C64>),
}

impl Direction {
    /// What it reads of coordinates.
    #[inline]
    #[must_use]
    pub fn read(&self, q: &[C64]) -> C64 {
        match self {
            Self::Unit(i) => q[*i],
            Self::Dense(weights) => weights.iter().zip(q).map(|(w, q)| w * q).sum(),
        }
    }

    /// Adds `amount` along it.
    #[inline]
    pub fn add(&self, amount: C64, to: &mut [C64]) {
        match self {
            Self::Unit(i) => to[*i] += amount,
            Self::Dense(weights) => to.iter_mut().zip(weights).for_each(|(to, w)| *to += w * amount),
        }
    }

    /// Itself in full.
    #[must_use]
    pub fn dense(&self, order: usize) -> DVector<C64> {
        let mut whole = DVector::zeros(order);
        match self {
            Self::Unit(i) => whole[*i] = C64::ONE,
            Self::Dense(weights) => whole.iter_mut().zip(weights).for_each(|(to, w)| *to = *w),
        }
        whole
    }
}

/// A named place at which displacement is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its name: `mass 1`, `left bearing`.
    pub name: String,
    /// What reads its displacement.
    pub row: Direction,
}

/// A support bearing with a clearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The station whose displacement presses on it, counted from 0.
    pub station: usize,
    /// What it does to the coordinates, per unit of force; of the plant's inverse mass matrix too.
    pub column: Direction,
    /// Its stiffness.
    pub stiffness: f64,
    /// Whether it is there for the worst alone, and out of what linear analysis looks at.
    pub is_touchdown: bool,
}

/// What holds the rotor with coefficients that change with speed: `-(k r + d r')` along its column, where `r` is what its row reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// What reads the displacement.
    pub row: Direction,
    /// What its force does to the coordinates; of the plant's inverse mass matrix too.
    pub column: Direction,
    /// Rising speeds with `[k, d]` at each: between them linear, beyond them the same. At least one.
    pub table: Vec<(f64, [C64; 2])>,
}

impl Tabulated {
    /// `[k, d]` at a speed.
    #[must_use]
    pub fn at(&self, speed: f64) -> [C64; 2] {
        let after = self.table.partition_point(|(s, _)| *s <= speed);
        match (after.checked_sub(1).map(|k| self.table[k]), self.table.get(after).copied()) {
            (Some((s0, a)), Some((s1, b))) => {
                let part = (speed - s0) / (s1 - s0);
                [0, 1].map(|k| a[k] + (b[k] - a[k]) * part)
            }
            (Some((_, values)), None) | (None, Some((_, values))) => values,
            (None, None) => [C64::ZERO; 2],
        }
    }
}

/// How the linear part is stored.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    Chain(Chain),
    Dense(Dense),
}

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

    fn of_chain(rotor: &Rotor) -> Self {
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
