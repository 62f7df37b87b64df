//! Rotors, feedback and profiles of speed as TOML text: reading with every fault at its line and column, and writing.
//!
//! Text in, text out; opening files is the caller's. What is written reads back as the same rotor or feedback, bit for
//! bit. Unknown keys are errors, because a misspelt key would otherwise be a parameter silently at its default.
//!
//! * A rotor has `name` (absent: whatever the caller says), `units` (`"dimensionless"`, the default, or `"si"`), one
//!   `[[mass]]` a mass with the keys of [`crate::FIELDS`] (`mass` must be there, the others are 0 where absent), one
//!   `[[shaft]]` with `stiffness` between each two, and in SI optionally `reference_length` in m, see
//!   [`Rotor::from_si`](crate::Rotor::from_si).
//! * Feedback has `bearing`, counted from 1, and one `[[signal]]` a signal: `mass`, counted from 1, or weights
//!   `displacement` and `velocity`; and the gains `kd cd kc cc` (0 where absent), each a number,
//!   `{ at_zero, slope }` or `{ speed = [..], value = [..] }`. Feedback is always dimensionless, over speed `R`.

mod document;
mod feedback_text;
mod feedback_toml;
mod known_rotor;
mod loop_toml;
mod profile_toml;
mod rotor_toml;
mod write;

pub use document::FeedbackDocument;
pub use feedback_text::{write_feedback, write_feedback_for};
pub use feedback_toml::{read_feedback, read_feedback_for};
pub use profile_toml::read_profile;
pub use rotor_toml::{read_rotor, read_rotor_with, write_rotor};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A rotor.
    Rotor,
    /// Feedback.
    Feedback,
}

/// What `text` seems meant to be: a rotor if it has sections; else feedback if it has a signal, a bearing or a loop, otherwise a rotor.
#[must_use]
pub fn kind_of(text: &str) -> Kind {
    let (table, _) = toml::de::DeTable::parse_recoverable(text);
    let has = |key: &str| table.get_ref().contains_key(key);
    if has("section") || has("plant") {
        return Kind::Rotor;
    }
    if has("signal") || has("bearing") || has("loop") { Kind::Feedback } else { Kind::Rotor }
}
