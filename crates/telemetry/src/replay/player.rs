//! The player: where in a recording we stand, how fast we move on, and what is made of the machine from there.

use std::ops::Range;
use std::time::Instant;

use alarms::{Alarms, Level, Limits, Turn, Watch};
use rotor::Settings;
use wire::{BenchStatus, Happening, SettingsDocument, State, Step};

use super::branch::Branch;
use super::loaded_steps::LoadedSteps;
use super::machine::{BranchPoint, Line, RecordedChange};
use super::{RecordedEvent, RecordingSource};
use crate::edits::Edit;
use crate::feed::Feed;
use crate::view_time::ViewTime;
use crate::what_if::WhatIf;

/// Speeds to choose from, in times the speed at which it was recorded.
pub(super) const SPEEDS: [f64; 13] = [0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// The place of 1 among them.
const AS_RECORDED: usize = 5;
/// Seconds before the moment that are at hand: what the longest panel shows.
const LOOK_BACK: f64 = 61.0;
/// Steps before the moment that are at hand at least, and at most.
const BACK: [u64; 2] = [10_500, 250_000];
/// Seconds of missing steps that are waited for as if they were there.
const SHORT: f64 = 0.1;
/// Steps that are fetched ahead at once.
const AHEAD: u64 = 2_000;
/// Steps that are fetched in passing, while there is nothing else to do.
const IN_PASSING: u64 = 10_000;

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

/// See the module.
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
    turns: Vec<Turn>,
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
    pub fn new(mut past: Box<dyn RecordingSource>, feed: &mut Feed, time: &mut ViewTime) -> Result<Self, String> {
        let Some([first, last]) = past.span() else { return Err("there are no steps in it".into()) };
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
        player.events.iter().for_each(|event| feed.push_past_event(event));
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
    pub fn toggle(&mut self, feed: &mut Feed, time: &mut ViewTime, now: Instant) -> Result<(), String> {
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
    pub fn tick(&mut self, feed: &mut Feed, time: &mut ViewTime, now: Instant) -> Result<bool, String> {
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
    pub fn play(&mut self, steps: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
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
    pub fn step(&mut self, by: i64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
        self.ticked = None;
        self.position = self.held(self.seq().saturating_add_signed(by)) as f64;
        self.show(feed, time, false)
    }

    /// Moves by so many seconds of the recording; goes on playing if it plays.
    pub fn seek(&mut self, seconds: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
        let to = (self.position + seconds * self.rate).max(0.0) as u64;
        self.position = self.held(to) as f64;
        self.show(feed, time, false)
    }

    /// Goes to a step; goes on playing if it plays.
    pub fn go(&mut self, seq: u64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
        self.position = self.held(seq) as f64;
        self.show(feed, time, true)
    }

    /// Goes to the step that the feed holds at a place.
    pub fn go_to_index(&mut self, place: u64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
        self.go(self.loaded.seq_of(place), feed, time)
    }

    /// Goes to where the rotor's time was `tau`.
    pub fn go_to_tau(&mut self, tau: f64, feed: &mut Feed, time: &mut ViewTime) -> Result<(), String> {
        let seq = self.past.at_tau(tau)?;
        self.go(seq, feed, time)
    }

    fn held(&self, seq: u64) -> u64 {
        seq.clamp(self.ends[0], self.ends[1])
    }

    /// Goes to the step of the next event (1) or of the one before (-1), and says what happened there.
    pub fn go_to_event(&mut self, by: isize, feed: &mut Feed, time: &mut ViewTime) -> Result<String, String> {
        let (here, [first, last]) = (self.seq(), self.ends);
        let mut there = self.events.iter().filter(|event| (first..=last).contains(&event.at.seq));
        let found =
            if by > 0 { there.find(|event| event.at.seq > here) } else { there.rfind(|event| event.at.seq < here) };
        let Some(seq) = found.map(|event| event.at.seq) else {
            return Err(format!("no event {} this", if by > 0 { "after" } else { "before" }));
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

    /// Sees to it that the feed has the steps around the moment, and that everything shows that moment.
    fn show(&mut self, feed: &mut Feed, time: &mut ViewTime, jumped: bool) -> Result<(), String> {
        let seq = self.seq();
        let back = (LOOK_BACK * self.rate) as u64;
        let back = back.max(time.steps(1.0 / self.rate)).clamp(BACK[0], BACK[1]);
        // What comes ahead needs room too.
        let back = back.min(feed.history().capacity_for(self.masses) / 2);
        self.loaded.let_go(feed);
        let wanted = seq.saturating_sub(back).max(self.ends[0])..seq + 1;
        if !(self.loaded.range().contains(&wanted.start) && self.loaded.range().end > seq) {
            let wanted = wanted.start..(wanted.end + AHEAD).min(self.ends[1] + 1);
            self.loaded.cover(&mut *self.past, feed, &wanted)?;
            self.reads_on = true;
        }
        if let Some(place) = self.loaded.index_of(seq) {
            let kept = feed.history().kept();
            if jumped {
                time.jump_to(place.clamp(kept.start, kept.end.saturating_sub(1)));
            } else {
                time.look_at(place, &kept, 1.0 / self.rate);
            }
        }
        let mut bench_status = self.past.bench_status_at(seq);
        if self.branch.is_some() {
            let acts = self.gathered();
            if let Some(branch) = &mut self.branch {
                branch.advance(wanted.start..seq + 1, &acts);
                // What edits apply to is what is in force beside, once there is something beside.
                bench_status.settings = SettingsDocument::of(branch.settings());
            }
            self.acts = Some(acts);
        }
        self.recall_alarms(seq, &bench_status, feed);
        feed.set_present(bench_status);
        Ok(())
    }

    /// Has alarms stand as they stood at step `seq`.
    fn recall_alarms(&mut self, seq: u64, bench_status: &BenchStatus, feed: &Feed) {
        let turned = self.turns.partition_point(|turn| turn.at.seq <= seq);
        if self.alarms.0 != turned {
            self.alarms = (turned, Alarms::recalled(self.limits.clone(), &self.turns[..turned]));
        }
        let alarms = &mut self.alarms.1;
        let place = self.loaded.index_of(seq);
        let track = place.map(|place| feed.history().track(&(place..place + 1))).filter(|track| track.len() > 0);
        let [mut orbit, mut force] = [None; 2];
        if let Some(track) = track {
            let radii = (0..track.masses()).map(|mass| track.displacement(0, mass)).map(|[y, z]| y.hypot(z));
            orbit = Some(radii.fold(0.0, f64::max));
            let [y, z] = track.force(0);
            force = Some(y.hypot(z));
        }
        let damping = (bench_status.analysis.count > 0).then_some(bench_status.analysis.min_damping);
        // Shares and counts over a stretch of time are known where they crossed a limit, and nowhere else.
        let past = |watch: Watch| alarms.standings().find(|(of, ..)| *of == watch).map(|(_, standing, _)| standing);
        let kept = |watch| past(watch).filter(|standing| standing.at > Level::Fine).and_then(|standing| standing.value);
        let values = Watch::ALL.map(|watch| match watch {
            Watch::Trip => Some(f64::from(u8::from(bench_status.trip.is_tripped()))),
            Watch::Damping => damping,
            Watch::Orbit => orbit,
            Watch::Force => force,
            Watch::Saturation | Watch::Lateness | Watch::Losses => kept(watch),
        });
        Watch::ALL.into_iter().zip(values).for_each(|(watch, value)| alarms.see(watch, value));
    }

    /// While paused the recording is read on, as far as there is room: going there is then immediate.
    fn fetch_in_passing(&mut self, feed: &mut Feed) -> Result<(), String> {
        let range = self.loaded.range();
        let steps = self.ends[1] + 1 - range.start.min(self.ends[1]);
        self.reads_on = range.end <= self.ends[1] && feed.history().capacity_for(self.masses) >= steps;
        if !self.reads_on {
            return Ok(());
        }
        let end = (range.end + IN_PASSING).min(self.ends[1] + 1);
        self.loaded.extend(&mut *self.past, feed, end)
    }

    /// What was done to the machine, taken out: to be put back.
    fn gathered(&mut self) -> Vec<(u64, RecordedChange)> {
        if let Some(acts) = self.acts.take() {
            return acts;
        }
        let mut acts: Vec<(u64, RecordedChange)> = self
            .events
            .iter()
            .filter_map(|event| match event.happening()? {
                Happening::Impulse { mass, velocity } => {
                    Some((event.at.seq, RecordedChange::Impulse(*mass, *velocity)))
                }
                Happening::Restarted => Some((event.at.seq, RecordedChange::Restart)),
                _ => None,
            })
            .collect();
        let changes = self.past.changes();
        acts.extend(changes.into_iter().map(|seq| {
            let there = self.past.bench_status_at(seq);
            (seq, RecordedChange::Settings(there.settings.get().clone(), there.substeps.max(1)))
        }));
        acts.extend(self.past.paces().into_iter().map(|(seq, dtau)| (seq, RecordedChange::Pace(dtau))));
        // Stable: what came first within a step stays first.
        acts.sort_by_key(|(seq, _)| *seq);
        acts
    }

    /// Makes an edit of the past: from the first edit on, the machine runs on beside what happened.
    pub fn edit(&mut self, edit: &Edit, feed: &mut Feed, time: &mut ViewTime) -> Result<String, String> {
        if matches!(edit, Edit::Note(_)) {
            return Err("a recording takes no more notes".into());
        }
        let here = self.seq();
        let fresh = self.branch.is_none();
        if self.branch.as_ref().is_none_or(|branch| branch.from() > here) {
            if fresh && matches!(edit, Edit::Undo | Edit::Redo) {
                return Err("nothing to undo: what happened cannot be changed, only run on from".into());
            }
            let root = self.root(here)?;
            self.branch = Some(match &self.branch {
                None => Branch::new(root).map_err(|error| error.to_string())?,
                Some(branch) => branch.moved_to(root).map_err(|error| error.to_string())?,
            });
        }
        let words = match &mut self.branch {
            Some(branch) => branch.edit(edit, here).inspect(|_| branch.begin()),
            None => Err("no step to run on from".into()),
        };
        if words.is_err() && fresh {
            self.branch = None;
        }
        self.show(feed, time, false)?;
        words.map(|words| format!("what if {words}: esc drops it"))
    }

    /// Whether there is a machine beside the recorded one.
    #[must_use]
    pub fn has_branch(&self) -> bool {
        self.branch.is_some()
    }

    /// Drops what is run on beside. Returns whether there was anything.
    pub fn drop_branch(&mut self, feed: &mut Feed, time: &mut ViewTime) -> Result<bool, String> {
        let dropped = self.branch.take().is_some();
        if dropped {
            self.show(feed, time, false)?;
        }
        Ok(dropped)
    }

    /// The moment at step `seq`, or at the last one before it that is there, to run on from.
    fn root(&mut self, seq: u64) -> Result<BranchPoint, String> {
        let place = self.loaded.index_of(seq).ok_or("no step to run on from")?;
        let at = self.state(seq)?.map_or_else(|| self.state(self.loaded.seq_of(place)), |state| Ok(Some(state)))?;
        let state = at.ok_or("the step to run on from is missing")?;
        let bench_status = self.past.bench_status_at(state.seq());
        let rotor = bench_status.rotor().map_err(|error| error.to_string())?;
        let settings = bench_status.settings.get().clone();
        settings.check(&rotor).map_err(|error| error.to_string())?;
        let substeps = bench_status.substeps.max(1);
        let line = self.line(&state, &settings, substeps)?;
        let (dtau, rate_hz) = (bench_status.dtau, bench_status.rate_hz);
        let mut root = BranchPoint { rotor, dtau, rate_hz, state, settings, substeps, line, restored: None };
        // What cannot be read costs what the loop held, and no more.
        if let Ok(Some(snapshot)) = self.past.snapshot_before(root.state.seq()) {
            let then = self.past.bench_status_at(snapshot.0);
            let acts = self.gathered();
            root.restored = root.recalled(snapshot, (then.settings.get(), then.substeps.max(1)), &acts);
            self.acts = Some(acts);
        }
        Ok(root)
    }

    fn state(&mut self, seq: u64) -> Result<Option<State>, String> {
        let mut found = None;
        self.past.visit(seq..seq + 1, &mut |state| found = Some(*state))?;
        Ok(found)
    }

    /// The line of time that the run was on at `state`: since the last restart or change of speed or of substeps, if that is
    /// on file. A line that begins at the first step on file differs from the true one by rounding only.
    fn line(&mut self, state: &State, settings: &Settings, substeps: u32) -> Result<Line, String> {
        let restart = self
            .events
            .iter()
            .rev()
            .find(|event| event.happening() == Some(&Happening::Restarted) && event.at.seq <= state.seq());
        // Before its first step a machine is at rest.
        let rest = restart.map_or(0, |event| event.at.seq);
        let changes = self.past.changes();
        let faster = changes.into_iter().rev().take_while(|from| *from > rest).filter(|from| *from <= state.seq());
        let turned = faster.into_iter().find(|from| {
            let [before, after] = [from - 1, *from].map(|seq| self.past.bench_status_at(seq));
            before.settings.get().speed != after.settings.get().speed || before.substeps.max(1) != after.substeps.max(1)
        });
        let made = |steps: u64| steps * u64::from(substeps);
        let line = match turned {
            None => Some(Line { tau: 0.0, angle: 0.0, steps: made(state.seq() + 1 - rest) }),
            Some(from) => self.state(from - 1)?.map(|before| Line {
                tau: before.tau(),
                angle: before.angle(),
                steps: made(state.seq() + 1 - from),
            }),
        };
        let here = Line { tau: state.tau(), angle: state.angle(), steps: 0 };
        let first = self.state(self.ends[0])?;
        let begun =
            first.map(|first| Line { tau: first.tau(), angle: first.angle(), steps: made(state.seq() - first.seq()) });
        let dtau = self.past.bench_status_at(state.seq()).dtau / f64::from(substeps);
        // Whichever arrives at the time and the angle that were recorded.
        let arrives = |line: &Line| {
            let passed = line.steps as f64 * dtau;
            line.tau + passed == state.tau() && line.angle + settings.speed * passed == state.angle()
        };
        Ok(line.filter(arrives).or(begun.filter(arrives)).unwrap_or(here))
    }
}
