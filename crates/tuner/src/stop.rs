//! When to stop early.

use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ends a search at the next opportunity: it then gives the best found so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stop<'a> {
    flag: Option<&'a AtomicBool>,
    /// Whether what is looked at is looked at no closer, because somebody waits already.
    is_glance: bool,
}

impl<'a> Stop<'a> {
    /// Never stops early.
    pub const NEVER: Stop<'static> = Stop { flag: None, is_glance: false };
    /// Never stops early, but leaves out what only makes an answer sharper.
    pub(crate) const GLANCE: Stop<'static> = Stop { flag: None, is_glance: true };

    /// Stops when `flag` is set.
    #[must_use]
    pub fn when(flag: &'a AtomicBool) -> Self {
        Self { flag: Some(flag), is_glance: false }
    }

    /// Whether to stop.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.flag.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Whether an answer is to be no sharper than it is.
    pub(crate) fn is_glance(&self) -> bool {
        self.is_glance
    }
}
