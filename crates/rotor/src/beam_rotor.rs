//! Rotors of shaft elements and discs, as crate [`beam`] draws them: scaled, reduced, and made a plant of.
//!
//! ```text
//! tau = w0 t,  R = w / w0,  w0 = sqrt(K_t / M_t),  K_t = sum of the stiffness of what holds it,  M_t its mass,  e_t = sum of |U| / M_t
//!     K_t = M_t w0^2 with w0 the first bending frequency, where nothing holds it
//! (M / M_t) q'' = -(C + Cr) / (M_t w0) q' + j R (G / M_t) q' - (K - j Kc) / K_t q + j R Cr / (M_t w0) q + forces / (K_t e_t)
//! ```
//!
//! Its coordinates are the displacements of so many places of the shaft (at most [`crate::MAX_MASSES`]), which stand where a chain has its
//! masses: they are published, recorded and read by sensors. All other places follow from them.

mod matrices;

use beam::{Drawing, FullModel, Place, Reduced};
use control::{ControlBearing, Feedback, Filter, Signal};
use nalgebra::DMatrix;
use units::Scales;

use self::matrices::{Holds, Places, complex, matrices, plant_of, row_of, unbalance_of};
use crate::parameters::is_setting;
use crate::plant::{Direction, Plant, Station};
use crate::{BeamError, RotorError};
use crate::{C64, MAX_BEARINGS, MAX_MASSES};

/// Where nothing says how long one dimensionless unit of length is: a micrometre.
const MICROMETRE: f64 = 1e-6;
/// What places cost in digits may not be more than this: the condition of their displacements.
const WORST_CONDITION: f64 = 1e7;

/// A rotor of shaft elements, reduced.
#[derive(Clone, Debug)]
pub struct BeamRotor {
    drawing: Drawing,
    scales: Scales,
    full: FullModel,
    reduced: Reduced,
    plant: Plant,
    clearances: Vec<f64>,
}

impl PartialEq for BeamRotor {
    /// The drawing decides all the rest.
    fn eq(&self, other: &Self) -> bool {
        self.drawing == other.drawing
    }
}

impl BeamRotor {
    /// Reduces a drawing and makes a plant of it.
    pub(crate) fn new(drawing: Drawing) -> Result<Self, RotorError> {
        if drawing.magnetics.len() > MAX_BEARINGS {
            return Err(BeamError::Magnetics(drawing.magnetics.len()).into());
        }
        if let Some(magnetic) = drawing.magnetics.iter().find(|magnetic| is_setting(&magnetic.name)) {
            return Err(BeamError::Setting(magnetic.name.clone()).into());
        }
        let full = drawing.full();
        let scales = scales_of(&drawing, &full)?;
        let reduced = full.reduce(&drawing, drawing.coordinates.unwrap_or(MAX_MASSES))?;
        if reduced.condition > WORST_CONDITION {
            return Err(BeamError::Crowded { condition: reduced.condition }.into());
        }
        let (plant, clearances) = plant_of(&full, &reduced, &scales)?;
        let made = Self { drawing, scales, full, reduced, plant, clearances };
        for magnetic in &made.drawing.magnetics {
            for station in [magnetic.station, magnetic.sensor] {
                made.coordinate(station).ok_or(BeamError::NotSimulated { station: station + 1 })?;
            }
        }
        Ok(made)
    }

    /// It with other numbers in the drawing: in the same scales, the same shapes and the same places, so that settings keep their
    /// meaning and everything is a smooth function of those numbers.
    pub(crate) fn redrawn(&self, drawing: Drawing) -> Result<Self, RotorError> {
        let full = drawing.full();
        let size = |of: &FullModel| (of.mass.nrows(), of.springs.len());
        if size(&full) != size(&self.full) {
            return Err(BeamError::OtherShape.into());
        }
        let reduced = full.among(&self.reduced);
        let (plant, clearances) = plant_of(&full, &reduced, &self.scales)?;
        let is_in_full = self.plant.order() != self.reduced.coordinates();
        let made = Self { drawing, full, reduced, plant, clearances, scales: self.scales };
        if is_in_full { made.in_full() } else { Ok(made) }
    }

    /// What it was made of.
    #[must_use]
    pub fn drawing(&self) -> &Drawing {
        &self.drawing
    }

    /// It with all the coordinates of its elements, in SI units.
    #[must_use]
    pub fn full(&self) -> &FullModel {
        &self.full
    }

    /// It in the coordinates that are stepped, in SI units.
    #[must_use]
    pub fn reduced(&self) -> &Reduced {
        &self.reduced
    }

    /// The places whose displacements are its coordinates, from left to right.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.reduced.stations
    }

    /// Which coordinate a station of the drawing, counted from 0, is.
    #[must_use]
    pub fn coordinate(&self, station: usize) -> Option<usize> {
        self.places().iter().position(|place| place.station == Some(station))
    }

    /// The coordinates whose clearance is that of a touchdown bearing: it is not to be bridged while the machine runs.
    pub fn touchdown(&self) -> impl Iterator<Item = usize> + '_ {
        self.plant.contacts().iter().filter(|contact| contact.is_touchdown).map(|contact| contact.station)
    }

    /// What one dimensionless unit is.
    #[must_use]
    pub fn scales(&self) -> &Scales {
        &self.scales
    }

    /// Play of what holds each place, in `e_t`.
    pub(crate) fn clearances(&self) -> &[f64] {
        &self.clearances
    }

    /// The mass matrix of its coordinates, in `M_t`.
    pub(crate) fn mass(&self) -> DMatrix<C64> {
        self.reduced.mass.map(|m| C64::from(m / self.scales.m_t))
    }

    pub(crate) fn plant(&self) -> &Plant {
        &self.plant
    }

    /// What a coordinate is called: by a magnetic bearing or sensor there, else by its place.
    #[must_use]
    pub fn place_name(&self, coordinate: usize) -> String {
        let Some(place) = self.places().get(coordinate) else { return String::new() };
        let Some(station) = place.station else { return place.told() };
        let magnetic = self.drawing.magnetics.iter().find(|m| m.station == station || m.sensor == station);
        let sensor = self.drawing.sensors.iter().find(|sensor| sensor.station == station);
        match (magnetic.map(|m| &m.name), sensor.map(|s| &s.name)) {
            (Some(name), _) | (None, Some(name)) => name.clone(),
            (None, None) => place.told(),
        }
    }

    /// The same with unbalance added at its places, `U / (m_t e_t)` each.
    pub(crate) fn with_unbalance(&self, added: &[f64]) -> Self {
        Self { plant: self.plant.clone().with_unbalance(added), ..self.clone() }
    }

    /// The same with a plant of all the coordinates of the elements.
    pub(crate) fn in_full(&self) -> Result<Self, RotorError> {
        Ok(Self { plant: self.full_plant()?, ..self.clone() })
    }

    /// The plant with all the coordinates of the elements, its stations those of the reduced one: what is lost by reduction is not
    /// lost in it.
    ///
    /// # Errors
    /// A rotor that is no plant.
    pub fn full_plant(&self) -> Result<Plant, RotorError> {
        let order = self.full.mass.nrows();
        let rows: Vec<Direction> = self.places().iter().map(|place| row_of(&self.full, place)).collect();
        let columns = rows.clone();
        let holds = Holds::of(&self.full, |spring| {
            let station = self.coordinate(spring.station);
            let row = match spring.pedestal {
                None => Direction::Unit(self.full.displacements[spring.node]),
                Some(_) => Direction::Dense(complex(&spring.stretch(&self.full))),
            };
            (row, station)
        })?;
        let stations = self.stations(rows);
        matrices(
            [&self.full.mass, &self.full.damping, &self.full.gyroscopic],
            [&self.full.stiffness, &self.full.cross_stiffness, &self.full.internal],
            &self.scales,
            holds,
            Places {
                stations,
                columns,
                unbalance: self.unbalance(order, |node| Direction::Unit(self.full.displacements[node])),
            },
        )
        .map(|(plant, _)| plant.free_in(self.full.free_motions().iter().map(complex).collect()))
    }

    fn stations(&self, rows: Vec<Direction>) -> Vec<Station> {
        let named = rows.into_iter().enumerate();
        named.map(|(k, row)| Station { name: self.place_name(k), row }).collect()
    }

    fn unbalance(&self, order: usize, at: impl Fn(usize) -> Direction) -> Vec<C64> {
        unbalance_of(&self.full, &self.scales, order, at)
    }

    /// The law that its drawing has for its magnetic bearings; `None` where one of them has none.
    #[must_use]
    pub fn own_feedback(&self) -> Option<Feedback> {
        let bearings: Option<Vec<ControlBearing>> = (0..self.drawing.magnetics.len())
            .map(|k| {
                let bearing = self.bearing(k)?;
                let controller = self.drawing.magnetics[k].controller.as_ref()?;
                let (gain, filter) = self.law(controller, self.drawing.magnetics[k].force_per_current)?;
                let mut signal = Signal::at_mass(self.sensor(k)?, self.places().len(), [gain, 0.0, 0.0, 0.0]);
                signal.filters.extend(filter);
                Some(ControlBearing { signals: vec![signal], ..bearing })
            })
            .collect();
        bearings.filter(|bearings| !bearings.is_empty()).map(|bearings| Feedback { bearings })
    }

    /// Its magnetic bearings with a signal of their own sensors each, every gain 0; without any, a control bearing at its first place.
    #[must_use]
    pub fn no_feedback(&self) -> Feedback {
        let off = |k| {
            Some(ControlBearing {
                signals: vec![Signal::at_mass(self.sensor(k)?, self.places().len(), [0.0; 4])],
                ..self.bearing(k)?
            })
        };
        let bearings: Vec<ControlBearing> = (0..self.drawing.magnetics.len()).filter_map(off).collect();
        if bearings.is_empty() {
            return Feedback::new(0, vec![Signal::at_mass(0, self.places().len(), [0.0; 4])]);
        }
        Feedback { bearings }
    }

    fn bearing(&self, k: usize) -> Option<ControlBearing> {
        let magnetic = &self.drawing.magnetics[k];
        let station = self.coordinate(magnetic.station)?;
        Some(ControlBearing { name: Some(magnetic.name.clone()), ..ControlBearing::new(station, vec![]) })
    }

    fn sensor(&self, k: usize) -> Option<usize> {
        self.coordinate(self.drawing.magnetics[k].sensor)
    }

    /// A controller as a gain and a filter: `ki C(s)` over `K_t`, with `s` in units of `w0`. The gain is the leading coefficient where
    /// `C` is as large at high frequencies, and `C(0)` where it fades.
    fn law(&self, controller: &beam::ImportedController, force_per_current: f64) -> Option<(f64, Option<Filter>)> {
        let scaled = |coefficients: &[f64]| -> Vec<f64> {
            let order = coefficients.len().saturating_sub(1);
            let powers = coefficients.iter().enumerate();
            powers.map(|(k, c)| c * self.scales.w0.powi((order - k) as i32)).collect()
        };
        let (numerator, denominator) = (scaled(&controller.numerator), scaled(&controller.denominator));
        let leading = *denominator.first()?;
        let largest = numerator.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        let (size, per) = match (numerator.last()?, denominator.last()?) {
            (n, d) if *n != 0.0 && *d != 0.0 => (*n / *d, *n / *d * leading),
            _ => (largest / leading, largest),
        };
        let gain = force_per_current * size / self.scales.k_t;
        if numerator.len() == 1 && denominator.len() == 1 {
            return Some((force_per_current * numerator[0] / leading / self.scales.k_t, None));
        }
        let filter = Filter::Transfer {
            numerator: numerator.iter().map(|c| c / per).collect(),
            denominator: denominator.iter().map(|c| c / leading).collect(),
        };
        (gain.is_finite() && filter.check().is_ok()).then_some((gain, Some(filter)))
    }
}

/// The scales of a drawing.
fn scales_of(drawing: &Drawing, full: &FullModel) -> Result<Scales, RotorError> {
    let positive = |what, found: f64, expected| match found.is_finite() && found > 0.0 {
        true => Ok(found),
        false => Err(RotorError::Scale { what, found, expected }),
    };
    let m_t = positive("the sum of mass", drawing.mass(), "a finite number of kg greater than 0")?;
    let held = full.springs.iter().filter(|spring| !spring.is_touchdown());
    let held = held.map(|spring| spring.stiffness.at(0.0).abs()).sum::<f64>();
    let k_t = positive(
        "the sum of the stiffness of bearings, seals and magnetic bearings",
        if held == 0.0 { m_t * full.bending_frequency().powi(2) } else { held },
        "a finite number of N/m greater than 0, because w0 = sqrt(K_t / M_t)",
    )?;
    let w0 = positive("w0 = sqrt(K_t / M_t)", (k_t / m_t).sqrt(), "a finite number of rad/s greater than 0")?;
    let unbalance: f64 = full.unbalance(w0).iter().map(|u| u.norm()).sum();
    let e_t = match drawing.reference_length {
        Some(length) => length,
        None if unbalance > 0.0 => unbalance / m_t,
        None => MICROMETRE,
    };
    Ok(Scales { w0, k_t, m_t, e_t })
}
