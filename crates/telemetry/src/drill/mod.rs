//! Drills: one fault at a time on a running machine, so that whoever runs it learns its fingerprint.
//!
//! A fault is a change of settings whose reason begins with `drill: `. So it is checked, answered, recorded, played again and undone like any
//! other change, and what a bench does with it is what a recording of it says. [`FaultOrder`] is a fault as it is asked for, and what it
//! changes; [`Drill`] is a row of them over time, a file; [`DrillLog`] knows from the events of a run which fault is there, and what it was
//! put in place of.

mod fault;
mod file;
mod log;
mod order;

use rotor::SettingsError;
use units::{Typed, TypedError};

pub use fault::Fault;
pub use file::{BUILTIN, Drill, DrillStep, builtin, read_drill};
pub use log::{ActiveFault, DrillLog};
pub use order::{CountedAlone, FaultOrder};

/// What stands before the cause of every change that a drill makes.
pub const CAUSE: &str = "drill: ";
/// Why settings change when a fault is put back.
pub const OVER: &str = "drill over";

/// Why there is no such drill, or it cannot be held on this machine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DrillError {
    /// No such fault.
    #[error("no fault '{found}': expected one of {known}{meant}")]
    Fault {
        /// What was asked for.
        found: String,
        /// What there is.
        known: String,
        /// What was probably meant, in words.
        meant: String,
    },
    /// Words that say nothing.
    #[error("'{0}': expected NAME, and perhaps at=PLACE and size=SIZE")]
    Words(String),
    /// A place that it cannot be at.
    #[error("{fault} at '{found}': expected {expected}")]
    Place {
        /// The fault.
        fault: Fault,
        /// What was asked for.
        found: String,
        /// What there is.
        expected: String,
    },
    /// Nowhere that it could be.
    #[error("{0}: {1}")]
    Nowhere(Fault, &'static str),
    /// A size that it cannot have.
    #[error("{fault} of size '{found}': expected {expected}")]
    Size {
        /// The fault.
        fault: Fault,
        /// What was asked for.
        found: String,
        /// What there is.
        expected: &'static str,
    },
    /// A size in a unit that this machine does not have.
    #[error("{0}: size = {1}: {2}")]
    Unit(Fault, Typed, TypedError),
    /// It is like that already.
    #[error("{0} would change nothing: the machine is like that already")]
    Nothing(Fault),
    /// What the machine does not take.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

#[cfg(test)]
mod tests;
