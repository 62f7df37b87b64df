//! One fault at a time on a running machine: made, told with its cause, put back, whoever ends it and however.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use promises::{Root, Screen};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

/// The events so far that are about settings, once there are so many.
fn changes(root: &Root, count: usize) -> Vec<Value> {
    for more in 1..60 {
        let asked = (count + more).to_string();
        let tail = root.run(&["tail", "--events", "--json", "--count", &asked]);
        assert_eq!(tail.code, Some(0), "{tail:?}");
        let lines = tail.stdout.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let told: Vec<Value> = lines.filter(|line| line["event"] == "settings").collect();
        if told.len() >= count {
            return told;
        }
        // What is still missing may be made of words about lost pace: one more event is sure to come.
        assert_eq!(root.run(&["note", "and"]).code, Some(0));
    }
    panic!("nothing but lateness");
}

#[test]
fn a_fault_is_a_change_with_its_cause_and_goes_for_the_next_and_back() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual"]);
    let made = root.run(&["drill", "delay-jump", "--size", "0.004", "--json"]).json();
    assert_eq!((&made["fault"], &made["revision"]), (&"delay-jump size=0.004".into(), &2.into()));
    assert_eq!(made["changed"], json!([{ "key": "delay", "was": 0.0, "is": 0.004 }]));
    // Whoever runs the machine helps meanwhile.
    assert_eq!(root.run(&["set", "speed=2"]).code, Some(0));
    let made = root.run(&["drill", "unbalance-added", "--at", "2", "--size", "0.5", "--json"]).json();
    let changed =
        json!([{ "key": "delay", "was": 0.004, "is": 0.0 }, { "key": "unbalance_added.2", "was": 0.0, "is": 0.5 }]);
    assert_eq!(made["changed"], changed);
    let back = root.run(&["drill", "off", "--json"]).json();
    assert_eq!((&back["fault"], &back["changed"][0]["is"]), (&Value::Null, &0.0.into()));
    let told = changes(&root, 4);
    let whys: Vec<&str> = told.iter().map(|line| line["why"].as_str().unwrap()).collect();
    assert_eq!(whys, ["drill: delay-jump size=0.004", "", "drill: unbalance-added at=2 size=0.5", "drill over"]);
    let last = &told[3]["settings"];
    assert_eq!((&last["speed"], &last["delay"], &last["unbalance_added.2"]), (&2.0.into(), &0.0.into(), &0.0.into()));
    let none = root.run(&["drill", "off"]);
    assert_eq!(none.code, Some(1));
    assert!(none.stderr.contains("no fault of a drill is there"), "{none:?}");
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual"]);
    for (arguments, code, words) in [
        (&["drill", "sensor-gian"][..], 2, "did you mean 'sensor-gain'?"),
        (&["drill", "sensor-lost", "--at", "3"], 2, "sensor-lost at '3': expected a place with a sensor: 1, 2"),
        (&["drill", "axis-lost", "--size", "x"], 2, "axis-lost of size 'x': expected y or z"),
        (&["drill", "fading-sensor", "--at", "1"], 2, "--at and --size are of a fault"),
        (&["drill", "amplifier-gain", "--size", "0"], 1, "it would make a stable machine unstable"),
        (&["drill", "nowhere/a.toml"], 2, "nowhere/a.toml"),
        (&["drill", "sensor-lost", "--bench", "other"], 3, "other"),
    ] {
        let ran = root.run(arguments);
        assert_eq!(ran.code, Some(code), "{ran:?}");
        assert!(ran.stderr.contains(words), "{ran:?}");
    }
    let status = root.run(&["status", "--json"]).json();
    assert_eq!(status["benches"][0]["revision"], 1);
    let list = root.run(&["drill", "--json"]).json();
    assert!(list.as_array().unwrap().len() >= 10);
    assert_eq!(list[0]["name"], "sensor-gain");
}

#[test]
fn without_an_axis_it_turns_and_no_poles_are_told() {
    let root = Root::new();
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual"]);
    // Nobody can tell by poles whether it will be stable.
    let asked = root.run(&["drill", "axis-lost", "--size", "z"]);
    assert!(asked.code == Some(1) && asked.stderr.contains("cannot be told"), "{asked:?}");
    assert_eq!(root.run(&["drill", "axis-lost", "--size", "z", "--force"]).code, Some(0));
    // Nor is control taken off what cannot be judged without a question, where that is unstable.
    let off = root.run(&["set", "speed=4", "feedback=off"]);
    assert!(off.code == Some(1) && off.stderr.contains("would be unstable"), "{off:?}");
    let status = root.run(&["status", "--json"]).json();
    assert_eq!(status["benches"][0]["min_damping"], Value::Null);
    let step = root.run(&["tail", "--count", "1", "--json"]).json();
    assert_eq!(step["force"]["z"], 0.0);
    assert_ne!(step["force"]["y"], 0.0);
    let poles = root.run(&["poles", "three-mass", "--speed", "2.5", "--set", "amplifier_y=0"]);
    assert_eq!(poles.code, Some(1));
    assert!(poles.stderr.contains("acts along its axes differently"), "{poles:?}");
}

#[test]
fn a_drill_that_is_interrupted_leaves_nothing() {
    let (root, folder) = (Root::new(), tempfile::tempdir().unwrap());
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual"]);
    let file = folder.path().join("long.toml");
    let text = "name = \"long\"\nend = 900\n[[step]]\nat = 0\nfault = \"delay-jump\"\nsize = 0.004\n\n[[step]]\nat = 800\nfault = \"sensor-lost\"\n";
    std::fs::write(&file, text).unwrap();
    let mut drill = root.whirl();
    let mut child = drill.arg("drill").arg(&file).args(["--json"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let first: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!(first["step"], "delay-jump size=0.004");
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let last: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!((&last["fault"], &last["changed"][0]["is"]), (&Value::Null, &0.0.into()));
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let told = changes(&root, 2);
    assert_eq!(told[1]["why"], "drill over");
    // A file that is wrong is told line by line.
    std::fs::write(&file, text.replace("sensor-lost", "spark")).unwrap();
    let wrong = root.run(&["drill", file.to_str().unwrap()]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.stderr.contains("long.toml:10:9: no fault 'spark': expected one of"), "{wrong:?}");
}

#[test]
fn the_console_lists_faults_and_puts_them_back_with_one_key() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &["up", "three-mass", "--feedback", "individual"], (140, 45));
    screen.wait_words("RUNNING");
    // What is asked before the settings are known changes nothing.
    screen.wait_words("rev 1");
    screen.press_for("F", "an amplifier gives nothing along one axis");
    screen.press_for("unbalance-added\r", "unbalance_added.1 = 1");
    screen.press_for("X", "drill over");
    screen.press_for("F", "sensors read nothing");
    screen.press_for("delay-jump size=0.004\r", "delay = 0.004");
    screen.press_for("u", "undone: delay");
    screen.press_for("X", "no fault of a drill is there");
    screen.press("q");
    assert!(screen.ended().success());
}
