//! The longest step that [`rotor::step`] allows, against exact responses and exact poles, over random rotors and speeds.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rotor::circular::synchronous;
use rotor::step::{Fastest, PROMISE, substeps};
use rotor::{C64, ClosedLoop, Feedback, GainKind, J, Mass, Modes, Rotor, Settings, Signal, builtin, stepper};

/// Rotors of one to six masses, soft and stiff, slow and fast, with and without control; and a speed.
fn machine() -> impl Strategy<Value = (Rotor, Feedback, f64)> {
    let mass = (0.1..1.0, -3.0..0.3, 0.0..0.2, -1.5..0.5, -2.0..0.3, 0.05..1.0);
    let masses = prop::collection::vec(mass, 1..=6);
    let shafts = prop::collection::vec(-1.0..1.5, 5);
    let gains = (-1.0..1.0, 0.0..2.0, -1.0..1.0, -1.0..1.0, -1.0..1.5);
    (masses, shafts, gains, 0usize..6, 0usize..6, -1.0..2.0).prop_map(|(masses, shafts, gains, bearing, at, speed)| {
        let n = masses.len();
        let ten = |exponent: f64| 10.0_f64.powf(exponent);
        let masses = masses.into_iter().map(|(mass, damping, cross_damping, bearing, seal, unbalance)| Mass {
            mass,
            damping: ten(damping),
            cross_damping,
            bearing_stiffness: ten(bearing),
            seal_stiffness: ten(seal),
            unbalance,
            ..Mass::default()
        });
        let shafts = shafts[..n - 1].iter().map(|shaft| ten(*shaft)).collect();
        let (kd, cd, kc, cc, size) = gains;
        let signal = Signal::at_mass(at % n, n, [kd, cd, kc, cc].map(|gain| gain * ten(size)));
        let rotor = Rotor::new("random", masses.collect(), shafts).expect("valid");
        (rotor, Feedback::new(bearing % n, vec![signal]), ten(speed))
    })
}

fn with_bearings(rotor: &Rotor, share: f64) -> Rotor {
    let masses = rotor.masses().iter().map(|m| Mass { bearing_stiffness: share * m.bearing_stiffness, ..*m });
    Rotor::new("partly held", masses.collect(), rotor.shafts().to_vec()).expect("valid")
}

fn min_damping(closed_loop: &ClosedLoop) -> f64 {
    Modes::of(closed_loop).map_or(f64::NAN, |linear| linear.min_damping())
}

/// The periodic answer of the integrator itself to the unbalance, at the beginning of a step: a step is an affine map, so
/// that this needs no simulation.
fn integrated(closed_loop: &ClosedLoop, dtau: f64) -> Option<Vec<C64>> {
    let n = closed_loop.masses();
    let stepped = |place: usize| {
        let mut unit = vec![C64::ZERO; 2 * n + 1];
        unit[place] = C64::ONE;
        let mut stepper = stepper(closed_loop);
        stepper.place(&unit[..n], &unit[n..2 * n]);
        stepper.step(dtau);
        let motion = stepper.motion();
        DVector::from_iterator(2 * n, motion.displacement.iter().chain(motion.velocity).copied())
    };
    let forced = stepped(2 * n);
    let columns: Vec<_> = (0..2 * n).map(|place| stepped(place) - &forced).collect();
    let turned = DMatrix::from_diagonal_element(2 * n, 2 * n, C64::cis(closed_loop.speed() * dtau));
    (turned - DMatrix::from_columns(&columns)).lu().solve(&forced).map(|x| x.as_slice().to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Radii and force of the linear rotor with any part of its bearings' stiffness, and every pole.
    #[test]
    fn val_the_longest_step_keeps_the_promise((rotor, feedback, speed) in machine(), share in 0.0..1.0) {
        let full = ClosedLoop::new(&rotor, &feedback, speed, &[]);
        let fastest = Fastest::of(&full).expect("poles");
        let dtau = fastest.longest_step();
        for share in [1.0, 0.0, share] {
            let rotor = with_bearings(&rotor, share);
            let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[]);
            if share == 0.0 || share == 1.0 {
                for mode in Modes::of(&closed_loop).expect("poles").modes {
                    let x = mode.pole * dtau;
                    let grown = C64::ONE + x * (C64::ONE + x / 2.0 * (C64::ONE + x / 3.0 * (C64::ONE + x / 4.0)));
                    prop_assert!((grown.ln() / x - 1.0).norm() <= 1.2e-5, "{} for {x}", grown.ln() / x);
                }
            }
            // A resonance that is hardly damped answers to anything; one without damping to nothing that is periodic.
            if min_damping(&closed_loop).is_nan() || min_damping(&closed_loop) < 1e-3 {
                continue;
            }
            let exact = synchronous(&rotor, &feedback, &[], &[speed]).expect("solved");
            let orbit = &exact.orbits[0][0];
            let state = integrated(&closed_loop, dtau).expect("regular");
            let (p, v) = state.split_at(rotor.len());
            let largest = orbit.largest_radius();
            for (found, exact) in p.iter().zip(&orbit.amplitude) {
                // A mass beside a node of the motion is where large terms cancel: its size is theirs.
                let size = exact.norm().max(5e-2 * largest);
                prop_assert!((found.norm() - exact.norm()).abs() <= PROMISE * size, "{found} for {exact}, R = {speed}");
            }
            // The force is gains times such displacements and velocities: where these terms cancel, its size is theirs.
            let signal = &feedback.bearings[0].signals[0];
            let [kd, cd, kc, cc] = GainKind::ALL.map(|kind| signal.gain(kind).at(speed));
            let terms = (kd.hypot(kc) + cd.hypot(cc) * speed.abs()) * 5e-2 * largest;
            let size = orbit.force.max(terms);
            let force = closed_loop.control(p, v).norm();
            prop_assert!((force - orbit.force).abs() <= PROMISE * size, "{force} for {}, R = {speed}", orbit.force);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// With clearances: run on from an exact stable orbit, the motion stays on it.
    #[test]
    fn val_the_longest_step_stays_on_exact_orbits_with_clearances(
        (rotor, feedback, speed) in machine(),
        deadband in 0.05..1.0,
    ) {
        let deadband = vec![deadband; rotor.len()];
        if rotor.len() > 3 {
            return Ok(());
        }
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &deadband);
        let dtau = Fastest::of(&closed_loop).expect("poles").longest_step();
        let exact = synchronous(&rotor, &feedback, &deadband, &[speed]).expect("solved");
        for orbit in exact.orbits[0].iter().filter(|orbit| orbit.growth.as_ref().is_ok_and(|growth| *growth < -0.02)) {
            let steps = 12.0 / -orbit.growth.clone().expect("judged") / dtau;
            if steps > 1e5 {
                continue;
            }
            let mut stepper = stepper(&closed_loop);
            let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| J * speed * c).collect();
            stepper.place(&orbit.amplitude, &velocity);
            (0..steps as u64).for_each(|_| stepper.step(dtau));
            for (found, exact) in stepper.motion().displacement.iter().zip(orbit.radii()) {
                let size = exact.max(1e-3 * orbit.largest_radius());
                prop_assert!((found.norm() - exact).abs() <= PROMISE * size, "{} for {exact}", found.norm());
            }
        }
    }
}

#[test]
fn val_the_reports_rotor_stays_on_its_orbits_at_the_longest_step() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "individual").expect("built in");
    for speed in [1.5, 2.25, 4.0, 6.5] {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[1.0; 3]);
        let dtau = Fastest::of(&closed_loop).expect("poles").longest_step();
        let exact = synchronous(&rotor, &feedback, &[1.0; 3], &[speed]).expect("solved");
        let mut stepper = stepper(&closed_loop);
        (0..(1500.0 / dtau) as u64).for_each(|_| stepper.step(dtau));
        let orbit = &exact.orbits[0][0];
        for (found, exact) in stepper.motion().displacement.iter().zip(orbit.radii()) {
            assert!((found.norm() - exact).abs() <= PROMISE * exact, "{} for {exact}, R = {speed}", found.norm());
        }
        assert!((stepper.control().norm() - orbit.force).abs() <= PROMISE * orbit.force);
    }
}

#[test]
fn one_substep_is_a_step_to_the_last_bit() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").expect("built in"));
    let closed_loop = settings.closed_loop(&rotor);
    assert_eq!(substeps(&closed_loop, 0.01, 1000.0), Ok(1));
    let (mut one, mut other) = (stepper(&closed_loop), stepper(&closed_loop));
    for _ in 0..1000 {
        one.step(0.01);
        other.advance(0.01, 1);
    }
    assert_eq!(one.motion().displacement, other.motion().displacement);
    assert_eq!(one.motion().tau.to_bits(), other.motion().tau.to_bits());
    other.advance(0.01, 7);
    one.step(0.01);
    assert!((one.motion().tau - other.motion().tau).abs() < 1e-14);
}
