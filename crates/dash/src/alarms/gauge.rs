//! Takes the readings of the alarms from what comes in: the worst of all steps since the last reading, so that no peak
//! falls between two frames, and shares over the last ten seconds.

use std::collections::VecDeque;

use wire::message::{Flags, Trip};
use wire::{Bulletin, State};

use super::Reading;

/// Over how long shares and losses are counted, in nanoseconds.
const WINDOW_NS: u64 = 10_000_000_000;
/// Least time between two counts within the window.
const COUNT_NS: u64 = 250_000_000;

/// What has come in since the last reading.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gauge {
    run_id: u64,
    wall_ns: u64,
    orbit: Option<f64>,
    force: Option<f64>,
    steps: u64,
    saturated: u64,
    counts: VecDeque<Counts>,
    damping: Option<f64>,
    trip: Option<String>,
}

/// Counters at one moment.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    wall_ns: u64,
    lost: u64,
    steps: u64,
    late: u64,
    missed: u64,
}

impl Gauge {
    /// Takes in one step. A new run starts anew.
    pub(crate) fn hear(&mut self, state: &State) {
        if state.run_id != self.run_id {
            *self = Self { run_id: state.run_id, ..Self::default() };
        }
        self.wall_ns = state.wall_ns;
        self.steps += 1;
        self.saturated += u64::from(state.flags.has(Flags::SATURATED));
        let [y, z] = state.force_delivered;
        let radius = state.points().iter().map(wire::message::Point::radius).fold(0.0, f64::max);
        self.orbit = Some(self.orbit.unwrap_or(0.0).max(radius));
        self.force = Some(self.force.unwrap_or(0.0).max(y.hypot(z)));
    }

    /// Takes in a bulletin, and how many steps have been lost to us so far.
    pub(crate) fn learn(&mut self, bulletin: &Bulletin, lost: u64) {
        if bulletin.run_id != self.run_id {
            *self = Self { run_id: bulletin.run_id, ..Self::default() };
        }
        self.wall_ns = self.wall_ns.max(bulletin.wall_ns);
        self.damping = (bulletin.analysis.count > 0).then_some(bulletin.analysis.min_damping);
        let trip: &Trip = &bulletin.trip;
        self.trip = Some(if trip.is_tripped() { trip.to_string() } else { String::new() });
        let health = &bulletin.health;
        let counts =
            Counts { wall_ns: bulletin.wall_ns, lost, steps: health.steps, late: health.late, missed: health.missed };
        if self.counts.back().is_none_or(|last| counts.wall_ns >= last.wall_ns + COUNT_NS) {
            self.counts.push_back(counts);
        }
        // One beyond the window stays: the window is what has come since it.
        while self.counts.get(1).is_some_and(|second| second.wall_ns + WINDOW_NS < counts.wall_ns) {
            self.counts.pop_front();
        }
    }

    /// What is to be held against the limits now; what follows is another reading.
    pub(crate) fn take(&mut self) -> Reading {
        let mut reading = Reading {
            wall_ns: self.wall_ns,
            damping: self.damping,
            orbit: self.orbit.take(),
            force: self.force.take(),
            saturation: (self.steps > 0).then(|| self.saturated as f64 / self.steps as f64),
            trip: self.trip.clone(),
            ..Reading::default()
        };
        (self.steps, self.saturated) = (0, 0);
        if let (Some(first), Some(last)) = (self.counts.front(), self.counts.back()) {
            reading.losses = Some(last.lost.saturating_sub(first.lost) as f64);
            let missed = last.missed.saturating_sub(first.missed);
            let due = last.steps.saturating_sub(first.steps) + missed;
            let late = last.late.saturating_sub(first.late) + missed;
            reading.lateness = (due > 0).then(|| late as f64 / due as f64);
        }
        reading
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;

    #[test]
    fn no_peak_falls_between_two_readings() {
        let mut gauge = Gauge::default();
        for seq in 0..100 {
            let mut state = tests::state(3, seq);
            if seq == 42 {
                state.masses[1].y = 900.0;
                state.force_delivered = [-30.0, 40.0];
                state.flags = Flags::SATURATED;
            }
            gauge.hear(&state);
        }
        let reading = gauge.take();
        assert_eq!((reading.orbit.unwrap().round(), reading.force), (900.0, Some(50.0)));
        assert_eq!(reading.saturation, Some(0.01));
        gauge.hear(&tests::state(3, 100));
        let after = gauge.take();
        assert!(after.orbit.unwrap() < 5.0 && after.saturation == Some(0.0));
        assert_eq!(gauge.take().orbit, None, "nothing heard is nothing known");
    }

    #[test]
    fn shares_and_losses_are_of_the_last_ten_seconds() {
        let mut gauge = Gauge::default();
        let mut learn = |second: u64, late: u64, missed: u64, lost: u64| {
            let mut bulletin = tests::bulletin("three-mass", "composite");
            bulletin.wall_ns = second * 1_000_000_000;
            (bulletin.health.steps, bulletin.health.late, bulletin.health.missed) = (1000 * second, late, missed);
            gauge.learn(&bulletin, lost);
            let reading = gauge.take();
            (reading.lateness, reading.losses)
        };
        assert_eq!(learn(100, 50, 7, 3), (None, Some(0.0)), "what was before we came is not ours");
        assert_eq!(learn(101, 150, 7, 3), (Some(0.1), Some(0.0)));
        assert_eq!(learn(102, 150, 1007, 8), (Some(1100.0 / 3000.0), Some(5.0)));
        for second in 103..=112 {
            learn(second, 150, 1007, 8);
        }
        assert_eq!(learn(113, 150, 1007, 8), (Some(0.0), Some(0.0)));
    }

    #[test]
    fn a_trip_brings_its_cause_and_a_new_run_starts_anew() {
        let mut gauge = Gauge::default();
        let mut bulletin = tests::bulletin("three-mass", "off");
        bulletin.trip = Trip { cause: 1, mass: 2, step: 9, radius: 1000.5, limit: 1000.0 };
        gauge.learn(&bulletin, 0);
        let cause = gauge.take().trip.unwrap();
        assert!(cause.starts_with("orbit of mass 2 reached 1000.5"), "{cause}");
        gauge.hear(&State { run_id: 8, ..tests::state(3, 0) });
        assert_eq!(gauge.take().trip, None);
    }
}
