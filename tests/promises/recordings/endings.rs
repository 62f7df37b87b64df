//! How a recording ends, and what keeps one from beginning: kills, full disks, signals, places that are taken.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use promises::{Root, run};
use rustix::process::{Pid, Signal, kill_process};
use tape::Recording;

use super::recorder::{Recorder, configure, text, wait};

#[test]
fn a_recorder_that_is_killed_leaves_what_it_wrote_a_hundred_times() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--rate", "10000"]);
    let mut unreadable = 0;
    // Random enough, and the same in every run.
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    for kill in 0..100 {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let path = root.path().join(format!("k{kill}.rrd"));
        let recorder = Recorder::start(&root, &path, &[]);
        // One in four may be killed before its head is whole; the rest have as long as they need for it.
        if kill % 4 != 0 {
            wait("a whole head", || Recording::open(&path).is_ok());
        }
        std::thread::sleep(Duration::from_micros(random % 900_000 / if kill % 5 == 0 { 1 } else { 10 }));
        let status = root.run(&["status", "--json"]).json();
        recorder.kill();
        // What it has told to be written is on disk, whenever it is killed; it tells nothing of what is on its way.
        let told = status["benches"][0]["recording"]["steps"].as_u64().unwrap_or(0);
        match Recording::open(&path) {
            Ok(mut recording) => {
                assert!(recording.notices().iter().any(|n| n.contains("killed")), "{:?}", recording.notices());
                assert_eq!(recording.gaps(), []);
                let Some(span) = recording.span() else { continue };
                let mut all = Vec::new();
                recording.steps(0..u64::MAX, &mut all).unwrap();
                assert_eq!(all.len() as u64, span.last.seq - span.first.seq + 1);
                assert!(all.len() as u64 >= told, "{} of {told} steps are on disk", all.len());
            }
            // Killed before even the head was whole.
            Err(error) => {
                assert!(
                    error.to_string().contains("nothing of whirl's")
                        || error.to_string().contains("No such file")
                        || error.to_string().contains("too short"),
                    "{error}"
                );
                unreadable += 1;
            }
        }
        let _ = std::fs::remove_file(&path);
    }
    assert!(unreadable <= 25, "whose head was seen can be read: {unreadable}");
    // The next recorder finds the bench free.
    let path = root.path().join("last.rrd");
    let recorder = Recorder::start(&root, &path, &[]);
    wait("a first stretch", || path.metadata().is_ok_and(|found| found.len() > 100_000));
    assert_eq!(recorder.end().code, Some(0));
    let ran = run(&["info", text(&path)]);
    assert!(ran.code == Some(0) && ran.stdout.contains("0 lost"), "{ran:?}");
}

#[test]
fn places_that_are_taken_missing_or_full_are_said_at_once() {
    let root = Root::new();
    let _simulation = root.simulate(&["jeffcott"]);
    let taken = root.path().join("taken.rrd");
    std::fs::write(&taken, "mine").unwrap();
    let record = |path: &Path, options: &[&str]| root.run(&[&["record", text(path)], options].concat());
    for (path, options, code, why) in [
        (taken.clone(), &[][..], 2, "is already there"),
        (root.path().join("no/s.rrd"), &[], 2, "No such file or directory"),
        (root.path().join("s.mcap"), &[], 2, "ends in .rrd"),
        (root.path().join("s.rrd"), &["--bench", "b"], 3, "no bench 'b' is running"),
        (root.path().join("s.rrd"), &["--pretrigger", "100h"], 2, "too many to hold in memory"),
        (root.path().join("s.rrd"), &["--keep", "10m"], 2, "expected a duration"),
        (root.path().join("s.rrd"), &["--min-free", "900000GB"], 1, "to be kept free"),
    ] {
        let ran = record(&path, options);
        assert_eq!(ran.code, Some(code), "{options:?}: {ran:?}");
        assert!(ran.stderr.contains(why), "{options:?}: {ran:?}");
    }
    assert_eq!(std::fs::read(&taken).unwrap(), b"mine");

    let config = configure(&root, "[alarms]\norbit = [5, 3]\n");
    let ran = record(&root.path().join("s.rrd"), &[]);
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(ran.stderr.contains("config.toml:2:9: orbit = [5, 3]: expected the alarm at or above"), "{ran:?}");
    std::fs::remove_file(config).unwrap();

    let first = root.path().join("first.rrd");
    let recorder = Recorder::start(&root, &first, &[]);
    let second = record(&root.path().join("second.rrd"), &[]);
    assert_eq!(second.code, Some(3), "one recorder a bench: {second:?}");
    // Deleted under its hands: it must not write into nothing.
    std::fs::remove_file(&first).unwrap();
    let ran = recorder.wait();
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains("has been deleted"), "{ran:?}");
}

#[test]
fn a_full_disk_ends_the_recording_at_once_and_leaves_it_readable() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--rate", "10000"]);
    let path = root.path().join("s.rrd");
    // A limit on the size of files stands for a disk that is full: the same refusal in the middle of a write.
    let mut command = Command::new("sh");
    let limited = "trap '' XFSZ; ulimit -f 4000; exec \"$0\" record \"$1\" --as-child";
    command.args(["-c", limited]).arg(promises::program()).arg(&path).env("WHIRL_ROOT", root.path());
    let ran = Recorder::of(&mut command).wait();
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains("cannot go on writing") && ran.stderr.contains("stays readable"), "{ran:?}");
    let mut recording = Recording::open(&path).unwrap();
    assert!(recording.rows() > 1000 && recording.gaps().is_empty());
    assert_eq!(recording.notices().len(), 2, "not cut, only ended: {:?}", recording.notices());
    let mut all = Vec::new();
    recording.steps(0..u64::MAX, &mut all).unwrap();
    assert_eq!(all.len() as u64, recording.rows());
}

#[test]
fn a_recording_ends_with_the_simulation_and_with_a_signal() {
    let root = Root::new();
    for ends_by_signal in [false, true] {
        let simulation = root.simulate(&["jeffcott"]);
        let path = root.path().join(format!("{ends_by_signal}.rrd"));
        let recorder = Recorder::start(&root, &path, &[]);
        wait("a first stretch", || path.metadata().is_ok_and(|found| found.len() > 30_000));
        let ran = if ends_by_signal {
            kill_process(Pid::from_raw(recorder.child.id() as i32).unwrap(), Signal::INT).unwrap();
            recorder.wait()
        } else {
            assert_eq!(simulation.end().code, Some(0));
            recorder.wait()
        };
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let why = if ends_by_signal { "asked to stop" } else { "the simulation ended" };
        assert!(ran.stdout.contains(why), "{ran:?}");
        assert!(!Recording::open(&path).unwrap().notices().iter().any(|n| n.contains("killed")));
    }
}
