//! How a search ends: without gains that hold, interrupted, in time.

use std::path::Path;

use promises::{PATIENCE, Ran, interrupted, run, terminated_at_work};
use serde_json::Value;

use super::{folder, number, text};

#[test]
fn gains_that_do_not_hold_are_shown_and_not_written() {
    let folder = folder();
    let file = folder.path().join("no.toml");
    let ask = ["tune", "--over", "0..7.6", "--starts", "4", "--out", text(&file), "--json"];
    let ran = run(&ask);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("no gains were found that hold the rotor"), "{}", ran.stderr);
    let document: Value = serde_json::from_str(&ran.stdout).expect("the best is printed all the same");
    assert_eq!(document["stable"], false);
    assert!(number(&document, "min_damping") < 0.0 && number(&document, "worst_speed") > 5.0);
    assert!(!file.exists());
    assert_eq!(run(&[&ask[..], &["--write-unstable"]].concat()).code, Some(1));
    assert!(file.exists());
}

#[test]
fn an_interrupted_search_gives_the_best_until_then() {
    let folder = folder();
    let file = folder.path().join("best.toml");
    let ran: Ran = interrupted(&[
        "tune",
        "--over",
        "0..6",
        "--signal",
        "individual",
        "--starts",
        "100000",
        "--out",
        text(&file),
        "--json",
    ]);
    assert_eq!(ran.code, Some(130), "{}", ran.stderr);
    let document: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert_eq!(document["interrupted"], true);
    assert!(document["values"].as_array().unwrap().len() < 100_000);
    if document["stable"] == true {
        assert!(std::fs::read_to_string(&file).expect("written").contains("interrupted"));
    }
}

/// A file of `count` masses, each with `fields`, on shafts of 0.5.
fn rotor_file(path: &Path, count: usize, fields: &str) {
    let masses = format!("[[mass]]\n{fields}\n").repeat(count);
    let shafts = "[[shaft]]\nstiffness = 0.5\n".repeat(count - 1);
    std::fs::write(path, format!("name = \"made\"\nunits = \"dimensionless\"\n{masses}{shafts}")).expect("written");
}

/// The grid of 2^17 conditions of a search for any deadband once looked at nothing for nine minutes. The patience is for
/// slow machines: it used to be exceeded many times over.
#[test]
fn a_search_in_a_large_family_ends_when_it_is_told_to() {
    let folder = folder();
    let file = folder.path().join("long.toml");
    for count in [10, 16] {
        rotor_file(
            &file,
            count,
            "mass = 0.25\ndamping = 0.25\ncross_damping = 0.05\nbearing_stiffness = 0.5\nunbalance = 1.0",
        );
        let ask = ["tune", text(&file), "--over", "0..1", "--bearing", "1", "--sensors", "1,2"];
        let (ran, after) = terminated_at_work(&[&ask[..], &["--robust", "deadband", "--starts", "1"]].concat());
        assert_eq!(ran.code, Some(130), "{ran:?}");
        assert!(after < PATIENCE / 3, "{count} masses: {after:?}");
    }
}

/// A rotor held only by its magnetic bearing, a free mode, a mode that nothing damps: bounds that leave no room, and so
/// nothing but rounding to tell the damping by.
#[test]
fn gains_that_leave_a_mode_marginal_are_no_success_and_no_file() {
    let folder = folder();
    let (file, out) = (folder.path().join("loose.toml"), folder.path().join("gains.toml"));
    for (fields, bound) in
        [("damping = 0.0", "1e-300"), ("damping = 0.1", "1e-300"), ("bearing_stiffness = 0.5", "1e-300")]
    {
        rotor_file(&file, 2, &format!("mass = 0.5\n{fields}"));
        let ask = ["tune", text(&file), "--speed", "0", "--bearing", "1", "--sensors", "1", "--bound", bound];
        for more in [&[][..], &["--delay", "0.1"], &["--measure", "decay"]] {
            let ran = run(&[&ask[..], more, &["--starts", "1", "--out", text(&out), "--json"]].concat());
            assert_eq!(ran.code, Some(1), "{fields} {more:?}: {ran:?}");
            assert!(!out.exists(), "{fields} {more:?}: {ran:?}");
            let document: Value = serde_json::from_str(&ran.stdout).expect("JSON");
            assert!(document["stable"] != true && number(&document, "min_damping") <= 0.0, "{document}");
        }
    }
}

/// The seconds told are those of the whole command, the proof and the judgement after it too; half of them was the proof.
#[test]
fn the_time_told_is_wall_time_all_of_it() {
    let begun = std::time::Instant::now();
    let document = run(&["tune", "three-mass", "--over", "0..5", "--measure", "decay", "--json"]).json();
    let (told, passed) = (number(&document, "seconds"), begun.elapsed().as_secs_f64());
    assert!(told <= passed && told > 0.5 * passed, "{told} s told, {passed} s passed");
}
