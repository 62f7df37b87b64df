//! Files: what is written is what is read, whole or cut off anywhere. With the cargo feature `rerun`.
#![cfg(feature = "rerun")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking, as tests do")]

mod common;

use std::ops::ControlFlow;
use std::path::Path;

use alarms::{Level, LevelChange, Limit, Limits, Watch};
use common::{RUN, at, batch, bench_status, state, states};
use rotor::builtin;
use tape::{Event, Head, Info, Recording, Remark, What};
use wire::message::Trip;
use wire::{Happening, SettingsDocument, State, Step, Text};

/// A recording of steps 100 to 5100 with 50 missing, a change of settings and a trip.
fn write(path: &Path) -> Vec<u64> {
    let head = Head::live(bench_status(), "rig").judged_by(limits());
    let mut sink = tape::create(path, &head).unwrap();
    let mut ends = vec![];
    sink.revision(&head.revision(), at(100)).unwrap();
    for first in (100..2100).step_by(500) {
        sink.steps(&batch(first..first + 500)).unwrap();
        sink.health(&bench_status(), at(first + 499)).unwrap();
        ends.push(sink.bytes());
    }
    let mut event = Happening::Settings.event();
    let mut settings = bench_status().settings.get().clone();
    settings.assign("kd", "-0.125").unwrap();
    event.settings = SettingsDocument::of(&settings);
    (event.run_id, event.number, event.seq, event.tau, event.revision) = (RUN, 9, 2100, 21.0, 4);
    (event.who, event.why) = (Text::new("dash:7"), Text::new("typed"));
    let told = Event::from(&*event);
    let mut changed = head.revision();
    (changed.revision, changed.from, changed.settings) = (4, 2100, settings);
    sink.revision(&changed, told.at).unwrap();
    sink.event(&told).unwrap();
    sink.remark(&Remark { at: at(2150), what: What::Lost(50) }).unwrap();
    for turn in turns() {
        // As a part that goes on from another has it.
        (0..2).for_each(|_| sink.remark(&Remark { at: turn.at, what: What::Alarm(turn.clone()) }).unwrap());
    }
    for first in (2150..5150).step_by(500) {
        sink.steps(&batch(first..first + 500)).unwrap();
        ends.push(sink.bytes());
    }
    let trip = Trip { cause: 1, mass: 2, step: 5000, radius: 1000.5, limit: 1000.0 };
    let mut event = Happening::Tripped(trip).event();
    (event.run_id, event.number, event.seq, event.tau, event.revision) = (RUN, 10, 5000, 50.0, 4);
    sink.event(&Event::from(&*event)).unwrap();
    sink.remark(&Remark { at: at(5149), what: What::Ends("asked to stop".into()) }).unwrap();
    assert_eq!(sink.finish().unwrap(), path.metadata().unwrap().len());
    ends
}

/// An alarm that rises twice and falls once.
fn turns() -> Vec<LevelChange> {
    let turn = |seq, before, level, value: f64, worst| {
        let (watch, limit, cause) = (Watch::Orbit, 1.0 / 3.0, String::new());
        LevelChange { at: at(seq), watch, before, level, value, limit, worst, cause }
    };
    vec![
        turn(2200, Level::Fine, Level::Warning, 0.4, 0.4),
        turn(2210, Level::Warning, Level::Fine, 0.1 + 0.2, 0.5),
        turn(3000, Level::Fine, Level::Alarm, 0.9, 0.9),
    ]
}

fn limits() -> Limits {
    Limits::none().having(Watch::Orbit, Limit::above(1.0 / 3.0, 0.5))
}

#[test]
fn what_is_written_is_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    write(&path);
    let mut recording = Recording::open(&path).unwrap();
    let session = recording.session();
    assert_eq!((session.run_id, session.bench.as_str(), session.rate_hz, session.dtau), (RUN, "rig", 1000.0, 0.01));
    assert_eq!(recording.rotor(), &builtin::rotor("three-mass").unwrap());
    let expected: Vec<State> = (100..2100).chain(2150..5150).map(state).collect();
    let read = states(&mut recording);
    assert_eq!(read, expected);
    assert!(read.iter().all(|s| s.point(0).vy.is_sign_negative()), "even the sign of zero");
    assert_eq!(recording.rows(), expected.len() as u64);
    assert_eq!(recording.gaps(), [tape::Gap { from: 2100, count: 50 }]);

    let mut some = Vec::new();
    recording
        .visit(590..610, 5, |s| {
            some.push(s.seq());
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(some, [590, 595, 600, 605]);
    assert_eq!(recording.seq_at_wall(at(777).wall_ns + 10).unwrap(), 777);
    assert_eq!(recording.seq_at_wall(0).unwrap(), 100);
    assert_eq!(recording.seq_at_tau(7.775).unwrap(), 777);

    assert_eq!(recording.settings_at(2099).unwrap().revision, 3);
    let changed = recording.settings_at(2100).unwrap();
    assert_eq!((changed.revision, changed.settings.feedback.bearings[0].signals[0].gains[0].at(2.5)), (4, -0.125));
    let before = recording.bench_status_at(2000);
    assert_eq!((before.revision, before.changed_by.as_str(), before.trip.is_tripped()), (3, "set:1", false));
    assert_eq!(before.settings.get().clone(), bench_status().settings.get().clone());
    assert_eq!(before.analysis.count, 6);
    assert!(recording.bench_status_at(5000).trip.is_tripped());
    let events = recording.events();
    assert_eq!(events.iter().map(|e| e.number).collect::<Vec<_>>(), [9, 10]);
    assert_eq!(events[0].text(), "settings changed by dash:7 (typed)");
    assert_eq!(session_limits(&recording), limits());
    let mut told = recording.turns();
    let tripped = told.pop().unwrap();
    assert_eq!((told, tripped.watch, tripped.at.seq), (turns(), Watch::Trip, 5000), "each once, and the trip");
    let events = recording.events();
    let sent = recording.wire_event(&events[0]);
    assert_eq!(sent.settings.get().clone().feedback.bearings[0].signals[0].gains[0].at(2.5), -0.125);
    let notices = recording.notices();
    assert_eq!(notices.len(), 2, "{notices:?}");
    assert!(notices[0].starts_with("begins at step 100") && notices[1].starts_with("50 steps are missing"));
}

fn session_limits(recording: &Recording) -> Limits {
    recording.session().limits.clone().unwrap()
}

#[test]
fn alarms_are_in_the_page_about_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    write(&path);
    let info = Info::of(&mut Recording::open(&path).unwrap()).unwrap();
    let told: Vec<_> = info.alarms.iter().map(|a| (a.watch, a.level, a.from.step, a.to.map(|to| to.step))).collect();
    assert_eq!(told, [("orbit", "warning", 2200, Some(2210)), ("orbit", "alarm", 3000, None)]);
    assert_eq!((info.alarms[0].worst, info.alarms[0].limit), (0.5, 1.0 / 3.0));
    // The second one never ended: the steps tell how far it went.
    let radius = |seq: u64| state(seq).largest_radius();
    assert_eq!(info.alarms[1].worst, (3000..5150).map(radius).fold(0.9, f64::max));
    let pairs = info.alarm_limits.unwrap();
    assert_eq!((pairs["orbit"], pairs["damping"]), (Some([1.0 / 3.0, 0.5]), None));
}

#[test]
fn a_file_cut_off_anywhere_reads_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    let ends = write(&path);
    let whole = std::fs::read(&path).unwrap();
    let cut = folder.path().join("cut.rrd");
    let mut random = fastrand::Rng::with_seed(7);
    let first = whole.len() as u64 - 64;
    let cuts = (0..150).map(|i| if i < 64 { first + i } else { random.u64(..whole.len() as u64) }).chain(ends.clone());
    for at in cuts {
        std::fs::write(&cut, &whole[..at as usize]).unwrap();
        // Steps whose message is whole are there: that is all that a kill may cost.
        let expected: u64 = ends.iter().filter(|end| **end <= at).count() as u64 * 500;
        match Recording::open(&cut) {
            Ok(mut recording) => {
                let read = states(&mut recording);
                assert!(read.len() as u64 == expected || read.len() as u64 == expected + 500, "{at}: {}", read.len());
                assert!(read.iter().all(|s| *s == state(s.seq())));
                let is_whole = at == whole.len() as u64;
                assert!(is_whole || !recording.notices().is_empty());
            }
            Err(error) => {
                assert!(expected == 0 && error.is_usage(), "{at}: {error}");
            }
        }
    }
}

#[test]
fn damage_in_the_middle_is_said_and_costs_what_it_hits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    let ends = write(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    // In the middle of the third stretch of steps.
    let place = (ends[1] + ends[2]) as usize / 2;
    bytes[place..place + 2000].fill(0xa5);
    std::fs::write(&path, bytes).unwrap();
    let mut recording = Recording::open(&path).unwrap();
    let notices = recording.notices().join("\n");
    assert!(notices.contains("damaged"), "{notices}");
    assert!(states(&mut recording).len() >= 1000);
}

#[test]
fn what_is_no_recording_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    for (content, why) in [
        (&b""[..], "0 bytes are too short"),
        (b"tau,y1\n1,2\n3,4\n", "expected an .rrd recording of whirl"),
        (b"RRF2", "4 bytes are too short"),
    ] {
        std::fs::write(&path, content).unwrap();
        let error = Recording::open(&path).err().unwrap();
        assert!(error.is_usage() && error.to_string().contains(why), "{error}");
    }
    assert!(Recording::open(folder.path()).err().unwrap().to_string().contains("is no file"));
    let missing = Recording::open(&folder.path().join("b.rrd")).err().unwrap();
    assert!(missing.to_string().contains("No such file"), "{missing}");
}

#[test]
fn a_place_that_is_taken_or_missing_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    let head = Head::live(bench_status(), "rig");
    tape::create(&path, &head).unwrap().finish().unwrap();
    let refused = |path: &Path| tape::create(path, &head).err().unwrap();
    assert!(refused(&path).to_string().contains("is already there"));
    assert!(refused(&folder.path().join("no/a.rrd")).to_string().contains("No such file or directory"));
}

/// A sample that was written by schema version 1 before there were alarms stays readable.
#[test]
fn regress_a_recording_of_schema_1_is_read() {
    let recording = is_a_run_up_that_was_saved(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/schema-1.rrd"));
    assert_eq!((recording.session().limits.clone(), recording.turns().len()), (None, 2), "the trip and its end");
}

/// The sample in `recordings/` tells its story in alarms too.
#[test]
fn the_sample_is_what_its_readme_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../recordings/run-up.rrd");
    assert!(path.metadata().unwrap().len() < 1_000_000);
    let recording = is_a_run_up_that_was_saved(&path);
    let turns = recording.turns();
    let first = |watch, level| turns.iter().find(|turn| (turn.watch, turn.level) == (watch, level)).unwrap().at.seq;
    let unstable = first(Watch::Damping, Level::Alarm);
    assert!(unstable < first(Watch::Orbit, Level::Warning));
    assert!(first(Watch::Orbit, Level::Alarm) < first(Watch::Trip, Level::Alarm));
    assert!(first(Watch::Trip, Level::Alarm) < first(Watch::Orbit, Level::Fine));
    assert_eq!(recording.settings_at(unstable).unwrap().from, unstable, "from the step of the change");
}

/// Unstable, tripped, restarted under better gains, kicked, and quiet.
fn is_a_run_up_that_was_saved(path: &Path) -> Recording {
    let mut recording = Recording::open(path).unwrap();
    assert_eq!((recording.session().schema, recording.rotor().name()), (1, "three-mass"));
    let read = states(&mut recording);
    assert_eq!(read.len() as u64, recording.rows());
    assert!(recording.gaps().is_empty() && read.len() > 2000);
    let names: Vec<&str> = recording.events().iter().map(|e| e.happening.name()).filter(|n| *n != "late").collect();
    let at = |name: &str| names.iter().position(|n| *n == name).unwrap();
    assert!(at("tripped") < at("restarted") && at("restarted") < at("note") && at("note") < at("impulse"), "{names:?}");
    let tripped = recording.events().iter().find(|e| e.happening.name() == "tripped").unwrap();
    let before = recording.settings_at(tripped.at.seq).unwrap();
    assert!(before.min_damping < 0.0 && before.settings.speed == 2.2);
    assert!(recording.bench_status_at(tripped.at.seq).trip.is_tripped());
    let after = recording.revisions().last().unwrap();
    assert!(after.min_damping > 0.0 && after.settings.speed == 3.2);
    let last = read.last().unwrap();
    assert!(last.points().all(|p| p.radius() < 5.0) && last.flags().names().iter().all(|n| n != "tripped"));
    recording
}
