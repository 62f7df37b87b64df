//! Files to which anything has happened: single bytes changed all over them, cut off, padded, filled with zeros, put behind one
//! another. What is not damaged is read, what is lost is told, and nothing panics, hangs or asks for more memory than
//! there is. With the cargo feature `rerun`.
//!
//! The run is bounded and always the same; `just fuzz` runs on with other seeds: `WHIRL_FUZZ_SECONDS` is how long for each
//! kind of file, `WHIRL_FUZZ_SEED` where it begins. With `WHIRL_FUZZ_TOLD` set each change is told before it is tried.
#![cfg(feature = "rerun")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking, as tests do")]

mod common;

use std::fs::File;
use std::io::Write;
use std::os::unix::fs::FileExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fastrand::Rng;

use common::{RUN, at, batch, bench_status, state, states};
use rustix::time::{ClockId, clock_gettime};
use tape::{DamageKind, Event, Head, Info, LostSteps, Recording, Remark, What};
use wire::message::Trip;
use wire::{Happening, State, Step, Text};

/// Steps in a message of the recording that is damaged.
const ROWS: u64 = 40;
/// Messages of steps in it.
const BATCHES: u64 = 8;
/// What opening and reading one file may take of a processor: a thousand times what it does.
const MOST_WORK: Duration = Duration::from_secs(20);
/// What it may ask for of memory beyond a hundred times the file.
const MOST_MEMORY: u64 = 64 << 20;

/// A small recording of ours: settings, steps, an event and a trip, an end.
fn write(path: &Path) {
    let head = Head::live(bench_status(), "rig");
    let mut sink = tape::create(path, &head).unwrap();
    sink.revision(&head.revision(), at(0)).unwrap();
    for number in 0..BATCHES {
        sink.steps(&batch(number * ROWS..(number + 1) * ROWS)).unwrap();
        if number == 3 {
            sink.health(&bench_status(), at(150)).unwrap();
            let trip = Trip { cause: 1, mass: 2, step: 155, radius: 1000.5, limit: 1000.0 };
            let mut event = Happening::Tripped(trip).event();
            (event.run_id, event.number, event.seq, event.tau, event.revision) = (RUN, 10, 155, 1.55, 3);
            event.who = Text::new("sim");
            sink.event(&Event::from(&*event)).unwrap();
        }
    }
    sink.remark(&Remark { at: at(BATCHES * ROWS - 1), what: What::Ends("asked to stop".into()) }).unwrap();
    sink.finish().unwrap();
}

/// What is on file, and what the reader says is wrong with it.
struct Read {
    states: Vec<State>,
    info: Info,
}

impl Read {
    fn kinds(&self) -> Vec<DamageKind> {
        self.info.damage.iter().map(|damage| damage.kind).collect()
    }

    /// Steps of which the reader says that they are lost.
    fn lost(&self) -> u64 {
        self.info.damage.iter().filter_map(|damage| damage.steps).map(|LostSteps { count, .. }| count).sum()
    }
}

/// A file, and what is done to it.
struct Patient {
    whole: Vec<u8>,
    states: Vec<State>,
    path: PathBuf,
    _folder: tempfile::TempDir,
}

impl Patient {
    fn of(original: impl FnOnce(&Path)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rrd");
        original(&path);
        let states = states(&mut Recording::open(&path).unwrap());
        Self { whole: std::fs::read(&path).unwrap(), states, path, _folder: folder }
    }

    /// With checksums.
    fn new() -> Self {
        Self::of(write)
    }

    /// As written before there were any.
    fn old(name: &str) -> Self {
        let original = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        Self::of(|path| {
            std::fs::copy(original, path).unwrap();
        })
    }

    fn with(&self, content: &[u8]) -> Option<Read> {
        std::fs::write(&self.path, content).unwrap();
        self.read()
    }

    /// Opens the file and reads all of it; `None` if it is told that nothing in it can be read.
    fn read(&self) -> Option<Read> {
        let mut read = None;
        let begun = work();
        let memory = allocation_counter::measure(|| {
            read = match Recording::open(&self.path) {
                Ok(mut recording) => {
                    let info = Info::of(&mut recording).unwrap();
                    // What is shown anywhere else.
                    assert!(!serde_json::to_string(&info).unwrap().is_empty());
                    let _ = recording.turns();
                    let changes: Vec<u64> = recording.revisions().iter().map(|revision| revision.from).collect();
                    changes.into_iter().for_each(|seq| drop(recording.bench_status_at(seq)));
                    Some(Read { states: states(&mut recording), info })
                }
                Err(error) => {
                    assert!(error.is_usage(), "{error}");
                    None
                }
            };
        });
        let most = MOST_MEMORY + 100 * self.path.metadata().unwrap().len();
        assert!(memory.bytes_max < most, "{} bytes at once", memory.bytes_max);
        assert!(work().saturating_sub(begun) < MOST_WORK, "it takes too long");
        read
    }

    /// Changes `cases` single bytes, each by itself, and as many again as there is time for.
    fn with_bytes_changed(&self, cases: usize, judge: impl Fn(usize, Option<&Read>)) {
        std::fs::write(&self.path, &self.whole).unwrap();
        let file = File::options().write(true).open(&self.path).unwrap();
        again(|random| {
            for _ in 0..cases {
                let place = random.usize(..self.whole.len());
                let changed = self.whole[place] ^ random.u8(1..);
                self.change(&file, place, changed, &judge);
            }
        });
    }

    fn change(&self, file: &File, place: usize, changed: u8, judge: impl Fn(usize, Option<&Read>)) {
        if std::env::var_os("WHIRL_FUZZ_TOLD").is_some() {
            let _ = writeln!(std::io::stderr(), "byte {place} set to {changed}");
        }
        file.write_all_at(&[changed], place as u64).unwrap();
        let tried = catch_unwind(AssertUnwindSafe(|| judge(place, self.read().as_ref())));
        file.write_all_at(&[self.whole[place]], place as u64).unwrap();
        tried.unwrap_or_else(|_| panic!("byte {place} set to {changed}"));
    }

    /// Whether every step that was read is one that was recorded, number for number.
    fn are_ours(&self, states: &[State]) -> bool {
        let of = |seq: u64| self.states.binary_search_by_key(&seq, |state| state.seq()).map(|at| &self.states[at]);
        states.iter().all(|state| of(state.seq()) == Ok(state))
    }
}

/// Does it from the seed, and from others as long as there is time.
fn again(mut work: impl FnMut(&mut Rng)) {
    let number = |name: &str| std::env::var(name).ok().and_then(|typed| typed.parse::<u64>().ok());
    let (budget, first) = (number("WHIRL_FUZZ_SECONDS").unwrap_or(0), number("WHIRL_FUZZ_SEED").unwrap_or(11));
    let begun = Instant::now();
    for seed in first.. {
        work(&mut Rng::with_seed(seed));
        if begun.elapsed() >= Duration::from_secs(budget) {
            return;
        }
    }
}

/// What this thread has had of a processor.
fn work() -> Duration {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(spent.tv_sec as u64, spent.tv_nsec as u32)
}

/// Most of them were read as if nothing had happened.
#[test]
fn regress_a_changed_byte_is_told_and_costs_the_message_that_it_is_in() {
    let patient = Patient::new();
    let whole = patient.with(&patient.whole).unwrap();
    assert_eq!((whole.info.checksums, whole.kinds()), (true, vec![]));
    assert_eq!(whole.states, (0..BATCHES * ROWS).map(state).collect::<Vec<_>>());
    patient.with_bytes_changed(2000, |_, read| {
        let read = read.unwrap();
        assert!(!read.info.damage.is_empty(), "not told");
        assert!(patient.are_ours(&read.states), "a changed number");
        let lost = patient.states.len() - read.states.len();
        assert!(lost == 0 || lost == ROWS as usize, "{lost} steps are lost");
        // At either end nothing tells which there were.
        let is_inside = read.states[0].seq() == 0 && read.states.last().unwrap().seq() == BATCHES * ROWS - 1;
        assert!(!is_inside || read.lost() == lost as u64, "{:?}", read.info.damage);
    });
}

/// The three that panicked and aborted, in arrow and for want of 1e15 bytes.
#[test]
fn regress_three_bytes_of_the_sample_that_panicked_or_aborted() {
    let patient = Patient::old("../../recordings/run-up.rrd");
    std::fs::write(&patient.path, &patient.whole).unwrap();
    let file = File::options().write(true).open(&patient.path).unwrap();
    for (place, changed) in [(306_670, 29), (203_945, 91), (87_687, 2)] {
        patient.change(&file, place, changed, |_, read| {
            let read = read.unwrap();
            assert_eq!(read.kinds(), [DamageKind::Unreadable], "{:?}", read.info.damage);
            let damage = &read.info.damage[0];
            assert!((damage.byte..damage.byte + damage.bytes).contains(&(place as u64)), "{damage:?}");
            assert!(patient.are_ours(&read.states));
            assert!(read.states.len() + 200 > patient.states.len(), "{} steps", read.states.len());
        });
    }
}

#[test]
fn old_files_are_gone_through_whatever_is_changed_in_them() {
    for (name, cases) in [("tests/schema-1.rrd", 400), ("../../recordings/run-up.rrd", 400)] {
        let patient = Patient::old(name);
        patient.with_bytes_changed(cases, |_, read| {
            // Without checksums a changed number reads as another; and the head is there but once.
            if let Some(read) = read {
                let lost = patient.states.len() - read.states.len();
                assert!(lost <= 200, "{lost} steps are lost: {:?}", read.info.damage);
                assert!(lost == 0 || !read.info.notices.is_empty());
            }
        });
    }
}

#[test]
fn files_that_are_cut_off_or_filled_with_zeros_are_read_up_to_there() {
    for patient in [Patient::new(), Patient::old("tests/schema-1.rrd")] {
        again(|random| {
            for _ in 0..60 {
                let cut = random.usize(..patient.whole.len());
                let zeros = [0, 1, 4096, 100_000][random.usize(..4)];
                let mut content = patient.whole[..cut].to_vec();
                content.resize(cut + zeros, 0);
                let Some(read) = patient.with(&content) else { continue };
                assert!(patient.are_ours(&read.states), "{cut}");
                assert!(!read.info.notices.is_empty(), "{cut}, {zeros}");
                assert!(
                    zeros < 4096 || read.kinds().last() == Some(&DamageKind::Zeros),
                    "{cut}: {:?}",
                    read.info.damage
                );
            }
        });
    }
}

#[test]
fn bytes_behind_the_end_are_told_even_one() {
    for patient in [Patient::new(), Patient::old("../../recordings/run-up.rrd")] {
        for tail in [&b"\0"[..], b"x", b"RRF2", &[0; 16], &[1, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0], &[7; 5000]]
        {
            let read = patient.with(&[&patient.whole[..], tail].concat()).unwrap();
            assert_eq!(read.states, patient.states);
            let [damage] = &read.info.damage[..] else { panic!("{tail:?}: {:?}", read.info.damage) };
            assert_eq!((damage.byte, damage.bytes), (patient.whole.len() as u64, tail.len() as u64), "{tail:?}");
        }
    }
}

#[test]
fn a_file_behind_another_is_read_or_told() {
    let (new, old) = (Patient::new(), Patient::old("tests/schema-1.rrd"));
    let run_up = Patient::old("../../recordings/run-up.rrd");
    for (first, second) in [(&new, &old), (&old, &new), (&run_up, &new), (&new, &run_up)] {
        let read = first.with(&[&first.whole[..], &second.whole[..]].concat()).unwrap();
        assert_eq!(read.states, first.states);
        assert_eq!(read.kinds(), [DamageKind::Other], "{:?}", read.info.damage);
        // Without the header by which one knows that another begins, too.
        let mut headless = second.whole.clone();
        headless[2] = b'X';
        let read = first.with(&[&first.whole[..], &headless[..]].concat()).unwrap();
        assert_eq!(read.states, first.states);
        assert!(read.kinds().contains(&DamageKind::Other), "{:?}", read.info.damage);
    }
    for patient in [&new, &old] {
        let read = patient.with(&[&patient.whole[..], &patient.whole[..]].concat()).unwrap();
        assert_eq!((&read.states, read.kinds()), (&patient.states, vec![DamageKind::Repeated]));
        // Of two copies one makes up for what the other has lost.
        let mut holed = patient.whole.clone();
        let hole = holed.len() / 3..holed.len() / 2;
        holed[hole].fill(0xa5);
        let read = patient.with(&[&holed[..], &patient.whole[..]].concat()).unwrap();
        assert_eq!(read.states, patient.states);
        assert!(!read.info.damage.is_empty());
    }
}

/// A file whose beginning is not there is gone on with where the next whole message begins.
#[test]
fn a_recording_whose_first_bytes_are_lost_is_read() {
    let patient = Patient::new();
    for lost in [1, 11, 12, 13, 40, 200] {
        let read = patient.with(&patient.whole[lost..]).unwrap();
        assert_eq!(read.states, patient.states, "{lost}");
        assert!(!read.info.damage.is_empty(), "{lost}");
    }
}

/// What is behind a recording may be as long as it likes, and look like the beginning of messages all over.
#[test]
fn fifty_megabytes_of_junk_behind_a_recording_cost_no_more_than_a_look() {
    const JUNK: usize = 50 << 20;
    let filled = |pattern: &[u8]| pattern.iter().copied().cycle().take(JUNK).collect::<Vec<u8>>();
    let header = |kind: u64, length: u64| [kind.to_le_bytes(), length.to_le_bytes()].concat();
    let mut random = Rng::with_seed(7);
    let noise: Vec<u8> = (0..1 << 16).map(|_| random.u8(..)).collect();
    for patient in [Patient::new(), Patient::old("tests/schema-1.rrd")] {
        let message = &patient.whole[patient.whole.len() / 4..patient.whole.len() / 2];
        // Lengths that lead to another header, far away; with the mark of a checksum behind it, and the first field's.
        let far = [header(2, 16 * 65_536), b"\x0a\x01.\xa1\xe1\x03.......\x00\x00\x00".to_vec()].concat();
        let kinds = [header(1, 1), header(2, 16 * 1_000_003), far, noise.clone(), message.to_vec(), vec![0x0a]];
        for (number, pattern) in kinds.iter().enumerate() {
            let read = patient.with(&[&patient.whole[..], &filled(pattern)].concat()).unwrap();
            assert_eq!(read.states, patient.states, "{number}");
            assert!(!read.info.damage.is_empty(), "{number}");
        }
        // And in the middle of one.
        let half = patient.whole.len() / 2;
        let (before, behind) = patient.whole.split_at(half);
        let read = patient.with(&[before, &filled(&header(2, 16 * 1_000_003)), behind].concat()).unwrap();
        assert!(read.states.len() + 200 > patient.states.len(), "{} steps: {:?}", read.states.len(), read.info.damage);
    }
}

/// Against the public reader of these files: `tests/reference/old_recordings.py`.
#[test]
fn val_files_from_before_checksums_are_read_as_ever() {
    for (name, steps, expected) in
        [("tests/schema-1.rrd", 2178, 0xc379_2e27), ("../../recordings/run-up.rrd", 2181, 0x2842_1853)]
    {
        let patient = Patient::old(name);
        let mut crc = crc32fast::Hasher::new();
        for state in &patient.states {
            let mut doubles = vec![state.tau(), state.angle(), state.speed()];
            doubles.extend(state.force_commanded().iter().chain(&state.force_delivered()));
            doubles.extend(state.points().flat_map(|point| [point.y, point.z, point.vy, point.vz]));
            // What was not told then is what it was.
            assert_eq!(state.speed_rate(), 0.0);
            assert!((0..3).all(|mass| state.reading(mass) == [state.point(mass).y, state.point(mass).z]));
            doubles.iter().for_each(|value| crc.update(&value.to_le_bytes()));
            [state.revision(), state.flags().0.into(), state.seq(), state.wall_ns()]
                .iter()
                .for_each(|v| crc.update(&v.to_le_bytes()));
        }
        assert_eq!((patient.states.len(), crc.finalize()), (steps, expected), "{name}");
        let read = patient.with(&patient.whole).unwrap();
        assert_eq!((read.info.checksums, read.kinds()), (false, vec![]));
    }
}
