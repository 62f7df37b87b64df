//! Rotors of shaft elements and magnetic bearings: imported, looked at, simulated live.

use promises::{Root, run};
use serde_json::Value;

/// A file that another program has saved; those of crate `beam` are its tests' too.
fn case(name: &str) -> String {
    format!("{}/../crates/beam/tests/cases/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// The slowest eigenvalues that ROSS has for a file at a speed in rad/s, with their conjugates.
fn expected(name: &str, speed: &str) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(case("ross_eigenvalues.json")).expect("is there");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    serde_json::from_value(all["rotors"][name]["speeds"][speed]["lateral_lowest_24"].clone()).expect("pairs")
}

#[test]
fn val_an_imported_rotor_has_the_poles_that_its_own_program_gives_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.toml");
    let imported = run(&["rotor", "import", &case("overhung_gyroscopic.toml")]);
    assert_eq!((imported.code, imported.stderr.as_str()), (Some(0), ""));
    std::fs::write(&file, &imported.stdout).expect("can be written");
    let mine = file.to_str().expect("text");
    assert_eq!(run(&["rotor", "check", mine]).code, Some(0));

    let rpm = (500.0 * 30.0 / std::f64::consts::PI).to_string();
    let known = expected("overhung_gyroscopic", "500");
    // As it is stepped, and with all the coordinates of its elements.
    for (also, compared, within) in [(&[][..], 16, 1e-4), (&["--full"][..], 24, 1e-8)] {
        let document = run(&[&["poles", mine, "--speed", &rpm, "--json"], also].concat()).json();
        let w0 = document["scales"]["w0"].as_f64().expect("SI");
        let poles: Vec<[f64; 2]> = (document["modes"].as_array().expect("modes").iter())
            .map(|mode| ["re", "im"].map(|part| mode[part].as_f64().expect("a number") * w0))
            .collect();
        for [re, im] in &known[..compared] {
            let apart = |pole: &[f64; 2]| (pole[0] - re).hypot(pole[1] - im);
            let nearest = poles.iter().map(apart).fold(f64::INFINITY, f64::min);
            // Real eigenvalues come with their conjugates, which are backward whirl of another pair.
            let mirrored = poles.iter().map(|p| apart(&[p[0], -p[1]])).fold(f64::INFINITY, f64::min);
            assert!(nearest.min(mirrored) < within * re.hypot(*im), "{re} {im} is off by {nearest} {also:?}");
        }
    }
    assert_eq!(run(&["poles", "--speed", "1", "--full"]).code, Some(2), "a chain has no other coordinates");
}

#[test]
fn what_is_not_the_same_in_every_direction_is_refused_by_name_and_numbers() {
    let refused = run(&["rotor", "import", &case("rotor_example.toml")]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    assert!(refused.stderr.contains("BearingElement_Bearing 0: kxx = 1000000, kyy = 800000"), "{}", refused.stderr);
    let averaged = run(&["rotor", "import", "--average", &case("rotor_example.toml")]);
    assert_eq!(averaged.code, Some(0));
    assert!(averaged.stderr.contains("mean"), "{}", averaged.stderr);
    assert!(averaged.stdout.contains("stiffness = 900000.0"), "{}", averaged.stdout);

    // The file says so and with which numbers; whatever is told of the rotor later, its name.
    let took = "# BearingElement_Bearing 1: kxx = 1000000, kyy = 800000: their mean 900000 is taken\n";
    assert!(averaged.stdout.contains(took), "{}", averaged.stdout);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, &averaged.stdout).expect("is written");
    let file = file.to_str().expect("text");
    let name = "rotor_example (averaged bearings)";
    let poles = run(&["poles", file, "--speed", "4000"]);
    assert!(poles.stdout.starts_with(name), "{}", poles.stdout);
    let checked = run(&["rotor", "check", file]);
    assert!(checked.stdout.ends_with(", averaged from unequal directions\n"), "{}", checked.stdout);
    assert_eq!(run(&["rotor", "check", file, "--json"]).json()["files"][0]["name"], name);
    assert_eq!(run(&["rotor", "show", file, "--json"]).json()["name"], name);
    // A name that is given says so too, at the cost of its end.
    let long = "n".repeat(64);
    let named = run(&["rotor", "import", "--average", "--name", &long, &case("rotor_example.toml")]);
    let expected = format!("name = \"{} (averaged bearings)\"\n", "n".repeat(44));
    assert!(named.stdout.contains(&expected), "{}", named.stdout);
    // Where nothing is averaged nothing says so.
    let plain = run(&["rotor", "import", "--average", &case("isotropic.toml")]);
    assert!(!plain.stdout.contains("averaged") && !plain.stdout.starts_with('#'), "{}", plain.stdout);
}

#[test]
fn the_rig_has_margins_shapes_and_criticals() {
    let margins = run(&["margin", "rig", "--speed", "6000", "--json"]).json();
    let names: Vec<&str> =
        margins["bearings"].as_array().expect("two").iter().map(|b| b["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["left", "right"]);
    let seconds = margins["delay"]["seconds"].as_f64().expect("a delay");
    assert!((seconds - 176.36e-6).abs() < 0.1e-6, "{seconds}");
    assert!(margins["largest_sensitivity"]["peak"].as_f64().expect("a peak") > 1.36);

    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("shapes.svg");
    let drawn = run(&["modes", "rig", "--speed", "4000", "--out", picture.to_str().expect("text")]);
    assert_eq!((drawn.code, drawn.stderr.as_str()), (Some(0), ""));
    let svg = std::fs::read_to_string(&picture).expect("was written");
    assert!(svg.starts_with("<svg") && svg.len() > 5000, "{} bytes", svg.len());
    let again = run(&["modes", "rig", "--speed", "4000", "--out", picture.to_str().expect("text")]);
    assert_eq!(again.code, Some(2), "nothing is overwritten");

    let campbell = run(&["trace", "rig", "--over", "0..12000", "--campbell"]);
    assert_eq!(campbell.code, Some(0));
    assert!(campbell.stdout.contains("forward") && campbell.stdout.contains("backward"));
    let reduced = run(&["rotor", "reduce", "rig", "--over", "0..12000", "--check", "1e-3", "--json"]);
    assert_eq!(reduced.code, Some(0), "{}", reduced.stderr);
    assert!(reduced.json()["worst_frequency"].as_f64().expect("a number") < 1e-4);
    let chain = run(&["rotor", "reduce", "three-mass"]);
    assert_eq!((chain.code, chain.stdout.as_str()), (Some(2), ""));
}

#[test]
fn the_rig_runs_live_tells_the_force_of_each_bearing_and_takes_settings_by_their_names() {
    let root = Root::new();
    let bench = root.simulate(&["rig"]);
    let steps = root.run(&["tail", "--json", "--count", "3"]);
    assert_eq!(steps.code, Some(0), "{}", steps.stderr);
    for line in steps.stdout.lines() {
        let step: Value = serde_json::from_str(line).expect("JSON");
        assert_eq!(step["masses"].as_array().expect("places").len(), 12);
        assert!(step["bearing_uy2"].is_number() && step["force"]["y"].is_number(), "{line}");
    }
    let set = root.run(&["set", "right.kd=8.77e8N/m", "delay=20us", "--json"]);
    assert_eq!(set.code, Some(0), "{}", set.stderr);
    let which = root.run(&["set", "kd=3400"]);
    assert_eq!(which.code, Some(1));
    assert!(which.stderr.contains("left.kd, right.kd"), "{}", which.stderr);
    assert_eq!(bench.end().code, Some(0));
}

#[test]
fn the_smallest_damping_is_that_of_the_modes_below_a_frequency_in_every_command() {
    let machine = ["rig", "--speed", "6000"];
    let all = run(&["poles", "rig", "--speed", "6000", "--json"]).json();
    let w0 = all["scales"]["w0"].as_f64().expect("SI");
    let modes: Vec<(f64, f64)> = (all["modes"].as_array().expect("modes").iter())
        .map(|mode| {
            let of = |key: &str| mode[key].as_f64().expect("a number");
            (of("re").hypot(of("im")), of("damping"))
        })
        .collect();
    let mut told = Vec::new();
    for hertz in [30.0, 150.0, 1000.0, 2500.0] {
        let below = hertz * std::f64::consts::TAU / w0;
        let least =
            modes.iter().filter(|(size, _)| *size <= below).map(|(_, zeta)| *zeta).fold(f64::INFINITY, f64::min);
        let word = hertz.to_string();
        let found = run(&[&["poles"][..], &machine, &["--below", &word, "--json"]].concat()).json();
        let number =
            |document: &Value, key: &str| document[key].as_f64().unwrap_or_else(|| panic!("{key}: {document}"));
        assert!((number(&found, "below") - below).abs() < 1e-9 * below, "{hertz}");
        assert!((number(&found, "min_damping") - least).abs() < 1e-9, "{hertz}: {least} {found}");
        assert_eq!(found["modes"].as_array().map(Vec::len), Some(modes.len()), "all are listed");
        if hertz < 2000.0 {
            let margin = run(&[&["margin"][..], &machine, &["--below", &word, "--json"]].concat()).json();
            assert!((number(&margin, "min_damping") - least).abs() < 1e-6, "{hertz}: {least} {margin}");
            let traced =
                run(&["trace", "rig", "--over", "0..6000", "--points", "3", "--below", &word, "--json"]).json();
            let last = traced["min_damping"][2].as_f64().expect("one a speed");
            assert!((last - least).abs() < 1e-6, "{hertz}: {least} {last}");
        }
        told.push(least);
    }
    assert!(told.windows(2).all(|pair| pair[1] <= pair[0]) && told[0] > told[3], "more modes, less damping: {told:?}");
    // What counts is said.
    let words = run(&[&["poles"][..], &machine, &["--below", "150"]].concat());
    assert!(words.stdout.contains("modes up to 150.000 Hz count"), "{}", words.stdout);
    for (arguments, why) in [
        (&["poles", "rig", "--speed", "1", "--below", "0"][..], "--below 0: expected a frequency in Hz above 0"),
        (&["poles", "three-mass", "--speed", "1", "--below", "5"], "every mode of a chain of masses counts"),
    ] {
        let refused = run(arguments);
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{refused:?}");
    }
}

#[test]
fn a_rotor_that_nothing_holds_has_its_free_modes() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("free.toml");
    let steel = "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n";
    let text = format!(
        "{steel}{}[[unbalance]]\nstation = 2\ngrade = 'G2.5'\n",
        "[[section]]\nlength = 0.5\nouter = 0.06\nelements = 6\n".repeat(2)
    );
    std::fs::write(&file, &text).expect("can be written");
    let free = file.to_str().expect("text");
    let checked = run(&["rotor", "check", free]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    assert!(checked.stdout.contains("the speed that a grade without one is for"), "{}", checked.stdout);

    let found = run(&["poles", free, "--speed", "0", "--json"]).json();
    let modes = found["modes"].as_array().expect("modes");
    let still = modes.iter().filter(|mode| mode["re"] == 0.0 && mode["im"] == 0.0).count();
    assert_eq!((still, &found["marginal"]), (4, &Value::Bool(true)), "{found}");
    // Timoshenko's free beam of this size, first bending: 22.373 sqrt(E I / m L^4) less 2 % for shear and rotary inertia.
    let hertz = found["scales"]["w0"].as_f64().expect("SI") / std::f64::consts::TAU;
    let slender = 22.373 * (211e9_f64 * 0.06 * 0.06 / 16.0 / 7810.0).sqrt() / std::f64::consts::TAU;
    assert!(hertz < slender && hertz > 0.95 * slender, "{hertz} and {slender}");

    for arguments in [
        &["modes", free, "--speed", "3000"][..],
        &["poles", free, "--speed", "3000", "--full"],
        &["trace", free, "--over", "0..30000", "--campbell"],
        &["thresholds", free, "--over", "0..6000"],
        &["rotor", "reduce", free, "--over", "0..6000"],
    ] {
        let ran = run(arguments);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{arguments:?}");
    }
}
