//! `whirl trace`, `thresholds`, `modes`, `assign`: the documented fields, and refusals that say what is wrong.

use promises::{Ran, run};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is not a list"))
}

#[test]
fn thresholds_are_those_of_the_report() {
    for (rotor, expected) in [
        ("three-mass", &[(1.775_522, 0.887_761), (4.101_250, 2.050_625), (4.650_456, 2.325_228)][..]),
        ("jeffcott", &[(2.209_975, 1.104_988)]),
    ] {
        let document = run(&["thresholds", rotor, "--over", "0..6", "--json"]).json();
        let found = list(&document["thresholds"]);
        assert_eq!(found.len(), expected.len(), "{document}");
        for (threshold, (speed, frequency)) in found.iter().zip(expected) {
            assert!((number(&threshold["speed"]) - speed).abs() < 5e-7, "{threshold}");
            assert!((number(&threshold["frequency"]) - frequency).abs() < 5e-7, "{threshold}");
            assert_eq!((&threshold["whirl"], &threshold["becomes"]), (&"forward".into(), &"unstable".into()));
        }
    }
}

#[test]
fn a_trace_has_the_promised_fields_and_the_campbell_diagram() {
    let document = run(&["trace", "three-mass", "--over", "0..5", "--points", "11", "--json"]).json();
    assert_eq!(list(&document["speeds"]).len(), 11);
    assert_eq!(list(&document["min_damping"]).len(), 11);
    assert_eq!(list(&document["modes"]).len(), 6);
    assert_eq!(number(&document["speeds"][10]), 5.0);
    for (at, least) in list(&document["min_damping"]).iter().enumerate() {
        let of_modes = list(&document["modes"]).iter().map(|branch| number(&branch[at]["damping"]));
        assert_eq!(of_modes.fold(f64::INFINITY, f64::min), number(least));
    }
    for point in list(&document["modes"]).iter().flat_map(list) {
        for field in ["re", "im", "damping", "log_dec", "frequency"] {
            number(&point[field]);
        }
    }
    let campbell = &document["campbell"];
    let orders: Vec<f64> = list(&campbell["lines"]).iter().map(|line| number(&line["order"])).collect();
    assert_eq!(orders, [0.5, 1.0]);
    // The seals drive each mode unstable where it whirls at half speed: the 0.5X line is met on the thresholds.
    let half_speed: Vec<f64> = list(&campbell["critical_speeds"])
        .iter()
        .filter(|c| number(&c["order"]) == 0.5 && c["whirl"] == "forward")
        .map(|c| number(&c["speed"]))
        .collect();
    assert_eq!(half_speed.len(), 3);
    assert!((half_speed[0] - 1.775_522).abs() < 5e-7);
}

#[test]
fn tables_of_a_trace_have_a_row_for_each_point_and_branch() {
    let csv = run(&["trace", "jeffcott", "--over", "0..1", "--points", "4", "--csv"]);
    let rows: Vec<&str> = csv.stdout.lines().collect();
    assert_eq!(rows[0], "speed,mode,re,im,damping,log dec,frequency,whirl");
    assert_eq!(rows.len(), 1 + 4 * 2);
    let campbell = run(&["trace", "jeffcott", "--over", "0..3", "--campbell", "--csv"]);
    assert_eq!(campbell.stdout.lines().next(), Some("line,speed,mode,frequency,damping,whirl"));
    assert_eq!(campbell.stdout.lines().count(), 1 + 4);
}

#[test]
fn modes_are_orbits_over_one_whirl_period() {
    let document = run(&["modes", "three-mass", "--speed", "4.1012498", "--json", "--points", "33"]).json();
    let pitch = list(&document["modes"]).iter().find(|m| number(&m["damping"]).abs() < 1e-6).expect("on its threshold");
    let orbits = list(&pitch["orbits"]);
    assert_eq!(orbits.len(), 3);
    for (orbit, radius) in orbits.iter().zip([1.0, 0.0, 1.0]) {
        let points = list(orbit);
        assert_eq!(points.len(), 33);
        for point in points {
            assert!((number(&point["y"]).hypot(number(&point["z"])) - radius).abs() < 1e-5);
        }
        assert!((number(&points[32]["tau"]) - number(&pitch["period"])).abs() < 1e-12);
        assert!((number(&points[0]["y"]) - number(&points[32]["y"])).abs() < 1e-5, "closed on its threshold");
    }
}

#[test]
fn assigned_poles_are_reported_with_their_error() {
    let wanted = "-1,2;-1,-2;-0.5,1;-0.5,-1;-1,3;-1,-3";
    let document = run(&["assign", "three-mass", "--speed", "4", "--poles", wanted, "--json"]).json();
    assert!(number(&document["largest_error"]) < 1e-10);
    assert_eq!(list(&document["achieved"]).len(), 6);
    assert_eq!(document["feedback"]["bearing"], 1);
    assert_eq!(list(&document["feedback"]["signal"]).len(), 3);
}

#[test]
fn val_assigned_feedback_reads_back_as_the_wanted_poles() {
    let home = tempfile::tempdir().expect("a temporary directory");
    let file = home.path().join("assigned.toml");
    let file = file.to_str().expect("UTF-8");
    let wanted = "-1,2;-1,-2;-0.5,1;-0.5,-1;-1,3;-1,-3";
    let printed = run(&["assign", "three-mass", "--speed", "4", "--poles", wanted]);
    assert_eq!(printed.code, Some(0), "{printed:?}");
    std::fs::write(file, &printed.stdout).expect("written");
    let document = run(&["poles", "three-mass", "--feedback", file, "--speed", "4", "--json"]).json();
    let poles: Vec<(f64, f64)> =
        list(&document["modes"]).iter().map(|mode| (number(&mode["re"]), number(&mode["im"]))).collect();
    for pair in wanted.split(';') {
        let (re, im) = pair.split_once(',').expect("a pair");
        let (re, im): (f64, f64) = (re.parse().expect("a number"), im.parse().expect("a number"));
        let error = poles.iter().map(|(a, b)| (a - re).hypot(b - im)).fold(f64::INFINITY, f64::min);
        assert!(error < 1e-9, "{pair} is missed by {error:e}: {poles:?}");
    }
}

#[test]
fn a_mode_out_of_reach_is_named() {
    let wanted = "-1,2;-1,-2;-0.5,1;-0.5,-1;-1,3;-1,-3";
    let Ran { code, stdout, stderr } = run(&["assign", "--speed", "4", "--bearing", "2", "--poles", wanted]);
    assert_eq!((code, stdout.as_str()), (Some(1), ""));
    assert!(
        stderr.contains("mass 2 does not move the forward mode") && stderr.contains("(1.000, 0.000, -1.000)"),
        "{stderr}"
    );
    let table = run(&["assign", "--table", "--speed", "4", "--json"]).json();
    let stuck = |mass: usize| list(&table["modes"]).iter().filter(|m| m["controllable"][mass] == false).count();
    assert_eq!([stuck(0), stuck(1), stuck(2)], [0, 2, 0]);
}

#[test]
fn the_cancelling_law_is_printed_as_a_feedback_file() {
    let printed = run(&["assign", "jeffcott", "--cancel", "--reference", "0.78"]);
    assert_eq!(printed.code, Some(0), "{printed:?}");
    assert!(printed.stdout.contains("kc = { at_zero = 0.39, slope = -0.5 }"), "{printed:?}");
    let home = tempfile::tempdir().expect("a temporary directory");
    let file = home.path().join("law.toml");
    let written =
        run(&["assign", "jeffcott", "--cancel", "--reference", "0.78", "--out", file.to_str().expect("UTF-8")]);
    assert_eq!((written.code, written.stdout.as_str()), (Some(0), ""), "{written:?}");
    assert_eq!(std::fs::read_to_string(&file).expect("written"), printed.stdout);
    assert_eq!(std::fs::read_dir(home.path()).expect("there").count(), 1, "nothing else is left");
}

#[test]
fn poles_without_a_speed_are_those_at_the_speed_that_up_starts_with_and_it_is_said() {
    let (without, with) = (run(&["poles"]), run(&["poles", "--speed", "2.5", "--feedback", "off"]));
    assert_eq!((without.code, with.code), (Some(0), Some(0)), "{without:?}");
    let taken = "not said, so taken: the speed of `up`, R = 2.5 (--speed); feedback off (--feedback)";
    assert_eq!(without.stdout, format!("{}\n{taken}\n", with.stdout.trim_end()));
    assert_eq!(run(&["poles", "--json"]).stdout, run(&["poles", "--speed", "2.5", "--json"]).stdout);
    let typed = run(&["poles", "--set", "speed=1", "--set", "feedback=off"]);
    assert!(typed.stdout.contains("R = 1") && !typed.stdout.contains("taken"), "{typed:?}");
}

#[test]
fn bad_input_exits_2_and_prints_nothing() {
    for (arguments, complaint) in [
        (&["thresholds", "--over", "6..0"][..], "expected A..B with finite numbers A < B, such as 0..6"),
        (&["thresholds", "--over", "3"], "expected A..B"),
        (&["trace", "--over", "-1..2"], "speed = -1: expected a number from 0 to 1000"),
        (&["trace", "--over", "0..2000"], "speed = 2000: expected a number from 0 to 1000"),
        (&["trace", "--over", "0..2", "--points", "1"], "--points"),
        (&["modes", "--speed", "nan"], "speed = NaN"),
        (&["assign", "--cancel"], "for one mass"),
        (&["assign", "jeffcott", "--cancel", "--reference", "inf"], "reference = inf: expected a finite number"),
        (&["assign", "--poles", "-1,2"], "--speed"),
        (&["assign", "--speed", "1", "--poles", "-1,2"], "6 poles to assign, found 1"),
        (&["assign", "--speed", "1", "--poles", "x"], "expected re,im"),
        (&["assign", "--speed", "1"], "--poles"),
        (&["assign", "jeffcott", "--speed", "1", "--bearing", "2", "--poles", "-1,1;-1,-1"], "masses 1 to 1"),
    ] {
        let Ran { code, stdout, stderr } = run(arguments);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{arguments:?}: {stderr}");
        assert!(stderr.contains(complaint), "{arguments:?}: {stderr}");
    }
}

#[test]
fn margins_have_the_promised_fields_and_the_printed_values() {
    let composite = ["--feedback", "composite", "--json"];
    let document = run(&[&["margin", "three-mass", "--speed", "2.5"][..], &composite].concat()).json();
    assert_eq!((&document["rotor"], &document["stable"]), (&"three-mass".into(), &true.into()), "{document}");
    for field in ["tau", "turns", "frequency"] {
        assert!(document["delay"][field].is_number(), "{document}");
    }
    assert_eq!(document["delay"]["seconds_null"], "the rotor is dimensionless");
    for field in ["up", "down"] {
        assert!(document["gain"][field]["factor"].is_number() && document["gain"][field]["frequency"].is_number());
    }
    assert!(document["phase"]["degrees"].is_number());
    let sensitivity = &document["sensitivity"];
    for field in ["peak", "decibels", "frequency"] {
        assert!(sensitivity[field].is_number(), "{sensitivity}");
    }
    for side in ["forward", "backward", "axis"] {
        assert!(sensitivity[side]["peak"].is_number(), "{sensitivity}");
    }
    assert!(document["complementary"]["peak"].is_number() && document["force"]["peak"].is_number());
    assert_eq!(document["bearings"][0]["name"], "mass 1");
    // A bound that nothing exceeds, a little above what was found; none of samples.
    let (peak, below) = (number(&sensitivity["peak"]), number(&sensitivity["below"]));
    assert!(peak <= below && below < 1.000_001 * peak && sensitivity["proof"] == "hamiltonian", "{sensitivity}");
    let with = |set| {
        run(&["margin", "three-mass", "--speed", "2.5", "--feedback", "composite", "--set", set, "--json"]).json()
    };
    let (late, sampled) = (with("delay=0.02"), with("sample=0.05"));
    let [peak, below] = ["peak", "below"].map(|name| number(&late["sensitivity"][name]));
    assert!(peak <= below && below < 1.002 * peak && late["sensitivity"]["proof"] == "covered", "{late}");
    assert!(sampled["sensitivity"]["below"].is_null() && sampled["sensitivity"]["below_null"].is_string(), "{sampled}");
    assert_eq!(document["bearings"][0]["sensitivity"], *sensitivity);
    // What is not there says why.
    let off = run(&["margin", "three-mass", "--speed", "1", "--json"]).json();
    assert!(off["delay"].is_null() && off["delay_null"].is_string() && off["gain"]["up_null"].is_string(), "{off}");
    // Zones that somebody else asks for.
    let zone = |zones: &[&str]| {
        run(&[&["margin", "three-mass", "--speed", "6"][..], &composite, zones].concat()).json()["sensitivity"]["zone"]
            .clone()
    };
    assert_eq!((zone(&[]), zone(&["--zones", "11,12,13"])), ("D".into(), "A".into()));
    // Over speed: the worst, and where.
    let over = run(&[&["margin", "three-mass", "--over", "1..6", "--points", "21"][..], &composite].concat()).json();
    let worst = &over["worst"]["delay"];
    assert!((number(&worst["speed"]) - 6.0).abs() < 1e-6, "{worst}");
    assert!(number(&worst["delay"]["tau"]) < number(&document["delay"]["tau"]));
}

#[test]
fn an_unstable_loop_has_no_margins_and_says_its_pole() {
    for speed in [["--speed", "7.5"], ["--over", "1..8"]] {
        let ran = run(&[&["margin", "three-mass", "--feedback", "composite"][..], &speed].concat());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(1), ""), "{ran:?}");
        assert!(ran.stderr.contains("is not stable at R = ") && ran.stderr.contains("it has a pole at"), "{ran:?}");
    }
    for zones in ["3,4", "4,3,5", "0,1,2"] {
        let ran = run(&["margin", "--speed", "1", "--zones", zones]);
        assert!(ran.code == Some(2) && ran.stderr.contains("three rising numbers"), "{ran:?}");
    }
}

#[test]
fn bode_tells_every_curve_and_draws_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let machine = ["bode", "three-mass", "--feedback", "composite"];
    let of = |options: &[&str]| run(&[&machine[..], options].concat());
    for (what, open) in [("loop", true), ("sensitivity", false), ("closed", false), ("station=2", false)] {
        let document = of(&["--speed", "6", "--of", what, "--json"]).json();
        assert_eq!((&document["of"], &document["open"], number(&document["speed"])), (&what.into(), &open.into(), 6.0));
        let points = list(&document["points"]);
        assert!(points.len() > 50, "{what}");
        for field in ["frequency", "re", "im", "amplitude", "phase"] {
            assert!(points[0][field].is_number(), "{field}");
        }
    }
    let sensitivity = of(&["--speed", "6", "--of", "sensitivity"]);
    assert!(sensitivity.stdout.contains("10.3495 at 2.27041"), "{sensitivity:?}");
    for (k, show) in ["amplitude", "phase", "nyquist"].into_iter().enumerate() {
        let path = folder.path().join(format!("{show}.{}", if k == 1 { "png" } else { "svg" }));
        let drawn = of(&["--speed", "6", "--show", show, "--out", path.to_str().expect("UTF-8")]);
        assert_eq!(drawn.code, Some(0), "{drawn:?}");
        assert!(std::fs::metadata(&path).expect("is there").len() > 2000, "{show}");
    }
    let unbalance = of(&["--over", "0..6", "--of", "unbalance", "--json"]).json();
    assert_eq!(list(&list(&unbalance["points"])[0]["stations"]).len(), 3);
    assert!(list(&unbalance["criticals"]).iter().all(|c| c["speed"].is_number() && c["station"].is_u64()));
    assert_eq!(of(&["--speed", "6", "--csv"]).stdout.lines().next(), Some("frequency,re,im,amplitude,phase"));
    for (options, code, why) in [
        (&["--speed", "7.5", "--of", "sensitivity"][..], 1, "it has a pole at"),
        (&["--speed", "6", "--of", "station=4"][..], 2, "has masses 1 to 3"),
        (&["--speed", "6", "--of", "station=2", "--set", "sample=0.05"][..], 2, "sample=off"),
        (&["--speed", "6", "--of", "unbalance"][..], 2, "expected --over A..B"),
        (&["--over", "1..6"][..], 2, "expected --speed R"),
        (&["--over", "1..6", "--of", "unbalance", "--band", "0..3"][..], 2, "--band does nothing"),
        (&["--speed", "6", "--of", "nothing"][..], 2, "expected loop, sensitivity"),
        (&["--speed", "6", "--out", "a.pdf"][..], 2, ".svg or .png"),
    ] {
        let refused = of(options);
        assert!(refused.code == Some(code) && refused.stderr.contains(why), "{options:?}: {refused:?}");
    }
}
