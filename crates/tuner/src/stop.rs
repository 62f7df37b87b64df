//! When to stop early.

use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ends a search at the next opportunity: it then gives the best found so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stop<'a>(Option<&'a AtomicBool>);

impl<'a> Stop<'a> {
    /// Never stops early.
    pub const NEVER: Stop<'static> = Stop(None);

    /// Stops when `flag` is set.
    #[must_use]
    pub fn when(flag: &'a AtomicBool) -> Self {
        Self(Some(flag))
    }

    /// Whether to stop.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.0.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}
