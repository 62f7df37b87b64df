//! Why a player does not do what it is asked for.

use machine::ProgramError;
use rotor::{RotorError, SettingsError};

use crate::processes::OpaqueError;
use crate::units::ScreenUnits;

/// Why a player does not do what it is asked for.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A recording without steps.
    #[error("there are no steps in it")]
    Empty,
    /// Whoever has the recording cannot read it.
    #[error(transparent)]
    Source(#[from] OpaqueError),
    /// There is no event that way.
    #[error("no event {} this", if *after { "after" } else { "before" })]
    NoEvent {
        /// Whether one after this was asked for.
        after: bool,
    },
    /// What was recorded cannot be undone.
    #[error("nothing to undo: what happened cannot be changed, only run on from")]
    Happened,
    /// No change of what is run on beside is left to undo.
    #[error("nothing to undo")]
    NothingToUndo,
    /// None that was undone is left.
    #[error("nothing to redo")]
    NothingToRedo,
    /// Notes are for a bench.
    #[error("a recording takes no more notes")]
    NoNotes,
    /// No step is at hand.
    #[error("no step to run on from")]
    NoStep,
    /// The step is not on file.
    #[error("the step to run on from is missing")]
    MissingStep,
    /// The loop was excited, and nothing tells how far that had come.
    #[error(
        "the loop was excited here, to be measured, and no snapshot tells how it stood: run on from before or after"
    )]
    Excited,
    /// Settings that are none, told in the machine's units.
    #[error("{told}")]
    Settings {
        /// What is wrong with them.
        told: String,
        /// The same, dimensionless.
        source: SettingsError,
    },
    /// The recording does not tell of its rotor.
    #[error(transparent)]
    Rotor(#[from] RotorError),
    /// Settings that the recorded machine cannot be stepped with.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

impl ReplayError {
    /// What is wrong with settings, in the units that they are typed in.
    pub(super) fn settings(source: SettingsError, units: &ScreenUnits) -> Self {
        Self::Settings { told: units.fault(&source), source }
    }
}
