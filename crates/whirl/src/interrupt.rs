//! What ctrl-c does to a long computation: it ends at the next opportunity, and leaves no half-written file.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::failure::Failure;

/// A flag that the first SIGINT or SIGTERM raises; the second ends the process at once, with exit code 130.
///
/// # Errors
/// The handlers cannot be set.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&flag))
            .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&flag)))
            .map_err(|error| Failure::Work(format!("cannot watch for signals: {error}")))?;
    }
    Ok(flag)
}
