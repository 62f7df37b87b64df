//! The signals that ask a process to end.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::failure::Failure;

const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

/// A flag that SIGINT, SIGTERM and SIGHUP raise. A second signal while it is raised ends the process at once.
///
/// # Errors
/// The handlers cannot be set.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let raised = Arc::new(AtomicBool::new(false));
    for signal in SIGNALS {
        signal_hook::flag::register_conditional_shutdown(signal, 130, raised.clone())
            .and_then(|_| signal_hook::flag::register(signal, raised.clone()))
            .map_err(|error| unhandled(&error))?;
    }
    Ok(raised)
}

/// From here on those signals end the process at once, with exit code 130: for work that has nothing to clean up.
///
/// # Errors
/// The handlers cannot be set.
pub(crate) fn end_at_once() -> Result<(), Failure> {
    let raised = Arc::new(AtomicBool::new(true));
    SIGNALS.into_iter().try_for_each(|signal| {
        signal_hook::flag::register_conditional_shutdown(signal, 130, raised.clone())
            .map(drop)
            .map_err(|error| unhandled(&error))
    })
}

fn unhandled(error: &std::io::Error) -> Failure {
    Failure::Work(format!("signals cannot be handled: {error}"))
}
