//! Other forms of an answer: places ranked, gains over speed, a front, criteria side by side, rows; and questions that are none.

use promises::run;

use super::{folder, number, text};

#[test]
fn places_are_ranked() {
    let document =
        run(&["tune", "--speed", "5", "--bearing", "any", "--sensors", "any:2", "--starts", "4", "--json"]).json();
    let ranking = document["ranking"].as_array().unwrap();
    assert_eq!(ranking.len(), 9);
    let values: Vec<f64> = ranking.iter().map(|place| number(place, "objective")).collect();
    assert!(values.windows(2).all(|w| w[0] >= w[1]));
    // The report's choice by eye: an end mass carries the bearing, and that end and the centre are measured. The rotor is
    // its own mirror image, so both ends are as good.
    let mut best: Vec<String> =
        ranking[..2].iter().map(|place| format!("{} {}", place["bearing"], place["sensors"])).collect();
    best.sort();
    assert_eq!(best, ["1 [1,2]", "3 [2,3]"]);
    assert!((values[0] - values[1]).abs() < 1e-4);
}

#[test]
fn gains_follow_the_speed_in_a_file_that_everything_reads() {
    let folder = folder();
    let (file, picture) = (folder.path().join("tracked.toml"), folder.path().join("gains.svg"));
    let document =
        run(&["tune", "--over", "0..7", "--track", "15", "--out", text(&file), "--plot", text(&picture), "--json"])
            .json();
    assert!(number(&document, "min_damping") > 0.0 && document["proven"] == true, "{document}");
    assert!(number(&document, "steepest") < 2.0);
    assert_eq!(document["speeds"].as_array().unwrap().len(), 15);
    let trace = run(&["trace", "--feedback", text(&file), "--over", "0..7", "--points", "141", "--json"]).json();
    let least = trace["min_damping"].as_array().unwrap().iter().map(|d| d.as_f64().unwrap()).fold(1.0, f64::min);
    assert!(least >= number(&document, "min_damping") - 1e-4);
    assert!(std::fs::read_to_string(picture).unwrap().starts_with("<svg"));
}

#[test]
fn damping_is_traded_for_force() {
    let folder = folder();
    let (files, picture) = (folder.path().join("front"), folder.path().join("front.png"));
    let document = run(&[
        "tune",
        "--over",
        "0..5",
        "--pareto",
        "force",
        "--points",
        "4",
        "--starts",
        "3",
        "--out",
        text(&files),
        "--plot",
        text(&picture),
        "--json",
    ])
    .json();
    let points = document["points"].as_array().unwrap();
    assert!(points.len() >= 3, "{document}");
    for pair in points.windows(2) {
        assert!(number(&pair[0], "limit") > number(&pair[1], "limit"));
        assert!(number(&pair[0], "min_damping") >= number(&pair[1], "min_damping") - 1e-6, "{document}");
    }
    for point in points {
        assert!(number(point, "max_force") <= number(point, "limit") * 1.001);
        let file = point["file"].as_str().unwrap();
        assert_eq!(run(&["rotor", "check", file]).code, Some(0));
    }
    assert!(std::fs::read(picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn criteria_stand_side_by_side() {
    let ask = ["tune", "three-mass", "--speed", "4", "--criteria", "all", "--starts", "2", "--deadband", "0,1"];
    let document = run(&[&ask[..], &["--json"]].concat()).json();
    let rows = document["criteria"].as_array().expect("a list");
    let row = |name: &str| rows.iter().find(|row| row["criterion"] == name).expect("a criterion");
    let number =
        |name: &str, key: &str| row(name)[key].as_f64().unwrap_or_else(|| panic!("{name} {key}: {}", row(name)));
    let names = ["ratio", "decay", "weighted", "region", "sensitivity", "cost"];
    assert!(
        rows.len() == names.len()
            && names.iter().all(|name| row(name)["simulated"].as_array().is_some_and(|s| s.len() == 2))
    );
    // Each is best at what it is for.
    for other in names {
        assert!(number("ratio", "min_damping") >= number(other, "min_damping") - 1e-6, "{other}");
        assert!(number("decay", "decay") >= number(other, "decay") - 1e-6, "{other}");
        assert!(number("cost", "cost") <= number(other, "cost") * (1.0 + 1e-6), "{other}");
    }
    assert!(number("sensitivity", "sensitivity") <= 2.0 * 1.001);
    // What was simulated without clearance is the linear rotor: its force is that of `tune`.
    let plain = run(&["tune", "three-mass", "--speed", "4", "--starts", "2", "--json"]).json();
    let (simulated, exact) = (&row("ratio")["simulated"][0]["force"], &plain["max_force"]);
    let apart = simulated.as_f64().expect("a number") / exact.as_f64().expect("a number") - 1.0;
    assert!(apart.abs() < 1e-4, "{simulated} {exact}");

    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("found").to_string_lossy().into_owned();
    let few = ["tune", "three-mass", "--speed", "4", "--criteria", "ratio,cost", "--starts", "1", "--out", &out];
    let ran = run(&few);
    assert!(ran.code == Some(0) && ran.stdout.contains("cost: kd "), "{} {}", ran.stdout, ran.stderr);
    let poles =
        run(&["poles", "three-mass", "--speed", "4", "--feedback", &format!("{out}/ratio.toml"), "--json"]).json();
    assert!((poles["min_damping"].as_f64().expect("a number") - 0.065409).abs() < 1e-5);
    let again = run(&few);
    assert!(again.code == Some(2) && again.stderr.contains("ratio.toml"), "{}", again.stderr);
    for (rest, words) in [
        (&["--criteria", "ratio,ratio"][..], "ratio is given twice"),
        (&["--criteria", "ratio", "--region", "damping=0.1"], "region is not among --criteria"),
        (&["--criteria", "cost", "--delay", "0.1"], "gains alone"),
        (&["--measure", "region"], "expected --region"),
        (&["--measure", "region", "--region", "damping=0.1,damping=0.2"], "damping is given twice"),
        (&["--measure", "region", "--region", "frequency=3"], "expected a damping ratio or a decay rate"),
        (&["--region", "damping=0.1"], "not with --measure ratio"),
        (&["--measure", "cost", "--cost", "noise=0"], "noise = 0"),
    ] {
        let ran = run(&[&["tune", "three-mass", "--speed", "4"][..], rest].concat());
        assert!(ran.code == Some(2) && ran.stderr.contains(words), "{rest:?}: {}", ran.stderr);
    }
}

#[test]
fn rows_for_a_spreadsheet_are_numbers_of_scheduled_gains_too() {
    for (gains, rows) in [("fixed", 4), ("linear", 8), ("table:3", 12)] {
        let ran = run(&["tune", "three-mass", "--over", "0..3", "--gains", gains, "--starts", "1", "--csv"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let mut lines = ran.stdout.lines();
        assert_eq!(lines.next(), Some("signal,gain,speed,value"));
        let lines: Vec<&str> = lines.collect();
        assert_eq!(lines.len(), rows, "{lines:?}");
        for line in lines {
            let fields: Vec<&str> = line.split(',').collect();
            assert!(fields[3].parse::<f64>().is_ok() && (fields[2].is_empty() == (gains == "fixed")), "{line}");
        }
    }
}

#[test]
fn questions_that_make_no_sense_are_refused_with_the_reason() {
    for (arguments, words) in [
        (&["--over", "0..6", "--bound", "0"][..], "bound = 0: expected a finite number above 0"),
        (&["--over", "6..0"], "expected A..B with finite numbers A < B"),
        (&["--over", "0..6", "--speed", "3"], "cannot be used with"),
        (&[], "required arguments were not provided"),
        (&["--speed", "3", "--sensors", "4"], "no mass 4: three-mass has masses 1 to 3"),
        (&["--speed", "3", "--bearing", "9"], "no mass 9: three-mass has masses 1 to 3"),
        (&["--speed", "3", "--sensors", "0"], "expected masses counted from 1"),
        (&["--speed", "3", "--sensors", "1,1"], "a mass is named twice"),
        (&["--speed", "3", "--sensors", "any:4"], "three-mass has only 3 masses"),
        (&["--speed", "3", "--gains", "linear"], "gains that depend on speed need a range"),
        (&["--speed", "3", "--gains", "table:1"], "table:N with N from 2 to 64"),
        (&["--speed", "3", "--track", "5"], "cannot be used with"),
        (&["--over", "0..6", "--measure", "decay", "--mode-weights", "1,2"], "not with --measure decay"),
        (&["--over", "0..6", "--mode-weights", "1,0"], "mode weight 0: expected a finite number above 0"),
        (&["--over", "0..6", "--force-limit", "0"], "force limit = 0: expected a finite number above 0"),
        (&["--over", "0..6", "--force-limit", "2", "--pareto", "force"], "leave --force-limit out"),
        (&["--over", "0..6", "--vary", "colour.1=1..2"], "is no parameter: expected mass, damping"),
        (&["--over", "0..6", "--vary", "damping.7=10%"], "three-mass has 3 masses and 2 shafts"),
        (&["--over", "0..6", "--vary", "damping.2=10%"], "a part of it is nothing"),
        (&["--over", "0..6", "--vary", "damping.1=-1..1"], "expected a finite number, not negative"),
        (&["--over", "0..6", "--vary", "mass.1=10%", "--vary", "mass.1=5%"], "mass.1 is given twice"),
        (&["--over", "0..6", "--delay", "-1"], "expected finite numbers, not negative"),
        (&["--over", "0..6", "--plot", "x.svg"], "--plot draws what --track or --pareto finds"),
        (&["--over", "0..6", "--pareto", "force", "--plot", "x.jpg"], "ends in .svg or .png"),
        (&["--over", "0..6", "--out", "/"], "expected a file to write"),
        (&["--over", "0..6", "--tolerance", "0"], "--tolerance 0: expected a finite number above 0"),
        (&["--speed", "-1"], "speed"),
    ] {
        let ran = run(&[&["tune"], arguments].concat());
        assert_eq!(ran.code, Some(2), "{arguments:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{arguments:?}: {}", ran.stderr);
        assert_eq!(ran.stdout, "", "{arguments:?}");
    }
    let ran = run(&["tune", "jeffcott", "--over", "0..2", "--robust", "deadband"]);
    assert_eq!(ran.code, Some(0), "jeffcott has a bearing with stiffness: {}", ran.stderr);
}
