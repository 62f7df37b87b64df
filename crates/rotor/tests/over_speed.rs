//! Laws of traces and thresholds: branches do not depend on the grid, and no crossing is missed.

mod common;

use common::machine;
use proptest::prelude::*;
use rotor::{
    ClosedLoop, Feedback, Gain, GainKind, Mass, Rotor, Signal, Stability, builtin, critical_speeds, poles, thresholds,
    trace,
};

const TOP: f64 = 6.0;

fn even(count: u32) -> Vec<f64> {
    (0..count).map(|i| TOP * f64::from(i) / f64::from(count - 1)).collect()
}

fn growing(rotor: &Rotor, feedback: &Feedback, speed: f64) -> (i64, f64) {
    let poles = poles(&ClosedLoop::new(rotor, feedback, speed, &[])).expect("converges");
    let nearest = poles.iter().map(|p| p.re.abs()).fold(f64::INFINITY, f64::min);
    (poles.iter().filter(|p| p.re > 0.0).count() as i64, nearest)
}

/// Wherever no mode is on its threshold, the thresholds passed so far account for every growing mode.
fn accounts_for_every_growing_mode(rotor: &Rotor, feedback: &Feedback, from: f64, to: f64, samples: u32) {
    let found = thresholds(rotor, feedback, from, to).expect("converges");
    assert!(found.is_sorted_by(|a, b| a.speed <= b.speed));
    for t in &found {
        assert!((from..=to).contains(&t.speed));
        let poles = poles(&ClosedLoop::new(rotor, feedback, t.speed, &[])).expect("converges");
        let nearest = poles.iter().map(|p| p.re.abs() + (p.im.abs() - t.frequency).abs()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "no mode is on its threshold at {t:?}: {poles:?}");
    }
    let (at_first, _) = growing(rotor, feedback, from);
    for i in 1..=samples {
        let speed = from + (to - from) * f64::from(i) / f64::from(samples);
        let (expected, nearest) = growing(rotor, feedback, speed);
        // On a threshold, or on an undamped mode, rounding decides which side it is.
        if nearest < 1e-10 || found.iter().any(|t| (t.speed - speed).abs() < 1e-9) {
            continue;
        }
        let change: i64 = found
            .iter()
            .filter(|t| t.speed < speed)
            .map(|t| if t.becomes == Stability::Unstable { 1 } else { -1 })
            .sum();
        assert_eq!(at_first + change, expected, "at R = {speed}: {found:?} of {rotor:?} {feedback:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// A finer grid passes the same poles on the same branches.
    #[test]
    fn refining_a_trace_does_not_pair_anew((rotor, feedback) in machine(5), factor in 2u32..7) {
        let coarse = trace(&rotor, &feedback, &even(8)).expect("converges");
        let fine = trace(&rotor, &feedback, &even(7 * factor + 1)).expect("converges");
        for (k, (few, many)) in coarse.branches.iter().zip(&fine.branches).enumerate() {
            for (i, pole) in few.poles.iter().enumerate() {
                let same = many.poles[i * factor as usize];
                prop_assert!((pole - same).norm() < 1e-6, "branch {k} at point {i}: {pole} or {same}, {rotor:?} {feedback:?}");
            }
        }
    }

    /// At every speed the branches hold all poles, each once, and the least damping is that of the spectrum.
    #[test]
    fn a_trace_loses_no_pole((rotor, feedback) in machine(6)) {
        let speeds = even(9);
        let trace = trace(&rotor, &feedback, &speeds).expect("converges");
        for (at, &speed) in speeds.iter().enumerate() {
            let mut left = poles(&ClosedLoop::new(&rotor, &feedback, speed, &[])).expect("converges");
            prop_assert!((trace.min_damping()[at] - rotor::damping_ratio(left[0])).abs() < 1e-6);
            for branch in &trace.branches {
                let nearest = (0..left.len()).min_by(|&i, &j| (left[i] - branch.poles[at]).norm()
                    .total_cmp(&(left[j] - branch.poles[at]).norm())).expect("one each");
                prop_assert!((left.swap_remove(nearest) - branch.poles[at]).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn no_threshold_is_missed_with_the_certificate((rotor, feedback) in machine(4)) {
        accounts_for_every_growing_mode(&rotor, &feedback, 0.0, TOP, 300);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_threshold_is_missed_on_longer_rotors((rotor, feedback) in machine(9)) {
        accounts_for_every_growing_mode(&rotor, &feedback, 0.0, TOP, 300);
    }

    /// A critical speed lies on its line.
    #[test]
    fn critical_speeds_lie_on_their_lines((rotor, feedback) in machine(4)) {
        for c in critical_speeds(&rotor, &feedback, 0.1, TOP, &[0.5, 1.0]).expect("converges") {
            let poles = poles(&ClosedLoop::new(&rotor, &feedback, c.speed, &[])).expect("converges");
            prop_assert!(poles.iter().any(|p| (p - c.pole).norm() < 1e-6));
            prop_assert!((c.pole.im.abs() - c.order * c.speed).abs() < 1e-9);
        }
    }
}

fn single(mass: Mass, gain: Gain) -> (Rotor, Feedback) {
    let mut signal = Signal::at_mass(0, 1, [0.0; 4]);
    *signal.gain_mut(GainKind::Kc) = gain;
    (Rotor::new("one", vec![mass], vec![]).expect("valid"), Feedback::new(0, vec![signal]))
}

fn seal() -> Mass {
    Mass { mass: 1.0, damping: 0.5, cross_damping: 0.1, bearing_stiffness: 1.0, ..Mass::default() }
}

/// `kc` of this height lasts for a hundred-thousandth of the range: a mode that crosses twice between any two samples.
#[test]
fn a_mode_that_crosses_twice_in_a_blink_is_seen_twice() {
    let (at, half) = (1.234_567, 3e-5);
    let spike = Gain::Table(vec![(at - half, 0.0), (at, 2.0), (at + half, 0.0)]);
    for sign in [1.0, -1.0] {
        let gain = match &spike {
            Gain::Table(points) => Gain::Table(points.iter().map(|&(s, v)| (s, sign * v)).collect()),
            _ => unreachable!("it is a table"),
        };
        let (rotor, feedback) = single(seal(), gain);
        let found = thresholds(&rotor, &feedback, 0.0, 2.0).expect("converges");
        let becomes: Vec<_> = found.iter().map(|t| t.becomes).collect();
        assert_eq!(becomes, [Stability::Unstable, Stability::Stable], "{found:?}");
        assert!(found.iter().all(|t| (t.speed - at).abs() < half));
        accounts_for_every_growing_mode(&rotor, &feedback, at - 2.0 * half, at + 2.0 * half, 500);
    }
}

/// Two rotors that do not touch, as one: their thresholds lie a ten-millionth apart, or on each other.
#[test]
fn two_modes_that_cross_together_are_two_thresholds() {
    for apart in [1e-3, 1e-7, 0.0] {
        let other = Mass { mass: 2.0, bearing_stiffness: 2.0 * (1.0 + apart), ..seal() };
        let rotor = Rotor::new("two", vec![seal(), other], vec![0.0]).expect("valid");
        let feedback = builtin::feedback(&rotor, "off").expect("fits any");
        let found = thresholds(&rotor, &feedback, 0.0, 5.0).expect("converges");
        // One mass alone, from (3.25): Re = 0 at w = R / 2, R^2 / 4 - zeta_q R - k = 0.
        let alone = |k: f64| 2.0 * (0.1 + (0.01 + k).sqrt());
        let expected = [alone(1.0), alone(1.0 + apart)];
        assert_eq!(found.len(), 2, "{apart}: {found:?}");
        for (t, speed) in found.iter().zip(expected) {
            assert!((t.speed - speed).abs() < 1e-9, "{apart}: {t:?} is not at {speed}");
        }
    }
}

#[test]
fn an_end_of_the_range_on_a_threshold_counts() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let off = builtin::feedback(&rotor, "off").expect("built in");
    let exact = thresholds(&rotor, &off, 0.0, 5.0).expect("converges")[0].speed;
    for (from, to) in [(exact, 5.0), (0.0, exact)] {
        let found = thresholds(&rotor, &off, from, to).expect("converges");
        assert!(matches!(found[..], [t] if (t.speed - exact).abs() < 1e-12), "{from}..{to}: {found:?}");
    }
    assert!(thresholds(&rotor, &off, exact + 1e-9, 5.0).expect("converges").is_empty());
    assert!(thresholds(&rotor, &off, 0.0, exact - 1e-9).expect("converges").is_empty());
}

/// Nothing damps it and nothing drives it: on the threshold at every speed, so crossing it at none.
#[test]
fn a_rotor_without_seals_has_no_threshold() {
    for n in [1, 3, 7] {
        let mass = Mass { mass: 0.3, bearing_stiffness: 0.4, ..Mass::default() };
        let rotor = Rotor::new("plain", vec![mass; n], vec![0.5; n - 1]).expect("valid");
        let off = builtin::feedback(&rotor, "off").expect("fits any");
        assert_eq!(thresholds(&rotor, &off, 0.0, 5.0), Ok(vec![]));
    }
    // The cancelling law holds every pole still.
    let jeffcott = builtin::rotor("jeffcott").expect("built in");
    for reference in [0.0, 0.78, 2.0] {
        let feedback = rotor::cancelling(&jeffcott, reference).expect("one mass");
        assert_eq!(thresholds(&jeffcott, &feedback, 0.0, 50.0), Ok(vec![]));
    }
}

/// A seal in the middle, where the pitch mode has its node: one undamped mode among others that cross.
#[test]
fn an_undamped_mode_hides_no_crossing() {
    let end = Mass { mass: 0.25, bearing_stiffness: 0.5, ..Mass::default() };
    let centre = Mass { mass: 0.5, damping: 0.25, cross_damping: 0.05, ..Mass::default() };
    let rotor = Rotor::new("middle", vec![end, centre, end], vec![0.5, 0.5]).expect("valid");
    let off = builtin::feedback(&rotor, "off").expect("fits any");
    let found = thresholds(&rotor, &off, 0.0, 12.0).expect("converges");
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|t| (t.frequency / t.speed - 0.5).abs() < 1e-9), "whirl at half speed: {found:?}");
}

#[test]
fn a_backward_or_infinite_range_is_refused() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let off = builtin::feedback(&rotor, "off").expect("built in");
    for (from, to) in [(1.0, 1.0), (2.0, 1.0), (0.0, f64::INFINITY), (f64::NAN, 1.0)] {
        assert_eq!(thresholds(&rotor, &off, from, to), Err(rotor::TraceError::Speeds));
    }
    assert_eq!(trace(&rotor, &off, &[1.0, 0.5]), Err(rotor::TraceError::Speeds));
    assert_eq!(trace(&rotor, &off, &[]), Err(rotor::TraceError::Speeds));
    assert_eq!(trace(&rotor, &off, &[1.0]).expect("one speed is a trace").branches.len(), 2);
}

fn mass(damping: f64, cross_damping: f64, bearing_stiffness: f64) -> Mass {
    Mass { mass: 0.5, damping, cross_damping, bearing_stiffness, ..Mass::default() }
}

/// The second mass drives the first and not the other way round: double poles with one shape, and a table that moves none.
/// NumPy's eigenvalues on a grid of 1e-6 change sign at 2.071224 to 2.071225, both.
#[test]
fn val_coincident_poles_cross_together_whatever_the_gain_tables() {
    let rotor = Rotor::new("two", vec![mass(0.33, 0.035, 0.5); 2], vec![0.0]).expect("valid");
    let mut signal = Signal::at_mass(1, 2, [0.0; 4]);
    *signal.gain_mut(GainKind::Cc) = Gain::Table(vec![(1.6, 0.1), (3.6, 0.2)]);
    let feedback = Feedback::new(0, vec![signal]);
    // One mass alone: R = 2 (zeta_q + sqrt(zeta_q^2 + k / m)).
    let exact = 2.0 * (0.035 + (0.035_f64.powi(2) + 1.0).sqrt());
    let found = thresholds(&rotor, &feedback, 0.0, 8.0).expect("followed");
    assert!(matches!(found[..], [a, b] if (a.speed - exact).abs() < 1e-9 && a.speed == b.speed), "{found:?}");
}

#[test]
fn permanently_double_poles_are_two_branches_on_top_of_each_other() {
    let critical = Mass { mass: 1.0, damping: 1.0, bearing_stiffness: 1.0, ..Mass::default() };
    let rotor = Rotor::new("critical", vec![critical], vec![]).expect("valid");
    let held = rotor::cancelling(&rotor, 0.0).expect("one mass");
    let free = Rotor::new("free", vec![mass(0.0, 0.0, 0.0); 2], vec![0.5]).expect("valid");
    let off = builtin::feedback(&free, "off").expect("fits any");
    for (rotor, feedback, twin) in [(&rotor, &held, -1.0), (&free, &off, 0.0)] {
        let trace = trace(rotor, feedback, &even(101)).expect("followed");
        let twins = trace.branches.iter().filter(|b| b.poles.iter().all(|p| (p - twin).norm() < 1e-12)).count();
        assert_eq!(twins, 2, "{trace:?}");
        assert_eq!(thresholds(rotor, feedback, 0.0, 6.0), Ok(vec![]));
        for c in critical_speeds(rotor, feedback, 0.0, 6.0, &[0.5, 1.0]).expect("followed") {
            assert!(c.speed > 0.1 && c.pole.im.abs() > 0.1, "what does not whirl has no critical speed: {c:?}");
        }
    }
}

/// Gains that hold a mode on zero from 1 to 2: the end of that is a threshold, its beginning none.
#[test]
fn a_mode_that_rests_on_zero_is_listed_where_it_leaves_for_any_range() {
    let plain = Mass { mass: 1.0, bearing_stiffness: 1.0, ..Mass::default() };
    let rotor = Rotor::new("one", vec![plain], vec![]).expect("valid");
    for (before, after, becomes) in [
        (0.1, -0.1, Stability::Unstable),
        (0.1, 0.1, Stability::Stable),
        (-0.1, -0.1, Stability::Unstable),
        (-0.1, 0.1, Stability::Stable),
    ] {
        let mut signal = Signal::at_mass(0, 1, [0.0; 4]);
        *signal.gain_mut(GainKind::Cd) = Gain::Table(vec![(0.5, before), (1.0, 0.0), (2.0, 0.0), (3.0, after)]);
        let feedback = Feedback::new(0, vec![signal]);
        for (from, to) in [(0.0, 4.0), (0.7, 2.0), (1.0, 2.0), (1.5, 2.5), (2.0, 2.1), (1.999, 4.0)] {
            let found = thresholds(&rotor, &feedback, from, to).expect("followed");
            assert!(
                found.len() == 2 && found.iter().all(|t| t.speed == 2.0 && t.becomes == becomes),
                "{from}..{to}: {found:?}"
            );
        }
        for (from, to) in [(0.0, 1.0), (0.0, 1.5), (1.0, 1.9), (1.2, 1.8), (2.001, 3.0)] {
            assert_eq!(thresholds(&rotor, &feedback, from, to), Ok(vec![]), "{from}..{to}");
        }
    }
}

/// Free in space with seals: on zero at rest, and driven from the first turn on.
#[test]
fn a_mode_that_leaves_zero_at_rest_has_its_threshold_there() {
    let rotor = Rotor::new("free", vec![mass(0.1, 0.0, 0.0); 2], vec![0.5]).expect("valid");
    let off = builtin::feedback(&rotor, "off").expect("fits any");
    for from in [0.0, -1.0] {
        let found = thresholds(&rotor, &off, from, 6.0).expect("followed");
        assert!(found.len() == 2 && found[0].speed == 0.0 && found[0].frequency == 0.0, "{found:?}");
        assert!((found[1].speed - 8.0_f64.sqrt()).abs() < 1e-9, "{found:?}");
        let critical = critical_speeds(&rotor, &off, from, 6.0, &[0.5, 1.0]).expect("followed");
        assert!(critical.iter().all(|c| c.speed.abs() > 0.1), "{critical:?}");
    }
    assert_eq!(thresholds(&rotor, &off, 0.1, 1.0), Ok(vec![]));
}
