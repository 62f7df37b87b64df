//! Why settings are refused, in words that say what was expected.

use units::TypedError;

use crate::{FeedbackError, PARAMETERS};

/// Why a change of settings is refused. Nothing has changed then.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// No such key.
    #[error("no setting '{0}': {meant}there are {known}, with .N for mass, signal or control bearing N", meant = meant(.0), known = known_keys())]
    UnknownKey(String),
    /// The mass, signal or control bearing asked for does not exist.
    #[error("no {key}: there are {count} {of}")]
    NoSuchIndex {
        /// The key, with its index.
        key: String,
        /// How many there are.
        count: usize,
        /// Of what: `masses`, `signals` or `control bearings`.
        of: &'static str,
    },
    /// The clearance of a support bearing that is not there.
    #[error("{key} does nothing: {place} has no support bearing with play; {}", known_clearances(known))]
    NoContact {
        /// The key.
        key: String,
        /// The place that was meant, or the rotor.
        place: String,
        /// The keys it may be.
        known: Vec<String>,
    },
    /// A gain of one of several control bearings, and it is not said of which.
    #[error("{key} of which control bearing? There are {known}", known = known.join(", "))]
    WhichBearing {
        /// The key, as typed.
        key: String,
        /// The keys it may be.
        known: Vec<String>,
    },
    /// What was typed is no value of this setting.
    #[error("{key} = '{found}': {expected}{}", or_off_words(*or_off))]
    NoValue {
        /// The key.
        key: String,
        /// What was typed.
        found: String,
        /// What was expected.
        expected: TypedError,
        /// Whether it can be off.
        or_off: bool,
    },
    /// The value is not finite, or outside its range.
    #[error("{key} = {found}: expected a number from {min} to {max}{}", or_off_words(*or_off))]
    OutOfRange {
        /// The key.
        key: String,
        /// The value.
        found: f64,
        /// The least allowed.
        min: f64,
        /// The greatest allowed.
        max: f64,
        /// Whether it can be off.
        or_off: bool,
    },
    /// The number of clearances is not the number of masses.
    #[error("{found} deadbands for {masses} masses")]
    Deadbands {
        /// How many were given.
        found: usize,
        /// How many there must be.
        masses: usize,
    },
    /// The number of added unbalances is not the number of masses.
    #[error("{found} added unbalances for {masses} masses")]
    Unbalances {
        /// How many were given.
        found: usize,
        /// How many there must be.
        masses: usize,
    },
    /// The feedback does not fit the rotor.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
}

fn or_off_words(can_be_off: bool) -> &'static str {
    if can_be_off { ", or off" } else { "" }
}

fn known_clearances(known: &[String]) -> String {
    if known.is_empty() { "it has none anywhere".to_owned() } else { format!("there are {}", known.join(", ")) }
}

/// Which key was probably meant, as words.
pub(crate) fn meant(typed: &str) -> String {
    text::meant(typed, &crate::PARAMETERS.map(|parameter| parameter.name))
}

pub(crate) fn known_keys() -> String {
    PARAMETERS.iter().map(|p| p.name).chain(["feedback"]).collect::<Vec<_>>().join(", ")
}
