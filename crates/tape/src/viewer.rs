//! How a running viewer stands in which a recording is shown while it is made. What speaks to it is [`crate::rrd`]'s.

use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a viewer that keeps up may take for the last that it is shown.
const FAREWELL: Duration = Duration::from_secs(2);

/// How a viewer stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewerState {
    /// None has answered yet.
    Waiting,
    /// It shows what comes.
    Showing,
    /// It takes less than comes: the rest is left out.
    Behind,
    /// It has gone; no other is looked for.
    Gone,
}

/// How a viewer stands, and what it was shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewerStatus {
    /// How it stands.
    pub state: ViewerState,
    /// Messages that were handed to it.
    pub shown: u64,
    /// Messages that were not, because too many waited already.
    pub left_out: u64,
    /// Whether nothing waits any more, and nothing else comes.
    pub(crate) is_done: bool,
}

/// Asks how a viewer stands.
#[derive(Clone)]
pub(crate) struct AskViewer(pub(crate) Arc<dyn Fn() -> ViewerStatus + Send + Sync>);

impl AskViewer {
    pub(crate) fn status(&self) -> ViewerStatus {
        (self.0)()
    }

    /// Waits until the last of it is shown: of a viewer that keeps up, and no longer than a moment.
    pub(crate) fn farewell(&self) -> ViewerStatus {
        let began = Instant::now();
        loop {
            let status = self.status();
            let keeps_up = matches!(status.state, ViewerState::Showing | ViewerState::Behind);
            if status.is_done || !keeps_up || began.elapsed() > FAREWELL {
                return status;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}
