//! Searches through a loop, with margins to be kept, and of a shaft on magnetic bearings.

use promises::run;
use serde_json::Value;

use super::{folder, number, text};

#[test]
fn a_search_through_the_loop_writes_the_loop_and_tells_what_poles_tells() {
    let folder = folder();
    let file = folder.path().join("late.toml");
    let line = ["tune", "--speed", "5", "--set", "lag=0.02", "--set", "delay=0.02", "--json"];
    let document = run(&[&line[..], &["--out", text(&file)]].concat()).json();
    assert_eq!((&document["proven"], &document["stable"]), (&Value::from(false), &Value::from(true)), "{document}");
    assert!(document["checked"].is_u64() && document["count_right_of"].is_number(), "{document}");
    let poles = run(&["poles", "--speed", "5", "--feedback", text(&file), "--json"]).json();
    let [told, found] = [&poles, &document].map(|document| number(document, "min_damping"));
    assert!((told - found).abs() < 1e-9, "{told} {found}");
    // The gains of that loop again, from its file.
    let again = run(&["tune", "--speed", "5", "--feedback", text(&file), "--json"]).json();
    assert!((number(&again, "min_damping") - found).abs() < 1e-6, "{again}");
    for (options, why) in [
        (&["--set", "limit=20"][..], "--set limit: a search takes the linear parts of the loop"),
        (&["--set", "kd=1"][..], "--set kd: a search takes"),
        (&["--set", "delay=0.1", "--delay", "0.1"][..], "the loop has a delay already"),
        (&["--feedback", "composite", "--sensors", "1,2"][..], "cannot be used with"),
    ] {
        let refused = run(&[&["tune", "--speed", "5"], options].concat());
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{options:?}: {refused:?}");
    }
}

#[test]
fn margins_are_kept_over_the_whole_range_and_missed_ones_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("kept.toml");
    let file = file.to_str().expect("UTF-8");
    let search = [
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
        "--starts",
        "4",
    ];
    let kept = ["--max-sensitivity", "1.5", "--min-delay", "0.1", "--out", file, "--json"];
    let document = run(&[&search[..], &kept[..]].concat()).json();
    let (peak, delay) = (&document["sensitivity"]["peak"], &document["delay"]["tau"]);
    assert!(peak.as_f64().expect("a number") <= 1.5 * 1.001 && delay.as_f64().expect("a number") >= 0.1 * 0.999);
    let below = document["sensitivity"]["below"].as_f64().expect("proven");
    assert!((1.0..1.0011).contains(&(below / peak.as_f64().expect("a number"))), "{below} {peak}");
    let margins = run(&["margin", "three-mass", "--feedback", file, "--over", "0..6", "--json"]).json();
    let worst = margins["worst"]["sensitivity"]["sensitivity"]["peak"].as_f64().expect("a number");
    assert!((worst / peak.as_f64().expect("a number") - 1.0).abs() < 1e-3, "{worst} {peak}");
    // No gains so small keep so long a delay.
    let missed = run(&["tune", "three-mass", "--speed", "6", "--bound", "0.7", "--starts", "2", "--min-delay", "5"]);
    assert_eq!(missed.code, Some(1), "{missed:?}");
    assert!(missed.stderr.contains("no gains were found"), "{}", missed.stderr);
    for (option, value, words) in [
        ("--max-sensitivity", "1", "expected a number above 1"),
        ("--min-delay", "0", "expected a finite number above 0"),
    ] {
        let refused = run(&["tune", "three-mass", "--speed", "6", option, value]);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains(words), "{}", refused.stderr);
    }
}

/// What is found for a rotor of shaft elements on its magnetic bearings is what the machine is, by every command that reads it back.
#[test]
fn the_law_of_a_shaft_on_two_magnetic_bearings_is_made_better_and_read_back() {
    let folder = folder();
    let file = folder.path().join("better.toml");
    let ask =
        ["tune", "rig", "--speed", "6000", "--starts", "1", "--max-sensitivity", "3", "--min-delay", "2e-5", "--json"];
    let document = run(&[&ask[..], &["--out", text(&file)]].concat()).json();
    assert_eq!((&document["stable"], &document["proven"]), (&Value::from(true), &Value::from(false)), "{document}");
    assert!(document["below"].is_number(), "{document}");
    let before = run(&["poles", "rig", "--speed", "6000", "--json"]).json();
    assert!(number(&document, "min_damping") > number(&before, "min_damping"), "{document}");
    let poles = run(&["poles", "rig", "--speed", "6000", "--feedback", text(&file), "--json"]).json();
    // Of the modes that count.
    let modes = poles["modes"].as_array().expect("modes").iter();
    let counts = |mode: &&Value| number(mode, "re").hypot(number(mode, "im")) <= number(&document, "below");
    let read = modes.filter(counts).map(|mode| number(mode, "damping")).fold(1.0, f64::min);
    assert!((read - number(&document, "min_damping")).abs() < 1e-8, "{read} {}", document["min_damping"]);
    let margin = run(&["margin", "rig", "--speed", "6000", "--feedback", text(&file), "--json"]).json();
    let (told, read) = (&document["sensitivity"]["peak"], &margin["sensitivity"]["peak"]);
    let [told, read] = [told, read].map(|value| value.as_f64().unwrap_or_else(|| panic!("{margin}")));
    assert!(told <= 3.003 && (told / read - 1.0).abs() < 1e-3, "{told} {read}");
    // Gains alone, of sensors that are named, and from a file for both ends of a chain.
    let named =
        ["tune", "rig", "--speed", "3000", "--signal", "individual", "--sensors", "left,right", "--starts", "1"];
    let document = run(&[&named[..], &["--json"]].concat()).json();
    assert!(number(&document, "min_damping") > number(&before, "min_damping"), "{document}");
    for (options, words) in [
        (&["rig", "--bearing", "1"][..], "--bearing: every magnetic bearing"),
        (&["rig", "--vary", "mass.1=10%"], "--vary mass.1: parameters of masses vary, but rig is of shaft elements"),
        (&["rig", "--sensors", "left,middle"], "--sensors: no place 'middle': rig has magnetic bearings left, right"),
        (&["rig", "--sensors", "left,left"], "--sensors: place 'left' is named twice"),
        (&["rig", "--sensors", "any:2"], "--sensors any: places of a rotor of shaft elements are named"),
        (&["rig", "--below", "0"], "--below 0: expected a frequency in Hz above 0"),
        (&["rig", "--robust", "deadband"], "--robust: rig has no support bearing with stiffness"),
        (&["three-mass", "--below", "100"], "--below: every mode of a chain of masses counts"),
        (&["three-mass", "--sensors", "1,left"], "expected masses counted from 1"),
    ] {
        let refused = run(&[&["tune"], options, &["--speed", "6"]].concat());
        assert_eq!(refused.code, Some(2), "{options:?}: {refused:?}");
        assert!(refused.stderr.contains(words), "{options:?}: {}", refused.stderr);
    }
}
