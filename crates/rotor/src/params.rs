//! What a rotor is made of, and which values are allowed. Not its motion: see [`crate::ClosedLoop`].

use std::sync::Arc;

use beam::Drawing;
use text::Domain;

use crate::parameters::NO_SETTING;
use crate::{BeamRotor, C64, MAX_BEARINGS, MAX_MASSES, MAX_NAME, Physical, PlantError};

/// One lumped mass with what acts on it, in the dimensionless ratios of Tables 3.1 and 4.1.
#[derive(Clone, Copy, Debug, PartialEq, Default, serde::Serialize)]
pub struct Mass {
    /// Mass ratio `Rm = m / M_t`, greater than 0.
    pub mass: f64,
    /// Seal damping ratio `zeta = C / (2 m w0)`, at least 0. It brings the cross-coupled stiffness `zeta R` with it.
    pub damping: f64,
    /// Seal cross-coupled damping ratio `zeta_q = Cq / (2 m w0)`, at least 0.
    pub cross_damping: f64,
    /// Stiffness ratio of the support bearing, the part with deadband, `Rb = K / K_t`, at least 0.
    pub bearing_stiffness: f64,
    /// Linear stiffness ratio of the seal, `Rs = Ks / K_t`, at least 0.
    pub seal_stiffness: f64,
    /// Unbalance radius ratio `Re = e / e_t`, any finite sign: all unbalances lie in one plane.
    pub unbalance: f64,
    /// Radial clearance of the support bearing, `g / e_t`, at least 0.
    pub deadband: f64,
}

/// One parameter of a mass: a row of [`FIELDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Its name in files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// The symbol of the dimensionless ratio, as in Table 4.1.
    pub ratio: &'static str,
    /// The symbol of the physical quantity.
    pub symbol: &'static str,
    /// The SI unit of the physical quantity.
    pub unit: &'static str,
    /// What it may be, in either system.
    pub domain: Domain,
}

const fn field(
    name: &'static str,
    meaning: &'static str,
    [ratio, symbol, unit]: [&'static str; 3],
    domain: Domain,
) -> Field {
    Field { name, meaning, ratio, symbol, unit, domain }
}

/// The parameters of a mass, in the order of [`Mass::values`]: one table for files, checks and printing.
pub const FIELDS: [Field; 7] = [
    field("mass", "lumped mass", ["Rm", "m", "kg"], Domain::Positive),
    field("damping", "seal damping", ["zeta", "C", "N s/m"], Domain::NotNegative),
    field("cross_damping", "seal cross-coupled damping", ["zeta_q", "Cq", "N s/m"], Domain::NotNegative),
    field("bearing_stiffness", "support bearing, the part with deadband", ["Rb", "K", "N/m"], Domain::NotNegative),
    field("seal_stiffness", "seal, linear", ["Rs", "Ks", "N/m"], Domain::NotNegative),
    field("unbalance", "unbalance radius", ["Re", "e", "m"], Domain::Finite),
    field("deadband", "clearance of the support bearing", ["g / e_t", "g", "m"], Domain::NotNegative),
];

/// Gives a kind of mass its parameters as one list, in the order of [`FIELDS`].
macro_rules! parameters_in_order {
    ($mass:ty) => {
        impl $mass {
            /// Its parameters, in the order of [`FIELDS`](crate::FIELDS).
            #[must_use]
            pub fn values(&self) -> [f64; 7] {
                [
                    self.mass,
                    self.damping,
                    self.cross_damping,
                    self.bearing_stiffness,
                    self.seal_stiffness,
                    self.unbalance,
                    self.deadband,
                ]
            }

            /// A mass of parameters in the order of [`FIELDS`](crate::FIELDS).
            #[must_use]
            pub fn from_values(values: [f64; 7]) -> Self {
                let [mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband] = values;
                Self { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
            }
        }
    };
}

pub(crate) use parameters_in_order;

parameters_in_order!(Mass);

/// A rotor: a chain of 1 to 16 masses joined by massless flexible shafts, or shaft elements and discs. Always valid: it is checked
/// where it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotor {
    pub(crate) name: String,
    pub(crate) body: Body,
}

/// What a rotor is made of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Body {
    /// Lumped masses.
    Chain {
        masses: Vec<Mass>,
        shafts: Vec<f64>,
        /// The numbers it was made of, if they were physical.
        physical: Option<Physical>,
    },
    /// Shaft elements; large, and never changed.
    Beam(Arc<BeamRotor>),
}

/// Why a drawing is not a rotor that can be stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BeamError {
    /// It cannot be reduced.
    #[error(transparent)]
    Reduction(#[from] beam::ReductionError),
    /// Its matrices are no plant.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// Its places can hardly be told apart.
    #[error(
        "the places of the rotor are too near each other for its coordinates (condition {condition:.1e}): fewer coordinates are needed, or stations farther apart"
    )]
    Crowded {
        /// The condition of their displacements.
        condition: f64,
    },
    /// A station that has to be among the coordinates is not.
    #[error(
        "station {station} is not among the places that are simulated: more coordinates are needed, or stations farther apart"
    )]
    NotSimulated {
        /// The station, counted from 1.
        station: usize,
    },
    /// A drawing with other parts than the one whose numbers it is to change.
    #[error("the drawing has other parts than the rotor: expected the same with other numbers")]
    OtherShape,
    /// More magnetic bearings than a machine can have.
    #[error("{0} magnetic bearings: expected at most {MAX_BEARINGS}")]
    Magnetics(usize),
    /// A magnetic bearing that is called as a setting is.
    #[error("magnetic bearing {0:?}: expected {NO_SETTING}")]
    Setting(String),
    /// Two bearings with play at one station.
    #[error("two bearings with play at station {station}: expected one")]
    TwoContacts {
        /// The station, counted from 1.
        station: usize,
    },
    /// A bearing with play whose stiffness changes with speed.
    #[error("the bearing with play at station {station} has a stiffness that changes with speed: expected one number")]
    TabulatedContact {
        /// The station, counted from 1.
        station: usize,
    },
}

/// Why a set of parameters is not a rotor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RotorError {
    /// The name is empty, too long for a message, or would disturb a terminal.
    #[error("name {0:?}: expected 1 to {MAX_NAME} bytes of printable text")]
    Name(String),
    /// The number of masses is outside 1 to 16.
    #[error("a rotor has 1 to {MAX_MASSES} masses, found {0}")]
    Masses(usize),
    /// The number of shafts does not fit the number of masses.
    #[error("{masses} masses are joined by {} shafts, found {found}", masses - 1)]
    Shafts {
        /// How many masses there are.
        masses: usize,
        /// How many shafts were given.
        found: usize,
    },
    /// One value is outside its range.
    #[error("{what} {index}: {field} = {found}: expected {expected}")]
    Value {
        /// `mass` or `shaft`.
        what: &'static str,
        /// Which one, counted from 1.
        index: usize,
        /// The name of the parameter.
        field: &'static str,
        /// The offending value.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// A drawing that cannot be stepped.
    #[error(transparent)]
    Beam(#[from] BeamError),
    /// A physical scale that everything would be divided by is not a finite number greater than 0.
    #[error("{what} = {found}: expected {expected}")]
    Scale {
        /// Which scale, and what it is made of.
        what: &'static str,
        /// Its value.
        found: f64,
        /// What it takes.
        expected: &'static str,
    },
}

impl Rotor {
    /// Checks the parameters and makes a rotor of them. `shafts[i]` is the stiffness ratio `Rf = Kf / K_t` between
    /// masses `i` and `i + 1`.
    ///
    /// # Errors
    /// The first parameter that is out of its range, the wrong number of masses or shafts, or a name that is empty,
    /// over 64 bytes or not printable.
    pub fn new(name: impl Into<String>, masses: Vec<Mass>, shafts: Vec<f64>) -> Result<Self, RotorError> {
        let name = name.into();
        check(&name, masses.iter().map(Mass::values), &shafts)?;
        Ok(Self { name, body: Body::Chain { masses, shafts, physical: None } })
    }

    /// The rotor's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// A rotor of shaft elements and discs, reduced to at most 16 coordinates.
    ///
    /// # Errors
    /// A rotor that nothing holds, or whose places cannot be coordinates.
    pub fn from_drawing(drawing: Drawing) -> Result<Self, RotorError> {
        let name = drawing.name.clone();
        Ok(Self { name, body: Body::Beam(Arc::new(BeamRotor::new(drawing)?)) })
    }

    /// The same with a plant of all the coordinates of its elements, for linear analysis: nothing is lost by reduction, and nothing but
    /// [`crate::Plant`] and what is made of it changes. A chain is what it is. It is not to be stepped: its coordinates are no places.
    ///
    /// # Errors
    /// Matrices that are no plant.
    pub fn in_full(&self) -> Result<Self, RotorError> {
        Ok(match &self.body {
            Body::Chain { .. } => self.clone(),
            Body::Beam(beam) => Self { name: self.name.clone(), body: Body::Beam(Arc::new(beam.in_full()?)) },
        })
    }

    /// It with other numbers in its drawing, which has the same parts in the same places: in the scales of this one, reduced to the same
    /// shapes and places, so that settings keep their meaning and poles are smooth functions of the numbers. A chain is what it is.
    ///
    /// # Errors
    /// A drawing of another make, or matrices that are no plant.
    pub fn redrawn(&self, drawing: Drawing) -> Result<Self, RotorError> {
        Ok(match &self.body {
            Body::Chain { .. } => self.clone(),
            Body::Beam(beam) => Self { name: self.name.clone(), body: Body::Beam(Arc::new(beam.redrawn(drawing)?)) },
        })
    }

    /// How many masses it has, 1 to 16; of shaft elements, how many places have their displacement as a coordinate.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a rotor is never empty")]
    pub fn len(&self) -> usize {
        match &self.body {
            Body::Chain { masses, .. } => masses.len(),
            Body::Beam(beam) => beam.places().len(),
        }
    }

    /// Whether it is a chain of masses.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        matches!(self.body, Body::Chain { .. })
    }

    /// It as shaft elements; `None` of a chain.
    #[must_use]
    pub fn beam(&self) -> Option<&BeamRotor> {
        match &self.body {
            Body::Chain { .. } => None,
            Body::Beam(beam) => Some(beam),
        }
    }

    /// Its masses, from one end to the other; none if it is no chain.
    #[must_use]
    pub fn masses(&self) -> &[Mass] {
        match &self.body {
            Body::Chain { masses, .. } => masses,
            Body::Beam(_) => &[],
        }
    }

    /// Stiffness ratios of its shafts; shaft `i` joins masses `i` and `i + 1`. None if it is no chain.
    #[must_use]
    pub fn shafts(&self) -> &[f64] {
        match &self.body {
            Body::Chain { shafts, .. } => shafts,
            Body::Beam(_) => &[],
        }
    }

    /// What turns control at a place, counted from 0, into a force in `K_t e_t`: the mass ratio `Rm` of the mass of a chain, whose control is
    /// an acceleration; 1 of shaft elements, whose control is a force, and where there is no such place.
    #[must_use]
    pub fn control_mass(&self, place: usize) -> f64 {
        self.masses().get(place).map_or(1.0, |mass| mass.mass)
    }

    /// The clearance of every support bearing, in `e_t`.
    #[must_use]
    pub fn deadbands(&self) -> Vec<f64> {
        match &self.body {
            Body::Chain { masses, .. } => masses.iter().map(|m| m.deadband).collect(),
            Body::Beam(beam) => beam.clearances().to_vec(),
        }
    }

    /// Whether a bearing with a clearance can be pressed on at a place, counted from 0.
    #[must_use]
    pub fn has_contact(&self, place: usize) -> bool {
        match &self.body {
            Body::Chain { masses, .. } => masses.get(place).is_some_and(|mass| mass.bearing_stiffness > 0.0),
            Body::Beam(beam) => beam.plant().contacts().get(place).is_some_and(|contact| contact.stiffness > 0.0),
        }
    }

    /// It with more unbalance: `U / (m_t e_t)` at every place, in the plane of its own. For stepping and its steady response alone: what it
    /// was made of, and the numbers of its file, stay those of the rotor without.
    #[must_use]
    pub fn with_unbalance(&self, added: &[f64]) -> Self {
        let mut made = self.clone();
        match &mut made.body {
            Body::Chain { masses, .. } => {
                masses.iter_mut().zip(added).for_each(|(mass, added)| mass.unbalance += added / mass.mass);
            }
            Body::Beam(beam) => *beam = Arc::new(beam.with_unbalance(added)),
        }
        made
    }

    /// Whether it has no unbalance.
    #[must_use]
    pub fn is_balanced(&self) -> bool {
        match &self.body {
            Body::Chain { masses, .. } => masses.iter().all(|mass| mass.unbalance == 0.0),
            Body::Beam(beam) => beam.plant().unbalance().iter().all(|unbalance| *unbalance == C64::ZERO),
        }
    }

    /// What a place, counted from 0, is called: `mass 1`, `left`, `station 3`, `0.125 m`.
    #[must_use]
    pub fn place_name(&self, place: usize) -> String {
        match &self.body {
            Body::Chain { .. } => format!("mass {}", place + 1),
            Body::Beam(beam) => beam.place_name(place),
        }
    }
}

impl From<beam::ReductionError> for RotorError {
    fn from(error: beam::ReductionError) -> Self {
        Self::Beam(error.into())
    }
}

impl From<PlantError> for RotorError {
    fn from(error: PlantError) -> Self {
        Self::Beam(error.into())
    }
}

/// Whether `name` can stand in a heading and in a message.
#[must_use]
pub(crate) fn is_name(name: &str) -> bool {
    (1..=MAX_NAME).contains(&name.len()) && !name.chars().any(char::is_control)
}

/// Checks the parameters of a rotor in either system of units.
pub(crate) fn check(
    name: &str,
    masses: impl ExactSizeIterator<Item = [f64; 7]>,
    shafts: &[f64],
) -> Result<(), RotorError> {
    if !is_name(name) {
        return Err(RotorError::Name(name.to_owned()));
    }
    let count = masses.len();
    if !(1..=MAX_MASSES).contains(&count) {
        return Err(RotorError::Masses(count));
    }
    if shafts.len() + 1 != count {
        return Err(RotorError::Shafts { masses: count, found: shafts.len() });
    }
    let value = |what, at: usize, field, found, domain: Domain| match domain.admits(found) {
        true => Ok(()),
        false => Err(RotorError::Value { what, index: at + 1, field, found, expected: domain.words() }),
    };
    for (i, values) in masses.enumerate() {
        for (field, found) in FIELDS.iter().zip(values) {
            value("mass", i, field.name, found, field.domain)?;
        }
    }
    for (i, &found) in shafts.iter().enumerate() {
        value("shaft", i, "stiffness", found, Domain::NotNegative)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Mass {
        Mass { mass: 1.0, ..Mass::default() }
    }

    #[test]
    fn refuses_what_is_out_of_range_and_names_it() {
        let told = |masses: Vec<Mass>, shafts: Vec<f64>| Rotor::new("x", masses, shafts).unwrap_err().to_string();
        assert_eq!(
            Rotor::new("a\u{1b}[2J", vec![unit()], vec![]).unwrap_err().to_string(),
            r#"name "a\u{1b}[2J": expected 1 to 64 bytes of printable text"#
        );
        assert_eq!(told(vec![], vec![]), "a rotor has 1 to 16 masses, found 0");
        assert_eq!(told(vec![unit(); 17], vec![1.0; 16]), "a rotor has 1 to 16 masses, found 17");
        assert_eq!(told(vec![unit(); 3], vec![1.0]), "3 masses are joined by 2 shafts, found 1");
        assert_eq!(
            told(vec![unit(), Mass { mass: 0.0, ..unit() }], vec![1.0]),
            "mass 2: mass = 0: expected a finite number greater than 0"
        );
        assert_eq!(
            told(vec![Mass { deadband: -1.0, ..unit() }], vec![]),
            "mass 1: deadband = -1: expected a finite number, not negative"
        );
        assert_eq!(
            told(vec![Mass { unbalance: f64::NAN, ..unit() }], vec![]),
            "mass 1: unbalance = NaN: expected a finite number"
        );
        assert_eq!(
            told(vec![unit(); 2], vec![f64::INFINITY]),
            "shaft 1: stiffness = inf: expected a finite number, not negative"
        );
    }
}
