//! Slopes against values computed in 50 digits (`tests/reference/sensitivities.py`), and against differences of the very margins that
//! they are slopes of.

use machine::{CountedModes, WORST, in_hand, margins};
use rotor::{C64, Rotor, Settings, builtin};
use serde_json::Value;
use variation::{Model, NoSlope, Parameter, damping_sensitivities, sensitivities};

fn built_in(rotor: &str, feedback: &str, speed: f64) -> Model {
    let rotor = builtin::rotor(rotor).expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    let settings = Settings::new(&rotor, speed, feedback);
    Model::new(rotor, settings)
}

fn with(mut model: Model, parts: &[(&str, f64)]) -> Model {
    for (key, value) in parts {
        let key = model.settings.key(key).expect("a key");
        model.settings.set(key, *value).expect("in range");
    }
    model
}

#[test]
fn val_slopes_of_damping_are_those_of_fifty_digits() {
    let cases: Vec<Value> =
        serde_json::from_str(include_str!("../../../tests/reference/sensitivities.json")).expect("JSON");
    assert_eq!(cases.len(), 3);
    for case in &cases {
        let name = case["name"].as_str().expect("a name");
        let mut model = built_in("three-mass", if name == "individual" { name } else { "composite" }, 6.0);
        for (key, value) in case["parts"].as_object().expect("parts") {
            model = with(model, &[(key, value.as_f64().expect("a number"))]);
        }
        let slopes = case["slopes"].as_object().expect("slopes");
        let parameters: Vec<Parameter> = slopes.keys().map(|key| model.parameter(key).expect("a parameter")).collect();
        let found = damping_sensitivities(&model, &parameters).expect("poles");
        let number = |value: &Value| value.as_f64().expect("a number");
        assert!((found.min_damping - number(&case["min_damping"])).abs() < 1e-13, "{name}");
        let pole = C64::new(number(&case["pole"][0]), number(&case["pole"][1]));
        assert!(found.modes.len() == 1 && (found.modes[0] - pole).norm() < 1e-12, "{name}");
        for (of, expected) in found.each.iter().zip(slopes.values()) {
            let slope = of.min_damping.clone().expect("a slope").one().expect("one mode");
            let error = (slope - number(expected)).abs();
            assert!(error < 1e-9 * (1.0 + number(expected).abs()), "{name} {}: {slope} {expected}", of.parameter);
        }
    }
}

/// Differences of what is told at machines that are a little different, over a step that suits its rounding.
fn differences(model: &Model, parameter: &Parameter, h: f64) -> ([f64; WORST.len()], f64) {
    let at = |value: f64| {
        let other = model.with(&[(parameter, value)]).expect("allowed");
        margins(&other.rotor, &other.settings, other.settings.speed).expect("stable")
    };
    let value = model.value(parameter);
    let (above, below) = (at(value + h), at(value - h));
    let slope = |kind: usize| match (in_hand(kind, &above), in_hand(kind, &below)) {
        // What is larger when it is worse is told turned.
        (Some(a), Some(b)) => (a - b) / (2.0 * h) * if matches!(kind, 2 | 4..) { -1.0 } else { 1.0 },
        _ => f64::NAN,
    };
    let [above, below] = [&above, &below].map(|found| CountedModes::ALL.min_damping(found.poles.iter().copied()));
    (std::array::from_fn(slope), (above - below) / (2.0 * h))
}

fn margins_agree(model: &Model, names: &[&str], [step, close]: [f64; 2]) {
    let parameters: Vec<Parameter> = names.iter().map(|name| model.parameter(name).expect("a parameter")).collect();
    let found = sensitivities(model, &parameters).expect("stable");
    for of in &found.each {
        let h = step * of.value.abs();
        let (slopes, damping) = differences(model, &of.parameter, h);
        let own = of.min_damping.clone().expect("a slope").one().expect("one mode");
        assert!(
            (own - damping).abs() < close * (damping.abs() + 1e-2 / of.value.abs()),
            "{}: {own} {damping}",
            of.parameter
        );
        for (kind, (own, difference)) in of.margins.iter().zip(slopes).enumerate() {
            match own {
                None => assert!(difference.is_nan() || kind == 5, "{} of {}", WORST[kind], of.parameter),
                Some(own) => {
                    let error = (own - difference).abs();
                    assert!(
                        error < close * (difference.abs() + 0.1 / of.value.abs()),
                        "{} of {}: {own} {difference}",
                        WORST[kind],
                        of.parameter
                    );
                }
            }
        }
    }
}

const CHAIN: [&str; 9] =
    ["mass.1", "mass.2", "damping.3", "cross_damping.1", "bearing_stiffness.3", "shaft.2", "kd", "cc", "speed"];

#[test]
fn val_slopes_of_margins_are_differences_of_margins() {
    margins_agree(&built_in("three-mass", "composite", 6.0), &CHAIN, [1e-4; 2]);
    let loops = with(built_in("three-mass", "composite", 6.0), &[("delay", 0.02), ("lag", 0.02), ("sensor_lag", 0.01)]);
    margins_agree(&loops, &[&CHAIN[..], &["delay", "lag", "sensor_lag", "gain"]].concat(), [1e-4, 3e-4]);
}

#[test]
fn val_slopes_of_a_sampled_loop_are_differences() {
    let sampled = with(built_in("three-mass", "composite", 6.0), &[("sample", 0.05), ("delay", 0.02)]);
    let names = ["mass.1", "damping.3", "kd", "cc", "gain", "speed", "delay", "sample"];
    margins_agree(&sampled, &names, [1e-4, 3e-4]);
}

#[test]
fn val_slopes_of_several_bearings_and_shaft_elements_are_differences() {
    let rig = built_in("rig", "own", 1.0);
    let names: Vec<String> = rig.parameters().iter().map(|of| of.name().to_owned()).collect();
    for wanted in ["left.gain", "right.kd", "filter.1.corner", "disc.1.mass", "magnetic.1.negative_stiffness"] {
        assert!(names.iter().any(|name| name == wanted) || wanted.starts_with("filter"), "{wanted} in {names:?}");
    }
    // Two bearings that are nearly alike: a large step changes which of them is the worse.
    margins_agree(&rig, &["left.gain", "right.kd"], [1e-3, 1e-2]);
    // The reduced rotor knows no more than five digits of a slow gain.
    margins_agree(&rig, &["disc.1.mass", "disc.1.polar_inertia"], [1e-2; 2]);
    margins_agree(&rig, &["magnetic.1.negative_stiffness"], [1e-3, 5e-2]);
}

#[test]
fn modes_that_share_the_smallest_damping_give_two_slopes() {
    // Two masses that nothing joins, one twice as fast and twice as damped as the other: the least is that of both.
    let mass = |damping, stiffness| {
        let seal_stiffness = 0.5 * stiffness;
        rotor::Mass { mass: 0.5, damping, seal_stiffness, ..rotor::Mass::default() }
    };
    let free = |masses| {
        let rotor = Rotor::new("twins", masses, vec![0.0]).expect("valid");
        let feedback = builtin::feedback(&rotor, "off").expect("any rotor has it");
        let settings = Settings::new(&rotor, 0.0, feedback);
        let model = Model::new(rotor, settings);
        let parameters = [model.parameter("damping.1").expect("a parameter")];
        damping_sensitivities(&model, &parameters).expect("poles")
    };
    let found = free(vec![mass(0.1, 1.0), mass(0.05, 0.25)]);
    let slope = found.each[0].min_damping.clone().expect("slopes");
    assert!(found.modes.len() == 4 && slope.one().is_none(), "{slope:?}");
    // With less of it the damping falls one for one, with more the other mass keeps it where it is.
    assert!((slope.down - 1.0).abs() < 1e-9 && slope.up.abs() < 1e-9, "{slope:?}");
    // Two that are alike have poles that are two in one.
    assert_eq!(free(vec![mass(0.1, 1.0); 2]).each[0].min_damping, Err(NoSlope::Several));
}

#[test]
fn a_pole_at_the_origin_has_no_slope() {
    let mass = rotor::Mass { mass: 1.0, damping: 0.1, ..rotor::Mass::default() };
    let rotor = Rotor::new("free", vec![mass], vec![]).expect("valid");
    let feedback = builtin::feedback(&rotor, "off").expect("any rotor has it");
    let settings = Settings::new(&rotor, 0.0, feedback);
    let model = Model::new(rotor, settings);
    let found = damping_sensitivities(&model, &[model.parameter("damping.1").expect("a parameter")]).expect("poles");
    assert_eq!(found.each[0].min_damping, Err(NoSlope::Origin));
}

/// Of a shaft the slope is that of the least damped mode that counts, where its fastest modes are less damped; and the smallest damping of a
/// machine a little different moves by it.
#[test]
fn val_slopes_of_a_shaft_are_of_the_modes_that_count() {
    let counted = CountedModes::up_to(15.0);
    let [all, some] = [CountedModes::ALL, counted].map(|modes| built_in("rig", "own", 2.5).counting(modes));
    let poles: Vec<C64> = all.poles().expect("poles").modes.iter().map(|mode| mode.pole).collect();
    let [all_damping, damping] = [&all, &some].map(|model| model.min_damping().expect("poles"));
    assert!((damping - counted.min_damping(poles.iter().copied())).abs() < 1e-12);
    assert!(all_damping < 0.5 * damping, "{all_damping} of all, {damping} of those that count");
    for name in ["left.kd", "right.kd", "material.1.density"] {
        let parameter = some.parameter(name).expect("there");
        let found = damping_sensitivities(&some, std::slice::from_ref(&parameter)).expect("poles");
        assert!((found.min_damping - damping).abs() < 1e-12);
        let slope = found.each[0].min_damping.clone().expect("a slope").one().expect("one mode");
        let value = some.value(&parameter);
        // Rounding of the poles of a shaft is felt in smaller steps.
        let h = 1e-2 * value;
        let at = |value: f64| some.with(&[(&parameter, value)]).expect("allowed").min_damping().expect("poles");
        let difference = (at(value + h) - at(value - h)) / (2.0 * h);
        let error = (slope - difference).abs();
        assert!(error < 2e-3 * slope.abs().max(difference.abs()), "{name}: {slope} and {difference}");
    }
}
