//! Laws of loops that are more than gains, over random machines.

use control::{Filter, Parts};
use linear::DelaySystem;
use machine::{LinearForm, Machine, MachinePoles, Program, margins};
use proptest::prelude::*;
use rotor::{C64, Feedback, Gain, Mass, OperatingPoint, Plant, Rotor, Settings, Signal};

fn any_mass() -> impl Strategy<Value = Mass> {
    (0.1..1.0f64, 0.01..0.5f64, 0.0..0.1f64, 0.1..1.0f64, 0.0..0.5f64).prop_map(
        |(mass, damping, cross, bearing, seal)| Mass {
            mass,
            damping,
            cross_damping: cross,
            bearing_stiffness: bearing,
            seal_stiffness: seal,
            unbalance: 0.0,
            deadband: 0.0,
        },
    )
}

/// A chain of up to three masses and a loop with every linear part.
fn any_machine() -> impl Strategy<Value = (Rotor, Feedback)> {
    (1..=3usize)
        .prop_flat_map(|n| {
            (
                prop::collection::vec(any_mass(), n),
                prop::collection::vec(0.2..1.0f64, n - 1),
                0..n,
                prop::collection::vec(prop::array::uniform4(-1.0..1.0f64), 1..=n),
                (0.0..0.1f64, 0.01..0.4f64, 0.0..0.1f64, any::<bool>(), any::<bool>()),
            )
        })
        .prop_map(|(masses, shafts, bearing, gains, (sensor_lag, delay, lag, second, filtered))| {
            let n = masses.len();
            let rotor = Rotor::new("any", masses, shafts).expect("valid");
            let signals: Vec<Signal> =
                gains.iter().enumerate().map(|(k, gains)| Signal::at_mass(k, n, *gains)).collect();
            let mut feedback = Feedback::new(bearing, signals);
            // Lags next to nothing make poles next to infinity.
            let part = |lag: f64| if lag < 0.01 { 0.0 } else { lag };
            feedback.bearings[0].parts = Parts {
                sensor_lag: part(sensor_lag),
                delay,
                lag: part(lag),
                lag_damping: if second { 0.7 } else { 0.0 },
                ..Parts::default()
            };
            if filtered {
                feedback.bearings[0].filters =
                    vec![Filter::Lowpass { corner: 20.0, order: 2 }, Filter::Notch { frequency: 3.0, width: 0.5 }];
            }
            (rotor, feedback)
        })
}

fn poles(rotor: &Rotor, feedback: &Feedback, speed: f64) -> Vec<C64> {
    let settings = Settings::new(rotor, speed, feedback.clone());
    MachinePoles::at(rotor, &settings, speed).expect("converges").modes.iter().map(|mode| mode.pole).collect()
}

/// Each of `a` has one of `b` by it, and the other way round. The poles of several sensors that lag alike coincide, and rounding
/// parts five of them by its fifth root.
fn same(a: &[C64], b: &[C64]) -> bool {
    let is_by = |x: &C64, y: &C64, part: f64| (x - y).norm() <= part * (1.0 + x.norm());
    let has = |a: &[C64], b: &[C64]| {
        a.iter().all(|x| {
            let crowd = a.iter().filter(|other| is_by(x, other, 1e-2)).count();
            b.iter().any(|y| is_by(x, y, if crowd > 1 { 1e-2 } else { 1e-6 }))
        })
    };
    a.len() == b.len() && has(a, b) && has(b, a)
}

/// The same rotor without cross-coupled damping, which does not turn with the spin.
fn plain(rotor: &Rotor) -> Rotor {
    let masses = rotor.masses().iter().map(|m| Mass { cross_damping: 0.0, ..*m }).collect();
    Rotor::new("plain", masses, rotor.shafts().to_vec()).expect("valid")
}

/// The loop seen in a mirror: what turned forward turns backward.
fn mirrored(feedback: &Feedback) -> Feedback {
    let mut feedback = feedback.clone();
    for gains in feedback.bearings[0].signals.iter_mut().map(|signal| &mut signal.gains) {
        for gain in &mut gains[2..] {
            *gain = Gain::Constant(-gain.at(0.0));
        }
    }
    feedback
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The poles of the mirrored machine at the reversed spin are the conjugates.
    #[test]
    fn reversed_spin_conjugates_the_poles((rotor, feedback) in any_machine(), speed in 0.1..4.0f64) {
        let rotor = plain(&rotor);
        let here = poles(&rotor, &feedback, speed);
        let there: Vec<C64> = poles(&rotor, &mirrored(&feedback), -speed).iter().map(|pole| pole.conj()).collect();
        prop_assert!(same(&here, &there), "{here:?} {there:?}");
    }

    /// Every pole of the ideal loop has one of the late or lagging loop by it, the nearer the less of it there is.
    #[test]
    fn a_loop_without_delay_or_lag_is_the_limit_of_those_with((rotor, feedback) in any_machine(), speed in 0.1..4.0f64) {
        let ideal = Feedback::new(feedback.bearings[0].station, feedback.bearings[0].signals.clone());
        let expected = poles(&rotor, &ideal, speed);
        for which in [0, 1] {
            let apart = |by: f64| {
                let none = Parts::default();
                let parts = [Parts { delay: by, ..none }, Parts { sensor_lag: by, lag: by, ..none }][which];
                let near = poles(&rotor, &ideal.clone().with_parts(parts), speed);
                let nearest = |pole: &C64| near.iter().map(|other| (other - pole).norm()).fold(f64::INFINITY, f64::min);
                expected.iter().map(nearest).fold(0.0, f64::max)
            };
            // Where poles coincide they part by the root of what moves them.
            let (less, more) = (apart(1e-4), apart(1e-2));
            prop_assert!(less < 3e-2 && less < 0.5 * more + 1e-9, "{less} {more}");
        }
    }

    /// A loop sampled every `h` is the continuous one with half a period more delay, but for the square of the period.
    #[test]
    fn a_sampled_loop_is_half_a_period_late((rotor, feedback) in any_machine(), speed in 0.1..4.0f64) {
        let apart = |period: f64| -> f64 {
            let mut sampled = Feedback::new(feedback.bearings[0].station, feedback.bearings[0].signals.clone());
            let mut late = sampled.clone();
            sampled.bearings[0].parts.sample = period;
            late.bearings[0].parts.delay = 0.5 * period;
            let exact = poles(&rotor, &sampled, speed);
            // The rotor's own poles: those of the delay's chain are far left.
            let own = poles(&rotor, &late, speed).into_iter().filter(|pole| pole.norm() < 10.0);
            own.map(|pole| exact.iter().map(|other| (other - pole).norm()).fold(f64::INFINITY, f64::min)).fold(0.0, f64::max)
        };
        prop_assume!(poles(&rotor, &Feedback::new(feedback.bearings[0].station, feedback.bearings[0].signals.clone()), speed).windows(2).all(|p| (p[0] - p[1]).norm() > 0.1));
        let (coarse, fine) = (apart(0.02), apart(0.005));
        // Second order: a quarter of the period, a sixteenth of the distance.
        prop_assert!(fine < 0.15 * coarse + 1e-8, "{coarse:e} {fine:e}");
    }

    /// A lone margin of delay puts a root on the axis, and less of it none right of it.
    #[test]
    fn a_delay_margin_is_where_the_count_of_roots_changes((rotor, feedback) in any_machine(), speed in 0.1..4.0f64) {
        let settings = Settings::new(&rotor, speed, feedback.clone());
        if let Ok(found) = margins(&rotor, &settings, speed)
            && let Some(margin) = found.margins.delay.filter(|margin| margin.delay < 5.0)
        {
            let form = LinearForm::of(&Plant::of(&rotor), &feedback, &OperatingPoint::at(speed)).expect("fits");
            let [a, b, c] = form.continuous().expect("continuous");
            let right = |part: f64| {
                let delay = form.delay + part * margin.delay;
                let system = DelaySystem::new(a.clone(), b.clone(), c.clone(), delay).expect("fits");
                system.count_right_of(0.0).expect("none on the axis")
            };
            prop_assert_eq!(right(0.99), 0);
            prop_assert!(right(1.01) > 0);
        }
    }

    /// The same seed is the same run, to the last bit; another one is another.
    #[test]
    fn the_same_seed_is_the_same_noise((rotor, feedback) in any_machine(), seed in 1..1000u32) {
        let run = |seed: u32| {
            let mut feedback = feedback.clone();
            (feedback.bearings[0].parts.noise, feedback.bearings[0].parts.sample, feedback.bearings[0].parts.seed) = (0.01, 0.05, f64::from(seed));
            let settings = Settings::new(&rotor, 1.0, feedback);
            let mut machine = Machine::new(Program::in_substeps(&rotor, &settings, 0.01, 4).expect("can be stepped"));
            (0..100).for_each(|_| { machine.step(); });
            machine.sample().displacement.iter().map(|p| [p.re.to_bits(), p.im.to_bits()]).collect::<Vec<_>>()
        };
        prop_assert_eq!(run(seed), run(seed));
        prop_assert!(feedback.bearings[0].signals.iter().all(|s| s.gains.iter().all(|g| g.at(0.0).abs() < 1e-6)) || run(seed) != run(seed + 1));
    }
}
