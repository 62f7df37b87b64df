//! A simulation without a dashboard: `sim`, `set`, `tail`, `status`, `clean`.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::process::Stdio;

use promises::Root;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn settings_change_between_two_steps_and_everybody_sees_it() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass", "--bench", "a"]);
    let answer = root.run(&["set", "--bench", "a", "speed=3", "kd=0.1", "--json"]).json();
    assert_eq!((&answer["accepted"], &answer["revision"]), (&true.into(), &2.into()));
    let applied = answer["applied_at_step"].as_u64().unwrap();

    let tail = root.run(&["tail", "--bench", "a", "--count", "3", "--json"]);
    let states = lines(&tail.stdout);
    assert_eq!(states.len(), 3);
    for (state, next) in states.iter().zip(&states[1..]) {
        assert_eq!(next["seq"].as_u64().unwrap(), state["seq"].as_u64().unwrap() + 1);
    }
    let state = &states[0];
    assert!(state["seq"].as_u64().unwrap() >= applied);
    assert_eq!((&state["speed"], &state["revision"]), (&3.0.into(), &2.into()));
    assert_eq!(state["masses"].as_array().unwrap().len(), 3);
    assert!(["y", "z", "vy", "vz"].iter().all(|field| state["masses"][2][field].is_f64()));
    assert!(state["force"]["y"].is_f64() && state["flags"].is_array() && state["tau"].is_f64());

    let status = root.run(&["status", "--json"]).json();
    let bench = &status["benches"][0];
    assert_eq!((&bench["name"], &bench["rotor"], &bench["speed"]), (&"a".into(), &"three-mass".into(), &3.0.into()));
    assert_eq!(
        (&bench["rate_hz"], &bench["recording"], &bench["tripped"]),
        (&1000.0.into(), &Value::Null, &false.into())
    );
    for field in ["steps", "missed", "subscribers"] {
        assert!(bench[field].is_u64(), "{field} of {bench}");
    }
    for field in ["p50", "p99", "max"] {
        assert!(bench["lateness_us"][field].is_f64(), "{field} of {bench}");
    }
    assert_eq!(bench["run_id"], state["run_id"]);

    let ran = simulation.end();
    assert_eq!((ran.code, ran.stderr.as_str(), ran.stdout.lines().count()), (Some(0), "", 1), "{ran:?}");
    assert!(ran.stdout.starts_with("bench a: three-mass, "), "{}", ran.stdout);
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn status_and_events_tell_an_si_rotor_in_its_units() {
    let root = Root::new();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/three-mass-si.toml");
    let simulation = root.simulate(&[file, "--bench", "rig", "--speed", "3000"]);
    let status = || root.run(&["status"]).stdout;
    let table = status();
    assert!(table.contains("3000.00 rpm"), "{table}");
    let set = root.run(&["set", "--bench", "rig", "trip=1e-7", "--force"]);
    assert_eq!(set.code, Some(0), "{set:?}");
    let patience = std::time::Instant::now();
    while !status().contains("TRIPPED") {
        assert!(patience.elapsed().as_secs() < 120, "{}", status());
    }
    let table = status();
    assert!(table.contains("past the limit of 0.0000001 m") && !table.contains("e_t"), "{table}");
    // Scripts read what they always read.
    let bench = &root.run(&["status", "--json"]).json()["benches"][0];
    assert!((bench["speed"].as_f64().unwrap() - std::f64::consts::FRAC_PI_3).abs() < 1e-6, "{bench}");
    let ran = simulation.end();
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

#[test]
fn a_bench_that_is_just_starting_is_waited_for() {
    let root = Root::new();
    // As a shell does with `whirl sim --bench a & whirl set --bench a speed=3`.
    let mut simulation = root.whirl().args(["sim", "--bench", "a"]).stdout(Stdio::null()).spawn().unwrap();
    let set = root.run(&["set", "--bench", "a", "speed=3", "kd=0.1"]);
    let tail = root.run(&["tail", "--bench", "a", "--count", "3", "--json"]);
    kill_process(Pid::from_raw(simulation.id() as i32).unwrap(), Signal::TERM).unwrap();
    simulation.wait().unwrap();
    assert_eq!(set.code, Some(0), "{set:?}");
    assert_eq!((tail.code, lines(&tail.stdout).len()), (Some(0), 3), "{tail:?}");
}

#[test]
fn what_is_wrong_changes_nothing_and_says_why() {
    let root = Root::new();
    let _simulation = root.simulate(&["jeffcott"]);
    for (assignments, reason) in [
        (
            &["sped=1"][..],
            "no setting 'sped': did you mean 'speed'? there are speed, ramp, deadband, kd, cd, kc, cc, trip, coast_down, sensor_lag, noise",
        ),
        (&["speed"], "'speed': expected KEY=VALUE"),
        (&["speed=fast"], "speed = 'fast': expected a number"),
        (&["speed=nan"], "speed = NaN: expected a number from 0 to 1000"),
        (&["speed=inf"], "speed = inf: expected a number from 0 to 1000"),
        (&["speed=3", "deadband=-1"], "deadband = -1: expected a number from 0 to 1000000"),
        (&["kd.2=1"], "no kd.2: there are 1 signals"),
        (&["deadband.2=1"], "no deadband.2: there are 1 masses"),
        (&["feedback=composite"], "no feedback 'composite' for jeffcott: built in are off, cancel"),
    ] {
        let ran = root.run(&[&["set", "--json"], assignments].concat());
        let document: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!((ran.code, &document["accepted"]), (Some(1), &false.into()), "{assignments:?}");
        assert!(document["reason"].as_str().unwrap().starts_with(reason), "{document}");
        assert!(ran.stderr.contains(reason), "{}", ran.stderr);
    }
    let state = &lines(&root.run(&["tail", "--count", "1", "--json"]).stdout)[0];
    assert_eq!((&state["speed"], &state["revision"]), (&2.5.into(), &1.into()));
    assert_eq!(root.run(&["set", "--force", "feedback=off", "deadband.1=0.5", "kc=-0.25"]).code, Some(0));
}

#[test]
fn what_is_too_fast_for_a_step_takes_substeps_that_are_told_or_is_refused_as_run_refuses_it() {
    let root = Root::new();
    let simulation = root.simulate(&["jeffcott", "--speed", "300"]);
    let state = |root: &Root| lines(&root.run(&["tail", "--count", "1", "--json"]).stdout).remove(0);
    let told = |root: &Root| root.run(&["status", "--json"]).json()["benches"][0]["substeps"].clone();
    assert_eq!(told(&root), 21);
    // Once transients have died it is on the exact orbit.
    let settled = std::iter::repeat_with(|| state(&root)).find(|state| state["tau"].as_f64().unwrap() > 60.0).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (mass, force) = (&settled["masses"][0], &settled["force"]);
    let radius = number(&mass["y"]).hypot(number(&mass["z"]));
    let force = number(&force["y"]).hypot(number(&force["z"]));
    assert!((radius - 1.0007).abs() < 1e-4 && (force - 150.1).abs() < 0.05, "{radius} {force}");
    let stiff = ["set", "kd=90000", "cd=20", "kc=0", "cc=0", "speed=2.5"];
    let answer = root.run(&stiff);
    assert!(answer.stdout.trim_end().ends_with(" substeps a step"), "{answer:?}");
    let refused = root.run(&["set", "cd=1000000"]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("dtau = 0.01 is too long for the mode at"), "{}", refused.stderr);
    let state = state(&root);
    assert_eq!(state["revision"], 2);
    assert!(!state["flags"].as_array().unwrap().contains(&"tripped".into()), "{state}");
    assert_eq!(simulation.end().code, Some(0));
    let refused = root.run(&["sim", "jeffcott", "--speed", "1000", "--dtau", "1", "--rate", "10000"]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    assert!(refused.stderr.contains("dtau = 1 is too long for the spin at R = 1000"), "{}", refused.stderr);
    let refused = root.run(&["run", "jeffcott", "--speed", "300", "--duration", "10", "--dtau", "0.01"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("dtau = 0.01 is too long for the spin at R = 300"), "{}", refused.stderr);
}

#[test]
fn two_benches_run_side_by_side_and_a_taken_name_is_refused() {
    let root = Root::new();
    let first = root.simulate(&["three-mass", "--bench", "a", "--rate", "500"]);
    let second = root.simulate(&["jeffcott", "--bench", "b"]);
    let taken = root.run(&["sim", "--bench", "a"]);
    assert_eq!((taken.code, taken.stdout.as_str()), (Some(3), ""));
    assert!(taken.stderr.contains("bench 'a' is taken by a running simulation"), "{}", taken.stderr);
    let status = root.run(&["status", "--json"]).json();
    let told: Vec<_> =
        status["benches"].as_array().unwrap().iter().map(|b| (&b["name"], &b["rotor"], &b["rate_hz"])).collect();
    assert_eq!(
        told,
        [(&"a".into(), &"three-mass".into(), &500.0.into()), (&"b".into(), &"jeffcott".into(), &1000.0.into())]
    );
    assert_eq!(root.run(&["set", "--bench", "b", "speed=1"]).code, Some(0));
    let untouched = &lines(&root.run(&["tail", "--bench", "a", "--count", "1", "--json"]).stdout)[0];
    assert_eq!(untouched["revision"], 1);
    assert_eq!((first.end().code, second.end().code), (Some(0), Some(0)));
}

#[test]
fn a_stopped_simulation_is_listed_as_one_that_does_not_answer() {
    let root = Root::new();
    let simulation = root.simulate(&["--bench", "s"]);
    simulation.signal(Signal::STOP);
    let status = root.run(&["status", "--json"]).json();
    let bench = &status["benches"][0];
    assert_eq!((&bench["name"], &bench["answers"]), (&"s".into(), &false.into()));
    assert_eq!((&bench["why"], &bench["pid"]), (&"it is stopped, or overloaded".into(), &simulation.pid().into()));
    // What is not known is `null`, whatever its kind: 0 steps, or a speed of 0, would be an answer.
    for field in ["rotor", "speed", "rate_hz", "steps", "missed", "min_damping", "revision", "tripped", "run_id"] {
        assert_eq!(bench[field], Value::Null, "{field} of {bench}");
    }
    assert_eq!(bench["lateness_us"], serde_json::json!({"p50": null, "p99": null, "max": null}));
    let table = root.run(&["status"]).stdout;
    assert!(table.contains("DOES NOT ANSWER: it is stopped, or overloaded") && !table.contains("NaN"), "{table}");
    let refused = root.run(&["set", "--bench", "s", "speed=1"]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("bench 's' did not answer"), "{}", refused.stderr);
    simulation.signal(Signal::CONT);
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn no_bench_and_wrong_names_have_their_exit_codes() {
    let root = Root::new();
    for command in [&["set", "--bench", "x", "speed=1"][..], &["tail", "--bench", "x"], &["dash", "--bench", "x"]] {
        let ran = root.run(command);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(3), ""), "{command:?}");
        assert!(ran.stderr.contains("no bench 'x' is running"), "{}", ran.stderr);
    }
    for (command, complaint) in [
        (&["sim", "--bench", "no/slash"][..], "bench 'no/slash': expected 1 to 32"),
        (&["sim", "nosuch"], "no rotor 'nosuch': built in are jeffcott, three-mass"),
        (
            &["sim", "--feedback", "nosuch"],
            "no feedback 'nosuch' for three-mass: built in are off, composite, individual",
        ),
        (&["sim", "--rate", "0"], "rate = 0: expected 1 to 100000 steps a second"),
        (&["sim", "--dtau", "-1"], "dtau = -1: expected more than 0 and at most 1"),
        (&["sim", "--trip", "nan"], "trip = NaN: expected a number from 0.001 to 1000000000"),
        (&["up"], "no terminal here: `whirl sim` runs the simulation alone, `whirl tail` prints its telemetry"),
        (&[], "no terminal here: `whirl sim` runs the simulation alone, `whirl tail` prints its telemetry"),
    ] {
        let ran = root.run(command);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{command:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(complaint), "{}", ran.stderr);
    }
    assert_eq!(root.run(&["status", "--json"]).json()["benches"], Value::Array(vec![]));
    let unusable = root.whirl().env("WHIRL_ROOT", "relative/folder").arg("status").output().unwrap();
    assert_eq!(unusable.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unusable.stderr).contains("relative/folder: expected an absolute path"));
}

#[test]
fn a_killed_simulation_is_cleaned_up_and_its_name_is_free() {
    let root = Root::new();
    let killed = root.simulate(&["--bench", "a"]);
    let alive = root.simulate(&["--bench", "b"]);
    killed.signal(Signal::KILL);
    drop(killed);
    assert!(!root.leftovers().is_empty());
    let cleaned = root.run(&["clean", "--json"]).json();
    assert_eq!((&cleaned["dead_processes"], &cleaned["live_benches"]), (&1.into(), &serde_json::json!(["b"])));
    assert_eq!(root.run(&["tail", "--bench", "b", "--count", "2"]).code, Some(0), "a live bench is not touched");
    let again = root.simulate(&["--bench", "a"]);
    again.signal(Signal::KILL);
    drop(again);
    // A new simulation clears away the dead one of its name by itself.
    let third = root.simulate(&["--bench", "a"]);
    assert_eq!((third.end().code, alive.end().code), (Some(0), Some(0)));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}
