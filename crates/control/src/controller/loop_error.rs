//! Why a loop cannot work at a step.

use super::MOST_STRETCHES;
use crate::FeedbackError;

/// Why a loop cannot work at a step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoopError {
    /// The feedback itself is not in order.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
    /// Samples closer together than steps.
    #[error("sample = {sample}: shorter than a step of {dtau}; expected at least that, or dtau = {sample}")]
    SampleWithinStep {
        /// The period asked for.
        sample: f64,
        /// The step.
        dtau: f64,
    },
    /// A delay of more steps than are remembered.
    #[error("delay = {delay} is {:.0} steps of {dtau}: at most {MOST_STRETCHES:.0} are remembered", delay / dtau)]
    DelayTooLong {
        /// The delay asked for.
        delay: f64,
        /// The step, or the sampling period.
        dtau: f64,
    },
}
