//! What is recorded goes where it belongs, without any file being written.

use std::sync::{Arc, Mutex};

use alarms::{Level, LevelChange, Watch};
use files::Existing;
use wire::message::Trip;
use wire::{Channel, SettingsDocument, State, StepLayout};

use super::*;
use crate::batch::Batch;

/// What was written, file by file.
type Log = Arc<Mutex<Vec<String>>>;

/// A sink that notes what it is given; each step counts for a hundred bytes.
struct Noting {
    name: String,
    log: Log,
    bytes: u64,
}

impl Noting {
    fn note(&mut self, what: &str) -> Result<(), TapeError> {
        self.log.lock().unwrap().push(format!("{} {what}", self.name));
        Ok(())
    }
}

impl Sink for Noting {
    fn steps(&mut self, batch: &Batch) -> Result<(), TapeError> {
        self.bytes += 100 * batch.len() as u64;
        self.note(&format!("{}..={}", batch.seq[0], batch.seq[batch.len() - 1]))
    }

    fn revision(&mut self, revision: &Revision, _: Moment) -> Result<(), TapeError> {
        self.note(&format!("revision {}", revision.revision))
    }

    fn event(&mut self, event: &Event) -> Result<(), TapeError> {
        self.note(event.happening.name())
    }

    fn remark(&mut self, remark: &Remark) -> Result<(), TapeError> {
        self.note(&remark.text())
    }

    fn snapshot(&mut self, snapshot: crate::Snapshot, _: Moment) -> Result<(), TapeError> {
        self.note(&format!("snapshot {}", snapshot.next))
    }

    fn health(&mut self, _: &BenchStatus, _: Moment) -> Result<(), TapeError> {
        Ok(())
    }

    fn bytes(&self) -> u64 {
        self.bytes
    }

    fn finish(self: Box<Self>) -> Result<u64, TapeError> {
        Ok(self.bytes)
    }
}

struct Bench {
    rotation: FileRotation,
    log: Log,
    folder: tempfile::TempDir,
}

impl Bench {
    fn new(keep: Keep) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let log = Log::default();
        let shared = log.clone();
        let open: Open = Box::new(move |path, _| {
            std::fs::write(path, "").unwrap();
            Ok(Box::new(Noting { name: name(path), log: shared.clone(), bytes: 0 }))
        });
        let subject = Subject { bench: "rig".into(), limits: Limits::default() };
        let rotation = FileRotation::with(&folder.path().join("s.rrd"), subject, keep, open).unwrap();
        Self { rotation, log, folder }
    }

    fn run(&mut self) {
        self.rotation.take(Item::Run(bench_status(), Moment::default())).unwrap();
    }

    /// One second of steps at 10 a second.
    fn second(&mut self, second: u64) {
        let mut batch = Batch::new(StepLayout::new(3));
        for seq in 10 * second..10 * (second + 1) {
            let wall_ns = 1_000_000_000_000 + seq * 100_000_000;
            let state = State::new(StepLayout::new(3)).with_word(Channel::RunId, 1).with_word(Channel::Seq, seq);
            batch.push(&state.with_word(Channel::WallNs, wall_ns));
        }
        self.rotation.take(Item::Steps(batch)).unwrap();
    }

    fn event(&mut self, happening: &Happening, revision: u64) {
        let mut event = happening.event();
        (event.run_id, event.revision, event.settings) = (1, revision, bench_status().settings);
        self.rotation.take(Item::Event(event)).unwrap();
    }

    fn log(&self) -> Vec<String> {
        std::mem::take(&mut self.log.lock().unwrap())
    }

    fn files(&self) -> Vec<String> {
        let mut files: Vec<_> =
            std::fs::read_dir(self.folder.path()).unwrap().flatten().map(|e| name(&e.path())).collect();
        files.sort();
        files
    }
}

fn bench_status() -> Box<BenchStatus> {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let off = rotor::builtin::feedback(&rotor, "off").unwrap();
    let settings = rotor::Settings::new(&rotor, 1.0, off);
    let settings = SettingsDocument::of(&settings);
    let mut bench_status = Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
        run_id: 1,
        revision: 1,
        ..wire::message::BenchStatusMessage::default()
    }));
    bench_status.set_rotor(&rotor);
    bench_status.settings = settings;
    bench_status
}

fn keep(keeping: Keeping) -> Keep {
    Keep { keeping, split: None, min_free: 0, existing: Existing::Keep }
}

#[test]
fn every_part_of_a_split_recording_can_be_read_alone() {
    let mut bench = Bench::new(Keep { split: Some(1500), ..keep(Keeping::All) });
    bench.run();
    bench.second(0);
    bench.event(&Happening::Settings, 2);
    bench.second(1);
    bench.second(2);
    let said = bench.log();
    assert_eq!(
        said,
        [
            "s.rrd revision 1",
            "s.rrd recording begins",
            "s.rrd 0..=9",
            "s.rrd revision 2",
            "s.rrd settings",
            "s.rrd 10..=19",
            "s.rrd recording goes on in s-2.rrd",
            "s-2.rrd revision 2",
            "s-2.rrd recording begins",
            "s-2.rrd 20..=29",
        ]
    );
    let files = bench.rotation.finish("enough").unwrap();
    assert_eq!(files.iter().map(|f| name(f)).collect::<Vec<_>>(), ["s.rrd", "s-2.rrd"]);
}

fn alarm(seq: u64, level: Level) -> Item {
    let before = if level == Level::Fine { Level::Alarm } else { Level::Fine };
    let at = Moment { seq, ..Moment::default() };
    let (watch, cause) = (Watch::Damping, String::new());
    let turn = LevelChange { at, watch, before, level, value: seq as f64, limit: 0.0, worst: 0.0, cause };
    Item::Remark(Remark { at, what: What::Alarm(turn) })
}

#[test]
fn an_alarm_in_force_stands_at_the_head_of_every_part_until_it_ends() {
    let mut bench = Bench::new(Keep { split: Some(1000), ..keep(Keeping::All) });
    bench.run();
    bench.second(0);
    bench.rotation.take(alarm(5, Level::Alarm)).unwrap();
    bench.second(1);
    bench.second(2);
    bench.rotation.take(alarm(25, Level::Fine)).unwrap();
    bench.second(3);
    let said = bench.log();
    let told: Vec<&str> = said.iter().filter(|line| line.contains("damping")).map(String::as_str).collect();
    let rose = "alarm: damping 5, limit 0";
    let [again, further] = [2, 3].map(|part| format!("s-{part}.rrd {rose}"));
    let fell = "s-3.rrd damping within its limits again: 25, at worst 0";
    assert_eq!(told, [&format!("s.rrd {rose}"), &again, &further, fell], "{said:?}");
}

#[test]
fn an_alarm_before_the_time_that_a_trip_looks_back_is_told_all_the_same() {
    let mut bench = Bench::new(keep(Keeping::Pretrigger(3.0)));
    bench.run();
    bench.second(0);
    bench.rotation.take(alarm(5, Level::Warning)).unwrap();
    (1..20).for_each(|second| bench.second(second));
    bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 1);
    let said = bench.log();
    assert_eq!(said[2], "s.rrd warning: damping 5, limit 0", "{said:?}");
}

#[test]
fn a_rolling_recording_lets_go_of_what_is_too_old() {
    let mut bench = Bench::new(keep(Keeping::Last(16.0)));
    bench.run();
    (0..40).for_each(|second| bench.second(second));
    // Parts of two seconds; those that end more than sixteen ago are gone.
    let files = bench.files();
    assert!((9..=10).contains(&files.len()), "{files:?}");
    assert!(!files.contains(&"s-1.rrd".to_owned()) && files.contains(&"s-20.rrd".to_owned()), "{files:?}");
    assert!(bench.rotation.bytes() <= 100 * 10 * 19, "{}", bench.rotation.bytes());
}

#[test]
fn a_trip_writes_what_came_before_it_under_the_settings_of_then() {
    let mut bench = Bench::new(keep(Keeping::Pretrigger(3.0)));
    bench.run();
    (0..10).for_each(|second| bench.second(second));
    bench.event(&Happening::Settings, 2);
    (10..20).for_each(|second| bench.second(second));
    bench.event(&Happening::Settings, 3);
    bench.second(20);
    assert!(bench.log().is_empty() && bench.files().is_empty());
    bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 3);
    let said = bench.log();
    assert_eq!(
        said,
        [
            "s.rrd revision 2",
            "s.rrd recording begins",
            "s.rrd 170..=179",
            "s.rrd 180..=189",
            "s.rrd 190..=199",
            "s.rrd revision 3",
            "s.rrd settings",
            "s.rrd 200..=209",
            "s.rrd tripped",
        ]
    );
    (21..30).for_each(|second| bench.second(second));
    let said = bench.log();
    assert_eq!(said.last().unwrap(), "s.rrd recording ends: 3 s after the trip are over");
    assert_eq!(said.len(), 4, "three seconds after it, and the end: {said:?}");
    // The next trip has a file of its own.
    bench.event(&Happening::Restarted, 3);
    bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 3);
    assert_eq!(bench.log()[0], "s-2.rrd revision 3");
    assert_eq!(bench.files(), ["s-2.rrd", "s.rrd"]);
}

/// It ended with the last steps that had been heard before the trip: half a second early.
#[test]
fn regress_the_time_after_a_trip_is_whole() {
    let mut bench = Bench::new(keep(Keeping::Pretrigger(3.0)));
    bench.run();
    (0..=20).for_each(|second| bench.second(second));
    // At 21.8 s, before its own steps are heard, as events are.
    let mut event = Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }).event();
    (event.run_id, event.revision, event.settings) = (1, 1, bench_status().settings);
    event.wall_ns = 1_000_000_000_000 + 21_800_000_000;
    bench.rotation.take(Item::Event(event)).unwrap();
    (21..40).for_each(|second| bench.second(second));
    let said = bench.log();
    let after: Vec<&String> = said.iter().rev().take(2).collect();
    assert_eq!(after, ["s.rrd recording ends: 3 s after the trip are over", "s.rrd 240..=249"], "to 24.8 s and more");
}

#[test]
fn another_run_is_another_file() {
    let mut bench = Bench::new(keep(Keeping::All));
    bench.run();
    bench.second(0);
    bench.run();
    bench.second(0);
    assert_eq!(bench.rotation.finish("enough").unwrap().len(), 2);
}

#[test]
fn what_is_no_place_for_a_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("there.rrd");
    std::fs::write(&there, "").unwrap();
    for (path, why) in [
        (there, "is already there"),
        (folder.path().join("no/s.rrd"), "no folder to record into"),
        (folder.path().join("s.csv"), "ends in .rrd"),
        (folder.path().join("there.rrd/s.rrd"), "is no folder"),
    ] {
        let told = check(&path, &keep(Keeping::All)).unwrap_err().to_string();
        assert!(told.contains(why), "{told}");
    }
    // Hours later the second part would not find its place.
    std::fs::write(folder.path().join("s-7.rrd"), "").unwrap();
    let path = folder.path().join("s.rrd");
    let split = |existing| Keep { split: Some(1000), existing, ..keep(Keeping::All) };
    check(&path, &keep(Keeping::All)).unwrap();
    for kept in [split(Existing::Keep), keep(Keeping::Last(60.0))] {
        let told = check(&path, &kept).unwrap_err().to_string();
        assert!(told.contains("s-7.rrd' is already there"), "{told}");
    }
    check(&path, &split(Existing::Replace)).unwrap();
    check(&folder.path().join("there.rrd"), &split(Existing::Replace)).unwrap();
}

/// What a part begins with leads to its first step.
#[test]
fn the_last_snapshot_stands_at_the_head_of_every_part() {
    let snapshot = |next| {
        let at = Moment { seq: next, ..Moment::default() };
        Item::Snapshot(crate::Snapshot { next, dtau: 0.01, words: vec![1, 2] }, at)
    };
    let mut bench = Bench::new(Keep { split: Some(1500), ..keep(Keeping::All) });
    bench.run();
    (0..2).for_each(|second| bench.second(second));
    bench.rotation.take(snapshot(18)).unwrap();
    bench.second(2);
    let log = bench.log();
    let at = |what: &str| log.iter().position(|line| line == what).unwrap_or_else(|| panic!("{what}: {log:?}"));
    assert!(at("s.rrd snapshot 18") < at("s-2.rrd snapshot 18") && at("s-2.rrd snapshot 18") < at("s-2.rrd 20..=29"));

    let mut bench = Bench::new(keep(Keeping::Pretrigger(2.0)));
    bench.run();
    for second in 0..6 {
        bench.second(second);
        bench.rotation.take(snapshot(10 * second + 7)).unwrap();
    }
    bench.event(&Happening::Tripped(Trip::default()), 1);
    let log = bench.log();
    let told: Vec<&str> = log.iter().filter(|line| line.contains("snapshot")).map(String::as_str).collect();
    // The one before it at the head.
    assert_eq!(told, [17, 27, 37, 47, 57].map(|next| format!("s.rrd snapshot {next}")), "{log:?}");
    assert!(log.contains(&"s.rrd 30..=39".to_owned()) && !log.contains(&"s.rrd 20..=29".to_owned()), "{log:?}");
}
