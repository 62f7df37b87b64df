//! The cost of unbalance and noise beside SciPy (`tests/reference/cost.py`): the same number by `solve_continuous_lyapunov` on equations in
//! real form, with a noise for every reading; and no gains of less cost found there.

use rotor::builtin;
use serde_json::Value;
use tuner::{Cost, Family, Measure, Options, Problem, Schedule, Stop, Structure, tune};

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn problem(gains: usize, speed: f64, cost: Cost) -> Problem {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let make = if gains == 8 { Structure::individual } else { Structure::composite };
    let structure = Structure::new(&rotor, &make(3, 0, &[0, 1]), Schedule::Fixed).expect("fits");
    let family = Family::new(&rotor, speed, speed).expect("a speed");
    Problem { measure: Measure::Cost(cost), ..Problem::new(family, structure, 20.0) }
}

#[test]
fn val_scipy_has_the_same_cost_and_finds_no_gains_of_less() {
    let document: Value = serde_json::from_str(include_str!("../../../tests/reference/cost.json")).expect("JSON");
    let number = |of: &Value| of.as_f64().expect("a number");
    let cost = Cost {
        force: number(&document["force"]),
        noise: number(&document["noise"]),
        corner: number(&document["corner"]),
    };
    let points = document["points"].as_array().expect("a list");
    for point in points {
        let (gains, speed) = (numbers(&point["gains"]), number(&point["speed"]));
        let ours = cost.square(&problem(gains.len(), speed, cost), &gains, &[speed]).expect("stable");
        let scipy = number(&point["cost"]);
        assert!((ours - scipy).abs() < 1e-10 * scipy, "{point}: {ours}");
    }
    assert!(points.len() >= 10);
    for searched in document["searched"].as_array().expect("a list") {
        let speed = number(&searched["speeds"][0]);
        let problem = problem(4, speed, cost);
        let found = tune(&problem, &Options::for_problem(&problem), &|_| (), Stop::NEVER).expect("makes sense");
        let (ours, scipy) = (found.worst.value.recip(), number(&searched["cost"]));
        assert!(ours < scipy * (1.0 + 1e-6), "{searched}: {ours} with {:?}", found.gains);
        assert!(found.stationarity.norm < 1e-5, "{:?}", found.stationarity);
    }
}
