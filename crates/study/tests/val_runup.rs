//! Motion at a changing speed against SciPy's DOP853 and against Duhamel's integral (F. M. Lewis, 1932); see
//! tests/reference/runup.py.

use std::sync::atomic::AtomicBool;

use machine::{Machine, Pace, Program};
use rotor::profile::{Leg, Profile};
use rotor::{C64, Feedback, Filter, Gain, GainKind, Mass, Rotor, Settings, Signal, builtin};
use study::runup::{OrderSample, RecordedCourse, RunUp, RunUpError, RunUpPlan};

fn reference() -> serde_json::Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/runup.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("committed")).expect("JSON")
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().expect("a number")
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// The rotor of the script: mass, zeta, zeta_q, Rb, Rs, Re.
fn five() -> (Rotor, Settings) {
    let table = [
        [0.10, 0.30, 0.05, 0.3, 0.05, 0.3, 0.05],
        [0.30, 0.10, 0.02, 0.0, 0.02, 0.1, 0.0],
        [0.20, 0.20, 0.00, 0.2, 0.03, 0.4, 0.10],
        [0.25, 0.15, 0.01, 0.0, 0.04, -0.2, 0.0],
        [0.15, 0.25, 0.04, 0.4, 0.06, 0.2, 0.15],
    ];
    let rotor = Rotor::new("five", table.map(Mass::from_values).to_vec(), vec![0.4, 0.6, 0.5, 0.3]).expect("valid");
    let signal = Signal::composite(&[0.2, 1.0, 0.3, 0.0, 0.1], [0.1, 0.3, -0.1, 0.05]);
    let settings = Settings::new(&rotor, 0.0, Feedback::new(1, vec![signal]));
    (rotor, settings)
}

#[test]
fn val_trajectories_at_changing_speeds_agree_with_dop853() {
    let (rotor, settings) = five();
    for case in reference()["cases"].as_array().expect("a list") {
        agrees(&rotor, &settings, case);
    }
}

/// Gains that are tables of speed, as they are at each moment, behind a notch that follows the speed, on bearings without clearance.
#[test]
fn val_gains_and_filters_that_follow_a_changing_speed_agree_with_dop853() {
    let (rotor, mut settings) = five();
    let scheduled = &reference()["scheduled"];
    let speeds = numbers(&scheduled["gain_speeds"]);
    let bearing = &mut settings.feedback.bearings[0];
    for kind in GainKind::ALL {
        let values = numbers(&scheduled["gains"][kind.name()]);
        *bearing.signals[0].gain_mut(kind) = Gain::Table(speeds.iter().copied().zip(values).collect());
    }
    bearing.filters = vec![Filter::SynchronousNotch { width: number(&scheduled["notch"]) }];
    settings.deadband.fill(0.0);
    for case in scheduled["cases"].as_array().expect("a list") {
        agrees(&rotor, &settings, case);
    }
}

/// Steps a machine along the profile of a case, and holds it to the states there.
fn agrees(rotor: &Rotor, settings: &Settings, case: &serde_json::Value) {
    let [from, to, rate] = ["from", "to", "rate"].map(|key| number(&case[key]));
    let leg = if case["kind"] == "decay" { Leg::Decay { speed: to, rate } } else { Leg::To { speed: to, rate } };
    let profile = Profile { from, legs: vec![leg], lines: vec![0] };
    // Small enough that the corners of the deadband, which a fixed step does not see, cost less than what is compared.
    let dtau = 0.001;
    let pace = Pace { dtau, rate_hz: 0.0 };
    let program = Program::compile_profile(rotor, settings, &profile, pace).expect("can be stepped");
    let mut machine = Machine::new(program);
    let mut steps = 0;
    for (k, tau) in numbers(&case["tau"]).into_iter().enumerate() {
        while steps < (tau / dtau).round() as u64 {
            machine.step();
            steps += 1;
        }
        let sample = machine.sample();
        assert!((sample.speed - number(&case["speed"][k])).abs() < 1e-12, "{case:?}");
        assert!((sample.angle - number(&case["angle"][k])).abs() < 1e-9, "{case:?}");
        let state = numbers(&case["states"][k]);
        let size = state[..10].iter().fold(0.0_f64, |most, x| x.abs().max(most));
        for (i, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
            let [y, z, vy, vz] = [0, 5, 10, 15].map(|at| state[at + i]);
            let off = (p - C64::new(y, z)).norm().max((v - C64::new(vy, vz)).norm());
            assert!(off < 1e-6 * size.max(1.0), "mass {} at {tau}: {off:e} off", i + 1);
        }
    }
}

/// One mass without damping, unbalance 1, natural frequency 1.
fn bare() -> (Rotor, Settings) {
    let mass = Mass { mass: 1.0, seal_stiffness: 1.0, unbalance: 1.0, ..Mass::default() };
    let rotor = Rotor::new("bare", vec![mass], vec![]).expect("valid");
    let settings = Settings::new(&rotor, 0.0, Feedback::new(0, vec![Signal::at_mass(0, 1, [0.0; 4])]));
    (rotor, settings)
}

fn run(plan: &RunUpPlan) -> RunUp {
    plan.run(&mut |_| (), &AtomicBool::new(false)).expect("runs")
}

#[test]
fn val_a_bare_mass_passes_its_critical_speed_as_lewis_has_it() {
    let mut peaks = Vec::new();
    for case in reference()["lewis"].as_array().expect("a list") {
        let [rate, until] = ["rate", "until"].map(|key| number(&case[key]));
        let (rotor, settings) = bare();
        let profile = Profile::ramp(0.0, rate * until, rate);
        let plan = RunUpPlan { rotor, settings, profile, dtau: 0.005, points: 400 };
        let (mut top, mut fell, mut end) = ((0.0, 0.0), false, C64::ZERO);
        plan.run(
            &mut |machine| {
                let sample = machine.sample();
                end = sample.displacement[0];
                fell |= sample.speed > 1.0 && end.norm() < top.1;
                if !fell && end.norm() > top.1 {
                    top = (sample.speed, end.norm());
                }
            },
            &AtomicBool::new(false),
        )
        .expect("runs");
        let exact = numbers(&case["end"]);
        assert!((end - C64::new(exact[0], exact[1])).norm() < 1e-6 * top.1.max(1.0), "{rate}: {end} {exact:?}");
        assert!((top.1 / number(&case["peak"]) - 1.0).abs() < 1e-6, "{rate}: {top:?}");
        assert!((top.0 - number(&case["peak_speed"])).abs() < 2.0 * 0.005 * rate, "{rate}: {top:?}");
        peaks.push(top);
    }
    // Faster: later and lower.
    assert!(peaks.windows(2).all(|pair| pair[1].0 > pair[0].0 && pair[1].1 < pair[0].1), "{peaks:?}");
}

#[test]
fn val_a_slow_run_up_shows_the_steady_critical_speeds() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "individual").expect("built in"));
    let mut off = Vec::new();
    for rate in [0.02, 0.005, 0.00125] {
        let plan = RunUpPlan::new(rotor.clone(), settings.clone(), Profile::ramp(0.0, 4.0, rate), 200)
            .expect("can be stepped");
        let found = run(&plan);
        let first =
            found.criticals.iter().filter(|c| c.station == 0).max_by(|a, b| a.peak.height.total_cmp(&b.peak.height));
        let (peak, steady) = first.map(|c| (c.peak, c.steady.expect("belongs to one"))).expect("there is one");
        off.push((
            (peak.speed / steady.speed - 1.0).abs(),
            (peak.height / steady.height - 1.0).abs(),
            (peak.amplification().expect("both") / steady.amplification().expect("both") - 1.0).abs(),
        ));
    }
    assert!(
        off.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1 && pair[1].2 < pair[0].2),
        "{off:?}"
    );
    assert!(off[2].0 < 0.01 && off[2].1 < 0.02 && off[2].2 < 0.1, "{off:?}");
}

#[test]
fn self_excited_whirl_is_no_critical_speed() {
    // Past 1.78 the bare rotor whirls at its own frequency and grows until it trips: the first order ripples with it.
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "off").expect("built in"));
    let plan = RunUpPlan::new(rotor, settings, Profile::ramp(0.0, 6.0, 0.01), 400).expect("can be stepped");
    let found = run(&plan);
    assert!(found.tripped.is_some());
    assert!(found.criticals.iter().all(|c| c.peak.speed < 1.3), "{:?}", found.criticals);
    assert_eq!(found.criticals.len(), 3);
    let slow = found.points.last().and_then(|p| p.subsynchronous.clone()).expect("eight turns");
    assert!(slow[1] > 100.0, "{slow:?}");
}

#[test]
fn the_beats_after_a_critical_speed_are_no_critical_speeds_and_levels_are_of_every_turn() {
    // One mode, hardly damped, passed fast: it rings on at its own frequency.
    let mass = Mass {
        mass: 1.0,
        damping: 0.0148,
        bearing_stiffness: 0.8,
        seal_stiffness: 0.2,
        unbalance: 1.0,
        ..Mass::default()
    };
    let rotor = Rotor::new("light", vec![mass], vec![]).expect("valid");
    let settings = Settings::new(&rotor, 0.0, Feedback::new(0, vec![Signal::at_mass(0, 1, [0.0; 4])]));
    let ran = |points| {
        let profile = Profile::ramp(0.0, 1.8, 5e-4);
        run(&RunUpPlan::new(rotor.clone(), settings.clone(), profile, points).expect("can be stepped"))
    };
    let (few, many) = (ran(2), ran(400));
    assert_eq!(many.criticals.len(), 1, "{:?}", many.criticals);
    assert!(many.criticals[0].steady.is_some());
    assert_eq!((few.largest, few.criticals.len()), (many.largest, 1));
    assert!(many.largest.radius.0 >= many.criticals[0].peak.height * 0.999);
}

#[test]
fn a_fast_run_up_keeps_the_largest_peak() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "individual").expect("built in"));
    let found = run(&RunUpPlan::new(rotor, settings, Profile::ramp(0.0, 6.0, 0.1), 400).expect("can be stepped"));
    let stations: Vec<usize> = found.criticals.iter().map(|critical| critical.station).collect();
    assert_eq!(stations, [2, 1, 0], "{:?}", found.criticals);
}

/// What a recording's reader finds in the steps of a motion is what the run-up itself found, and legs are where they were.
#[test]
fn steps_tell_the_legs_and_critical_speeds_of_the_run_that_made_them() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "individual").expect("built in"));
    let legs = vec![
        Leg::To { speed: 4.0, rate: 0.01 },
        Leg::Dwell { duration: 50.0 },
        Leg::Decay { speed: 0.5, rate: 0.02 },
        Leg::To { speed: 1.0, rate: 0.05 },
    ];
    let profile = Profile { from: 0.0, lines: vec![0; legs.len()], legs };
    let plan = RunUpPlan::new(rotor.clone(), settings.clone(), profile, 100).expect("can be stepped");
    let mut course = RecordedCourse::new(&rotor);
    let mut seq = 0;
    let in_force = |_: u64| Some(&settings);
    let mut see = |machine: &Machine| {
        let sample = machine.sample();
        let read = OrderSample {
            tau: sample.tau,
            angle: sample.angle,
            speed: sample.speed,
            displacement: sample.displacement,
            velocity: sample.velocity,
            force: 0.0,
        };
        course.see(seq, &read, sample.acceleration, &in_force);
        seq += 1;
    };
    let found = plan.run(&mut see, &AtomicBool::new(false)).expect("runs");
    let told = course.legs(&in_force);
    assert_eq!(told.len(), 4, "{told:?}");
    assert_eq!(told.iter().map(|leg| leg.rests()).collect::<Vec<_>>(), [false, true, false, false]);
    for (leg, ends) in told.iter().zip(found.course.windows(2)) {
        let step = 1.1 * plan.dtau;
        assert!((leg.tau[0] - ends[0].0).abs() < step && (leg.tau[1] - ends[1].0).abs() < step, "{leg:?} {ends:?}");
        assert!((leg.speed[0] - ends[0].1).abs() < 0.05 * step && (leg.speed[1] - ends[1].1).abs() < 0.05 * step);
    }
    let criticals: Vec<_> = told.iter().flat_map(|leg| leg.criticals.iter().flatten()).collect();
    assert_eq!(criticals.len(), found.criticals.len());
    assert!(criticals.len() >= 3, "{criticals:?}");
    for (told, found) in criticals.iter().zip(&found.criticals) {
        assert_eq!((told.leg, told.station), (found.leg, found.station));
        assert!((told.peak.speed - found.peak.speed).abs() < 1e-9, "{told:?} {found:?}");
        assert!((told.peak.height / found.peak.height - 1.0).abs() < 1e-9, "{told:?} {found:?}");
    }
}

/// A steady machine has no legs; one whose speed jumps has two; steps far apart tell legs without critical speeds.
#[test]
fn jumps_restarts_and_steps_far_apart() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let settings = Settings::new(&rotor, 1.0, Feedback::new(0, vec![]));
    let legs = |steps: &[(f64, f64, f64)]| {
        let mut course = RecordedCourse::new(&rotor);
        let in_force = |_: u64| Some(&settings);
        for (seq, (tau, angle, speed)) in steps.iter().enumerate() {
            let still = [C64::ZERO];
            let [tau, angle, speed] = [*tau, *angle, *speed];
            let read = OrderSample { tau, angle, speed, displacement: &still, velocity: &still, force: 0.0 };
            course.see(seq as u64, &read, 0.0, &in_force);
        }
        course.legs(&in_force)
    };
    let at = |k: usize, speed: f64| (0.1 * k as f64, 0.1 * k as f64 * speed, speed);
    assert_eq!(legs(&(0..50).map(|k| at(k, 1.0)).collect::<Vec<_>>()), []);
    let jumped = legs(&(0..50).map(|k| at(k, if k < 20 { 1.0 } else { 2.0 })).collect::<Vec<_>>());
    assert_eq!(
        jumped.iter().map(|leg| (leg.steps, leg.speed)).collect::<Vec<_>>(),
        [([0, 19], [1.0; 2]), ([20, 49], [2.0; 2])]
    );
    let again = legs(&(0..40).map(|k| at(k % 20, if k < 20 { 1.0 } else { 2.0 })).collect::<Vec<_>>());
    assert_eq!((again.len(), again[1].tau), (2, [0.0, 0.1 * 19.0]));
    let coarse = legs(&(0..40).map(|k| (f64::from(k), f64::from(k), 1.0 + f64::from(k / 20))).collect::<Vec<_>>());
    assert!(coarse.iter().all(|leg| leg.criticals.is_none()), "{coarse:?}");
}

/// What comes after the last step, the steady response, is the longest part of a run-up of a shaft.
#[test]
fn a_run_up_that_is_over_and_is_asked_to_stop_stops() {
    let rotor = builtin::rotor("rig").expect("built in");
    let own = builtin::feedback(&rotor, "own").expect("it has a law");
    let settings = Settings::new(&rotor, 0.0, own);
    let profile = Profile { from: 2.0, legs: vec![Leg::To { speed: 4.0, rate: 0.05 }], lines: vec![0] };
    let duration = profile.duration();
    let plan = RunUpPlan::new(rotor, settings, profile, 10).expect("can be stepped");
    let stop = AtomicBool::new(false);
    let mut see = |machine: &Machine| {
        if machine.tau() > duration - 2.0 * plan.dtau {
            stop.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    };
    assert!(matches!(plan.run(&mut see, &stop), Err(RunUpError::Interrupted)));
    assert!(study::runup::steady_response(&plan, &stop).is_none());
}
