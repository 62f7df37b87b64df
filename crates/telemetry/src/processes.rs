//! What the dashboard needs done outside of itself, by whoever started it: processes are not its business.

use crate::past::Past;

/// What the dashboard asked of its surroundings failed: with the error of whoever was to do it.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct OpaqueError(Box<dyn std::error::Error + Send + Sync>);

impl OpaqueError {
    /// That failed, for this.
    pub fn new(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self(error.into())
    }
}

impl From<OpaqueError> for String {
    /// In the words that the message line has.
    fn from(error: OpaqueError) -> Self {
        error.to_string()
    }
}

/// Whoever started the simulation, if it was us.
pub trait SimulationProcess {
    /// How the simulation ended, once it has.
    fn ended(&mut self) -> Option<String>;
    /// Starts it again.
    ///
    /// # Errors
    /// It cannot be started.
    fn restart(&mut self) -> Result<(), OpaqueError>;
}

/// Whoever can record the bench, in a process of its own.
pub trait RecorderProcess {
    /// Starts a recording, and says in which file it will be. Does not wait for it. With `past` what is kept in memory goes before it:
    /// [`RecorderProcess::wants_past_before`] tells up to where.
    ///
    /// # Errors
    /// It cannot be started.
    fn start(&mut self, past: bool) -> Result<String, OpaqueError>;
    /// The number of the first step that is recorded, while what is kept from before it is waited for.
    fn wants_past_before(&self) -> Option<u64>;
    /// Has this written before what is recorded. Does not wait.
    fn put_past(&mut self, past: Past);
    /// Whether a recording that was started here has not said yet that it records.
    fn is_starting(&self) -> bool;
    /// Asks the recording that was started here to end in good order. Does not wait.
    fn stop(&mut self);
    /// Whether a recording that was started here has not ended yet.
    fn is_running(&self) -> bool;
    /// What has become of the recording that was started here: each thing is told once.
    fn news(&mut self) -> Option<RecorderNews>;
}

/// What becomes of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecorderNews {
    /// It records, in this file.
    Records(String),
    /// What was kept in memory is written, or not, in words.
    Past(Result<String, String>),
    /// It has ended, in good order or not, in words.
    Ended(Result<String, String>),
}
