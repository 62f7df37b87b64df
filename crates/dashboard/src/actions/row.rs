//! What a row of the table of actions says.

use super::action::Action;

/// One action.
pub(crate) struct ActionRow {
    /// Its name, as typed after `:` and in the configuration.
    pub(crate) name: &'static str,
    /// What must follow the name, in capitals; in brackets what may; empty if nothing does.
    pub(crate) argument: &'static str,
    /// What it does, as the command line tells it.
    pub(crate) meaning: &'static str,
    /// Its keys.
    pub(crate) keys: &'static [KeyBinding],
    /// What it makes of its argument.
    pub(super) make: fn(&str) -> Result<Action, String>,
}

/// Keys that do the same, more or less.
pub(crate) struct KeyBinding {
    /// Each with what follows the name of the action.
    pub(crate) chords: &'static [(&'static str, &'static str)],
    /// What they do.
    pub(crate) meaning: &'static str,
    /// The same in a word or two, if it is hinted at the foot of the screen.
    pub(crate) hint: Option<&'static str>,
}

/// Keys that do the same: each with what follows the name of the action, what they do, and the hint for the foot.
pub(super) const fn keys(
    chords: &'static [(&'static str, &'static str)],
    meaning: &'static str,
    hint: Option<&'static str>,
) -> KeyBinding {
    KeyBinding { chords, meaning, hint }
}
