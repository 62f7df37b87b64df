//! `whirl measure`: what is measured on a running bench is what is computed where the machine is linear, and not where it is not.

use promises::{Ran, Root};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

/// A bench that is fast enough for nobody to wait, and slow enough for any machine.
const FAST: [&str; 7] = ["three-mass", "--feedback", "individual", "--speed", "6", "--rate", "10000"];

fn bench(root: &Root, options: &[&str]) -> promises::Simulation {
    root.simulate(&[&FAST[..], options].concat())
}

fn measured(root: &Root, options: &[&str]) -> Ran {
    let ran = root.run(&[&["measure", "--periods", "3"], options].concat());
    // A machine that cannot keep up loses steps, and says so: once more.
    if ran.code == Some(1) && ran.stderr.contains("steps were lost") {
        return root.run(&[&["measure", "--periods", "8"], options].concat());
    }
    ran
}

#[test]
fn val_a_linear_machine_measures_as_computed() {
    let root = Root::new();
    let simulation = bench(&root, &["--deadband", "0"]);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let picture = folder.path().join("measured.svg");
    let document = measured(&root, &["--json", "--out", picture.to_str().expect("UTF-8")]).json();
    assert_eq!((&document["rotor"], number(&document["speed"])), (&"three-mass".into(), 6.0));
    let points = document["points"].as_array().expect("a list");
    assert!(points.len() >= 30, "{document}");
    for point in points {
        assert!(number(&point["difference"]) < 0.01 && number(&point["coherence"]) > 0.99, "{point}");
        for curve in ["measured", "computed"] {
            for field in ["re", "im", "amplitude", "phase"] {
                assert!(point[curve][field].is_number(), "{point}");
            }
        }
    }
    assert!(number(&document["largest_difference"]["value"]) < 0.01, "{document}");
    assert!((number(&document["curve"]["peak"]) - 1.19172).abs() < 1e-5, "{document}");
    let peak = &document["peak"]["measured"];
    assert!((1.05..1.2).contains(&number(&peak["peak"])) && peak["zone"] == "A", "{document}");
    for side in ["forward", "backward"] {
        assert!(peak[side]["peak"].is_number(), "{document}");
    }
    assert_eq!(document["bent_by"], serde_json::json!([]));
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.contains("<circle") || drawn.len() > 5000, "{}", drawn.len());
    // For people, and who did it.
    let table = measured(&root, &["--tones", "6", "--band", "0.5..4", "--seed", "3"]);
    assert_eq!(table.code, Some(0), "{table:?}");
    assert!(table.stdout.contains("measured and computed differ by 0."), "{}", table.stdout);
    let events = root.run(&["tail", "--events", "--json", "--count", "2"]).stdout;
    let begun: Value = serde_json::from_str(events.lines().nth(1).expect("two events")).expect("JSON");
    assert!(begun["event"] == "excited" || begun["event"] == "late", "{begun}");
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn a_clearance_bends_what_is_measured_and_is_named() {
    let root = Root::new();
    let _simulation = root.simulate(&[
        "three-mass",
        "--feedback",
        "composite",
        "--speed",
        "2.5",
        "--rate",
        "10000",
        "--deadband",
        "1",
    ]);
    let ran = measured(&root, &["--tones", "12", "--json"]);
    let document = ran.json();
    assert!(number(&document["largest_difference"]["value"]) > 0.01, "{document}");
    let told = document["bent_by"].as_array().expect("a list");
    assert!(told.iter().any(|words| words.as_str().expect("words").contains("has a clearance of 1")), "{document}");
}

#[test]
fn what_would_trip_or_cannot_be_measured_is_refused_before_it_begins() {
    let root = Root::new();
    let nobody = root.run(&["measure"]);
    assert!(nobody.code == Some(3) && nobody.stderr.contains("no bench 'default'"), "{nobody:?}");
    let simulation = bench(&root, &["--deadband", "0", "--trip", "200"]);
    for (options, code, why) in [
        (&["--amplitude", "100000"][..], 1, "the excitation could trip the machine: mass "),
        (&["--amplitude", "0%"][..], 2, "expected a force greater than 0, or a share such as 2%"),
        (&["--band", "0..3"][..], 2, "expected frequencies greater than 0"),
        (&["--band", "1..1000"][..], 2, "tell frequencies apart up to"),
        (&["--periods", "1"][..], 2, "2..=100"),
        (&["--tones", "40"][..], 2, "1..=32"),
        (&["--band", "5.9..6.1", "--tones", "2"][..], 2, "no tone fits"),
        (&["--out", "a.pdf"][..], 2, ".svg or .png"),
    ] {
        let refused = root.run(&[&["measure"], options].concat());
        assert!(refused.code == Some(code) && refused.stderr.contains(why), "{options:?}: {refused:?}");
        assert_eq!(refused.stdout, "");
    }
    let status = root.run(&["status", "--json"]);
    assert!(!status.stdout.contains("\"tripped\":true"), "{status:?}");
    assert_eq!(root.run(&["set", "feedback=off", "speed=4.2", "--force"]).code, Some(0));
    let unstable = root.run(&["measure"]);
    assert!(unstable.code == Some(1) && unstable.stderr.contains("it has a pole at"), "{unstable:?}");
    assert_eq!(simulation.end().code, Some(0));
}
