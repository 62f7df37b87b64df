//! Whole rotors beside ROSS, and beside what its authors' book prints.

use beam::{C64, Drawing, FullModel, import_ross};
use serde_json::Value;

const RAD_PER_S: f64 = std::f64::consts::PI / 30.0;

/// Every rotor of the cases that is the same in every direction.
const ISOTROPIC: [(&str, &str); 3] = [
    ("isotropic", include_str!("cases/isotropic.toml")),
    ("overhung_gyroscopic", include_str!("cases/overhung_gyroscopic.toml")),
    ("overhung_gyroscopic_seal", include_str!("cases/overhung_gyroscopic_seal.toml")),
];

fn rotor(text: &str) -> (Drawing, FullModel) {
    let (drawing, _) = import_ross(text, false).expect("a rotor");
    let full = drawing.full();
    (drawing, full)
}

fn numbers(value: &Value) -> Vec<(f64, Value)> {
    let map = value.as_object().expect("a table");
    map.iter().map(|(key, value)| (key.parse().expect("a speed"), value.clone())).collect()
}

fn complex(value: &Value) -> C64 {
    C64::new(value[0].as_f64().expect("a number"), value[1].as_f64().expect("a number"))
}

#[test]
fn val_the_eigenvalues_of_every_isotropic_rotor_at_every_speed_are_those_of_ross() {
    let expected: Value = serde_json::from_str(include_str!("cases/ross_eigenvalues.json")).expect("JSON");
    let mut compared = 0;
    let mut worst = 0.0_f64;
    for (name, text) in ISOTROPIC {
        let (_, full) = rotor(text);
        let case = &expected["rotors"][name];
        for (speed, of) in numbers(&case["speeds"]) {
            let ours = full.eigenvalues(speed).expect("eigenvalues");
            // The real equations have each of ours and its conjugate.
            let mut left: Vec<C64> = ours.iter().flat_map(|&pole| [pole, pole.conj()]).collect();
            for theirs in of["lateral_lowest_24"].as_array().expect("a list").iter().map(complex) {
                let distance = |pole: &C64| (pole - theirs).norm();
                let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
                let pole = left.swap_remove(nearest.expect("one is left"));
                let error = distance(&pole) / theirs.norm();
                worst = worst.max(error);
                assert!(error < 1e-8, "{name} at {speed} rad/s: {pole} is not {theirs}, by {error:e}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 3 * 4 * 24);
    assert!(worst < 1e-10, "as near as two programs get: {worst:e}");
}

#[test]
fn val_whirl_under_unbalance_is_that_of_ross() {
    let expected: Value = serde_json::from_str(include_str!("cases/unbalance_response.json")).expect("JSON");
    let mut compared = 0;
    for (name, text) in ISOTROPIC {
        let Some(points) = expected[name].as_array() else { continue };
        let (_, full) = rotor(text);
        let mut unbalance = vec![C64::ZERO; full.station_nodes.len()];
        unbalance[2] = C64::from(1e-3);
        for point in points {
            let number = |key: &str| point[key].as_f64().expect("a number");
            let whirl = full.response_to(&unbalance, number("speed")).expect("a response");
            for (node, key) in [(2, "radius_node2"), (0, "radius_node0")] {
                let radius = whirl[2 * node].norm();
                assert!((radius / number(key) - 1.0).abs() < 1e-6, "{name}: {radius} is not {point}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 16, "{compared}");
}

/// Friswell, Penny, Garvey and Lees, *Dynamics of Rotating Machines* (2010), example 5.9.1: as printed, in rad/s.
#[test]
fn val_the_frequencies_of_the_book_come_out() {
    let (_, full) = rotor(include_str!("cases/friswell_5_9_1.toml"));
    let at = |rpm: f64| {
        let poles = full.eigenvalues(rpm * RAD_PER_S).expect("eigenvalues");
        let mut frequencies: Vec<f64> = poles.iter().map(|pole| pole.im.abs()).collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies
    };
    for (rpm, printed) in
        [(0.0, [86.66, 86.66, 274.31, 274.31, 716.78]), (4000.0, [85.39, 87.80, 251.78, 294.71, 600.18])]
    {
        for (found, printed) in at(rpm).into_iter().zip(printed) {
            // The book has 716.78 where this element gives 716.787.
            assert!((found - printed).abs() < 0.0101, "{found} is not {printed} at {rpm} rpm");
        }
    }
}

/// Example 5.9.5, with dampers of 3 kN s/m: as ROSS has it, to the digits of the list in the cases.
#[test]
fn val_damped_bearings_of_the_book_come_out() {
    let (_, full) = rotor(include_str!("cases/friswell_5_9_5.toml"));
    for (rpm, expected) in [
        (0.0, [(-4.4238, 87.2579), (-78.2408, 292.4228), (-566.5404, 648.5814), (-657.3081, 834.7575)]),
        (4000.0, [(-4.7417, 88.4147), (-74.1018, -263.7864), (-78.8104, 318.2350), (-402.5909, -655.0120)]),
    ] {
        let poles = full.eigenvalues(rpm * RAD_PER_S).expect("eigenvalues");
        for (re, im) in expected {
            // Lists of ROSS are of real motion: each pole and its conjugate.
            let near = |pole: &C64| (pole.re - re).abs() < 1e-4 && (pole.im.abs() - f64::abs(im)).abs() < 1e-4;
            assert!(poles.iter().any(near), "{re} {im} at {rpm} rpm: {poles:?}");
        }
    }
}
