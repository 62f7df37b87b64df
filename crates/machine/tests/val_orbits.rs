//! Circular orbits of loops that are more than gains: exact ones against the machine in motion, part by part, and against
//! the linear machine where it is linear.

use control::{Filter, Parts};
use machine::{LinearForm, Machine, Program};
use rotor::circular::{CircularError, End, Orbit, cycles, synchronous};
use rotor::{C64, Feedback, J, Mass, OperatingPoint, Plant, Rotor, Settings, builtin};

/// The rate of an orbit that can be judged.
fn growth(orbit: &Orbit) -> f64 {
    *orbit.growth.as_ref().expect("judged")
}

/// The loops: every part alone, and all of them.
fn loops() -> Vec<(&'static str, Feedback)> {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let individual = builtin::feedback(&rotor, "individual").expect("built in");
    let with = |parts: Parts, filters: Vec<Filter>| {
        let mut feedback = individual.clone();
        (feedback.bearings[0].parts, feedback.bearings[0].filters) = (parts, filters);
        feedback
    };
    let parts = Parts::default();
    let mut signal = with(parts, vec![]);
    signal.bearings[0].signals[1].filters = vec![Filter::Lead { zero: 4.0, pole: 20.0 }];
    vec![
        ("sensor lag", with(Parts { sensor_lag: 0.02, ..parts }, vec![])),
        ("actuator lag", with(Parts { lag: 0.03, ..parts }, vec![])),
        ("actuator of second order", with(Parts { lag: 0.03, lag_damping: 0.7, ..parts }, vec![])),
        ("delay", with(Parts { delay: 0.05, ..parts }, vec![])),
        ("low-pass", with(parts, vec![Filter::Lowpass { corner: 30.0, order: 2 }])),
        ("synchronous notch", with(parts, vec![Filter::SynchronousNotch { width: 0.1 }])),
        ("filter of a signal", signal),
        (
            "all",
            with(
                Parts { sensor_lag: 0.01, delay: 0.03, lag: 0.01, ..parts },
                vec![Filter::Lowpass { corner: 60.0, order: 2 }],
            ),
        ),
    ]
}

fn settings(rotor: &Rotor, feedback: &Feedback, speed: f64, deadband: f64) -> Settings {
    let mut settings = Settings::new(rotor, speed, feedback.clone());
    settings.deadband.fill(deadband);
    settings.trip = 1e9;
    settings
}

#[test]
fn val_the_response_of_every_loop_is_what_the_machine_settles_on() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (what, feedback) in loops() {
        for (speed, deadband) in [(1.3, 0.5), (2.5, 0.2)] {
            let settings = settings(&rotor, &feedback, speed, deadband);
            let found = synchronous(&rotor, &feedback, &settings.deadband, &[speed]).expect("converges");
            let stable: Vec<&Orbit> = found.orbits[0].iter().filter(|o| o.is_stable()).collect();
            assert!(!found.orbits[0].is_empty(), "{what} at {speed}");
            if stable.is_empty() {
                // A notch at the speed leaves the bearing without damping there.
                assert_eq!((what, speed), ("synchronous notch", 2.5));
                continue;
            }
            let program = Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped");
            let mut machine = Machine::new(program);
            (0..300_000).for_each(|_| assert!(machine.step().is_none()));
            let sample = machine.sample();
            let radii: Vec<f64> = sample.displacement.iter().map(|p| p.norm()).collect();
            let force = sample.outputs[0].delivered.norm();
            let near = |orbit: &&&Orbit| {
                orbit.radii().iter().zip(&radii).all(|(a, b)| (a - b).abs() < 1e-5 * (1.0 + b))
                    && (orbit.force - force).abs() < 1e-5 * (1.0 + force)
            };
            assert!(
                stable.iter().any(|o| near(&o)),
                "{what} at {speed}: simulated {radii:?} {force}, exact {stable:?}"
            );
        }
    }
}

#[test]
fn val_without_clearance_the_response_of_every_loop_is_that_of_its_matrices() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    for (what, feedback) in loops() {
        let speed = 2.0;
        let found = synchronous(&rotor, &feedback, &[0.0; 3], &[speed]).expect("converges");
        let [orbit] = &found.orbits[0][..] else { panic!("{what}: {:?}", found.orbits) };
        let form = LinearForm::of(&Plant::of(&rotor), &feedback, &OperatingPoint::at(speed)).expect("fits");
        let [a, b, c] = form.continuous().expect("continuous");
        let s = J * speed;
        let mut m = -(a + b * c * (-s * form.delay).exp());
        (0..m.nrows()).for_each(|i| m[(i, i)] += s);
        let mut drive = nalgebra::DVector::zeros(m.nrows());
        (0..3).for_each(|k| drive[3 + k] = C64::from(rotor.masses()[k].unbalance * speed * speed));
        let x = m.lu().solve(&drive).expect("no pole there");
        assert!((0..3).all(|k| (x[k] - orbit.amplitude[k]).norm() < 1e-12), "{what}");
        // Linear: what becomes of disturbances is told by the poles.
        let poles = machine::min_damping(&rotor, &settings(&rotor, &feedback, speed, 0.0), speed).expect("converges");
        assert_eq!(orbit.is_stable(), poles > 0.0, "{what}");
        let rightmost = machine::MachinePoles::of(&rotor, &settings(&rotor, &feedback, speed, 0.0)).expect("converges");
        let fastest = rightmost.modes.iter().map(|m| m.pole.re).fold(f64::NEG_INFINITY, f64::max);
        assert!((growth(orbit) - fastest).abs() < 1e-8, "{what}: {} for {fastest}", growth(orbit));
    }
}

/// Composite feedback so late that the machine whirls by itself, held by bearings with clearance.
fn whirling(delay: f64, change: impl Fn(&mut Feedback)) -> (Rotor, Feedback) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let masses: Vec<Mass> = rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect();
    let rotor = Rotor::new("balanced", masses, rotor.shafts().to_vec()).expect("valid");
    let mut feedback =
        builtin::feedback(&builtin::rotor("three-mass").expect("built in"), "composite").expect("built in");
    feedback.bearings[0].parts.delay = delay;
    change(&mut feedback);
    (rotor, feedback)
}

#[test]
fn val_cycles_of_late_loops_are_what_the_machine_settles_on() {
    let mut met = 0;
    for (delay, lag) in [(0.02, 0.0), (0.02, 0.02), (0.0, 0.03)] {
        let (rotor, feedback) = whirling(delay, |f| f.bearings[0].parts.lag = lag);
        for speed in [3.0, 4.5, 6.0] {
            let settings = settings(&rotor, &feedback, speed, 1.0);
            let found = cycles(&rotor, &feedback, &settings.deadband, &[speed]).expect("converges");
            for orbit in found.orbits[0].iter().filter(|o| o.is_stable()) {
                let program = Program::in_substeps(&rotor, &settings, 0.01, 1).expect("can be stepped");
                let mut machine = Machine::new(program);
                // Beside the cycle, with nothing under way in the loop.
                let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| c * J * orbit.frequency).collect();
                machine.place(&orbit.amplitude, &velocity);
                (0..150_000).for_each(|_| assert!(machine.step().is_none()));
                let radii: Vec<f64> = machine.sample().displacement.iter().map(|p| p.norm()).collect();
                let near = orbit.radii().iter().zip(&radii).all(|(a, b)| (a - b).abs() < 1e-4 * (1.0 + b));
                assert!(near, "delay {delay}, lag {lag}, R = {speed}: simulated {radii:?}, exact {:?}", orbit.radii());
                met += 1;
            }
        }
    }
    assert!(met >= 3, "{met} cycles");
}

#[test]
fn a_loop_that_is_almost_ideal_has_the_orbits_of_the_ideal_one() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let ideal = builtin::feedback(&rotor, "composite").expect("built in");
    for tiny in [Parts { delay: 1e-8, ..Parts::default() }, Parts { lag: 1e-6, ..Parts::default() }] {
        let late = ideal.clone().with_parts(tiny);
        for speed in [1.0, 3.0, 6.0] {
            let of = |feedback: &Feedback| {
                let forced = synchronous(&rotor, feedback, &[1.0; 3], &[speed]).expect("converges").orbits;
                let free = cycles(&rotor, feedback, &[1.0; 3], &[speed]).expect("converges").orbits;
                [forced, free].concat().concat()
            };
            let (exact, near) = (of(&ideal), of(&late));
            assert_eq!(exact.len(), near.len(), "{tiny:?} at {speed}");
            for (a, b) in exact.iter().zip(&near) {
                let apart = a.amplitude.iter().zip(&b.amplitude).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
                assert!(apart < 1e-3 * (1.0 + a.largest_radius()), "{tiny:?} at {speed}: {a:?} {b:?}");
                assert!((growth(a) - growth(b)).abs() < 1e-3, "{tiny:?} at {speed}: {} {}", growth(a), growth(b));
            }
        }
    }
}

#[test]
fn orbits_that_the_actuator_cannot_hold_are_left_out_and_counted() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let speeds: Vec<f64> = (0..=30).map(|i| 0.1 * f64::from(i)).collect();
    let free = builtin::feedback(&rotor, "individual").expect("built in");
    let all = synchronous(&rotor, &free, &[0.0; 3], &speeds).expect("converges");
    let most = all.orbits.iter().flatten().map(|o| o.force).fold(0.0, f64::max);
    for (key, parts) in [
        ("limit", Parts { limit: 0.5 * most, ..Parts::default() }),
        ("slew", Parts { slew: 0.5 * most, ..Parts::default() }),
    ] {
        let limited = free.clone().with_parts(parts);
        let found = synchronous(&rotor, &limited, &[0.0; 3], &speeds).expect("converges");
        assert!(found.complete.iter().all(|complete| !complete), "{key}");
        let (mut kept, mut left_out) = (0, 0);
        for (at, speed) in speeds.iter().enumerate() {
            let [orbit] = &all.orbits[at][..] else { panic!("one orbit of a linear machine") };
            let within = orbit.force <= parts.limit && orbit.force * speed <= parts.slew;
            assert_eq!(
                (found.orbits[at].len(), found.beyond_limits[at]),
                if within { (1, 0) } else { (0, 1) },
                "{key}"
            );
            (kept, left_out) = (kept + usize::from(within), left_out + usize::from(!within));
        }
        assert!(kept > 3 && left_out > 3, "{key}: {kept} {left_out}");
        assert!(found.curves.iter().any(|curve| curve.ends.contains(&End::Limit)), "{key}");
    }
}

#[test]
fn orbits_of_a_sampled_loop_are_refused_in_words() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut feedback = builtin::feedback(&rotor, "composite").expect("built in");
    feedback.bearings[0].parts.sample = 0.05;
    let refused = synchronous(&rotor, &feedback, &[1.0; 3], &[1.0]).expect_err("no circle");
    assert_eq!(refused, CircularError::Sampled);
    assert!(refused.to_string().contains("sample=off"), "{refused}");
}

/// The machine from an orbit on, in steps that it can take, for so long.
fn in_motion(rotor: &Rotor, settings: &Settings, start: &Orbit, duration: f64) -> Machine {
    let pace = machine::Pace { dtau: 0.01, rate_hz: 0.0 };
    let mut machine =
        Machine::new(Program::compile(rotor, settings, [settings.speed; 2], pace).expect("can be stepped"));
    let velocity: Vec<C64> = start.amplitude.iter().map(|c| c * J * start.frequency).collect();
    machine.place(&start.amplitude, &velocity);
    (0..(duration / 0.01) as u64).for_each(|_| assert!(machine.step().is_none()));
    machine
}

/// Two places of twelve have play: the whirl of all others follows from what these two are pushed with.
#[test]
fn val_the_response_of_shaft_elements_in_their_touchdown_bearings_is_what_the_machine_stays_on() {
    let rotor = builtin::rotor("rig").expect("built in");
    let feedback = builtin::feedback(&rotor, "own").expect("it has a law");
    let mut settings = Settings::new(&rotor, 3.0, feedback.clone());
    let met: Vec<usize> = (0..rotor.len()).filter(|place| rotor.has_contact(*place)).collect();
    met.iter().for_each(|place| settings.deadband[*place] = 0.1);
    let found = synchronous(&rotor, &feedback, &settings.deadband, &[3.0]).expect("converges");
    let stable: Vec<&Orbit> = found.orbits[0].iter().filter(|orbit| orbit.is_stable()).collect();
    let [orbit] = stable[..] else { panic!("one stable orbit: {:?}", found.orbits[0]) };
    assert!(met.iter().any(|place| orbit.contact >> place & 1 == 1), "it presses on one: {orbit:?}");
    // What the integrators of its magnets begin with fades within a thousand tau; it is small.
    let machine = in_motion(&rotor, &settings, orbit, 150.0);
    let sample = machine.sample();
    let turned = C64::cis(-sample.angle);
    for (ours, exact) in sample.displacement.iter().zip(&orbit.amplitude) {
        assert!((ours * turned - exact).norm() < 2e-3 * (1.0 + exact.norm()), "{} and {exact}", ours * turned);
    }
    for (output, force) in machine.outputs().iter().zip(&orbit.forces) {
        assert!((output.delivered.norm() - force).abs() < 5e-3 * (0.1 + force), "{output:?} and {force}");
    }
}

/// A shaft with two discs in bearings with play and a seal that drives forward whirl.
fn driven() -> Rotor {
    let text = format!(
        "units = 'si'\nreference_length = 1e-4\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n{}\
         [[disc]]\nstation = 2\nmass = 32.6\npolar_inertia = 0.356\ndiametral_inertia = 0.178\n\
         [[disc]]\nstation = 3\nmass = 35.8\npolar_inertia = 0.405\ndiametral_inertia = 0.203\n\
         [[bearing]]\nstation = 1\nstiffness = 1e7\ndamping = 2000.0\nclearance = 1e-4\n\
         [[bearing]]\nstation = 4\nstiffness = 1e7\ndamping = 2000.0\nclearance = 1e-4\n\
         [[seal]]\nstation = 2\ndamping = 500.0\ncross_stiffness = 3e5\n",
        "[[section]]\nlength = 0.25\nouter = 0.05\nelements = 2\n".repeat(3)
    );
    rotor::file::read_rotor(&text, "driven").expect("a rotor")
}

#[test]
fn val_the_cycle_of_shaft_elements_is_what_the_machine_whirls_on() {
    let rotor = driven();
    let off = rotor.beam().expect("shaft elements").no_feedback();
    let settings = Settings::new(&rotor, 1.0, off.clone());
    let found = cycles(&rotor, &off, &settings.deadband, &[1.0]).expect("converges");
    let stable: Vec<&Orbit> = found.orbits[0].iter().filter(|orbit| orbit.is_stable()).collect();
    let [orbit] = stable[..] else { panic!("one stable cycle: {:?}", found.orbits[0]) };
    assert_eq!(orbit.contact.count_ones(), 2, "it presses on both");
    // From a tenth more than it, to it.
    let larger = Orbit { amplitude: orbit.amplitude.iter().map(|c| c * 1.1).collect(), ..orbit.clone() };
    let machine = in_motion(&rotor, &settings, &larger, 200.0);
    for (ours, exact) in machine.sample().displacement.iter().zip(orbit.radii()) {
        assert!((ours.norm() - exact).abs() < 2e-4 * exact, "{} and {exact}", ours.norm());
    }
    let (p, v) = (machine.sample().displacement[0], machine.sample().velocity[0]);
    assert!(((v / p).im - orbit.frequency).abs() < 2e-4 * orbit.frequency, "{} and {}", v / p, orbit.frequency);
}

/// The equation of all coordinates of a shaft spans nine decades, and had made these up: no force at a magnet balanced them.
#[test]
fn no_cycles_of_the_rig_are_made_up() {
    let rotor = builtin::rotor("rig").expect("built in");
    let feedback = builtin::feedback(&rotor, "own").expect("it has a law");
    let scales = rotor.scales().expect("SI");
    let speeds =
        [3700.0, 4100.0, 5033.0 + 1.0 / 3.0, 5133.0 + 1.0 / 3.0, 6466.0 + 2.0 / 3.0].map(|rpm| scales.speed(rpm));
    let found = cycles(&rotor, &feedback, &rotor.deadbands(), &speeds).expect("converges");
    assert!(found.orbits.iter().all(Vec::is_empty), "{:?}", found.orbits);
}

/// A delay so long that its roots have no end to count: the orbits are what they are all the same.
#[test]
fn regress_an_orbit_that_cannot_be_judged_is_told_as_such() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let mut late = builtin::feedback(&rotor, "cancel").expect("built in");
    let speeds = [0.5, 2.0];
    let of = |feedback: &Feedback| synchronous(&rotor, feedback, &[0.5], &speeds).expect("orbits");
    late.bearings[0].parts.delay = 5000.0;
    let found = of(&late);
    assert!(found.orbits.iter().all(|here| !here.is_empty()), "{found:?}");
    for orbit in found.orbits.iter().flatten().chain(found.curves.iter().flat_map(|curve| &curve.orbits)) {
        let why = orbit.stability().expect_err("no count has an end");
        assert!(matches!(why, CircularError::Roots(_) | CircularError::NotTried(_)) && !orbit.is_stable(), "{why}");
    }
    assert!(Orbit::largest_stable(&found.orbits[0]).is_err());
    // Cycles are sought from the poles that there are without the delay.
    assert!(cycles(&rotor, &late, &[0.5], &speeds).is_ok());
    // Where it ends all are judged.
    late.bearings[0].parts.delay = 0.05;
    assert!(of(&late).orbits.iter().flatten().all(|orbit| orbit.growth.is_ok()));
}

#[test]
fn the_largest_stable_orbit_is_not_known_below_one_that_cannot_be_judged() {
    let of = |radius: f64, growth: Result<f64, CircularError>| Orbit {
        speed: 1.0,
        frequency: 1.0,
        amplitude: vec![C64::from(radius)],
        contact: 0,
        force: 0.0,
        forces: vec![0.0],
        growth,
    };
    let lost = || Err(CircularError::Stopped);
    let radius = |orbits: &[Orbit]| Orbit::largest_stable(orbits).map(|orbit| orbit.map(Orbit::largest_radius)).ok();
    assert_eq!(radius(&[of(1.0, Ok(-0.1)), of(2.0, Ok(0.1))]), Some(Some(1.0)));
    assert_eq!(radius(&[of(1.0, Ok(-0.1)), of(0.5, lost())]), Some(Some(1.0)));
    assert_eq!(radius(&[of(1.0, Ok(-0.1)), of(2.0, lost())]), None);
    assert_eq!(radius(&[of(1.0, Ok(0.1))]), Some(None));
}
