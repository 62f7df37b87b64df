//! Searches that move corners of filters: what is found is better than without, within what was allowed, and what the machine says.

use rotor::{Feedback, Filter, Rotor, Settings, builtin};
use tuner::{Corner, Family, Options, Problem, ProblemError, Schedule, Stop, Structure, Tuned, track, tune};

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

/// Gains behind a lead and a low-pass that are in the wrong place.
fn late() -> Feedback {
    let mut template = builtin::feedback(&three_mass(), "composite").expect("built in");
    template.bearings[0].signals[0].filters = vec![Filter::Lead { zero: 6.0, pole: 9.0 }];
    template.bearings[0].filters = vec![Filter::Lowpass { corner: 12.0, order: 2 }];
    template
}

fn problem(rotor: &Rotor, template: &Feedback, [from, to]: [f64; 2], corners: Vec<Corner>) -> Problem {
    let structure = Structure::new(rotor, template, Schedule::Fixed).expect("fits").with_corners(corners);
    let bound = structure.default_bound();
    Problem::new(Family::new(rotor, from, to).expect("a range"), structure, bound)
}

fn search(problem: &Problem, starts: usize) -> Tuned {
    let options = Options { starts, ..Options::for_problem(problem) };
    tune(problem, &options, &|_| (), Stop::NEVER).expect("makes sense")
}

#[test]
fn corners_are_called_as_their_file_has_them() {
    let names = |feedback: &Feedback| Corner::all(feedback).into_iter().map(|c| c.name).collect::<Vec<_>>();
    assert_eq!(names(&late()), ["signal.1.filter.1.zero", "signal.1.filter.1.pole", "filter.1.corner"]);
    let rig = builtin::rotor("rig").expect("built in");
    let own = builtin::feedback(&rig, "own").expect("it has a law");
    let of_left = ["zero.1", "zero.2", "pole.1", "pole.2"].map(|name| format!("left.signal.1.filter.1.{name}"));
    assert_eq!(names(&own)[..4], of_left);
    assert!(names(&own)[4].starts_with("right."));
}

#[test]
fn variables_are_corners_and_back() {
    let rotor = three_mass();
    let template = late();
    let corners: Vec<Corner> =
        Corner::all(&template).into_iter().map(|c| Corner::within(c.clone(), c.own / 2.0, c.own * 8.0)).collect();
    let structure = Structure::new(&rotor, &template, Schedule::Fixed).expect("fits").with_corners(corners);
    let own = structure.own();
    assert_eq!(own.len(), 4 + 3);
    for (found, expected) in structure.corner_values(&own).iter().zip([6.0, 9.0, 12.0]) {
        assert!((found / expected - 1.0_f64).abs() < 1e-14);
    }
    // A range from half to eight times is four either way around twice what it is.
    let ends = structure.reach(20.0);
    assert!((ends[4] - 4.0_f64.ln()).abs() < 1e-14 && ends[0] == 20.0);
    let mut other = own.clone();
    (other[4], other[6]) = (ends[4], -ends[6]);
    let made = structure.feedback(&other);
    assert_eq!(made.bearings[0].signals[0].filters[0], Filter::Lead { zero: 48.0, pole: made_pole(&made) });
    assert_eq!(made.bearings[0].filters, [Filter::Lowpass { corner: 6.0, order: 2 }]);
    for (a, b) in structure.variables_of(&made).iter().zip(&other) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
    }
}

fn made_pole(feedback: &Feedback) -> f64 {
    let Filter::Lead { pole, .. } = feedback.bearings[0].signals[0].filters[0] else { panic!("a lead") };
    assert!((pole / 9.0 - 1.0).abs() < 1e-14);
    pole
}

#[test]
fn corners_that_move_damp_the_worst_mode_better_and_stay_where_they_may_be() {
    let (rotor, template) = (three_mass(), late());
    let corners: Vec<Corner> = Corner::all(&template);
    let fixed = search(&problem(&rotor, &template, [0.0, 5.0], vec![]), 4);
    let asked = problem(&rotor, &template, [0.0, 5.0], corners.clone());
    let found = search(&asked, 4);
    assert!(found.worst.value > 1.05 * fixed.worst.value, "{} {}", found.worst.value, fixed.worst.value);
    for (corner, value) in corners.iter().zip(&found.corners) {
        assert!((corner.from..=corner.to).contains(value), "{corner:?} {value}");
    }
    // The feedback that is told has them, and the machine has the damping that is told of it.
    let settings = Settings::new(&rotor, 0.0, found.feedback.clone());
    let Filter::Lead { zero, pole } = found.feedback.bearings[0].signals[0].filters[0] else { panic!("still a lead") };
    assert_eq!([zero, pole], found.corners[..2]);
    let at = |speed: f64| machine::min_damping(&rotor, &settings, speed).expect("converges");
    assert!((at(found.worst.point[0]) - found.worst.value).abs() < 1e-9);
    let least = (0..=100).map(|i| at(0.05 * f64::from(i))).fold(f64::INFINITY, f64::min);
    assert!(least > found.worst.value - 1e-6, "{least} {:?}", found.worst);
    assert!(!found.worst.proven);
}

#[test]
fn the_law_as_it_is_comes_first_so_that_what_is_found_is_never_worse() {
    let (rotor, mut template) = (three_mass(), late());
    template.bearings[0].filters = vec![Filter::Lowpass { corner: 80.0, order: 2 }];
    let asked = problem(&rotor, &template, [4.0, 4.0], Corner::all(&template));
    let options = Options::for_problem(&asked);
    assert_eq!(options.first, [asked.structure.own()]);
    let before = tuner::evaluate(&asked, &options, &asked.structure.own(), Stop::NEVER).expect("judged");
    let found = search(&asked, 1);
    assert!(found.worst.value >= before.worst.value, "{} {}", found.worst.value, before.worst.value);
}

#[test]
fn limits_of_margins_and_force_are_kept_by_corners_that_move() {
    let (rotor, template) = (three_mass(), late());
    let plain = problem(&rotor, &template, [3.0, 3.0], Corner::all(&template));
    let asked = Problem { max_sensitivity: Some(2.0), min_delay: Some(0.12), force_limit: Some(3.0), ..plain };
    let found = search(&asked, 4);
    assert!(found.worst.stable() == Some(true), "{:?}", found.worst);
    let settings = Settings::new(&rotor, 3.0, found.feedback.clone());
    let read = machine::margins(&rotor, &settings, 3.0).expect("stable").margins;
    let delay = read.delay.expect("one").delay;
    assert!(read.sensitivity().amplitude < 2.0 * 1.001 && delay > 0.12 * 0.999, "{read:?}");
    let [(told, _), (late, _)] = found.margins.as_ref().expect("asked for");
    assert!((told.sensitivity.0 / read.sensitivity().amplitude - 1.0).abs() < 1e-6, "{told:?} {read:?}");
    assert!((late.delay.expect("one").0 / delay - 1.0).abs() < 1e-6);
    let exact = rotor::circular::synchronous(&rotor, &found.feedback, &[0.0; 3], &[3.0]).expect("converges");
    let force = exact.orbits[0][0].force;
    assert!((force / found.force - 1.0).abs() < 1e-6 && force < 3.0 * 1.001, "{force} {}", found.force);
}

#[test]
fn corners_that_cannot_move_or_would_follow_the_speed_are_refused_by_name() {
    let (rotor, template) = (three_mass(), late());
    for (from, to) in [(0.0, 3.0), (-1.0, 3.0), (3.0, 3.0), (4.0, 3.0), (1.0, f64::INFINITY), (f64::NAN, 3.0)] {
        let corners = Corner::all(&template).into_iter().map(|corner| corner.within(from, to)).collect();
        let refused = problem(&rotor, &template, [3.0, 3.0], corners).check();
        assert!(
            matches!(&refused, Err(ProblemError::Corner { name, .. }) if name == "signal.1.filter.1.zero"),
            "{refused:?}"
        );
    }
    let asked = problem(&rotor, &template, [0.0, 3.0], Corner::all(&template));
    let refused = track(&asked, &[0.0, 3.0], 1e-3, &Options::for_problem(&asked), &|_| (), Stop::NEVER);
    assert!(matches!(refused, Err(ProblemError::Followed(_))));
}
