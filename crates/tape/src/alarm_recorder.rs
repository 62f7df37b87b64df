//! Alarms as the recorder sees them: what comes from the bench, held against the limits of whoever records.

use std::time::{Duration, Instant};

use alarms::{Alarms, LevelChange, Limits, Sampler, Watch};
use rotor::Rotor;
use wire::{BenchStatus, Event, Step};

/// How often what has come in is held against the limits. Peaks keep their own steps, however long that is.
const LOOK: Duration = Duration::from_millis(100);
/// One part in so many of the time may go into margins.
const SPARE: u32 = 50;

/// Judges one bench.
#[derive(Debug)]
pub(crate) struct AlarmRecorder {
    sampler: Sampler,
    alarms: Alarms,
    run_id: Option<u64>,
    looked: Option<Instant>,
    margins: MarginsInForce,
}

/// The margins of the loop in force: computed here, as a bench does not send them.
#[derive(Debug, Default)]
struct MarginsInForce {
    /// The run, the revision and the speed that they are of.
    of: Option<(u64, u64, f64)>,
    rotor: Option<Rotor>,
    /// The peak of the sensitivity, and the delay margin; none of a loop that is not stable.
    found: Option<(f64, Option<f64>)>,
    /// No sooner than this they are computed again.
    not_before: Option<Instant>,
}

impl MarginsInForce {
    /// Takes in the latest bench status. While the speed is on its way that may be asked for ten times a second: at most one part
    /// in [`SPARE`] of the time goes into it, however large the rotor.
    fn learn(&mut self, bench_status: &BenchStatus) {
        let speed = bench_status.analysis.speed;
        let of = (bench_status.run_id, bench_status.revision, speed);
        let begun = Instant::now();
        if self.of == Some(of) || self.not_before.is_some_and(|at| begun < at) {
            return;
        }
        if self.of.is_none_or(|(run_id, ..)| run_id != of.0) {
            self.rotor = None;
        }
        if self.rotor.is_none() {
            self.rotor = bench_status.rotor().ok();
        }
        (self.of, self.found) = (Some(of), None);
        let Some(rotor) = &self.rotor else { return };
        let found = machine::margins(rotor, bench_status.settings.get(), speed).ok();
        self.found = found.map(|found| (found.margins.sensitivity().amplitude, found.margins.delay.map(|d| d.delay)));
        self.not_before = Some(begun + begun.elapsed() * SPARE);
    }
}

impl AlarmRecorder {
    pub(crate) fn new(limits: Limits) -> Self {
        Self {
            sampler: Sampler::default(),
            alarms: Alarms::new(limits),
            run_id: None,
            looked: None,
            margins: MarginsInForce::default(),
        }
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
        self.alarms.learn(bench_status);
        let is_watched = |watch: Watch| self.alarms.limits().of(watch).is_some();
        if is_watched(Watch::Sensitivity) || is_watched(Watch::DelayMargin) {
            self.margins.learn(bench_status);
        }
    }

    /// What has gone past a limit or come back since this was last asked; at `None` whatever there is, else only now and
    /// then. Trips are not among it: they are events of the bench.
    pub(crate) fn turns(&mut self, now: Option<Instant>) -> Vec<LevelChange> {
        if let (Some(now), Some(looked)) = (now, self.looked)
            && now.saturating_duration_since(looked) < LOOK
        {
            return Vec::new();
        }
        self.looked = now;
        let mut reading = self.sampler.take();
        if let Some((sensitivity, delay)) = self.margins.found {
            reading.set_margins(sensitivity, delay);
        }
        let mut turns = self.alarms.read(&reading);
        turns.retain(|turn| turn.watch != Watch::Trip);
        turns
    }
}

#[cfg(test)]
mod tests {
    use alarms::Level;
    use wire::message::Trip;
    use wire::{Channel, State, StepLayout};

    use super::*;

    fn state(run_id: u64, seq: u64, radius: f64) -> State {
        let state = State::new(StepLayout::new(1)).with_word(Channel::RunId, run_id).with_word(Channel::Seq, seq);
        let state = state.with_word(Channel::WallNs, 200_000_000 * seq);
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
    fn the_loop_s_margins_are_judged_when_settings_change() {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let mut alarms = AlarmRecorder::new(Limits::default());
        let mut of = |revision: u64, feedback: &str| {
            let settings = rotor::Settings::new(&rotor, 6.0, rotor::builtin::feedback(&rotor, feedback).unwrap());
            let analysis = wire::message::Analysis { revision, speed: 6.0, ..Default::default() };
            let message = wire::message::BenchStatusMessage { run_id: 1, revision, analysis, ..Default::default() };
            let mut bench_status = BenchStatus::from(message);
            bench_status.set_rotor(&rotor);
            bench_status.settings = wire::SettingsDocument::of(&settings);
            alarms.margins.not_before = None;
            alarms.bench_status(&bench_status, 0);
            alarms.turns(None)
        };
        let turns = of(1, "composite");
        let [turn] = &turns[..] else { panic!("{turns:?}") };
        assert_eq!((turn.watch, turn.level, turn.limit), (Watch::Sensitivity, Level::Alarm, 5.0));
        assert!((turn.value - 10.3495).abs() < 1e-3, "{turn:?}");
        assert!(of(2, "off").is_empty(), "what is not stable has no margins: that is for its damping to say");
        let turns = of(3, "individual");
        assert!(turns.len() == 1 && turns[0].level == Level::Fine && turns[0].value < 1.2, "{turns:?}");
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
