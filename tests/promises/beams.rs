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
    let set = root.run(&["set", "right.kd=3400", "delay=2e-5", "--json"]);
    assert_eq!(set.code, Some(0), "{}", set.stderr);
    let which = root.run(&["set", "kd=3400"]);
    assert_eq!(which.code, Some(1));
    assert!(which.stderr.contains("left.kd, right.kd"), "{}", which.stderr);
    assert_eq!(bench.end().code, Some(0));
}
