//! Why something is no rotor, in words that say what was expected.

use crate::parameters::NO_SETTING;
use crate::{MAX_BEARINGS, MAX_MASSES, MAX_NAME, PlantError};

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
