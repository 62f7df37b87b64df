//! Faults of sensors and amplifiers beside what they are in mathematics: a gain is a gain of the law, and a machine that has lost an axis is
//! linear in real numbers, if not in complex ones.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use machine::{Machine, MachinePoles, Program};
use nalgebra::{DMatrix, DVector};
use rotor::{C64, ClosedLoop, Mass, Rotor, Settings, builtin};

/// The three-mass rotor without unbalance and clearances, under its own law: linear.
fn linear(set: &[(&str, &str)]) -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").unwrap();
    let masses: Vec<Mass> = rotor.masses().iter().map(|m| Mass { unbalance: 0.0, deadband: 0.0, ..*m }).collect();
    let rotor = Rotor::new("linear", masses, rotor.shafts().to_vec()).unwrap();
    let three_mass = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&three_mass, "individual").unwrap());
    settings.trip = 1e9;
    set.iter().for_each(|(key, value)| settings.assign(key, value).unwrap());
    (rotor, settings)
}

const DTAU: f64 = 0.002;
const KICK: C64 = C64::new(0.7, -0.4);

fn moved((rotor, settings): &(Rotor, Settings), steps: usize) -> Vec<C64> {
    let mut machine = Machine::new(Program::in_substeps(rotor, settings, DTAU, 1).unwrap());
    machine.kick(1, KICK);
    (0..steps).for_each(|_| assert!(machine.step().is_none()));
    let sample = machine.sample();
    sample.displacement.iter().chain(sample.velocity).copied().collect()
}

fn scaled(factor: f64, of: &[usize]) -> (Rotor, Settings) {
    let (rotor, mut settings) = linear(&[]);
    for signal in of {
        let gains = &mut settings.feedback.first_mut().signals[*signal].gains;
        gains.iter_mut().for_each(|gain| *gain = gain.scaled(factor));
    }
    (rotor, settings)
}

fn agree(faulty: &(Rotor, Settings), scaled: &(Rotor, Settings)) {
    let (ours, theirs) = (moved(faulty, 2000), moved(scaled, 2000));
    for (a, b) in ours.iter().zip(&theirs) {
        assert!((a - b).norm() < 1e-9 * (1.0 + b.norm()), "{a} {b}");
    }
    let poles = |(rotor, settings): &(Rotor, Settings)| MachinePoles::of(rotor, settings).unwrap().modes;
    for (a, b) in poles(faulty).iter().zip(poles(scaled)) {
        assert!((a.pole - b.pole).norm() < 1e-9, "{} {}", a.pole, b.pole);
    }
}

#[test]
fn val_a_gain_of_sensors_or_amplifier_is_one_of_the_law() {
    agree(&linear(&[("sensor_gain", "0.6")]), &scaled(0.6, &[0, 1]));
    agree(&linear(&[("amplifier_y", "0.6"), ("amplifier_z", "0.6")]), &scaled(0.6, &[0, 1]));
    // Signal 2 reads mass 2, and signal 1 does not.
    agree(&linear(&[("sensor_gain", "0.6"), ("sensor_at", "2")]), &scaled(0.6, &[1]));
    agree(&linear(&[("sensor_gain", "0"), ("sensor_at", "1")]), &scaled(0.0, &[0]));
}

#[test]
fn val_without_an_axis_the_motion_is_that_of_the_real_equations() {
    let (rotor, sound) = linear(&[]);
    let deadband = vec![0.0; rotor.len()];
    let free = ClosedLoop::new(&rotor, &sound.feedback.off(), sound.speed, &deadband).state_matrix();
    let held = ClosedLoop::new(&rotor, &sound.feedback, sound.speed, &deadband).state_matrix();
    let n = free.nrows();
    let law = &held - &free;
    // x = [re; im], of which the law acts on the imaginary rows alone.
    let real = |a: &DMatrix<C64>, keeps: [f64; 2]| {
        DMatrix::from_fn(2 * n, 2 * n, |i, j| {
            let z = a[(i % n, j % n)];
            let part = match (i < n, j < n) {
                (true, true) | (false, false) => z.re,
                (true, false) => -z.im,
                (false, true) => z.im,
            };
            part * keeps[usize::from(i >= n)]
        })
    };
    for (key, keeps) in [("amplifier_y", [0.0, 1.0]), ("amplifier_z", [1.0, 0.0])] {
        let matrix = real(&free, [1.0; 2]) + real(&law, keeps);
        let mut start = DVector::zeros(2 * n);
        (start[n / 2 + 1], start[n + n / 2 + 1]) = (KICK.re, KICK.im);
        let steps = 1500;
        let exact = (matrix * (DTAU * steps as f64)).exp() * start;
        let lost = linear(&[(key, "0")]);
        let found = moved(&lost, steps);
        for (i, z) in found.iter().enumerate() {
            let expected = C64::new(exact[i], exact[n + i]);
            assert!((z - expected).norm() < 1e-7 * (1.0 + expected.norm()), "{key} {i}: {z} {expected}");
        }
        // Which is not the motion with the axis.
        assert!((found[0] - moved(&(rotor.clone(), sound.clone()), steps)[0]).norm() > 1e-3);
        let told = MachinePoles::of(&lost.0, &lost.1).unwrap_err().to_string();
        assert!(told.contains("acts along its axes differently"), "{told}");
    }
}

#[test]
fn sensors_that_are_not_there_are_refused() {
    let told = |set: &[(&str, &str)]| {
        let (rotor, settings) = linear(set);
        settings.check(&rotor).unwrap_err().to_string()
    };
    assert!(
        told(&[("sensor_gain", "0.5"), ("sensor_at", "4")]).starts_with("sensor_at = 4: expected a mass from 1 to 3")
    );
    assert!(told(&[("sensor_gain", "0.5"), ("sensor_at", "1.5")]).starts_with("sensor_at = 1.5: expected a mass"));
    assert!(told(&[("sensor_at", "2")]).starts_with("sensor_at = 2 without sensor_gain"));
}

/// Circular whirl has no meaning where the axes differ: it is refused, and not worked out without control.
#[test]
fn regress_circular_whirl_of_a_lost_axis_is_refused() {
    let (rotor, settings) = linear(&[("amplifier_y", "0")]);
    let told = rotor::circular::synchronous(&rotor, &settings.feedback, &settings.deadband, &[1.0]).unwrap_err();
    assert!(told.to_string().contains("acts along its axes differently"), "{told}");
    let told = rotor::circular::cycles(&rotor, &settings.feedback, &[1.0; 3], &[1.0]).unwrap_err();
    assert!(told.to_string().contains("acts along its axes differently"), "{told}");
}
