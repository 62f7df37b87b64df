//! What a frame costs: the operator's screen at 200 x 60 with 10 000 points an orbit, beside ratatui's own canvas with the
//! same orbits and nothing else; and how many bytes go to the terminal. Run `cargo bench -p dashboard`.

#![allow(clippy::print_stdout, reason = "figures on stdout are what it is for")]

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use dashboard::{Headless, Options, built_in_layouts};
use divan::{Bencher, black_box};
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::widgets::Widget;
use ratatui::widgets::canvas::{Canvas, Points};
use rotor::{Modes, Settings, builtin};
use wire::message::Analysis;
use wire::{BenchStatus, Channel, Point, SettingsDocument, State};

/// The screen of the promises.
const SIZE: (u16, u16) = (200, 60);
/// Points of an orbit.
const POINTS: u64 = 10_000;
/// Spin speed at which eight turns, which an orbit shows, take about as many steps.
const SPEED: f64 = 0.5;

fn main() {
    let sent = Sent::default();
    let mut frames = fed("operator").frames(sent.clone(), SIZE.0, SIZE.1).expect("memory");
    let mut bytes = || {
        frames.draw().expect("memory");
        sent.0.swap(0, Ordering::Relaxed)
    };
    let (first, unchanged) = (bytes(), (0..20).map(|_| bytes()).max().unwrap_or(0));
    let mut seq = 2 * POINTS;
    let mut moving = Vec::new();
    for _ in 0..20 {
        for _ in 0..33 {
            frames.headless().push_step(&state(seq));
            seq += 1;
        }
        frames.draw().expect("memory");
        moving.push(sent.0.swap(0, Ordering::Relaxed));
    }
    moving.sort_unstable();
    let (width, height) = SIZE;
    println!(
        "operator at {width} x {height}: bytes a frame: first {first}, moving {} (median), unchanged {unchanged} (most)",
        moving[10]
    );
    divan::main();
}

/// Counts what is sent, and forgets it.
#[derive(Clone, Default)]
struct Sent(Arc<AtomicU64>);

impl Write for Sent {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn bench_status() -> Box<BenchStatus> {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "composite").expect("built in");
    let settings = Settings::new(&rotor, SPEED, feedback);
    let linear = Modes::of(&settings.closed_loop(&rotor)).expect("converges");
    let count = linear.modes.len() as u32;
    let mut analysis = Analysis { revision: 1, count, min_damping: linear.min_damping(), ..Analysis::default() };
    for (place, mode) in analysis.poles.iter_mut().zip(&linear.modes) {
        *place = [mode.pole.re, mode.pole.im];
    }
    let settings = SettingsDocument::of(&settings);
    let mut bench_status = BenchStatus::from(wire::message::BenchStatusMessage {
        run_id: 7,
        rate_hz: 1000.0,
        dtau: 0.01,
        revision: 1,
        analysis,
        ..wire::message::BenchStatusMessage::default()
    });
    bench_status.set_rotor(&rotor);
    bench_status.settings = settings;
    Box::new(bench_status)
}

/// Masses that drift over ellipses, so that no two turns are alike.
fn state(seq: u64) -> State {
    let tau = seq as f64 * 0.01;
    let mut state = State::new(wire::StepLayout::new(3));
    let mut row = state.row_mut();
    row.set_word(Channel::RunId, 7);
    row.set_word(Channel::Seq, seq);
    row.set_word(Channel::Revision, 1);
    row.set(Channel::Tau, 0, tau);
    row.set(Channel::Angle, 0, SPEED * tau);
    row.set(Channel::Speed, 0, SPEED);
    row.set_pair([Channel::ForceY, Channel::ForceZ], 0, [tau.cos(), tau.sin()]);
    for mass in 0..3 {
        let [y, z] = place_of(tau, mass + 1);
        state = state.with_point(mass as usize, Point { y, z, vy: 0.0, vz: 0.0 });
    }
    state
}

fn place_of(tau: f64, mass: u32) -> [f64; 2] {
    let radius = f64::from(mass);
    [radius * (0.76 * tau).cos() + 0.3 * (0.5 * tau).cos(), 0.8 * radius * (0.76 * tau).sin() + 0.3 * (0.5 * tau).sin()]
}

/// A dashboard that has heard enough for whole orbits.
fn fed(layout: &str) -> Headless {
    let layouts = built_in_layouts();
    let layout = layouts.iter().position(|built_in| built_in.name() == layout).expect("built in");
    let mut headless = Headless::new("bench", &Options { layout, layouts, ..Options::default() });
    headless.push_bench_status(bench_status());
    (0..2 * POINTS).for_each(|seq| headless.push_step(&state(seq)));
    headless
}

/// A whole frame, from the history to what goes to the terminal.
#[divan::bench(args = ["operator", "overview", "tuning", "whirl"])]
fn frame(bencher: Bencher<'_, '_>, layout: &str) {
    let mut frames = fed(layout).frames(Sent::default(), SIZE.0, SIZE.1).expect("memory");
    let mut seq = 2 * POINTS;
    bencher.bench_local(|| {
        frames.headless().push_step(&state(seq));
        seq += 1;
        frames.draw()
    });
}

/// The peer: three orbits of as many points on ratatui's canvas, over the area that they have there.
#[divan::bench]
fn ratatui_canvas_orbits_alone(bencher: Bencher<'_, '_>) {
    let area = Rect::new(0, 0, 150, 33);
    let orbits: Vec<Vec<(f64, f64)>> =
        (1..=3).map(|mass| (0..POINTS).map(|seq| place_of(seq as f64 * 0.01, mass).into()).collect()).collect();
    let mut buffer = Buffer::empty(area);
    bencher.bench_local(|| {
        let cells = Layout::horizontal([Constraint::Fill(1); 3]).split(area);
        for (orbit, cell) in orbits.iter().zip(cells.iter()) {
            Canvas::default()
                .marker(Marker::Braille)
                .x_bounds([-4.0, 4.0])
                .y_bounds([-4.0, 4.0])
                .paint(|context| context.draw(&Points { coords: black_box(orbit), color: Color::Cyan }))
                .render(*cell, &mut buffer);
        }
    });
}
