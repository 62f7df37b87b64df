//! A step of three masses: the fused path alone, the same in a machine, and with every part of the loop on; and one of a shaft on two magnetic bearings. What a changing speed costs
//! is measured by `ramps`.

use control::{Filter, Parts};
use divan::{Bencher, black_box};
use machine::{Machine, Program};
use rotor::{Settings, builtin};

fn main() {
    divan::main();
}

/// Steps a call, so that the clock is not what is measured.
const STEPS: usize = 1000;

fn settings(change: impl Fn(&mut rotor::Feedback)) -> (rotor::Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut feedback = builtin::feedback(&rotor, "individual").expect("built in");
    change(&mut feedback);
    // A motion that lasts: clearances in play, the limits never reached for long, and no trip.
    let mut settings = Settings::new(&rotor, 2.5, feedback);
    settings.deadband.fill(0.2);
    (rotor, settings)
}

fn machine(change: impl Fn(&mut rotor::Feedback)) -> Machine {
    let (rotor, settings) = settings(change);
    Machine::new(Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"))
}

fn thousand(bencher: Bencher, mut machine: Machine) {
    bencher.counter(STEPS).bench_local(|| {
        for _ in 0..STEPS {
            machine.step();
        }
        assert!(machine.trip().is_none(), "it stands still");
        black_box(machine.sample().displacement[0])
    });
}

#[divan::bench]
fn fused_path_alone(bencher: Bencher) {
    let (rotor, settings) = settings(|_| ());
    let mut stepper = rotor::stepper(&settings.closed_loop(&rotor));
    bencher.counter(STEPS).bench_local(|| {
        let mut worst: f64 = 0.0;
        for _ in 0..STEPS {
            stepper.step(0.01);
            worst = worst.max(stepper.motion().largest_radius() + stepper.control().re);
        }
        black_box(worst)
    });
}

/// The fused path with the guard and the trip that a live bench had around it before there was a machine: the peer of
/// `ideal_machine`, which is to cost at most 3 % more.
#[divan::bench]
fn fused_path_guarded(bencher: Bencher) {
    let (rotor, settings) = settings(|_| ());
    let mut stepper = rotor::stepper(&settings.closed_loop(&rotor));
    let mut good = [vec![rotor::C64::ZERO; rotor.len()], vec![rotor::C64::ZERO; rotor.len()]];
    let (mut delivered, mut has_tripped) = (rotor::C64::ZERO, false);
    let (dtau, substeps, trip_limit) = black_box((0.01, 1, settings.trip));
    bencher.counter(STEPS).bench_local(|| {
        for _ in 0..STEPS {
            if has_tripped {
                continue;
            }
            stepper.advance(dtau, substeps);
            let (motion, control) = (stepper.motion(), stepper.control());
            let radius = motion.largest_radius();
            if motion.is_finite() && radius.is_finite() && control.is_finite() {
                good[0].copy_from_slice(motion.displacement);
                good[1].copy_from_slice(motion.velocity);
                delivered = control;
                has_tripped = radius > trip_limit;
            } else {
                has_tripped = true;
            }
        }
        assert!(!has_tripped, "it stands still");
        black_box(delivered)
    });
}

#[divan::bench]
fn ideal_machine(bencher: Bencher) {
    thousand(bencher, machine(|_| ()));
}

#[divan::bench]
fn every_part(bencher: Bencher) {
    thousand(
        bencher,
        machine(|f| {
            f.bearings[0].parts = Parts {
                sensor_lag: 0.01,
                noise: 0.001,
                quantum: 0.0005,
                sample: 0.05,
                delay: 0.02,
                lag: 0.02,
                limit: 20.0,
                slew: 500.0,
                ..Parts::default()
            };
            f.bearings[0].signals[0].filters = vec![Filter::Lowpass { corner: 60.0, order: 2 }];
            f.bearings[0].filters = vec![Filter::SynchronousNotch { width: 0.1 }];
        }),
    );
}

#[divan::bench]
fn every_continuous_part(bencher: Bencher) {
    thousand(
        bencher,
        machine(|f| {
            f.bearings[0].parts =
                Parts { sensor_lag: 0.01, delay: 0.02, lag: 0.02, limit: 20.0, slew: 500.0, ..Parts::default() };
            f.bearings[0].signals[0].filters = vec![Filter::Lowpass { corner: 60.0, order: 2 }];
            f.bearings[0].filters = vec![Filter::SynchronousNotch { width: 0.1 }];
        }),
    );
}

/// The built-in rotor on two magnetic bearings in so many coordinates, its own controllers closed.
#[divan::bench(args = [12, 16])]
fn shaft_on_two_bearings(bencher: Bencher, coordinates: usize) {
    let text = include_str!("../../rotor/src/rig.toml");
    let text = text.replace("coordinates = 12", &format!("coordinates = {coordinates}"));
    let rotor = rotor::file::read_rotor(&text, "rig").expect("a rotor");
    assert_eq!(rotor.len(), coordinates);
    let settings = Settings::new(&rotor, 3.0, builtin::feedback(&rotor, "own").expect("its own"));
    // As fine as its fastest mode asks for, one to a step.
    let dtau = machine::default_step(&rotor, &settings).expect("one that follows it");
    thousand(bencher, Machine::new(Program::in_substeps(&rotor, &settings, dtau, 1).expect("can be stepped")));
}
