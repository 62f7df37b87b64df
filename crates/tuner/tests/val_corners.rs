//! Gains and corners of filters against a global optimiser of SciPy on matrices written down independently
//! (`tests/reference/tune_corners.py`): its best is worth here what it is there, and a search here does not end below it.

use rotor::{Filter, builtin};
use serde_json::Value;
use tuner::{Corner, Family, Options, Problem, Schedule, Stop, Structure, evaluate, tune};

#[test]
fn val_scipys_global_search_finds_nothing_better() {
    let text = include_str!("../../../tests/reference/tune_corners.json");
    let cases: Vec<Value> = serde_json::from_str(text).expect("JSON");
    let rotor = builtin::rotor("three-mass").expect("built in");
    for case in &cases {
        let number = |value: &Value| value.as_f64().expect("a number");
        let list = |key: &str| case[key].as_array().expect("a list").iter().map(number).collect::<Vec<f64>>();
        let speed = number(&case["speed"]);
        let (gains, corners, theirs) = (list("gains"), list("corners"), number(&case["damping"]));
        let mut template = Structure::composite(3, 0, &[0, 1]);
        template.bearings[0].signals[0].filters = vec![Filter::Lead { zero: corners[0], pole: corners[1] }];
        template.bearings[0].filters = vec![Filter::Lowpass { corner: corners[2], order: 2 }];
        let ranges = case["ranges"].as_array().expect("a list");
        let free = Corner::all(&template).into_iter().zip(ranges);
        let free = free.map(|(corner, range)| corner.within(number(&range[0]), number(&range[1]))).collect();
        let structure = Structure::new(&rotor, &template, Schedule::Fixed).expect("fits").with_corners(free);
        let own = structure.own();
        let variables: Vec<f64> = gains.iter().chain(&own[4..]).copied().collect();
        let family = Family::new(&rotor, speed, speed).expect("a speed");
        let problem = Problem::new(family, structure, number(&case["bound"]));
        let options = Options::for_problem(&problem);
        let judged = evaluate(&problem, &options, &variables, Stop::NEVER).expect("makes sense");
        // At the best gains poles nearly merge, and hang on the last digits of everything: half of them are left.
        assert!((judged.worst.value - theirs).abs() < 1e-6, "{} {theirs}", judged.worst.value);
        // From nothing: the first start is at random too.
        let found =
            tune(&problem, &Options { first: Vec::new(), ..options }, &|_| (), Stop::NEVER).expect("makes sense");
        assert!(found.worst.value > theirs - 1e-6, "R = {speed}: {} {theirs}", found.worst.value);
    }
    assert_eq!(cases.len(), 2);
}
