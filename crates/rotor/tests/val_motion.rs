//! The integrator against solutions that are exact: linear motion from the eigenvectors, and circular whirl, in which
//! the deadband is a constant factor.

use nalgebra::{DMatrix, DVector};
use rotor::{C64, ClosedLoop, Feedback, J, MAX_MASSES, Mass, Modes, Rotor, Signal, builtin, stepper};

/// Complex amplitudes `c` of the synchronous whirl `p = c exp(j R tau)` when every support bearing is scaled by its
/// factor: the dynamic stiffness of the system matrix, solved against the unbalance.
fn synchronous(rotor: &Rotor, closed_loop: &ClosedLoop, factors: &[f64]) -> DVector<C64> {
    let (n, speed) = (rotor.len(), closed_loop.speed());
    let a = closed_loop.state_matrix_with(factors);
    let s = J * speed;
    let stiffness = a.view((n, 0), (n, n));
    let damping = a.view((n, n), (n, n));
    let dynamic = DMatrix::<C64>::identity(n, n) * (s * s) - damping * s - stiffness;
    let forcing = DVector::from_iterator(n, rotor.masses().iter().map(|m| C64::from(m.unbalance * speed * speed)));
    dynamic.lu().solve(&forcing).expect("not resonant without damping")
}

/// The synchronous whirl with deadband: the factors `s(|c|)` and the amplitudes agree.
fn synchronous_with_deadband(rotor: &Rotor, closed_loop: &ClosedLoop, deadband: &[f64]) -> DVector<C64> {
    let mut factors = vec![1.0; rotor.len()];
    for _ in 0..20_000 {
        let c = synchronous(rotor, closed_loop, &factors);
        for ((factor, g), c) in factors.iter_mut().zip(deadband).zip(c.iter()) {
            let wanted = if c.norm() > *g { 1.0 - g / c.norm() } else { 0.0 };
            *factor += 0.1 * (wanted - *factor);
        }
    }
    synchronous(rotor, closed_loop, &factors)
}

/// Largest error after following an exact synchronous whirl for `turns` turns with `steps` steps a turn.
fn error_after(closed_loop: &ClosedLoop, c: &DVector<C64>, turns: f64, steps: u32) -> f64 {
    let speed = closed_loop.speed();
    let mut rotor = stepper(closed_loop);
    rotor.place(c.as_slice(), (c * (J * speed)).as_slice());
    let dtau = std::f64::consts::TAU / speed / f64::from(steps);
    for _ in 0..(turns * f64::from(steps)).round() as u32 {
        rotor.step(dtau);
    }
    let motion = rotor.motion();
    c.iter().zip(motion.displacement).map(|(c, p)| (c * C64::cis(speed * motion.tau) - p).norm()).fold(0.0, f64::max)
}

#[track_caller]
fn converges_at_fourth_order(closed_loop: &ClosedLoop, c: &DVector<C64>) {
    let coarse = error_after(closed_loop, c, 3.0, 100);
    let fine = error_after(closed_loop, c, 3.0, 200);
    let order = (coarse / fine).log2();
    assert!((3.8..4.2).contains(&order), "order {order}: errors {coarse:e} and {fine:e}");
    let finest = error_after(closed_loop, c, 3.0, 3200);
    assert!(finest < 1e-10, "error {finest:e}");
}

#[test]
fn val_linear_synchronous_response_is_followed_at_fourth_order() {
    for (name, feedback, speed) in [("jeffcott", "cancel", 5.0), ("three-mass", "composite", 2.5)] {
        let rotor = builtin::rotor(name).expect("built in");
        let feedback = builtin::feedback(&rotor, feedback).expect("built in");
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[]);
        let c = synchronous(&rotor, &closed_loop, &[]);
        converges_at_fourth_order(&closed_loop, &c);
    }
}

#[test]
fn val_circular_whirl_with_deadband_is_followed_at_fourth_order() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let feedback = builtin::feedback(&rotor, "cancel").expect("built in");
    // Well inside and well outside the clearance, so that no step crosses its edge.
    for deadband in [[0.3], [0.6], [10.0]] {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, 1.5, &deadband);
        let c = synchronous_with_deadband(&rotor, &closed_loop, &deadband);
        assert!((c[0].norm() - deadband[0]).abs() > 0.1, "radius {} at the edge {}", c[0].norm(), deadband[0]);
        converges_at_fourth_order(&closed_loop, &c);
    }
}

#[test]
fn val_circular_whirl_of_a_chain_with_three_deadbands_is_followed() {
    let mass = |mass, damping, cross, bearing, unbalance| Mass {
        mass,
        damping,
        cross_damping: cross,
        bearing_stiffness: bearing,
        seal_stiffness: 0.05,
        unbalance,
        deadband: 0.0,
    };
    let rotor = Rotor::new(
        "five",
        vec![
            mass(0.10, 0.30, 0.05, 0.3, 0.3),
            mass(0.30, 0.10, 0.02, 0.0, 0.1),
            mass(0.20, 0.20, 0.00, 0.2, 0.4),
            mass(0.25, 0.15, 0.01, 0.0, -0.2),
            mass(0.15, 0.25, 0.04, 0.4, 0.2),
        ],
        vec![0.4, 0.6, 0.5, 0.3],
    )
    .expect("valid");
    let feedback = Feedback::new(1, vec![Signal::composite(&[0.2, 1.0, 0.3, 0.0, 0.1], [0.1, 0.3, -0.1, 0.0])]);
    let deadband = [0.05, 0.0, 0.04, 0.0, 0.06];
    let closed_loop = ClosedLoop::new(&rotor, &feedback, 0.9, &deadband);
    let c = synchronous_with_deadband(&rotor, &closed_loop, &deadband);
    for (c, g) in c.iter().zip(deadband) {
        assert!((c.norm() - g).abs() > 0.01, "radius {} at the edge {g}", c.norm());
    }
    converges_at_fourth_order(&closed_loop, &c);
}

#[test]
fn val_free_motion_is_the_sum_of_its_modes() {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let still = Rotor::new(
        "balanced",
        rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect(),
        rotor.shafts().to_vec(),
    )
    .expect("valid");
    let feedback = builtin::feedback(&still, "off").expect("built in");
    let closed_loop = ClosedLoop::new(&still, &feedback, 2.0, &[]);
    for mode in Modes::of(&closed_loop).expect("converges").modes {
        let velocity: Vec<C64> = mode.shape.iter().map(|c| c * mode.pole).collect();
        let mut motion = stepper(&closed_loop);
        motion.place(&mode.shape, &velocity);
        (0..5000).for_each(|_| motion.step(0.001));
        let grown = (mode.pole * motion.motion().tau).exp();
        for (c, p) in mode.shape.iter().zip(motion.motion().displacement) {
            assert!((c * grown - p).norm() < 1e-10 * grown.norm().max(1.0), "mode at {}", mode.pole);
        }
    }
}

#[test]
fn val_a_change_of_speed_leaves_the_spin_angle_continuous() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let feedback = builtin::feedback(&rotor, "cancel").expect("built in");
    let at = |speed| ClosedLoop::new(&rotor, &feedback, speed, &[1.0]);
    let mut motion = stepper(&at(2.0));
    (0..1000).for_each(|_| motion.step(0.01));
    motion.load(&at(3.0));
    (0..500).for_each(|_| motion.step(0.01));
    motion.step(0.005);
    let now = motion.motion();
    assert!((now.tau - 15.005).abs() < 1e-12 && (now.angle - (20.0 + 15.015)).abs() < 1e-12, "{now:?}");
    motion.rest();
    assert_eq!((motion.motion().tau, motion.motion().angle), (0.0, 0.0));
}

#[test]
fn val_sixteen_masses_step_like_the_matrix_says() {
    let masses = (0..MAX_MASSES).map(|i| Mass { mass: 0.5 + i as f64, damping: 0.1, ..Mass::default() }).collect();
    let rotor = Rotor::new("long", masses, vec![1.0; MAX_MASSES - 1]).expect("valid");
    let feedback = builtin::feedback(&rotor, "off").expect("fits any");
    let closed_loop = ClosedLoop::new(&rotor, &feedback, 1.0, &[]);
    let mut motion = stepper(&closed_loop);
    motion.kick(7, C64::new(1.0, -2.0));
    // One tiny step is the matrix times the state, to first order.
    let x: Vec<C64> = motion.motion().displacement.iter().chain(motion.motion().velocity).copied().collect();
    let slope = closed_loop.state_matrix() * DVector::from_vec(x.clone());
    let h = 1e-6;
    motion.step(h);
    let moved = motion.motion().displacement.iter().chain(motion.motion().velocity).copied().collect::<Vec<_>>();
    for ((before, after), slope) in x.iter().zip(&moved).zip(slope.iter()) {
        assert!(((after - before) / h - slope).norm() < 1e-5);
    }
}
