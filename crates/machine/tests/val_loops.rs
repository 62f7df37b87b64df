//! The machine in motion against its own matrices, the fused path, and exact poles: neither knows the other.

use control::{Filter, Parts};
use machine::{Leg, LinearForm, Machine, Program, StateWords};
use rotor::{C64, Mass, OperatingPoint, Plant, Rotor, Settings, builtin, eigenvalues};

/// The three-mass rotor without unbalance, so that nothing but a disturbance moves it.
fn balanced() -> Rotor {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let masses: Vec<Mass> = rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect();
    Rotor::new("balanced", masses, rotor.shafts().to_vec()).expect("valid")
}

fn settings(rotor: &Rotor, speed: f64, change: impl Fn(&mut rotor::Feedback)) -> Settings {
    let three_mass = builtin::rotor("three-mass").expect("built in");
    let mut feedback = builtin::feedback(&three_mass, "composite").expect("built in");
    change(&mut feedback);
    let mut settings = Settings::new(rotor, speed, feedback);
    settings.trip = 1e9;
    settings
}

/// The growth per unit of time of the last that is left of a disturbance.
fn simulated(machine: &mut Machine, dtau: f64, between: u64, until: f64) -> C64 {
    machine.kick(1, C64::new(1.0, 0.3));
    let steps = (until / dtau).round() as u64;
    (0..steps).for_each(|_| assert!(machine.step().is_none()));
    let before = machine.sample().displacement[1];
    (0..between).for_each(|_| assert!(machine.step().is_none()));
    (machine.sample().displacement[1] / before).ln() / (between as f64 * dtau)
}

fn rightmost(poles: impl IntoIterator<Item = C64>) -> C64 {
    poles.into_iter().filter(|s| s.re.is_finite()).max_by(|a, b| a.re.total_cmp(&b.re)).expect("there are poles")
}

/// The exact pole that lasts longest.
fn exact(rotor: &Rotor, settings: &Settings) -> C64 {
    let point = OperatingPoint::at(settings.speed);
    let form = LinearForm::of(&Plant::of(rotor), &settings.feedback, &point).expect("fits");
    if let Some(step) = form.sampled() {
        return rightmost(eigenvalues(step.a).expect("converges").into_iter().map(|z| z.ln() / step.period));
    }
    let [a, b, c] = form.continuous().expect("continuous");
    // With a delay, by iterating on exp(-s T) from without; poles here are simple and the delays short.
    let mut s = rightmost(eigenvalues(&a + &b * &c).expect("converges"));
    for _ in 0..200 {
        let factor = (-s * form.delay).exp();
        let poles = eigenvalues(&a + &b * &c * factor).expect("converges");
        s = poles.into_iter().min_by(|x, y| (x - s).norm().total_cmp(&(y - s).norm())).expect("there are poles");
    }
    s
}

fn compare(what: &str, change: impl Fn(&mut rotor::Feedback)) {
    let (rotor, speed, dtau) = (balanced(), 6.0, 0.01);
    let settings = settings(&rotor, speed, change);
    let program = Program::in_substeps(&rotor, &settings, dtau, 1).expect("can be stepped");
    let expected = exact(&rotor, &settings);
    let found = simulated(&mut Machine::new(program), dtau, 10, 1500.0);
    assert!((found - expected).norm() < 1e-4 * expected.norm(), "{what}: simulated {found:.8}, exact {expected:.8}");
}

#[test]
fn val_disturbances_grow_and_decay_as_the_poles_say_for_every_part_of_the_loop() {
    let part = |change: fn(&mut Parts)| move |f: &mut rotor::Feedback| change(&mut f.bearings[0].parts);
    compare("ideal", |_| ());
    compare("sensor lag", part(|p| p.sensor_lag = 0.02));
    compare("actuator lag", part(|p| p.lag = 0.02));
    compare("second-order actuator", part(|p| (p.lag, p.lag_damping) = (0.03, 0.7)));
    compare("delay of many steps", part(|p| p.delay = 0.0567));
    compare("delay of a step", part(|p| p.delay = 0.01));
    compare("delay within a step", part(|p| p.delay = 0.004));
    compare("tiny delay", part(|p| p.delay = 1e-5));
    compare("sampling", part(|p| p.sample = 0.05));
    compare("sampling off the grid of steps", part(|p| p.sample = 0.0125));
    compare("sampling, delay of a period", part(|p| (p.sample, p.delay) = (0.05, 0.05)));
    compare("sampling, delay within a period", part(|p| (p.sample, p.delay) = (0.05, 0.03)));
    compare("sampling, delay beyond a period, off the grid", part(|p| (p.sample, p.delay) = (0.02, 0.0333)));
    compare("low-pass", |f| f.bearings[0].signals[0].filters = vec![Filter::Lowpass { corner: 30.0, order: 2 }]);
    compare("lead", |f| f.bearings[0].signals[0].filters = vec![Filter::Lead { zero: 20.0, pole: 60.0 }]);
    compare("notch", |f| f.bearings[0].signals[0].filters = vec![Filter::Notch { frequency: 9.0, width: 0.4 }]);
    compare("synchronous notch", |f| f.bearings[0].filters = vec![Filter::SynchronousNotch { width: 0.1 }]);
    compare("derivative and integrator", |f| {
        f.bearings[0].signals[0].filters = vec![
            Filter::Integrator { rate: 0.01 },
            Filter::Transfer { numerator: vec![0.01, 1.0], denominator: vec![0.02, 1.0] },
        ];
    });
    let all = |sample: f64| {
        move |f: &mut rotor::Feedback| {
            f.bearings[0].parts = Parts { sensor_lag: 0.01, delay: 0.012, lag: 0.01, sample, ..Parts::default() };
            f.bearings[0].signals[0].filters =
                vec![Filter::Lowpass { corner: 60.0, order: 3 }, Filter::Lead { zero: 8.0, pole: 40.0 }];
            f.bearings[0].filters = vec![Filter::SynchronousNotch { width: 0.05 }];
        }
    };
    compare("all together", all(0.0));
    compare("all together, sampled", all(0.02));
}

#[test]
fn an_ideal_loop_at_a_steady_speed_is_the_fused_path_to_the_last_bit() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut settings = settings(&rotor, 6.0, |_| ());
    settings.deadband.fill(1.0);
    let mut machine = Machine::new(Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"));
    let mut stepper = rotor::stepper(&settings.closed_loop(&rotor));
    for k in 0..5000 {
        if k == 3000 {
            settings.speed = 2.0;
            let mut program = Box::new(Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"));
            machine.load(&mut program);
            stepper.load(&settings.closed_loop(&rotor));
        }
        machine.step();
        stepper.step(0.01);
        let (a, b) = (machine.sample(), stepper.motion());
        assert_eq!(
            (a.tau, a.angle, a.displacement, a.velocity),
            (b.tau, b.angle, b.displacement, b.velocity),
            "step {k}"
        );
        assert_eq!(a.outputs[0].delivered, stepper.control());
    }
}

/// A loop with everything on.
fn everything(f: &mut rotor::Feedback) {
    f.bearings[0].parts = Parts {
        sensor_lag: 0.01,
        noise: 0.001,
        quantum: 0.0005,
        seed: 7.0,
        sample: 0.025,
        delay: 0.012,
        lag: 0.01,
        limit: 20.0,
        slew: 500.0,
        ..Parts::default()
    };
    f.bearings[0].signals[0].filters = vec![Filter::Lowpass { corner: 60.0, order: 3 }];
}

#[test]
fn a_machine_that_is_restored_goes_on_to_the_last_bit() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (what, change) in [
        ("ideal", (|_| ()) as fn(&mut rotor::Feedback)),
        ("everything", everything),
        ("delay and noise", |f| (f.bearings[0].parts.delay, f.bearings[0].parts.noise) = (0.033, 0.01)),
    ] {
        for ramp in [f64::INFINITY, 0.05] {
            let mut settings = settings(&rotor, 4.0, change);
            settings.deadband.fill(1.0);
            settings.ramp = ramp;
            let program = || Program::in_substeps(&rotor, &settings, 0.01, 2).expect("can be stepped");
            let mut machine = Machine::spinning(program(), 2.0);
            (0..1500).for_each(|_| assert!(machine.step().is_none()));
            let mut words = StateWords::default();
            machine.save(&mut words);
            let mut restored = Machine::new(program());
            assert!(restored.restore(&mut StateWords::from_saved(words.as_slice().to_vec())), "{what}");
            for _ in 0..4000 {
                machine.step();
                restored.step();
                let (a, b) = (machine.sample(), restored.sample());
                assert_eq!(
                    (a.tau, a.angle, a.speed, a.displacement, a.velocity),
                    (b.tau, b.angle, b.speed, b.displacement, b.velocity),
                    "{what}"
                );
                assert_eq!(
                    (a.outputs, a.contact, machine.readings(0)),
                    (b.outputs, b.contact, restored.readings(0)),
                    "{what}"
                );
            }
        }
    }
}

#[test]
fn val_a_slow_ramp_ends_in_the_steady_motion_and_takes_the_time_it_should() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut settings = settings(&rotor, 3.0, |_| ());
    let steady = |settings: &Settings| {
        let mut machine = Machine::new(Program::in_substeps(&rotor, settings, 0.01, 1).expect("can be stepped"));
        (0..60_000).for_each(|_| assert!(machine.step().is_none()));
        machine.sample().displacement[0].norm()
    };
    let expected = steady(&settings);
    settings.ramp = 0.01;
    let mut machine = Machine::spinning(Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"), 1.0);
    (0..10_000).for_each(|_| assert!(machine.step().is_none()));
    let half_way = machine.sample();
    assert!((half_way.speed - 2.0).abs() < 1e-12 && half_way.acceleration == 0.01);
    assert!((half_way.angle - 150.0).abs() < 1e-9, "{}", half_way.angle);
    (0..70_000).for_each(|_| assert!(machine.step().is_none()));
    let end = machine.sample();
    assert_eq!((end.speed, end.acceleration), (3.0, 0.0));
    // The angle is where the ramp left it: 400 over the ramp, then 600 at speed 3.
    assert!((end.angle - (400.0 + 1800.0)).abs() < 1e-8, "{}", end.angle);
    assert!((end.displacement[0].norm() - expected).abs() < 1e-9);
}

#[test]
fn a_force_is_kept_to_its_limit_and_its_rate() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut settings = settings(&rotor, 6.0, |f| (f.bearings[0].parts.limit, f.bearings[0].parts.slew) = (3.0, 5.0));
    settings.deadband.fill(1.0);
    let mut machine = Machine::new(Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped"));
    let (mut before, mut saturated) = (C64::ZERO, 0);
    for _ in 0..3000 {
        if machine.step().is_some() {
            break;
        }
        let output = machine.sample().outputs[0];
        assert!(output.delivered.norm() <= 3.0 + 1e-12);
        assert!((output.delivered - before).norm() <= 5.0 * 0.01 + 1e-12);
        before = output.delivered;
        saturated += usize::from(output.saturated);
    }
    assert!(saturated > 100, "{saturated}");
}

#[test]
fn legs_follow_each_other() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let feedback = builtin::feedback(&rotor, "cancel").expect("built in");
    let settings = Settings::new(&rotor, 0.0, feedback);
    let legs = vec![Leg::To { speed: 1.0, rate: 0.1 }, Leg::Dwell { duration: 5.0 }, Leg::To { speed: 0.0, rate: 0.5 }];
    let program = Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped").following(legs);
    let mut machine = Machine::spinning(program, 0.0);
    let mut at = |tau: f64| {
        while machine.tau() < tau - 1e-9 {
            machine.step();
        }
        machine.sample().speed
    };
    for (tau, speed) in [(5.0, 0.5), (10.0, 1.0), (14.0, 1.0), (16.0, 0.5), (17.0, 0.0), (30.0, 0.0)] {
        assert!((at(tau) - speed).abs() < 1e-9, "at {tau}");
    }
}

#[test]
fn val_the_delay_at_which_a_simulation_begins_to_grow_is_the_delay_margin() {
    // physics: composite gains at R = 6 reach the axis at a delay of 0.112792, at frequency 2.2158.
    let (rotor, dtau) = (balanced(), 0.01);
    let growth = |delay: f64| {
        let settings = settings(&rotor, 6.0, |f| f.bearings[0].parts.delay = delay);
        let program = Program::in_substeps(&rotor, &settings, dtau, 1).expect("can be stepped");
        simulated(&mut Machine::new(program), dtau, 10, 600.0)
    };
    let (mut low, mut high) = (0.09, 0.13);
    for _ in 0..10 {
        let middle = 0.5 * (low + high);
        if growth(middle).re < 0.0 { low = middle } else { high = middle }
    }
    let margin = 0.5 * (low + high);
    assert!((margin / 0.112_792 - 1.0).abs() < 1e-3, "{margin}");
    assert!((growth(margin).im - 2.2158).abs() < 1e-3);
}

/// Of several samples under way the poles at the origin of the z-plane are nothing but rounding: the iteration for the eigenvalues never
/// ended, and `run` refused the machine.
#[test]
fn regress_poles_of_samples_under_way_are_found() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let growth = |sample: f64| {
        let mut settings = settings(&rotor, 2.5, |f| {
            f.bearings[0].parts = Parts { sensor_lag: 0.01, sample, delay: 0.02, lag: 0.01, ..Parts::default() };
            f.bearings[0].signals[0].filters = vec![Filter::Lowpass { corner: 60.0, order: 2 }];
        });
        settings.deadband.fill(1.0);
        let program = Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped");
        program.growth_at_centre(program.speed()).expect("poles")
    };
    let growths = [0.02, 0.025, 0.03, 0.035, 0.04].map(growth);
    // A little more with every period, by the half of it that a hold delays.
    let steps: Vec<f64> = growths.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean = (growths[4] - growths[0]) / 4.0;
    assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < 0.1), "{growths:?}");
}

#[test]
fn branches_of_equal_sensors_are_told_apart_as_far_as_they_can_be() {
    // Three sensor lags beside two sensors' worth of feedback: poles at -1 / lag that coincide at every speed.
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "individual").expect("built in"));
    settings.feedback.bearings[0].parts.sensor_lag = 0.1;
    let speeds = [0.0, 1.5, 3.0, 4.5, 6.0];
    let branches = machine::trace(&rotor, &settings, &speeds).expect("poles");
    for (k, speed) in speeds.iter().enumerate() {
        let mut traced: Vec<C64> = branches.iter().filter_map(|branch| branch[k]).collect();
        let mut there: Vec<C64> = machine::MachinePoles::at(&rotor, &settings, *speed)
            .expect("poles")
            .modes
            .iter()
            .map(|mode| mode.pole)
            .collect();
        let order = |a: &C64, b: &C64| (a.re + 1e-3 * a.im).total_cmp(&(b.re + 1e-3 * b.im));
        traced.sort_by(order);
        there.sort_by(order);
        assert_eq!(traced.len(), there.len());
        assert!(
            traced.iter().zip(&there).all(|(a, b)| (a - b).norm() < 1e-4 * (1.0 + a.norm())),
            "{traced:?} {there:?}"
        );
    }
}
