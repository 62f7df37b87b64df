//! The numbers that the report prints, and the exact values behind them (physics: poles).

use rotor::{ClosedLoop, Modes, Rotor, Whirl, builtin};

fn modes_of(rotor: &Rotor, feedback: &str, speed: f64) -> Modes {
    let feedback = builtin::feedback(rotor, feedback).expect("built in");
    Modes::of(&ClosedLoop::new(rotor, &feedback, speed, &[])).expect("converges")
}

#[track_caller]
fn close(ours: f64, theirs: f64, tolerance: f64) {
    assert!((ours - theirs).abs() <= tolerance, "{ours} is not {theirs} within {tolerance}");
}

fn jeffcott() -> Rotor {
    builtin::rotor("jeffcott").expect("built in")
}

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

#[test]
fn val_jeffcott_at_rest_has_the_poles_the_report_prints() {
    let at_rest = modes_of(&jeffcott(), "off", 0.0);
    assert_eq!(at_rest.modes.len(), 2);
    for (whirl, re, im) in [(Whirl::Forward, -0.557_231, 0.973_656), (Whirl::Backward, -0.442_769, -0.773_656)] {
        let mode = at_rest.modes.iter().find(|m| m.whirl() == whirl).expect("one of each");
        close(mode.pole.re, re, 5e-7);
        close(mode.pole.im, im, 5e-7);
    }
    close(at_rest.min_damping(), 0.496_714, 5e-7);
    close(modes_of(&jeffcott(), "off", 0.78).min_damping(), 0.322_721, 5e-7);
}

#[test]
fn val_jeffcott_loses_stability_at_2_21_whirling_forward_at_half_speed() {
    let threshold = 2.209_975;
    assert!(modes_of(&jeffcott(), "off", threshold - 1e-5).is_stable());
    let beyond = modes_of(&jeffcott(), "off", threshold + 1e-5);
    assert!(!beyond.is_stable());
    assert_eq!(beyond.modes[0].whirl(), Whirl::Forward);
    close(beyond.modes[0].frequency(), 1.104_988, 1e-5);
}

#[test]
fn val_the_cancelling_law_holds_the_poles_of_rest_at_any_speed() {
    let at_rest = modes_of(&jeffcott(), "off", 0.0);
    for speed in [0.5, 2.3, 5.0, 40.0] {
        let held = modes_of(&jeffcott(), "cancel", speed);
        for (held, rest) in held.modes.iter().zip(&at_rest.modes) {
            close((held.pole - rest.pole).norm(), 0.0, 1e-12);
        }
    }
}

#[test]
fn val_three_mass_thresholds_are_1_776_4_101_and_4_650() {
    let unstable = |speed| modes_of(&three_mass(), "off", speed).modes.iter().filter(|m| m.pole.re > 0.0).count();
    for (already, threshold) in [(0, 1.775_522), (1, 4.101_250), (2, 4.650_456)] {
        assert_eq!((unstable(threshold - 2e-6), unstable(threshold + 2e-6)), (already, already + 1), "at {threshold}");
    }
}

#[test]
fn val_three_mass_bounces_pitches_and_bends() {
    for (threshold, shape) in
        [(1.775_522, [0.606, 1.0, 0.606]), (4.101_250, [-1.0, 0.0, 1.0]), (4.650_456, [1.0, -0.587, 1.0])]
    {
        let modes = modes_of(&three_mass(), "off", threshold).modes;
        let crossing = modes.iter().min_by(|a, b| a.pole.re.abs().total_cmp(&b.pole.re.abs())).expect("six modes");
        // Shapes are scaled to a largest component of 1, whichever of two equal ones that is: compare up to sign.
        let sign = (crossing.shape[0].re * shape[0]).signum();
        for (ours, theirs) in crossing.shape.iter().zip(shape) {
            close(ours.re * sign, theirs, 6e-4);
            close(ours.im, 0.0, 1e-5);
        }
    }
}

#[test]
fn val_builtin_feedback_holds_the_range_it_claims() {
    let worst = |name: &str, top: f64| {
        (0..=1000).map(|i| modes_of(&three_mass(), name, top * f64::from(i) / 1000.0).min_damping()).fold(1.0, f64::min)
    };
    close(worst("composite", 7.0), 0.0036, 1e-4);
    assert!(worst("composite", 7.1) < 0.0);
    assert!(worst("individual", 7.2) > 0.0);
}
