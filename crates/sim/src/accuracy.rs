//! What a live bench shows is what is exact, whatever the settings: the engine against closed forms.

use rotor::circular::synchronous;
use rotor::{C64, J, Rotor, Settings, builtin, poles};
use wire::{BenchName, State, Step, StepLayout};

use crate::Options;
use crate::engine::Engine;

fn jeffcott(feedback: &str, speed: f64, deadband: f64) -> (Rotor, Settings) {
    let rotor = builtin::rotor("jeffcott").unwrap();
    let mut settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
    settings.deadband.fill(deadband);
    (rotor, settings)
}

fn options(dtau: f64) -> Options {
    Options { bench: BenchName::default(), rate_hz: Options::DEFAULT_RATE_HZ, dtau, ..Options::default() }
}

/// The state after `tau`, from rest.
fn shown(rotor: &Rotor, settings: &Settings, dtau: f64, tau: f64) -> State {
    let mut engine = Engine::new(options(dtau).check(rotor, settings).unwrap(), 7, 1000);
    for _ in 0..(tau / dtau).round() as u64 {
        assert_eq!(engine.step(), None);
    }
    let mut state = State::new(StepLayout::new(rotor.len()));
    engine.fill(&mut state.row_mut(), 0, false);
    state
}

fn assert_steady(rotor: &Rotor, settings: &Settings, tau: f64) -> (f64, f64) {
    let state = shown(rotor, settings, 0.01, tau);
    let exact = synchronous(rotor, &settings.feedback, &settings.deadband, &[settings.speed]).unwrap();
    let orbit = &exact.orbits[0][0];
    let [force, other] = state.force_delivered();
    let (radius, force) = (state.point(0).radius(), force.hypot(other));
    assert!((radius / orbit.radii()[0] - 1.0).abs() < 1e-4, "radius {radius} for {:?}", orbit.radii());
    assert!((force - orbit.force).abs() <= 1e-4 * orbit.force, "force {force} for {}", orbit.force);
    (radius, force)
}

#[test]
fn val_a_fast_spin_shows_the_exact_radius_and_force() {
    // One Runge-Kutta step of 0.01 showed a radius of 0.860 and a force of 129.2 at R = 300, and tripped at 628.3.
    let (rotor, settings) = jeffcott("cancel", 300.0, 1.0);
    let (radius, force) = assert_steady(&rotor, &settings, 60.0);
    assert!((radius - 1.0007).abs() < 1e-4 && (force - 150.1).abs() < 0.05, "{radius} {force}");
    for speed in [628.3, 1000.0] {
        let (rotor, settings) = jeffcott("cancel", speed, 1.0);
        assert_steady(&rotor, &settings, 60.0);
    }
}

#[test]
fn val_stiff_gains_that_are_stable_do_not_trip() {
    // |lambda| dtau = 3.0: one Runge-Kutta step grew to 1412 e_t and tripped.
    let (rotor, mut settings) = jeffcott("off", 2.5, 0.0);
    for (key, value) in [("kd", "90000"), ("cd", "20"), ("kc", "0"), ("cc", "0")] {
        settings.assign(key, value).unwrap();
    }
    assert_steady(&rotor, &settings, 10.0);
    // Where nothing damps what is stiff but the seal.
    settings.assign("cd", "0").unwrap();
    assert_steady(&rotor, &settings, 40.0);
}

#[test]
fn val_an_unstable_rotor_grows_as_its_pole_says_at_any_step() {
    // At a step of 1 it stayed small.
    let (rotor, mut settings) = jeffcott("off", 2.25, 0.0);
    settings.trip = 1e9;
    let [one, other] = poles(&settings.closed_loop(&rotor)).unwrap()[..] else { panic!("two poles") };
    assert!(one.re > 0.0);
    let turn = J * settings.speed;
    let forced = C64::from(settings.speed.powi(2)) / ((turn - one) * (turn - other));
    let first = -forced * (turn - other) / (one - other);
    for (dtau, tau) in [(1.0, 200.0), (1.0, 1200.0), (0.5, 1200.0), (0.01, 200.0)] {
        let exact = first * (one * tau).exp() + (-forced - first) * (other * tau).exp() + forced * (turn * tau).exp();
        let radius = shown(&rotor, &settings, dtau, tau).point(0).radius();
        assert!((radius / exact.norm() - 1.0).abs() < 1e-4, "{radius} for {} at {tau} by {dtau}", exact.norm());
    }
}

#[test]
fn what_no_substeps_can_follow_in_time_is_refused_at_the_start() {
    let (rotor, mut settings) = jeffcott("off", 2.5, 0.0);
    settings.assign("cd", "1e6").unwrap();
    let refused = options(0.01).check(&rotor, &settings).unwrap_err().to_string();
    assert!(refused.contains("at 1000 steps a second there is time for 3333"), "{refused}");
    assert!(options(0.00049).check(&rotor, &settings).is_ok(), "what it says would do does");
}
