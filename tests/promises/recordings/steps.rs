//! Every step and every change is on file: of a bench, a run, a run-up, and as a table.

use promises::{Root, Screen, run};
use serde_json::Value;
use tape::Recording;
use wire::Step;

use super::recorder::{Recorder, configure, info, steps, text, wait};

#[test]
fn every_step_and_every_change_is_in_the_file_bit_for_bit() {
    let root = Root::new();
    let path = root.path().join("s.rrd");
    configure(&root, "[alarms]\norbit = [0.001, 0.002]\n");
    let simulation = root.simulate(&["three-mass", "--rate", "5000"]);
    let recorder = Recorder::start(&root, &path, &[]);
    let tail = root.run(&["tail", "--count", "4000", "--json"]);
    assert_eq!(root.run(&["set", "kd=0.125", "--why", "to see"]).code, Some(0));
    assert_eq!(root.run(&["note", "here it begins"]).code, Some(0));
    assert_eq!(root.run(&["set", "trip=0.001", "--force"]).code, Some(0));
    wait("the trip", || root.run(&["status", "--json"]).json()["benches"][0]["tripped"] == true);
    let status = root.run(&["status", "--json"]).json();
    let told = &status["benches"][0]["recording"];
    assert_eq!((&told["state"], &told["lost"]), (&"recording".into(), &0.into()), "{told}");
    let ran = recorder.end();
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:?}");
    assert!(ran.stdout.contains("0 lost; asked to stop"), "{ran:?}");
    drop(simulation);

    let recorded = steps(&path);
    let mut compared = 0;
    for line in tail.stdout.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        let state = &recorded[&line["seq"].as_u64().unwrap()];
        let [y, z] = state.force_delivered();
        let mut pairs = vec![("tau", state.tau(), &line["tau"]), ("speed", state.speed(), &line["speed"])];
        pairs.extend([("uy", y, &line["force"]["y"]), ("uz", z, &line["force"]["z"])]);
        for (point, told) in state.points().zip(line["masses"].as_array().unwrap()) {
            let of = [("y", point.y), ("z", point.z), ("vy", point.vy), ("vz", point.vz)];
            pairs.extend(of.map(|(name, value)| (name, value, &told[name])));
        }
        for (name, value, told) in pairs {
            assert_eq!(value.to_bits(), told.as_f64().unwrap().to_bits(), "{name} of step {}", state.seq());
        }
        compared += 1;
    }
    assert_eq!(compared, 4000);

    let recording = Recording::open(&path).unwrap();
    // A busy machine may make the simulation late: that is an event of its own.
    let events: Vec<_> = recording.events().iter().filter(|e| e.happening.name() != "late").collect();
    let happened: Vec<&str> = events.iter().map(|e| e.happening.name()).collect();
    assert_eq!(happened, ["started", "settings", "note", "settings", "tripped"]);
    let changed = events[1];
    assert_eq!((changed.why.as_str(), changed.revision), ("to see", 2));
    let revision = recording.settings_at(changed.at.seq).unwrap();
    assert_eq!(revision.settings.feedback.bearings[0].signals[0].gains[0].at(0.0), 0.125);
    assert_eq!(recorded[&changed.at.seq].revision(), 2, "from that step on");
    assert_eq!(recorded[&(changed.at.seq - 1)].revision(), 1);
    let info = info(&path);
    assert_eq!((&info["lost"], &info["settings_changes"]), (&0.into(), &2.into()), "{info}");
    assert_eq!(info["trips"][0]["revision"], 3, "{info}");
    // Alarms, by the user's own limits, at the step whose value it was.
    let alarms = info["alarms"].as_array().unwrap();
    let orbit = alarms.iter().find(|alarm| alarm["watch"] == "orbit").unwrap_or_else(|| panic!("{info}"));
    let radius = |step: &Value| {
        let state = &recorded[&step.as_u64().unwrap()];
        state.largest_radius()
    };
    assert!(radius(&orbit["from"]["step"]) > 0.001, "{orbit}");
    assert_eq!((&orbit["level"], &info["alarm_limits"]["orbit"][0]), (&"alarm".into(), &0.001.into()), "{info}");
    assert!(info["max_force"]["value"].is_f64() && info["min_damping"]["value"].is_f64());
}

#[test]
fn a_run_up_on_file_tells_its_legs_its_critical_speeds_and_its_trip() {
    let root = Root::new();
    let path = root.path().join("up.rrd");
    let legs = root.path().join("legs.toml");
    std::fs::write(&legs, "[[leg]]\nto = 3\nrate = 0.01\n[[leg]]\ndwell = 40\n[[leg]]\nto = 0.5\nrate = 0.02\n")
        .unwrap();
    let machine = ["runup", "three-mass", "--feedback", "individual"];
    let out = ["--profile", text(&legs), "--out", text(&path), "--json"];
    let ran = run(&[&machine[..], &out].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let (found, told) = (ran.json(), info(&path));
    assert_eq!(told["legs"].as_array().unwrap().len(), 3, "{}", told["legs"]);
    for (leg, expected) in told["legs"].as_array().unwrap().iter().zip(found["legs"].as_array().unwrap()) {
        for (name, near) in [("tau", 0.1), ("speed", 2e-3)] {
            for end in 0..2 {
                let [a, b] = [leg, expected].map(|leg| leg[name][end].as_f64().unwrap());
                assert!((a - b).abs() < near, "{leg} {expected}");
            }
        }
    }
    let [told, found] = [&told, &found].map(|document| document["criticals"].as_array().unwrap().clone());
    assert!(told.len() >= 3 && told.len() == found.len(), "{told:?} {found:?}");
    for (told, found) in told.iter().zip(&found) {
        assert_eq!((&told["leg"], &told["station"]), (&found["leg"], &found["station"]), "{told} {found}");
        let [a, b] = [told, found].map(|of| of["speed"].as_f64().unwrap());
        assert!((a - b).abs() < 1e-6, "{told} {found}");
    }
    let words = run(&["info", text(&path)]).stdout;
    for word in ["leg 1", "0 to R = 3", "leg 2", "at R = 3", "critical", "amplification"] {
        assert!(words.contains(word), "{word}: {words}");
    }
    // Every step is there, and the machine with all that it held.
    assert_eq!(run(&["export", text(&path), "--csv"]).code, Some(0));
    assert!(info(&path)["snapshots"].as_u64().unwrap() > 10);
    // One that trips ends there.
    let tripped = root.path().join("tripped.rrd");
    let off = ["runup", "three-mass", "--feedback", "off", "--to", "5", "--rate", "0.005", "--out", text(&tripped)];
    let ran = run(&off);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let told = info(&tripped);
    assert_eq!(told["trips"].as_array().unwrap().len(), 1, "{told}");
    // A name of no known kind.
    let ran = run(&["runup", "jeffcott", "--to", "2", "--rate", "0.1", "--out", "x.txt"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("ends in .svg, .png or .rrd"), "{ran:?}");
    // And opens as any recording does.
    let mut screen = Screen::start(root.path(), &["replay", text(&path)], (120, 40));
    screen.wait_words("REPLAY");
    screen.press_for("g100\r", "tau 100");
    screen.press("q");
    assert!(screen.ended().success());
}

#[test]
fn a_table_of_it_has_every_digit() {
    let root = Root::new();
    let path = root.path().join("r.rrd");
    let out = ["run", "three-mass", "--speed", "2", "--duration", "20", "--dtau", "0.01"];
    let ran = run(&[&out[..], &["--impulse", "mass=2,vy=0.5,at=5", "--out", text(&path)]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let csv = run(&["export", text(&path), "--csv", "--from", "4", "--to", "6", "--every", "10"]);
    assert_eq!((csv.code, csv.stderr.as_str()), (Some(0), ""), "{csv:?}");
    let table = std::fs::read_to_string(path.with_extension("csv")).unwrap();
    let recorded = steps(&path);
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let (step, y2) = (names.iter().position(|n| *n == "step").unwrap(), names.iter().position(|n| *n == "y2").unwrap());
    let mut rows = 0;
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let state = &recorded[&fields[step].parse().unwrap()];
        assert!((4.0..=6.0).contains(&state.tau()) && state.seq().is_multiple_of(10));
        assert_eq!(fields[y2].parse::<f64>().unwrap().to_bits(), state.point(1).y.to_bits());
        rows += 1;
    }
    assert!((19..=21).contains(&rows), "{rows}");
    let parquet = run(&["export", text(&path), "--parquet"]);
    assert_eq!(parquet.code, Some(0), "{parquet:?}");
    assert!(std::fs::read(path.with_extension("parquet")).unwrap().starts_with(b"PAR1"));

    // The recording of a run holds what its table holds.
    let direct = path.with_file_name("d.csv");
    assert_eq!(run(&[&out[..], &["--impulse", "mass=2,vy=0.5,at=5", "--out", text(&direct)]].concat()).code, Some(0));
    let direct = std::fs::read_to_string(direct).unwrap();
    assert_eq!(direct.lines().count() - 1, recorded.len());
    for (line, state) in direct.lines().skip(1).zip(recorded.values()) {
        let fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
        assert_eq!((fields[0], fields[5], fields[13]), (state.tau(), state.point(1).y, state.force_delivered()[0]));
    }
    let event = &Recording::open(&path).unwrap().events()[0].clone();
    assert_eq!((event.happening.name(), event.at.tau), ("impulse", 5.0));
    let kicked = recorded[&event.at.seq].point(1).vy - recorded[&(event.at.seq - 1)].point(1).vy;
    assert!((kicked - 0.5).abs() < 1e-12, "the impulse shows from its step on: {kicked}");
}
