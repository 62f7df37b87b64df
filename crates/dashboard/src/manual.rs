//! The manual's tables, made from the one table of actions.

use crate::actions::{ACTIONS, ActionRow};
use crate::keymap::Keymap;

/// The manual's table of keys: each with what it does.
#[must_use]
pub fn manual_keys() -> Vec<(String, &'static str)> {
    let keymap = Keymap::default();
    let keys = ACTIONS.iter().flat_map(|row| row.keys.iter().map(move |keys| (row, keys)));
    keys.map(|(row, keys)| (keymap.shown(row, keys), keys.meaning)).collect()
}

/// The manual's table of commands that can be typed: each with what it does.
#[must_use]
pub fn manual_commands() -> Vec<(String, &'static str)> {
    let command = |row: &ActionRow| (format!("{} {}", row.name, row.argument).trim_end().to_owned(), row.meaning);
    ACTIONS.iter().map(command).collect()
}
