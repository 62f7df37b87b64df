//! Steps as columns: the form in which they are queued, written and read.

use wire::message::{Flags, Point};
use wire::{Moment, State};

use crate::schema;

/// Consecutive steps of one run, column by column. Doubles are kept bit for bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    masses: usize,
    pub(crate) seq: Vec<u64>,
    pub(crate) wall_ns: Vec<u64>,
    pub(crate) revision: Vec<u64>,
    pub(crate) flags: Vec<u32>,
    /// As [`schema::columns`] orders them.
    pub(crate) values: Vec<Vec<f64>>,
}

impl Batch {
    /// An empty batch for a rotor of `masses` masses.
    #[must_use]
    pub fn new(masses: usize) -> Self {
        let values = vec![Vec::new(); schema::HEAD + schema::PER_MASS * masses];
        Self { masses, values, ..Self::default() }
    }

    /// How many masses the rotor has.
    #[must_use]
    pub fn masses(&self) -> usize {
        self.masses
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

    /// Adds a step. It must have as many masses as the batch.
    pub fn push(&mut self, state: &State) {
        debug_assert_eq!(state.points().len(), self.masses);
        self.seq.push(state.seq);
        self.wall_ns.push(state.wall_ns);
        self.revision.push(state.revision);
        self.flags.push(state.flags.0);
        let ([cy, cz], [dy, dz]) = (state.force_commanded, state.force_delivered);
        let head = [state.tau, state.angle, state.speed, cy, cz, dy, dz];
        let points = state.masses.iter().take(self.masses).flat_map(|p| [p.y, p.z, p.vy, p.vz]);
        for (column, value) in self.values.iter_mut().zip(head.into_iter().chain(points)) {
            column.push(value);
        }
    }

    /// Step `row` as it was sent in run `run_id`.
    #[must_use]
    pub fn state(&self, row: usize, run_id: u64) -> State {
        let at = |column: usize| self.values[column][row];
        let mut state = State {
            run_id,
            seq: self.seq[row],
            tau: at(0),
            angle: at(1),
            wall_ns: self.wall_ns[row],
            speed: at(2),
            force_commanded: [at(3), at(4)],
            force_delivered: [at(5), at(6)],
            revision: self.revision[row],
            flags: Flags(self.flags[row]),
            count: self.masses as u32,
            ..State::default()
        };
        for (mass, place) in state.masses.iter_mut().take(self.masses).enumerate() {
            let first = schema::HEAD + schema::PER_MASS * mass;
            *place = Point { y: at(first), z: at(first + 1), vy: at(first + 2), vz: at(first + 3) };
        }
        state
    }

    /// When step `row` was.
    #[must_use]
    pub fn moment(&self, row: usize) -> Moment {
        Moment { seq: self.seq[row], tau: self.values[0][row], wall_ns: self.wall_ns[row] }
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
    use rotor::MAX_MASSES;

    use super::*;

    /// Any step of a rotor of `masses` masses, its doubles any bits.
    pub(crate) fn any_state(masses: usize) -> impl Strategy<Value = State> {
        let double = || any::<u64>().prop_map(f64::from_bits);
        let heads = (any::<u64>(), any::<u64>(), any::<u64>(), any::<u32>());
        (heads, proptest::collection::vec(double(), 7 + 4 * masses)).prop_map(
            move |((seq, wall_ns, revision, flags), d)| {
                let mut state = State {
                    run_id: 9,
                    seq,
                    wall_ns,
                    revision,
                    flags: Flags(flags),
                    tau: d[0],
                    angle: d[1],
                    speed: d[2],
                    force_commanded: [d[3], d[4]],
                    force_delivered: [d[5], d[6]],
                    count: masses as u32,
                    ..State::default()
                };
                for (place, p) in state.masses.iter_mut().zip(d[7..].chunks(4)) {
                    *place = Point { y: p[0], z: p[1], vy: p[2], vz: p[3] };
                }
                state
            },
        )
    }

    /// Every field as bits: a NaN is equal to itself.
    pub(crate) fn bits(state: &State) -> Vec<u64> {
        let head = [state.run_id, state.seq, state.wall_ns, state.revision, state.flags.0.into(), state.count.into()];
        let forces = state.force_commanded.into_iter().chain(state.force_delivered);
        let doubles = [state.tau, state.angle, state.speed].into_iter().chain(forces);
        let points = state.masses.iter().flat_map(|p| [p.y, p.z, p.vy, p.vz]);
        head.into_iter().chain(doubles.chain(points).map(f64::to_bits)).collect()
    }

    proptest! {
        #[test]
        fn a_step_comes_back_bit_for_bit(
            states in (1..=MAX_MASSES).prop_flat_map(|n| proptest::collection::vec(any_state(n), 1..5))
        ) {
            let mut batch = Batch::new(states[0].points().len());
            states.iter().for_each(|state| batch.push(state));
            for (row, state) in states.iter().enumerate() {
                prop_assert_eq!(bits(&batch.state(row, 9)), bits(state));
            }
        }
    }
}
