//! A point of a session.

use crate::{Event, Step};

/// A point of a session, on its three time scales.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Step number since the simulation started: it only rises.
    pub seq: u64,
    /// Dimensionless time since the rotor was last at rest.
    pub tau: f64,
    /// Wall clock, nanoseconds since 1970.
    pub wall_ns: u64,
}

impl<S: Step> From<&S> for Moment {
    fn from(step: &S) -> Self {
        Self { seq: step.seq(), tau: step.tau(), wall_ns: step.wall_ns() }
    }
}

impl From<&Event> for Moment {
    fn from(event: &Event) -> Self {
        Self { seq: event.seq, tau: event.tau, wall_ns: event.wall_ns }
    }
}
