//! The signals that ask a process to end.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::failure::Failure;

/// A flag that SIGINT, SIGTERM and SIGHUP raise. A second signal while it is raised ends the process at once.
///
/// # Errors
/// The handlers cannot be set.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let raised = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, raised.clone())
            .and_then(|_| signal_hook::flag::register(signal, raised.clone()))
            .map_err(|error| Failure::Work(format!("signals cannot be handled: {error}")))?;
    }
    Ok(raised)
}
