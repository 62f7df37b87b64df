//! Sampled loops against SciPy, which made `sampled_loop.json`: see `tests/reference/sampled_loop.py`.

use machine::MachinePoles;
use rotor::{C64, Settings, builtin};

#[test]
fn val_sampled_poles_are_those_of_scipy_with_the_delay_split_exactly() {
    let cases: serde_json::Value = serde_json::from_str(include_str!("sampled_loop.json")).expect("JSON");
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let rotor = builtin::rotor("three-mass").expect("built in");
    for case in cases.as_array().expect("a list") {
        let feedback = builtin::feedback(&rotor, "composite").expect("built in");
        let mut settings = Settings::new(&rotor, number(&case["speed"]), feedback);
        settings.feedback.bearings[0].parts.sample = number(&case["sample"]);
        settings.feedback.bearings[0].parts.delay = number(&case["delay"]);
        let found = MachinePoles::of(&rotor, &settings).expect("poles").z.expect("sampled");
        for z in case["z"].as_array().expect("a list") {
            let expected = C64::new(number(&z[0]), number(&z[1]));
            let apart = found.iter().map(|z| (z - expected).norm()).fold(f64::INFINITY, f64::min);
            assert!(apart < 1e-10, "{case}: {expected} is off by {apart:e}");
        }
    }
}
