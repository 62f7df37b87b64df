//! What goes between a bench and a controller outside it: readings, and the commands that answer them.

use std::time::{SystemTime, UNIX_EPOCH};

use iceoryx2::prelude::ZeroCopySend;
use rotor::{MAX_BEARINGS, MAX_MASSES};

use crate::wire_struct::message;

/// Readings that wait for a controller, and commands that wait for the bench: of more, the oldest are lost.
pub(crate) const CONTROL_BUFFERED: usize = 8;

message! {
    "whirl.Readings"
    /// What a controller outside is given: what the sensors read before a step with which a sample is due.
    pub struct Readings {
        /// Which run of which process: as in the steps.
        pub run_id: u64,
        /// Number of these readings in their run: up by 1 with every sample. The command that answers them has it.
        pub number: u64,
        /// The step that the machine makes next.
        pub seq: u64,
        /// Wall clock when they were sent, nanoseconds since 1970.
        pub wall_ns: u64,
        /// Wall clock by which their command must be there to act in time, nanoseconds since 1970; 0 where the machine waits for it.
        pub deadline_ns: u64,
        /// Time of the rotor.
        pub tau: f64,
        /// Spin angle in radians, unwrapped.
        pub angle: f64,
        /// Spin speed R.
        pub speed: f64,
        /// How many masses there are.
        pub masses: u32,
        /// How many control bearings there are.
        pub bearings: u32,
        /// 1 if the machine waits for the command (lockstep), 0 in real time.
        pub lockstep: u32,
        /// 1 if commands from outside act, 0 while the law of the bench does.
        pub acting: u32,
        /// The newest readings that were answered.
        pub answered: u64,
        /// Commands that came after their deadline, since the start.
        pub late: u64,
        /// Samples whose command was not there at its deadline, since the start.
        pub missed: u64,
        /// Commands that were not taken, because they were not finite, since the start.
        pub refused: u64,
        /// Of every mass [y, z, vy, vz] as the sensors of the first control bearing read them, in e_t and w0 e_t; zeros after the last.
        pub readings: [[f64; 4]; MAX_MASSES],
    }
}

message! {
    "whirl.ControlCommand"
    /// What a controller outside sends back.
    pub struct ControlCommand {
        /// The run_id of the readings.
        pub run_id: u64,
        /// The number of the readings that it answers.
        pub number: u64,
        /// Wall clock when it was sent, nanoseconds since 1970; 0 if it is not told.
        pub wall_ns: u64,
        /// Control [uy, uz] at every control bearing, in w0^2 e_t; what is after the last is not looked at.
        pub command: [[f64; 2]; MAX_BEARINGS],
    }
}

/// Writes words into bytes, one after the other, as this machine has them.
struct Bytes<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> Bytes<N> {
    fn put<const K: usize>(&mut self, word: [u8; K]) {
        self.bytes[self.at..self.at + K].copy_from_slice(&word);
        self.at += K;
    }
}

impl Readings {
    /// Its size in bytes.
    pub const SIZE: usize = size_of::<Self>();

    /// It as C has it in memory, for a pipe.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::SIZE] {
        let Self { run_id, number, seq, wall_ns, deadline_ns, tau, angle, speed, .. } = *self;
        let Self { masses, bearings, lockstep, acting, answered, late, missed, refused, .. } = *self;
        let mut made = Bytes { bytes: [0; Self::SIZE], at: 0 };
        [run_id, number, seq, wall_ns, deadline_ns].into_iter().for_each(|word| made.put(word.to_ne_bytes()));
        [tau, angle, speed].into_iter().for_each(|word| made.put(word.to_ne_bytes()));
        [masses, bearings, lockstep, acting].into_iter().for_each(|word| made.put(word.to_ne_bytes()));
        [answered, late, missed, refused].into_iter().for_each(|word| made.put(word.to_ne_bytes()));
        self.readings.iter().flatten().for_each(|word| made.put(word.to_ne_bytes()));
        made.bytes
    }

    /// Their command, at the first control bearing and no other.
    #[must_use]
    pub fn answer(&self, command: [f64; 2]) -> ControlCommand {
        let mut answer = ControlCommand { run_id: self.run_id, number: self.number, ..ControlCommand::default() };
        answer.command[0] = command;
        answer
    }
}

impl ControlCommand {
    /// Its size in bytes.
    pub const SIZE: usize = size_of::<Self>();

    /// What C had in memory, from a pipe.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::SIZE]) -> Self {
        let mut words = bytes.chunks_exact(8).map(|word| u64::from_ne_bytes(word.try_into().unwrap_or_default()));
        let mut next = || words.next().unwrap_or_default();
        let (run_id, number, wall_ns) = (next(), next(), next());
        let command = std::array::from_fn(|_| std::array::from_fn(|_| f64::from_bits(next())));
        Self { run_id, number, wall_ns, command }
    }

    /// Stamps it with the present time.
    pub fn stamp(&mut self) {
        self.wall_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64;
    }

    /// Whether it is finite at each of so many control bearings.
    #[must_use]
    pub fn is_finite(&self, bearings: usize) -> bool {
        self.command.iter().take(bearings).flatten().all(|u| u.is_finite())
    }
}
