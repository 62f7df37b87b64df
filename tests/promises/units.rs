//! Units: an SI rotor equivalent to Table 4.2 gives the dimensionless results of three-mass, whatever is asked.

use promises::{Ran, run};
use serde_json::Value;

/// w0 in rad/s and e_t in m of the fixture.
const W0: f64 = 300.0;
const E_T: f64 = 20e-6;

fn fixture() -> String {
    concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/three-mass-si.toml").to_owned()
}

fn rpm(speed: f64) -> String {
    (speed * W0 * 60.0 / std::f64::consts::TAU).to_string()
}

fn metres(length: f64) -> String {
    (length * E_T).to_string()
}

/// Every number of `ours` equals that of `theirs` to `tolerance` of the larger of its size and `scale`.
fn same(ours: &Value, theirs: &Value, tolerance: f64, path: &str) {
    match (ours, theirs) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap_or(f64::NAN), b.as_f64().unwrap_or(f64::NAN));
            assert!((a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1.0), "{path}: {a} for {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| same(a, b, tolerance, &format!("{path}[{i}]")));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path}: {:?} for {:?}", a.keys(), b.keys());
            a.iter().for_each(|(key, value)| same(value, &b[key], tolerance, &format!("{path}.{key}")));
        }
        _ => assert_eq!(ours, theirs, "{path}"),
    }
}

/// Runs `command` on both rotors with options that mean the same, and compares all that the documents hold.
fn both(command: &str, dimensionless: &[&str], si: &[String], tolerance: f64) {
    let file = fixture();
    let theirs = run(&[&[command, "three-mass"], dimensionless, &["--json"]].concat()).json();
    let si: Vec<&str> = si.iter().map(String::as_str).collect();
    let mut ours = run(&[&[command, file.as_str()], si.as_slice(), &["--json"]].concat()).json();
    let fields = ours.as_object_mut().expect("an object");
    assert_eq!(fields.remove("units"), Some("si".into()), "{command}");
    let scales = fields.remove("scales").expect("scales");
    assert!((scales["w0"].as_f64().expect("a number") - W0).abs() < 1e-9);
    let mut theirs = theirs;
    let expected = theirs.as_object_mut().expect("an object");
    for own in ["rotor", "seconds"] {
        fields.remove(own);
        expected.remove(own);
    }
    same(&ours, &theirs, tolerance, command);
}

fn owned(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

#[test]
fn val_an_si_rotor_has_the_linear_results_of_its_dimensionless_form() {
    both("poles", &["--speed", "4"], &owned(&["--speed", &rpm(4.0)]), 1e-12);
    both("modes", &["--speed", "2.5", "--points", "5"], &owned(&["--speed", &rpm(2.5), "--points", "5"]), 1e-12);
    let over = format!("0..{}", rpm(6.0));
    both("thresholds", &["--over", "0..6"], &owned(&["--over", &over]), 1e-12);
    both("trace", &["--over", "0..6", "--points", "13"], &owned(&["--over", &over, "--points", "13"]), 1e-12);
    let wanted = "-1,2;-1,-2;-0.5,1;-0.5,-1;-1,3;-1,-3";
    // Gains of any size, and errors that are rounding.
    both("assign", &["--speed", "4", "--poles", wanted], &owned(&["--speed", &rpm(4.0), "--poles", wanted]), 1e-12);
    both("assign", &["--speed", "4", "--table"], &owned(&["--speed", &rpm(4.0), "--table"]), 1e-12);
}

/// The built-in composite feedback as a file: its name is for the built-in rotor alone.
fn composite(folder: &tempfile::TempDir) -> String {
    let file = folder.path().join("composite.toml");
    let shown = run(&["rotor", "show", "three-mass", "--feedback", "composite"]);
    std::fs::write(&file, shown.stdout).expect("written");
    file.to_str().expect("UTF-8").to_owned()
}

#[test]
fn val_an_si_rotor_has_the_orbits_of_its_dimensionless_form() {
    let (over, gap) = (format!("0..{}", rpm(7.0)), metres(1.0));
    let folder = tempfile::tempdir().expect("a folder");
    let file = composite(&folder);
    let feedback = ["--feedback", file.as_str()];
    let common = |own: &[&str]| owned(&[&feedback, own].concat());
    let sweep = common(&["--over", &over, "--points", "8", "--deadband", &gap]);
    let plain = [&feedback[..], &["--over", "0..7", "--points", "8", "--deadband", "1"]].concat();
    // Orbits at their speeds; where along a branch it was sampled is the continuation's affair.
    for command in ["response", "cycles"] {
        let file = fixture();
        let si: Vec<&str> = sweep.iter().map(String::as_str).collect();
        let ours = run(&[&[command, file.as_str()], si.as_slice(), &["--json"]].concat()).json();
        let theirs = run(&[&[command, "three-mass"], plain.as_slice(), &["--json"]].concat()).json();
        assert_eq!((&ours["units"], &theirs["units"]), (&"si".into(), &Value::Null));
        same(&ours["points"], &theirs["points"], 1e-12, command);
    }
    let force = common(&["--over", &over, "--points", "3", "--deadband", &format!("0,{gap}")]);
    let plain = [&feedback[..], &["--over", "0..7", "--points", "3", "--deadband", "0,1"]].concat();
    both("force", &plain, &force, 1e-12);
    let change = (-0.5 * W0 * E_T).to_string();
    let impulse = format!("mass=1,vy={change}");
    let ours = common(&["--speed", &rpm(2.0), "--duration", "50", "--impulse", &impulse, "--deadband", &gap]);
    let plain = ["--speed", "2", "--duration", "50", "--impulse", "mass=1,vy=-0.5", "--deadband", "1"];
    both("run", &[&feedback[..], &plain].concat(), &ours, 1e-12);
}

/// The headings of what a command prints for spreadsheets.
fn headings(command: &str, options: &[&str]) -> String {
    let file = fixture();
    let Ran { code, stdout, stderr } = run(&[&[command, file.as_str(), "--csv"], options].concat());
    assert_eq!(code, Some(0), "{stderr}");
    stdout.lines().next().unwrap_or_default().to_owned()
}

#[test]
fn tables_of_an_si_rotor_name_their_units() {
    let with = |more: &[&'static str]| [&["--over", "300..600", "--points", "2"], more].concat();
    for (command, options, expected) in [
        ("trace", with(&[]), "speed (rpm),mode,re (1/s),im (rad/s),damping,log dec,frequency (Hz),whirl"),
        ("trace", vec!["--over", "300..600", "--campbell"], "line,speed (rpm),mode,frequency (Hz),damping,whirl"),
        ("thresholds", vec!["--over", "0..14000"], "speed (rpm),frequency (Hz),whirl ratio,whirl,becomes"),
        ("modes", vec!["--speed", "600"], "mode,mass,t (s),y,z"),
        ("force", with(&[]), "speed (rpm),deadband (m),max force (N),motion,stability,centre"),
        ("response", with(&[]), "speed (rpm),branch,r1 (m),r2 (m),r3 (m),force (N),stability"),
        ("cycles", with(&[]), "speed (rpm),branch,frequency (Hz),r1 (m),r2 (m),r3 (m),stability"),
        (
            "run",
            vec!["--speed", "600", "--duration", "5"],
            "mass,max radius (m),mean radius (m),y (m),z (m),vy (m/s),vz (m/s)",
        ),
        (
            "assign",
            vec!["--speed", "600", "--table"],
            "re (1/s),im (rad/s),whirl,mass,control,observe,pbh,controllable",
        ),
    ] {
        assert_eq!(headings(command, &options), expected, "{command}");
    }
    let file = fixture();
    let printed = run(&["thresholds", &file, "--over", "0..14000"]);
    // 1.775522 of 300 rad/s, and half of it in turns a second.
    assert!(printed.stdout.contains("5086.50") && printed.stdout.contains("42.3875"), "{printed:?}");
    for (options, complaint) in [
        (&["--over", "0..1e9"][..], "speed = 1000000000 rpm: expected a number from"),
        (&["--over", "-1..2"], "speed = -1 rpm: expected a number from"),
    ] {
        let refused = run(&[&["thresholds", file.as_str()], options].concat());
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{refused:?}");
        assert!(refused.stderr.contains(complaint), "{refused:?}");
    }
}

#[test]
fn val_options_may_say_what_they_are_counted_in() {
    // 300 rad/s are 47.7464829275686 Hz and 2864.788975654116 rpm; e_t is 20 um.
    let si: &[&[&str]] = &[
        &["poles", "--speed", "119.3662073189215Hz"],
        &["thresholds", "--over", "0..286.4788975654116 Hz"],
        &["margin", "--speed", "1w0"],
        &["runup", "--from", "1w0", "--to", "100Hz", "--rate", "800Hz/s", "--deadband", "20um", "--points", "5"],
        &["response", "--over", "0.5..3w0", "--points", "3", "--deadband", "0.02mm"],
        &["run", "--deadband", "0um", "--speed", "300rad/s", "--duration", "0.1s", "--settle", "50ms"],
        &["map", "--x", "speed=40..120Hz", "--y", "delay=100..200us", "--points", "3x2"],
        // A velocity of 1 is 6 mm/s.
        &[
            "run",
            "--deadband",
            "0",
            "--speed",
            "1w0",
            "--duration",
            "30",
            "--impulse",
            "mass=1,vy=6mm/s,vz=-0.003m/s,at=20ms",
        ],
    ];
    let plain: &[&[&str]] = &[
        &["poles", "--speed", "2.5"],
        &["thresholds", "--over", "0..6"],
        &["margin", "--speed", "1"],
        &[
            "runup",
            "--from",
            "1",
            "--to",
            "2.0943951023931953",
            "--rate",
            "0.05585053606381855",
            "--deadband",
            "1",
            "--points",
            "5",
        ],
        &["response", "--over", "0.5..3", "--points", "3", "--deadband", "1"],
        &["run", "--deadband", "0", "--speed", "1", "--duration", "30", "--settle", "15"],
        &["map", "--x", "speed=0.8377580409572781..2.5132741228718345", "--y", "delay=0.03..0.06", "--points", "3x2"],
        &["run", "--deadband", "0", "--speed", "1", "--duration", "30", "--impulse", "mass=1,vy=1,vz=-0.5,at=6"],
    ];
    for (si, plain) in si.iter().zip(plain) {
        both(plain[0], &plain[1..], &owned(&si[1..]), 1e-6);
    }
}

#[test]
fn val_a_reduction_is_looked_at_over_what_it_says() {
    let reduced =
        |over: &str, up_to: &str| run(&["rotor", "reduce", "rig", "--over", over, "--up-to", up_to, "--json"]).json();
    let plain = reduced("0..6000", "800");
    assert_eq!(
        (&plain["up_to_hz"], plain["poles"].as_array().unwrap().last().unwrap()["rpm"].as_f64()),
        (&800.0.into(), Some(6000.0))
    );
    // 6000 rpm are 100 Hz, and 800 Hz 48000 rpm.
    for (over, up_to) in [("0..100Hz", "0.8kHz"), ("0rpm..6000rpm", "48000rpm")] {
        same(&reduced(over, up_to), &plain, 1e-9, over);
    }
}

#[test]
fn a_unit_of_something_else_or_of_a_rotor_without_scales_is_refused_in_words() {
    let file = fixture();
    let file = file.as_str();
    let no_scales = "expected a number without a unit: the rotor is not one in SI units";
    for (arguments, why) in [
        (&["poles", "--speed", "3000rpm"][..], no_scales),
        (&["poles", "--speed", "1", "--deadband", "250um"], no_scales),
        (&["thresholds", "--over", "0..50Hz"], no_scales),
        (&["map", "--speed", "1", "--x", "kd=0..1", "--y", "delay=0..200us"], no_scales),
        (&["tune", "--over", "0..3", "--delay", "200us"], no_scales),
        (&["run", "--speed", "1", "--duration", "3s"], no_scales),
        (&["sim", "--trip", "4mm"], no_scales),
        (&["sim", "--dtau", "20us"], no_scales),
        (&["sim", "--rate", "2rpm"], "expected a number, alone or in Hz, kHz"),
        (&["run", "--speed", "1", "--duration", "3", "--impulse", "mass=1,vy=6mm/s"], no_scales),
        (&["rotor", "reduce", "rig", "--over", "0..50N"], "expected"),
        (&["rotor", "reduce", "rig", "--up-to", "0kHz"], "expected a finite number greater than 0"),
        (&["assess", "--over", "0..3", "--force-limit", "2N"], no_scales),
        (&["poles", file, "--speed", "3000N"], "expected a number, alone or in rpm, Hz, rad/s"),
        (
            &["force", file, "--over", "0..50Hz", "--deadband", "20um,3s"],
            "expected a number, alone or in m, mm, um, nm",
        ),
        (&["trace", file, "--over", "0Hz..50"], "expected a unit at the upper end"),
        (&["trace", file, "--over", "50Hz..600rpm"], "expected A..B with finite numbers A < B"),
        (&["map", file, "--speed", "1", "--x", "damping.1=0..1um", "--y", "kd=0..1"], "without a unit"),
    ] {
        let Ran { code, stdout, stderr } = run(arguments);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{arguments:?}: {stderr}");
        assert!(stderr.contains(why), "{arguments:?}: {stderr}");
    }
}

#[test]
fn regions_of_poles_and_costs_take_units_as_other_options_do() {
    let file = fixture();
    let tune = |measure: &str, value: &str| {
        let option = format!("--{measure}");
        let rest = ["tune", &file, "--speed", "11459rpm", "--signal", "composite", "--starts", "1"];
        let mut document = run(&[&rest[..], &["--measure", measure, &option, value, "--json"]].concat()).json();
        document.as_object_mut().expect("an object").remove("seconds");
        document
    };
    // 150 Hz, 18 1/s; 2 um, 480 Hz.
    let region = tune("region", "damping=0.1,decay=18,frequency=150");
    assert_eq!(region, tune("region", "damping=0.1, decay=18 1/s, frequency=0.15kHz"));
    let cost = tune("cost", "force=0.2,noise=2e-6,corner=480");
    assert_eq!(cost, tune("cost", "force=0.2,noise=2um,corner=480Hz"));
    assert_ne!(cost, tune("cost", "force=0.2,noise=3um,corner=480Hz"));
    for (measure, value, words) in [
        ("region", "damping=0.1,frequency=3m", "frequency = 3m: expected a number, alone or in Hz"),
        ("region", "damping=0.1s", "damping = 0.1s: expected a number without a unit"),
        ("cost", "colour=1", "expected force=NUMBER, noise=NUMBER or corner=NUMBER"),
    ] {
        let ran = run(&["tune", &file, "--speed", "4 w0", "--measure", measure, &format!("--{measure}"), value]);
        assert!(ran.code == Some(2) && ran.stderr.contains(words), "{value}: {}", ran.stderr);
    }
    let ran = run(&["tune", "three-mass", "--speed", "4", "--measure", "cost", "--cost", "noise=1um"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("the rotor is not one in SI units"), "{}", ran.stderr);
}

#[test]
fn regress_an_operating_range_may_end_where_all_speeds_do_in_another_unit() {
    let file = fixture();
    for (rpm, hertz) in [("3000rpm", "50Hz"), ("4200rpm", "70Hz"), ("5400rpm", "90Hz"), ("6600rpm", "110Hz")] {
        let (over, operating) = (format!("0..{rpm}"), format!("10..{hertz}"));
        for (over, operating) in [(&over, &operating), (&operating.replace("10..", "0.."), &over.replace("0..", "9.."))]
        {
            let ran = run(&["assess", &file, "--over", over, "--operating", operating, "--json"]);
            assert!(
                !ran.stdout.is_empty() && !ran.stderr.contains("expected a range"),
                "{over} {operating}: {}",
                ran.stderr
            );
        }
    }
}
