//! A rotor as matrices, with all the coordinates of its elements.

use nalgebra::{DMatrix, RowDVector, RowVector4};

use crate::drawing::Unbalance;
use crate::poles::{PoleError, eigenvalues};
use crate::{C64, Coefficient, Matrices};

/// A place along the rotor.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// What it is called: a station by its number, counted from 1, or by the name of its coordinate in
    /// matrices that have such names, any other by where it is, as in `0.125 m`, or `pedestal 1`.
    pub name: String,
    /// Distance from the left end in m.
    pub position: f64,
    /// Which station it is, counted from 0.
    pub station: Option<usize>,
    /// Which pedestal it is, counted from 0; its position is that of its first bearing.
    pub pedestal: Option<usize>,
}

impl Place {
    pub(crate) fn station(position: f64, station: usize) -> Self {
        Self { name: (station + 1).to_string(), position, station: Some(station), pedestal: None }
    }

    /// A station of matrices, by the name of its coordinate where that has one.
    pub(crate) fn of_coordinate(position: f64, station: usize, matrices: &Matrices) -> Self {
        let name = matrices.stations.get(station).and_then(|at| matrices.names.get(*at)).cloned();
        let plain = Self::station(position, station);
        Self { name: name.unwrap_or_else(|| plain.name.clone()), ..plain }
    }

    /// What it is called among words: a station that has no name by its number, as `station 3`.
    #[must_use]
    pub fn told(&self) -> String {
        match self.station {
            Some(station) if self.name == (station + 1).to_string() => format!("station {}", self.name),
            _ => self.name.clone(),
        }
    }

    pub(crate) fn inner(position: f64) -> Self {
        Self { name: format!("{} m", text::number::significant(position, 6)), position, station: None, pedestal: None }
    }

    pub(crate) fn pedestal(position: f64, pedestal: usize) -> Self {
        Self { name: format!("pedestal {}", pedestal + 1), position, station: None, pedestal: Some(pedestal) }
    }
}

/// Displacement inside an element, as a row in `p` and `psi` of the nodes `node` and `node + 1`.
#[derive(Clone, Debug)]
pub(crate) struct Inside {
    pub(crate) node: usize,
    pub(crate) position: f64,
    pub(crate) row: RowVector4<f64>,
}

/// Of what part of the drawing a spring is, counted from 0 among its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringPart {
    /// A bearing that carries the rotor.
    Bearing(usize),
    /// A seal.
    Seal(usize),
    /// The pull of a magnetic bearing's bias: its stiffness is negative.
    Magnetic(usize),
    /// The touchdown bearing of a magnetic one.
    Touchdown(usize),
}

/// What holds one node to the ground, or to a pedestal whose displacement `p` is less then: force on it `-(k - j kc) p - (d - j dc) p'`, the stiffness beyond the clearance only.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// What it is of.
    pub part: SpringPart,
    /// At which station, counted from 0.
    pub station: usize,
    /// At which node of the full model; [`FullModel::displacements`] says which coordinate its displacement is.
    pub node: usize,
    /// `k` in N/m.
    pub stiffness: Coefficient,
    /// `d` in N s/m.
    pub damping: Coefficient,
    /// `kc` in N/m.
    pub cross_stiffness: Coefficient,
    /// `dc` in N s/m.
    pub cross_damping: Coefficient,
    /// Radial play in m; 0 if there is none.
    pub clearance: f64,
    /// Which coordinate of the full model its other end is; `None` where that is the ground.
    pub pedestal: Option<usize>,
}

impl Spring {
    /// Whether it is a touchdown bearing, which a rotor in order does not meet.
    #[must_use]
    pub fn is_touchdown(&self) -> bool {
        matches!(self.part, SpringPart::Touchdown(_))
    }

    /// `k - j kc` at a spin speed in rad/s.
    #[must_use]
    pub fn stiffness_at(&self, speed: f64) -> C64 {
        C64::new(self.stiffness.at(speed), -self.cross_stiffness.at(speed))
    }

    /// `d - j dc` at a spin speed in rad/s.
    #[must_use]
    pub fn damping_at(&self, speed: f64) -> C64 {
        C64::new(self.damping.at(speed), -self.cross_damping.at(speed))
    }
}

/// The equations of motion, of a drawing with a shaft with two complex coordinates a node, `p` and `psi = beta - j alpha`, and behind
/// them the displacement of each pedestal:
///
/// ```text
/// M p'' + (C + Cr - j w G) p' + (K - j (Kc + w Cr)) p = springs + forces
/// ```
///
/// The matrices are real and none depends on speed. What holds the rotor to the ground is not in them but in
/// [`FullModel::springs`]; only masses of bearings that move with it are in `M`.
#[derive(Clone, Debug)]
pub struct FullModel {
    /// `M` in kg, kg m, kg m^2; symmetric, positive definite.
    pub mass: DMatrix<f64>,
    /// `C` in N s/m and so on: damping that does not turn with the rotor.
    pub damping: DMatrix<f64>,
    /// `G`, symmetric: the entry of a disc is its polar inertia.
    pub gyroscopic: DMatrix<f64>,
    /// `K` in N/m and so on; symmetric.
    pub stiffness: DMatrix<f64>,
    /// `Kc`: what a torque couples.
    pub cross_stiffness: DMatrix<f64>,
    /// `Cr`: damping that turns with the rotor.
    pub internal: DMatrix<f64>,
    /// What holds it to the ground.
    pub springs: Vec<Spring>,
    /// The ends of all elements, from left to right.
    pub nodes: Vec<Place>,
    /// Which coordinate the displacement of each node is: of a drawing with a shaft, every other one.
    pub displacements: Vec<usize>,
    /// Which node each station is.
    pub station_nodes: Vec<usize>,
    /// The pedestals, whose displacements are the last coordinates.
    pub pedestals: Vec<Place>,
    pub(crate) inside: Vec<Inside>,
    pub(crate) unbalances: Vec<Unbalance>,
    pub(crate) rotor_mass: f64,
}

impl FullModel {
    /// `(M, D, S)` of `M p'' + D p' + S p = 0` at a spin speed in rad/s, with all springs as if there were no clearance, and
    /// touchdown bearings out.
    #[must_use]
    pub fn at(&self, speed: f64) -> (DMatrix<C64>, DMatrix<C64>, DMatrix<C64>) {
        let damping = self.damping.zip_map(&self.internal, |c, internal| c + internal);
        let mut d = damping.zip_map(&self.gyroscopic, |c, g| C64::new(c, -speed * g));
        let cross = self.cross_stiffness.zip_map(&self.internal, |kc, internal| kc + speed * internal);
        let mut s = self.stiffness.zip_map(&cross, |k, cross| C64::new(k, -cross));
        for spring in self.springs.iter().filter(|spring| !spring.is_touchdown()) {
            let (damping, stiffness) = (spring.damping_at(speed), spring.stiffness_at(speed));
            let p = self.displacements[spring.node];
            let mut add = |row, column, sign: f64| {
                d[(row, column)] += damping * sign;
                s[(row, column)] += stiffness * sign;
            };
            add(p, p, 1.0);
            if let Some(other) = spring.pedestal {
                add(other, other, 1.0);
                add(p, other, -1.0);
                add(other, p, -1.0);
            }
        }
        (self.mass.map(C64::from), d, s)
    }

    /// The displacement of a place as a row of the coordinates; of one that is no place of this rotor, of its left end.
    #[must_use]
    pub fn row(&self, place: &Place) -> RowDVector<f64> {
        let mut row = RowDVector::zeros(self.mass.nrows());
        let at = |position: f64| (position - place.position).abs() <= 1e-12 * (1.0 + position.abs());
        if let Some(pedestal) = place.pedestal.filter(|pedestal| *pedestal < self.pedestals.len()) {
            row[self.first_pedestal() + pedestal] = 1.0;
        } else if let Some(node) = self.nodes.iter().position(|node| at(node.position)) {
            row[self.displacements[node]] = 1.0;
        } else if let Some(inside) = self.inside.iter().find(|inside| at(inside.position)) {
            row.fixed_columns_mut::<4>(2 * inside.node).copy_from(&inside.row);
        }
        row
    }

    /// The eigenvalues at a spin speed in rad/s, in 1/s and rad/s: two a coordinate, least in size first. With their conjugates
    /// they are those of the real equations; where the imaginary part is positive, whirl is forward.
    ///
    /// # Errors
    /// Matrices that are not finite or are singular in a way that no shift mends.
    pub fn eigenvalues(&self, speed: f64) -> Result<Vec<C64>, PoleError> {
        let (mass, damping, stiffness) = self.at(speed);
        eigenvalues(&mass, &damping, &stiffness, crate::modes::scale(&self.mass, &self.stiffness))
    }
}
