//! Searches through filters, lags, delays and samples: what is told is what the machine's own poles say.

use rotor::circular::synchronous;
use rotor::{Feedback, Filter, Parts, Rotor, Settings, builtin};
use tuner::{Family, FamilyAxis, FamilyQuantity, Options, Problem, Schedule, Stop, Structure, Tuned, evaluate, tune};

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

fn template(parts: Parts, filters: Vec<Filter>) -> Feedback {
    let mut template = Structure::composite(3, 0, &[0, 1]);
    (template.bearings[0].parts, template.bearings[0].filters) = (parts, filters);
    template
}

fn problem(template: &Feedback) -> Problem {
    let rotor = three_mass();
    let structure = Structure::new(&rotor, template, Schedule::Fixed).expect("fits");
    Problem::new(Family::new(&rotor, 0.0, 6.0).expect("a range"), structure, 20.0)
}

fn search(problem: &Problem) -> Tuned {
    let options = Options { starts: 1, ..Options::for_problem(problem) };
    tune(problem, &options, &|_| (), Stop::NEVER).expect("makes sense")
}

fn loops() -> [(&'static str, Feedback); 4] {
    let parts = Parts::default();
    let mut filtered = template(parts, vec![Filter::Lowpass { corner: 40.0, order: 2 }]);
    filtered.bearings[0].signals[0].filters = vec![Filter::SynchronousNotch { width: 0.05 }];
    [
        ("lags", template(Parts { sensor_lag: 0.01, lag: 0.02, lag_damping: 0.8, ..parts }, vec![])),
        ("filters", filtered),
        ("lag and delay", template(Parts { lag: 0.02, delay: 0.02, ..parts }, vec![])),
        ("samples", template(Parts { sample: 0.05, delay: 0.03, ..parts }, vec![])),
    ]
}

#[test]
fn what_a_search_through_a_loop_tells_no_speed_of_the_machine_is_worse_than() {
    let rotor = three_mass();
    for (what, template) in loops() {
        let problem = problem(&template);
        let found = search(&problem);
        assert!(found.worst.value > 0.004 && !found.worst.proven, "{what}: {:?}", found.worst);
        assert_eq!(
            found.feedback.bearings[0].parts, template.bearings[0].parts,
            "{what}: the loop stays in the answer"
        );
        assert_eq!(found.feedback.bearings[0].filters, template.bearings[0].filters);
        let settings = Settings::new(&rotor, 0.0, found.feedback.clone());
        let at = |speed: f64| machine::min_damping(&rotor, &settings, speed).expect("converges");
        assert!((at(found.worst.point[0]) - found.worst.value).abs() < 1e-9, "{what}");
        let least = (0..=120).map(|i| at(0.05 * f64::from(i))).fold(f64::INFINITY, f64::min);
        assert!(least > found.worst.value - 1e-6, "{what}: {least} {:?}", found.worst);
    }
}

#[test]
fn through_next_to_no_lag_the_search_finds_what_it_finds_without() {
    let parts = Parts { lag: 1e-5, ..Parts::default() };
    let [ideal, near] = [Parts::default(), parts].map(|parts| search(&problem(&template(parts, vec![]))));
    assert!((ideal.worst.value - near.worst.value).abs() < 1e-4, "{} {}", ideal.worst.value, near.worst.value);
    assert!(ideal.worst.proven && !near.worst.proven, "a proof is of the ideal loop alone");
}

#[test]
fn a_delay_of_the_loop_is_a_delay_of_the_family() {
    let gains = [-0.5879, 0.4948, -0.4847, 0.6483];
    let own = problem(&template(Parts { delay: 0.02, ..Parts::default() }, vec![]));
    let mut family = problem(&template(Parts::default(), vec![]));
    family.family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from: 0.02, to: 0.02 }).expect("a delay");
    let [own, family] = [own, family].map(|mut problem| {
        problem.family = problem.family.at_speed(6.0);
        evaluate(&problem, &Options::for_problem(&problem), &gains, Stop::NEVER).expect("makes sense")
    });
    assert_eq!(own.worst.value, family.worst.value);
    // Physics, section 7: these gains at R = 6 with this delay.
    assert!((own.worst.value - 0.009_767_58).abs() < 1e-8, "{}", own.worst.value);
    assert!(!own.worst.proven && own.worst.count_right_of == Some(-100.0));
}

#[test]
fn a_limit_on_force_is_kept_through_the_loop() {
    let template = template(Parts { lag: 0.03, sensor_lag: 0.01, ..Parts::default() }, vec![]);
    let problem = Problem { force_limit: Some(4.0), ..problem(&template) };
    let found = search(&problem);
    assert!(found.force <= 4.0 * (1.0 + 1e-4) && found.worst.value > 0.0, "{} {:?}", found.force, found.worst);
    let speeds: Vec<f64> = (1..=60).map(|i| 0.1 * f64::from(i)).collect();
    let exact = synchronous(&three_mass(), &found.feedback, &[0.0; 3], &speeds).expect("converges");
    let most = exact.orbits.iter().flatten().map(|orbit| orbit.force).fold(0.0, f64::max);
    assert!((most - found.force).abs() < 0.01 * found.force, "{most} {}", found.force);
}

/// A search on a bench with a fault is of the machine as it is; where that has no poles it is refused.
#[test]
fn regress_faults_of_sensors_and_amplifiers_are_a_part_of_what_is_searched() {
    let rotor = three_mass();
    let mut faulty = builtin::feedback(&rotor, "individual").expect("built in");
    faulty.bearings[0].parts.sensor_gain = 0.5;
    let asked = problem(&faulty);
    let gains = asked.structure.variables_of(&faulty);
    let found = evaluate(&asked, &Options::for_problem(&asked), &gains, Stop::NEVER).expect("makes sense");
    let there = machine::min_damping(&rotor, &Settings::new(&rotor, 0.0, faulty.clone()), found.worst.point[0]);
    assert!((found.worst.value - there.expect("poles")).abs() < 1e-9, "{:?}", found.worst);
    faulty.bearings[0].parts.amplifier_y = 0.0;
    assert!(Structure::new(&rotor, &faulty, Schedule::Fixed).is_err());
}
