//! The rotor on two magnetic bearings against ROSS's matrices closed by another program (SciPy): poles, sensitivity, delay margin.

use linear::SeveralLoops;
use machine::{Machine, MachineLoop, MachinePoles, Program, margins};
use nalgebra::DVector;
use rotor::{C64, LinearForm, OperatingPoint, Plant, Rotor, Settings, builtin};
use serde_json::Value;

fn case(name: &str) -> Value {
    let text = match name {
        "amb_lead" => include_str!("../../beam/tests/cases/amb_lead.json"),
        _ => include_str!("amb_lead_delay.json"),
    };
    serde_json::from_str(text).expect("JSON")
}

fn rig() -> (Rotor, Settings) {
    let rotor = builtin::rotor("rig").expect("built in");
    let own = builtin::feedback(&rotor, "own").expect("it has a law of its own");
    let settings = Settings::new(&rotor, 0.0, own);
    (rotor, settings)
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Of the poles from 5 rad/s to 1500 Hz at five speeds, each reduced to what is stepped.
#[test]
fn val_its_poles_are_those_of_the_whole_rotor() {
    let (rotor, settings) = rig();
    let w0 = rotor.scales().expect("SI").w0;
    for (speed, expected) in case("amb_lead")["speeds"].as_object().expect("speeds") {
        let speed: f64 = speed.parse().expect("rad/s");
        let found = MachinePoles::at(&rotor, &settings, speed / w0).expect("found");
        assert!(found.modes.iter().all(|mode| mode.pole.re < 0.0), "stable at {speed}");
        for pole in expected["poles_5rad_to_1500Hz"].as_array().expect("poles") {
            let exact = C64::new(number(&pole[0]), number(&pole[1]));
            let nearest = found.modes.iter().map(|mode| (mode.pole * w0 - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-4 * exact.norm(), "{exact} at {speed} rad/s is off by {nearest}");
        }
    }
}

#[test]
fn val_its_sensitivity_and_the_delay_it_bears_are_those_of_the_whole_rotor() {
    let (rotor, settings) = rig();
    let scales = rotor.scales().expect("SI");
    for (at, expected) in [("0", 178.29e-6), ("628.319", 176.36e-6), ("1200", 175.18e-6)] {
        let speed = at.parse::<f64>().expect("rad/s") / scales.w0;
        let found = margins(&rotor, &settings, speed).expect("stable");
        let delay = scales.seconds(found.margins.delay.expect("some delay is too much").delay);
        assert!((delay - expected).abs() < 5e-4 * expected, "{delay} s at {at} rad/s");
        let peaks = &case("amb_lead")["speeds"][at]["peak_sensitivity"];
        for (bearing, peak) in found.bearings.iter().zip(peaks.as_array().expect("one a bearing")) {
            let ours = bearing.margins.sensitivity().amplitude;
            // Twelve coordinates: the table of the case has 5e-4 for sixteen.
            assert!((ours - number(&peak[0])).abs() < 2e-3 * ours, "{ours} for {}", peak[0]);
        }
    }
    // And with a delay in both loops, of all the coordinates of its elements.
    let mut late = settings.clone();
    late.feedback.set_delay(scales.tau(100e-6));
    let whole = rotor.in_full().expect("a plant");
    let each: Vec<_> = (MachineLoop::each(&whole, &late, 0.0).expect("fits").into_iter()).map(|m| m.gain).collect();
    for (gain, peak) in each.iter().zip([2.465_775, 2.057_126]) {
        let ours = gain.margins().sensitivity().amplitude;
        assert!((ours - peak).abs() < 5e-3 * peak, "{ours} for {peak}");
    }
    let together = SeveralLoops::of(&each).expect("found");
    assert!(together.largest_sensitivity.amplitude >= 2.46);
}

/// The same machine in motion: what is stepped settles to the response that its matrices say.
#[test]
fn val_in_motion_it_settles_to_its_unbalance_response() {
    let (rotor, mut settings) = rig();
    settings.speed = 3.0;
    let response = machine::unbalance_response(&rotor, &settings, [3.0, 3.001]).expect("found").expect("continuous");
    let pace = machine::Pace { dtau: 0.01, rate_hz: 0.0 };
    let mut machine = Machine::new(Program::compile(&rotor, &settings, [3.0; 2], pace).expect("can be stepped"));
    // Its slowest pole, the integrators', fades as exp(-0.026 tau).
    (0..30_000).for_each(|_| assert!(machine.step().is_none()));
    let sample = machine.sample();
    let turned = C64::cis(-sample.angle);
    for (ours, exact) in sample.displacement.iter().zip(&response.points[0].stations) {
        assert!((ours * turned - exact).norm() < 1e-3 * (1.0 + exact.norm()), "{} and {exact}", ours * turned);
    }
}

/// What shaft elements make of the matrices is far from normal: a proof that rounding has spoilt is none.
#[test]
fn what_is_proven_of_the_rig_is_not_below_what_is_found() {
    let (rotor, settings) = rig();
    for speed in [0.0, 0.75, 1.5, 3.0, 3.010_876_865_75, 3.06, 3.26, 4.5] {
        let found = margins(&rotor, &settings, speed).expect("stable");
        let peak = found.together.expect("two bearings").largest_sensitivity.amplitude;
        let machine = MachineLoop::at(&rotor, &settings, speed).expect("fits");
        let proven = machine.certified_peak().expect("a bound").expect("continuous");
        assert!(proven.below >= peak * (1.0 - 1e-9), "{} at {speed}, but {peak} is found", proven.below);
        assert!(proven.below <= peak * (1.0 + 1e-4), "{} at {speed}, but {peak} is all that is found", proven.below);
    }
}

/// Sampled, in the steps that it is compiled for, with samples on steps and between them: it moves by the powers of its matrix, whose
/// eigenvalues its poles are.
#[test]
fn val_sampled_it_moves_by_the_powers_of_its_step() {
    let text = include_str!("../../rotor/src/rig.toml").split("[[unbalance]]").next().expect("some").to_owned();
    let rotor = rotor::file::read_rotor(&text, "balanced").expect("a rotor");
    let scales = *rotor.scales().expect("SI");
    for (rate, late, parts) in [(20e3, 1.3, 7.3), (5e3, 0.3, 4.0)] {
        let mut settings = rig().1;
        settings.speed = scales.speed(6000.0);
        let sample = scales.tau(1.0 / rate);
        for bearing in &mut settings.feedback.bearings {
            (bearing.parts.sample, bearing.parts.delay) = (sample, late * sample);
        }
        let at = OperatingPoint::at(settings.speed);
        let form = LinearForm::of(&Plant::of(&rotor), &settings.feedback, &at).expect("fits");
        let step = form.sampled().expect("sampled");
        let pace = machine::Pace { dtau: sample / parts, rate_hz: 0.0 };
        let mut machine = Machine::new(Program::compile(&rotor, &settings, [settings.speed; 2], pace).expect("can be"));
        let kick: Vec<C64> = (0..rotor.len()).map(|k| C64::new(0.1 * k as f64, 0.3)).collect();
        machine.place(&kick, &vec![C64::ZERO; rotor.len()]);
        let mut x: DVector<C64> = DVector::zeros(step.a.nrows());
        x.rows_mut(0, kick.len()).copy_from_slice(&kick);
        for _ in 0..20 {
            // Ten samples are a whole number of steps.
            (0..(10.0 * parts) as usize).for_each(|_| assert!(machine.step().is_none()));
            (0..10).for_each(|_| x = &step.a * &x);
            for (q, exact) in machine.sample().displacement.iter().zip(x.iter()) {
                assert!((q - exact).norm() < 2e-6, "{q} and {exact} at {rate} Hz");
            }
        }
        for z in MachinePoles::of(&rotor, &settings).expect("found").z.expect("sampled") {
            let mut m = -step.a.clone();
            (0..m.nrows()).for_each(|k| m[(k, k)] += z);
            let least = m.singular_values().min();
            assert!(least < 1e-9, "{z} is no eigenvalue of the step: {least}");
        }
    }
}
