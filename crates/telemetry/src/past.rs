//! What is kept in memory of the present run, for whoever writes it down.

use wire::{BenchStatus, Event};

use crate::history::PastSteps;

/// Some of the past of a run, up to a step.
#[derive(Clone, Debug)]
pub struct Past {
    /// The slow picture, with the settings that were in force at the first step.
    pub bench_status: Box<BenchStatus>,
    /// What happened in the run and is remembered, the oldest first; the settings before each change among it.
    pub events: Vec<Event>,
    /// The steps.
    pub steps: PastSteps,
}
