//! A drive of given torque: against SciPy's DOP853, the balance of energy, and the speed that is given.

use machine::{Leg, Machine, Program, StateWords};
use proptest::prelude::*;
use rotor::{C64, J, Mass, Rotor, Settings, builtin};
use serde_json::Value;

fn one_mass(damping: f64) -> Rotor {
    let mass = Mass { mass: 1.0, damping, bearing_stiffness: 1.0, unbalance: 1.0, ..Mass::default() };
    Rotor::new("one mass", vec![mass], vec![]).expect("valid")
}

fn settings(rotor: &Rotor, feedback: &str) -> Settings {
    let mut settings = Settings::new(rotor, 0.0, builtin::feedback(rotor, feedback).expect("any rotor has it"));
    settings.trip = 1e9;
    settings
}

fn machine(rotor: &Rotor, settings: &Settings, from: f64, legs: Vec<Leg>, dtau: f64) -> Machine {
    let program = Program::in_substeps(rotor, settings, dtau, 1).expect("fits");
    Machine::spinning(program.following(legs), from)
}

#[test]
fn val_a_torque_that_sticks_and_one_that_passes_are_those_of_dop853() {
    let data: Value = serde_json::from_str(include_str!("drive.json")).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    let rotor = one_mass(number(&data["zeta"]));
    let settings = settings(&rotor, "off");
    let (inertia, drag) = (number(&data["inertia"]), number(&data["drag"]));
    let mut ends = Vec::new();
    for case in data["cases"].as_array().expect("a list") {
        let (torque, duration) = (number(&case["torque"]), number(&case["duration"]));
        // One leg parted in two: they join where they are.
        let leg = |part: f64| Leg::Drive { torque, inertia, drag, duration: part * duration };
        let steps = 30 * (duration / 30.0 / 0.004).round() as u64;
        let dtau = duration / steps as f64;
        let mut machine = machine(&rotor, &settings, 0.0, vec![leg(0.37), leg(0.7)], dtau);
        for (tau, state) in
            case["tau"].as_array().expect("a list").iter().zip(case["states"].as_array().expect("a list"))
        {
            while machine.tau() < number(tau) - 0.5 * dtau {
                machine.step();
            }
            let sample = machine.sample();
            let there: Vec<f64> = state.as_array().expect("a list").iter().map(number).collect();
            let (p, v) = (C64::new(there[0], there[1]), C64::new(there[2], there[3]));
            assert!(
                (sample.displacement[0] - p).norm() < 1e-6 * (1.0 + p.norm()),
                "{tau}: {:?} {p}",
                sample.displacement
            );
            assert!((sample.velocity[0] - v).norm() < 1e-6 * (1.0 + v.norm()), "{tau}");
            assert!(
                (sample.angle - there[4]).abs() < 1e-6 * (1.0 + there[4].abs()),
                "{tau}: {} {}",
                sample.angle,
                there[4]
            );
            assert!((sample.speed - there[5]).abs() < 1e-7, "{tau}: {} {}", sample.speed, there[5]);
        }
        ends.push(machine.sample().speed);
    }
    // Sommerfeld: without whirl 5 / 0.5 would be R = 10. The weak torque is stuck below the critical speed at 1.
    assert!(ends[0] > 0.9 && ends[0] < 1.0 && ends[1] > 3.0, "{ends:?}");
}

/// Energy of the motion and the spin about the moving centre, and the work of the torque so far.
fn energy(rotor: &Rotor, machine: &Machine, inertia: f64) -> f64 {
    let sample = machine.sample();
    let turn = C64::cis(sample.angle);
    let each = rotor.masses().iter().zip(sample.displacement).zip(sample.velocity).map(|((m, p), v)| {
        let centre = v + J * sample.speed * m.unbalance * turn;
        0.5 * m.mass * centre.norm_sqr() + 0.5 * (m.bearing_stiffness + m.seal_stiffness) * p.norm_sqr()
    });
    let shafts = rotor
        .shafts()
        .iter()
        .enumerate()
        .map(|(i, k)| 0.5 * k * (sample.displacement[i + 1] - sample.displacement[i]).norm_sqr());
    each.sum::<f64>() + shafts.sum::<f64>() + 0.5 * inertia * sample.speed * sample.speed
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Without losses all that the torque does is in the motion and the spin.
    #[test]
    fn the_torques_work_is_in_the_motion_and_the_spin(
        masses in prop::collection::vec((0.2..1.0f64, 0.2..1.0f64, -1.0..1.0f64), 1..4),
        shaft in 0.2..1.0f64,
        torque in -0.3..1.0f64,
        inertia in 20.0..80.0f64,
        from in 0.0..2.0f64,
    ) {
        let shafts = vec![shaft; masses.len() - 1];
        let made = masses.iter().map(|&(mass, bearing_stiffness, unbalance)| Mass { mass, bearing_stiffness, unbalance, ..Mass::default() });
        let rotor = Rotor::new("conservative", made.collect(), shafts).expect("valid");
        let settings = settings(&rotor, "off");
        let legs = vec![Leg::Drive { torque, inertia, drag: 0.0, duration: 60.0 }];
        let mut machine = machine(&rotor, &settings, from, legs, 0.005);
        let began = energy(&rotor, &machine, inertia);
        for _ in 0..10_000 {
            machine.step();
        }
        let now = energy(&rotor, &machine, inertia);
        let work = torque * machine.sample().angle;
        prop_assert!((now - began - work).abs() < 1e-6 * (1.0 + now.abs() + work.abs()), "{began} + {work} = {now}");
    }
}

#[test]
fn val_a_great_inertia_follows_the_speed_that_is_given() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = settings(&rotor, "individual");
    let (rate, inertia) = (0.01, 1e10);
    let driven = vec![Leg::Drive { torque: rate * inertia, inertia, drag: 0.0, duration: 100.0 }];
    let mut driven = machine(&rotor, &settings, 1.0, driven, 0.01);
    let mut given = machine(&rotor, &settings, 1.0, vec![Leg::To { speed: 2.0, rate }], 0.01);
    for _ in 0..12_000 {
        driven.step();
        given.step();
    }
    let (a, b) = (driven.sample(), given.sample());
    assert!((a.speed - b.speed).abs() < 1e-7 && (a.angle - b.angle).abs() < 1e-5, "{a:?} {b:?}");
    for (a, b) in a.displacement.iter().zip(b.displacement) {
        assert!((a - b).norm() < 1e-5, "{a} {b}");
    }
    // It stays at the speed that it has, whatever the settings' own is.
    assert!((a.speed - 2.0).abs() < 1e-7 && a.acceleration == 0.0);
}

#[test]
fn a_drive_is_saved_in_mid_leg_and_goes_on_to_the_last_bit() {
    let rotor = one_mass(0.02);
    let settings = settings(&rotor, "off");
    let legs = vec![
        Leg::Drive { torque: 60.0, inertia: 200.0, drag: 0.1, duration: 20.0 },
        Leg::Dwell { duration: 3.0 },
        Leg::Drive { torque: -60.0, inertia: 200.0, drag: 0.1, duration: 10.0 },
    ];
    let mut machine = machine(&rotor, &settings, 0.0, legs.clone(), 0.01);
    for at in [700, 2100, 2600] {
        while machine.tau() < f64::from(at) * 0.01 - 0.005 {
            machine.step();
        }
        let mut words = StateWords::default();
        machine.save(&mut words);
        let program = Program::in_substeps(&rotor, &settings, 0.01, 1).expect("fits").following(legs.clone());
        let mut other = Machine::new(program);
        assert!(other.restore(&mut StateWords::from_saved(words.as_slice().to_vec())), "its own words");
        let mut same = machine.clone();
        for _ in 0..1500 {
            other.step();
            same.step();
        }
        let [a, b] = [other.sample(), same.sample()];
        assert_eq!((a.tau, a.angle, a.speed, a.displacement), (b.tau, b.angle, b.speed, b.displacement));
    }
}

#[test]
fn a_brake_brings_it_to_rest_and_does_not_turn_it_back() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let settings = settings(&rotor, "off");
    let legs = vec![Leg::Drive { torque: -0.19, inertia: 60.0, drag: 0.0, duration: 600.0 }];
    let mut machine = machine(&rotor, &settings, 1.3, legs, 0.02);
    let mut slowest = f64::INFINITY;
    while machine.tau() < 599.0 {
        machine.step();
        slowest = slowest.min(machine.sample().speed);
    }
    let sample = machine.sample();
    assert_eq!((sample.speed, sample.acceleration, slowest), (0.0, 0.0, 0.0));
    assert!(sample.displacement[0].norm() < 1e-6, "{:?}", sample.displacement);
}
