//! Loops with delay are told as they are, families of any size end when asked to, and what is marginal is no success.

use std::sync::atomic::{AtomicBool, Ordering};

use rotor::{Feedback, Mass, Rotor, builtin};
use tuner::{
    Family, FamilyAxis, FamilyQuantity, Measure, Options, Price, Problem, Schedule, Stop, Structure, Tuned, evaluate,
    pareto, tune,
};

fn problem(rotor: &Rotor, [from, to]: [f64; 2], delay: f64) -> Problem {
    let mut family = Family::new(rotor, from, to).expect("a range");
    if delay > 0.0 {
        family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from: delay, to: delay }).expect("a delay");
    }
    let sensors: &[usize] = if rotor.len() == 1 { &[0] } else { &[0, 1] };
    let template: Feedback = Structure::composite(rotor.len(), 0, sensors);
    Problem::new(family, Structure::new(rotor, &template, Schedule::Fixed).expect("fits"), 100.0)
}

fn evaluated(problem: &Problem, gains: &[f64]) -> Tuned {
    evaluate(problem, &Options::for_problem(problem), gains, Stop::NEVER).expect("makes sense")
}

/// What `tune three-mass --over 0..6 --delay 5` once found and called damped by 0.999999. SciPy has 0.178320 + 2.000303 j.
#[test]
fn val_a_long_delay_hides_no_mode() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let gains =
        [0.442_827_951_028_133_55, 0.841_506_631_057_064_5, 0.031_695_913_115_900_94, 0.047_239_476_878_905_035];
    let found = evaluated(&problem(&rotor, [6.0, 6.0], 5.0), &gains);
    let worst = &found.worst;
    assert_eq!(worst.stable(), Some(false), "{worst:?}");
    assert!((worst.count_right_of.expect("a line") + 0.4).abs() < 0.01, "{worst:?}");
    let there = found.active.iter().map(|mode| mode.pole).chain([worst.pole]);
    let damping = |re: f64, im: f64| -re / f64::hypot(re, im);
    // The less damped ratio of the two that grow is the other one, SciPy's 0.156388 + 0.851272 j.
    assert!((worst.value - damping(0.156_387_771_1, 0.851_271_940_1)).abs() < 1e-8, "{worst:?}");
    assert!(there.into_iter().all(|pole| pole.re > 0.15), "{found:?}");
}

/// Every shaft at 50: what was called damped by 0.87 grows beyond `pi / delay`.
#[test]
fn modes_beyond_pi_over_the_delay_are_judged() {
    let soft = builtin::rotor("three-mass").expect("built in");
    let rotor = Rotor::new("stiff", soft.masses().to_vec(), vec![50.0, 50.0]).expect("a rotor");
    // Of the case "stiff shafts" of tests/reference/delay.json.
    let found = evaluated(&problem(&rotor, [3.0, 3.0], 0.25), &[9.0, 6.0, -3.0, 2.0]);
    assert_eq!(found.worst.stable(), Some(false));
    assert!(found.worst.pole.norm() > std::f64::consts::PI / 0.25, "{:?}", found.worst);
}

#[test]
fn val_damping_with_a_short_delay_is_that_of_the_table() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (speed, damping) in [(2.5, 0.054_314_4), (6.0, 0.009_767_58)] {
        let found = evaluated(&problem(&rotor, [speed, speed], 0.02), &[-0.5879, 0.4948, -0.4847, 0.6483]);
        assert!((found.worst.value - damping).abs() < 5e-8, "{:?}", found.worst);
        assert_eq!(found.worst.count_right_of, Some(-100.0));
    }
}

/// A delay for which there are too many poles to count is no ground for an answer.
#[test]
fn what_cannot_be_counted_is_not_known() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let found = evaluated(&problem(&rotor, [6.0, 6.0], 1e9), &[-0.5879, 0.4948, -0.4847, 0.6483]);
    assert!(!found.worst.is_known() && found.worst.stable() != Some(true), "{:?}", found.worst);
}

/// Masses 0.5 on a shaft 0.5 with nothing to hold them but this.
fn loose(damping: [f64; 2]) -> Rotor {
    let mass = |damping: f64| Mass {
        mass: 0.5,
        damping,
        cross_damping: 0.0,
        bearing_stiffness: 0.0,
        seal_stiffness: 0.0,
        unbalance: 0.0,
        deadband: 0.0,
    };
    Rotor::new("loose", damping.map(mass).to_vec(), vec![0.5]).expect("a rotor")
}

/// A free mode, a mode that nothing damps, and a rotor held only by its magnetic bearing, at once and after a delay: worth
/// exactly nothing, for either measure.
#[test]
fn a_mode_within_rounding_of_the_axis_is_no_success() {
    for (damping, gains) in [([0.1; 2], [0.0; 4]), ([0.0; 2], [0.0; 4]), ([0.0; 2], [1.0, 0.0, 0.0, 0.0])] {
        for delay in [0.0, 0.1] {
            if delay > 0.0 && gains != [0.0; 4] {
                continue;
            }
            for measure in [Measure::default(), Measure::Decay] {
                let asked = Problem { measure, ..problem(&loose(damping), [0.0, 0.0], delay) };
                let found = evaluated(&asked, &gains);
                assert!(found.worst.marginal() && found.worst.stable().is_none(), "{damping:?} {delay} {found:?}");
                assert_eq!(found.worst.value, 0.0);
            }
        }
    }
}

/// A feedback that pushes round the circle drives one mode and leaves another undamped: what grows is what is told.
#[test]
fn what_grows_beside_a_marginal_mode_is_unstable_and_not_marginal() {
    let found = evaluated(&problem(&loose([0.0, 0.0]), [0.0, 0.0], 0.0), &[0.0, -1.0, 0.0, 0.0]);
    assert_eq!(found.worst.stable(), Some(false), "{found:?}");
}

/// Where the best there is is marginal there is nothing to trade: the front is that one point, and no success.
#[test]
fn a_front_of_marginal_gains_ends_at_once() {
    let asked = Problem { bound: 0.0, ..problem(&loose([0.0; 2]), [0.0, 0.0], 0.0) };
    let options = Options { starts: 1, ..Options::for_problem(&asked) };
    match pareto(&asked, Price::Gain, 4, &options, &|_| (), Stop::NEVER) {
        Ok(front) => assert!(front.len() == 1 && front[0].tuned.worst.stable() != Some(true), "{front:?}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Sixteen bearings with deadband have 2^17 corners: they are not walked, and a search among them ends when it is told to.
#[test]
fn a_family_too_large_to_enumerate_ends_when_asked() {
    let end = builtin::rotor("three-mass").expect("built in").masses()[0];
    let rotor = Rotor::new("long", vec![end; 16], vec![0.5; 15]).expect("a rotor");
    let mut asked = problem(&rotor, [0.0, 1.0], 0.0);
    asked.family.any_deadband(true).expect("bearings");
    let stopped = AtomicBool::new(true);
    let options = Options { starts: 1, ..Options::for_problem(&asked) };
    let found = tune(&asked, &options, &|_| (), Stop::when(&stopped)).expect("makes sense");
    assert!(found.interrupted && !found.worst.proven);
    // What it looked at is a sample, not a grid.
    assert!(found.evaluations < 5000, "{}", found.evaluations);
    stopped.store(false, Ordering::Relaxed);
}
