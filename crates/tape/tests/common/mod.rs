//! A machine that is recorded: what it says at every step is known.
#![allow(dead_code, reason = "no test needs all of it")]

use rotor::{Settings, builtin};
use tape::{Batch, Recording};
use wire::message::Flags;
use wire::{BenchStatus, Channel, Moment, Point, SettingsDocument, State, Step, StepLayout, Text};

pub(crate) const RUN: u64 = 0xfeed_beef_0123_4567;

pub(crate) fn bench_status() -> Box<BenchStatus> {
    let rotor = builtin::rotor("three-mass").unwrap();
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
    let mut bench_status = Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
        run_id: RUN,
        rate_hz: 1000.0,
        dtau: 0.01,
        revision: 3,
        ..wire::message::BenchStatusMessage::default()
    }));
    bench_status.set_rotor(&rotor);
    bench_status.settings = SettingsDocument::of(&settings);
    bench_status.applied_at_step = 17;
    bench_status.changed_by = Text::new("set:1");
    bench_status.version = Text::new("0.1.0");
    bench_status.started_ns = 1_700_000_000_000_000_000;
    bench_status
}

pub(crate) fn state(seq: u64) -> State {
    let mut state = State::new(StepLayout::new(3)).with_flags(Flags::contact((seq % 8) as u32));
    let mut row = state.row_mut();
    row.set_word(Channel::RunId, RUN);
    row.set_word(Channel::Seq, seq);
    row.set_word(Channel::WallNs, 1_700_000_000_000_000_000 + seq * 1_000_000);
    row.set_word(Channel::Revision, 3);
    row.set(Channel::Tau, 0, seq as f64 * 0.01 + 1e-13);
    row.set(Channel::Angle, 0, seq as f64 * 0.025);
    row.set(Channel::Speed, 0, 2.5);
    row.set(Channel::SpeedRate, 0, 0.125 * seq as f64);
    row.set_pair([Channel::CommandY, Channel::CommandZ], 0, [0.1 * seq as f64, -1.0 / 3.0]);
    row.set_pair([Channel::ForceY, Channel::ForceZ], 0, [0.05 * seq as f64, f64::MIN_POSITIVE]);
    for mass in 0..3 {
        let x = seq as f64 + mass as f64 / 7.0;
        row.set_point(mass, Point { y: x.sin(), z: x.cos(), vy: -0.0, vz: x.sqrt() });
        row.set_pair([Channel::ReadingY, Channel::ReadingZ], mass, [x.sin() + 0.001, x.cos() - 0.002]);
    }
    state
}

pub(crate) fn batch(range: std::ops::Range<u64>) -> Batch {
    let mut batch = Batch::new(StepLayout::new(3));
    range.for_each(|seq| batch.push(&state(seq)));
    batch
}

pub(crate) fn at(seq: u64) -> Moment {
    let state = state(seq);
    Moment { seq, tau: state.tau(), wall_ns: state.wall_ns() }
}

/// Every step of a recording.
pub(crate) fn states(recording: &mut Recording) -> Vec<State> {
    let mut states = Vec::new();
    recording.steps(0..u64::MAX, &mut states).unwrap();
    states
}
