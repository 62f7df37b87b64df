//! Why a number cannot be another, or nothing can be said of a machine.

use linear::DelayError;
use machine::{MarginsError, PolesError};
use rotor::{RotorError, SettingsError};

/// Why a number cannot be another, or nothing can be said of a machine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VariationError {
    /// No parameter of that name.
    #[error("no parameter '{found}': there are {known}")]
    Unknown {
        /// What was found.
        found: String,
        /// What there is, in words.
        known: String,
    },
    /// A value that the parameter cannot have.
    #[error("{name} = {found}: expected {expected}")]
    Value {
        /// The parameter.
        name: String,
        /// The value.
        found: f64,
        /// What it may be.
        expected: String,
    },
    /// A setting that cannot be.
    #[error(transparent)]
    Setting(#[from] SettingsError),
    /// Numbers of which no rotor can be made.
    #[error(transparent)]
    Rotor(#[from] RotorError),
    /// A drawing that is none.
    #[error(transparent)]
    Drawing(#[from] beam::DrawingError),
    /// Poles that cannot be had.
    #[error(transparent)]
    Poles(#[from] PolesError),
    /// Margins that cannot be had.
    #[error(transparent)]
    Margins(#[from] MarginsError),
}

impl From<DelayError> for VariationError {
    fn from(error: DelayError) -> Self {
        Self::Poles(error.into())
    }
}

impl From<control::FeedbackError> for VariationError {
    fn from(error: control::FeedbackError) -> Self {
        Self::Poles(error.into())
    }
}
