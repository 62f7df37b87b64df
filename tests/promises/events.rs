//! What happens on a bench is told, with who and why: `tail --events`, `note`, `set --why`.

use promises::Root;
use serde_json::Value;

/// The events so far, `count` of them at least, as `tail --events --json` prints them; those of lost pace left out.
fn events(root: &Root, count: usize) -> Vec<Value> {
    // A machine that falls behind adds events of its own: ask for more until enough others are there.
    for more in 0..50 {
        let asked = (count + more).to_string();
        let tail = root.run(&["tail", "--events", "--json", "--count", &asked]);
        assert_eq!(tail.code, Some(0), "{tail:?}");
        let lines = tail.stdout.lines().map(|line| serde_json::from_str(line).expect("JSON"));
        let told: Vec<Value> = lines.filter(|line: &Value| line["event"] != "late").collect();
        if told.len() >= count {
            return told;
        }
    }
    panic!("nothing but lateness");
}

#[test]
fn everybody_sees_who_changed_what_and_why() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass"]);
    let set = root.run(&["set", "speed=3", "kd=0.1", "--why", "to see it whirl", "--json"]).json();
    let note = root.run(&["note", "here", "it begins", "--json"]).json();
    assert_eq!(root.run(&["set", "trip=7"]).code, Some(0));
    let told = events(&root, 4);
    let names: Vec<_> = told.iter().map(|line| line["event"].as_str().expect("a name")).collect();
    assert_eq!(names, ["started", "settings", "note", "settings"]);
    let [started, first, noted, second] = &told[..] else { panic!("{told:?}") };
    assert_eq!(
        (&started["number"], &started["who"], &started["settings"]["speed"]),
        (&1.into(), &"sim".into(), &2.5.into())
    );
    assert_eq!(first["seq"], set["applied_at_step"]);
    assert!(first["who"].as_str().expect("who").starts_with("set:"));
    assert_eq!((&first["why"], &first["revision"]), (&"to see it whirl".into(), &2.into()));
    assert_eq!(first["changed"], serde_json::json!(["speed 2.5 -> 3", "kd.1 -0.5879 -> 0.1"]));
    assert_eq!((&first["settings"]["speed"], &first["settings"]["kd.1"]), (&3.0.into(), &0.1.into()));
    assert_eq!((&noted["text"], &noted["seq"], &noted["tau"]), (&"here it begins".into(), &note["seq"], &note["tau"]));
    assert_eq!((&second["why"], &second["changed"]), (&"".into(), &serde_json::json!(["trip 1000 -> 7"])));
    // For people, one line each.
    let tail = root.run(&["tail", "--events", "--count", "3"]);
    assert!(tail.stdout.contains("speed 2.5 -> 3, kd.1 -0.5879 -> 0.1 (to see it whirl)"), "{}", tail.stdout);
    let step = |document: &Value| document["seq"].as_u64().expect("a step");
    let after = root.run(&["tail", "--count", "1", "--json"]).json();
    assert!(step(&after) >= step(&note), "the note stands at a step that was made");
    let said = root.run(&["note", "again"]);
    assert!(said.code == Some(0) && said.stdout.starts_with("noted at step "), "{said:?}");
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn a_trip_is_told_with_its_cause() {
    let root = Root::new();
    let _simulation =
        root.simulate(&["three-mass", "--feedback", "off", "--speed", "4", "--trip", "3", "--rate", "20000"]);
    let told = events(&root, 2);
    let trip = &told[1];
    assert_eq!((&trip["event"], &trip["cause"], &trip["limit"]), (&"tripped".into(), &"limit".into(), &3.0.into()));
    assert!(
        trip["radius"].as_f64().expect("a radius") > 3.0 && trip["mass"].is_u64() && trip["seq"].is_u64(),
        "{trip}"
    );
    assert!(trip["text"].as_str().expect("words").contains("past the limit of 3 e_t"), "{trip}");
}

#[test]
fn what_is_no_note_and_no_bench_is_said() {
    let root = Root::new();
    let nobody = root.run(&["note", "hello"]);
    assert_eq!((nobody.code, nobody.stdout.as_str()), (Some(3), ""));
    assert!(nobody.stderr.contains("no bench 'default' is running"), "{}", nobody.stderr);
    let long = root.run(&["note", &"x".repeat(241)]);
    assert_eq!(long.code, Some(2));
    assert!(long.stderr.contains("a note of 241 bytes: expected at most 240"), "{}", long.stderr);
    assert_eq!(root.run(&["note"]).code, Some(2));
    assert_eq!(root.run(&["tail", "--events", "--every", "3"]).code, Some(2));
    let _simulation = root.simulate(&[]);
    let empty = root.run(&["note", " "]);
    assert_eq!(empty.code, Some(1));
    assert!(empty.stderr.contains("not noted: a note must say something"), "{}", empty.stderr);
}
