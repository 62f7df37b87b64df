//! Everything that is known of a bench, or of a recording around one moment: the history of its steps, the last bench status, the
//! connection, a recorder, the events; and the part of it that one frame is drawn from ([`FrameData`]).

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use alarms::{Reading, Sampler};
use rotor::{ControlMasses, MAX_BEARINGS, Rotor, Settings};
use wire::message::Flags;
use wire::{BenchStatus, Event, Happening, RecorderStatus, SettingsDocument, Step, Text};

use crate::connection::Connection;
use crate::drill::{ActiveFault, DrillLog};
use crate::event_log::EventLog;
use crate::frame_data::FrameData;
use crate::history::{Era, History};
use crate::jobs::LoopRequest;
use crate::past::Past;
use crate::replay::RecordedEvent;
use crate::units::ScreenUnits;
use crate::view_time::ViewTime;

/// Steps before the cursor that a frame has in any case: all that an orbit shows.
const BEFORE: u64 = 10_240;
/// Events that are kept as they were sent.
const EVENTS: usize = 500;
/// Seconds that an overview shows at least.
const OVERVIEW: f64 = 60.0;

/// See the module. Its memory is bounded. The reader thread (or the player of a recording) writes it, the drawing thread takes the data of
/// one frame at a time.
#[derive(Debug)]
pub struct Feed {
    history: History,
    last_step_at: Option<Instant>,
    pace: Pace,
    sampler: Sampler,
    event_log: EventLog,
    /// As they were sent, the oldest first.
    events: VecDeque<Event>,
    drills: DrillLog,
    rotor: Option<Arc<Rotor>>,
    bench_status: Option<Arc<BenchStatus>>,
    connection: Connection,
    recorder: Option<Box<RecorderStatus>>,
    changes: u64,
}

impl Feed {
    /// An empty feed, and why it is empty.
    #[cfg(any(test, feature = "test-support"))]
    #[must_use]
    pub fn new(why: &str) -> Self {
        Self::with_bound(why, crate::history::BOUND)
    }

    /// An empty feed, and why it is empty; its steps take at most `bound` bytes.
    pub fn with_bound(why: &str, bound: usize) -> Self {
        Self {
            history: History::new(bound),
            last_step_at: None,
            pace: Pace::default(),
            sampler: Sampler::default(),
            event_log: EventLog::default(),
            events: VecDeque::new(),
            drills: DrillLog::default(),
            rotor: None,
            bench_status: None,
            connection: Connection::Waiting(why.to_owned()),
            recorder: None,
            changes: 0,
        }
    }

    /// Adds the newest step of a bench, which came at `now`.
    pub fn push_step(&mut self, state: &impl Step, now: Instant) {
        self.history.push(state);
        self.sampler.hear(state);
        self.last_step_at = Some(now);
        self.pace.count(now);
        self.connection = Connection::Live;
        self.changes += 1;
    }

    /// Adds the newest bench status, with the settings and poles that hold from its step on.
    pub fn push_bench_status(&mut self, bench_status: Box<BenchStatus>) {
        self.history.note_bench_status(&bench_status);
        self.sampler.learn(&bench_status, self.history.lost());
        if self.bench_status.as_ref().is_none_or(|last| last.run_id != bench_status.run_id) {
            self.rotor = self.history.newest_era().and_then(|era| era.rotor.clone());
        }
        self.bench_status = Some(Arc::from(bench_status));
        self.changes += 1;
    }

    /// Adds a step of a recording: no sign of life, no pace, no alarm comes of it.
    pub fn push_past_step(&mut self, state: &impl Step) {
        self.history.push(state);
        self.changes += 1;
    }

    /// Adds settings of a recording, for the steps that were made with them.
    pub fn note_past_settings(&mut self, bench_status: &BenchStatus) {
        self.history.note_bench_status(bench_status);
    }

    /// Forgets every step; the next one gets the index `first`.
    pub fn clear_steps(&mut self, first: u64) {
        self.history = self.history.emptied(first);
        self.changes += 1;
    }

    /// Sets what is in force at the moment of a recording that is looked at, in place of the present.
    pub fn set_present(&mut self, bench_status: Box<BenchStatus>) {
        if self.rotor.is_none() {
            self.rotor = bench_status.rotor().ok().map(Arc::new);
        }
        self.bench_status = Some(Arc::from(bench_status));
        self.connection = Connection::Live;
        self.changes += 1;
    }

    /// Sets what is known of a recorder.
    pub fn set_recorder(&mut self, status: Option<Box<RecorderStatus>>) {
        if self.recorder != status {
            self.recorder = status;
            self.changes += 1;
        }
    }

    /// The fault of a drill that is there, as far as the events tell.
    pub fn active_fault(&self) -> Option<&ActiveFault> {
        self.drills.active()
    }

    /// What is known of a recorder.
    pub fn recorder(&self) -> Option<&RecorderStatus> {
        self.recorder.as_deref()
    }

    /// Adds an event, if it is news.
    pub fn push_event(&mut self, event: &Event) {
        let is_news = self.event_log.push(event, &self.units());
        self.sampler.happen(event);
        self.drills.push(event);
        if is_news {
            if self.events.len() == EVENTS {
                self.events.pop_front();
            }
            self.events.push_back(event.clone());
        }
        if is_news && let Some(Happening::Note(_)) = event.happening() {
            self.history.note(event.run_id, event.seq);
        }
        self.changes += u64::from(is_news);
    }

    /// Adds an event of a recording; of a change with the settings before and after it.
    pub fn push_past_event(&mut self, event: &RecordedEvent, change: Option<[&Settings; 2]>) {
        let units = self.units();
        let told = change.map(|[before, after]| units.difference(before, after));
        self.event_log.push_past(event, told.filter(|told| !told.is_empty()), &units);
    }

    /// Sets whether the simulation is there and sends; what has come from it stays.
    pub fn set_connection(&mut self, connection: Connection) {
        if self.connection != connection {
            self.connection = connection;
            self.changes += 1;
        }
    }

    /// Has the largest force count from the newest step on.
    pub fn reset_peak(&mut self) {
        self.history.reset_peak();
        self.changes += 1;
    }

    /// Takes what is to be held against the alarms' limits: the worst of all that has come since this was last asked.
    pub fn take_alarm_reading(&mut self) -> Reading {
        self.sampler.take()
    }

    /// The last `seconds` of the present run before its step `before`, as far as they are kept; `None` while the step before that one
    /// has not come, and where nothing is kept.
    pub fn past(&self, seconds: f64, before: u64) -> Option<Past> {
        let mut bench_status = Box::new(BenchStatus::clone(self.bench_status.as_ref()?));
        let newest = self.history.track(&self.history.kept());
        let newest_ns = newest.wall_ns(newest.len().checked_sub(1)?);
        let since_ns = newest_ns.saturating_sub((seconds * 1e9) as u64);
        let steps = self.history.past_steps(since_ns, before)?;
        // What was in force then; the rest of the picture is that of now.
        let era = self.history.era_at(steps.first_place())?;
        if era.revision != bench_status.revision {
            bench_status.settings = SettingsDocument::of(&era.settings);
            bench_status.revision = era.revision;
            bench_status.changed_by = Text::new(&era.who);
            bench_status.applied_at_step = steps.first_seq();
        }
        let run_id = bench_status.run_id;
        let events = self.events.iter().filter(|event| event.run_id == run_id && event.seq < before).cloned().collect();
        Some(Past { bench_status, events, steps })
    }

    /// What to ask about the margins of the loop in force, at the speed that was told last; nothing before the first step.
    pub fn loop_request(&self) -> Option<LoopRequest> {
        self.last_step_at?;
        LoopRequest::of(self.history.newest_era()?)
    }

    /// When the last state came.
    pub fn last_step_at(&self) -> Option<Instant> {
        self.last_step_at
    }

    /// Whether the simulation is there and sends.
    pub fn connection(&self) -> &Connection {
        &self.connection
    }

    /// The latest bench status, once there is one.
    pub fn bench_status(&self) -> Option<&Arc<BenchStatus>> {
        self.bench_status.as_ref()
    }

    /// The settings in force, once they are known.
    pub fn settings(&self) -> Option<Settings> {
        self.bench_status.as_ref().map(|bench_status| bench_status.settings.get().clone())
    }

    /// The rotor, once it is known.
    pub fn rotor(&self) -> Option<Arc<Rotor>> {
        self.rotor.clone()
    }

    /// The units that settings are typed and shown in.
    pub fn units(&self) -> ScreenUnits {
        let Some(bench_status) = &self.bench_status else { return ScreenUnits::DIMENSIONLESS };
        let feedback = &bench_status.settings.get().feedback;
        let masses = self.rotor.as_ref().map(|rotor| ControlMasses::of(rotor, feedback));
        ScreenUnits::of(bench_status.scales(), masses.unwrap_or_default())
    }

    /// The steps that are kept, with the settings they were made under.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Seconds from step to step, as the simulation means it; 0 while unknown.
    pub fn step_seconds(&self) -> f64 {
        self.bench_status
            .as_ref()
            .map(|bench_status| bench_status.rate_hz)
            .filter(|rate| *rate > 0.0)
            .map_or(0.0, f64::recip)
    }

    /// Rises with everything that is added: a frame of the same count shows nothing new.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// An era with the poles at the speed of the step that is looked at, where that is on its way to the one that is set.
    fn at_speed(&self, era: Arc<Era>, speed: Option<f64>, coasts: bool) -> Arc<Era> {
        let Some(speed) = speed.filter(|speed| *speed != era.speed && !era.poles.is_empty()) else { return era };
        // A step that came before its bench status, or after it, at a speed that is set at once, is no ramp.
        if !(coasts || era.settings.ramp.is_finite() || era.speed != era.settings.speed) {
            return era;
        }
        era.at_speed(speed).map_or(era, Arc::new)
    }

    /// What one frame shows. Shares the steps with the history, copies little.
    pub fn frame_data(&self, time: &ViewTime, now: Instant) -> FrameData {
        let (kept, seconds) = (self.history.kept(), self.step_seconds());
        let view = time.resolve(&kept, seconds);
        let minute = ViewTime::steps_of(OVERVIEW, seconds);
        let overview = view.window.start.min(view.window.end.saturating_sub(minute))..view.window.end;
        let before = view.now.map_or(kept.end, |now| now.saturating_sub(BEFORE));
        let overview = overview.start.max(kept.start)..overview.end;
        let around = overview.start.min(before).max(kept.start)..view.window.end;
        let place = |place: u64| (place - around.start) as usize;
        let era = |at: u64| if time.is_live() { self.history.newest_era() } else { self.history.era_at(at) };
        let whole = self.history.track(&kept);
        let track = whole.part(&around);
        // When another machine takes the name, its bench status and its steps do not come at the same moment.
        let masses = track.masses();
        let fits = |era: &Arc<Era>| masses == 0 || era.settings.deadband.len() == masses;
        let era_now = view.now.map_or_else(|| self.history.newest_era(), era).filter(|era| fits(era)).cloned();
        let speed = view.now.map(|now| track.speed(place(now)));
        let coasts = view.now.is_some_and(|now| track.flags(place(now)).has(Flags::COASTING));
        FrameData {
            era: era_now.map(|era| self.at_speed(era, speed, coasts)),
            track,
            kept: whole,
            window: place(view.window.start)..place(view.window.end),
            overview: place(overview.start)..place(overview.end),
            now: view.now.map(place),
            eras: (self.history.eras(&overview).into_iter())
                .filter(|(_, era)| fits(era))
                .map(|(at, era)| (place(at), era))
                .collect(),
            marks: self.history.marks(&overview).map(|(at, mark)| (place(*at), mark.clone())).collect(),
            peak_forces: view.now.map_or([0.0; MAX_BEARINGS], |now| self.history.peak_forces(now)),
            seconds,
            settings: self.settings(),
            rotor: self.rotor.clone(),
            bench_status: self.bench_status.clone(),
            events: self.event_log.entries(),
            lost: self.history.lost(),
            rate: self.pace.rate(now),
            age: self.last_step_at.map(|heard| now.saturating_duration_since(heard)),
            connection: self.connection.clone(),
            recorder: self.recorder.clone(),
            recorder_starts: false,
            tripped: self.history.is_tripped(),
            behind: view.now.map_or(0, |now| kept.end - 1 - now),
        }
    }
}

/// Steps a second, over the last second or so.
#[derive(Debug, Default)]
struct Pace {
    window: Option<(Instant, u32)>,
    rate: f64,
}

impl Pace {
    fn count(&mut self, now: Instant) {
        let (since, count) = *self.window.get_or_insert((now, 0));
        let elapsed = now.saturating_duration_since(since).as_secs_f64();
        if elapsed >= 1.0 {
            self.rate = f64::from(count) / elapsed;
            self.window = Some((now, 1));
        } else {
            self.window = Some((since, count + 1));
        }
    }

    fn rate(&self, now: Instant) -> f64 {
        match self.window {
            Some((since, _)) if now.saturating_duration_since(since).as_secs_f64() < 2.0 => self.rate,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use wire::Channel;

    use super::*;
    use crate::test_support::{bench_status, frame_data, state};

    #[test]
    fn a_live_picture_shows_the_newest_steps_and_says_how_things_stand() {
        let data = frame_data();
        assert_eq!((data.window.clone(), data.now, data.behind), (0..3000, Some(2999), 0));
        assert_eq!((data.masses(), data.lost, data.tripped), (3, 0, false));
        assert_eq!((data.connection.clone(), data.seconds), (Connection::Live, 1e-3));
        assert_eq!(data.track.force(2999), state(3, 2999).force_delivered());
        assert_eq!(data.least_damping(&data.overview), data.era.as_ref().map(|era| era.min_damping));
    }

    #[test]
    fn a_picture_of_the_past_is_whole_while_settings_stay_live() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.push_bench_status(bench_status("three-mass", "composite"));
        (0..70_000).for_each(|seq| feed.push_step(&state(3, seq), now));
        let mut off = bench_status("three-mass", "off");
        off.revision = 2;
        feed.push_bench_status(off);
        (70_000..90_000).for_each(|seq| feed.push_step(&state(3, seq).with_word(Channel::Revision, 2), now));
        let mut time = ViewTime::default();
        time.look_at(69_990, &feed.history().kept(), feed.step_seconds());
        let past = feed.frame_data(&time, now);
        assert_eq!(past.now.map(|now| past.track.tau(now)), Some(699.9));
        assert_eq!(past.behind, 90_000 - 1 - 69_990);
        assert_eq!(past.window.len(), 4000);
        assert_eq!(past.overview.len(), 60_000);
        assert_eq!(past.era.as_ref().map(|era| era.revision), Some(1));
        let then = past.poles().unwrap().0;
        let live = feed.frame_data(&ViewTime::default(), now);
        assert!(then > 0.0 && live.poles().unwrap().0 < 0.0);
        assert_eq!(past.settings, live.settings, "what can be changed is what is in force now");
        assert_eq!(live.least_damping(&live.overview), live.poles().map(|(least, _)| least), "the least of both");
        assert_eq!(live.eras.len(), 2);
    }
}
