//! Alarms as the recorder sees them: what comes from the bench, held against the limits of whoever records.

use std::time::{Duration, Instant};

use alarms::{Alarms, Limits, Sampler, Turn, Watch};
use wire::{BenchStatus, Event, Step};

/// How often what has come in is held against the limits. Peaks keep their own steps, however long that is.
const LOOK: Duration = Duration::from_millis(100);

/// Judges one bench.
#[derive(Debug)]
pub(crate) struct AlarmRecorder {
    sampler: Sampler,
    alarms: Alarms,
    run_id: Option<u64>,
    looked: Option<Instant>,
}

impl AlarmRecorder {
    pub(crate) fn new(limits: Limits) -> Self {
        Self { sampler: Sampler::default(), alarms: Alarms::new(limits), run_id: None, looked: None }
    }

    /// Takes in one step. A new run knows nothing of the alarms of the one before it.
    pub(crate) fn state(&mut self, state: &impl Step) {
        if self.run_id.replace(state.run_id()).is_some_and(|before| before != state.run_id()) {
            self.alarms = Alarms::new(self.alarms.limits().clone());
        }
        self.sampler.hear(state);
    }

    /// Takes in an event.
    pub(crate) fn event(&mut self, event: &Event) {
        self.sampler.happen(event);
    }

    /// Takes in the latest bench status, and how many steps have been lost so far.
    pub(crate) fn bench_status(&mut self, bench_status: &BenchStatus, lost: u64) {
        self.sampler.learn(bench_status, lost);
    }

    /// What has gone past a limit or come back since this was last asked; at `None` whatever there is, else only now and
    /// then. Trips are not among it: they are events of the bench.
    pub(crate) fn turns(&mut self, now: Option<Instant>) -> Vec<Turn> {
        if let (Some(now), Some(looked)) = (now, self.looked)
            && now.saturating_duration_since(looked) < LOOK
        {
            return Vec::new();
        }
        self.looked = now;
        let mut turns = self.alarms.read(&self.sampler.take());
        turns.retain(|turn| turn.watch != Watch::Trip);
        turns
    }
}

#[cfg(test)]
mod tests {
    use alarms::Level;
    use wire::message::Trip;
    use wire::{Channel, Layout, State};

    use super::*;

    fn state(run_id: u64, seq: u64, radius: f64) -> State {
        let state = State::new(Layout::new(1)).with_word(Channel::RunId, run_id).with_word(Channel::Seq, seq);
        state.with(Channel::Tau, 0, seq as f64 / 100.0).with(Channel::Y, 0, radius)
    }

    #[test]
    fn a_peak_is_judged_with_its_step_and_a_new_run_anew() {
        let mut limits = Limits::none();
        limits.set(Watch::Orbit, Some([2.0, 3.0])).unwrap();
        let mut alarms = AlarmRecorder::new(limits);
        for seq in 0..50 {
            alarms.state(&state(1, seq, if seq == 17 { 2.5 } else { 1.0 }));
        }
        let now = Instant::now();
        let turns = alarms.turns(Some(now));
        let told: Vec<_> = turns.iter().map(|turn| (turn.at.seq, turn.level, turn.value, turn.limit)).collect();
        assert_eq!(told, [(17, Level::Warning, 2.5, 2.0)]);
        alarms.state(&state(1, 50, 1.0));
        assert!(alarms.turns(Some(now + LOOK / 2)).is_empty(), "not yet");
        assert_eq!(alarms.turns(None)[0].level, Level::Fine);
        alarms.state(&state(1, 51, 9.0));
        assert_eq!(alarms.turns(None).len(), 1);
        alarms.state(&state(2, 0, 9.0));
        let anew = alarms.turns(None);
        assert_eq!((anew.len(), anew[0].before), (1, Level::Fine));
    }

    #[test]
    fn a_trip_is_an_event_and_not_told_twice() {
        let mut alarms = AlarmRecorder::new(Limits::none());
        let trip = Trip { cause: 1, mass: 1, step: 5, radius: 7.0, limit: 6.0 };
        alarms.bench_status(
            &BenchStatus::from(wire::message::BenchStatusMessage {
                trip,
                ..wire::message::BenchStatusMessage::default()
            }),
            0,
        );
        assert!(alarms.turns(None).is_empty());
    }
}
