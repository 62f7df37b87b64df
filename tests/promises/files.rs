//! Rotor and feedback files: what is right is used, what is wrong is told at its line and column.

use std::fs;
use std::path::{Path, PathBuf};

use promises::{Ran, Root, Screen, run, whirl};
use tempfile::TempDir;

fn fixture(name: &str) -> String {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "fixtures", name].iter().collect();
    path.to_str().expect("UTF-8").to_owned()
}

/// Runs `whirl` in `folder`, so that messages hold bare file names.
fn run_in(folder: &Path, arguments: &[&str]) -> Ran {
    let output = whirl().args(arguments).current_dir(folder).output().expect("whirl starts");
    let text = |bytes| String::from_utf8(bytes).expect("whirl prints UTF-8");
    Ran { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

const MASS: &str = "[[mass]]\nmass = 1\n";
const SIGNAL: &str = "bearing = 1\n[[signal]]\n";

#[test]
fn every_wrong_rotor_file_says_where_and_what_was_expected() {
    let folder = TempDir::new().expect("a folder");
    for (text, complaint) in [
        // Keys.
        (
            "nam = 'x'\n[[mass]]\nmass = 1",
            "1:1: unknown key 'nam': expected one of name, units, reference_length, mass, shaft; did you mean 'name'?",
        ),
        (
            "[[mass]]\nmass = 1\ndampng = 1",
            "3:1: unknown key 'dampng': expected one of mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband; did you mean 'damping'?",
        ),
        (
            "[[mass]]\nmass = 1\nwidth = 1",
            "3:1: unknown key 'width': expected one of mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband",
        ),
        ("name = ''\n[[mass]]\nmass = 1", "1:8: name = '': expected 1 to 64 bytes of printable text in quotes"),
        ("units = 'SI'\n[[mass]]\nmass = 1", "1:9: units = 'SI': expected \"dimensionless\" or \"si\""),
        ("units = 3\n[[mass]]\nmass = 1", "1:9: units = 3: expected \"dimensionless\" or \"si\""),
        (
            "reference_length = 1\n[[mass]]\nmass = 1",
            "1:20: reference_length = 1: expected units = \"si\" with it: dimensionless lengths are in e_t",
        ),
        // Masses.
        ("name = 'x'", "1:1: no [[mass]]: expected 1 to 16 of them"),
        ("[[mass]]\ndamping = 1", "1:1: [[mass]] 1 without mass: expected mass = a finite number greater than 0"),
        ("[mass]\nmass = 1", "1:1: [mass]: expected [[mass]] and its keys on lines of their own"),
        ("mass = 1", "1:8: mass = 1: expected [[mass]] and its keys on lines of their own"),
        ("[[mass]]\nmass = 0", "2:8: mass = 0: expected a finite number greater than 0"),
        ("[[mass]]\nmass = -0.25", "2:8: mass = -0.25: expected a finite number greater than 0"),
        ("[[mass]]\nmass = 'heavy'", "2:8: mass = 'heavy': expected a finite number greater than 0"),
        ("[[mass]]\nmass = nan", "2:8: mass = nan: expected a finite number greater than 0"),
        ("[[mass]]\nmass = 1e999", "2:8: mass = 1e999: expected a finite number greater than 0"),
        ("[[mass]]\nmass = 1\n damping = -1", "3:12: damping = -1: expected a finite number, not negative"),
        ("[[mass]]\nmass = 1\ncross_damping = -1", "3:17: cross_damping = -1: expected a finite number, not negative"),
        (
            "[[mass]]\nmass = 1\nbearing_stiffness = -1",
            "3:21: bearing_stiffness = -1: expected a finite number, not negative",
        ),
        (
            "[[mass]]\nmass = 1\nseal_stiffness = inf",
            "3:18: seal_stiffness = inf: expected a finite number, not negative",
        ),
        ("[[mass]]\nmass = 1\ndeadband = -1e-3", "3:12: deadband = -1e-3: expected a finite number, not negative"),
        ("[[mass]]\nmass = 1\ndeadband = 2e6", "3:12: deadband = 2e6: expected at most 1000000"),
        ("[[mass]]\nmass = 1\nunbalance = -inf", "3:13: unbalance = -inf: expected a finite number"),
        (
            &MASS.repeat(17),
            "33:1: 17 times [[mass]]: expected 1 to 16 of them\nbad.toml:33:1: 17 masses and no shafts: expected 16 [[shaft]], one between each two masses",
        ),
        // Shafts.
        (&MASS.repeat(3), "5:1: 3 masses and no shafts: expected 2 [[shaft]], one between each two masses"),
        (
            "[[mass]]\nmass = 1\n[[shaft]]\nstiffness = 1",
            "3:1: 1 mass and 1 shaft: expected no [[shaft]], one between each two masses",
        ),
        (
            &(MASS.repeat(2) + "[[shaft]]\nstiffness = -2"),
            "6:13: stiffness = -2: expected a finite number, not negative",
        ),
        (
            &(MASS.repeat(2) + "[[shaft]]"),
            "5:1: [[shaft]] 1 without stiffness: expected stiffness = a finite number, not negative",
        ),
        // SI.
        (
            "units = 'si'\n[[mass]]\nmass = 1\nunbalance = 1e-5",
            "1:9: the sum of bearing_stiffness and seal_stiffness = 0: expected a finite number of N/m greater than 0, because w0 = sqrt(K_t / M_t)",
        ),
        (
            "units = 'si'\n[[mass]]\nmass = 1\nseal_stiffness = 1",
            "1:9: the sum of unbalance = 0: expected a finite number of m greater than 0, or a reference_length in m to measure displacements by",
        ),
        (
            "reference_length = 0\nunits = 'si'\n[[mass]]\nmass = 1\nseal_stiffness = 1",
            "1:20: reference_length = 0: expected a finite number greater than 0",
        ),
        // Not TOML.
        ("[[mass]]\nmass = 1.2.3", "2:11: invalid float: '.3': expected TOML"),
        ("[[mass]\nmass = 1", "1:8: unclosed array table: expected `]`"),
        ("[[mass]]\nmass = 1\nmass = 2", "3:1: duplicate key: 'mass': expected TOML"),
    ] {
        fs::write(folder.path().join("bad.toml"), text).expect("written");
        let ran = run_in(folder.path(), &["poles", "bad.toml", "--speed", "1", "--json"]);
        let expected = format!("whirl: bad.toml:{complaint}\n");
        assert_eq!((ran.code, ran.stdout.as_str(), ran.stderr.as_str()), (Some(2), "", expected.as_str()), "{text}");
    }
}

#[test]
fn every_wrong_feedback_file_says_where_and_what_was_expected() {
    let folder = TempDir::new().expect("a folder");
    let gain = |text: &str| format!("{SIGNAL}mass = 1\nkd = {text}");
    const GAIN: &str = "expected a number, { at_zero = A, slope = B } or { speed = [..], value = [..] }";
    for (text, complaint) in [
        ("bering = 1\n[[signal]]\nmass = 1".to_owned(), "1:1: unknown key 'bering': expected one of units, gains, bearing, filter, signal, loop; did you mean 'bearing'?\nbad.toml:1:1: no bearing: expected bearing = a mass of the rotor that carries the control bearing, 1 to 3".to_owned()),
        ("bearing = 4\n[[signal]]\nmass = 1".into(), "1:11: bearing = 4: expected a mass of the rotor, 1 to 3".into()),
        ("bearing = 0\n[[signal]]\nmass = 1".into(), "1:11: bearing = 0: expected a mass of the rotor, 1 to 3".into()),
        ("bearing = 1.0\n[[signal]]\nmass = 1".into(), "1:11: bearing = 1.0: expected a mass of the rotor, 1 to 3".into()),
        ("bearing = 1".into(), "1:1: no [[signal]]: expected 1 to 16 of them".into()),
        ("bearing = 1\nsignal = []".into(), "2:10: no [[signal]]: expected 1 to 16 of them".into()),
        (format!("bearing = 1\n{}", "[[signal]]\nmass = 1\n".repeat(17)), "34:1: 17 times [[signal]]: expected 1 to 16 of them".into()),
        (format!("{SIGNAL}mass = 5"), "3:8: mass = 5: expected a mass of the rotor, 1 to 3".into()),
        (format!("{SIGNAL}kd = 1"), "2:1: [[signal]] 1 without mass or weights: expected either mass = N, or displacement = [..] and velocity = [..]".into()),
        (format!("{SIGNAL}mass = 1\ndisplacement = [1, 0, 0]"), "2:1: [[signal]] 1 with both mass and weights: expected either mass = N, or displacement = [..] and velocity = [..]".into()),
        (format!("{SIGNAL}displacement = [1, 0, 0]"), "2:1: [[signal]] 1 without velocity weights: expected either mass = N, or displacement = [..] and velocity = [..]".into()),
        (format!("{SIGNAL}displacement = [1, 0]\nvelocity = [1, 0, 0]"), "3:16: displacement with 2 weights: expected 3, one for each mass".into()),
        (format!("{SIGNAL}displacement = [1, nan, 0]\nvelocity = [1, 0, 0]"), "3:20: displacement, entry 2: nan: expected a finite number".into()),
        (format!("{SIGNAL}displacement = 1\nvelocity = [1, 0, 0]"), "3:16: displacement = 1: expected a list of weights, one a mass".into()),
        (format!("{SIGNAL}mass = 1\nkD = 1"), "4:1: unknown key 'kD': expected one of mass, displacement, velocity, kd, cd, kc, cc, filter; did you mean 'kd'?".into()),
        (gain("'strong'"), format!("4:6: kd = 'strong': {GAIN}")),
        (gain("nan"), "4:6: kd = nan: expected a number from -1000000 to 1000000".into()),
        (gain("2e6"), "4:6: kd = 2e6: expected a number from -1000000 to 1000000".into()),
        (gain("{ speed = [1] }"), format!("4:6: kd = {{ speed = [1] }}: {GAIN}")),
        (gain("{ at_zero = 1 }"), "4:6: kd without slope: expected slope = a finite number".into()),
        (gain("{ at_zero = 1, slope = inf }"), "4:29: slope = inf: expected a finite number".into()),
        (gain("{ speed = [0, 1], value = [1] }"), "4:6: kd with 2 speeds and 1 values: expected as many values as speeds, at least one".into()),
        (gain("{ speed = [], value = [] }"), "4:6: kd with 0 speeds and 0 values: expected as many values as speeds, at least one".into()),
        (gain("{ speed = [0, 1, 1], value = [1, 2, 3] }"), "4:23: speed 1 after 1: expected rising speeds".into()),
        (format!("{SIGNAL}mass = 1\n[loop]\ndelay = -0.1"), "5:9: delay = -0.1: expected 0 or a number from 0.000000001 to 1000000".into()),
        (format!("{SIGNAL}mass = 1\nfilter = [{{ kind = \"lowpass\", corner = 8, order = 9 }}]"), "4:51: order = 9: expected an order, 1 to 8".into()),
    ] {
        fs::write(folder.path().join("bad.toml"), &text).expect("written");
        let ran = run_in(folder.path(), &["poles", "three-mass", "--speed", "1", "--feedback", "bad.toml"]);
        let expected = format!("whirl: bad.toml:{complaint}\n");
        assert_eq!((ran.code, ran.stdout.as_str(), ran.stderr.as_str()), (Some(2), "", expected.as_str()), "{text}");
    }
}

#[test]
fn what_is_no_readable_text_is_told_so() {
    let folder = TempDir::new().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("folder.toml")).expect("made");
    fs::write(at("latin.toml"), b"name = 'x'\n# gr\xfc\xdfe\n").expect("written");
    fs::write(at("huge.toml"), "# very long\n".repeat(100_000)).expect("written");
    fs::write(at("prose.toml"), "The rotor of our lab\n").expect("written");
    for (file, start) in [
        ("missing.toml", "missing.toml: no such file: expected a TOML file that can be read"),
        ("folder.toml", "folder.toml: a directory: expected a TOML file that can be read"),
        ("./folder.toml/", "./folder.toml/: a directory: expected"),
        ("latin.toml", "latin.toml:2:5: byte 0xfc is not UTF-8: expected TOML text in UTF-8"),
        ("huge.toml", "huge.toml:1:1: more than 1 MiB: expected a TOML file of at most 1 MiB"),
        ("prose.toml", "prose.toml:1:"),
    ] {
        for arguments in [
            &["poles", file, "--speed", "1"][..],
            &["poles", "--speed", "1", "--feedback", file],
            &["rotor", "show", file],
            &["rotor", "check", file],
        ] {
            let ran = run_in(folder.path(), arguments);
            assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
            assert!(ran.stderr.starts_with(&format!("whirl: {start}")), "{ran:?}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_fails_while_it_is_read_is_told_so() {
    // Opening one's own memory works for anyone, reading it at address 0 for no one.
    let ran = run(&["rotor", "show", "/proc/self/mem"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
    assert!(ran.stderr.starts_with("whirl: /proc/self/mem: ") && ran.stderr.ends_with("can be read\n"), "{ran:?}");
}

#[test]
fn check_tells_all_errors_of_a_file_and_goes_on() {
    let (bad, good) = (fixture("many-errors.toml"), fixture("three-mass-si.toml"));
    let ran = run(&["rotor", "check", &bad, &good, &fixture("scheduled.toml")]);
    assert_eq!(ran.code, Some(2));
    let places: Vec<_> = ran.stderr.lines().map(|line| line.split(&bad).last().expect("a place")).collect();
    let starts = [
        ":2:9: units",
        ":5:8: mass",
        ":6:1: unknown",
        ":8:1: [[mass]] 2",
        ":9:11: damping",
        ":12:13: stiff",
        ":14:1: 2 masses and 2 shafts",
    ];
    assert_eq!(places.len(), starts.len(), "{}", ran.stderr);
    for (place, start) in places.iter().zip(starts) {
        assert!(place.starts_with(start), "{place}");
    }
    assert!(ran.stdout.contains("three-mass-si.toml: ok, 3 masses, SI, w0 = 300.000 rad/s = 2864.79 rpm\n"), "{ran:?}");
    assert!(ran.stdout.contains("scheduled.toml: ok, feedback, 2 signals, bearing at mass 1\n"), "{ran:?}");

    let ran = run(&["rotor", "check", "--json", &bad, &good]);
    assert_eq!(ran.code, Some(2));
    let document: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one document");
    assert_eq!(document["files"][0]["ok"], false);
    assert_eq!(document["files"][0]["problems"][1]["line"], 5);
    assert_eq!(document["files"][0]["problems"][1]["column"], 8);
    assert_eq!(document["files"][1]["masses"], 3);

    let ran = run(&["rotor", "check", &fixture("scheduled.toml"), "--for", "jeffcott"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("scheduled.toml:11:16: displacement with 3 weights: expected 1"), "{ran:?}");
}

#[test]
fn on_a_terminal_the_line_of_a_fault_stands_under_it() {
    let (root, folder) = (Root::new(), TempDir::new().expect("a folder"));
    fs::write(folder.path().join("bad.toml"), "[[mass]]\nmass = -0.25\n").expect("written");
    let mut screen = Screen::start_in(folder.path(), root.path(), &["poles", "bad.toml", "--speed", "1"], (100, 20));
    assert_eq!(screen.ended().exit_code(), 2);
    let text = screen.text();
    let lines: Vec<&str> = text.lines().map(str::trim_end).take(4).collect();
    let told = "whirl: bad.toml:2:8: mass = -0.25: expected a finite number greater than 0";
    assert_eq!(lines, [told, "  |", "2 | mass = -0.25", "  |        ^^^^^"], "{text}");
}

#[test]
fn show_prints_a_file_that_is_the_same_rotor() {
    let folder = TempDir::new().expect("a folder");
    for rotor in ["jeffcott", "three-mass", &fixture("three-mass-si.toml")] {
        let shown = run(&["rotor", "show", rotor]).stdout;
        fs::write(folder.path().join("again.toml"), &shown).expect("written");
        assert_eq!(run_in(folder.path(), &["rotor", "show", "again.toml"]).stdout, shown);
        let poles = |name: &str| run_in(folder.path(), &["poles", name, "--speed", "3", "--json"]).json();
        assert_eq!(poles("again.toml"), poles(rotor));
    }
    let shown = run(&["rotor", "show", "three-mass", "--feedback", &fixture("scheduled.toml")]).stdout;
    fs::write(folder.path().join("feedback.toml"), &shown).expect("written");
    let poles = |name: &str| run_in(folder.path(), &["poles", "--speed", "3", "--json", "--feedback", name]).json();
    assert_eq!(poles("feedback.toml"), poles(&fixture("scheduled.toml")));
}

#[test]
fn an_si_rotor_takes_rpm_and_metres_and_answers_with_scales() {
    let rig = fixture("three-mass-si.toml");
    // 300 rad/s are R = 1; its rpm in full.
    let rpm = format!("{}", 300.0 * 60.0 / std::f64::consts::TAU);
    let si = run(&["poles", &rig, "--speed", &rpm, "--deadband", "20e-6", "--json"]).json();
    let plain = run(&["poles", "three-mass", "--speed", "1", "--json"]).json();
    assert_eq!((si["units"].as_str(), si["scales"]["w0"].as_f64()), (Some("si"), Some(300.0)));
    assert_eq!((si["scales"]["k_t"].as_f64(), si["scales"]["m_t"].as_f64()), (Some(3.6e6), Some(40.0)));
    assert!(plain.get("units").is_none() && plain.get("scales").is_none());
    assert!((si["speed"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
    for (a, b) in si["modes"].as_array().expect("modes").iter().zip(plain["modes"].as_array().expect("modes")) {
        for field in ["re", "im", "damping", "frequency"] {
            let [a, b] = [a, b].map(|mode| mode[field].as_f64().expect("a number"));
            assert!((a - b).abs() < 1e-12, "{field}: {a} and {b}");
        }
    }

    let table = run(&["poles", &rig, "--speed", &rpm]).stdout;
    assert!(table.starts_with("test rig at 2864.79 rpm (R = 1.00000), deadband neglected\n"), "{table}");
    assert!(table.contains("re (1/s)") && table.contains("frequency (Hz)"), "{table}");
    for (arguments, complaint) in [
        (["--speed=-1", "--deadband=0"], "speed = -1 rpm: expected a number from 0.000000 to 2864789 rpm"),
        (["--speed=1", "--deadband=-2e-6"], "deadband = -0.000002 m: expected a number from 0.000000 to 20.0000 m"),
    ] {
        let ran = run(&[&["poles", &rig][..], &arguments].concat());
        assert_eq!((ran.code, ran.stderr), (Some(2), format!("whirl: {complaint}\n")));
    }
}

#[test]
fn list_names_every_built_in_rotor() {
    let document = run(&["rotor", "list", "--json"]).json();
    let names: Vec<_> =
        document["rotors"].as_array().expect("a list").iter().map(|r| r["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["jeffcott", "three-mass", "rig"]);
    let table = run(&["rotor", "list"]).stdout;
    assert!(names.iter().all(|name| table.contains(name)), "{table}");
    let shown = run(&["rotor", "show", "three-mass", "--json"]).json();
    assert_eq!(shown["masses"][1]["unbalance"], 1.0);
    let dimensionless = run(&["rotor", "show", &fixture("three-mass-si.toml"), "--dimensionless", "--json"]).json();
    assert_eq!(dimensionless["masses"][2]["deadband"], 1.0);
    assert!(dimensionless.get("scales").is_none());
}

#[test]
fn layouts_are_listed_shown_checked_and_overridden() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("whirl/layouts");
    std::fs::create_dir_all(&own).unwrap();
    let run = |arguments: &[&str]| {
        let output = promises::whirl().args(arguments).env("XDG_CONFIG_HOME", folder.path()).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (code, shown, _) = run(&["layout", "show", "operator"]);
    assert_eq!(code, Some(0));
    let mine = own.join("mine.toml");
    std::fs::write(&mine, &shown).unwrap();
    let (code, listed, _) = run(&["layout", "list"]);
    assert_eq!(code, Some(0));
    for name in ["overview", "operator", "tuning", "whirl", "replay", "mine"] {
        assert!(listed.contains(name), "{listed}");
    }
    assert_eq!(run(&["layout", "check", mine.to_str().unwrap()]).0, Some(0));
    std::fs::write(&mine, "[[screen]]\npicture = '''\npoles orbit\n'''\n").unwrap();
    let (code, _, complaint) = run(&["layout", "check", mine.to_str().unwrap()]);
    assert_eq!(code, Some(2));
    assert!(complaint.contains("mine.toml:3:7: no panel 'orbit': expected one of poles"), "{complaint}");
    let (code, _, complaint) = run(&["dash", "--layout", "nope"]);
    assert_eq!(code, Some(2), "a wrong file of one's own is said before anything starts");
    assert!(complaint.contains("mine.toml:3:7"), "{complaint}");
    std::fs::remove_file(&mine).unwrap();
    let (code, _, complaint) = run(&["dash", "--layout", "nope"]);
    assert_eq!(code, Some(2));
    assert!(complaint.contains("no layout 'nope': expected one of overview"), "{complaint}");
}
