//! What a rotor is made of, and which values are allowed. Not its motion: see [`crate::ClosedLoop`].

use std::sync::Arc;

use beam::Drawing;
use text::Domain;

use crate::{BeamRotor, C64, FIELDS, MAX_MASSES, MAX_NAME, Mass, Physical, RotorError};

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
