//! Snapshots: all that decides how the machine goes on, right before a step, so that who has one can run it on to the last bit.
//!
//! One goes out at every change of settings, impulse, restart and trip, and once a second. A snapshot is words as
//! `machine::Machine::save` writes them: they mean something only to a machine of the same program (the rotor, the settings of
//! that revision, the substeps). A loop that remembers more than [`MAX_SNAPSHOT`] words tells of none.

use iceoryx2::prelude::ZeroCopySend;

use crate::wire_struct::message;

/// Words of the largest snapshot: a delay of some three thousand steps.
pub const MAX_SNAPSHOT: usize = 1 << 15;

/// Snapshots that wait for a reader that sleeps.
pub(crate) const SNAPSHOTS_BUFFERED: usize = 16;

message! {
    "whirl.SnapshotHead"
    /// What stands before the words of a snapshot.
    pub struct SnapshotHead {
        /// Which run of which process: as in the steps.
        pub run_id: u64,
        /// The step that the machine makes next: the state is that before it, with all that was done to the machine in between.
        pub seq: u64,
        /// Revision of the settings that this step is made with.
        pub revision: u64,
        /// Time of the rotor.
        pub tau: f64,
    }
}
