//! Several control bearings: what is stepped is what is analysed, and each is what it would be alone.

use control::{ControlBearing, Filter, Parts};
use machine::{Machine, MachineLoop, MachinePoles, Program, margins};
use nalgebra::{DMatrix, DVector};
use rotor::{C64, Characteristic, Feedback, LinearForm, OperatingPoint, Plant, Rotor, Settings, Signal, builtin};

/// The rotor without what forces it.
fn balanced() -> Rotor {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let masses = rotor.masses().iter().map(|mass| rotor::Mass { unbalance: 0.0, ..*mass }).collect();
    Rotor::new("balanced", masses, rotor.shafts().to_vec()).expect("allowed")
}

/// Two bearings, each with a sensor of its own and one of the other's, and parts of their own.
fn two(sample: f64, delay: f64) -> Feedback {
    let left = ControlBearing {
        name: Some("left".into()),
        filters: vec![Filter::Lowpass { corner: 30.0, order: 2 }],
        parts: Parts { sensor_lag: 0.01, sample, delay, ..Parts::default() },
        ..ControlBearing::new(0, vec![Signal::at_mass(0, 3, [1.5, 1.2, 0.4, 0.0]), Signal::at_mass(2, 3, [0.2; 4])])
    };
    let right = ControlBearing {
        name: Some("right".into()),
        parts: Parts { lag: 0.02, sample, delay, ..Parts::default() },
        ..ControlBearing::new(2, vec![Signal::composite(&[0.0, 0.5, 1.0], [0.9, 1.1, -0.3, 0.1])])
    };
    Feedback { bearings: vec![left, right] }
}

fn kicked(rotor: &Rotor, settings: &Settings, dtau: f64) -> Machine {
    let mut machine = Machine::new(Program::in_substeps(rotor, settings, dtau, 1).expect("can be stepped"));
    machine.place(&[C64::new(0.3, 0.1), C64::new(-0.2, 0.5), C64::new(0.1, -0.4)], &[C64::ZERO; 3]);
    machine
}

#[test]
fn val_a_continuous_machine_moves_as_the_exponential_of_its_matrix() {
    let rotor = balanced();
    let settings = Settings::new(&rotor, 2.0, two(0.0, 0.0));
    let form = LinearForm::of(&Plant::of(&rotor), &settings.feedback, &OperatingPoint::at(2.0)).expect("fits");
    let matrix = form.immediate().expect("continuous and at once");
    let mut machine = kicked(&rotor, &settings, 0.005);
    let start: Vec<C64> = machine.sample().displacement.iter().chain(machine.sample().velocity).copied().collect();
    (0..800).for_each(|_| assert!(machine.step().is_none()));
    let mut x = DVector::zeros(matrix.nrows());
    x.rows_mut(0, 6).copy_from_slice(&start);
    let expected = (matrix * C64::from(4.0)).exp() * x;
    let sample = machine.sample();
    for (ours, exact) in sample.displacement.iter().chain(sample.velocity).zip(expected.iter()) {
        assert!((ours - exact).norm() < 2e-8, "{ours} and {exact}");
    }
}

#[test]
fn val_a_sampled_machine_moves_by_the_powers_of_its_step() {
    let rotor = balanced();
    // A delay of more than a period that is no multiple of it.
    let settings = Settings::new(&rotor, 2.0, two(0.05, 0.0625));
    let form = LinearForm::of(&Plant::of(&rotor), &settings.feedback, &OperatingPoint::at(2.0)).expect("fits");
    let step = form.sampled().expect("sampled");
    let mut machine = kicked(&rotor, &settings, 0.0125 / 4.0);
    let mut x: DVector<C64> = DVector::zeros(step.a.nrows());
    for (k, q) in machine.sample().displacement.iter().enumerate() {
        x[k] = *q;
    }
    for _ in 0..40 {
        (0..16).for_each(|_| assert!(machine.step().is_none()));
        x = &step.a * x;
        for (k, q) in machine.sample().displacement.iter().enumerate() {
            // What the step of integration leaves beside a sensor as fast as three of them.
            assert!((q - x[k]).norm() < 1e-7, "{q} and {}", x[k]);
        }
    }
}

#[test]
fn val_late_bearings_grow_as_the_rightmost_root_says() {
    let rotor = balanced();
    let settings = Settings::new(&rotor, 2.0, two(0.0, 0.15));
    let form = LinearForm::of(&Plant::of(&rotor), &settings.feedback, &OperatingPoint::at(2.0)).expect("fits");
    let roots = Characteristic::of(&form).expect("finite").roots().expect("found");
    let rightmost = roots.iter().map(|root| root.pole.re).fold(f64::NEG_INFINITY, f64::max);
    let mut machine = kicked(&rotor, &settings, 0.005);
    // Energy-like size, its peaks over windows that hold every turn of what is left.
    let size = |machine: &mut Machine| -> f64 {
        let one = |machine: &mut Machine| {
            machine.step();
            machine.sample().displacement.iter().map(|p| p.norm_sqr()).sum::<f64>().sqrt()
        };
        (0..4000).map(|_| one(machine)).fold(0.0, f64::max)
    };
    (0..6000).for_each(|_| assert!(machine.step().is_none()));
    let (first, second) = (size(&mut machine), size(&mut machine));
    let rate = (second / first).ln() / 20.0;
    assert!((rate - rightmost).abs() < 5e-3 + 0.02 * rightmost.abs(), "{rate} and {rightmost}");
}

#[test]
fn a_second_bearing_without_gains_changes_nothing() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut one = builtin::feedback(&rotor, "individual").expect("built in");
    one.bearings[0].parts.delay = 0.03;
    let mut both = one.clone();
    let idle = ControlBearing {
        parts: one.bearings[0].parts,
        ..ControlBearing::new(2, vec![Signal::at_mass(2, 3, [0.0; 4])])
    };
    both.bearings.push(idle);
    let [one, both] = [one, both].map(|feedback| Settings::new(&rotor, 3.0, feedback));
    let mut machines = [&one, &both].map(|settings| kicked(&rotor, settings, 0.01));
    for _ in 0..500 {
        machines.iter_mut().for_each(|machine| assert!(machine.step().is_none()));
        assert_eq!(machines[0].sample().displacement, machines[1].sample().displacement);
        assert_eq!(machines[1].outputs()[1].delivered, C64::ZERO);
    }
    let [alone, joined] = [&one, &both].map(|settings| margins(&rotor, settings, 3.0).expect("stable"));
    let [a, b] = [&alone.margins, &joined.bearings[0].margins];
    assert!((a.forward.amplitude - b.forward.amplitude).abs() < 1e-9);
    assert!((a.delay.expect("one").delay - b.delay.expect("one").delay).abs() < 1e-9);
    // The idle one answers nothing, so that nothing about it can be lost.
    assert_eq!(joined.bearings[1].margins.delay, None);
    let together = joined.together.expect("two bearings");
    assert!((together.delay.expect("one").delay - a.delay.expect("one").delay).abs() < 1e-9);
}

#[test]
fn val_the_delay_that_all_bearings_bear_together_is_where_a_root_reaches_the_axis() {
    let rotor = balanced();
    let settings = Settings::new(&rotor, 2.0, two(0.0, 0.02));
    let found = margins(&rotor, &settings, 2.0).expect("stable");
    let margin = found.margins.delay.expect("some delay is too much");
    let unstable = |share: f64| {
        let mut feedback = settings.feedback.clone();
        feedback.set_delay(0.02 + share * margin.delay);
        let form = LinearForm::of(&Plant::of(&rotor), &feedback, &OperatingPoint::at(2.0)).expect("fits");
        Characteristic::of(&form).expect("finite").system().count_right_of(0.0).expect("counted")
    };
    assert_eq!(unstable(0.999), 0);
    assert!(unstable(1.001) > 0);
    // The largest singular value is not below any loop's own peak.
    let together = found.together.expect("two bearings").largest_sensitivity.amplitude;
    assert!(found.bearings.iter().all(|of| of.margins.sensitivity().amplitude <= together + 1e-9));
}

#[test]
fn what_was_saved_goes_on_to_the_last_bit() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (sample, delay) in [(0.0, 0.0), (0.0, 0.07), (0.05, 0.12)] {
        let settings = Settings::new(&rotor, 2.0, two(sample, delay));
        let program = || Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped");
        let mut machine = Machine::new(program());
        (0..137).for_each(|_| assert!(machine.step().is_none()));
        let mut words = control::StateWords::with_room(machine.words_at_most());
        machine.save(&mut words);
        assert!(words.as_slice().len() <= machine.words_at_most());
        let mut restored = Machine::new(program());
        assert!(restored.restore(&mut control::StateWords::from_saved(words.as_slice().to_vec())));
        for _ in 0..200 {
            machine.step();
            restored.step();
            let (a, b) = (machine.sample(), restored.sample());
            assert_eq!((a.displacement, a.velocity, a.outputs), (b.displacement, b.velocity, b.outputs));
        }
    }
}

#[test]
fn val_a_push_at_one_bearing_moves_the_rotor_as_the_matrices_say() {
    let rotor = balanced();
    for delay in [0.0, 0.1] {
        let settings = Settings::new(&rotor, 2.0, two(0.0, delay));
        let form = LinearForm::of(&Plant::of(&rotor), &settings.feedback, &OperatingPoint::at(2.0)).expect("fits");
        let [a, b, c] = form.continuous().expect("continuous");
        for (bearing, machine) in MachineLoop::each(&rotor, &settings, 2.0).expect("fits").iter().enumerate() {
            let station = [0, 2][bearing];
            let curve = machine
                .response(machine::TransferFunction::Station(1), [-5.0, 5.0])
                .expect("found")
                .expect("continuous");
            for point in curve.iter().step_by(37) {
                let s = C64::new(0.0, point.frequency);
                let mut m: DMatrix<C64> = -(&a + &b * &c * (-s * delay).exp());
                (0..m.nrows()).for_each(|i| m[(i, i)] += s);
                let mut push: DVector<C64> = DVector::zeros(m.nrows());
                push[3 + station] = C64::ONE;
                let exact = m.lu().solve(&push).expect("no pole there")[1];
                assert!((point.value - exact).norm() < 1e-9 * (1.0 + exact.norm()), "{bearing} at {}", point.frequency);
            }
        }
    }
}

/// The curve of the loop says at which delay it becomes unstable; the roots that are counted there say so too, and are found.
#[test]
fn val_a_delay_of_a_shaft_is_counted_on_both_sides_of_its_margin() {
    let rotor = builtin::rotor("rig").expect("there is");
    let own = builtin::feedback(&rotor, "own").expect("there is");
    let ideal = Settings::new(&rotor, 1.2, own);
    let margin = margins(&rotor, &ideal, ideal.speed).expect("stable").margins.delay.expect("one").delay;
    for (by, grow) in [(0.999, 0), (1.001, 1)] {
        let mut late = ideal.clone();
        late.set("delay".parse().expect("a key"), by * margin).expect("in range");
        let poles = MachinePoles::of(&rotor, &late).expect("counted");
        assert_eq!(poles.modes.iter().filter(|mode| mode.pole.re > 0.0).count(), grow, "{by}");
    }
}
