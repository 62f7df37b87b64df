//! Steps as columns: the form in which they are queued, written and read.

use wire::message::Flags;
use wire::{Channel, Moment, State, Step, StepLayout, WHOLES};

/// Consecutive steps of one run, column by column. Doubles are kept bit for bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    layout: StepLayout,
    pub(crate) seq: Vec<u64>,
    pub(crate) wall_ns: Vec<u64>,
    pub(crate) revision: Vec<u64>,
    pub(crate) flags: Vec<u32>,
    /// In the order of [`StepLayout::number_columns`].
    pub(crate) values: Vec<Vec<f64>>,
}

impl Batch {
    /// An empty batch of steps that are laid out like this.
    #[must_use]
    pub fn new(layout: StepLayout) -> Self {
        Self { layout, values: vec![Vec::new(); layout.numbers()], ..Self::default() }
    }

    /// How its steps are laid out.
    #[must_use]
    pub fn layout(&self) -> StepLayout {
        self.layout
    }

    /// How many steps there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.seq.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.seq.is_empty()
    }

    /// All values of a channel that is a number, of a mass or sensor counted from 0.
    #[must_use]
    pub fn column(&self, channel: Channel, index: usize) -> &[f64] {
        &self.values[self.layout.place(channel, index) - WHOLES]
    }

    /// Adds a step, which must be laid out like the batch.
    pub fn push(&mut self, step: &impl Step) {
        debug_assert_eq!(step.layout(), self.layout);
        self.seq.push(step.seq());
        self.wall_ns.push(step.wall_ns());
        self.revision.push(step.revision());
        self.flags.push(step.flags().0);
        for (column, value) in self.values.iter_mut().zip(step.numbers()) {
            column.push(value);
        }
    }

    /// Step `row` as it was sent in run `run_id`.
    #[must_use]
    pub fn state(&self, row: usize, run_id: u64) -> State {
        let mut state = State::new(self.layout);
        let mut into = state.row_mut();
        into.set_word(Channel::RunId, run_id);
        into.set_word(Channel::Seq, self.seq[row]);
        into.set_word(Channel::WallNs, self.wall_ns[row]);
        into.set_word(Channel::Revision, self.revision[row]);
        into.set_flags(Flags(self.flags[row]));
        into.set_numbers(self.values.iter().map(|column| column[row]));
        state
    }

    /// When step `row` was.
    #[must_use]
    pub fn moment(&self, row: usize) -> Moment {
        Moment { seq: self.seq[row], tau: self.column(Channel::Tau, 0)[row], wall_ns: self.wall_ns[row] }
    }

    /// The first step's moment and the last's.
    #[must_use]
    pub fn span(&self) -> Option<(Moment, Moment)> {
        let last = self.len().checked_sub(1)?;
        Some((self.moment(0), self.moment(last)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use proptest::prelude::*;
    use rotor::{MAX_BEARINGS, MAX_MASSES};

    use super::*;

    /// Any step of this layout, its doubles any bits.
    pub(crate) fn any_state(layout: StepLayout) -> impl Strategy<Value = State> {
        let heads = (any::<u64>(), any::<u64>(), any::<u64>(), any::<u32>());
        (heads, proptest::collection::vec(any::<u64>(), layout.numbers())).prop_map(
            move |((seq, wall_ns, revision, flags), words)| {
                let mut state = State::new(layout).with_flags(Flags(flags));
                let mut row = state.row_mut();
                row.set_word(Channel::RunId, 9);
                row.set_word(Channel::Seq, seq);
                row.set_word(Channel::WallNs, wall_ns);
                row.set_word(Channel::Revision, revision);
                row.set_numbers(words.into_iter().map(f64::from_bits));
                state
            },
        )
    }

    /// Any layout.
    pub(crate) fn any_layout() -> impl Strategy<Value = StepLayout> {
        (1..=MAX_MASSES, 1..=MAX_BEARINGS)
            .prop_map(|(masses, bearings)| StepLayout::new(masses).with_bearings(bearings))
    }

    proptest! {
        #[test]
        fn a_step_comes_back_bit_for_bit(
            states in any_layout().prop_flat_map(|layout| proptest::collection::vec(any_state(layout), 1..5))
        ) {
            let mut batch = Batch::new(states[0].layout());
            states.iter().for_each(|state| batch.push(state));
            for (row, state) in states.iter().enumerate() {
                prop_assert_eq!(&batch.state(row, 9), state);
            }
        }
    }
}
