//! Which steps of a recording are in the feed, and which of its places is which step.

use std::ops::Range;

use wire::Step;

use super::RecordingSource;
use crate::feed::Feed;
use crate::replay::ReplayError;

/// Steps that may be added ahead at once: more is a jump, and starts anew.
const STRIDE: u64 = 200_000;

/// The steps of a [`RecordingSource`] that the feed's history holds.
#[derive(Debug, Default)]
pub(crate) struct LoadedSteps {
    /// The steps asked for so far, by number: what is missing among them is not there.
    range: Range<u64>,
    /// From which place on which number: within a run both rise by one. Steps that are missing, and those of a machine
    /// that is held, have no place of their own and begin a new run.
    runs: Vec<(u64, u64)>,
    /// How many of the changes of settings are known to the history.
    told: usize,
}

impl LoadedSteps {
    /// Sees to it that the steps `wanted` are in the feed, and those that follow if there is room in passing.
    pub(crate) fn cover(
        &mut self,
        past: &mut dyn RecordingSource,
        feed: &mut Feed,
        wanted: &Range<u64>,
    ) -> Result<(), ReplayError> {
        let begins_within = (self.range.start..=self.range.end).contains(&wanted.start) && !self.range.is_empty();
        if begins_within && wanted.end <= self.range.end {
            return Ok(());
        }
        if !begins_within || wanted.end - self.range.end > STRIDE {
            feed.clear_steps(wanted.start);
            *self = Self { range: wanted.start..wanted.start, runs: Vec::new(), told: 0 };
        }
        self.extend(past, feed, wanted.end)
    }

    /// Adds the steps up to `end`.
    pub(crate) fn extend(
        &mut self,
        past: &mut dyn RecordingSource,
        feed: &mut Feed,
        end: u64,
    ) -> Result<(), ReplayError> {
        let changes = past.changes();
        if self.told == 0 {
            // The settings in force at the first step come with it.
            self.told = changes.partition_point(|from| *from <= self.range.start).saturating_sub(1);
        }
        while let Some(from) = changes.get(self.told).filter(|from| **from < end) {
            feed.note_past_settings(&past.bench_status_at(*from));
            self.told += 1;
        }
        let (from, runs) = (self.range.end, &mut self.runs);
        past.visit(from..end, &mut |state| {
            let place = feed.history().kept().end;
            feed.push_past_step(state);
            if feed.history().kept().end == place {
                return;
            }
            let expected = runs.last().map(|(at, seq)| seq + (place - at));
            if expected != Some(state.seq()) {
                runs.push((place, state.seq()));
            }
        })?;
        self.range.end = self.range.end.max(end);
        Ok(())
    }

    /// Steps that the history has let go of are no longer covered.
    pub(crate) fn let_go(&mut self, feed: &Feed) {
        let first = feed.history().kept().start;
        let Some((place, _)) = self.runs.first() else { return };
        if first > *place {
            self.range.start = self.range.start.max(self.seq_of(first));
            let gone = self.runs.partition_point(|(place, _)| *place <= first) - 1;
            self.runs.drain(..gone);
        }
    }

    /// The steps that have been asked for.
    pub(crate) fn range(&self) -> &Range<u64> {
        &self.range
    }

    /// The place of the last step there is at or before `seq`; the first there is if none is before.
    pub(crate) fn index_of(&self, seq: u64) -> Option<u64> {
        let after = self.runs.partition_point(|(_, from)| *from <= seq);
        let Some((place, from)) = after.checked_sub(1).map(|at| self.runs[at]) else {
            return self.runs.first().map(|(place, _)| *place);
        };
        let end = self.runs.get(after).map_or(u64::MAX, |(next, _)| next - 1);
        Some((place + (seq - from)).min(end))
    }

    /// The number of the step at `place`.
    pub(crate) fn seq_of(&self, place: u64) -> u64 {
        let after = self.runs.partition_point(|(from, _)| *from <= place);
        after.checked_sub(1).map_or(0, |at| self.runs[at].1 + (place - self.runs[at].0))
    }
}
