//! Gains that the search returned, evaluated by SciPy's eigenvalues of matrices written down independently
//! (`tests/reference/tune.py`): the same damping at the condition that is named as the worst, and none lower on SciPy's grid.

use rotor::builtin;
use serde_json::Value;
use tuner::{Family, Options, Problem, Schedule, Stop, Structure, evaluate};

#[test]
fn val_scipy_agrees_on_the_worst_and_finds_nothing_below_the_certified_bound() {
    let text = include_str!("../../../tests/reference/tune.json");
    let cases: Vec<Value> = serde_json::from_str(text).expect("JSON");
    let rotor = builtin::rotor("three-mass").expect("built in");
    for case in &cases {
        let number = |key: &str| case[key].as_f64().expect("a number");
        let list = |key: &str| -> Vec<f64> {
            case[key].as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
        };
        let gains = list("gains");
        let mut family = Family::new(&rotor, number("from"), number("to")).expect("a range");
        if case["robust"] == true {
            family.any_deadband(true).expect("bearings");
        }
        let make = if gains.len() == 8 { Structure::individual } else { Structure::composite };
        let structure = Structure::new(&rotor, &make(3, 0, &[0, 1]), Schedule::Fixed).expect("fits");
        let problem = Problem::new(family, structure, number("bound"));
        let evaluated = evaluate(&problem, &Options::for_problem(&problem), &gains, Stop::NEVER).expect("makes sense");
        let (name, worst) = (&case["name"], &evaluated.worst);
        assert!(worst.proven, "{name}: {worst:?}");
        assert!((number("ours") - number("scipy")).abs() < 1e-9, "{name}");
        assert!((worst.value - number("scipy")).abs() < 1e-9, "{name}: {worst:?}");
        assert!(number("grid") >= worst.value - worst.tolerance, "{name}: {worst:?}");
    }
    assert_eq!(cases.len(), 9);
}
