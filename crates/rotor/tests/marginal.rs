//! Poles within rounding of zero are marginal: told as exactly zero, never judged by the sign of rounding.

use rotor::{ClosedLoop, Feedback, Mass, Modes, Rotor, Settings, Signal, Stability, Whirl, builtin, poles, stability};

/// Two equal masses on one shaft that nothing holds, with seals of this damping.
fn free(damping: f64) -> Rotor {
    Rotor::new("free", vec![Mass { mass: 0.5, damping, ..Mass::default() }; 2], vec![0.5]).expect("valid")
}

fn off(rotor: &Rotor, speed: f64) -> ClosedLoop {
    ClosedLoop::new(rotor, &builtin::feedback(rotor, "off").expect("fits any"), speed, &[])
}

#[test]
fn a_rotor_free_in_space_is_marginal_at_rest() {
    for damping in [0.0, 0.1] {
        let linear = Modes::of(&off(&free(damping), 0.0)).expect("converges");
        assert_eq!(linear.stability(), Stability::Marginal, "{linear:?}");
        assert_eq!(linear.min_damping().to_bits(), 0, "zero, and not -0");
        assert!(!linear.is_stable());
        let still: Vec<_> = linear.modes.iter().filter(|m| m.pole.norm() == 0.0).collect();
        assert_eq!(still.len(), if damping == 0.0 { 2 } else { 1 }, "{linear:?}");
        assert!(still.iter().all(|m| m.log_decrement() == 0.0 && m.whirl() == Whirl::Forward));
    }
    // Seals that turn with the spin drive it from the first turn on.
    assert_eq!(stability(&off(&free(0.1), 0.5)), Ok(Stability::Unstable));
}

#[test]
fn a_mode_that_nothing_damps_is_marginal_beside_damped_ones() {
    let end = Mass { mass: 0.25, bearing_stiffness: 0.5, ..Mass::default() };
    let centre = Mass { mass: 0.5, damping: 0.25, cross_damping: 0.05, ..Mass::default() };
    let rotor = Rotor::new("middle", vec![end, centre, end], vec![0.5, 0.5]).expect("valid");
    let linear = Modes::of(&off(&rotor, 1.0)).expect("converges");
    let count = |stability| linear.modes.iter().filter(|m| m.stability() == stability).count();
    assert_eq!((count(Stability::Marginal), count(Stability::Unstable)), (2, 0), "{linear:?}");
    assert_eq!(linear.stability(), Stability::Marginal);
    // The pitch mode: sqrt((0.5 + 0.5) / 0.25) = 2.
    assert!(linear.modes[..2].iter().all(|m| (m.frequency() - 2.0).abs() < 1e-14));
}

/// Stiffness from the magnetic bearing alone: a rotor that is held, and that nothing damps.
#[test]
fn a_rotor_held_only_by_its_magnetic_bearing_is_marginal() {
    let rotor = free(0.0);
    let feedback = Feedback::new(0, vec![Signal::at_mass(0, 2, [0.7, 0.0, 0.0, 0.0])]);
    for speed in [0.0, 1.0, 20.0] {
        assert_eq!(stability(&ClosedLoop::new(&rotor, &feedback, speed, &[])), Ok(Stability::Marginal));
    }
}

/// What is small and no rounding keeps its sign.
#[test]
fn a_damping_of_a_millionth_of_a_millionth_is_not_marginal() {
    for (damping, expected) in [(1e-12, Stability::Stable), (0.0, Stability::Marginal)] {
        let mass = Mass { mass: 1.0, damping, bearing_stiffness: 1.0, ..Mass::default() };
        let rotor = Rotor::new("hardly", vec![mass; 3], vec![0.5; 2]).expect("valid");
        assert_eq!(stability(&off(&rotor, 0.0)), Ok(expected), "{damping}");
    }
    let jeffcott = builtin::rotor("jeffcott").expect("built in");
    let threshold = rotor::thresholds(&jeffcott, &builtin::feedback(&jeffcott, "off").expect("built in"), 0.0, 5.0)
        .expect("converges")[0]
        .speed;
    assert_eq!(stability(&off(&jeffcott, threshold)), Ok(Stability::Marginal));
    assert_eq!(stability(&off(&jeffcott, threshold - 1e-11)), Ok(Stability::Stable));
    assert_eq!(stability(&off(&jeffcott, threshold + 1e-11)), Ok(Stability::Unstable));
}

/// A double pole on the real axis splits into a pair by the root of rounding: it does not whirl.
#[test]
fn a_critically_damped_mode_has_two_real_poles() {
    let mass = Mass { mass: 1.0, damping: 1.0, bearing_stiffness: 1.0, ..Mass::default() };
    let rotor = Rotor::new("critical", vec![mass], vec![]).expect("valid");
    let poles = poles(&off(&rotor, 0.0)).expect("converges");
    assert!(poles.iter().all(|p| p.im == 0.0 && (p.re + 1.0).abs() < 1e-7), "{poles:?}");
}

/// Without damping every pole of every chain is marginal, whatever its masses, stiffnesses and spread; SciPy's `eig` gives
/// them real parts of either sign, as we do before rounding is taken off.
#[test]
fn nothing_that_is_undamped_is_called_stable_or_unstable() {
    let mut random = fastrand::Rng::with_seed(20_260_101);
    for round in 0..2000 {
        let n = 1 + round % 12;
        let decades = if round % 3 == 0 { 6.0 } else { 1.0 };
        let mut size = |zero: f64| if random.f64() < zero { 0.0 } else { 10_f64.powf(decades * (random.f64() - 0.5)) };
        let mass = |size: &mut dyn FnMut(f64) -> f64| Mass {
            mass: size(0.0),
            cross_damping: 0.1 * size(0.5),
            bearing_stiffness: size(0.5),
            ..Mass::default()
        };
        let masses: Vec<Mass> = if round % 5 == 0 {
            vec![mass(&mut |zero| size(zero)); n]
        } else {
            (0..n).map(|_| mass(&mut |zero| size(zero))).collect()
        };
        let shafts = (1..n).map(|_| size(0.1)).collect();
        let rotor = Rotor::new("undamped", masses, shafts).expect("valid");
        let settings = Settings::new(&rotor, 2.0, builtin::feedback(&rotor, "off").expect("fits any"));
        let poles = poles(&settings.closed_loop(&rotor)).expect("converges");
        assert!(poles.iter().all(|p| Stability::of(*p) == Stability::Marginal), "{poles:?} of {rotor:?}");
    }
}
