//! `whirl map`: pictures, tables, JSON, and what is refused.

use promises::{Root, Screen, run};

const PLANE: [&str; 8] = ["map", "three-mass", "--feedback", "individual", "--x", "speed=0..8", "--y", "delay=0..0.2"];

#[test]
fn a_map_is_json_a_table_and_a_picture() {
    let document = run(&[&PLANE[..], &["--points", "9x5", "--json"]].concat()).json();
    assert_eq!((document["x"]["key"].as_str(), document["y"]["key"].as_str()), (Some("speed"), Some("delay")));
    let columns = document["values"].as_array().expect("a list");
    assert!(columns.len() == 9 && columns.iter().all(|column| column.as_array().is_some_and(|c| c.len() == 5)));
    let poles =
        run(&["poles", "three-mass", "--feedback", "individual", "--speed", "6", "--set", "delay=0.1", "--json"])
            .json();
    let apart = document["values"][6][2].as_f64().expect("a number") - poles["min_damping"].as_f64().expect("a number");
    assert!(apart.abs() < 1e-12, "{apart}");
    assert!(document["boundary"][0].as_array().is_some_and(|curve| curve.len() > 3), "{}", document["boundary"]);
    let rows = run(&[&PLANE[..], &["--points", "3x2", "--csv"]].concat()).stdout;
    assert_eq!(rows.lines().count(), 1 + 6);
    assert!(rows.starts_with("speed,delay,damping\n0.0,0.0,"), "{rows}");

    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for name in ["map.svg", "map.png", "map.csv"] {
        let out = at(name);
        let ran = run(&[&PLANE[..], &["--points", "9x5", "--out", &out]].concat());
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        assert!(ran.stdout.contains("speed across, delay up; damping") && ran.stdout.contains("cells are stable"));
        let again = run(&[&PLANE[..], &["--points", "9x5", "--out", &out]].concat());
        assert!(again.code == Some(2) && again.stdout.is_empty(), "{}", again.stderr);
    }
    assert!(std::fs::read(at("map.png")).expect("a file").starts_with(b"\x89PNG"));
    assert!(std::fs::read_to_string(at("map.svg")).expect("a file").contains("aria-label=\"smallest damping 0\""));
    assert_eq!(std::fs::read_to_string(at("map.csv")).expect("a file").lines().count(), 1 + 45);
}

#[test]
fn axes_that_do_nothing_are_refused() {
    let map = ["map", "three-mass", "--feedback", "composite"];
    for (rest, words) in [
        (&["--x", "speed=0..8", "--y", "speed=0..1"][..], "speed is given twice"),
        (&["--speed", "3", "--x", "speed=0..8", "--y", "kd=0..1"], "--speed does nothing: an axis is the speed"),
        (&["--x", "kd=0..1", "--y", "cd=0..1"], "--speed: expected the spin speed"),
        (&["--speed", "3", "--x", "kd=1..1", "--y", "cd=0..1"], "expected KEY=A..B"),
        (&["--speed", "3", "--x", "deadband=0..1", "--y", "cd=0..1"], "deadband does nothing to damping"),
        (&["--speed", "3", "--x", "start.1.y=0..1", "--y", "cd=0..1"], "start.1.y does nothing to damping"),
        (&["--speed", "3", "--x", "impulse.1.vy=0..1", "--y", "cd=0..1"], "impulse.1.vy does nothing to damping"),
        (&["--speed", "3", "--x", "impulse.4.vy=0..1", "--y", "cd=0..1"], "impulse.N.vy|vz with N from 1 to 3"),
        (&["--speed", "3", "--x", "start.1.w=0..1", "--y", "cd=0..1"], "start.N.y|z|vy|vz with N from 1 to 3"),
        (
            &["--speed", "3", "--x", "kd=0..1", "--y", "cd=0..1", "--points", "1000000x1000000"],
            "1000000000000 cells: expected at most 16777216",
        ),
        (&["--speed", "3", "--x", "kd=0..1", "--y", "cd=0..1", "--set", "kd=1"], "'kd=1' does nothing"),
        (&["--speed", "3", "--x", "kd=0..1", "--y", "cd=0..1", "--quantity", "colour"], "expected damping"),
        (
            &["--speed", "3", "--x", "kd=0..1", "--y", "cd=0..1", "--duration", "5"],
            "--duration does nothing: damping is not simulated",
        ),
        (
            &["--speed", "3", "--x", "kd=0..1", "--y", "cd=0..1", "--out", "x.jpg"],
            "ends in .svg, .png, .csv or .parquet",
        ),
    ] {
        let ran = run(&[&map[..], rest].concat());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{rest:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{rest:?}: {}", ran.stderr);
    }
}

#[test]
fn a_map_that_takes_a_while_is_shown_as_it_fills() {
    let root = Root::new();
    let plane = ["--feedback", "composite", "--speed", "6", "--x", "deadband=0..10", "--y", "kd=-0.8..0"];
    let rest = ["--quantity", "orbit", "--points", "61x41", "--duration", "300"];
    let mut screen = Screen::start(root.path(), &[&["map", "three-mass"][..], &plane, &rest].concat(), (100, 40));
    let known = screen.wait("part of a map", |text| {
        let line = text.lines().find(|line| line.contains(" of 2501 cells"))?;
        line.split_whitespace().next()?.parse::<u64>().ok()
    });
    assert!((1..2501).contains(&known), "{known}");
    assert!(screen.ended().success());
    let text = screen.text();
    assert!(!text.contains(" of 2501 cells") && text.contains("deadband across, kd up; orbit"), "{text}");
    assert_eq!(text.matches("orbit over deadband and kd").count(), 1, "{text}");
}

/// A map of a shaft, its middle cell and the machine itself tell the damping of the same modes, and say which.
#[test]
fn a_map_of_a_shaft_counts_the_modes_that_others_count() {
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"));
    for below in [&["--below", "500"][..], &["--below", "2kHz"], &[]] {
        let map = ["map", "rig", "--speed", "6000", "--x", "left.kd=10%", "--y", "right.kd=10%"];
        let map = run(&[&map[..], below, &["--points", "3x3", "--json"]].concat()).json();
        let poles = run(&[&["poles", "rig", "--speed", "6000", "--json"][..], below].concat()).json();
        assert_eq!(number(&map["below"]), number(&poles["below"]));
        let [middle, there] = [&map["values"][1][1], &poles["min_damping"]].map(number);
        assert!((middle - there).abs() < 1e-9, "{below:?}: {middle} and {there}");
    }
    let useless = run(&["map", "rig", "--speed", "6000", "--x", "left.kd=10%", "--y", "right.kd=10%"]
        .into_iter()
        .chain(["--quantity", "sensitivity", "--below", "500"])
        .collect::<Vec<_>>());
    assert_eq!(useless.code, Some(2), "{useless:?}");
    assert!(useless.stderr.contains("--below does nothing: sensitivity is of no modes"), "{useless:?}");
}
