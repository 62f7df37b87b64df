//! Gains as good as promised, and proven where they say so.

use promises::{run, whirl};
use serde_json::Value;

use super::{folder, number, text};

#[test]
fn one_speed_is_held_better_than_by_anyone_before() {
    for (speed, least) in [("7.2", 0.00652), ("6", 0.0291), ("4", 0.0654)] {
        let document =
            run(&["tune", "three-mass", "--speed", speed, "--signal", "composite", "--sensors", "1,2", "--json"])
                .json();
        assert!(number(&document, "min_damping") >= least, "{document}");
        assert_eq!(number(&document, "worst_speed"), speed.parse::<f64>().unwrap());
        assert_eq!(document["stable"], true);
        assert_eq!(document["proven"], true);
        assert!(document["stationarity"]["norm"].as_f64().unwrap() < 1e-4, "{document}");
        let signal = &document["feedback"]["signal"][0];
        assert_eq!(signal["displacement"], serde_json::json!([1.0, 1.0, 0.0]));
        assert!(["kd", "cd", "kc", "cc"].iter().all(|gain| signal[gain].is_f64()));
        let active = document["active"].as_array().unwrap();
        assert!(!active.is_empty() && active.iter().all(|mode| mode["re"].is_f64() && mode["im"].is_f64()));
        for field in ["evaluations", "seconds", "starts", "seed", "max_force"] {
            assert!(document[field].is_number(), "{field}");
        }
    }
}

#[test]
fn a_range_is_proven_as_a_whole() {
    let document = run(&["tune", "--over", "0..5", "--sensors", "1,2", "--json"]).json();
    assert!(number(&document, "min_damping") >= 0.0388, "{document}");
    assert_eq!(document["proven"], true);
    assert_eq!(number(&document, "tolerance"), 1e-4);
}

#[test]
fn gains_hold_whatever_the_deadband_leaves_and_the_rotor_stays_near_its_centre() {
    let folder = folder();
    let file = folder.path().join("robust.toml");
    let document = run(&[
        "tune",
        "three-mass",
        "--over",
        "0..6",
        "--signal",
        "individual",
        "--sensors",
        "1,2",
        "--bound",
        "5",
        "--robust",
        "deadband",
        "--out",
        text(&file),
        "--json",
    ])
    .json();
    assert!(number(&document, "min_damping") >= 0.054, "{document}");
    assert_eq!(document["proven"], true);
    for signal in document["feedback"]["signal"].as_array().unwrap() {
        assert!(["kd", "cd", "kc", "cc"].iter().all(|gain| signal[gain].as_f64().unwrap().abs() <= 5.0));
    }
    let motion = run(&[
        "run",
        "three-mass",
        "--feedback",
        text(&file),
        "--speed",
        "6",
        "--deadband",
        "10",
        "--duration",
        "3000",
        "--json",
    ])
    .json();
    assert_eq!(motion["diverged"], false);
    let largest = motion["max_displacement"].as_array().unwrap().iter().map(|r| r.as_f64().unwrap());
    assert!(largest.fold(0.0, f64::max) < 3.0, "{motion}");
    let cycles =
        run(&["cycles", "three-mass", "--feedback", text(&file), "--deadband", "10", "--over", "1..6", "--json"])
            .json();
    for point in cycles["points"].as_array().unwrap() {
        assert_eq!(point["branches"], serde_json::json!([]), "a self-excited limit cycle: {point}");
    }
}

#[test]
fn the_reports_method_is_there_to_compare() {
    let powell = run(&["tune", "three-mass", "--speed", "6", "--method", "powell", "--starts", "60", "--json"]).json();
    assert_eq!((&powell["method"], number(&powell, "starts")), (&"powell".into(), 60.0));
    assert_eq!(powell["values"].as_array().unwrap().len(), 60);
    let ours = run(&["tune", "three-mass", "--speed", "6", "--json"]).json();
    assert!(number(&ours, "min_damping") > number(&powell, "min_damping"));
    assert!(number(&ours, "evaluations") < number(&powell, "evaluations"));
}

#[test]
fn the_same_seed_gives_the_same_answer_on_any_number_of_threads() {
    let on = |threads: &str, seed: &str| {
        let arguments = ["tune", "--over", "0..6", "--signal", "individual", "--bound", "5", "--starts", "6"];
        let output = whirl()
            .args(arguments)
            .args(["--seed", seed, "--json"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .expect("it runs");
        let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        ["feedback", "min_damping", "evaluations", "values", "active", "worst"].map(|field| document[field].clone())
    };
    assert_eq!(on("1", "7"), on("2", "7"));
    assert_ne!(on("2", "7")[3], on("2", "8")[3], "another seed climbs from elsewhere");
}
