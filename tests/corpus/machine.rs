//! Rotor and feedback files: what is accepted goes on through settings, poles, a short run and thresholds.

use std::sync::atomic::AtomicBool;

use machine::{MachinePoles, Program};
use proptest::prelude::*;
use rotor::file::{read_feedback, read_rotor, write_feedback, write_rotor};
use rotor::{Feedback, Rotor, Settings, builtin};
use study::run::{Plan, Settle};
use text::Faults;

use crate::{harness, made_up, mutation};

/// Texts of each kind: some seconds of an unoptimised build.
const CASES: u32 = 256;

/// Masses up to which thresholds are searched too.
const FEW: usize = 4;

/// What every complaint has: a place in the file, what was found, and what was expected, fit for a terminal.
pub(crate) fn complains(text: &str, faults: &Faults) {
    assert!(!faults.list().is_empty());
    for fault in faults.list() {
        let lines = text.split('\n').count();
        assert!((1..=lines).contains(&fault.line) && fault.column >= 1, "{fault:?} of {lines} lines");
        assert!(!fault.expected.is_empty(), "{fault:?}");
        assert!(!fault.to_string().chars().any(char::is_control), "{fault:?}");
    }
    let drawn = faults.drawn("file", text);
    assert!(drawn.chars().all(|c| c == '\n' || !c.is_control()), "{drawn:?}");
}

/// All that is done with a machine, at some speeds.
fn goes_through(rotor: &Rotor, feedback: &Feedback) {
    for speed in [0.0, 2.5] {
        let settings = Settings::new(rotor, speed, feedback.clone());
        // A refusal in words is an answer; a schedule may leave the range of gains at some speed.
        if settings.check(rotor).is_err() {
            continue;
        }
        // Poles that cannot be had are refused in words too.
        if let Ok(spectrum) = MachinePoles::of(rotor, &settings).map(MachinePoles::into_modes) {
            assert!(!feedback.is_ideal() || spectrum.modes.len() == 2 * rotor.len());
            for mode in &spectrum.modes {
                assert!(mode.pole.re.is_finite() && mode.pole.im.is_finite(), "pole {:?}", mode.pole);
                assert!((-1.0..=1.0).contains(&mode.damping()), "damping {}", mode.damping());
                let is_whole = mode.shape.iter().all(|part| part.re.is_finite() && part.im.is_finite());
                assert!(is_whole, "shape {:?} of {:?}", mode.shape, mode.pole);
            }
            assert!(spectrum.modes.is_empty() || !spectrum.min_damping().is_nan());
        }
        let Ok(program) = Program::in_substeps(rotor, &settings, 1e-3, 1) else { continue };
        let plan =
            Plan { program, start: None, impulses: Vec::new(), dtau: 1e-3, duration: 0.1, settle: Settle::From(0.0) };
        // What leaves the range of numbers is refused in words here too.
        let Ok(outcome) = study::run::run(&plan, &mut [], &AtomicBool::new(false)) else { continue };
        let numbers = [outcome.maxima_from, outcome.max_force, outcome.max_force_component];
        for number in numbers.iter().chain(&outcome.max_displacement).chain(&outcome.mean_radius) {
            assert!(number.is_finite(), "{outcome:?}");
        }
        assert!(outcome.diverged_at.is_none_or(f64::is_finite));
    }
    // The search costs the third power of the masses: of long chains the poles will do.
    if rotor.len() <= FEW
        && let Ok(found) = rotor::thresholds(rotor, feedback, 0.0, 3.0)
    {
        for threshold in found {
            assert!((0.0..=3.0).contains(&threshold.speed) && threshold.frequency.is_finite(), "{threshold:?}");
        }
    }
}

fn rotor_file(text: &str) {
    match read_rotor(text, "made-up") {
        Err(faults) => complains(text, &faults),
        Ok(rotor) => {
            let written = write_rotor(&rotor);
            assert_eq!(read_rotor(&written, "made-up").as_ref(), Ok(&rotor), "it reads back as it was:\n{written}");
            let off = builtin::feedback(&rotor, "off").expect("any rotor can be left alone");
            goes_through(&rotor, &off);
        }
    }
}

fn feedback_file(text: &str) {
    if let Err(faults) = read_feedback(text, None) {
        complains(text, &faults);
    }
    let rotor = builtin::rotor("three-mass").unwrap();
    match read_feedback(text, Some(rotor.len())) {
        Err(faults) => complains(text, &faults),
        Ok(feedback) => {
            let written = write_feedback(&feedback);
            assert_eq!(read_feedback(&written, Some(rotor.len())).as_ref(), Ok(&feedback), "it reads back:\n{written}");
            goes_through(&rotor, &feedback);
        }
    }
}

#[test]
fn no_rotor_file_is_stumbled_over() {
    let rotors = builtin::ROTORS.iter().filter_map(|name| builtin::rotor(name));
    let si = "units = \"si\"\nreference_length = 1e-5\n\
              [[mass]]\nmass = 40\nbearing_stiffness = 3.6e6\ndamping = 200.0\nunbalance = 20e-6\ndeadband = 1e-5\n\
              [[mass]]\nmass = 10\nseal_stiffness = 1e5\n[[shaft]]\nstiffness = 1e6\n";
    let seeds = rotors.map(|rotor| write_rotor(&rotor)).chain([si.to_owned()]).collect();
    harness::run("rotor", CASES, &mutation::mutated(seeds), rotor_file);
}

#[test]
fn no_rotor_that_is_made_up_is_stumbled_over() {
    harness::run("rotor made up", CASES, &made_up::rotor(), rotor_file);
}

#[test]
fn no_feedback_file_is_stumbled_over() {
    let rotor = builtin::rotor("three-mass").unwrap();
    let built_in = builtin::feedback_names(&rotor).iter().filter_map(|name| builtin::feedback(&rotor, name));
    let scheduled = "bearing = 1\n[[signal]]\nmass = 2\nkd = { at_zero = 0.0, slope = -0.5 }\n\
                     cc = { speed = [0, 2, 7], value = [0.1, 0.3, 0.2] }\n[[signal]]\ndisplacement = [1, 0.5, 0]\n\
                     velocity = [0, 1, 0]\ncd = -0.3\n";
    let seeds = built_in.map(|feedback| write_feedback(&feedback)).chain([scheduled.to_owned()]).collect();
    harness::run("feedback", CASES, &mutation::mutated(seeds), feedback_file);
}

#[test]
fn no_feedback_that_is_made_up_is_stumbled_over() {
    harness::run("feedback made up", CASES, &made_up::feedback(), feedback_file);
}

/// Files that fell: values that are finite and too far apart for poles or their shapes to be.
#[test]
fn files_that_fell_are_told_or_gone_through() {
    let weights = |weight: &str| {
        format!(
            "bearing = 1\n[[signal]]\ndisplacement = [{weight}, 1.0, 0.0]\nvelocity = [1.0, 1.0, 0.0]\nkd = -0.5\nkc = 0.5\n"
        )
    };
    for weight in ["1.7976931348623157e308", "1e232", "-1e7", "1e6"] {
        feedback_file(&weights(weight));
    }
    let told = read_feedback(&weights("1e232"), Some(3)).unwrap_err().to_string();
    assert!(told.starts_with("3:17: displacement weight 1e232: expected a weight from -1000000 to 1000000"), "{told}");
    feedback_file("bearing = 1\n[[signal]]\nmass = 1\nkd = { at_zero = 1e300, slope = -1e300 }\n");
    let masses = ["", "cross_damping = 1e186\n", "damping = 1e300\n", "bearing_stiffness = 1e-300\n"];
    let masses: String = masses.iter().map(|line| format!("[[mass]]\nmass = 1.0\n{line}")).collect();
    rotor_file(&(masses + &"[[shaft]]\nstiffness = 0.0\n".repeat(3)));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is typed for a range or a row of keys is read or refused, and a range that is read has two ends in order.
    #[test]
    fn nothing_that_is_typed_is_stumbled_over(typed in "[-0-9.e+ infa=,]{0,16}|\\PC{0,12}") {
        if let Ok([from, to]) = rotor::typed::range(&typed) {
            prop_assert!(from < to && from.is_finite() && to.is_finite());
            prop_assert!(!typed.contains("..."));
        }
        if let Ok(pairs) = rotor::typed::pairs(typed.split(',')) {
            prop_assert!((1..pairs.len()).all(|i| pairs[..i].iter().all(|(key, _)| *key != pairs[i].0)));
        }
    }
}
