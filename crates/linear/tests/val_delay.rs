//! Roots of loops with delay beside SciPy's, found by another method (`tests/reference/delay.py`), and laws that hold for any.

use linear::{C64, DelayError, DelaySystem};
use nalgebra::DMatrix;
use proptest::prelude::*;
use serde_json::Value;

fn numbers(value: &Value) -> Vec<C64> {
    let part = |z: &Value, k: usize| z[k].as_f64().expect("a number");
    value.as_array().expect("a list").iter().map(|z| C64::new(part(z, 0), part(z, 1))).collect()
}

/// The loop of a case, with another delay if one is given.
fn system(case: &Value, delay: Option<f64>) -> DelaySystem {
    let rows: Vec<Vec<C64>> = case["a"].as_array().expect("rows").iter().map(numbers).collect();
    let n = rows.len();
    let a = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    let mut b = DMatrix::zeros(n, 1);
    b[case["bearing"].as_u64().expect("a row") as usize] = C64::ONE;
    let row = numbers(&case["row"]);
    let c = DMatrix::from_fn(1, n, |_, j| row[j]);
    DelaySystem::new(a, b, c, delay.unwrap_or_else(|| case["delay"].as_f64().expect("a number"))).expect("fits")
}

fn cases() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../tests/reference/delay.json")).expect("JSON")
}

fn named(name: &str) -> Value {
    cases().into_iter().find(|case| case["name"] == name).expect("a case of that name")
}

fn least_damping(roots: &[C64]) -> f64 {
    roots.iter().map(|s| -s.re / s.norm()).fold(f64::INFINITY, f64::min)
}

/// How far `found` is from `expected`, each taken once, relative to what is largest.
fn distance(found: &[C64], expected: &[C64]) -> f64 {
    assert_eq!(found.len(), expected.len(), "{found:?}\n{expected:?}");
    let size = expected.iter().map(|s| s.norm()).fold(1.0, f64::max);
    let mut left = found.to_vec();
    let mut worst = 0.0_f64;
    for root in expected {
        let nearest = |k: &usize| (left[*k] - root).norm();
        let k = (0..left.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b))).expect("as many");
        worst = worst.max(nearest(&k) / size);
        left.swap_remove(k);
    }
    worst
}

#[test]
fn val_scipy_finds_the_same_roots_and_no_more() {
    for case in cases() {
        let line = case["line"].as_f64().expect("a number");
        let found =
            system(&case, None).roots_right_of(line).unwrap_or_else(|error| panic!("{}: {error}", case["name"]));
        assert!(found.right_of <= line && found.right_of > line - 0.01 * line.abs());
        let off = distance(&found.roots, &numbers(&case["roots"]));
        assert!(off < 1e-10, "{}: off by {off:e}", case["name"]);
    }
}

/// The shaft of the loops that were called stable: its roots lie beyond `pi / delay`, and SciPy's simulation grows with the first.
#[test]
fn val_a_loop_that_grows_beyond_pi_over_the_delay_is_seen_to_grow() {
    let case = named("stiff shafts");
    let found = system(&case, None).roots_right_of(0.0).expect("counted");
    assert!(found.roots[0].re > 0.5 && found.roots[0].norm() > std::f64::consts::PI / 0.25, "{found:?}");
    let growth = case["growth"].as_f64().expect("a number");
    assert!((found.roots[0].re - growth).abs() < 0.05 * growth, "{} {growth}", found.roots[0]);
}

#[test]
fn val_damping_with_delay_is_that_of_the_table() {
    for (name, damping) in [("composite 2.5 0.02", 0.054_314_4), ("composite 6.0 0.02", 0.009_767_58)] {
        let loop_ = system(&named(name), None);
        let found = loop_.roots_right_of(loop_.echo_line()).expect("counted");
        assert!((least_damping(&found.roots) - damping).abs() < 5e-8, "{name}: {}", least_damping(&found.roots));
    }
    // The exact roots right of -2 / delay, as SciPy has them.
    for (name, damping) in [("individual 2.5 0.02", 0.079_787_7), ("individual 6.0 0.02", 0.040_645_7)] {
        let loop_ = system(&named(name), None);
        let found = loop_.roots_right_of(loop_.echo_line()).expect("counted");
        assert!((least_damping(&found.roots) - damping).abs() < 5e-8, "{name}: {}", least_damping(&found.roots));
    }
}

#[test]
fn val_delay_margins_are_those_of_the_table_and_put_a_root_on_the_axis() {
    for (name, delay, frequency) in [
        ("composite 2.5 0.02", 0.615_245, 2.459_5),
        ("composite 6.0 0.02", 0.112_792, 2.215_8),
        ("individual 2.5 0.02", 0.257_659, 3.711_4),
        ("individual 6.0 0.02", 0.232_233, 3.730_9),
    ] {
        let case = named(name);
        let margin = system(&case, None).delay_margin().expect("one loop").expect("a margin");
        assert!((margin.delay - delay).abs() < 1e-6, "{name}: {margin:?}");
        assert!((margin.frequency - frequency).abs() < 5e-5, "{name}: {margin:?}");
        let unstable = |by: f64| system(&case, Some(margin.delay * by)).count_right_of(0.0).expect("counted");
        assert_eq!((unstable(0.999), unstable(1.001)), (0, 1), "{name}");
    }
}

#[test]
fn without_delay_all_roots_are_eigenvalues_and_a_short_delay_hardly_moves_them() {
    let case = named("composite 6.0 0.02");
    let at = |delay: f64| {
        let loop_ = system(&case, Some(delay));
        loop_.roots_right_of(loop_.echo_line().max(-100.0)).expect("counted").roots
    };
    let free = system(&case, Some(0.0)).roots_right_of(f64::NEG_INFINITY).expect("eigenvalues").roots;
    assert_eq!(free.len(), 6);
    assert!(distance(&at(1e-9), &free) < 1e-8);
    assert!(distance(&at(0.0), &free) < 1e-14);
    assert!(distance(&at(1e-5), &free) < 1e-4);
}

/// `s = -exp(-1) exp(-s)` has the double root -1; two such loops side by side have it four times.
#[test]
fn roots_that_are_several_are_found_as_often_as_they_are() {
    for (size, times) in [(1, 2_u8), (2, 4)] {
        let one = DMatrix::identity(size, size);
        let loop_ = DelaySystem::new(DMatrix::zeros(size, size), one.clone(), one * C64::from(-(-1.0_f64).exp()), 1.0);
        let found = loop_.expect("fits").roots_right_of(-1.5).expect("counted");
        assert_eq!(found.roots.len(), usize::from(times), "{found:?}");
        // Rounding moves a root that is there four times by its own fourth root.
        let rounding = f64::EPSILON.powf(1.0 / f64::from(times));
        assert!(found.roots.iter().all(|s| (s + 1.0).norm() < rounding), "{found:?}");
    }
}

#[test]
fn a_line_through_a_root_is_moved_and_said() {
    // s = -pi/2 exp(-s): the roots of least size are +-j pi/2, on the axis.
    let one = |x: f64| DMatrix::from_element(1, 1, C64::from(x));
    let loop_ = DelaySystem::new(one(0.0), one(1.0), one(-std::f64::consts::FRAC_PI_2), 1.0).expect("fits");
    let found = loop_.roots_right_of(0.0).expect("moved");
    assert!(found.right_of < 0.0 && found.right_of > -1e-2 && found.roots.len() == 2, "{found:?}");
    assert!(loop_.count_right_of(0.0).is_err());
    assert_eq!(loop_.count_right_of(0.1), Ok(0));
}

#[test]
fn what_cannot_be_counted_is_refused() {
    let one = |x: f64| DMatrix::from_element(1, 1, C64::from(x));
    let make = |delay: f64| DelaySystem::new(one(1.0), one(1.0), one(2.0), delay);
    assert!(matches!(make(-1.0), Err(DelayError::Delay(_))));
    assert!(matches!(make(f64::NAN), Err(DelayError::Delay(_))));
    assert!(matches!(make(1.0).expect("fits").roots_right_of(f64::NEG_INFINITY), Err(DelayError::Line(_))));
    assert!(matches!(make(1e9).expect("fits").roots_right_of(-2e-9), Err(DelayError::TooMany { .. })));
    let wide = DelaySystem::new(one(1.0), DMatrix::zeros(2, 1), one(2.0), 1.0);
    assert!(matches!(wide, Err(DelayError::Shape { .. })));
    assert_eq!(DelaySystem::new(one(f64::NAN), one(1.0), one(2.0), 1.0), Err(DelayError::NotFinite));
}

fn matrix(rows: usize, columns: usize, values: &[f64]) -> DMatrix<C64> {
    DMatrix::from_fn(rows, columns, |i, j| {
        let k = (i * columns + j) * 2 % (values.len() - 1);
        C64::new(values[k], values[k + 1])
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Roots solve the equation, are as many as are counted right of another line, and move as their vectors say.
    #[test]
    fn roots_are_roots_all_of_them_and_move_as_said(
        values in prop::collection::vec(-1.0..1.0f64, 60),
        size in 1usize..5,
        loops in 1usize..3,
        gain in 0.1..5.0f64,
        delay in prop_oneof![0.001..0.1f64, 0.1..3.0f64, 3.0..30.0f64],
    ) {
        let (a, b) = (matrix(size, size, &values[..40]), matrix(size, loops, &values[3..50]));
        let c = matrix(loops, size, &values[7..60]) * C64::from(gain);
        let made = DelaySystem::new(a.clone(), b.clone(), c.clone(), delay).expect("fits");
        let found = made.roots_right_of(made.echo_line());
        prop_assert!(found.is_ok(), "{found:?}");
        let found = found.expect("ok");
        let half = 0.5 * made.echo_line();
        if let Ok(count) = made.count_right_of(half) {
            prop_assert_eq!(count, found.roots.iter().filter(|s| s.re > half).count());
        }
        for &s in found.roots.iter().take(6) {
            let m = DMatrix::<C64>::identity(size, size) * s - &a - &b * &c * (-s * delay).exp();
            let least = m.clone().singular_values().min();
            prop_assert!(least < 1e-8 * (1.0 + m.norm()), "{s}: {least:e}");
            let Some(at) = made.sensitivity(s) else { continue };
            let apart = found.roots.iter().map(|r| (r - s).norm()).filter(|d| *d > 0.0).fold(1.0, f64::min);
            if at.give.norm() < 1e-2 || apart < 0.05 {
                continue;
            }
            let h = 1e-6;
            let mut moved = a.clone();
            moved[(0, size - 1)] += C64::from(h);
            let near = DelaySystem::new(moved, b.clone(), c.clone(), delay).expect("fits");
            let there = near.roots_from(made.echo_line(), &found.roots).expect("counted").roots;
            let step = there.iter().map(|r| r - s).min_by(|x, y| x.norm().total_cmp(&y.norm()));
            let slope = at.left[0] * at.right[size - 1] / at.give;
            if let Some(step) = step && s.re > half {
                prop_assert!((step / h - slope).norm() < 1e-2 * (1.0 + slope.norm()), "{} {slope}", step / h);
            }
        }
    }
}
