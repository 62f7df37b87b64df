//! Runs and spectra against SciPy, on a five-mass rotor that is not the report's; see tests/reference/trajectories.py.

use std::sync::atomic::AtomicBool;

use rotor::{C64, Feedback, Mass, Rotor, Signal};
use study::run::{Impulse, Outcome, Plan, Settle, run};
use study::spectrum::welch;

fn reference() -> serde_json::Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/trajectories.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("committed")).expect("JSON")
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// The rotor of the script: mass, zeta, zeta_q, Rb, Rs, Re.
fn five(speed: f64, duration: f64, settle: Settle) -> Plan {
    let table = [
        [0.10, 0.30, 0.05, 0.3, 0.05, 0.3],
        [0.30, 0.10, 0.02, 0.0, 0.02, 0.1],
        [0.20, 0.20, 0.00, 0.2, 0.03, 0.4],
        [0.25, 0.15, 0.01, 0.0, 0.04, -0.2],
        [0.15, 0.25, 0.04, 0.4, 0.06, 0.2],
    ];
    let masses = table.map(|[mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance]| Mass {
        mass,
        damping,
        cross_damping,
        bearing_stiffness,
        seal_stiffness,
        unbalance,
        deadband: 0.0,
    });
    let rotor = Rotor::new("five", masses.to_vec(), vec![0.4, 0.6, 0.5, 0.3]).expect("valid");
    let signal = Signal::composite(&[0.2, 1.0, 0.3, 0.0, 0.1], [0.1, 0.3, -0.1, 0.05]);
    let feedback = Feedback::new(1, vec![signal]);
    feedback.check(5).expect("fits");
    let clearances = [0.05, 0.0, 0.10, 0.0, 0.15];
    Plan::steady(&rotor, &feedback, speed, &clearances, duration, settle).expect("can be stepped")
}

fn simulate(case: &serde_json::Value, duration: f64) -> Outcome {
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let impulses = case["impulse"].as_array().expect("a list").iter().map(|impulse| Impulse {
        mass: impulse["mass"].as_u64().expect("a mass") as usize - 1,
        change: C64::new(number(&impulse["vy"]), number(&impulse["vz"])),
        at: 0.0,
    });
    let plan = Plan {
        impulses: impulses.collect(),
        // Small enough that the corners of the deadband, which a fixed step does not see, cost less than what is compared.
        dtau: 0.001,
        ..five(number(&case["speed"]), duration, Settle::From(number(&case["settle"]).min(duration)))
    };
    run(&plan, &mut [], &AtomicBool::new(false)).expect("runs")
}

#[test]
fn val_trajectories_agree_with_dop853() {
    for case in reference()["cases"].as_array().expect("a list") {
        let marks = numbers(&case["tau"]);
        for (tau, state) in marks.iter().zip(case["states"].as_array().expect("a list")).skip(1).step_by(3) {
            let state = numbers(state);
            let last = simulate(case, *tau).last;
            for k in 0..5 {
                let p = C64::new(state[k], state[5 + k]);
                let v = C64::new(state[10 + k], state[15 + k]);
                assert!((last.displacement[k] - p).norm() < 1e-6, "mass {k} at tau = {tau}, R = {}", case["speed"]);
                assert!((last.velocity[k] - v).norm() < 1e-6, "mass {k} at tau = {tau}, R = {}", case["speed"]);
            }
        }
    }
}

#[test]
fn val_maxima_and_means_agree_with_dop853() {
    for case in reference()["cases"].as_array().expect("a list") {
        let outcome = simulate(case, case["duration"].as_f64().expect("a number"));
        let pairs = [
            (
                vec![outcome.max_force, outcome.max_force_component],
                vec![
                    case["max_force"].as_f64().expect("a number"),
                    case["max_force_component"].as_f64().expect("a number"),
                ],
            ),
            (outcome.max_displacement, numbers(&case["max_displacement"])),
        ];
        for (ours, theirs) in pairs {
            for (a, b) in ours.iter().zip(&theirs) {
                assert!((a - b).abs() < 1e-6, "{a} for {b} at R = {}", case["speed"]);
            }
        }
        // A mean over samples is the integral to the order of one step in the whole.
        for (a, b) in outcome.mean_radius.iter().zip(numbers(&case["mean_radius"])) {
            assert!((a - b).abs() < 2e-5, "{a} for {b} at R = {}", case["speed"]);
        }
    }
}

#[test]
fn val_spectra_agree_with_scipy_welch() {
    let reference = reference();
    let case = reference["cases"].as_array().expect("a list").iter().find(|c| c.get("psd").is_some()).expect("one");
    let psd = &case["psd"];
    let samples: Vec<C64> =
        numbers(&psd["y"]).into_iter().zip(numbers(&psd["z"])).map(|(y, z)| C64::new(y, z)).collect();
    let segment = psd["segment"].as_u64().expect("a count") as usize;
    let ours = welch(&samples, psd["apart"].as_f64().expect("a number"), segment).expect("enough");
    let (frequency, density) = (numbers(&psd["frequency"]), numbers(&psd["density"]));
    assert_eq!(ours.density.len(), density.len());
    let highest = density.iter().copied().fold(0.0, f64::max);
    for i in 0..density.len() {
        assert!((ours.frequency[i] - frequency[i]).abs() < 1e-9);
        assert!((ours.density[i] - density[i]).abs() < 1e-12 * highest, "{} for {}", ours.density[i], density[i]);
    }
    // The steady motion is synchronous.
    assert_eq!(ours.peaks(1.6)[0].name, "1X");
}
