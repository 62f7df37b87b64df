//! The player: where in a recording we stand, how fast we move on, and what is made of the machine from there.

mod moment;
mod run_on;

use std::ops::Range;
use std::time::Instant;

use alarms::{Alarms, LevelChange, Limits};
use wire::Happening;

use crate::feed::Feed;
use crate::replay::ReplayError;
use crate::replay::branch::Branch;
use crate::replay::loaded_steps::LoadedSteps;
use crate::replay::machine::RecordedChange;
use crate::replay::{RecordedEvent, RecordingSource};
use crate::view_time::ViewTime;
use crate::what_if::WhatIf;

/// Speeds to choose from, in times the speed at which it was recorded.
pub(super) const SPEEDS: [f64; 13] = [0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// The place of 1 among them.
const AS_RECORDED: usize = 5;
/// Seconds of missing steps that are waited for as if they were there.
const SHORT: f64 = 0.1;

/// A part of the recording that is played over and over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopRange {
    /// None.
    Off,
    /// From here to an end that is not set yet.
    From(u64),
    /// Both ends are in it.
    Over(u64, u64),
}

/// See the module of replay.
pub struct Player {
    past: Box<dyn RecordingSource>,
    /// The numbers of the first step and the last.
    ends: [u64; 2],
    /// Steps a second when it was recorded.
    rate: f64,
    masses: usize,
    pub(super) events: Vec<RecordedEvent>,
    pub(super) missing: Vec<Range<u64>>,
    /// What alarms did, and how they stood where we stand: after so many of these turns.
    turns: Vec<LevelChange>,
    limits: Limits,
    pub(super) judged: bool,
    alarms: (usize, Alarms),
    /// What was done to the machine; gathered when it is first needed.
    acts: Option<Vec<(u64, RecordedChange)>>,
    pub(super) loaded: LoadedSteps,
    /// While paused there is more to be read in passing.
    reads_on: bool,
    /// The step we stand at, with the part of the next one that has passed.
    position: f64,
    /// While playing: when the clock was last looked at.
    ticked: Option<Instant>,
    speed: usize,
    pub(super) repeat: LoopRange,
    pub(super) branch: Option<Branch>,
}

impl Player {
    /// A player at the beginning of `past`, which fills `feed` and moves `time`.
    pub fn new(mut past: Box<dyn RecordingSource>, feed: &mut Feed, time: &mut ViewTime) -> Result<Self, ReplayError> {
        let Some([first, last]) = past.span() else { return Err(ReplayError::Empty) };
        let bench_status = past.bench_status_at(first.seq);
        let mut player = Self {
            ends: [first.seq, last.seq],
            rate: if bench_status.rate_hz > 0.0 { bench_status.rate_hz } else { 1000.0 },
            masses: bench_status.masses as usize,
            events: past.events(),
            missing: past.missing(),
            turns: past.turns(),
            limits: past.limits().unwrap_or_else(Limits::none),
            judged: past.limits().is_some(),
            alarms: (usize::MAX, Alarms::default()),
            acts: None,
            loaded: LoadedSteps::default(),
            reads_on: true,
            position: first.seq as f64,
            ticked: None,
            speed: AS_RECORDED,
            repeat: LoopRange::Off,
            branch: None,
            past,
        };
        // Units come with the first moment, changes with the settings around them.
        feed.set_present(bench_status);
        for event in &player.events {
            let is_change = event.happening() == Some(&Happening::Settings);
            let around = is_change
                .then(|| [event.at.seq.saturating_sub(1), event.at.seq].map(|seq| player.past.bench_status_at(seq)));
            let around = around.as_ref().map(|around| around.each_ref().map(|status| status.settings.get()));
            feed.push_past_event(event, around);
        }
        player.show(feed, time, true)?;
        Ok(player)
    }

    /// The number of the step we stand at.
    pub fn seq(&self) -> u64 {
        self.position as u64
    }

    /// The first step and the last.
    pub fn ends(&self) -> [u64; 2] {
        self.ends
    }

    /// Steps a second when it was recorded.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// What it is called.
    pub fn name(&self) -> String {
        self.past.name()
    }

    /// What is to be told about it.
    pub fn notices(&self) -> Vec<String> {
        self.past.notices()
    }

    /// How alarms stood at the moment.
    pub fn alarms(&self) -> &Alarms {
        &self.alarms.1
    }

    /// Whether it moves on by itself.
    pub fn is_playing(&self) -> bool {
        self.ticked.is_some()
    }

    /// Whether it has something to do soon: it plays, or reads on in passing.
    pub fn is_busy(&self) -> bool {
        self.is_playing() || self.reads_on || self.lags()
    }

    /// Whether the machine beside has not come as far as the moment.
    fn lags(&self) -> bool {
        self.branch.as_ref().is_some_and(|branch| branch.lag(self.seq()) > 0)
    }

    /// What the settings of the machine beside mean, if there is one.
    pub fn what_if(&self) -> Option<&WhatIf> {
        self.branch.as_ref().and_then(Branch::judged)
    }

    /// How fast, in times the speed at which it was recorded.
    pub fn speed(&self) -> f64 {
        SPEEDS[self.speed]
    }

    /// Plays, or pauses. From the end it plays again from the beginning.
    pub fn toggle(&mut self, feed: &mut Feed, time: &mut ViewTime, now: Instant) -> Result<(), ReplayError> {
        if self.ticked.take().is_some() {
            return Ok(());
        }
        self.ticked = Some(now);
        if self.seq() >= self.ends[1] && self.repeat == LoopRange::Off {
            return self.go(self.ends[0], feed, time);
        }
        Ok(())
    }

    /// Plays faster (1) or slower (-1), within [`SPEEDS`].
    pub fn change_speed(&mut self, by: isize) {
        self.speed = self.speed.saturating_add_signed(by).min(SPEEDS.len() - 1);
    }

    /// Lets time pass. Returns whether that shows.
    pub fn tick(&mut self, feed: &mut Feed, time: &mut ViewTime, now: Instant) -> Result<bool, ReplayError> {
        let Some(ticked) = self.ticked else {
            if self.lags() {
                return self.show(feed, time, false).map(|()| true);
            }
            self.fetch_in_passing(feed)?;
            return Ok(false);
        };
        let elapsed = now.saturating_duration_since(ticked).as_secs_f64();
        self.ticked = Some(now);
        self.play(elapsed * self.rate * self.speed(), feed, time)?;
        Ok(true)
    }

    /// Moves on by so many steps, as playing does: over what is missing, round the loop, and no further than the end.
    ///
    /// # Errors
    /// Steps that cannot be read.
    pub fn play(&mut self, steps: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        let before = self.seq();
        self.position += steps;
        let mut jumped = false;
        if let LoopRange::Over(from, to) = self.repeat {
            // The last step of all has no next one to wait for.
            let turn = (to + 1).min(self.ends[1]);
            if (before..=self.seq()).contains(&turn) && steps > 0.0 {
                self.position = from as f64 + (self.position - turn as f64) % (turn - from).max(1) as f64;
                jumped = true;
            }
        }
        // Where many steps are missing there is nothing to be seen.
        let here = self.seq();
        let gap = self.missing.get(self.missing.partition_point(|gap| gap.end <= here));
        if let Some(gap) = gap.filter(|gap| gap.contains(&here) && (gap.end - gap.start) as f64 > SHORT * self.rate) {
            self.position = gap.end as f64;
        }
        if self.position >= self.ends[1] as f64 {
            self.position = self.ends[1] as f64;
            self.ticked = None;
        }
        self.show(feed, time, jumped)
    }

    /// Moves by so many steps, and pauses.
    pub fn step(&mut self, by: i64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        self.ticked = None;
        self.position = self.held(self.seq().saturating_add_signed(by)) as f64;
        self.show(feed, time, false)
    }

    /// Moves by so many seconds of the recording; goes on playing if it plays.
    pub fn seek(&mut self, seconds: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        let to = (self.position + seconds * self.rate).max(0.0) as u64;
        self.position = self.held(to) as f64;
        self.show(feed, time, false)
    }

    /// Goes to a step; goes on playing if it plays.
    pub fn go(&mut self, seq: u64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        self.position = self.held(seq) as f64;
        self.show(feed, time, true)
    }

    /// Goes to the step that the feed holds at a place.
    pub fn go_to_index(&mut self, place: u64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        self.go(self.loaded.seq_of(place), feed, time)
    }

    /// Goes to where the rotor's time was `tau`.
    pub fn go_to_tau(&mut self, tau: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), ReplayError> {
        let seq = self.past.at_tau(tau)?;
        self.go(seq, feed, time)
    }

    fn held(&self, seq: u64) -> u64 {
        seq.clamp(self.ends[0], self.ends[1])
    }

    /// Goes to the step of the next event (1) or of the one before (-1), and says what happened there.
    pub fn go_to_event(&mut self, by: isize, feed: &mut Feed, time: &mut ViewTime) -> Result<String, ReplayError> {
        let (here, [first, last]) = (self.seq(), self.ends);
        let mut there = self.events.iter().filter(|event| (first..=last).contains(&event.at.seq));
        let found =
            if by > 0 { there.find(|event| event.at.seq > here) } else { there.rfind(|event| event.at.seq < here) };
        let Some(seq) = found.map(|event| event.at.seq) else {
            return Err(ReplayError::NoEvent { after: by > 0 });
        };
        self.go(seq, feed, time)?;
        // Several may have happened before one step.
        let all = self.events.iter().filter(|event| event.at.seq == seq);
        let units = feed.units();
        Ok(all.map(|event| event.words(&units)).collect::<Vec<_>>().join("; "))
    }

    /// Sets where the loop begins, then where it ends, then ends it; and says so.
    pub fn mark_loop(&mut self) -> &'static str {
        let here = self.seq();
        let (repeat, words) = match self.repeat {
            LoopRange::Off => (LoopRange::From(here), "loop begins here: again where it shall end"),
            LoopRange::From(from) if from == here => (LoopRange::Off, "no loop"),
            LoopRange::From(from) => {
                (LoopRange::Over(from.min(here), from.max(here)), "loop ends here: again for no loop")
            }
            LoopRange::Over(..) => (LoopRange::Off, "no loop"),
        };
        self.repeat = repeat;
        words
    }
}
