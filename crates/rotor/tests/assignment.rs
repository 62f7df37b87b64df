//! Assigned poles are achieved; what cannot be assigned is named.

mod common;

use common::machine;
use proptest::prelude::*;
use rotor::{
    AssignError, C64, ClosedLoop, Mass, Modes, PBH_LIMIT, Rotor, Whirl, assign_poles, builtin, cancelling, influence,
    poles,
};

fn wanted(n: usize) -> impl Strategy<Value = Vec<C64>> {
    // One for each slot of a ladder, so that no two of them coincide and the answer is well conditioned.
    prop::collection::vec((-0.8..-0.1, 0.1..0.9), 2 * n).prop_map(move |parts| {
        let rung = |i: usize| if i.is_multiple_of(2) { (i / 2) as f64 } else { -((i / 2 + 1) as f64) };
        parts
            .into_iter()
            .enumerate()
            .map(|(i, (re, im)): (usize, (f64, f64))| C64::new(re, 0.8 * (rung(i) + im)))
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn assigned_poles_are_achieved(((rotor, feedback), wanted) in machine(4).prop_flat_map(|m| {
        let n = m.0.len();
        (Just(m), wanted(n))
    }), speed in 0.0..6.0) {
        let off = feedback.off();
        let table = influence(&ClosedLoop::new(&rotor, &off, speed, &[])).expect("converges");
        // Barely controllable modes take gains so large that rounding moves the poles: not the law that is tested here.
        prop_assume!(table.iter().all(|mode| mode.pbh[feedback.bearings[0].station] > 1e-4));
        let made = assign_poles(&rotor, speed, feedback.bearings[0].station, &wanted).expect("controllable");
        prop_assert!(made.error() < 1e-6, "off by {:e}", made.error());
        made.feedback.check(rotor.len()).expect("fits");
        // Seen from outside: the rotor with this feedback has these poles.
        let achieved = poles(&ClosedLoop::new(&rotor, &made.feedback, speed, &[])).expect("converges");
        for pole in wanted {
            let distance = achieved.iter().map(|a| (a - pole).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance < 2e-6, "{pole} is not among {achieved:?}");
        }
    }

    /// The three measures agree on what a bearing reaches: a distinct mode is stuck if its left vector has a node there.
    #[test]
    fn measures_agree((rotor, feedback) in machine(4), speed in 0.0..6.0) {
        for mode in influence(&ClosedLoop::new(&rotor, &feedback.off(), speed, &[])).expect("converges") {
            for mass in 0..rotor.len() {
                prop_assert!((0.0..=1.0 + 1e-12).contains(&mode.controllability[mass]));
                prop_assert!((0.0..=1.0 + 1e-12).contains(&mode.observability[mass]));
                // |y b| / |y| bounds the least singular value of [A - lambda I, b] from above.
                let norm = ClosedLoop::new(&rotor, &feedback.off(), speed, &[]).state_matrix().norm();
                // It is found by iteration, slow where the next one is near: a hundredth is allowed for that.
                prop_assert!(mode.pbh[mass] * norm <= mode.controllability[mass] * 1.01 + 1e-9);
            }
        }
    }

    /// (3.40)-(3.44): the poles stay at those of the reference speed.
    #[test]
    fn the_cancelling_law_holds_the_poles_of_its_reference(reference in 0.0..3.0, speed in 0.0..20.0) {
        let rotor = builtin::rotor("jeffcott").expect("built in");
        let off = builtin::feedback(&rotor, "off").expect("built in");
        let law = cancelling(&rotor, reference).expect("one mass");
        let held = poles(&ClosedLoop::new(&rotor, &law, speed, &[])).expect("converges");
        let there = poles(&ClosedLoop::new(&rotor, &off, reference, &[])).expect("converges");
        for pole in held {
            let distance = there.iter().map(|t| (t - pole).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance < 1e-12, "{pole} is not among {there:?}");
        }
    }
}

#[test]
fn val_the_pitch_mode_is_out_of_reach_of_the_centre_bearing() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let off = builtin::feedback(&rotor, "off").expect("built in");
    let closed_loop = ClosedLoop::new(&rotor, &off, 4.101_25, &[]);
    let table = influence(&closed_loop).expect("converges");
    let stuck: Vec<C64> = table.iter().filter(|m| m.pbh[1] < PBH_LIMIT).map(|m| m.pole).collect();
    assert_eq!(stuck.len(), 2, "the pitch mode, forward and backward: {stuck:?}");
    assert!((stuck[0] - C64::new(0.0, 2.050_625)).norm() < 1e-5);
    assert!(table.iter().all(|m| m.pbh[0] > 1e-3 && m.pbh[2] > 1e-3));
    let wanted: Vec<C64> = Modes::of(&closed_loop).expect("converges").modes.iter().map(|m| m.pole - 0.3).collect();
    let error = assign_poles(&rotor, 4.101_25, 1, &wanted).expect_err("not controllable");
    assert!(matches!(error, AssignError::NotControllable { bearing: 2, whirl: Whirl::Forward, .. }), "{error}");
    assert!(error.to_string().contains("(1.000, 0.000, -1.000)"), "{error}");
    let made = assign_poles(&rotor, 4.101_25, 0, &wanted).expect("an end bearing reaches all");
    assert!(made.error() < 1e-12, "off by {:e}", made.error());
}

#[test]
fn all_poles_of_sixteen_masses_can_be_assigned() {
    let masses = (0..16)
        .map(|i| Mass { mass: 0.2 + 0.1 * f64::from(i % 3), damping: 0.2, bearing_stiffness: 0.5, ..Mass::default() })
        .collect();
    let rotor = Rotor::new("long", masses, vec![0.5; 15]).expect("valid");
    let off = builtin::feedback(&rotor, "off").expect("fits any");
    let present = poles(&ClosedLoop::new(&rotor, &off, 3.0, &[])).expect("converges");
    let wanted: Vec<C64> = present.iter().map(|p| C64::new(-0.1 - p.re.abs(), p.im)).collect();
    let made = assign_poles(&rotor, 3.0, 0, &wanted).expect("controllable");
    assert!(made.error() < 1e-6, "off by {:e}", made.error());
}

#[test]
fn several_poles_in_one_place_are_achieved_to_the_root_of_rounding() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let made = assign_poles(&rotor, 3.0, 0, &[C64::new(-0.5, 1.0); 2]).expect("controllable");
    assert!(made.error() < 1e-6, "off by {:e}", made.error());
    // n = 1: the law is s^2 + 2 (zeta - j zeta_q) s + ... by hand, u = -(f1 p + f2 p').
    let gain = |k: usize| made.feedback.bearings[0].signals[0].gains[k].at(3.0);
    assert!((gain(0) - -1.75).abs() < 1e-9 && (gain(1) - 0.0).abs() < 1e-9, "{:?}", made.feedback);
}

#[test]
fn what_does_not_fit_is_named() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let told = |bearing, poles: &[C64]| assign_poles(&rotor, 1.0, bearing, poles).expect_err("refused").to_string();
    let pole = C64::new(-1.0, 0.0);
    assert_eq!(told(0, &[pole]), "a rotor of 1 masses has 2 poles to assign, found 1");
    assert_eq!(told(1, &[pole, pole]), "bearing at mass 2, but the rotor has masses 1 to 1");
    assert_eq!(told(0, &[pole, C64::new(f64::NAN, 0.0)]), "pole 2 is not finite");
    assert!(cancelling(&builtin::rotor("three-mass").expect("built in"), 0.0).is_none());
}

#[test]
fn poles_that_are_missed_are_refused_in_words() {
    let light = Mass { mass: 1e-5, damping: 0.2, bearing_stiffness: 0.5, ..Mass::default() };
    let rotor = Rotor::new("light", vec![light; 3], vec![0.5; 2]).expect("valid");
    let wanted: Vec<C64> = (0..6).map(|k| C64::new(-0.5, f64::from(k) - 2.5)).collect();
    let error = assign_poles(&rotor, 1.0, 0, &wanted).expect_err("rounding decides where such a loop has its poles");
    assert!(matches!(error, AssignError::Missed { off, .. } if off > 0.1), "{error}");
    assert!(error.to_string().contains("cannot be placed"), "{error}");
}
