//! A machine that is recorded: what it says at every step is known.
#![allow(dead_code, reason = "no test needs all of it")]

use rotor::{Settings, builtin};
use tape::{Batch, Recording};
use wire::message::{Flags, Point};
use wire::{Bulletin, Moment, SettingsMessage, State, Text};

pub(crate) const RUN: u64 = 0xfeed_beef_0123_4567;

pub(crate) fn bulletin() -> Box<Bulletin> {
    let rotor = builtin::rotor("three-mass").unwrap();
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
    let mut bulletin =
        Box::new(Bulletin { run_id: RUN, rate_hz: 1000.0, dtau: 0.01, revision: 3, ..Bulletin::default() });
    bulletin.set_rotor(&rotor);
    bulletin.settings = SettingsMessage::pack(&settings).unwrap();
    bulletin.applied_at_step = 17;
    bulletin.changed_by = Text::new("set:1");
    bulletin.version = Text::new("0.1.0");
    bulletin.started_ns = 1_700_000_000_000_000_000;
    bulletin
}

pub(crate) fn state(seq: u64) -> State {
    let mut state = State {
        run_id: RUN,
        seq,
        tau: seq as f64 * 0.01 + 1e-13,
        angle: seq as f64 * 0.025,
        wall_ns: 1_700_000_000_000_000_000 + seq * 1_000_000,
        speed: 2.5,
        force_commanded: [0.1 * seq as f64, -1.0 / 3.0],
        force_delivered: [0.05 * seq as f64, f64::MIN_POSITIVE],
        revision: 3,
        flags: Flags::contact((seq % 8) as u32),
        count: 3,
        ..State::default()
    };
    for (i, place) in state.masses.iter_mut().take(3).enumerate() {
        let x = seq as f64 + i as f64 / 7.0;
        *place = Point { y: x.sin(), z: x.cos(), vy: -0.0, vz: x.sqrt() };
    }
    state
}

pub(crate) fn batch(range: std::ops::Range<u64>) -> Batch {
    let mut batch = Batch::new(3);
    range.for_each(|seq| batch.push(&state(seq)));
    batch
}

pub(crate) fn at(seq: u64) -> Moment {
    let state = state(seq);
    Moment { seq, tau: state.tau, wall_ns: state.wall_ns }
}

/// Every step of a recording.
pub(crate) fn states(recording: &mut Recording) -> Vec<State> {
    let mut states = Vec::new();
    recording.steps(0..u64::MAX, &mut states).unwrap();
    states
}
