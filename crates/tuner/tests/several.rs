//! Searches over several control bearings, and over rotors of shaft elements: what is told is what the machine itself says.

use nalgebra::DVector;
use rotor::{
    C64, Characteristic, Feedback, LinearForm, OperatingPoint, Plant, Rotor, Settings, builtin, damping_ratio,
};
use tuner::{
    Family, FamilyAxis, FamilyError, FamilyQuantity, Options, Problem, Schedule, Stop, Structure, Tuned, evaluate, tune,
};

fn problem(rotor: &Rotor, template: &Feedback, [from, to]: [f64; 2]) -> Problem {
    let structure = Structure::new(rotor, template, Schedule::Fixed).expect("fits");
    let bound = structure.default_bound();
    Problem::new(Family::new(rotor, from, to).expect("a range"), structure, bound)
}

fn search(problem: &Problem, starts: usize) -> Tuned {
    let options = Options { starts, ..Options::for_problem(problem) };
    tune(problem, &options, &|_| (), Stop::NEVER).expect("makes sense")
}

fn rig() -> (Rotor, Feedback) {
    let rotor = builtin::rotor("rig").expect("built in");
    let own = builtin::feedback(&rotor, "own").expect("it has a law");
    (rotor, own)
}

/// The poles of the machine itself.
fn poles(rotor: &Rotor, feedback: &Feedback, speed: f64) -> Vec<C64> {
    let form = LinearForm::of(&Plant::of(rotor), feedback, &OperatingPoint::at(speed)).expect("fits");
    Characteristic::of(&form).expect("finite").roots().expect("found").iter().map(|root| root.pole).collect()
}

/// The largest command under unbalance, solved from the machine's matrices as a whole.
fn force(rotor: &Rotor, feedback: &Feedback, speed: f64) -> f64 {
    let plant = Plant::of(rotor);
    let form = LinearForm::of(&plant, feedback, &OperatingPoint::at(speed)).expect("fits");
    let [a, b, c] = form.continuous().expect("a continuous loop");
    let n = plant.order();
    let mut driven = DVector::zeros(a.nrows());
    (0..n).for_each(|k| driven[n + k] = plant.unbalance()[k] * (speed * speed));
    let mut whole = -(&a + &b * &c);
    (0..a.nrows()).for_each(|k| whole[(k, k)] += C64::new(0.0, speed));
    let command = c * whole.lu().solve(&driven).expect("no pole on the axis");
    command.iter().map(|u| u.norm()).fold(0.0, f64::max)
}

fn two_ends() -> Feedback {
    let mut both = Structure::individual(3, 0, &[0, 1]);
    both.bearings.extend(Structure::individual(3, 2, &[1, 2]).bearings);
    both
}

#[test]
fn a_chain_on_two_control_bearings_is_damped_better_than_on_one() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let one = search(&Problem { bound: 3.0, ..problem(&rotor, &Structure::individual(3, 0, &[0, 1]), [0.0, 6.0]) }, 4);
    let two = search(&Problem { bound: 3.0, ..problem(&rotor, &two_ends(), [0.0, 6.0]) }, 3);
    assert!(two.worst.value > one.worst.value, "{} {}", two.worst.value, one.worst.value);
    assert!(one.worst.proven && !two.worst.proven, "nothing is claimed proven of several bearings");
    assert_eq!(two.gains.len(), 16);
    let least = |speed: f64| poles(&rotor, &two.feedback, speed).into_iter().map(damping_ratio).fold(1.0, f64::min);
    for k in 0..=60 {
        assert!(least(0.1 * f64::from(k)) > two.worst.value - 1e-6);
    }
    assert!((least(two.worst.point[0]) - two.worst.value).abs() < 1e-9);
    assert!((force(&rotor, &two.feedback, two.force_at[0]) - two.force).abs() < 1e-9 * two.force);
}

#[test]
fn what_is_promised_of_the_margins_of_two_bearings_the_machine_keeps() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let plain = problem(&rotor, &two_ends(), [3.0, 3.0]);
    let asked = Problem { bound: 3.0, max_sensitivity: Some(1.4), min_delay: Some(0.25), ..plain };
    let found = search(&asked, 2);
    assert_margins(&rotor, &found, &[3.0], 1.4, 0.25);
    assert!(found.worst.value > 0.02, "{}", found.worst.value);
}

/// The margins told are those of the machine at their conditions, and nowhere are they worse.
fn assert_margins(rotor: &Rotor, found: &Tuned, speeds: &[f64], most: f64, least: f64) {
    let settings = Settings::new(rotor, speeds[0], found.feedback.clone());
    let at = |speed: f64| {
        let read = machine::margins(rotor, &settings, speed).expect("stable").margins;
        (read.sensitivity().amplitude, read.delay.map_or(f64::INFINITY, |d| d.delay))
    };
    let [(peak, at_peak), (late, at_late)] = found.margins.as_ref().expect("asked for");
    assert!((at(at_peak[0]).0 - peak.sensitivity.0).abs() < 1e-4, "{} {}", at(at_peak[0]).0, peak.sensitivity.0);
    let told = late.delay.expect("some delay is too much").0;
    assert!((at(at_late[0]).1 - told).abs() < 1e-4 * told, "{} {told}", at(at_late[0]).1);
    for &speed in speeds {
        let (peak, delay) = at(speed);
        assert!(peak < most * 1.001 && delay > least * 0.999, "at {speed}: {peak} {delay}");
    }
}

#[test]
fn the_rig_is_damped_better_than_by_its_own_law_within_the_margins_asked_for() {
    let (rotor, own) = rig();
    let plain = problem(&rotor, &own, [6.0, 6.0]);
    let before = evaluate(&plain, &Options::for_problem(&plain), &plain.structure.own(), Stop::NEVER).expect("judged");
    let asked = Problem { max_sensitivity: Some(3.0), min_delay: Some(0.01), ..plain };
    let found = search(&asked, 1);
    assert!(found.worst.value > 1.2 * before.worst.value, "{} {}", found.worst.value, before.worst.value);
    assert!(!found.worst.proven && found.peak_below.is_none());
    assert_margins(&rotor, &found, &[6.0], 3.0, 0.01);
    let below = asked.below.expect("by default");
    for pole in poles(&rotor, &found.feedback, 6.0) {
        assert!(pole.re < 0.0 && (pole.norm() > below || damping_ratio(pole) > found.worst.value - 1e-6), "{pole}");
    }
    assert!((force(&rotor, &found.feedback, found.force_at[0]) - found.force).abs() < 1e-8 * found.force);
}

/// A variable of 1 is the law's own gain, and what is read back are the variables.
#[test]
fn gains_of_a_law_with_filters_are_searched_in_times_of_its_own() {
    let (rotor, own) = rig();
    let structure = Structure::new(&rotor, &own, Schedule::Fixed).expect("fits");
    assert_eq!(structure.own(), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(structure.feedback(&structure.own()), own);
    let other = [0.5, 0.25, -1.0, 2.0, 1.0, 0.0, 3.0, 0.5];
    assert_eq!(structure.variables_of(&structure.feedback(&other)), other);
}

#[test]
fn a_shaft_has_no_parameters_of_masses_and_no_play_but_touchdown_bearings() {
    let (rotor, _) = rig();
    let mut family = Family::new(&rotor, 0.0, 6.0).expect("a range");
    let quantity = FamilyQuantity::Parameter { field: 1, mass: 0 };
    let refused = family.push(FamilyAxis { quantity, from: 0.1, to: 0.2 });
    assert!(matches!(refused, Err(FamilyError::Chain(name)) if name.ends_with(".1")));
    family.any_deadband(true).expect("nothing to vary");
    assert_eq!(family.axes().len(), 1, "touchdown bearings hold nothing while all is well");
}

/// A quarter of the mass under the first bearing, half of it under the second.
#[test]
fn of_bearings_on_unequal_masses_the_larger_force_counts() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut unequal = Structure::individual(3, 0, &[0]);
    unequal.bearings.extend(Structure::individual(3, 1, &[1]).bearings);
    let plain = problem(&rotor, &unequal, [1.2, 1.2]);
    let gains = [1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
    let found = evaluate(&plain, &Options::for_problem(&plain), &gains, Stop::NEVER).expect("judged");
    let exact =
        rotor::circular::synchronous(&rotor, &plain.structure.feedback(&gains), &[0.0; 3], &[1.2]).expect("solved");
    let forces = &exact.orbits[0][0].forces;
    assert!(forces[1] * 2.0 > forces[0], "{forces:?}");
    assert!((found.force / (2.0 * forces[1]) - 1.0).abs() < 1e-9, "{} and {forces:?}", found.force);
    let limited = Problem { force_limit: Some(0.9 * found.force), bound: 3.0, ..plain };
    let kept = search(&limited, 2);
    assert!(kept.force <= 0.9 * found.force * (1.0 + 1e-6), "{}", kept.force);
}
