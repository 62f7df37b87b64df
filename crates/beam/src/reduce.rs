//! Fewer coordinates, each the displacement of a place.
//!
//! The motion is taken as a sum of `n` shapes: the slowest modes of the free rotor at rest, and for the places that are held the
//! hardest the static shape `(K + scale^2 M)^-1 e` under a force there, without which stiff bearings are missed by per cents (residual
//! flexibility; Craig 1981, ch. 19). Then `n` places are chosen whose displacements tell those shapes apart best, and the
//! displacements themselves become the coordinates `q` (O'Callahan's SEREP, 1989):
//!
//! ```text
//! p = Phi a,  q = Phi_s a,  p = T q,  T = Phi Phi_s^-1,  Mr = T^T M T, ...
//! ```
//!
//! Matrices are computed among the shapes, which are orthonormal over `M`, and only then brought to displacements.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::model::{FullModel, Place, Spring};
use crate::modes::{scale, undamped};
use crate::pedestal::alone;
use crate::poles::{PoleError, eigenvalues};
use crate::select::{candidates, choose};
use crate::{C64, Coefficient, Drawing, MAX_COORDINATES};

/// Why a rotor could not be reduced.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReductionError {
    /// A number of coordinates that cannot be.
    #[error("{0} coordinates: expected 1 to {MAX_COORDINATES}")]
    Coordinates(usize),
    /// A mass matrix that is not positive definite, or not finite.
    #[error("the mass matrix of the rotor is not positive definite: no part of it may be without mass")]
    Mass,
    /// No places whose displacements tell the shapes apart.
    #[error("no {0} places of the rotor have displacements that tell its shapes apart")]
    Places(usize),
}

/// A rotor in `n` coordinates, the displacements of `n` places. The equations are those of [`FullModel`].
#[derive(Clone, Debug)]
pub struct Reduced {
    /// `M`.
    pub mass: DMatrix<f64>,
    /// `C`.
    pub damping: DMatrix<f64>,
    /// `G`.
    pub gyroscopic: DMatrix<f64>,
    /// `K`.
    pub stiffness: DMatrix<f64>,
    /// `Kc`.
    pub cross_stiffness: DMatrix<f64>,
    /// `Cr`.
    pub internal: DMatrix<f64>,
    /// The places whose displacements are the coordinates, from left to right: stations where they will do, other places of the shaft
    /// where those are too few.
    pub stations: Vec<Place>,
    /// All coordinates of the full model, of a shaft `p` and `psi` of its nodes, from these: as many rows as it has, `n` columns.
    pub shape: DMatrix<f64>,
    /// Which of those rows is the displacement of each node of the full model.
    pub displacements: Vec<usize>,
    /// The condition number of the displacements of the places: how many digits choosing them has cost.
    pub condition: f64,
}

impl FullModel {
    /// Reduces the rotor to so many coordinates, or as many as it has if those are fewer. Places that `drawing` has sensors at are
    /// preferred, then those with play, magnetic bearings, bearings and seals, discs, stations and any others.
    ///
    /// # Errors
    /// No coordinates or more than [`MAX_COORDINATES`]; a mass matrix that is not positive definite.
    pub fn reduce(&self, drawing: &Drawing, coordinates: usize) -> Result<Reduced, ReductionError> {
        if !(1..=MAX_COORDINATES).contains(&coordinates) {
            return Err(ReductionError::Coordinates(coordinates));
        }
        let places = self.nodes.len() + self.inside.len() + self.pedestals.len();
        let basis = self.shapes(coordinates.min(self.mass.nrows()).min(places))?;
        let (places, rows): (Vec<_>, Vec<_>) = candidates(self, drawing, &basis).into_iter().unzip();
        let chosen = choose(&places, &rows, basis.ncols()).ok_or(ReductionError::Places(basis.ncols()))?;

        let among = |matrix: &DMatrix<f64>| basis.tr_mul(&(matrix * &basis));
        let place = |matrix: &DMatrix<f64>| chosen.inverse.tr_mul(&(among(matrix) * &chosen.inverse));
        let even = |matrix: &DMatrix<f64>| {
            let placed = place(matrix);
            (&placed + placed.transpose()) * 0.5
        };
        Ok(Reduced {
            mass: even(&self.mass),
            damping: place(&self.damping),
            gyroscopic: even(&self.gyroscopic),
            stiffness: even(&self.stiffness),
            cross_stiffness: place(&self.cross_stiffness),
            internal: even(&self.internal),
            stations: chosen.places.iter().map(|&at| places[at].place.clone()).collect(),
            shape: &basis * &chosen.inverse,
            displacements: self.displacements.clone(),
            condition: chosen.condition,
        })
    }

    /// The same rotor with other numbers among the shapes of `reduced`, which has as many coordinates in full: how its motion depends on
    /// those numbers, without the shapes' own dependence on them.
    #[must_use]
    pub fn among(&self, reduced: &Reduced) -> Reduced {
        let shape = &reduced.shape;
        let place = |matrix: &DMatrix<f64>| shape.tr_mul(&(matrix * shape));
        Reduced {
            mass: place(&self.mass),
            damping: place(&self.damping),
            gyroscopic: place(&self.gyroscopic),
            stiffness: place(&self.stiffness),
            cross_stiffness: place(&self.cross_stiffness),
            internal: place(&self.internal),
            ..reduced.clone()
        }
    }

    /// `count` shapes, orthonormal over `M`.
    fn shapes(&self, count: usize) -> Result<DMatrix<f64>, ReductionError> {
        let scale = scale(&self.mass, &self.stiffness);
        let modes = undamped(&self.mass, &self.stiffness, scale).ok_or(ReductionError::Mass)?;
        // Each pedestal is a shape of its own, whatever its frequency: it moves with the shaft by its bearings alone.
        let pedestals = self.pedestals.len().min(count);
        let held = self.held(scale, (count / 4 + 1).min(count.saturating_sub(2 + pedestals)));
        let alone: Vec<DVector<f64>> = alone(self).collect();
        let shifted = (&self.stiffness + &self.mass * (scale * scale)).cholesky().ok_or(ReductionError::Mass)?;
        let statics = held.iter().map(|node| {
            let mut force = DVector::zeros(self.mass.nrows());
            force[self.displacements[*node]] = 1.0;
            shifted.solve(&force)
        });
        let is_of_shaft = |shape: &DVector<f64>| pedestals == 0 || self.orthonormal(shape.clone(), &alone).is_some();
        let modes: Vec<DVector<f64>> =
            modes.column_iter().map(|shape| shape.into_owned()).filter(is_of_shaft).collect();
        let slow = count - pedestals - held.len();
        let first = modes.iter().take(slow).cloned();
        // Where a static shape is a sum of the modes already, as of a rotor with no more shapes, the next modes take its place.
        let rest = modes.iter().skip(slow).cloned();
        let mut kept: Vec<DVector<f64>> = alone.iter().take(pedestals).cloned().collect();
        for shape in first.chain(statics).chain(rest) {
            if kept.len() < count
                && let Some(shape) = self.orthonormal(shape, &kept)
            {
                kept.push(shape);
            }
        }
        if kept.len() < count { Err(ReductionError::Places(count)) } else { Ok(DMatrix::from_columns(&kept)) }
    }

    /// The `most` nodes that are held the hardest at frequencies of about `scale` in rad/s.
    fn held(&self, scale: f64, most: usize) -> Vec<usize> {
        let mut nodes: Vec<(usize, f64)> = Vec::new();
        for spring in &self.springs {
            let largest = |c: &Coefficient| c.values().map(f64::abs).fold(0.0, f64::max);
            let stiffness = largest(&spring.stiffness) + largest(&spring.cross_stiffness);
            let hold = stiffness + scale * (largest(&spring.damping) + largest(&spring.cross_damping));
            match nodes.iter_mut().find(|(node, _)| *node == spring.node) {
                Some((_, sum)) => *sum += hold,
                None => nodes.push((spring.node, hold)),
            }
        }
        nodes.sort_by(|a, b| b.1.total_cmp(&a.1));
        // What holds little is seen by the modes well enough, and each shape for it would cost a mode.
        let hardest = nodes.first().map_or(0.0, |&(_, hold)| hold);
        nodes.retain(|&(_, hold)| hold > 0.02 * hardest);
        nodes.into_iter().take(most).map(|(node, _)| node).collect()
    }

    /// `shape` less what it has in common with `others`, of length 1 over `M`; `None` if nothing is left.
    fn orthonormal(&self, mut shape: DVector<f64>, others: &[DVector<f64>]) -> Option<DVector<f64>> {
        let length = |shape: &DVector<f64>| shape.dot(&(&self.mass * shape)).sqrt();
        shape /= length(&shape);
        // Twice: once leaves rounding of what was taken away.
        for _ in 0..2 {
            for other in others {
                let part = other.dot(&(&self.mass * &shape));
                shape.axpy(-part, other, 1.0);
            }
        }
        let left = length(&shape);
        (left > 1e-9).then(|| shape / left)
    }
}

impl Reduced {
    /// How many coordinates there are.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.mass.nrows()
    }

    /// The displacement of a node of the full model as a row of the coordinates.
    #[must_use]
    pub fn displacement(&self, node: usize) -> RowDVector<f64> {
        self.shape.row(self.displacements[node]).into_owned()
    }

    /// What a spring of the full model is stretched by, as a row of the coordinates.
    #[must_use]
    pub fn stretch(&self, spring: &Spring) -> RowDVector<f64> {
        let row = self.displacement(spring.node);
        spring.pedestal.map_or_else(|| row.clone(), |pedestal| &row - self.shape.row(pedestal))
    }

    /// `(M, D, S)` of `M q'' + D q' + S q = 0` at a spin speed in rad/s, held by the `springs` of the full model as if there were no
    /// clearance, touchdown bearings out.
    #[must_use]
    pub fn at(&self, springs: &[Spring], speed: f64) -> (DMatrix<C64>, DMatrix<C64>, DMatrix<C64>) {
        let damping = &self.damping + &self.internal;
        let mut d = damping.zip_map(&self.gyroscopic, |c, g| C64::new(c, -speed * g));
        let cross = &self.cross_stiffness + &self.internal * speed;
        let mut s = self.stiffness.zip_map(&cross, |k, cross| C64::new(k, -cross));
        for spring in springs.iter().filter(|spring| !spring.is_touchdown()) {
            let row = self.stretch(spring).map(C64::from);
            let square = row.transpose() * row;
            d += &square * spring.damping_at(speed);
            s += square * spring.stiffness_at(speed);
        }
        (self.mass.map(C64::from), d, s)
    }

    /// The eigenvalues at a spin speed in rad/s, held by the `springs` of the full model, least in size first.
    ///
    /// # Errors
    /// Matrices that are not finite or are singular in a way that no shift mends.
    pub fn eigenvalues(&self, springs: &[Spring], speed: f64) -> Result<Vec<C64>, PoleError> {
        let (mass, damping, stiffness) = self.at(springs, speed);
        eigenvalues(&mass, &damping, &stiffness, scale(&self.mass, &self.stiffness))
    }
}
