//! Recordings in several files: split, rolling, around a trip.

use std::collections::BTreeMap;
use std::path::PathBuf;

use promises::{Root, Screen, run};
use tape::Recording;
use wire::Step;

use super::recorder::{Recorder, info, steps, text, wait};

#[test]
fn a_recording_is_split_rolled_or_waits_for_a_trip() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass", "--rate", "10000"]);
    let files = |stem: &str| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(root.path()).unwrap().flatten().map(|e| e.path());
        let mut files: Vec<_> =
            entries.filter(|p| p.file_name().unwrap().to_string_lossy().starts_with(stem)).collect();
        files.sort();
        files
    };
    let split = root.path().join("split.rrd");
    let recorder = Recorder::start(&root, &split, &["--split", "1MB"]);
    wait("the third part", || files("split").len() >= 3);
    assert_eq!(root.run(&["set", "kd=0.25"]).code, Some(0));
    assert_eq!(recorder.end().code, Some(0));
    let mut all = BTreeMap::new();
    for part in files("split") {
        let recording = Recording::open(&part).unwrap();
        assert!(recording.settings_at(0).is_some() && recording.rotor().len() == 3, "each can be read alone");
        assert!(!recording.notices().iter().any(|n| n.contains("killed")), "{:?}", recording.notices());
        all.extend(steps(&part));
    }
    let (first, last) = (*all.keys().next().unwrap(), *all.keys().next_back().unwrap());
    assert_eq!(all.len() as u64, last - first + 1, "nothing is lost between the parts");

    let rolling = root.path().join("roll.rrd");
    let recorder = Recorder::start(&root, &rolling, &["--keep", "2s"]);
    wait("the rolling", || files("roll-").first().is_some_and(|f| !f.ends_with("roll-1.rrd")));
    let ran = recorder.end();
    assert_eq!((ran.code, files("roll")), (Some(0), vec![rolling.clone()]), "{ran:?}");
    let told = info(&rolling);
    assert_eq!(told["lost"], 0, "{told}");
    // Steps, not seconds: a machine that is late makes fewer of them a second.
    let kept = steps(&rolling);
    let (first, last) = (*kept.keys().next().unwrap(), *kept.keys().next_back().unwrap());
    assert_eq!(kept.len() as u64, last - first + 1, "a stretch without a hole");
    assert!(first > 0 && kept.len() > 10_000, "the beginning has been let go: {first} to {last}");

    let before = root.path().join("trip.rrd");
    let recorder = Recorder::start(&root, &before, &["--pretrigger", "1s"]);
    // Two and a half times as many steps as it holds.
    let newest = || -> u64 {
        let line = root.run(&["tail", "--count", "1", "--json"]).stdout;
        serde_json::from_str::<serde_json::Value>(&line).unwrap()["seq"].as_u64().unwrap()
    };
    let begun = newest();
    wait("more than it holds", || newest() > begun + 25_000);
    assert!(!before.exists(), "nothing is written before a trip");
    assert_eq!(root.run(&["set", "trip=0.001", "--force"]).code, Some(0));
    wait("the file", || before.exists());
    let tripped = newest();
    wait("some time after it", || newest() > tripped + 25_000);
    assert_eq!(recorder.end().code, Some(0));
    let recording = Recording::open(&before).unwrap();
    let trip = recording.events().iter().find(|e| e.happening.name() == "tripped").unwrap();
    let span = recording.span().unwrap();
    // It holds a second of the clock: of a machine that is late, fewer steps.
    let wall = |seq: u64| steps(&before)[&seq].wall_ns();
    let before_trip = (wall(trip.at.seq) - wall(span.first.seq)) as f64 / 1e9;
    assert!(before_trip > 0.9 && trip.at.seq > span.first.seq, "{before_trip} s before the trip");
    assert!(span.last.seq > trip.at.seq, "and some time after it");
    assert_eq!(recording.settings_at(trip.at.seq).unwrap().settings.trip, 0.001);
    drop(simulation);
}

#[test]
fn a_split_recording_is_read_as_one_from_any_of_its_parts() {
    let root = Root::new();
    let part = |number: u32| root.path().join(format!("s-{number}.rrd"));
    let first = root.path().join("s.rrd");
    let simulation = root.simulate(&["three-mass", "--rate", "10000"]);
    let recorder = Recorder::start(&root, &first, &["--split", "1MB", "--follow"]);
    wait("the second part", || part(2).exists());
    assert_eq!(root.run(&["set", "kd=0.25"]).code, Some(0));
    wait("the fifth part", || part(5).exists());
    // Another run of the same name goes into a part of its own: its steps have the same numbers.
    drop(simulation);
    let simulation = root.simulate(&["three-mass", "--rate", "10000"]);
    let count = || {
        std::fs::read_dir(root.path())
            .unwrap()
            .flatten()
            .filter(|e| e.file_name().to_string_lossy().ends_with(".rrd"))
            .count()
    };
    let before = count() as u32;
    wait("another run", || part(before + 1).exists() || count() as u32 > before);
    let latest = || part(count() as u32);
    wait("its head", || Recording::open(&latest()).is_ok_and(|recording| recording.span().is_some()));
    assert_eq!(recorder.end().code, Some(0));
    drop(simulation);
    let all = count() as u32;
    let runs: Vec<u64> = (1..=all)
        .map(|number| if number == 1 { first.clone() } else { part(number) })
        .map(|path| Recording::open(&path).unwrap().session().run_id)
        .collect();
    let last = runs.iter().filter(|run| **run == runs[0]).count() as u32;
    assert!(last >= 5 && last < all && runs[last as usize] != runs[0], "{runs:x?}");

    // Any part leads to all of its run, and to no other.
    let whole = info(&first);
    assert_eq!(whole["parts"].as_array().unwrap().len() as u32, last, "{whole}");
    assert_eq!((&whole["lost"], &whole["settings_changes"]), (&0.into(), &1.into()), "{whole}");
    let notices = whole["notices"].to_string();
    assert!(notices.contains("with another run") && !notices.contains("killed"), "{notices}");
    for number in 2..=last {
        assert_eq!(info(&part(number)), whole, "from part {number}");
    }
    let rows: usize = (1..=last).map(|n| steps(&if n == 1 { first.clone() } else { part(n) }).len()).sum();
    assert_eq!(whole["steps"], rows, "{whole}");
    let other = info(&part(all));
    assert_ne!(other["run_id"], whole["run_id"]);
    let mixed = run(&["info", text(&first), text(&part(all))]);
    assert_eq!(mixed.code, Some(2), "{mixed:?}");
    assert!(mixed.stderr.contains("is of another run than 's.rrd'"), "{mixed:?}");

    // A table of it, and of some parts alone.
    assert_eq!(run(&["export", text(&part(3)), "--csv"]).code, Some(0));
    let table = std::fs::read_to_string(part(3).with_extension("csv")).unwrap();
    assert_eq!(table.lines().count() - 1, rows);
    let two = run(&["info", text(&part(3)), text(&part(2)), "--json"]).json();
    assert_eq!(two["steps"], steps(&part(2)).len() + steps(&part(3)).len(), "{two}");
    assert_eq!((&two["lost"], two["parts"].as_array().unwrap().len()), (&0.into(), 2), "{two}");
    assert!(two["notices"].to_string().contains("s-4.rrd is not among these"), "{two}");
    let twice = run(&["info", text(&part(3)), text(&part(3))]);
    assert!(twice.code == Some(2) && twice.stderr.contains("has too"), "{twice:?}");

    // It is played as one.
    let mut screen = Screen::start(root.path(), &["replay", text(&part(2))], (200, 50));
    screen.wait_words(&format!("s.rrd ({last} parts)"));
    screen.press("\x1b[F");
    let end = whole["last"]["step"].as_u64().unwrap();
    screen.wait_words(&format!("step {end}"));
    screen.press("q");
    assert!(screen.ended().success());

    // What is missing is said, and the rest is there.
    std::fs::remove_file(part(3)).unwrap();
    let lacking = info(&first);
    assert!(lacking["notices"].to_string().contains("s-3.rrd is not there"), "{lacking}");
    assert_eq!(lacking["parts"].as_array().unwrap().len() as u32, last - 1, "{lacking}");
    assert!(lacking["lost"].as_u64() > Some(0) && lacking["last"] == whole["last"], "{lacking}");
    assert_eq!(info(&part(4)), lacking, "from behind the gap too");
    let said = run(&["info", text(&part(5))]);
    assert!(said.stdout.contains("s-3.rrd is not there"), "{said:?}");
}

/// A rolling recording has its own name only once it has ended: until then its parts stand for it.
#[test]
fn a_rolling_recording_that_was_killed_is_found_by_its_name() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--rate", "5000"]);
    let path = root.path().join("r.rrd");
    let recorder = Recorder::start(&root, &path, &["--keep", "4s"]);
    wait("the fourth part", || root.path().join("r-4.rrd").exists());
    wait("its head", || Recording::open(&root.path().join("r-4.rrd")).is_ok());
    recorder.kill();
    assert!(!path.exists());
    let told = info(&path);
    assert!(told["parts"].as_array().unwrap().len() >= 4 && told["lost"] == 0, "{told}");
    assert!(told["notices"].to_string().contains("killed"), "{told}");
    let none = run(&["info", text(&root.path().join("t.rrd"))]);
    assert!(none.code == Some(2) && none.stderr.contains("No such file"), "{none:?}");
}
