//! What a search says of itself: how it goes, and what it found.

use std::time::Duration;

use rotor::Feedback;

use crate::certify::Certificate;
use crate::minimax::Stationarity;
use crate::opened::LoopMargins;

/// How a search is going.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Climbs that have ended.
    pub done: usize,
    /// Climbs in all.
    pub starts: usize,
    /// The best worst value so far.
    pub best: f64,
    /// Since the search began.
    pub elapsed: Duration,
}

impl Progress {
    /// How long the rest will take if it goes on like this.
    #[must_use]
    pub fn left(&self) -> Option<Duration> {
        (self.done > 0).then(|| self.elapsed.mul_f64((self.starts - self.done) as f64 / self.done as f64))
    }
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The gains: the variables of the structure, those of corners behind them.
    pub gains: Vec<f64>,
    /// The feedback with those gains.
    pub feedback: Feedback,
    /// The corners that were searched, in radians per `tau`.
    pub corners: Vec<f64>,
    /// The worst over the family: what, where, and whether that is proven.
    pub worst: Certificate,
    /// The largest steady control force of the linear rotor under its unbalance found in the family, in `w0^2 e_t`.
    pub force: f64,
    /// Where it is, in the coordinates of the family's axes.
    pub force_at: Vec<f64>,
    /// Where margins are asked for: those where the peak of the sensitivity is largest, and those where the delay margin is smallest,
    /// each with its condition.
    pub margins: Option<[(LoopMargins, Vec<f64>); 2]>,
    /// Where the peak of the sensitivity is limited: what no condition of the whole family exceeds. `None` where that is not proven.
    pub peak_below: Option<f64>,
    /// How near to a local optimum they are.
    pub stationarity: Stationarity,
    /// The modes that hold the value, at their conditions.
    pub active: Vec<Active>,
    /// What every climb ended with, best first.
    pub values: Vec<f64>,
    /// How many eigenvalue problems were solved.
    pub evaluations: u64,
    /// How long it took.
    pub elapsed: Duration,
    /// Whether it was stopped before its end.
    pub interrupted: bool,
}

impl Tuned {
    /// The largest peak of the sensitivity, where margins were asked for.
    #[must_use]
    pub fn peak_sensitivity(&self) -> Option<f64> {
        self.margins.as_ref().map(|[(margins, _), _]| margins.sensitivity.0)
    }

    /// The largest magnitude of any gain.
    #[must_use]
    pub fn largest_gain(&self) -> f64 {
        let gains = &self.gains[..self.gains.len() - self.corners.len()];
        gains.iter().fold(0.0, |most, gain| gain.abs().max(most))
    }
}

/// A mode near the worst value.
#[derive(Clone, Debug, PartialEq)]
pub struct Active {
    /// The condition, in the coordinates of the family's axes.
    pub point: Vec<f64>,
    /// The pole.
    pub pole: rotor::C64,
    /// What it is worth.
    pub value: f64,
}
