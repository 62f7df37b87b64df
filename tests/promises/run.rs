//! `whirl run` and `whirl force`: the documented fields, files that are whole or not there, and refusals in words.

use std::time::{Duration, Instant};

use promises::{interrupted, run, whirl};

#[test]
fn prints_the_promised_fields_and_the_reconstructed_impulse() {
    for (deadband, force) in [("0", 9.367), ("1", 9.684), ("10", 11.415)] {
        let document = run(&[
            "run",
            "jeffcott",
            "--feedback",
            "cancel",
            "--speed",
            "5",
            "--impulse",
            "mass=1,vy=-2.5",
            "--duration",
            "40",
            "--deadband",
            deadband,
            "--json",
        ])
        .json();
        assert!((document["max_force_component"].as_f64().unwrap() - force).abs() < 6e-4, "{document}");
        assert_eq!(document["diverged"], false);
        assert!(document["diverged_at"].is_null() && document["settled_at"].is_null());
        assert!(document["steps"].as_u64().unwrap() > 1000 && document["seconds"].is_f64());
        assert!(document["max_force"].as_f64().unwrap() >= document["max_force_component"].as_f64().unwrap());
        for list in ["max_displacement", "mean_radius"] {
            assert_eq!(document[list].as_array().unwrap().len(), 1);
        }
        assert_eq!(document["final"]["tau"], 40.0);
        let mass = &document["final"]["masses"][0];
        assert!(["y", "z", "vy", "vz"].iter().all(|field| mass[field].is_f64()), "{mass}");
    }
}

#[test]
fn settles_by_itself_and_says_from_when() {
    let document =
        run(&["run", "jeffcott", "--feedback", "cancel", "--speed", "5", "--duration", "200", "--json"]).json();
    assert_eq!(document["settled"], "steady");
    assert!(document["settled_at"].as_f64().unwrap() < 150.0);
    assert!((document["max_force"].as_f64().unwrap() - 2.655_371).abs() < 1e-6, "{document}");
    let short = run(&["run", "jeffcott", "--feedback", "cancel", "--speed", "5", "--duration", "12", "--json"]).json();
    assert_eq!(short["settled"], "no");
    assert!(short["settled_at"].is_null());
}

#[test]
fn a_short_run_tells_the_step_that_it_makes() {
    let short = ["run", "jeffcott", "--speed", "1", "--duration", "0.001"];
    assert_eq!(run(&[&short[..], &["--json"]].concat()).json()["dtau"], 0.001);
    assert!(run(&short).stdout.contains("1 steps of 0.00100000 to"), "{:?}", run(&short));
}

#[test]
fn steady_values_say_whether_the_motion_would_stay() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("centre.toml");
    std::fs::write(&file, "bearing = 2\n\n[[signal]]\nmass = 2\nkd = 1.0\ncd = 2.0\n").unwrap();
    let file = file.to_str().unwrap();
    let machine = ["three-mass", "--feedback", file];
    let found = run(&[&["run"], &machine[..], &["--speed", "4.3", "--duration", "5000", "--json"]].concat()).json();
    assert_eq!((found["settled"].as_str(), found["stability"].as_str()), (Some("steady"), Some("unstable")));
    assert_eq!((&found["stable"], &found["centre_stability"]), (&false.into(), &"unstable".into()));
    assert!((found["growth"].as_f64().unwrap() - 0.0122).abs() < 1e-4, "{found}");
    let options = ["--over", "4..4.3", "--points", "2"];
    let swept = run(&[&["force"], &machine[..], &options, &["--json"]].concat()).json();
    assert_eq!(swept["stability"], serde_json::json!([["stable", "unstable"]]), "{swept}");
    let table = run(&[&["force"], &machine[..], &options].concat()).stdout;
    assert!(
        table.contains("steady  UNSTABLE") && table.contains("1 of 2 steady values belong to motion that is NOT"),
        "{table}"
    );
}

#[test]
fn a_diverging_run_says_when_and_keeps_what_it_has() {
    let document = run(&[
        "run",
        "--speed",
        "2.5",
        "--impulse",
        "mass=2,vz=1,at=3",
        "--duration",
        "5000",
        "--set",
        "deadband.1=0.5",
        "--json",
    ])
    .json();
    assert_eq!(document["diverged"], true);
    assert_eq!(document["diverged_at"], document["final"]["tau"]);
    assert_eq!(document["deadband"], serde_json::json!([0.5, 0.0, 0.0]));
}

#[test]
fn names_spectral_lines_in_multiples_of_the_spin() {
    let document = run(&[
        "run",
        "three-mass",
        "--feedback",
        "composite",
        "--speed",
        "6",
        "--deadband",
        "1",
        "--duration",
        "1200",
        "--settle",
        "400",
        "--psd",
        "mass=1",
        "--json",
    ])
    .json();
    let peaks = document["psd"]["peaks"].as_array().unwrap();
    // The self-excited whirl of the report, near 0.76 rad per tau, stands above the unbalance.
    assert!((peaks[0]["frequency"].as_f64().unwrap() - 0.77).abs() < 0.03, "{}", peaks[0]);
    assert!(peaks.iter().any(|p| p["name"] == "1X"), "{peaks:?}");
    let (frequency, density) = (&document["psd"]["frequency"], &document["psd"]["density"]);
    assert_eq!(frequency.as_array().unwrap().len(), density.as_array().unwrap().len());
}

#[test]
fn writes_a_whole_file_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let path_text = path.to_str().unwrap();
    let done = run(&["run", "--speed", "1", "--duration", "10", "--dtau", "0.02", "--out", path_text, "--every", "10"]);
    assert_eq!(done.code, Some(0), "{done:?}");
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "tau,y1,z1,vy1,vz1,y2,z2,vy2,vz2,y3,z3,vy3,vz3,uy,uz,contact");
    assert_eq!(lines.len(), 1 + 51);
    assert!(lines[1..].iter().all(|line| line.split(',').all(|field| field.parse::<f64>().unwrap().is_finite())));

    // Interrupted: the file of before stays, and nothing lies about beside it.
    let mut long = whirl()
        .args(["run", "--speed", "1", "--duration", "1e7", "--out", path_text, "--force"])
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while std::fs::read_dir(folder.path()).unwrap().count() < 2 && began.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = rustix::process::Pid::from_child(&long);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
    assert_eq!(long.wait().unwrap().code(), Some(130));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_interrupt_ends_every_analysis_with_130_and_half_a_result_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.csv");
    for arguments in [
        &["force", "--over", "0.01..7", "--points", "5000", "--feedback", "composite"][..],
        &["response", "--over", "0..7", "--points", "20000", "--deadband", "1"],
        &["cycles", "--over", "0..7", "--points", "20000", "--deadband", "1", "--feedback", "composite"],
        &["run", "--speed", "1", "--duration", "1e7", "--out", file.to_str().unwrap()],
    ] {
        let ran = interrupted(arguments);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(130), ""), "{arguments:?}: {ran:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_place_that_takes_no_file_is_refused_before_anything_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("taken.csv");
    std::fs::create_dir(&directory).unwrap();
    let nowhere = folder.path().join("missing").join("run.csv");
    for (path, complaint) in
        [(&directory, "is a directory: expected a file to write"), (&nowhere, "No such file or directory")]
    {
        let path = path.to_str().unwrap();
        for arguments in [
            // Minutes, if it were not refused first.
            &["run", "--speed", "1", "--duration", "1e7", "--out", path][..],
            &["assign", "jeffcott", "--cancel", "--out", path],
        ] {
            let ran = run(arguments);
            assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
            assert!(ran.stderr.contains(complaint) && ran.stderr.contains(path), "{ran:?}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn bad_input_exits_2_and_writes_nothing() {
    for (arguments, complaint) in [
        (&["--duration", "0"][..], "duration = 0: expected a finite number greater than 0"),
        (&["--duration", "nan"], "duration = NaN: expected a finite number greater than 0"),
        (&["--duration", "5", "--settle", "6"], "settle = 6: expected a number from 0 to the duration, 5"),
        (&["--duration", "1e30"], "steps are too many"),
        (&["--duration", "5", "--impulse", "mass=4,vy=1"], "impulse at mass 4, but three-mass has masses 1 to 3"),
        (&["--duration", "5", "--impulse", "mass=one"], "expected a mass, counted from 1"),
        (&["--duration", "5", "--psd", "mass=9"], "psd at mass 9, but three-mass has masses 1 to 3"),
        (&["--duration", "5", "--dtau", "2"], "dtau = 2 is too long for the mode at"),
        (&["--duration", "5", "--dtau", "0"], "dtau = 0: expected a finite number greater than 0"),
        (&["--duration", "5", "--out", "x.txt"], "expected a file name that ends in .csv, .parquet or .rrd"),
        (&["--duration", "5", "--set", "deadband.7=1"], "no deadband.7: there are 3 masses"),
    ] {
        let ran = run(&[&["run", "three-mass", "--speed", "2"], arguments].concat());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
        assert!(ran.stderr.contains(complaint), "{ran:?}");
    }
}

#[test]
fn sweeps_the_force_over_speed_and_clearance() {
    let document = run(&[
        "force",
        "jeffcott",
        "--feedback",
        "cancel",
        "--over",
        "0..5",
        "--points",
        "11",
        "--deadband",
        "0,1,10",
        "--json",
    ])
    .json();
    assert_eq!(document["speeds"].as_array().unwrap().len(), 11);
    assert_eq!(document["deadbands"], serde_json::json!([0.0, 1.0, 10.0]));
    for (row, expected) in document["max_force"].as_array().unwrap().iter().zip([2.655_371, 2.572_277, 2.569_950]) {
        assert_eq!(row[0], 0.0);
        assert!((row[10].as_f64().unwrap() - expected).abs() < 1e-6, "{row}");
    }
    for over in ["5..1", "1..1", "fast", "0..inf"] {
        assert_eq!(run(&["force", "jeffcott", "--over", over]).code, Some(2));
    }
    assert_eq!(run(&["force", "jeffcott", "--over", "0..1", "--deadband", "-1"]).code, Some(2));
}
