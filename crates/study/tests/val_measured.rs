//! What is measured on a machine in motion is what is computed from its matrices, for every kind of loop.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use machine::{Excitation, Machine, MachineLoop, MachinePoles, Multisine, Program, StateWords};
use rotor::{C64, Rotor, Settings, builtin};
use study::measured::{MeasuredPoint, Tones};

const DTAU: f64 = 0.01;
/// Steps of a period.
const PERIOD: usize = 5000;

fn three_mass(feedback: &str, speed: f64, change: &[(&str, &str)]) -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
    settings.deadband.fill(0.0);
    change.iter().for_each(|(key, value)| settings.assign(key, value).unwrap());
    (rotor, settings)
}

/// The sensitivity out of two periods, after the machine has settled twice: without tones and with them.
fn measure(rotor: &Rotor, settings: &Settings, amplitude: f64) -> Vec<MeasuredPoint> {
    let poles = MachinePoles::of(rotor, settings).unwrap();
    let slowest = poles.modes.iter().map(|mode| -mode.pole.re).fold(f64::INFINITY, f64::min);
    let settle = (10.0 / slowest / DTAU).ceil() as usize;
    let steps = settle + 2 * PERIOD;
    let multisine = Multisine {
        seed: 5,
        period: PERIOD as f64 * DTAU,
        lines: [1, 40],
        tones: 16,
        away_from: settings.speed,
        amplitude,
        duration: steps as f64 * DTAU,
    };
    let mut machine = Machine::new(Program::in_substeps(rotor, settings, DTAU, 1).unwrap());
    for _ in 0..settle {
        machine.step();
    }
    let from = machine.tau();
    machine.excite(0, &mut Some(Box::new(Excitation::of(&multisine).unwrap())));
    assert!(machine.is_excited());
    let mut record: Vec<(f64, C64)> = Vec::new();
    for _ in 0..steps {
        assert_eq!(machine.step(), None);
        let sample = machine.sample();
        record.push((sample.tau, sample.outputs[0].commanded));
    }
    assert!(!machine.is_excited(), "it ends by itself");
    let tones = Tones {
        tones: multisine.tones().unwrap(),
        from,
        speed: settings.speed,
        sample: settings.feedback.bearings[0].parts.sample,
    };
    let periods: Vec<Vec<C64>> =
        record[settle..].chunks(PERIOD).map(|period| tones.identify(period).expect("long enough")).collect();
    tones.averaged(&periods)
}

fn largest_difference(rotor: &Rotor, settings: &Settings, points: &[MeasuredPoint]) -> f64 {
    let machine = MachineLoop::at(rotor, settings, settings.speed).unwrap();
    let difference = |p: &MeasuredPoint| {
        let computed = machine.gain.at(p.frequency).sensitivity();
        (p.value - computed).norm() / computed.norm()
    };
    points.iter().map(difference).fold(0.0, f64::max)
}

#[test]
fn val_a_linear_machine_has_the_sensitivity_that_is_computed() {
    let loops: [&[(&str, &str)]; 5] = [
        &[],
        &[("delay", "0.05")],
        &[("delay", "0.004"), ("sensor_lag", "0.01")],
        &[("lag", "0.03"), ("lag_damping", "0.7")],
        &[("sample", "0.025"), ("delay", "0.03")],
    ];
    for change in loops {
        let (rotor, settings) = three_mass("individual", 6.0, change);
        let points = measure(&rotor, &settings, 1e-3);
        let difference = largest_difference(&rotor, &settings, &points);
        assert!(difference < 1e-3, "{change:?}: {difference}");
        assert!(points.iter().all(|point| point.coherence > 1.0 - 1e-6), "{change:?}");
    }
}

#[test]
fn val_a_clearance_bends_it() {
    let (rotor, mut settings) = three_mass("composite", 2.5, &[]);
    settings.deadband.fill(1.0);
    let points = measure(&rotor, &settings, 1e-3);
    assert!(largest_difference(&rotor, &settings, &points) > 0.05);
}

#[test]
fn an_excited_machine_that_is_written_down_goes_on_to_the_last_bit() {
    let multisine: Multisine =
        "seed=1 period=50.0 lines=1..40 tones=20 away_from=2.5 amplitude=0.125 duration=2.0".parse().unwrap();
    for change in [&[][..], &[("delay", "0.05")], &[("sample", "0.02"), ("noise", "0.001")]] {
        let (rotor, settings) = three_mass("composite", 2.5, change);
        let made = || Machine::new(Program::in_substeps(&rotor, &settings, DTAU, 2).unwrap());
        let mut machine = made();
        (0..100).for_each(|_| assert_eq!(machine.step(), None));
        machine.excite(0, &mut Some(Box::new(Excitation::of(&multisine).unwrap())));
        (0..50).for_each(|_| assert_eq!(machine.step(), None));
        let mut words = StateWords::default();
        machine.save(&mut words);
        assert!(words.as_slice().len() <= machine.words_at_most());
        let mut other = made();
        assert!(other.restore(&mut StateWords::from_saved(words.as_slice().to_vec())), "{change:?}");
        for step in 0..400 {
            machine.step();
            other.step();
            let [a, b] = [&machine, &other].map(|machine| {
                let sample = machine.sample();
                (sample.tau, sample.angle, sample.displacement.to_vec(), sample.outputs[0])
            });
            assert_eq!(a, b, "{change:?} at {step}");
        }
        assert!(!other.is_excited());
        // Back to rest there is none, and another loop has none either.
        machine.excite(0, &mut Some(Box::new(Excitation::of(&multisine).unwrap())));
        machine.step();
        other = machine.clone();
        machine.restart();
        assert!(!machine.is_excited() && other.is_excited());
        other.load(&mut Box::new(Program::in_substeps(&rotor, &settings, DTAU, 2).unwrap()));
        assert!(!other.is_excited());
    }
}
