//! What has happened: every step that reached us at full rate, the settings that were in force, and what interrupted the
//! motion, in memory of a fixed bound.
//!
//! Steps have a number of their own, their **place**, which rises by one from step to step and is never used again: what is
//! lost or held leaves a [`Mark`] and no hole. Full blocks of steps are shared with whoever draws, never copied.

mod block;
mod era;
mod past_steps;
mod track;

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use rotor::{ControlMasses, MAX_BEARINGS};
use wire::message::Flags;
use wire::{BenchStatus, Step, StepLayout};

pub use block::StepQuantity;
use block::{Block, STEPS};
pub use era::{Era, Mark};
pub use past_steps::PastSteps;
pub use track::Track;

/// Bytes that steps may take unless somebody says otherwise: 10 minutes of a rotor with three masses at 1000 steps a second.
pub const BOUND: usize = 145_000_000;
/// Eras and marks that are kept of each: a key that repeats through the whole history makes no more.
const NOTES_KEPT: usize = 4096;

/// Steps, eras and marks, oldest first.
#[derive(Debug)]
pub struct History {
    /// Bytes that steps may take.
    bound: usize,
    layout: StepLayout,
    /// Full blocks.
    blocks: VecDeque<Arc<Block>>,
    /// The block that is being filled, once there is a step.
    open: Option<Block>,
    /// Place of the first step that is kept.
    first: u64,
    marks: VecDeque<(u64, Mark)>,
    /// From which step on which revision of which run was in force.
    passages: VecDeque<(u64, u64, u64)>,
    eras: VecDeque<Arc<Era>>,
    /// From which place on steps have which numbers, each one more than the one before it.
    numbers: VecDeque<(u64, u64)>,
    run_id: u64,
    last_seq: u64,
    last_tau: f64,
    lost: u64,
    tripped: bool,
    /// Whether the machine stands still since a trip.
    stands_still: bool,
    /// The largest control of every bearing.
    peak_forces: [f64; MAX_BEARINGS],
    /// The place from which a person has had the largest control count.
    peak_from: u64,
}

impl History {
    /// An empty history whose steps take at most `bound` bytes, but always a few thousand steps.
    pub fn new(bound: usize) -> Self {
        Self {
            bound,
            layout: StepLayout::default(),
            blocks: VecDeque::new(),
            open: None,
            first: 0,
            marks: VecDeque::new(),
            passages: VecDeque::new(),
            eras: VecDeque::new(),
            numbers: VecDeque::new(),
            run_id: 0,
            last_seq: 0,
            last_tau: 0.0,
            lost: 0,
            tripped: false,
            stands_still: false,
            peak_forces: [0.0; MAX_BEARINGS],
            peak_from: 0,
        }
    }

    /// An empty history of the same bound, whose first step will have the place `first`.
    pub fn emptied(&self, first: u64) -> Self {
        // Whatever comes first is of another run than what was before: no gap is lost between the two.
        Self { first, run_id: !self.run_id, ..Self::new(self.bound) }
    }

    /// How many steps of a rotor of `masses` masses there is room for.
    pub fn capacity_for(&self, masses: usize) -> u64 {
        ((self.bound / Block::bytes(StepLayout::new(masses))).saturating_sub(1).max(8) * STEPS) as u64
    }

    /// Takes in one step. A rotor of another number of masses starts the history anew; a gap in the numbers is a loss.
    pub fn push(&mut self, state: &impl Step) {
        let layout = state.layout();
        if layout != self.layout {
            *self = Self { first: self.end(), eras: std::mem::take(&mut self.eras), ..Self::new(self.bound) };
            self.layout = layout;
        }
        let is_new_run = state.run_id() != self.run_id;
        let (tripped, stands_still) = (state.flags().has(Flags::TRIPPED), state.flags().stands_still());
        if is_new_run {
            if !self.is_empty() {
                self.mark(Mark::NewRun);
            }
            self.run_id = state.run_id();
            self.lost = 0;
        } else {
            let lost = state.seq().saturating_sub(self.last_seq + 1);
            self.lost += lost;
            if lost > 0 && !(stands_still && self.stands_still) {
                self.mark(Mark::Lost(lost));
            }
        }
        self.last_seq = state.seq();
        let is_new_revision = self.pass(state);
        // A machine that is held would push what tripped it out of what is shown.
        if stands_still && self.stands_still && !is_new_run {
            return;
        }
        let restarted = !is_new_run && !self.is_empty() && state.tau() < self.last_tau;
        if restarted {
            self.mark(Mark::Restart);
        }
        // One that coasts down and is held after all has tripped again.
        if tripped && (is_new_run || !self.tripped || (stands_still && !self.stands_still)) {
            self.mark(Mark::Trip);
        }
        if restarted || is_new_run || is_new_revision || (self.tripped && !tripped) {
            self.peak_forces = [0.0; MAX_BEARINGS];
        }
        (self.tripped, self.stands_still) = (tripped, stands_still);
        self.last_tau = state.tau();
        for (bearing, peak) in self.peak_forces.iter_mut().enumerate().take(state.bearings()) {
            let [u_y, u_z] = state.force(bearing)[1];
            *peak = peak.max(u_y.hypot(u_z));
        }
        self.keep(state);
    }

    /// Puts a step behind the others, and lets go of the oldest if there is no more room.
    fn keep(&mut self, state: &impl Step) {
        let place = self.end();
        let goes_on = |(from, seq): &(u64, u64)| seq.wrapping_add(place - from) == state.seq();
        if !self.numbers.back().is_some_and(goes_on) {
            if self.numbers.len() == NOTES_KEPT {
                self.numbers.pop_front();
            }
            self.numbers.push_back((place, state.seq()));
        }
        let open = self.open.get_or_insert_with(|| Block::new(self.layout));
        open.push(state);
        if open.len() < STEPS {
            return;
        }
        let full = std::mem::replace(open, Block::new(self.layout));
        self.blocks.push_back(Arc::new(full));
        // The open block counts too, and the latest motion always stays.
        let most = (self.bound / Block::bytes(self.layout)).saturating_sub(1).max(8);
        while self.blocks.len() > most {
            self.blocks.pop_front();
            self.first += STEPS as u64;
        }
        let first = self.first;
        while self.marks.front().is_some_and(|(place, _)| *place < first) {
            self.marks.pop_front();
        }
        while self.passages.get(1).is_some_and(|(place, ..)| *place <= first) {
            self.passages.pop_front();
        }
        while self.numbers.get(1).is_some_and(|(place, _)| *place <= first) {
            self.numbers.pop_front();
        }
        if let Some((_, run, revision)) = self.passages.front() {
            // The one in force at the first step, and whatever is newer than all passages, stay.
            let keep_from = self.eras.iter().rposition(|era| era.run_id == *run && era.revision <= *revision);
            self.eras.drain(..keep_from.unwrap_or(0));
        }
    }

    /// Notes which settings a step was made with. Returns whether they are others than before, in the same run.
    fn pass(&mut self, state: &impl Step) -> bool {
        let place = self.end();
        let last = self.passages.back().map(|(_, run, revision)| (*run, *revision));
        if last == Some((state.run_id(), state.revision())) {
            return false;
        }
        // Several changes while the machine is held: only the last was ever used.
        if self.passages.back().is_some_and(|(last, ..)| *last == place) {
            self.passages.pop_back();
        }
        if self.passages.len() == NOTES_KEPT {
            self.passages.pop_front();
        }
        self.passages.push_back((place, state.run_id(), state.revision()));
        let is_change = last.is_some_and(|(run, _)| run == state.run_id());
        if is_change {
            self.mark(Mark::Settings(state.revision()));
        }
        is_change
    }

    fn mark(&mut self, mark: Mark) {
        if self.marks.len() == NOTES_KEPT {
            self.marks.pop_front();
        }
        self.marks.push_back((self.end(), mark));
    }

    /// Marks the step `seq` of a run, at which somebody put a note on the record; nothing if it is not kept.
    pub fn note(&mut self, run_id: u64, seq: u64) {
        if run_id != self.run_id || self.is_empty() {
            return;
        }
        // Steps that were lost or held in between leave no place: then the mark is that much early.
        let back = (self.last_seq + 1).saturating_sub(seq);
        let Some(place) = self.end().checked_sub(back).filter(|place| *place >= self.first) else { return };
        let at = self.marks.partition_point(|(before, _)| *before <= place);
        self.marks.insert(at, (place, Mark::Note));
        if self.marks.len() > NOTES_KEPT {
            self.marks.pop_front();
        }
    }

    /// Takes in one bench status: its settings and poles become an era, if they are news.
    pub fn note_bench_status(&mut self, bench_status: &BenchStatus) {
        let last = self.eras.back();
        let is_same =
            last.is_some_and(|era| era.run_id == bench_status.run_id && era.revision == bench_status.revision);
        if is_same && last.is_some_and(|era| era.has_same_poles(&bench_status.analysis)) {
            return;
        }
        let rotor = last.filter(|era| era.run_id == bench_status.run_id).and_then(|era| era.rotor.clone());
        let era = Era::of(bench_status, rotor);
        if is_same {
            self.eras.pop_back();
        } else if self.eras.len() == NOTES_KEPT {
            self.eras.pop_front();
        }
        self.eras.push_back(Arc::new(era));
    }

    /// The settings and poles in force at a step, if they are known; of a revision whose bench status never came, the one before.
    pub fn era_at(&self, place: u64) -> Option<&Arc<Era>> {
        let passed = self.passages.partition_point(|(from, ..)| *from <= place).checked_sub(1)?;
        let (_, run, revision) = self.passages[passed];
        let mut older = self.eras.iter().rev().filter(|era| era.run_id == run);
        older.clone().find(|era| era.revision <= revision).or_else(|| older.next_back())
    }

    /// The newest era, whether or not a step was made in it.
    pub fn newest_era(&self) -> Option<&Arc<Era>> {
        self.eras.back()
    }

    /// The eras in force over some steps, each with the first of them that it holds for.
    pub fn eras(&self, over: &Range<u64>) -> Vec<(u64, Arc<Era>)> {
        let from = self.passages.partition_point(|(from, ..)| *from <= over.start).saturating_sub(1);
        let passed = self.passages.iter().skip(from).take_while(|(from, ..)| *from < over.end);
        passed.filter_map(|(from, ..)| Some(((*from).max(over.start), self.era_at(*from)?.clone()))).collect()
    }

    /// What is marked among some steps.
    pub fn marks(&self, over: &Range<u64>) -> impl Iterator<Item = &(u64, Mark)> {
        let from = self.marks.partition_point(|(place, _)| *place < over.start);
        self.marks.iter().skip(from).take_while(|(place, _)| *place < over.end)
    }

    /// The largest control of every bearing between the last change of settings, or start of the motion, and `place`, both included.
    pub fn peak_forces(&self, place: u64) -> [f64; MAX_BEARINGS] {
        if place + 1 >= self.end() {
            // Also counts what has gone out of the history.
            return self.peak_forces;
        }
        let since = self.peak_since(place);
        let track = self.track(&(since..place + 1));
        let mut peaks = [0.0; MAX_BEARINGS];
        for (bearing, peak) in peaks.iter_mut().enumerate().take(track.layout().bearings()) {
            let range = track.range(StepQuantity::force(bearing), 0..(place + 1 - since) as usize);
            *peak = range.map_or(0.0, |[_, most]| most);
        }
        peaks
    }

    /// From which place on the largest control up to `place` counts.
    fn peak_since(&self, place: u64) -> u64 {
        let before = self.marks.partition_point(|(at, _)| *at <= place);
        let since = self.marks.iter().take(before).rev().find(|(_, mark)| mark.resets_peaks());
        let since = since.map_or(self.first, |(at, _)| (*at).max(self.first));
        if self.peak_from <= place { since.max(self.peak_from) } else { since }
    }

    /// The place of the step with the largest control of those that [`Self::peak_forces`] counts, as far as they are kept; the first of
    /// several.
    pub fn peak_place(&self, place: u64) -> Option<u64> {
        let since = self.peak_since(place);
        let track = self.track(&(since..place + 1));
        let masses = self.era_at(place).map_or_else(ControlMasses::default, |era| era.masses_of_bearings());
        let peaks = (0..track.layout().bearings()).filter_map(|bearing| {
            let force = StepQuantity::force(bearing);
            let most = track.range(force, 0..track.len())?[1];
            Some((masses.as_of_first(bearing, most), most, force))
        });
        let (_, most, force) = peaks.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (0..track.len()).find(|step| track.value(force, *step) >= most).map(|step| track.index_of(step))
    }

    /// Has the largest control count from the newest step on.
    pub fn reset_peak(&mut self) {
        (self.peak_forces, self.peak_from) = ([0.0; MAX_BEARINGS], self.end());
    }

    /// The steps that are kept, by their places.
    pub fn kept(&self) -> Range<u64> {
        self.first..self.end()
    }

    /// The place that the next step will get.
    fn end(&self) -> u64 {
        self.first + (self.blocks.len() * STEPS + self.open.as_ref().map_or(0, Block::len)) as u64
    }

    fn is_empty(&self) -> bool {
        self.first == self.end()
    }

    /// Steps over a range of places, cut to what is kept. Shares all blocks but the one that is being filled.
    pub fn track(&self, over: &Range<u64>) -> Track {
        let end = over.end.min(self.end());
        let start = over.start.clamp(self.first, end);
        let from = ((start - self.first) as usize) / STEPS;
        let to = ((end - self.first) as usize).div_ceil(STEPS);
        let shared = self.blocks.range(from.min(self.blocks.len())..to.min(self.blocks.len())).cloned();
        let mut blocks: Vec<Arc<Block>> = shared.collect();
        if to > self.blocks.len() {
            blocks.extend(self.open.clone().map(Arc::new));
        }
        Track::new(self.layout, blocks, start, ((start - self.first) as usize) % STEPS, (end - start) as usize)
    }

    /// The steps of the present run that were due at `since_ns` of the wall clock or later and have a number below `before`, as they
    /// were sent; `None` while the one before `before` has not come, and where there is none.
    pub fn past_steps(&self, since_ns: u64, before: u64) -> Option<PastSteps> {
        let run_begins = self.passages.iter().find(|(_, run, _)| *run == self.run_id)?.0;
        let first = self.numbers.front()?.0.max(run_begins).max(self.first);
        let track = self.track(&(first..self.end()));
        let has_come = self.last_seq + 1 >= before;
        let passages = self.passages.iter().map(|(place, _, revision)| (*place, *revision)).collect();
        let numbers = self.numbers.iter().copied().collect();
        has_come.then(|| PastSteps::new(track, self.run_id, numbers, passages).between(since_ns, before)).flatten()
    }

    /// Steps of this run that were sent and did not reach us.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// The place of the first step that was due at a time of the wall clock or after it; `None` if what was then is not kept.
    pub fn index_at(&self, wall_ns: u64) -> Option<u64> {
        let track = self.track(&self.kept());
        if track.is_empty() || track.wall_ns(0) > wall_ns || track.wall_ns(track.len() - 1) < wall_ns {
            return None;
        }
        let (mut before, mut at) = (0, track.len() - 1);
        while before < at {
            let middle = before + (at - before) / 2;
            if track.wall_ns(middle) < wall_ns {
                before = middle + 1;
            } else {
                at = middle;
            }
        }
        Some(self.first + at as u64)
    }

    /// Whether the machine has tripped.
    pub fn is_tripped(&self) -> bool {
        self.tripped
    }

    /// How many steps there is room for.
    #[cfg(test)]
    pub fn room(&self) -> usize {
        self.bound / Block::bytes(self.layout) * STEPS
    }
}

#[cfg(test)]
mod tests;
