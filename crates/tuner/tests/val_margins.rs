//! Margins in the search, against those that crate `machine` finds on another way.

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{margins, worst_margins};
use rotor::{Feedback, Settings, builtin};
use tuner::{Family, Options, Price, Problem, ProblemError, Schedule, Stop, Structure, evaluate, pareto, tune};

fn problem(from: f64, to: f64, template: &Feedback) -> Problem {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let structure = Structure::new(&rotor, template, Schedule::Fixed).expect("fits");
    Problem::new(Family::new(&rotor, from, to).expect("a range"), structure, 5.0)
}

#[test]
fn val_margins_of_given_gains_are_those_of_the_machine() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (name, peak, delay) in [("composite", 10.3495, 0.112_792), ("individual", 1.19172, 0.232_233)] {
        for lag in [0.0, 0.03] {
            let mut feedback = builtin::feedback(&rotor, name).expect("built in");
            feedback.bearings[0].parts.lag = lag;
            let asked = Problem { max_sensitivity: Some(f64::INFINITY), ..problem(6.0, 6.0, &feedback) };
            let gains = asked.structure.variables_of(&feedback);
            let found = evaluate(&asked, &Options::for_problem(&asked), &gains, Stop::NEVER).expect("makes sense");
            let [(ours, _), _] = found.margins.clone().expect("asked for");
            let there = margins(&rotor, &Settings::new(&rotor, 6.0, feedback), 6.0).expect("stable").margins;
            assert!((ours.sensitivity.0 / there.sensitivity().amplitude - 1.0).abs() < 1e-9, "{ours:?} {there:?}");
            // A lag is more than gains: nothing is proven of it.
            assert_eq!(found.peak_below.is_some(), lag == 0.0, "{found:?}");
            let (found, of) = (ours.delay.expect("one"), there.delay.expect("one"));
            assert!(
                (found.0 / of.delay - 1.0).abs() < 1e-9 && (found.1 - of.frequency).abs() < 1e-6,
                "{found:?} {of:?}"
            );
            if lag == 0.0 {
                assert!((ours.sensitivity.0 / peak - 1.0).abs() < 1e-5 && (found.0 / delay - 1.0).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn val_limits_of_both_margins_hold_over_the_whole_range() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let free = problem(0.0, 6.0, &Structure::individual(3, 0, &[0, 1]));
    let asked = Problem { max_sensitivity: Some(1.5), min_delay: Some(0.1), ..free.clone() };
    let options = Options { starts: 4, ..Options::for_problem(&asked) };
    let found = tune(&asked, &options, &|_| (), Stop::NEVER).expect("makes sense");
    assert!(found.worst.stable() == Some(true), "{:?}", found.worst);
    let speeds: Vec<f64> = (0..=300).map(|k| 0.02 * f64::from(k)).collect();
    let worst = worst_margins(&rotor, &Settings::new(&rotor, 0.0, found.feedback.clone()), &speeds).expect("stable");
    let peak = worst[4].as_ref().expect("one").margins.sensitivity().amplitude;
    let delay = worst[0].as_ref().and_then(|margins| margins.margins.delay).map_or(f64::INFINITY, |delay| delay.delay);
    assert!(peak <= 1.5 * 1.001 && delay >= 0.1 * 0.999, "{peak} {delay}");
    // What is told is what is there.
    let [(told, _), (late, _)] = found.margins.as_ref().expect("asked for");
    assert!((told.sensitivity.0 / peak - 1.0).abs() < 1e-3, "{told:?} {peak}");
    assert!((late.delay.map_or(f64::INFINITY, |(delay, _)| delay) / delay - 1.0).abs() < 1e-3, "{late:?} {delay}");
    // And nothing between any of the speeds is above what is proven.
    let below = found.peak_below.expect("proven");
    assert!(peak <= below && below <= told.sensitivity.0 * 1.0011, "{peak} {below}");
    // Limits cost damping.
    let free = tune(&free, &options, &|_| (), Stop::NEVER).expect("makes sense");
    assert!(found.worst.value <= free.worst.value + 1e-6, "{} {}", found.worst.value, free.worst.value);
}

#[test]
fn less_sensitivity_costs_damping_along_the_front() {
    let problem = problem(4.0, 4.0, &Structure::individual(3, 0, &[0, 1]));
    let options = Options { starts: 3, prove: false, ..Options::for_problem(&problem) };
    let front = pareto(&problem, Price::Sensitivity, 4, &options, &|_| (), Stop::NEVER).expect("makes sense");
    assert!(front.len() >= 3, "{}", front.len());
    for pair in front.windows(2) {
        let [a, b] = [&pair[0].tuned, &pair[1].tuned]
            .map(|tuned| (tuned.peak_sensitivity().expect("looked at"), tuned.worst.value));
        assert!(b.0 < a.0 && b.1 <= a.1 * (1.0 + 1e-3), "{a:?} {b:?}");
    }
}

#[test]
fn limits_that_no_loop_keeps_and_sampled_loops_are_refused() {
    let fine = problem(0.0, 6.0, &Structure::individual(3, 0, &[0, 1]));
    for limit in [1.0, 0.5, f64::NAN] {
        assert!(matches!(
            Problem { max_sensitivity: Some(limit), ..fine.clone() }.check(),
            Err(ProblemError::Sensitivity(_))
        ));
    }
    for least in [0.0, -1.0, f64::INFINITY] {
        assert!(matches!(Problem { min_delay: Some(least), ..fine.clone() }.check(), Err(ProblemError::Delay(_))));
    }
    let mut template = Structure::individual(3, 0, &[0, 1]);
    template.bearings[0].parts.sample = 0.05;
    let sampled = Problem { min_delay: Some(0.1), ..problem(0.0, 6.0, &template) };
    assert_eq!(sampled.check(), Err(ProblemError::Sampled));
}

/// Whoever stops a search is told of the gains that it leaves what holds for the whole range, not for the one place that came last.
#[test]
fn a_search_that_was_stopped_tells_force_and_margins_of_the_whole_range() {
    let free = problem(0.0, 6.0, &Structure::individual(3, 0, &[0, 1]));
    let asked = Problem { max_sensitivity: Some(5.0), min_delay: Some(0.1), ..free };
    let options = Options { starts: 1, ..Options::for_problem(&asked) };
    let stopped = AtomicBool::new(false);
    // Some way up, and not there.
    let say = |_: &tuner::Progress| stopped.store(true, Ordering::Relaxed);
    let found = tune(&asked, &options, &say, Stop::when(&stopped)).expect("makes sense");
    assert!(found.interrupted);
    let whole = evaluate(&asked, &options, &found.gains, Stop::NEVER).expect("makes sense");
    let told = |tuned: &tuner::Tuned| {
        let [(peak, _), (late, _)] = tuned.margins.clone().expect("asked for");
        [tuned.force, peak.sensitivity.0, late.delay.map_or(f64::INFINITY, |(delay, _)| delay)]
    };
    for (hasty, whole) in told(&found).into_iter().zip(told(&whole)) {
        assert!(hasty == whole || (hasty / whole - 1.0).abs() < 0.01, "{hasty} {whole}");
    }
}
