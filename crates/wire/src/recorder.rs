//! What a recorder of a bench tells about itself: where it writes, how much, what it has lost, and whether it still does.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::Text;
use iceoryx2::prelude::ZeroCopySend;

use crate::wire_struct::message;

message! {
    "whirl.RecorderStatus"
    /// How a recorder stands. It sends this at least once a second; the latest reaches readers that come later.
    pub struct RecorderStatus {
        /// Which run it records: as in the steps.
        pub run_id: u64,
        /// Wall clock when this was sent, nanoseconds since 1970.
        pub wall_ns: u64,
        /// Wall clock when it began, nanoseconds since 1970.
        pub started_ns: u64,
        /// Bytes written, all parts together.
        pub bytes: u64,
        /// Steps written.
        pub rows: u64,
        /// Steps that were sent and did not reach the file.
        pub lost: u64,
        /// 1 recording, 2 stopped in good order, 3 failed, 4 died. A recorder sends 1 to 3; readers make 4 of a 1 whose
        /// process has gone.
        pub state: u32,
        /// The part that is being written, counted from 1, when a recording is split.
        pub part: u32,
        /// 0 keeps everything, 1 keeps the last `window_s` seconds, 2 holds them in memory and writes on a trip.
        pub mode: u32,
        /// Process id of the recorder.
        pub pid: u32,
        /// Modes 1 and 2: how many seconds; else 0.
        pub window_s: f64,
        /// The file.
        pub path: Text<1024>,
        /// Failed: why.
        pub error: Text<240>,
    }
}

/// Whether a recorder is at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderState {
    /// It writes, or holds what it will write.
    Recording,
    /// It has ended in good order.
    Stopped,
    /// It cannot go on: [`RecorderStatus::error`] says why. What is on disk stays readable.
    Failed,
    /// Its process has gone without a word: killed, or crashed.
    Died,
}

/// What a recorder keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Keeping {
    /// Everything.
    All,
    /// The last so many seconds.
    Last(f64),
    /// So many seconds before a trip, written when one comes.
    Pretrigger(f64),
}

impl RecorderStatus {
    /// How it stands. A state that this version does not know counts as failed.
    #[must_use]
    pub fn state(&self) -> RecorderState {
        match self.state {
            1 => RecorderState::Recording,
            2 => RecorderState::Stopped,
            4 => RecorderState::Died,
            _ => RecorderState::Failed,
        }
    }

    /// Says how it stands.
    pub fn set_state(&mut self, state: RecorderState) {
        self.state = match state {
            RecorderState::Recording => 1,
            RecorderState::Stopped => 2,
            RecorderState::Failed => 3,
            RecorderState::Died => 4,
        };
    }

    /// Whether it is at work.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.state() == RecorderState::Recording
    }

    /// What it keeps.
    #[must_use]
    pub fn keeping(&self) -> Keeping {
        match self.mode {
            1 => Keeping::Last(self.window_s),
            2 => Keeping::Pretrigger(self.window_s),
            _ => Keeping::All,
        }
    }

    /// Says what it keeps.
    pub fn set_keeping(&mut self, keeping: Keeping) {
        (self.mode, self.window_s) = match keeping {
            Keeping::All => (0, 0.0),
            Keeping::Last(seconds) => (1, seconds),
            Keeping::Pretrigger(seconds) => (2, seconds),
        };
    }

    /// Stamps it with the present time.
    pub(crate) fn stamp(&mut self) {
        self.wall_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64;
    }

    /// This status, if its recorder's process is there; of one that has gone, what it has come to.
    #[must_use]
    pub(crate) fn seen(mut self, alive: bool) -> Self {
        if self.is_recording() && !alive {
            self.set_state(RecorderState::Died);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_and_keeping_read_back() {
        let mut status = RecorderStatus::default();
        for state in [RecorderState::Recording, RecorderState::Stopped, RecorderState::Failed, RecorderState::Died] {
            status.set_state(state);
            assert_eq!((status.state(), status.is_recording()), (state, state == RecorderState::Recording));
            let gone = status.seen(false).state();
            assert_eq!(gone, if state == RecorderState::Recording { RecorderState::Died } else { state });
            assert_eq!(status.seen(true), status);
        }
        for keeping in [Keeping::All, Keeping::Last(600.0), Keeping::Pretrigger(10.0)] {
            status.set_keeping(keeping);
            assert_eq!(status.keeping(), keeping);
        }
    }
}
