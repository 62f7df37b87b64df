//! What is typed and does nothing, or is typed twice, is an error in words, and nothing is printed.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, run};

fn refused(typed: &str, why: &str) {
    let ran = run(&typed.split(' ').collect::<Vec<_>>());
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{typed}: {ran:?}");
    let told = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains(why), "{typed}: {told}");
}

#[test]
fn a_range_with_three_dots_is_read_in_neither_of_two_ways() {
    let why = "more than two dots in a row: expected A..B such as 0..3, or 0..0.3";
    for typed in ["trace --over 0...3", "thresholds --over 0...3", "tune --over 0...3", "force --over 0....3"] {
        refused(typed, why);
    }
    refused("tune --over 0..3 --delay 0...1", "expected a number or a range A..B");
    refused("tune --over 0..3 --vary damping.1=0...1", "expected KEY=A..B with A below B, or KEY=P%");
}

#[test]
fn an_impulse_that_is_not_felt_is_refused() {
    let run = |impulse: &str| format!("run jeffcott --speed 1 --duration 5 --impulse {impulse}");
    for (impulse, why) in [
        ("mass=1,vy=1,at=5", "impulse at 5, but the run ends at 5: expected a time before its end"),
        ("mass=1,vy=1,at=50", "impulse at 50, but the run ends at 5: expected a time before its end"),
        ("mass=1", "no velocity changes: expected vy=V or vz=V other than 0"),
        ("mass=1,vy=0", "no velocity changes: expected vy=V or vz=V other than 0"),
        ("mass=1,vy=1,vy=2", "vy is given twice: expected each key once"),
        ("mass=1,vy=1,mass=1", "mass is given twice: expected each key once"),
    ] {
        refused(&run(impulse), why);
    }
}

#[test]
fn a_setting_that_another_one_undoes_is_refused() {
    let undone = |first: &str, then: &str| format!("'{first}' does nothing: '{then}' sets the same");
    let run = "run jeffcott --speed 1 --duration 5";
    for (typed, why) in [
        (format!("{run} --set speed=2"), undone("--speed", "speed=2")),
        (format!("{run} --set kd=1 --set kd.1=2"), undone("kd=1", "kd.1=2")),
        (format!("{run} --deadband 1 --set deadband=2"), undone("--deadband", "deadband=2")),
        (format!("{run} --set kd=1 --set feedback=off"), undone("kd=1", "feedback=off")),
        (format!("{run} --set trip=5"), "only a live bench trips".into()),
        (format!("{run} --set ramp=0.1"), "only a live bench is on its way to a speed".into()),
        ("poles jeffcott --speed 1 --set ramp=0.1".into(), "only a live bench is on its way to a speed".into()),
        ("response --over 0..1 --set speed=1".into(), undone("--over", "speed=1")),
        ("cycles --over 0..1 --set trip=1".into(), "only a live bench trips".into()),
    ] {
        refused(&typed, &why);
    }
    let root = Root::new();
    let _simulation = root.simulate(&["jeffcott"]);
    for (typed, why) in [
        (["speed=1", "speed=2"], undone("speed=1", "speed=2")),
        (["deadband.1=1", "deadband=2"], undone("deadband.1=1", "deadband=2")),
    ] {
        let ran = root.run(&["set", typed[0], typed[1]]);
        assert!(ran.code == Some(1) && ran.stderr.contains(&why), "{ran:?}");
    }
}

#[test]
fn an_option_that_another_one_makes_void_is_refused() {
    for (typed, why) in [
        ("run jeffcott --speed 1 --duration 5 --psd mass=1 --csv", "--psd has no place in the rows of --csv"),
        ("trace --over 0..3 --campbell --points 5", "--points does nothing to the Campbell diagram"),
        ("modes --speed 1 --points 5", "--points: the orbits are in the output of --json and --csv alone"),
        ("force --over 0..1 --deadband 0,1,0", "deadband 0 is given twice: expected each once"),
        ("assign jeffcott --cancel --csv", "--csv: feedback is no table"),
        ("assign jeffcott --cancel --speed 1", "cannot be used with"),
        ("assign jeffcott --cancel --bearing 1", "cannot be used with"),
        ("assign --table --speed 1 --bearing 2", "cannot be used with"),
        ("assign jeffcott --speed 1 --poles -1,0;-1,1 --reference 2", "--reference is the speed of the cancelling law"),
        ("tune --over 0..3 --spread 50", "--spread 50: expected at most --bound, which is 20"),
        ("dash --picture a.txt --theme full", "a picture in plain text has no colours"),
        ("tail --count 0", "0 is not in 1.."),
        ("record a.rrd --split 0.5B", "'0.5B': expected a size from 1 B"),
    ] {
        refused(typed, why);
    }
    let root = Root::new();
    let file = root.path().join("r.toml");
    std::fs::write(&file, "[[mass]]\nmass = 1.0\n").unwrap();
    let ran = run(&["rotor", "check", file.to_str().unwrap(), "--for", "jeffcott"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("there is no feedback among these files"), "{ran:?}");
}
