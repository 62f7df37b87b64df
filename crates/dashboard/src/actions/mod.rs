//! The one table of actions: it makes the keys, the command line with its completion, the help screen, the hints at the
//! foot, the table of docs/book/src/keys.md and the default configuration.
//!
//! A key stands for a command line, such as `nudge -1`; what is typed after `:` goes through the same [`parse`].

mod action;
mod argument;
mod line;
mod row;
mod table;

pub(crate) use action::{Action, TypedLimit, TypedScaling};
pub(crate) use line::{parse, with_keys};
pub(crate) use row::{ActionRow, KeyBinding};
pub(crate) use table::{ACTIONS, MOUSE};
