//! What standards ask, against exact values of small rotors and printed ones of the report's.

use std::f64::consts::{PI, TAU};

use rotor::{PhysicalMass, Rotor, Settings, builtin};
use study::assess::{Asked, Assessment, AssessmentCase, Finding, Limits, assess};

fn settings(rotor: &Rotor, feedback: &str) -> Settings {
    Settings::new(rotor, 0.0, builtin::feedback(rotor, feedback).expect("built in"))
}

fn question<'a>(rotor: &'a Rotor, settings: &'a Settings, over: [f64; 2], limits: &'a Limits) -> AssessmentCase<'a> {
    AssessmentCase {
        rotor,
        settings,
        over,
        operating: over,
        cross_at: rotor.len() / 2,
        cross_stiffness: None,
        modes: machine::CountedModes::ALL,
        grade: None,
        clearance: None,
        force: None,
        limits,
    }
}

fn found<'a>(assessment: &'a Assessment, what: &str) -> &'a Finding {
    let line = assessment.lines.iter().find(|line| line.what.starts_with(what));
    line.unwrap_or_else(|| panic!("no line '{what}' among {:?}", assessment.lines))
}

#[test]
fn val_decrement_and_cross_coupling_of_one_mass_are_exact() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let (off, limits) = (settings(&rotor, "off"), Limits::default());
    let answer =
        assess(&AssessmentCase { cross_stiffness: Some(0.4), ..question(&rotor, &off, [0.0, 0.78], &limits) }).unwrap();
    // The report's minimum damping at R = 0.78.
    let zeta = 0.322_721_f64;
    let line = found(&answer, "log decrement, forward");
    assert!((line.found.unwrap() - TAU * zeta / (1.0 - zeta * zeta).sqrt()).abs() < 2e-5, "{line:?}");
    assert!((line.place.speed.unwrap() - 0.78).abs() < 1e-9 && line.passed == Some(true));
    // Added stiffness Q adds to zeta R: the threshold R0 = 2.209975 leaves 0.5 (R0 - R).
    let borne = 0.5 * (2.209_975 - 0.78);
    assert!((answer.cross_coupling.borne.unwrap() - borne).abs() < 1e-6, "{:?}", answer.cross_coupling.borne);
    let ratio = found(&answer, "cross-coupled stiffness borne / expected");
    assert!((ratio.found.unwrap() - borne / 0.4).abs() < 1e-5 && ratio.passed == Some(false), "{ratio:?}");
    // The curve falls to zero there.
    let [before, after] = [0.99, 1.01].map(|share| {
        let nearest = answer
            .cross_coupling
            .curve
            .iter()
            .min_by(|a, b| (a.0 - share * borne).abs().total_cmp(&(b.0 - share * borne).abs()));
        nearest.unwrap().1
    });
    assert!(before > -0.05 && after < 0.05 && before > after, "{before} {after}");
}

#[test]
fn val_the_zones_of_the_reports_two_gain_sets_are_a_and_d() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let limits = Limits::default();
    for (feedback, peak, zone, passed) in
        [("individual", 1.19172, "zone A", true), ("composite", 10.3495, "zone D", false)]
    {
        let set = settings(&rotor, feedback);
        // Near rest the composite gains are worse still.
        let answer = assess(&question(&rotor, &set, [5.0, 6.0], &limits)).unwrap();
        let line = found(&answer, "sensitivity");
        assert!((line.found.unwrap() / peak - 1.0).abs() < 1e-5, "{line:?}");
        assert_eq!((line.note.as_deref(), line.passed), (Some(zone), Some(passed)));
    }
}

#[test]
fn an_unstable_machine_fails_and_a_sampled_one_is_told_what_it_cannot_be_asked() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let limits = Limits::default();
    let off = settings(&rotor, "off");
    let answer = assess(&question(&rotor, &off, [0.0, 6.0], &limits)).unwrap();
    assert!(!answer.passed() && answer.cross_coupling.borne.is_none());
    assert_eq!(found(&answer, "sensitivity").passed, Some(false));
    let mut sampled = settings(&rotor, "individual");
    sampled.feedback.bearings[0].parts.sample = 0.02;
    let answer = assess(&question(&rotor, &sampled, [0.0, 6.0], &limits)).unwrap();
    for what in ["critical speed", "vibration", "orbit", "dynamic force"] {
        let line = found(&answer, what);
        assert!(
            line.found.is_none() && line.passed.is_none() && line.note.as_deref().unwrap().contains("sampled"),
            "{line:?}"
        );
    }
    assert!(found(&answer, "log decrement").found.is_some() && found(&answer, "sensitivity").found.is_some());
}

/// 40 kg on 3.6e6 N/m with 4000 N s/m, 20 um of unbalance and a clearance of 100 um: `w0` is 300 rad/s.
fn rig() -> Rotor {
    let mass = PhysicalMass {
        mass: 40.0,
        bearing_stiffness: 3.6e6,
        damping: 4000.0,
        unbalance: 20e-6,
        deadband: 0.0,
        ..PhysicalMass::default()
    };
    Rotor::from_si("rig", vec![mass], vec![], None).expect("valid")
}

/// `|p|` per eccentricity at the speed `w` in rad/s: `m w^2 / |k - m w^2 + j (c w - C w / 2)|`, the seal's cross-coupled stiffness
/// being `C w / 2` (3.1).
fn response(w: f64) -> f64 {
    let (m, k, c) = (40.0, 3.6e6, 4000.0);
    m * w * w / ((k - m * w * w).powi(2) + (c * w - 0.5 * c * w).powi(2)).sqrt()
}

#[test]
fn val_unbalance_of_a_grade_and_of_the_residual_are_the_exact_response() {
    let rotor = rig();
    let limits = Limits::default();
    let off = settings(&rotor, "off");
    let scales = *rotor.scales().expect("in SI units");
    let over = [scales.speed(500.0), scales.speed(6000.0)];
    let asked = AssessmentCase {
        grade: Some("G2.5".parse().unwrap()),
        clearance: Some(scales.length(100e-6)),
        ..question(&rotor, &off, over, &limits)
    };
    let answer = assess(&asked).unwrap();
    let largest =
        (0..200_001).map(|k| response((500.0 + f64::from(k) * 5500.0 / 200_000.0) * PI / 30.0)).fold(0.0, f64::max);
    let line = found(&answer, "orbit of a rotor balanced to G2.5");
    let exact = 2.5e-3 / (6000.0 * PI / 30.0) * largest;
    assert!((scales.metres(line.found.unwrap()) / exact - 1.0).abs() < 1e-8, "{line:?} {exact}");
    // 2 U_r = 2 * 6350 W / N g mm: an eccentricity of 2.1167 um; at 6000 rpm 25.4 um peak to peak are allowed.
    let line = found(&answer, "vibration under 2 U_r");
    let exact = 2.0 * 2.0 * 6350.0e-6 / 6000.0 * largest;
    assert!((scales.metres(line.found.unwrap()) / exact - 1.0).abs() < 1e-8, "{line:?} {exact}");
    let Some(Asked::AtMost(most)) = line.asked else { panic!("{line:?}") };
    assert!((scales.metres(most) - 25.4e-6).abs() < 1e-18, "{line:?}");
    // Scaled to 25.4 um, in parts of twice 100 um of clearance.
    let line = found(&answer, "scaled major axis / clearance");
    assert!((line.found.unwrap() - 100.0 * 25.4 / 200.0).abs() < 1e-6 || line.found.unwrap() < 12.7, "{line:?}");
    // Half-power points of the same curve.
    let height = |rpm: f64| response(rpm * PI / 30.0);
    let grid: Vec<f64> = (0..600_001).map(|k| 500.0 + f64::from(k) * 0.02).collect();
    let top = grid.iter().copied().max_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap();
    let level = height(top) * std::f64::consts::FRAC_1_SQRT_2;
    let low = grid.iter().copied().find(|rpm| height(*rpm) >= level).unwrap();
    let high = grid.iter().copied().filter(|rpm| *rpm > top).find(|rpm| height(*rpm) <= level).unwrap();
    let line = found(&answer, "critical speed");
    assert!((scales.rpm(line.place.speed.unwrap()) / top - 1.0).abs() < 1e-4, "{line:?} {top}");
    assert!(
        line.note.as_deref().unwrap().starts_with(&format!("amplification {:.1}", top / (high - low))),
        "{line:?} {}",
        top / (high - low)
    );
}

#[test]
fn no_angles_between_the_unbalances_are_worse_than_those_that_were_found() {
    let mass = |mass: f64, damping: f64, unbalance: f64| PhysicalMass {
        mass,
        damping,
        unbalance,
        bearing_stiffness: 2e6,
        ..PhysicalMass::default()
    };
    let limits = Limits::default();
    let made = |signs: [f64; 3]| {
        let [a, b, c] = signs.map(|sign| sign * 2.5e-3 / (3000.0 * PI / 30.0));
        let masses = vec![mass(10.0, 900.0, a), mass(20.0, 100.0, b), mass(8.0, 700.0, c)];
        Rotor::from_si("rig", masses, vec![3e6, 2e6], Some(1e-6)).expect("valid")
    };
    let rotor = made([1.0, 1.0, 1.0]);
    let off = settings(&rotor, "off");
    let over = [0.1, rotor.scales().expect("in SI units").speed(3000.0)];
    let asked = AssessmentCase { grade: Some("G2.5".parse().unwrap()), ..question(&rotor, &off, over, &limits) };
    let worst = found(&assess(&asked).unwrap(), "orbit of a rotor").found.unwrap();
    let mut nearest = 0.0_f64;
    for signs in [[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]] {
        let rotor = made(signs);
        let response = machine::unbalance_response(&rotor, &settings(&rotor, "off"), over).unwrap().unwrap();
        let largest = response.points.iter().flat_map(|p| p.stations.iter().map(|z| z.norm())).fold(0.0, f64::max);
        assert!(largest <= worst * (1.0 + 1e-9), "{signs:?}: {largest} {worst}");
        nearest = nearest.max(largest);
    }
    assert!(nearest > 0.5 * worst, "{nearest} {worst}");
}

#[test]
fn val_a_resonance_between_two_speeds_is_not_missed() {
    // Seal damping zeta brings zeta R of cross-coupled stiffness: at R = 1 the radius is 1 / zeta.
    let mass =
        rotor::Mass { mass: 1.0, damping: 0.002, bearing_stiffness: 1.0, unbalance: 1.0, ..rotor::Mass::default() };
    let rotor = Rotor::new("light", vec![mass], vec![]).expect("valid");
    let (off, limits) = (settings(&rotor, "off"), Limits::default());
    let asked = AssessmentCase { clearance: Some(700.0), ..question(&rotor, &off, [0.0, 1.9], &limits) };
    let answer = assess(&asked).unwrap();
    let line = found(&answer, "orbit / clearance");
    assert!((line.found.unwrap() - 500.0 / 700.0).abs() < 1e-3, "{line:?}");
    assert_eq!((line.note.as_deref(), line.passed), (Some("zone D"), Some(false)));
}

#[test]
fn a_machine_that_asks_for_more_than_its_limit_fails() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut limited = settings(&rotor, "individual");
    limited.feedback.bearings[0].parts.limit = 20.0;
    limited.deadband.fill(1.0);
    let limits = Limits::default();
    let answer = assess(&question(&rotor, &limited, [4.0, 5.0], &limits)).unwrap();
    for what in ["orbit / clearance", "dynamic force"] {
        let line = found(&answer, what);
        assert_eq!(line.passed, Some(false), "{line:?}");
        assert!(line.note.as_deref().unwrap().contains("within the limit of the force"), "{line:?}");
    }
    assert!(!answer.passed());
}

/// 30 kg and 10 kg with a control bearing each, the lighter one first.
#[test]
fn every_control_bearing_has_a_line_of_its_own_limit() {
    let mass = |mass, unbalance| PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance, ..PhysicalMass::default() };
    let rotor = Rotor::from_si("two", vec![mass(30.0, 9e-6), mass(10.0, 1e-6)], vec![4e6], None).expect("valid");
    let bearing = |name: &str, station, limit| {
        let signal = rotor::Signal::at_mass(station, 2, [0.5, 1.0, 0.0, 0.0]);
        let mut bearing = rotor::ControlBearing::new(station, vec![signal]);
        (bearing.name, bearing.parts.limit) = (Some(name.to_owned()), limit);
        bearing
    };
    let speeds = [0.1, 0.8];
    let free =
        rotor::Feedback { bearings: vec![bearing("light", 1, f64::INFINITY), bearing("heavy", 0, f64::INFINITY)] };
    let found_at = rotor::circular::synchronous(&rotor, &free, &[0.0; 2], &[0.8]).expect("solved");
    let [light, heavy] = found_at.orbits[0][0].forces[..] else { panic!("two") };
    // Enough for the one, not for the other.
    let bearings = vec![bearing("light", 1, 2.0 * light), bearing("heavy", 0, 0.999 * heavy)];
    let settings = Settings::new(&rotor, 0.0, rotor::Feedback { bearings });
    let limits = Limits::default();
    let answer = assess(&question(&rotor, &settings, speeds, &limits)).expect("assessed");
    let of = |name: &str| found(&answer, &format!("dynamic force, {name}"));
    let near = |found: Option<f64>, expected: f64, within: f64| (found.expect("found") / expected - 1.0).abs() < within;
    assert_eq!((of("light").passed, of("light").asked), (Some(false), Some(Asked::AtMost(2.0 * light))), "{answer:?}");
    // Told as that of the first, on a third of the mass; what the heavy one cannot do is no orbit.
    assert!(matches!(of("heavy").asked, Some(Asked::AtMost(most)) if near(Some(most), 3.0 * 0.999 * heavy, 1e-12)));
    assert!(near(of("heavy").found, 3.0 * 0.999 * heavy, 0.05), "{:?}", of("heavy"));
    assert!(near(of("light").found, light, 0.05) && of("light").place.station == Some(1), "{:?}", of("light"));
}

/// A shaft with two discs on bearings, with cross-coupled stiffness from a seal at station 2.
fn shaft(cross: f64) -> Rotor {
    let text = format!(
        "units = 'si'\nreference_length = 1e-5\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n{}\
         [[disc]]\nstation = 2\nmass = 32.6\npolar_inertia = 0.356\ndiametral_inertia = 0.178\n\
         [[disc]]\nstation = 3\nmass = 35.8\npolar_inertia = 0.405\ndiametral_inertia = 0.203\n\
         [[bearing]]\nstation = 1\nstiffness = 1e7\ndamping = 8000.0\n[[bearing]]\nstation = 4\nstiffness = 1e7\ndamping = 8000.0\n\
         [[sensor]]\nname = 'seal'\nstation = 2\n[[seal]]\nstation = 2\ncross_stiffness = {cross:?}\n",
        "[[section]]\nlength = 0.25\nouter = 0.05\nelements = 2\n".repeat(3)
    );
    rotor::file::read_rotor(&text, "shaft").expect("a rotor")
}

/// Of shaft elements a force at a place moves all of them: what is added there by `assess` is what a seal there has.
#[test]
fn val_cross_coupling_of_shaft_elements_is_that_of_a_seal_in_their_place() {
    let rotor = shaft(0.0);
    let scales = rotor.scales().expect("SI");
    let settings = Settings::new(&rotor, 0.0, rotor.beam().expect("elements").no_feedback());
    let at = rotor.beam().and_then(|beam| beam.coordinate(1)).expect("a place");
    let limits = Limits::default();
    let over = [0.0, scales.speed(4000.0)];
    let asked = AssessmentCase { cross_at: at, ..question(&rotor, &settings, over, &limits) };
    let answer = assess(&asked).expect("assessed");
    let borne = answer.cross_coupling.borne.expect("some") * scales.k_t;
    let least = |cross: f64| {
        let rotor = shaft(cross);
        let settings = Settings::new(&rotor, over[1], rotor.beam().expect("elements").no_feedback());
        machine::min_damping(&rotor, &settings, over[1]).expect("found")
    };
    let [before, after] = [0.999, 1.001].map(|part| least(part * borne));
    assert!(before > 0.0 && after < 0.0, "{before} and {after} at {borne} N/m");
}

#[test]
fn modes_that_do_not_count_are_summed_up_and_nothing_is_asked_of_them() {
    let rotor = shaft(0.0);
    let scales = rotor.scales().expect("SI");
    let settings = Settings::new(&rotor, 0.0, rotor.beam().expect("elements").no_feedback());
    let limits = Limits::default();
    let over = [0.0, scales.speed(4000.0)];
    let modes = machine::CountedModes::usual(&rotor, &settings, over[1]).expect("found");
    let lines = |modes| {
        let asked = AssessmentCase { modes, ..question(&rotor, &settings, over, &limits) };
        let lines = assess(&asked).expect("assessed").lines;
        lines.into_iter().filter(|line| line.what.starts_with("log decrement")).collect::<Vec<_>>()
    };
    let all = lines(machine::CountedModes::ALL);
    let some = lines(modes);
    let below = modes.below().expect("of shaft elements");
    let judged = |lines: &[Finding]| lines.iter().filter(|line| line.passed.is_some()).count();
    assert!(judged(&some) < judged(&all), "{some:?}");
    for line in some.iter().filter(|line| line.passed.is_some()) {
        assert!(line.place.frequency.expect("it whirls").abs() <= below, "{line:?}");
    }
    let rest = some.iter().find(|line| line.what.contains("faster than what counts")).expect("told");
    assert!(rest.asked.is_none() && rest.place.frequency.expect("it whirls").abs() > below, "{rest:?}");
}
