//! What a machine does once its orbit has tripped it and its settings let it coast down.

use control::StateWords;
use rotor::{Settings, builtin};

use super::trip::LOST;
use super::{Machine, Path};
use crate::{Program, TripCause};

const DTAU: f64 = 0.01;

fn settings(feedback: &str, changes: &[(&str, &str)]) -> Settings {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).expect("built in"));
    for (key, value) in [("trip", "5"), ("coast_down", "0.5")].iter().chain(changes) {
        settings.assign(key, value).expect("in range");
    }
    settings
}

fn program(settings: &Settings) -> Box<Program> {
    let rotor = builtin::rotor("three-mass").expect("built in");
    Box::new(Program::in_substeps(&rotor, settings, DTAU, 1).expect("can be stepped"))
}

fn tripped(settings: &Settings) -> Machine {
    let mut machine = Machine::new(*program(settings));
    let trip = (0..1_000_000).find_map(|_| machine.step()).expect("it grows");
    assert!(trip.radius > 5.0 && trip.radius < 5.1 && trip.limit == 5.0, "{trip:?}");
    machine
}

fn saved(machine: &Machine) -> Vec<u64> {
    let mut words = StateWords::default();
    machine.save(&mut words);
    words.as_slice().to_vec()
}

fn radius(machine: &Machine) -> f64 {
    machine.sample().displacement.iter().map(|place| place.norm()).fold(0.0, f64::max)
}

/// Without control the rotor is unstable above R = 1.7755 and stable below: it trips, and its orbit dies down on the way to rest.
#[test]
fn val_a_tripped_speed_decays_exponentially_while_the_rotor_moves_on() {
    // On the fused path, and beside a loop that has none.
    for changes in [&[][..], &[("lag", "0.001")]] {
        let mut machine = tripped(&settings("off", changes));
        assert_eq!((machine.trip().map(|trip| trip.cause), machine.is_held()), (Some(TripCause::CoastDown), false));
        let (from, angle) = (machine.tau(), machine.sample().angle);
        // R = 2.5 exp(-t / 5) for 5 ln 100 = 23.03, the angle its integral.
        for step in 1..=2300 {
            assert!(machine.step().is_none(), "it has tripped already");
            let t = machine.tau() - from;
            assert!((t - f64::from(step) * DTAU).abs() < 1e-9, "time goes on");
            let (left, sample) = ((-t / 5.0).exp(), machine.sample());
            assert!((sample.speed - 2.5 * left).abs() < 1e-12 && (sample.acceleration + 0.5 * left).abs() < 1e-12);
            assert!((sample.angle - angle - 12.5 * (1.0 - left)).abs() < 1e-9);
        }
        assert!(radius(&machine) < 5.0, "it is stable at these speeds");
        (0..20_000).for_each(|_| assert!(machine.step().is_none()));
        assert_eq!((machine.sample().speed, machine.is_held()), (0.0, false));
        assert!(radius(&machine) < 1e-3, "at rest no unbalance turns: {}", radius(&machine));
        // Nothing but a restart turns it again.
        machine.load(&mut program(&settings("individual", &[("speed", "1.5")])));
        (0..100).for_each(|_| assert!(machine.step().is_none()));
        assert_eq!((machine.sample().speed, machine.trip().is_some()), (0.0, true));
        machine.restart();
        machine.step();
        assert_eq!((machine.sample().speed, machine.trip(), machine.tau()), (1.5, None, DTAU));
    }
}

#[test]
fn an_orbit_that_goes_on_growing_is_held_at_ten_times_the_limit() {
    let mut machine = tripped(&settings("off", &[("coast_down", "1e-4")]));
    let trip = (0..1_000_000).find_map(|_| machine.step()).expect("it is unstable for long");
    assert_eq!((trip.cause, trip.limit, machine.is_held()), (TripCause::Orbit, LOST * 5.0, true));
    let (tau, speed) = (machine.tau(), machine.sample().speed);
    assert!(machine.step().is_none() && (machine.tau(), machine.sample().speed) == (tau, speed) && speed > 2.4);
}

#[test]
fn a_coast_down_is_taken_up_to_the_last_bit() {
    for changes in [&[][..], &[("delay", "0.02")]] {
        let settings = settings("off", changes);
        let mut machine = tripped(&settings);
        // Other gains and an aim at rest, where it is on its steady path again at the end.
        for (at, speed) in [(0, "2.5"), (500, "0"), (9000, "0"), (100, "2")] {
            (0..at).for_each(|_| assert!(machine.step().is_none()));
            let next = Settings { speed: speed.parse().expect("a number"), ..settings.clone() };
            machine.load(&mut program(&next));
            let mut other = Machine::new(*program(&next));
            (0..37).for_each(|_| assert!(machine.step().is_none()));
            assert!(other.restore(&mut StateWords::from_saved(saved(&machine))));
            for _ in 0..50 {
                assert!(machine.step().is_none() && other.step().is_none());
                assert_eq!(saved(&machine), saved(&other), "{changes:?}, towards {speed}");
                assert_eq!(machine.sample().angle, other.sample().angle);
            }
        }
        assert_eq!(machine.sample().speed, 0.0);
    }
}

/// A ramp that was set while the speed rested left a snapshot whose angle was of another time.
#[test]
fn regress_a_snapshot_after_a_ramp_was_set_has_the_angle() {
    let settings = settings("individual", &[]);
    let mut machine = Machine::new(*program(&settings));
    (0..100).for_each(|_| assert!(machine.step().is_none()));
    let next = Settings { ramp: 0.1, ..settings };
    machine.load(&mut program(&next));
    (0..50).for_each(|_| assert!(machine.step().is_none()));
    assert_eq!(machine.path, Path::Steady);
    let mut other = Machine::new(*program(&next));
    assert!(other.restore(&mut StateWords::from_saved(saved(&machine))));
    assert_eq!(machine.sample().angle, other.sample().angle);
}
