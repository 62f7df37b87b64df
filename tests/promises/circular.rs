//! `whirl response` and `whirl cycles`: the documented fields, and exact numbers behind them.

use promises::run;

#[test]
fn response_lists_every_branch_at_every_speed() {
    let document = run(&["response", "jeffcott", "--feedback", "cancel", "--over", "0..5", "--json"]).json();
    let points = document["points"].as_array().unwrap();
    assert_eq!(points.len(), 61);
    let last = &points[60];
    assert_eq!(last["speed"], 5.0);
    assert_eq!(last["branches"].as_array().unwrap().len(), 1);
    let branch = &last["branches"][0];
    assert!((branch["force"].as_f64().unwrap() - 2.655_371).abs() < 5e-7 && branch["stable"] == true, "{branch}");
    assert_eq!(branch["radius"].as_array().unwrap().len(), 1);
}

#[test]
fn response_folds_where_the_clearance_makes_it_jump() {
    let document = run(&["response", "--over", "0.1..1.5", "--points", "15", "--deadband", "1", "--json"]).json();
    let folds: Vec<f64> = document["folds"].as_array().unwrap().iter().map(|f| f["speed"].as_f64().unwrap()).collect();
    assert!(!folds.is_empty(), "{document}");
    let most = document["points"].as_array().unwrap().iter().map(|p| p["branches"].as_array().unwrap().len()).max();
    assert_eq!(most, Some(3));
}

#[test]
fn cycles_list_frequency_radius_and_stability_and_the_thresholds_they_end_at() {
    let document =
        run(&["cycles", "three-mass", "--over", "0..7", "--deadband", "1", "--feedback", "composite", "--json"]).json();
    let points = document["points"].as_array().unwrap();
    assert_eq!(points.len(), 61);
    let seen: Vec<_> = points.iter().flat_map(|p| p["branches"].as_array().unwrap()).collect();
    assert!(seen.len() > 61);
    for branch in seen {
        assert!(branch["frequency"].is_f64() && branch["stable"].is_boolean(), "{branch}");
        assert_eq!(branch["radius"].as_array().unwrap().len(), 3);
    }
    let off = run(&["cycles", "three-mass", "--over", "0..7", "--points", "29", "--deadband", "1", "--json"]).json();
    let mut ends: Vec<f64> = off["thresholds"]
        .as_array()
        .unwrap()
        .iter()
        .map(|t| t["speed"].as_array().unwrap().last().unwrap().as_f64().unwrap())
        .collect();
    ends.sort_by(f64::total_cmp);
    for (end, threshold) in ends.iter().zip([1.775_522, 4.101_250, 4.650_456]) {
        assert!((end - threshold).abs() < 3e-4, "{end} for {threshold}");
    }
    assert_eq!(ends.len(), 3);
    let none = run(&["cycles", "three-mass", "--over", "0..7", "--deadband", "0"]);
    assert!(none.stdout.contains("no self-excited circular limit cycle found"), "{none:?}");
}

#[test]
fn what_is_proven_complete_is_said_and_what_is_not() {
    let two = run(&["response", "--over", "0.1..1.5", "--points", "15", "--deadband", "1", "--json"]).json();
    assert_eq!(two["completeness"]["complete"], 15);
    assert!(two["points"].as_array().unwrap().iter().all(|p| p["complete"] == true), "{two}");
    let cycles = ["cycles", "--over", "1..5", "--points", "5", "--deadband", "1"];
    let found = run(&[&cycles[..], &["--json"]].concat()).json();
    let told = &found["completeness"];
    assert_eq!((&told["clearances"], &told["enumerated"], &told["others"]), (&2.into(), &1.into(), &"search".into()));
    assert!(run(&cycles).stdout.contains("NOT proven complete: all orbits that press on at most one bearing of the 2"));
}

#[test]
fn bad_input_exits_2() {
    for arguments in [
        &["response", "--over", "3..1"][..],
        &["response", "--over", "0..2000"],
        &["cycles", "--over", "-1..3"],
        &["cycles", "--over", "0..3", "--points", "0"],
        &["response", "--over", "0..3", "--set", "speed=2"],
    ] {
        let ran = run(arguments);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
    }
}

#[test]
fn a_rotor_that_floats_free_in_its_clearances_is_marginal_in_words_and_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let mass = "[[mass]]\nmass = 0.5\nbearing_stiffness = 1.0\ndeadband = 1.0\n";
    let text = format!("name = \"free\"\nunits = \"dimensionless\"\n{mass}{mass}[[shaft]]\nstiffness = 0.5\n");
    let path = folder.path().join("free.toml");
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    let document = run(&["response", path, "--over", "0..1", "--points", "2", "--json"]).json();
    for point in document["points"].as_array().unwrap() {
        let branch = &point["branches"][0];
        assert_eq!((&branch["stable"], &branch["growth"]), (&serde_json::Value::Null, &0.0.into()), "{branch}");
    }
    assert!(run(&["response", path, "--over", "0..1", "--points", "2"]).stdout.contains("marginal"));
    let found = run(&["run", path, "--speed", "1", "--duration", "20", "--json"]).json();
    assert_eq!((&found["centre_stability"], &found["centre_growth"]), (&"marginal".into(), &0.0.into()));
}

#[test]
fn regress_orbits_that_cannot_be_judged_are_told_and_do_not_end_the_command() {
    let asked = ["jeffcott", "--feedback", "cancel", "--over", "0.5..2", "--points", "2", "--deadband", "0.5"];
    let response = |delay: &str, rest: &[&str]| run(&[&["response"], &asked[..], &["--set", delay], rest].concat());
    let late = response("delay=5000", &["--json"]).json();
    for point in late["points"].as_array().unwrap() {
        let branches = point["branches"].as_array().unwrap();
        assert!(!branches.is_empty(), "{point}");
        for branch in branches {
            assert!(branch["stable"].is_null() && branch["growth"].is_null() && branch["force"].is_f64(), "{branch}");
            for why in ["stable_null", "growth_null"] {
                assert!(branch[why].as_str().unwrap().contains("too"), "{branch}");
            }
        }
    }
    let text = response("delay=5000", &[]).stdout;
    assert!(text.contains("unknown") && text.contains("the stability of") && text.contains("too many roots"), "{text}");
    let judged = response("delay=0.05", &["--json"]).json();
    let first = &judged["points"][0]["branches"][0];
    assert!(first["growth"].is_f64() && first.get("growth_null").is_none(), "{first}");
    // Cycles too: nothing to be judged is no error.
    let cycles = run(&[&["cycles"], &asked[..], &["--set", "delay=5000"]].concat());
    assert!(cycles.stdout.contains("limit cycle"), "{cycles:?}");
}

#[test]
fn regress_the_sensitivity_of_the_rig_has_a_bound() {
    let document = run(&["margin", "rig", "--speed", "6000", "--json"]).json();
    let found = &document["largest_sensitivity"];
    let [peak, below] = ["peak", "below"].map(|name| found[name].as_f64().unwrap_or_else(|| panic!("{found}")));
    assert!(peak <= below * (1.0 + 1e-9) && below <= 1.0001 * peak, "{found}");
}
