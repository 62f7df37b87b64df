//! How a controller outside does, in numbers.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How a controller outside does, as the stepping thread counts it.
#[derive(Debug, Default)]
pub(crate) struct ExternalCounters {
    /// Commands that were taken.
    pub(crate) taken: AtomicU64,
    pub(crate) late: AtomicU64,
    pub(crate) missed: AtomicU64,
    pub(crate) refused: AtomicU64,
    /// How often commands from outside came to act.
    pub(crate) took_over: AtomicU64,
    /// How often the law of the bench had to take over.
    pub(crate) lost: AtomicU64,
    /// Whether commands from outside act.
    pub(crate) acting: AtomicBool,
}

/// How a controller outside did, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExternalCounts {
    /// Commands that were taken.
    pub taken: u64,
    /// Of these, commands that came after their deadline.
    pub late: u64,
    /// Samples whose command was not there at its deadline.
    pub missed: u64,
    /// Commands that were not taken, because they were not finite, whatever they answered.
    pub refused: u64,
    /// How often commands from outside came to act.
    pub took_over: u64,
    /// How often the law of the bench had to take over.
    pub lost: u64,
    /// Whether commands from outside act.
    pub acting: bool,
}

impl ExternalCounters {
    pub(crate) fn now(&self) -> ExternalCounts {
        let of = |count: &AtomicU64| count.load(Ordering::Relaxed);
        ExternalCounts {
            taken: of(&self.taken),
            late: of(&self.late),
            missed: of(&self.missed),
            refused: of(&self.refused),
            took_over: of(&self.took_over),
            lost: of(&self.lost),
            acting: self.acting.load(Ordering::Relaxed),
        }
    }

    /// The counts, if there was a controller.
    pub(crate) fn told(&self) -> Option<ExternalCounts> {
        let counts = self.now();
        (counts.taken + counts.refused > 0).then_some(counts)
    }
}

impl fmt::Display for ExternalCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { taken, late, missed, refused, lost, .. } = self;
        write!(
            f,
            "controller outside: {taken} commands, {late} late, {missed} missed, {refused} refused, lost {lost} times"
        )
    }
}
