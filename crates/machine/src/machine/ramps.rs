//! The fused path through a changing speed, beside the integrator of plant and loop: two ways of the same equations.

use control::StateWords;
use proptest::prelude::*;
use rotor::profile::{Leg, Profile};
use rotor::{C64, Feedback, Gain, Mass, Rotor, Settings, Signal};

use super::{Machine, Path};
use crate::Program;

const DTAU: f64 = 0.02;

fn any_mass() -> impl Strategy<Value = Mass> {
    (
        0.2..1.0f64,
        (0.05..0.5f64, 0.0..0.1f64),
        0.1..1.0f64,
        0.0..0.5f64,
        0.0..1.0f64,
        prop_oneof![Just(0.0), 0.1..1.0f64],
    )
        .prop_map(|(mass, (damping, cross_damping), bearing_stiffness, seal_stiffness, unbalance, deadband)| {
            Mass { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
        })
}

fn any_gain() -> impl Strategy<Value = Gain> {
    let size = -0.5..0.5f64;
    prop_oneof![
        size.clone().prop_map(Gain::Constant),
        (size.clone(), -0.2..0.2f64).prop_map(|(at_zero, slope)| Gain::Linear { at_zero, slope }),
        // Corners that the speed passes, between two steps and within one.
        (size.clone(), size.clone(), size, 0.1..1.5f64).prop_map(|(a, b, c, apart)| Gain::Table(vec![
            (0.2, a),
            (0.2 + apart, b),
            (0.3 + 2.0 * apart, c)
        ])),
    ]
}

fn any_leg() -> impl Strategy<Value = Leg> {
    prop_oneof![
        (0.0..3.0f64, 0.01..2.0f64).prop_map(|(speed, rate)| Leg::To { speed, rate }),
        (0.0..3.0f64, 0.1..2.0f64).prop_map(|(speed, rate)| Leg::Decay { speed, rate }),
        (0.05..2.0f64).prop_map(|duration| Leg::Dwell { duration }),
        (0.0..3.0f64).prop_map(|speed| Leg::To { speed, rate: f64::INFINITY }),
    ]
}

prop_compose! {
    /// A chain of up to four masses under gains alone.
    fn any_chain()(n in 1..=4usize)(
        masses in prop::collection::vec(any_mass(), n),
        shafts in prop::collection::vec(0.2..1.0f64, n - 1),
        bearing in 0..n,
        gains in prop::collection::vec((0..n, prop::array::uniform4(any_gain())), 1..=2),
    ) -> (Rotor, Feedback) {
        let n = masses.len();
        let signals = gains.into_iter().map(|(mass, gains)| Signal { gains, ..Signal::at_mass(mass, n, [0.0; 4]) });
        let feedback = Feedback::new(bearing, signals.collect());
        (Rotor::new("random", masses, shafts).expect("a rotor"), feedback)
    }
}

/// Two machines alike on the way of `legs`: one may take the fused path, the other may not.
fn pair(rotor: &Rotor, feedback: &Feedback, from: f64, legs: Vec<Leg>, substeps: u32) -> [Machine; 2] {
    let profile = Profile { from, lines: vec![0; legs.len()], legs };
    let mut settings = Settings::new(rotor, profile.ends_at(), feedback.clone());
    settings.trip = 1e9;
    let program = Program::in_substeps(rotor, &settings, DTAU, substeps).expect("can be stepped").along(&profile);
    let fused = Machine::new(program);
    let mut integrated = fused.clone();
    integrated.fuses_ramps = false;
    integrated.choose_path();
    [fused, integrated]
}

/// How far apart two machines are, in parts of how far they are out.
fn apart(a: &Machine, b: &Machine) -> f64 {
    let (a, b) = (a.sample(), b.sample());
    let all = |s: &super::Sample<'_>| -> Vec<C64> {
        let spin = [C64::new(s.tau, s.angle), C64::new(s.speed, s.acceleration), s.outputs[0].delivered];
        s.displacement.iter().chain(s.velocity).copied().chain(spin).collect()
    };
    let (a, b) = (all(&a), all(&b));
    let size = a.iter().map(|z| z.norm()).fold(1.0, f64::max);
    a.iter().zip(&b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size
}

fn saved(machine: &Machine) -> Vec<u64> {
    let mut words = StateWords::default();
    machine.save(&mut words);
    words.as_slice().to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Both paths go the same way, through every kind of leg and gain, with blows and clearances.
    #[test]
    fn a_changing_speed_is_the_same_on_both_paths(
        (rotor, feedback) in any_chain(),
        from in 0.0..3.0f64,
        legs in prop::collection::vec(any_leg(), 1..5),
        substeps in 1..=3u32,
    ) {
        let mut pair = pair(&rotor, &feedback, from, legs, substeps);
        let mut most = 0.0_f64;
        for step in 0..400 {
            if step % 150 == 20 {
                pair.iter_mut().for_each(|machine| machine.kick(0, C64::new(0.3, -0.5)));
            }
            pair.iter_mut().for_each(|machine| { machine.step(); });
            let [fused, integrated] = &pair;
            prop_assert!(fused.path != Path::Integrated && (integrated.path != Path::Changing));
            most = most.max(apart(fused, integrated));
        }
        prop_assert!(most < 1e-12, "{most:e}");
    }

    /// What is saved on a ramp goes on to the last bit, through the ends of legs, another program and another pace.
    #[test]
    fn a_ramp_is_taken_up_to_the_last_bit(
        (rotor, feedback) in any_chain(),
        from in 0.0..3.0f64,
        legs in prop::collection::vec(any_leg(), 1..5),
        (at, fuses) in (0..300usize, any::<bool>()),
    ) {
        let [fused, integrated] = pair(&rotor, &feedback, from, legs, 2);
        let mut machine = if fuses { fused } else { integrated };
        machine.kick(0, C64::new(0.3, -0.5));
        (0..at).for_each(|_| { machine.step(); });
        let words = saved(&machine);
        // As it was compiled, and at rest.
        let mut other = Machine::new((*machine.program).clone());
        other.program.integrator.rest();
        prop_assert!(other.restore(&mut StateWords::from_saved(words)));
        let mut settings = Settings::new(&rotor, 1.5, feedback.off());
        (settings.ramp, settings.trip) = (0.3, 1e9);
        for step in 0..250 {
            for machine in [&mut machine, &mut other] {
                match step {
                    60 => machine.kick(0, C64::new(-0.1, 0.2)),
                    90 => machine.pace(0.5 * DTAU),
                    120 => {
                        let program = Program::in_substeps(&rotor, &settings, 0.5 * DTAU, 1).expect("can be stepped");
                        machine.load(&mut Box::new(program));
                    }
                    _ => {}
                }
                machine.step();
            }
            prop_assert_eq!(saved(&machine), saved(&other), "after {} steps", step + 1);
        }
    }
}

/// Snapshots of machines whose ramps were integrated have no mark; they go on as they did.
#[test]
fn an_old_snapshot_goes_on_integrated() {
    let rotor = rotor::builtin::rotor("three-mass").expect("built in");
    let feedback = rotor::builtin::feedback(&rotor, "individual").expect("built in");
    let [fused, mut old] = pair(&rotor, &feedback, 1.0, vec![Leg::To { speed: 1.5, rate: 0.1 }], 1);
    (0..100).for_each(|_| {
        old.step();
    });
    let words = saved(&old);
    assert_eq!(words[2], 0, "the path, as it was written down then");
    let mut taken_up = Machine::new((*fused.program).clone());
    assert!(taken_up.restore(&mut StateWords::from_saved(words)));
    for _ in 0..400 {
        old.step();
        taken_up.step();
        assert_eq!(saved(&taken_up), saved(&old));
    }
    assert_eq!(taken_up.path, Path::Steady, "it has arrived");
}
