//! Steps that are kept, as they were sent: for whoever writes them down.

use wire::{Channel, State};

use super::block::StepQuantity;
use super::track::Track;

/// Consecutive steps of one run; at least one.
#[derive(Clone, Debug)]
pub struct PastSteps {
    track: Track,
    run_id: u64,
    /// From which place on steps have which numbers, each one more than the one before it.
    numbers: Vec<(u64, u64)>,
    /// From which place on which revision was in force.
    revisions: Vec<(u64, u64)>,
}

impl PastSteps {
    pub(super) fn new(track: Track, run_id: u64, numbers: Vec<(u64, u64)>, revisions: Vec<(u64, u64)>) -> Self {
        Self { track, run_id, numbers, revisions }
    }

    /// Those that were due at `since_ns` or later and have a number below `before`; `None` if there is none.
    pub(super) fn between(self, since_ns: u64, before: u64) -> Option<Self> {
        let place = |step: usize| self.track.index_of(step);
        // Both rise from step to step.
        let begin = first_of(self.track.len(), |step| self.track.wall_ns(step) >= since_ns);
        let end = first_of(self.track.len(), |step| self.seq(place(step)) >= before);
        let track = self.track.part(&(place(begin)..place(end.max(begin))));
        (!track.is_empty()).then_some(Self { track, ..self })
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.track.len()
    }

    /// The place of the first.
    pub(crate) fn first_place(&self) -> u64 {
        self.track.first()
    }

    /// The number of the first.
    #[must_use]
    pub fn first_seq(&self) -> u64 {
        self.seq(self.track.first())
    }

    /// Each, in its order.
    pub fn states(&self) -> impl Iterator<Item = State> + '_ {
        (0..self.track.len()).map(|step| self.state(step))
    }

    fn seq(&self, place: u64) -> u64 {
        let (from, seq) = entry(&self.numbers, place);
        seq + (place - from)
    }

    fn state(&self, step: usize) -> State {
        let (track, place) = (&self.track, self.track.index_of(step));
        let mut state = State::new(track.layout())
            .with_word(Channel::RunId, self.run_id)
            .with_word(Channel::Seq, self.seq(place))
            .with_word(Channel::WallNs, track.wall_ns(step))
            .with_word(Channel::Revision, entry(&self.revisions, place).1)
            .with_flags(track.flags(step));
        let mut row = state.row_mut();
        for column in track.layout().number_columns() {
            row.set(column.channel, column.index, track.value(StepQuantity::Of(column.channel, column.index), step));
        }
        state
    }
}

/// The last entry at or before `place`; there is one.
fn entry(entries: &[(u64, u64)], place: u64) -> (u64, u64) {
    let after = entries.partition_point(|(from, _)| *from <= place);
    entries[after.saturating_sub(1)]
}

/// The first of `0..count` that `is` holds for, as it does for all after it; `count` if for none.
fn first_of(count: usize, is: impl Fn(usize) -> bool) -> usize {
    let (mut from, mut to) = (0, count);
    while from < to {
        let middle = from + (to - from) / 2;
        if is(middle) {
            to = middle;
        } else {
            from = middle + 1;
        }
    }
    from
}

#[cfg(test)]
mod tests {
    use wire::message::Flags;
    use wire::{Step, StepLayout};

    use super::*;
    use crate::history::{BOUND, History};

    fn state(run_id: u64, seq: u64, revision: u64) -> State {
        let state = State::new(StepLayout::new(2).with_bearings(2))
            .with_word(Channel::RunId, run_id)
            .with_word(Channel::Seq, seq)
            .with_word(Channel::WallNs, 1_000 * seq)
            .with_word(Channel::Revision, revision)
            .with(Channel::Tau, 0, seq as f64 / 100.0)
            .with(Channel::FurtherForceZ, 0, 0.5 * seq as f64)
            .with(Channel::Vz, 1, -(seq as f64));
        if seq.is_multiple_of(7) { state.with_flags(Flags::SATURATED) } else { state }
    }

    #[test]
    fn steps_come_back_word_for_word_without_those_of_another_run() {
        let mut history = History::new(BOUND);
        let other: Vec<State> = (0..50).map(|seq| state(1, seq, 1)).collect();
        // Steps 1000 to 1009 are lost, and the settings change at 2000.
        let sent: Vec<State> = (10..3000)
            .filter(|seq| !(1000..1010).contains(seq))
            .map(|seq| state(2, seq, 1 + u64::from(seq >= 2000)))
            .collect();
        other.iter().chain(&sent).for_each(|state| history.push(state));
        let all = history.past_steps(0, 3000).unwrap();
        assert_eq!((all.count(), all.first_seq()), (sent.len(), 10));
        for (back, sent) in all.states().zip(&sent) {
            assert_eq!(back.words(), sent.words(), "step {}", sent.seq());
        }
        let some: Vec<u64> = history.past_steps(990_000, 1012).unwrap().states().map(|state| state.seq()).collect();
        assert_eq!(some, [990, 991, 992, 993, 994, 995, 996, 997, 998, 999, 1010, 1011]);
        assert!(history.past_steps(0, 3001).is_none(), "the step before has not come");
        assert!(history.past_steps(0, 10).is_none(), "there is none");
    }

    #[test]
    fn what_has_gone_out_of_the_history_is_not_among_them() {
        let mut history = History::new(1);
        (0..40_000).for_each(|seq| history.push(&state(3, seq, 1)));
        let kept = history.past_steps(0, 40_000).unwrap();
        assert_eq!(kept.first_seq(), 40_000 - kept.count() as u64);
        assert_eq!(kept.first_place(), history.kept().start);
    }
}
