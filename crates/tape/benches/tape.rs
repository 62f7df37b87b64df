//! The sink beside rerun's own column API, fed from memory with the same steps, and the reader on ten minutes of them.
//!
//! `cargo bench -p tape --features rerun` prints a table; it judges nothing. The peer logs every step as one wide entity
//! with `send_columns` in batches of 1000 rows into a file sink, on the same three timelines: of rerun's ways the fastest.
//! Each is timed to the end of its file, alternating, and the median is taken.

#![allow(clippy::print_stdout, reason = "a table on stdout is what it is for")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot set up has failed")]

use std::path::Path;
use std::time::Instant;

use rerun::{RecordingStreamBuilder, Scalars, TimeColumn};
use rotor::{Settings, Stepper, builtin};
use tape::{Batch, Head, Recording};
use wire::message::Flags;
use wire::{BenchStatus, Channel, Moment, Point, SettingsDocument, State, Step, StepLayout};

/// Ten minutes at 1000 steps a second.
const STEPS: usize = 600_000;
/// Rows a batch of the peer.
const PEER_ROWS: usize = 1000;
/// Rows a batch of ours: what half a second is at 1000 steps a second, as many as the peer's, and the most there are.
const ROWS: [usize; 3] = [500, PEER_ROWS, 4096];
const ROUNDS: usize = 5;

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let (head, states) = session();
    let mut peer = Vec::new();
    let mut ours: [Vec<(f64, u64)>; 3] = Default::default();
    for round in 0..ROUNDS {
        let path = folder.path().join(format!("peer-{round}.rrd"));
        peer.push(timed(&path, |path| peer_writes(path, &states)));
        for (measured, rows) in ours.iter_mut().zip(ROWS) {
            let path = folder.path().join(format!("ours-{round}-{rows}.rrd"));
            measured.push(timed(&path, |path| we_write(path, &head, &states, rows)));
        }
    }
    println!(
        "| {STEPS} steps, n = 3, to disk | rows/s | bytes/step | rows/s beside the peer | bytes beside the peer |\n|---|---|---|---|---|"
    );
    let (peer_seconds, peer_bytes) = median(&mut peer);
    let line = |what: &str, (seconds, bytes): (f64, u64)| {
        let (rate, size) = (STEPS as f64 / seconds, bytes as f64 / STEPS as f64);
        let (faster, larger) = (peer_seconds / seconds, bytes as f64 / peer_bytes as f64);
        println!("| {what} | {rate:.0} | {size:.1} | {faster:.2} | {larger:.3} |");
    };
    line("rerun's `send_columns`, one wide entity, 1000 rows a batch", (peer_seconds, peer_bytes));
    for (measured, rows) in ours.iter_mut().zip(ROWS) {
        line(&format!("`tape`, {rows} rows a batch, with orbits"), median(measured));
    }

    let path = folder.path().join("ours-0-500.rrd");
    let start = Instant::now();
    let mut recording = Recording::open(&path).unwrap();
    let opened = start.elapsed();
    let first = recording.span().unwrap().first.seq;
    let mut shown = Vec::new();
    recording.steps(first..first + 8192, &mut shown).unwrap();
    let first_picture = start.elapsed();
    let mut seeks: Vec<f64> = (0..200_u64)
        .map(|i| {
            let seq = (i * 7_919_357) % (STEPS as u64 - 8192);
            shown.clear();
            let start = Instant::now();
            recording.steps(seq..seq + 8192, &mut shown).unwrap();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    seeks.sort_by(f64::total_cmp);
    println!("\n| ten minutes at 1000 steps/s, read | |\n|---|---|");
    println!(
        "| open | {:.0} ms |\n| first 8192 steps | {:.0} ms |",
        opened.as_secs_f64() * 1e3,
        first_picture.as_secs_f64() * 1e3
    );
    println!("| 8192 steps anywhere, median / worst of 200 | {:.1} / {:.1} ms |", seeks[100], seeks[199]);
}

/// A session of the three-mass rotor under the composite feedback, stepped for real.
fn session() -> (Head, Vec<State>) {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
    settings.deadband.fill(1.0);
    let mut bench_status = Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
        run_id: 7,
        rate_hz: 1000.0,
        dtau: 0.01,
        revision: 1,
        ..wire::message::BenchStatusMessage::default()
    }));
    bench_status.set_rotor(&rotor);
    bench_status.settings = SettingsDocument::of(&settings);
    let mut stepper: Box<dyn Stepper> = rotor::stepper(&settings.closed_loop(&rotor));
    let step = |seq: usize| {
        stepper.step(0.01);
        let (motion, control) = (stepper.motion(), stepper.control());
        let force = [control.re, control.im];
        let mut state = State::new(StepLayout::new(3)).with_flags(Flags::contact(stepper.contact()));
        let mut row = state.row_mut();
        row.set_word(Channel::RunId, 7);
        row.set_word(Channel::Seq, seq as u64);
        row.set_word(Channel::WallNs, 1_700_000_000_000_000_000 + seq as u64 * 1_000_000);
        row.set_word(Channel::Revision, 1);
        row.set(Channel::Tau, 0, motion.tau);
        row.set(Channel::Angle, 0, motion.angle);
        row.set(Channel::Speed, 0, 2.5);
        row.set_pair([Channel::CommandY, Channel::CommandZ], 0, force);
        row.set_pair([Channel::ForceY, Channel::ForceZ], 0, force);
        for (mass, (p, v)) in motion.displacement.iter().zip(motion.velocity).enumerate() {
            state = state.with_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
        }
        state
    };
    let states = (0..STEPS).map(step).collect();
    (Head::live(bench_status, "bench"), states)
}

fn we_write(path: &Path, head: &Head, states: &[State], rows: usize) {
    let mut sink = tape::create(path, head).unwrap();
    sink.revision(&head.revision(), Moment::default()).unwrap();
    for states in states.chunks(rows) {
        let mut batch = Batch::new(StepLayout::new(3));
        states.iter().for_each(|state| batch.push(state));
        sink.steps(&batch).unwrap();
    }
    sink.finish().unwrap();
}

fn peer_writes(path: &Path, states: &[State]) {
    let stream = RecordingStreamBuilder::new("peer").enabled(true).save(path).unwrap();
    for states in states.chunks(PEER_ROWS) {
        let times = [
            TimeColumn::new_sequence("step", states.iter().map(|s| s.seq() as i64)),
            TimeColumn::new_duration_nanos("tau", states.iter().map(|s| (s.tau() * 1e9).round() as i64)),
            TimeColumn::new_timestamp_nanos_since_epoch("wall", states.iter().map(|s| s.wall_ns() as i64)),
        ];
        let row = |s: &State| s.numbers().chain([s.revision() as f64, f64::from(s.flags().0)]).collect::<Vec<_>>();
        let values: Vec<f64> = states.iter().flat_map(row).collect();
        let width = values.len() / states.len();
        let columns = Scalars::new(values).columns(std::iter::repeat_n(width, states.len())).unwrap();
        stream.send_columns("steps", times, columns).unwrap();
    }
    stream.flush_blocking().unwrap();
    drop(stream);
}

/// Seconds and bytes.
fn timed(path: &Path, write: impl FnOnce(&Path)) -> (f64, u64) {
    let start = Instant::now();
    write(path);
    (start.elapsed().as_secs_f64(), path.metadata().unwrap().len())
}

fn median(measured: &mut [(f64, u64)]) -> (f64, u64) {
    measured.sort_by(|a, b| a.0.total_cmp(&b.0));
    measured[measured.len() / 2]
}
