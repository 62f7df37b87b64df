//! What a run settles at may be unstable all the same: where neither start nor unbalance excites the mode that grows.

use std::sync::atomic::AtomicBool;

use rotor::{C64, ClosedLoop, Feedback, Mass, Rotor, Signal, Stability, builtin, poles};
use study::disturbance::Means;
use study::force::{ForcePoint, LONGEST, steady, until_settled};
use study::run::{Impulse, Plan, Settle, Settled, run};

fn steady_plan(
    rotor: &Rotor,
    feedback: &Feedback,
    speed: f64,
    clearances: &[f64],
    duration: f64,
    settle: Settle,
) -> Plan {
    Plan::steady(rotor, feedback, speed, clearances, duration, settle).expect("can be stepped")
}

/// Three masses with the control bearing and its sensor at the centre, which the pitch mode leaves at rest.
fn centre_bearing(gains: [f64; 4]) -> (Rotor, Feedback) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    (rotor, Feedback::new(1, vec![Signal::at_mass(1, 3, gains)]))
}

fn balanced(rotor: &Rotor) -> Rotor {
    let masses = rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect();
    Rotor::new("balanced", masses, rotor.shafts().to_vec()).expect("valid")
}

fn point(rotor: &Rotor, feedback: &Feedback, speed: f64, deadband: f64) -> ForcePoint {
    steady(rotor, feedback, speed, &vec![deadband; rotor.len()], &AtomicBool::new(false)).expect("simulated")
}

/// The largest real part of a pole, deadband neglected.
fn growth(rotor: &Rotor, feedback: &Feedback, speed: f64) -> f64 {
    let found = poles(&ClosedLoop::new(rotor, feedback, speed, &[])).expect("poles");
    found.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn val_force_says_that_the_pitch_mode_grows_though_nothing_excites_it() {
    for (gains, speed, rate) in [([1.0, 2.0, 0.0, 0.0], 4.3, 0.0122), ([0.5, 1.5, -0.6, 0.0], 4.5, f64::NAN)] {
        let (rotor, feedback) = centre_bearing(gains);
        let expected = growth(&rotor, &feedback, speed);
        assert!(rate.is_nan() || (expected - rate).abs() < 5e-5, "{expected}");
        let found = point(&rotor, &feedback, speed, 0.0);
        assert_eq!(found.settled, Settled::Steady, "what was found is steady: {found:?}");
        let found_growth = found.stability.expect("a circular orbit");
        assert_eq!((found_growth.stability, found_growth.by), (Stability::Unstable, Means::Eigenvalues));
        assert!((found_growth.growth - expected).abs() < 1e-9, "{} for {expected}", found_growth.growth);
        assert!(
            (found.centre.expect("told").growth - expected).abs() < 1e-9
                && found.centre.expect("told").stability == Stability::Unstable
        );
    }
}

#[test]
fn a_rotor_without_unbalance_rests_and_is_told_to_be_unstable() {
    let (rotor, feedback) = centre_bearing([1.0, 2.0, 0.0, 0.0]);
    let rotor = balanced(&rotor);
    let found = point(&rotor, &feedback, 4.3, 0.0);
    assert_eq!((found.max_force, found.settled), (0.0, Settled::Steady));
    assert_eq!(found.stability.map(|j| j.stability), Some(Stability::Unstable), "{found:?}");
    // And one mass above its threshold, with and without clearance; below it and without, it is stable.
    let jeffcott = balanced(&builtin::rotor("jeffcott").expect("built in"));
    let off = builtin::feedback(&jeffcott, "off").expect("built in");
    for (speed, deadband, stability) in
        [(2.3, 0.0, Stability::Unstable), (2.1, 0.0, Stability::Stable), (2.1, 1.0, Stability::Unstable)]
    {
        let found = point(&jeffcott, &off, speed, deadband);
        assert_eq!(found.stability.map(|j| j.stability), Some(stability), "R = {speed}, g = {deadband}");
        assert_eq!(found.centre.expect("told").stability, stability);
    }
}

#[test]
fn stable_values_are_called_stable() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let composite = builtin::feedback(&rotor, "composite").expect("built in");
    let linear = point(&rotor, &composite, 3.0, 0.0);
    let found_growth = linear.stability.expect("a circular orbit");
    assert_eq!(found_growth.stability, Stability::Stable);
    assert!((found_growth.growth - growth(&rotor, &composite, 3.0)).abs() < 1e-9, "{found_growth:?}");
    // A limit cycle under unbalance beats, and stays.
    let beating = point(&rotor, &composite, 6.0, 1.0);
    assert_eq!(beating.settled, Settled::Beating);
    let found_growth = beating.stability.expect("it has settled");
    assert_eq!((found_growth.stability, found_growth.by), (Stability::Stable, Means::Simulation), "{found_growth:?}");
    assert_eq!(beating.centre.expect("told").stability, Stability::Unstable, "the whirl has grown out of the centre");
}

#[test]
fn a_beating_motion_that_a_hidden_mode_would_leave_is_called_unstable() {
    // Bounce whirls by itself in the clearances and beats with the unbalance; pitch grows faster, but nothing starts it.
    let (rotor, feedback) = centre_bearing([-0.4, 0.3, -0.3, 0.0]);
    let outcome = until_settled(&rotor, &feedback, 4.4, &vec![1.0; rotor.len()], LONGEST, &AtomicBool::new(false))
        .expect("simulated");
    assert_eq!(outcome.settled, Settled::Beating, "{outcome:?}");
    let found_growth = outcome.stability.expect("it has settled");
    assert_eq!((found_growth.stability, found_growth.by), (Stability::Unstable, Means::Simulation), "{found_growth:?}");
    // So it does, when something starts it.
    let plan = Plan {
        impulses: vec![Impulse { mass: 0, change: C64::new(1e-6, 0.0), at: 0.0 }],
        ..steady_plan(&rotor, &feedback, 4.4, &[1.0; 3], 2000.0, Settle::Detect)
    };
    let kicked = run(&plan, &mut [], &AtomicBool::new(false)).expect("simulated");
    assert!(
        kicked.diverged_at.is_some() || (kicked.max_displacement[0] / outcome.max_displacement[0] - 1.0).abs() > 0.01,
        "{kicked:?}"
    );
}

#[test]
fn a_limit_cycle_reached_by_a_blow_is_judged_about_itself_and_its_centre_beside_it() {
    let rotor = balanced(&builtin::rotor("jeffcott").expect("built in"));
    let off = builtin::feedback(&rotor, "off").expect("built in");
    let plan = Plan {
        impulses: vec![Impulse { mass: 0, change: C64::new(1.0, 0.0), at: 0.0 }],
        dtau: 0.02,
        ..steady_plan(&rotor, &off, 1.6, &[1.0], 2000.0, Settle::From(1900.0))
    };
    let outcome = run(&plan, &mut [], &AtomicBool::new(false)).expect("simulated");
    let found_growth = outcome.stability.expect("a limit cycle");
    assert_eq!(
        (found_growth.stability, outcome.centre.expect("told").stability),
        (Stability::Stable, Stability::Unstable),
        "{outcome:?}"
    );
    assert!(found_growth.growth < -1e-3, "the free phase is not a disturbance: {found_growth:?}");
}

#[test]
fn the_step_told_is_the_step_taken() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let off = builtin::feedback(&rotor, "off").expect("built in");
    let mut plan = Plan { dtau: 0.02, ..steady_plan(&rotor, &off, 1.0, &[], 0.001, Settle::From(0.0)) };
    let step = |plan: &Plan| run(plan, &mut [], &AtomicBool::new(false)).expect("simulated").step;
    assert_eq!(step(&plan), (0.001, 0.001));
    assert_eq!(plan.longest_step(), 0.001);
    plan.duration = 0.03;
    assert_eq!(step(&plan), (0.015, 0.015));
    // An impulse parts the run in stretches of other steps.
    plan.impulses = vec![Impulse { mass: 0, change: C64::new(1.0, 0.0), at: 0.005 }];
    let (longest, shortest) = step(&plan);
    assert!((longest - 0.0125).abs() < 1e-15 && (shortest - 0.005).abs() < 1e-15);
    assert_eq!(plan.longest_step(), longest);
}

/// A machine that has lost an axis is stepped as it is, to the end, offline too; of what has no complex form nothing is told.
#[test]
fn regress_a_run_with_an_axis_lost_tells_its_motion() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut feedback = builtin::feedback(&rotor, "individual").expect("built in");
    feedback.bearings[0].parts.amplifier_y = 0.0;
    let settings = rotor::Settings::new(&rotor, 1.0, feedback);
    let plan = Plan {
        program: machine::Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"),
        start: None,
        impulses: vec![],
        dtau: 0.01,
        duration: 50.0,
        settle: Settle::From(0.0),
    };
    let found = run(&plan, &mut [], &AtomicBool::new(false)).expect("a run");
    assert!(found.centre.is_none() && found.max_displacement[0] > 0.0, "{found:?}");
}
