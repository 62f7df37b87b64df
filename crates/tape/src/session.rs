//! What a recording says of itself: whose session it is, what was in force, and how far it goes.

use alarms::Limits;
use rotor::{C64, Settings};
use wire::Moment;

/// About the whole file.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Version of what the recording holds, [`crate::schema::VERSION`] when written now.
    pub schema: u32,
    /// Version of the program that recorded.
    pub whirl: String,
    /// Version of the program that simulated.
    pub simulation: String,
    /// Which run of which process.
    pub run_id: u64,
    /// The bench's name; empty for an offline run.
    pub bench: String,
    /// Where it comes from.
    pub source: Source,
    /// Wall clock when the simulation started, nanoseconds since 1970.
    pub started_ns: u64,
    /// Steps a second that it paced itself to; 0 for an offline run.
    pub rate_hz: f64,
    /// Advance of `tau` per step.
    pub dtau: f64,
    /// How many control bearings its steps tell of.
    pub bearings: usize,
    /// What alarms were held against; `None` if nobody judged, as in runs without a bench and before there were alarms.
    pub limits: Option<Limits>,
}

/// Where a recording comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A running bench.
    Live,
    /// `whirl run`: the wall clock of its steps is made up, one second of it for one unit of `tau`.
    Offline,
}

impl Source {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "live",
            Self::Offline => "offline",
        }
    }

    pub(crate) fn of(name: &str) -> Self {
        if name == "offline" { Self::Offline } else { Self::Live }
    }
}

/// Settings, whole, with the poles under them.
#[derive(Clone, Debug, PartialEq)]
pub struct Revision {
    /// The first step made with them.
    pub from: u64,
    /// Their number: 1 at the start of a run.
    pub revision: u64,
    /// Who made the change.
    pub who: String,
    /// Why; may be empty.
    pub why: String,
    /// The settings.
    pub settings: Settings,
    /// Runge-Kutta steps that make one step under them, at least 1.
    pub substeps: u32,
    /// Poles, least damped first; none if they did not converge.
    pub poles: Vec<C64>,
    /// The smallest damping ratio; 0 if there are no poles.
    pub min_damping: f64,
}

/// The first step on file and the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The first.
    pub first: Moment,
    /// The last.
    pub last: Moment,
}

impl Span {
    /// Seconds on the wall clock between the two.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.last.wall_ns.saturating_sub(self.first.wall_ns) as f64 / 1e9
    }
}

/// Steps that are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The first that is missing.
    pub from: u64,
    /// How many.
    pub count: u64,
}
