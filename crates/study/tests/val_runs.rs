//! Runs and sweeps against exact circular whirl, the report's numbers, and laws.

use std::sync::atomic::AtomicBool;

use proptest::prelude::*;
use rotor::circular::synchronous;
use rotor::{C64, ControlBearing, Feedback, Mass, Rotor, Signal, builtin};
use study::force::{steady, sweep};
use study::run::{Impulse, Outcome, Plan, RunError, Settle, Settled, run};

fn machine(rotor: &str, feedback: &str) -> (Rotor, Feedback) {
    let rotor = builtin::rotor(rotor).expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    (rotor, feedback)
}

/// A rotor under its feedback at a speed, with its clearances.
type Case<'a> = (&'a Rotor, &'a Feedback, f64, &'a [f64]);

fn plan((rotor, feedback, speed, clearances): Case<'_>, duration: f64, settle: Settle) -> Plan {
    Plan::steady(rotor, feedback, speed, clearances, duration, settle).expect("can be stepped")
}

fn go(plan: &Plan) -> Outcome {
    run(plan, &mut [], &AtomicBool::new(false)).expect("runs")
}

#[test]
fn val_steady_force_over_speed_is_the_exact_one_where_the_orbit_is_circular() {
    let (rotor, feedback) = machine("jeffcott", "cancel");
    let speeds = [0.0, 0.5, 1.0, 2.0, 3.5, 5.0];
    let deadbands = [0.0, 1.0, 10.0];
    let clearances = deadbands.map(|deadband| vec![deadband; rotor.len()]);
    let points = sweep(&rotor, &feedback, &speeds, &clearances, &AtomicBool::new(false), &|| ()).expect("sweeps");
    for (deadband, row) in deadbands.iter().zip(&points) {
        let exact = synchronous(&rotor, &feedback, &[*deadband], &speeds).expect("solved");
        for (i, point) in row.iter().enumerate() {
            let [orbit] = &exact.orbits[i][..] else { panic!("one orbit: {:?}", exact.orbits[i]) };
            assert_eq!(point.settled, Settled::Steady, "R = {}, g = {deadband}", speeds[i]);
            // The step is chosen for a relative error of 5e-8 a radian.
            assert!((point.max_force - orbit.force).abs() <= 2e-7 * orbit.force, "{point:?} for {}", orbit.force);
        }
    }
    for (row, printed) in points.iter().zip([2.655_371, 2.572_277, 2.569_950]) {
        assert!((row[5].max_force - printed).abs() < 1e-6, "{} for {printed}", row[5].max_force);
    }
}

#[test]
fn val_three_mass_settles_on_its_stable_circular_orbits() {
    let (rotor, feedback) = machine("three-mass", "individual");
    for (speed, deadband) in [(1.5, 0.0), (2.25, 1.0), (4.0, 1.0), (6.5, 1.0)] {
        let exact = synchronous(&rotor, &feedback, &[deadband; 3], &[speed]).expect("solved");
        let [orbit] = &exact.orbits[0][..] else { panic!("one orbit") };
        assert!(orbit.is_stable());
        let point =
            steady(&rotor, &feedback, speed, &vec![deadband; rotor.len()], &AtomicBool::new(false)).expect("runs");
        assert_eq!(point.settled, Settled::Steady, "R = {speed}");
        // Near resonance the orbit answers to the step's 5e-8 a radian some fifty times over.
        assert!((point.max_force - orbit.force).abs() < 5e-6 * orbit.force, "{point:?} for {}", orbit.force);
        let case = (&rotor, &feedback, speed, &[deadband; 3][..]);
        let fine = go(&Plan { dtau: 0.004, ..plan(case, 1200.0, Settle::DetectAndStop) });
        assert!((fine.max_force - orbit.force).abs() < 1e-8 * orbit.force, "{fine:?} for {}", orbit.force);
        for (max, radius) in fine.max_displacement.iter().zip(orbit.radii()) {
            assert!((max - radius).abs() < 1e-8 * (1.0 + radius), "{max} for {radius} at R = {speed}");
        }
    }
}

#[test]
fn val_impulse_forces_reconstruct_the_reports() {
    let (rotor, feedback) = machine("jeffcott", "cancel");
    for (deadband, force) in [(0.0, 9.367), (1.0, 9.684), (10.0, 11.415)] {
        let mut plan = plan((&rotor, &feedback, 5.0, &[deadband]), 40.0, Settle::From(0.0));
        plan.impulses.push(Impulse { mass: 0, change: C64::new(-2.5, 0.0), at: 0.0 });
        let found = go(&plan).max_force_component;
        assert!((found - force).abs() < 6e-4, "{found} for {force}");
    }
}

#[test]
fn val_a_limit_cycle_under_unbalance_beats_and_says_so() {
    // Exact cycle at 0.7863 rad per tau, 4.279 e_t wide, beside the unbalance: the two beat.
    let (rotor, feedback) = machine("three-mass", "composite");
    let outcome = go(&plan((&rotor, &feedback, 6.0, &[1.0; 3]), 1500.0, Settle::DetectAndStop));
    assert_eq!(outcome.settled, Settled::Beating, "{outcome:?}");
    let widest = outcome.max_displacement.iter().copied().fold(0.0, f64::max);
    assert!((3.0..8.0).contains(&widest), "{widest}");
}

#[test]
fn a_diverging_run_says_when_and_keeps_what_it_has() {
    let (rotor, feedback) = machine("three-mass", "off");
    let mut plan = plan((&rotor, &feedback, 2.5, &[0.0; 3]), 5000.0, Settle::Detect);
    plan.impulses.push(Impulse { mass: 1, change: C64::new(1.0, 0.0), at: 0.0 });
    let outcome = go(&plan);
    let at = outcome.diverged_at.expect("unstable");
    assert!(at < 500.0 && outcome.last.tau == at && outcome.settled == Settled::No, "{outcome:?}");
    assert!(outcome.max_displacement.iter().all(|r| r.is_finite() && *r > 0.0));
}

#[test]
fn a_run_stops_when_asked_and_refuses_to_take_for_ever() {
    let (rotor, feedback) = machine("jeffcott", "cancel");
    let mut plan = plan((&rotor, &feedback, 1.0, &[]), 100.0, Settle::Detect);
    assert!(matches!(run(&plan, &mut [], &AtomicBool::new(true)), Err(RunError::Interrupted)));
    plan.duration = 1e300;
    assert!(matches!(run(&plan, &mut [], &AtomicBool::new(false)), Err(RunError::TooLong(_))));
}

fn balanced() -> impl Strategy<Value = (Rotor, Feedback)> {
    (1usize..=4, prop::collection::vec((0.2..1.0, 0.1..0.5, 0.1..0.8, 0.0..0.4), 4), 0.1..0.9).prop_map(
        |(n, masses, shaft)| {
            let masses = masses[..n].iter().map(|&(mass, damping, bearing_stiffness, seal_stiffness)| Mass {
                mass,
                damping,
                bearing_stiffness,
                seal_stiffness,
                ..Mass::default()
            });
            let rotor = Rotor::new("balanced", masses.collect(), vec![shaft; n - 1]).expect("valid");
            let signal = Signal::at_mass(0, n, [0.1, 0.2, -0.1, 0.05]);
            (rotor, Feedback::new(n - 1, vec![signal]))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Without unbalance and deadband the rotor is linear: twice the impulse, twice the peak.
    #[test]
    fn the_peak_of_an_impulse_scales_with_it((rotor, feedback) in balanced(), speed in 0.0..2.0, scale in 0.1..50.0, angle in 0.0..6.0) {
        let after = |size: f64| {
            let mut plan = plan((&rotor, &feedback, speed, &[]), 30.0, Settle::From(0.0));
            plan.impulses.push(Impulse { mass: 0, change: C64::from_polar(size, angle), at: 3.0 });
            go(&plan)
        };
        let (once, scaled) = (after(1.0), after(scale));
        prop_assert!(once.max_displacement[0] > 0.0);
        for (a, b) in once.max_displacement.iter().chain([&once.max_force]).zip(scaled.max_displacement.iter().chain([&scaled.max_force])) {
            prop_assert!((a * scale - b).abs() <= 1e-9 * b.max(1e-9), "{a} times {scale} is not {b}");
        }
    }

    /// Turning the impulse turns the answer, deadband or not: radii and |u| stay.
    #[test]
    fn turning_the_impulse_changes_no_radius((rotor, feedback) in balanced(), speed in 0.0..2.0, deadband in 0.0..2.0, turn in 0.0..6.3) {
        let after = |angle: f64| {
            let mut plan = plan((&rotor, &feedback, speed, &[deadband; 4]), 30.0, Settle::From(0.0));
            plan.impulses.push(Impulse { mass: 0, change: C64::from_polar(2.0, angle), at: 0.0 });
            go(&plan)
        };
        let (straight, turned) = (after(0.0), after(turn));
        for (a, b) in straight.last.displacement.iter().zip(&turned.last.displacement) {
            prop_assert!((a * C64::cis(turn) - b).norm() < 1e-8 * (1.0 + a.norm()));
        }
        for (a, b) in straight.max_displacement.iter().zip(&turned.max_displacement) {
            prop_assert!((a - b).abs() < 1e-7 * (1.0 + a));
        }
    }
}

/// A quarter of the mass under the first bearing and half of it under the second: what is told as the largest force is that of the first
/// which is as large.
#[test]
fn val_of_two_bearings_on_unequal_masses_the_larger_force_is_told_not_the_larger_acceleration() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let bearing = |station, gains| ControlBearing::new(station, vec![Signal::at_mass(station, 3, gains)]);
    let speed = 1.2;
    let gains = [1.0, 1.0, 0.0, 0.0];
    let feedback = Feedback { bearings: vec![bearing(0, gains), bearing(1, gains)] };
    let exact = synchronous(&rotor, &feedback, &[0.0; 3], &[speed]).expect("solved");
    let [orbit] = &exact.orbits[0][..] else { panic!("one orbit: {:?}", exact.orbits[0]) };
    // The second mass is twice as heavy as the first.
    let [light, heavy] = [orbit.forces[0], orbit.forces[1] * 2.0];
    assert!((orbit.force - heavy).abs() < 1e-12 && orbit.force > light, "{orbit:?}");
    let outcome = go(&plan((&rotor, &feedback, speed, &[0.0; 3]), 200.0, Settle::Detect));
    assert!((outcome.max_force / orbit.force - 1.0).abs() < 1e-5, "{} and {}", outcome.max_force, orbit.force);
}
