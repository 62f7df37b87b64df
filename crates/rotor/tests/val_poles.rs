//! Poles and thresholds beside SciPy's, on a rotor that is not the report's: `tests/reference/poles.py` writes the file.

use rotor::{C64, ClosedLoop, Feedback, Gain, Mass, Rotor, Signal, Stability, poles, thresholds, trace};
use serde_json::Value;

/// The largest difference from SciPy allowed in a pole, a speed or a frequency.
const TOLERANCE: f64 = 1e-9;

fn reference() -> Value {
    serde_json::from_str(include_str!("../../../tests/reference/poles.json")).expect("the reference is JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn chain(described: &Value) -> (Rotor, Feedback) {
    let list = |field: &str| numbers(&described[field]);
    let masses: Vec<Mass> = (0..list("mass").len())
        .map(|i| Mass {
            mass: list("mass")[i],
            damping: list("damping")[i],
            cross_damping: list("cross_damping")[i],
            bearing_stiffness: list("bearing_stiffness")[i],
            seal_stiffness: list("seal_stiffness")[i],
            unbalance: 0.0,
            deadband: 0.0,
        })
        .collect();
    let n = masses.len();
    let signals = described["sensors"].as_object().expect("by sensor").iter().map(|(sensor, gains)| {
        let mut signal = Signal::at_mass(sensor.parse::<usize>().expect("a mass") - 1, n, [0.0; 4]);
        for (gain, value) in signal.gains.iter_mut().zip(gains.as_array().expect("four")) {
            *gain = match value.as_f64() {
                Some(value) => Gain::Constant(value),
                None => Gain::Linear { at_zero: numbers(value)[0], slope: numbers(value)[1] },
            };
        }
        signal
    });
    let bearing = usize::try_from(described["bearing"].as_u64().expect("a mass")).expect("small") - 1;
    let feedback = Feedback::new(bearing, signals.collect());
    feedback.check(n).expect("fits");
    (Rotor::new("chain", masses, list("shaft")).expect("valid"), feedback)
}

#[track_caller]
fn same_poles(ours: &[C64], theirs: &Value, tolerance: f64) {
    let theirs = theirs.as_array().expect("a list");
    assert_eq!(ours.len(), theirs.len());
    for their in theirs {
        let their = C64::new(numbers(their)[0], numbers(their)[1]);
        let distance = ours.iter().map(|our| (our - their).norm()).fold(f64::INFINITY, f64::min);
        assert!(distance < tolerance, "{their} is {distance:e} from {ours:?}");
    }
}

#[test]
fn val_poles_of_a_chain_are_scipys() {
    let reference = reference();
    let (rotor, feedback) = chain(&reference["chain"]);
    for at in reference["poles"].as_array().expect("by speed") {
        let speed = at["speed"].as_f64().expect("a number");
        let ours = poles(&ClosedLoop::new(&rotor, &feedback, speed, &[])).expect("converges");
        same_poles(&ours, &at["poles"], TOLERANCE);
    }
}

#[test]
fn val_a_trace_of_a_chain_passes_scipys_poles() {
    let reference = reference();
    let (rotor, feedback) = chain(&reference["chain"]);
    let known = reference["poles"].as_array().expect("by speed");
    let speeds: Vec<f64> = known.iter().map(|at| at["speed"].as_f64().expect("a number")).collect();
    let trace = trace(&rotor, &feedback, &speeds).expect("converges");
    for (i, at) in known.iter().enumerate() {
        let ours: Vec<C64> = trace.branches.iter().map(|b| b.poles[i]).collect();
        same_poles(&ours, &at["poles"], TOLERANCE);
    }
}

#[test]
fn val_thresholds_of_a_chain_are_scipys() {
    let reference = reference();
    let (rotor, feedback) = chain(&reference["chain"]);
    let ours = thresholds(&rotor, &feedback, 0.0, reference["to"].as_f64().expect("a number")).expect("converges");
    let theirs = reference["thresholds"].as_array().expect("a list");
    assert!(!theirs.is_empty());
    assert_eq!(ours.len(), theirs.len(), "{ours:?}");
    for (our, their) in ours.iter().zip(theirs) {
        let number = |field: &str| their[field].as_f64().expect("a number");
        assert!((our.speed - number("speed")).abs() < TOLERANCE, "{our:?} is not {their}");
        assert!((our.frequency - number("im").abs()).abs() < TOLERANCE, "{our:?} is not {their}");
        let becomes = if our.becomes == Stability::Stable { "stable" } else { "unstable" };
        assert_eq!(their["becomes"], becomes);
    }
}
