//! The player: the dashboard on a recording instead of a bench.
//!
//! The same loop, panels and keys. Where a live dashboard has a reader thread that fills the [`crate::feed`], a
//! [`Player`] fills it from a [`RecordingSource`] around the moment it stands at, and moves on with a clock of its own; where a
//! live dashboard sends edits to the simulation, the player makes a [`branch`] of them: the machine run on from that
//! moment with other settings, shown beside what happened.
//!
//! Not its job: reading files. Whoever has a recording implements [`RecordingSource`]; this crate knows no file format.

mod branch;
mod error;
mod loaded_steps;
mod machine;
mod player;
mod rows;
#[cfg(test)]
mod snapshot_tests;
mod source;
mod status;
#[cfg(test)]
mod tests;

pub use error::ReplayError;
pub use player::{LoopRange, Player};
pub use source::{RecordedEvent, RecordedKind, RecordingSource};
pub use status::{ReplayStatus, WhatIfRun};
