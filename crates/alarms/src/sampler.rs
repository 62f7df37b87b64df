//! Takes readings from what comes in: the worst of all steps since the last reading, so that no peak falls between two, and
//! shares over the last ten seconds.

use std::collections::VecDeque;

use rotor::{ControlMasses, MAX_BEARINGS};
use wire::message::Flags;
use wire::{BenchStatus, Event, Moment, Step};

use crate::{Reading, Sample, Watch};

/// Over how long shares and losses are counted, in nanoseconds.
const WINDOW_NS: u64 = 10_000_000_000;
/// Least time between two counts within the window.
const COUNT_NS: u64 = 250_000_000;

/// What has come in since the last reading.
#[derive(Clone, Debug, Default)]
pub struct Sampler {
    run_id: u64,
    last: Moment,
    orbit: Option<Sample>,
    /// Of every control bearing, as that of the first.
    forces: [Option<Sample>; MAX_BEARINGS],
    masses: ControlMasses,
    steps: u64,
    saturated: u64,
    counts: VecDeque<Counts>,
    damping: Option<Sample>,
    trip: Option<String>,
    /// The last change of settings that was heard of: its run, its revision, and from when on it held.
    changed: Option<(u64, u64, Moment)>,
    /// The revision of the last analysis that was heard of.
    analysed: Option<u64>,
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

impl Sampler {
    /// Takes in one step. A new run starts anew.
    pub fn hear(&mut self, state: &impl Step) {
        self.follow(state.run_id());
        self.last = state.into();
        self.steps += 1;
        self.saturated += u64::from(state.flags().has(Flags::SATURATED));
        let radius = state.largest_radius();
        let at = self.last;
        let worst = |kept: &mut Option<Sample>, value: f64| {
            if kept.is_none_or(|kept| value > kept.value) {
                *kept = Some(Sample { value, at });
            }
        };
        worst(&mut self.orbit, radius);
        for (bearing, kept) in self.forces.iter_mut().take(state.bearings()).enumerate() {
            let [y, z] = state.force(bearing)[1];
            worst(kept, self.masses.as_of_first(bearing, y.hypot(z)));
        }
    }

    /// Takes in an event: from which step on which settings hold.
    pub fn happen(&mut self, event: &Event) {
        if self.changed.is_none_or(|(run, revision, _)| run != event.run_id || revision < event.revision) {
            self.changed = Some((event.run_id, event.revision, event.into()));
        }
    }

    /// Takes in a bench status, and how many steps have been lost to us so far.
    pub fn learn(&mut self, bench_status: &BenchStatus, lost: u64) {
        self.follow(bench_status.run_id);
        self.last.wall_ns = self.last.wall_ns.max(bench_status.wall_ns);
        if let Some(rotor) = bench_status.rotor_document() {
            self.masses = ControlMasses::of(rotor.get(), &bench_status.settings.get().feedback);
        }
        let analysis = &bench_status.analysis;
        if analysis.count == 0 || self.damping.is_none_or(|known| known.value != analysis.min_damping) {
            // While the speed is on its way damping changes without anybody's doing.
            let is_new = self.analysed.replace(analysis.revision) != Some(analysis.revision);
            let here = self
                .changed
                .filter(|(run, revision, _)| is_new && (*run, *revision) == (self.run_id, analysis.revision));
            let at = here.map_or(self.last, |(.., at)| at);
            self.damping = (analysis.count > 0).then_some(Sample { value: analysis.min_damping, at });
        }
        let trip = &bench_status.trip;
        self.trip = Some(if trip.is_tripped() { trip.told(bench_status.scales()) } else { String::new() });
        let health = &bench_status.health;
        let counts = Counts {
            wall_ns: bench_status.wall_ns,
            lost,
            steps: health.steps,
            late: health.late,
            missed: health.missed,
        };
        if self.counts.back().is_none_or(|last| counts.wall_ns >= last.wall_ns + COUNT_NS) {
            self.counts.push_back(counts);
        }
        // One beyond the window stays: the window is what has come since it.
        while self.counts.get(1).is_some_and(|second| second.wall_ns + WINDOW_NS < counts.wall_ns) {
            self.counts.pop_front();
        }
    }

    fn follow(&mut self, run_id: u64) {
        if run_id != self.run_id {
            *self = Self { run_id, changed: self.changed, masses: self.masses, ..Self::default() };
        }
    }

    /// What is to be held against the limits now; what follows is another reading.
    pub fn take(&mut self) -> Reading {
        let at = self.last;
        let mut reading = Reading::new(at);
        let sample = |value: f64| Some(Sample { value, at });
        reading.set(Watch::Damping, self.damping);
        reading.set(Watch::Orbit, self.orbit.take());
        reading.set_forces(std::mem::take(&mut self.forces));
        if self.steps > 0 {
            reading.set(Watch::Saturation, sample(self.saturated as f64 / self.steps as f64));
        }
        (self.steps, self.saturated) = (0, 0);
        if let (Some(first), Some(last)) = (self.counts.front(), self.counts.back()) {
            reading.set(Watch::Losses, sample(last.lost.saturating_sub(first.lost) as f64));
            let missed = last.missed.saturating_sub(first.missed);
            let due = last.steps.saturating_sub(first.steps) + missed;
            let late = last.late.saturating_sub(first.late) + missed;
            if due > 0 {
                reading.set(Watch::Lateness, sample(late as f64 / due as f64));
            }
        }
        match &self.trip {
            Some(cause) => reading.tripped(cause),
            None => reading,
        }
    }
}

#[cfg(test)]
mod tests {
    use wire::message::{Analysis, Trip};
    use wire::{Channel, State, StepLayout};

    use super::*;

    fn state(seq: u64) -> State {
        let state = State::new(StepLayout::new(3)).with_word(Channel::RunId, 7).with_word(Channel::Seq, seq);
        state.with(Channel::Tau, 0, seq as f64 / 100.0).with(Channel::Y, 1, 2.5)
    }

    fn bench_status() -> Box<BenchStatus> {
        Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
            run_id: 7,
            ..wire::message::BenchStatusMessage::default()
        }))
    }

    fn value(reading: &Reading, watch: Watch) -> Option<f64> {
        reading.get(watch).map(|sample| sample.value)
    }

    #[test]
    fn no_peak_falls_between_two_readings_and_its_step_is_known() {
        let mut sampler = Sampler::default();
        for seq in 0..100 {
            let mut state = state(seq);
            if seq == 42 {
                state = state.with(Channel::Y, 1, 900.0).with_flags(Flags::SATURATED);
                state.row_mut().set_pair([Channel::ForceY, Channel::ForceZ], 0, [-30.0, 40.0]);
            }
            sampler.hear(&state);
        }
        let reading = sampler.take();
        let at = Moment { seq: 42, tau: 0.42, wall_ns: 0 };
        assert_eq!(reading.get(Watch::Orbit), Some(Sample { value: 900.0, at }));
        assert_eq!(reading.get(Watch::Force), Some(Sample { value: 50.0, at }));
        assert_eq!((value(&reading, Watch::Saturation), reading.at.seq), (Some(0.01), 99));
        sampler.hear(&state(100));
        let after = sampler.take();
        assert_eq!((value(&after, Watch::Orbit), value(&after, Watch::Saturation)), (Some(2.5), Some(0.0)));
        assert_eq!(sampler.take().get(Watch::Orbit), None, "nothing heard is nothing known");
    }

    #[test]
    fn shares_and_losses_are_of_the_last_ten_seconds() {
        let mut sampler = Sampler::default();
        let mut learn = |second: u64, late: u64, missed: u64, lost: u64| {
            let mut bench_status = bench_status();
            bench_status.wall_ns = second * 1_000_000_000;
            (bench_status.health.steps, bench_status.health.late, bench_status.health.missed) =
                (1000 * second, late, missed);
            sampler.learn(&bench_status, lost);
            let reading = sampler.take();
            (value(&reading, Watch::Lateness), value(&reading, Watch::Losses))
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
        let mut sampler = Sampler::default();
        let mut bench_status = bench_status();
        bench_status.trip = Trip { cause: 1, mass: 2, step: 9, radius: 1000.5, limit: 1000.0 };
        sampler.learn(&bench_status, 0);
        let reading = sampler.take();
        assert!(reading.cause.starts_with("orbit of mass 2 reached 1000.5"), "{}", reading.cause);
        assert_eq!(value(&reading, Watch::Trip), Some(1.0));
        sampler.hear(&state(0).with_word(Channel::RunId, 8));
        assert_eq!(sampler.take().get(Watch::Trip), None);
    }

    #[test]
    fn damping_is_of_the_step_from_which_its_settings_hold() {
        let mut sampler = Sampler::default();
        sampler.hear(&state(500));
        let mut bench_status = bench_status();
        bench_status.analysis = Analysis { revision: 3, count: 6, min_damping: 0.05, ..Analysis::default() };
        sampler.learn(&bench_status, 0);
        assert_eq!(sampler.take().get(Watch::Damping), Some(Sample { value: 0.05, at: (&state(500)).into() }));
        sampler.happen(&Event::from(wire::EventMessage {
            run_id: 7,
            seq: 510,
            tau: 5.1,
            revision: 4,
            ..wire::EventMessage::default()
        }));
        sampler.happen(&Event::from(wire::EventMessage {
            run_id: 7,
            seq: 530,
            tau: 5.3,
            revision: 4,
            ..wire::EventMessage::default()
        }));
        sampler.hear(&state(560));
        bench_status.analysis = Analysis { revision: 4, count: 6, min_damping: -0.01, ..Analysis::default() };
        sampler.learn(&bench_status, 0);
        sampler.hear(&state(600));
        sampler.learn(&bench_status, 0);
        let at = Moment { seq: 510, tau: 5.1, wall_ns: 0 };
        assert_eq!(sampler.take().get(Watch::Damping), Some(Sample { value: -0.01, at }));
    }
}
