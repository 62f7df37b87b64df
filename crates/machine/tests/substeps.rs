//! A step is cut as finely as the machine gets fast at any speed that it passes, not only where it begins and ends.

use machine::{Pace, Program};
use rotor::profile::Profile;
use rotor::{Gain, GainKind, Rotor, Settings, builtin};

const PACE: Pace = Pace { dtau: 0.1, rate_hz: 1000.0 };

/// Weak at rest and at R = 4, stiff at R = 2: the column of a gain that is looked up over speed.
fn settings(rotor: &Rotor, ramp: f64, coast_down: f64) -> Settings {
    let mut feedback = builtin::feedback(rotor, "individual").expect("built in");
    let table = Gain::Table(vec![(0.0, 0.1), (1.0, 0.1), (2.0, 400.0), (3.0, 0.1), (4.0, 0.1)]);
    *feedback.first_mut().signals[0].gain_mut(GainKind::Kd) = table;
    Settings { ramp, coast_down, ..Settings::new(rotor, 4.0, feedback) }
}

fn rotor() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

fn at(speed: f64) -> u32 {
    let rotor = rotor();
    let there = Settings { speed, ..settings(&rotor, f64::INFINITY, 0.0) };
    Program::compile(&rotor, &there, [speed; 2], PACE).expect("can be stepped").substeps()
}

#[test]
fn a_ramp_a_profile_and_a_coast_down_are_as_fine_as_the_stiffest_speed_on_the_way() {
    let rotor = rotor();
    let compile = |ramp, coast_down, have| {
        Program::compile(&rotor, &settings(&rotor, ramp, coast_down), have, PACE).expect("can be stepped").substeps()
    };
    let [ends, stiff] = [at(4.0).max(at(0.0)), at(2.0)];
    assert!(stiff > ends, "{stiff} parts at the stiff speed, {ends} at the ends");
    assert_eq!(compile(0.01, 0.0, [0.0, 0.0]), stiff, "a ramp from rest");
    assert_eq!(compile(0.01, 0.0, [3.5, 3.2]), ends, "a ramp that does not come there");
    assert_eq!(compile(f64::INFINITY, 0.0, [4.0; 2]), ends, "a jump passes nothing");
    assert_eq!(compile(f64::INFINITY, 0.01, [4.0; 2]), stiff, "a trip would let it coast down through it");
    let profile = Profile::ramp(0.0, 4.0, 0.01);
    let program = Program::compile_profile(&rotor, &settings(&rotor, 0.01, 0.0), &profile, PACE).expect("can be");
    assert_eq!(program.substeps(), stiff);
    let step = |speeds| machine::default_step_over(&rotor, &settings(&rotor, 0.01, 0.0), speeds).expect("modes");
    assert!(step([0.0, 4.0]) < 0.5 * step([3.2, 4.0]));
}
