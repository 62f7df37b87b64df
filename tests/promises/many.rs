//! Many at one bench, or at one name: who gets in, who is told what, and what is lost on the way.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use promises::{PATIENCE, Root};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

fn end(mut child: Child) {
    let _ = kill_process(Pid::from_child(&child), Signal::TERM);
    child.wait().unwrap();
}

#[test]
fn of_six_simulations_started_at_once_on_one_name_five_end_with_3() {
    let root = Root::new();
    for _ in 0..3 {
        let mut started: Vec<_> = (0..6)
            .map(|_| {
                let mut command = root.whirl();
                command.args(["sim", "--bench", "six"]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
            })
            .collect();
        let start = Instant::now();
        let mut lost = Vec::new();
        while lost.len() < 5 {
            assert!(start.elapsed() < PATIENCE, "only {} have ended", lost.len());
            let mut left = Vec::new();
            for mut child in started {
                if child.try_wait().unwrap().is_some() {
                    lost.push(child.wait_with_output().unwrap());
                } else {
                    left.push(child);
                }
            }
            started = left;
            std::thread::sleep(Duration::from_millis(5));
        }
        for refused in &lost {
            let words = String::from_utf8_lossy(&refused.stderr);
            assert_eq!(refused.status.code(), Some(3), "{words}");
            assert!(words.contains("bench 'six' is taken by a running simulation"), "{words}");
        }
        assert_eq!(root.run(&["set", "--bench", "six", "speed=1"]).code, Some(0), "the one left works");
        started.into_iter().for_each(end);
    }
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_full_house_is_said_as_such_and_keeps_nobody_from_commanding() {
    let root = Root::new();
    let simulation = root.simulate(&["--bench", "full"]);
    let mut readers = Vec::new();
    for _ in 0..16 {
        let mut command = root.whirl();
        let mut reader = command.args(["tail", "--bench", "full"]).stdout(Stdio::piped()).spawn().unwrap();
        // It has a place once it prints; then it sleeps, as the worst of readers do.
        BufReader::new(reader.stdout.take().unwrap()).read_line(&mut String::new()).unwrap();
        signal(&reader, Signal::STOP);
        readers.push(reader);
    }
    for command in [&["tail", "--bench", "full"][..], &["tail", "--bench", "full", "--events"]] {
        let refused = root.run(command);
        assert_eq!(refused.code, Some(1));
        assert!(refused.stderr.contains("bench 'full' is full: it has the 16 readers that it can take"), "{refused:?}");
    }
    let status = root.run(&["status", "--json"]).json();
    let bench = &status["benches"][0];
    let told = (&bench["name"], &bench["answers"], &bench["full"], &bench["subscribers"]);
    assert_eq!(told, (&"full".into(), &true.into(), &true.into(), &16.into()), "{bench}");
    assert!(root.run(&["status"]).stdout.contains("full: no room for more than 16 readers"));
    assert_eq!(root.run(&["set", "--bench", "full", "speed=1"]).code, Some(0));
    assert_eq!(root.run(&["note", "--bench", "full", "a full house"]).code, Some(0));
    // Who died in there leaves a place, and who has one still hears.
    let killed = readers.pop().unwrap();
    signal(&killed, Signal::KILL);
    end(killed);
    assert_eq!(root.run(&["tail", "--bench", "full", "--count", "1"]).code, Some(0));
    for reader in readers {
        signal(&reader, Signal::KILL);
        end(reader);
    }
    assert_eq!(simulation.end().code, Some(0));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_tail_that_slept_says_how_many_steps_it_lost_and_where() {
    let root = Root::new();
    let simulation = root.simulate(&["--bench", "s", "--rate", "20000"]);
    let mut command = root.whirl();
    let mut tail =
        command.args(["tail", "--bench", "s", "--json"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(tail.stdout.take().unwrap()).lines();
    let mut next = || serde_json::from_str::<Value>(&lines.next().unwrap().unwrap()).unwrap();
    let number = |line: &Value, field: &str| line[field].as_u64().unwrap();
    let mut last = next();
    assert_eq!(number(&last, "lost"), 0);
    signal(&tail, Signal::STOP);
    // Until what is kept for it has been overwritten: a bench keeps 2048 messages of up to 32 steps each.
    let steps = || root.run(&["status", "--json"]).json()["benches"][0]["steps"].as_u64().unwrap();
    let (from, start) = (steps(), Instant::now());
    while steps() < from + 100_000 {
        assert!(start.elapsed() < PATIENCE, "it does not step");
        std::thread::sleep(Duration::from_millis(100));
    }
    signal(&tail, Signal::CONT);
    let mut lost = 0;
    while lost == 0 {
        let line = next();
        lost = number(&line, "lost");
        assert_eq!(number(&line, "seq"), number(&last, "seq") + 1 + lost, "every step is printed or counted");
        last = line;
    }
    signal(&tail, Signal::INT);
    lines.by_ref().for_each(drop);
    let ended = tail.wait_with_output().unwrap();
    let words = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(130));
    assert!(words.contains("steps were lost: the output was read too slowly"), "{words}");
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn any_root_will_do_by_whirl_root_and_by_the_runtime_folder() {
    let outer = tempfile::tempdir().unwrap();
    let long = outer.path().join("a folder with a long name that no socket could bear".repeat(3)).join("m\u{fc}hle");
    std::fs::create_dir_all(&long).unwrap();
    for variable in ["WHIRL_ROOT", "XDG_RUNTIME_DIR"] {
        let run = |arguments: &[&str]| {
            let mut command = promises::whirl();
            command.env_remove("WHIRL_ROOT").env(variable, &long).args(arguments);
            command
        };
        let simulation = run(&["sim"]).stdout(Stdio::null()).spawn().unwrap();
        let set = run(&["set", "speed=1", "--json"]).output().unwrap();
        let words = String::from_utf8_lossy(&set.stderr).into_owned();
        end(simulation);
        assert!(set.status.success(), "{variable}: {words}");
    }
    assert!(long.join("lease").exists() && long.join("whirl/lease").exists());
}

#[test]
fn a_bench_that_is_not_there_is_answered_with_those_that_are() {
    let root = Root::new();
    let refused = |arguments: &[&str]| {
        let ran = root.run(arguments);
        assert!(ran.code != Some(0), "{arguments:?}: {ran:?}");
        ran.stderr
    };
    let asked: [&[&str]; 4] = [
        &["set", "--bench", "c", "speed=1"],
        &["tail", "--bench", "c", "--count", "1"],
        &["note", "--bench", "c", "here"],
        &["drill", "off", "--bench", "c"],
    ];
    // Nothing runs: how to start it.
    assert!(refused(asked[0]).contains("whirl sim --bench c"), "{}", refused(asked[0]));
    let first = root.simulate(&["jeffcott", "--bench", "a"]);
    for arguments in asked {
        assert!(refused(arguments).contains("no bench 'c' is running; there is a\n"), "{}", refused(arguments));
    }
    let second = root.simulate(&["jeffcott", "--bench", "b"]);
    for arguments in asked {
        let told = refused(arguments);
        let both = ["there are a, b\n", "there are b, a\n"].iter().any(|all| told.ends_with(all));
        assert!(told.contains("no bench 'c' is running; ") && both, "{told}");
    }
    assert_eq!((first.end().code, second.end().code), (Some(0), Some(0)));
}

#[test]
fn a_trip_limit_below_the_present_orbit_is_refused_unless_forced() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass", "--bench", "a", "--speed", "2.5"]);
    assert_eq!(root.run(&["tail", "--bench", "a", "--count", "2000"]).code, Some(0));
    let ran = root.run(&["set", "--bench", "a", "trip=0.5", "--json"]);
    let told: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(
        (ran.code, &told["accepted"], &told["orbit"]["limit"]),
        (Some(1), &false.into(), &0.5.into()),
        "{ran:?}"
    );
    let orbit = told["orbit"]["now"].as_f64().unwrap();
    assert!(orbit > 0.5 && told.get("min_damping").is_none(), "{told}");
    for words in ["trips at once: its orbit is ", " e_t, past a limit of 0.500 e_t; --force makes it all the same"] {
        assert!(ran.stderr.contains(words), "{ran:?}");
    }
    // Above the orbit it goes through, and so does what is forced, which trips as it was said.
    let above = format!("trip={}", 2.0 * orbit);
    assert_eq!(root.run(&["set", "--bench", "a", &above]).code, Some(0));
    assert_eq!(root.run(&["set", "--bench", "a", "trip=0.5", "--force"]).code, Some(0));
    let tripped = || root.run(&["status", "--json"]).json()["benches"][0]["tripped"] == true;
    let begun = std::time::Instant::now();
    while !tripped() {
        assert!(begun.elapsed().as_secs() < 60, "no trip");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    // What stands still has no orbit to speak of.
    assert_eq!(root.run(&["set", "--bench", "a", "trip=0.1"]).code, Some(0));
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn a_change_that_makes_a_stable_machine_unstable_is_refused_unless_forced() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass", "--bench", "a"]);
    let revision = || root.run(&["status", "--json"]).json()["benches"][0]["revision"].clone();
    for assignment in ["feedback=off", "cd=-2", "speed=100"] {
        let ran = root.run(&["set", "--bench", "a", assignment, "--json"]);
        let told: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!((ran.code, &told["accepted"]), (Some(1), &false.into()), "{assignment}: {ran:?}");
        let damping = |when: &str| told["min_damping"][when].as_f64().unwrap();
        assert!(damping("now") > 0.0 && damping("then") < 0.0, "{told}");
        assert!(ran.stderr.contains("it would make a stable machine unstable: minimum damping 0."), "{}", ran.stderr);
        assert!(ran.stderr.contains("--force makes it all the same"), "{}", ran.stderr);
    }
    assert_eq!(revision(), 1);
    // What leaves it stable goes through, and so does what is forced; and an unstable machine may be changed freely.
    assert_eq!(root.run(&["set", "--bench", "a", "speed=2"]).code, Some(0));
    assert_eq!(root.run(&["set", "--bench", "a", "speed=2.5", "feedback=off", "--force"]).code, Some(0));
    assert_eq!(root.run(&["set", "--bench", "a", "speed=3"]).code, Some(0));
    let same = root.run(&["set", "--bench", "a", "speed=3", "--json"]).json();
    assert_eq!((&same["accepted"], &same["changed"], &same["revision"]), (&true.into(), &false.into(), &4.into()));
    assert_eq!(revision(), 4);
    assert_eq!(simulation.end().code, Some(0));
}
