//! Benches and recordings to test with: what a simulation would send, without one, and a recording of one.

#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "tests alone use this")]

mod recorded;

use std::sync::Arc;
use std::time::Instant;

use rotor::{Modes, Scales, Settings, builtin};
use wire::message::Analysis;
use wire::{BenchStatus, Channel, Event, Happening, Point, SettingsDocument, State, StepLayout, Text};

pub use recorded::{Long, Session, Stage, session, whole};

use crate::feed::Feed;
use crate::frame_data::FrameData;
use crate::jobs::{PoleTrace, PoleTraceRequest};
use crate::view_time::ViewTime;

/// Scales with `w0` = 1000 rad/s, `e_t` = 5 um, and 2 kg on 2e6 N/m.
pub const SI: Scales = Scales { w0: 1000.0, k_t: 2e6, m_t: 2.0, e_t: 5e-6 };

/// A bench status of a built-in rotor at speed 2.5.
#[must_use]
pub fn bench_status(rotor_name: &str, feedback: &str) -> Box<BenchStatus> {
    let rotor = builtin::rotor(rotor_name).unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
    settings.deadband.fill(1.0);
    let linear = Modes::of(&settings.closed_loop(&rotor)).unwrap();
    let mut analysis = Analysis {
        revision: 1,
        count: linear.modes.len() as u32,
        speed: settings.speed,
        min_damping: linear.min_damping(),
        ..Analysis::default()
    };
    for (place, mode) in analysis.poles.iter_mut().zip(&linear.modes) {
        *place = [mode.pole.re, mode.pole.im];
    }
    let mut bench_status = Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
        run_id: 7,
        pid: 1234,
        rate_hz: 1000.0,
        dtau: 0.01,
        revision: 1,
        analysis,
        ..wire::message::BenchStatusMessage::default()
    }));
    bench_status.set_rotor(&rotor);
    bench_status.settings = SettingsDocument::of(&settings);
    bench_status.health.lateness_p50_us = 50.0;
    bench_status.health.lateness_p99_us = 120.0;
    bench_status
}

/// State number `seq` of masses that whirl on circles of radius 1.5, 2.5, 3.5 ... at half the spin speed.
#[must_use]
pub fn state(masses: usize, seq: u64) -> State {
    let tau = seq as f64 * 0.01;
    let (sin, cos) = (1.25 * tau).sin_cos();
    let mut state = State::new(StepLayout::new(masses));
    let mut row = state.row_mut();
    row.set_word(Channel::RunId, 7);
    row.set_word(Channel::Seq, seq);
    row.set_word(Channel::Revision, 1);
    row.set(Channel::Tau, 0, tau);
    row.set(Channel::Angle, 0, 2.5 * tau);
    row.set(Channel::Speed, 0, 2.5);
    row.set_pair([Channel::ForceY, Channel::ForceZ], 0, [0.8 * cos, 0.8 * sin]);
    for mass in 0..masses {
        let radius = 1.5 + mass as f64;
        state = state.with_point(mass, Point { y: radius * cos, z: radius * sin, vy: 0.0, vz: 0.0 });
    }
    state
}

/// The data of a frame of the three-mass rotor after 3000 steps of regular whirl.
#[must_use]
pub fn frame_data() -> FrameData {
    let now = Instant::now();
    let mut feed = Feed::new("");
    feed.push_bench_status(bench_status("three-mass", "composite"));
    (0..3000).for_each(|seq| feed.push_step(&state(3, seq), now));
    feed.frame_data(&ViewTime::default(), now)
}

/// The data of a frame of the rig, of shaft elements in SI units, after a second or three.
#[must_use]
pub fn frame_data_of_shafts() -> FrameData {
    let rotor = builtin::rotor("rig").unwrap();
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "own").unwrap());
    let mut bench_status = bench_status("three-mass", "composite");
    bench_status.set_rotor(&rotor);
    bench_status.scales = rotor.scales().map_or([0.0; 4], |s| [s.w0, s.k_t, s.m_t, s.e_t]);
    bench_status.settings = SettingsDocument::of(&settings);
    let found = machine::MachinePoles::of(&rotor, &settings).unwrap();
    bench_status.analysis.min_damping = found.counted_damping(&rotor, settings.speed);
    bench_status.analysis.count = found.modes.len().min(bench_status.analysis.poles.len()) as u32;
    for (place, mode) in bench_status.analysis.poles.iter_mut().zip(&found.modes) {
        *place = [mode.pole.re, mode.pole.im];
    }
    let now = Instant::now();
    let mut feed = Feed::new("");
    feed.push_bench_status(bench_status);
    (0..3000).for_each(|seq| feed.push_step(&state(rotor.len(), seq), now));
    feed.frame_data(&ViewTime::LIVE, now)
}

/// The data of a frame of a rotor in SI units of 30 kg and 10 kg with a control bearing each, `left` on the second, after a few steps with
/// a control of 3 and of 2: `K_t e_t` are 72 N, so that 1 is 18 N on `left` and 54 N on `right`.
#[must_use]
pub fn frame_data_of_two_bearings() -> FrameData {
    let mass = |mass| rotor::PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance: 1e-5, ..Default::default() };
    let rotor = rotor::Rotor::from_si("two", vec![mass(30.0), mass(10.0)], vec![1e6], None).unwrap();
    let bearing = |name: &str, station| rotor::ControlBearing {
        name: Some(name.to_owned()),
        ..rotor::ControlBearing::new(station, vec![rotor::Signal::at_mass(station, 2, [0.5, 0.5, 0.0, 0.0])])
    };
    let feedback = rotor::Feedback { bearings: vec![bearing("left", 1), bearing("right", 0)] };
    let mut status = bench_status("jeffcott", "off");
    status.set_rotor(&rotor);
    status.settings = SettingsDocument::of(&Settings::new(&rotor, 1.0, feedback));
    let now = Instant::now();
    let mut feed = Feed::new("");
    feed.push_bench_status(status);
    for seq in 0..100 {
        let mut state = State::new(StepLayout::new(2).with_bearings(2));
        let mut row = state.row_mut();
        row.set_word(Channel::RunId, 7);
        row.set_word(Channel::Seq, seq);
        row.set_word(Channel::Revision, 1);
        row.set(Channel::Tau, 0, seq as f64 * 0.01);
        row.set_pair([Channel::ForceY, Channel::ForceZ], 0, [3.0, 0.0]);
        row.set_pair([Channel::FurtherForceY, Channel::FurtherForceZ], 0, [0.0, 2.0]);
        feed.push_step(&state, now);
    }
    feed.frame_data(&ViewTime::default(), now)
}

/// Poles and damping over speed of a built-in rotor.
#[must_use]
pub fn question(rotor: &str, feedback: &str, speed: f64) -> PoleTraceRequest {
    let rotor = builtin::rotor(rotor).unwrap();
    let feedback = builtin::feedback(&rotor, feedback).unwrap();
    PoleTraceRequest::at(Arc::new(rotor), feedback, speed)
}

/// The same, answered.
#[must_use]
pub fn pole_trace(rotor: &str, feedback: &str) -> PoleTrace {
    PoleTrace::of(&question(rotor, feedback, 2.5))
}

/// Event number `number` of a run, a second after the one before.
#[must_use]
pub fn event(number: u64, happening: &Happening, settings: &Settings) -> Box<Event> {
    let mut event = happening.event();
    (event.run_id, event.number, event.wall_ns) = (7, number, (50_600 + number) * 1_000_000_000);
    (event.who, event.tau) = (Text::new("dash:812"), number as f64);
    event.settings = SettingsDocument::of(settings);
    event
}
