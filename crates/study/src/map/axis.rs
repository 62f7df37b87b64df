//! What varies along an axis of a map: a number of the machine, where a run starts, or what strikes it.

use variation::{Model, Parameter};

use super::MapError;

/// What an axis is.
#[derive(Clone, Debug, PartialEq)]
pub enum MapKey {
    /// A parameter of the machine.
    Parameter(Parameter),
    /// Where a run starts: a component of displacement or velocity of a mass, from 0.
    Start {
        /// The mass.
        mass: usize,
        /// Which of [`START_PARTS`].
        part: usize,
    },
    /// An impulse that strikes once the motion has settled: a component of the change of a mass's velocity, from 0.
    Impulse {
        /// The mass.
        mass: usize,
        /// Which of [`IMPULSE_PARTS`].
        part: usize,
    },
}

/// Components of a start: `start.1.y` is the displacement of mass 1.
pub const START_PARTS: [&str; 4] = ["y", "z", "vy", "vz"];

/// Components of an impulse: `impulse.1.vy` adds to the velocity of mass 1.
pub const IMPULSE_PARTS: [&str; 2] = ["vy", "vz"];

impl MapKey {
    /// The key that is typed as `name`: a parameter of the machine, `start.N.y|z|vy|vz`, or `impulse.N.vy|vz`.
    ///
    /// # Errors
    /// There is none.
    pub fn of(model: &Model, name: &str) -> Result<Self, MapError> {
        let (word, rest) = name.split_once('.').unwrap_or((name, ""));
        let place = |parts: &[&str]| {
            let (number, part) = rest.split_once('.')?;
            let mass = number.parse::<usize>().ok()?.checked_sub(1).filter(|mass| *mass < model.rotor.len())?;
            Some((mass, parts.iter().position(|own| *own == part)?))
        };
        let unknown = |parts: &[&str]| MapError::Motion {
            key: name.to_owned(),
            expected: format!("{word}.N.{} with N from 1 to {}", parts.join("|"), model.rotor.len()),
        };
        match word {
            "start" => {
                let found = place(&START_PARTS).map(|(mass, part)| Self::Start { mass, part });
                found.ok_or_else(|| unknown(&START_PARTS))
            }
            "impulse" => {
                let found = place(&IMPULSE_PARTS).map(|(mass, part)| Self::Impulse { mass, part });
                found.ok_or_else(|| unknown(&IMPULSE_PARTS))
            }
            _ => Ok(Self::Parameter(model.parameter(name)?)),
        }
    }

    /// Whether it is of the motion, and the machine the same along it.
    #[must_use]
    pub fn is_of_motion(&self) -> bool {
        !matches!(self, Self::Parameter(_))
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Parameter(parameter) => parameter.name().to_owned(),
            Self::Start { mass, part } => format!("start.{}.{}", mass + 1, START_PARTS[*part]),
            Self::Impulse { mass, part } => format!("impulse.{}.{}", mass + 1, IMPULSE_PARTS[*part]),
        }
    }
}

/// An axis: a key and its values, rising, at least two.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// What varies.
    pub key: MapKey,
    /// Its values.
    pub values: Vec<f64>,
}
