//! Peaks of the sensitivity beside SciPy's (`tests/reference/sensitivity_peak.py`), and laws of what is proven of them.

use linear::{AffineTerm, C64, DelayError, DelaySystem, LoopGain, PeakProof};
use nalgebra::DMatrix;
use proptest::prelude::*;
use serde_json::Value;

/// How far above what was found a bound over stretches of the axis is.
const TOLERANCE: f64 = 1e-3;

fn matrix(value: &Value) -> DMatrix<C64> {
    let rows = value.as_array().expect("rows");
    let number = |z: &Value, k: usize| z[k].as_f64().expect("a number");
    let columns = rows[0].as_array().expect("numbers").len();
    DMatrix::from_fn(rows.len(), columns, |i, j| C64::new(number(&rows[i][j], 0), number(&rows[i][j], 1)))
}

fn system(case: &Value) -> DelaySystem {
    let [a, b, c] = ["a", "b", "c"].map(|name| matrix(&case[name]));
    DelaySystem::new(a, b, c, case["delay"].as_f64().expect("a number")).expect("fits")
}

#[test]
fn val_scipy_finds_the_same_peaks_and_none_above_what_is_proven() {
    let cases: Vec<Value> =
        serde_json::from_str(include_str!("../../../tests/reference/sensitivity_peak.json")).expect("JSON");
    assert!(cases.len() > 20);
    for case in &cases {
        let (name, expected) = (&case["name"], case["peak"].as_f64().expect("a number"));
        let system = system(case);
        let found = system.certified_peak(TOLERANCE).unwrap_or_else(|error| panic!("{name}: {error}"));
        let within = if system.delay() == 0.0 { 1e-7 } else { 1e-6 };
        assert!((found.amplitude / expected - 1.0).abs() < within, "{name}: {found:?}, {expected}");
        assert!(expected <= found.below && found.amplitude <= found.below, "{name}: {found:?}, {expected}");
        assert!(found.below <= found.amplitude * (1.0 + TOLERANCE), "{name}: {found:?}");
        let apart = found.frequency.expect("a peak") - case["frequency"].as_f64().expect("a number");
        assert!(apart.abs() < 1e-3, "{name}: {found:?}");
        let proof = if system.delay() == 0.0 { PeakProof::Hamiltonian } else { PeakProof::Covered };
        assert_eq!(found.proof, proof, "{name}");
        // Both ways where both go.
        let covered = system.covered_peak(&[], 1.0, TOLERANCE, 400_000, &|| false).expect("fits").expect("a bound");
        assert!(expected <= covered.2 && (covered.0 / expected - 1.0).abs() < 1e-6, "{name}: {covered:?}");
        // Beside the peak of one loop's margins, which is found on a curve.
        if system.b().ncols() == 1 {
            let on_curve = LoopGain::of(&system).expect("a loop").margins().sensitivity().amplitude;
            assert!((on_curve / found.amplitude - 1.0).abs() < 1e-6, "{name}: {on_curve} {found:?}");
        }
    }
}

#[test]
fn val_a_loop_of_one_state_has_the_peak_of_its_formula() {
    // S = (s + a) / (s + a + k) is largest far out; with k < 0 at rest, a / (a + k).
    let one = |number: f64| DMatrix::from_element(1, 1, C64::from(number));
    let of = |a: f64, k: f64| DelaySystem::new(one(-a), one(1.0), one(-k), 0.0).expect("fits");
    let far = of(1.0, 2.0).certified_peak(TOLERANCE).expect("a bound");
    assert!(far.amplitude == 1.0 && far.frequency.is_none() && far.below < 1.0 + 2e-6, "{far:?}");
    let near = of(1.0, -0.75).certified_peak(TOLERANCE).expect("a bound");
    assert!((near.amplitude - 4.0).abs() < 1e-7 && near.frequency.expect("one").abs() < 1e-3, "{near:?}");
    // s = -(a + k) = 0: a pole on the axis has no bound.
    assert_eq!(of(1.0, -1.0).certified_peak(TOLERANCE), Err(DelayError::NoBound));
}

/// Some loop, its states damped so that little is on the axis.
fn any_loop(n: usize, m: usize, delay: f64, numbers: &[f64]) -> DelaySystem {
    let mut next = numbers.iter().copied().cycle();
    let mut z = |size: f64| C64::new(next.next().unwrap_or(0.0), next.next().unwrap_or(0.0)) * size;
    let mut a = DMatrix::from_fn(n, n, |_, _| z(1.0));
    (0..n).for_each(|i| a[(i, i)] -= C64::from(1.0 + i as f64));
    let b = DMatrix::from_fn(n, m, |_, _| z(1.0));
    let c = DMatrix::from_fn(m, n, |_, _| z(0.6));
    DelaySystem::new(a, b, c, delay).expect("fits")
}

/// The largest singular value of `S` at a frequency.
fn sensitivity(system: &DelaySystem, w: f64) -> f64 {
    let s = C64::new(0.0, w);
    let mut m = -system.a().clone();
    (0..m.nrows()).for_each(|i| m[(i, i)] += s);
    let h = system.c() * m.lu().solve(system.b()).expect("no pole there") * (-s * system.delay()).exp();
    let loops = h.nrows();
    let s = (DMatrix::identity(loops, loops) - h).try_inverse().expect("no root there");
    s.singular_values().max()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn no_frequency_exceeds_what_is_proven(
        numbers in prop::collection::vec(-1.0..1.0f64, 67),
        n in 1..6usize,
        m in 1..3usize,
        delay in prop_oneof![Just(0.0), 0.02..0.5f64],
    ) {
        let system = any_loop(n, m, delay, &numbers);
        let Ok(found) = system.certified_peak(TOLERANCE) else { return Ok(()) };
        for k in -2000..=2000 {
            let w = 20.0 * (f64::from(k) / 2000.0).powi(3);
            let here = sensitivity(&system, w);
            prop_assert!(here <= found.below * (1.0 + 1e-9), "{here} at {w}: {found:?}");
        }
        if let Some(w) = found.frequency {
            prop_assert!((sensitivity(&system, w) / found.amplitude - 1.0).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn no_parameters_within_reach_exceed_what_is_proven(
        numbers in prop::collection::vec(-1.0..1.0f64, 67),
        reach in 0.05..0.3f64,
        delay in prop_oneof![Just(0.0), 0.02..0.2f64],
    ) {
        let system = any_loop(4, 1, delay, &numbers);
        let way = DMatrix::from_fn(4, 4, |i, j| C64::from(numbers[(5 * i + j) % 60]));
        let along = [AffineTerm { a: way.clone(), reach }];
        let Some((amplitude, at, below)) = system.covered_peak(&along, 1.0, 0.02, 200_000, &|| false).expect("fits") else {
            return Ok(());
        };
        let moved = |t: f64| {
            DelaySystem::new(system.a() + &way * C64::from(t), system.b().clone(), system.c().clone(), delay).expect("fits")
        };
        for k in -10..=10 {
            let there = moved(reach * f64::from(k) / 10.0);
            for step in -200..=200 {
                let here = sensitivity(&there, 12.0 * (f64::from(step) / 200.0).powi(3));
                prop_assert!(here <= below * (1.0 + 1e-9), "{here} {below}");
            }
        }
        if let Some(at) = at {
            prop_assert!((sensitivity(&moved(at[1]), at[0]) / amplitude - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn a_direction_that_does_not_fit_is_refused_and_a_budget_that_is_spent_gives_nothing() {
    let system = any_loop(3, 1, 0.1, &[0.3, -0.7, 0.9, 0.2, -0.4]);
    let wrong = [AffineTerm { a: DMatrix::zeros(2, 3), reach: 1.0 }];
    assert_eq!(
        system.covered_peak(&wrong, 1.0, TOLERANCE, 100, &|| false),
        Err(DelayError::Direction { rows: 2, columns: 3, expected: 3 })
    );
    assert_eq!(system.covered_peak(&[], 1.0, 1e-9, 5, &|| false), Ok(None));
    assert_eq!(system.covered_peak(&[], 1.0, TOLERANCE, 1000, &|| true), Ok(None));
}
