//! Laws that hold for any rotor: random machines, random feedback, random motion.

use nalgebra::DVector;
use proptest::prelude::*;
use rotor::{C64, ClosedLoop, Feedback, Mass, Modes, Rotor, Signal, damping_ratio, eigenvalues, report_form, stepper};

fn mass() -> impl Strategy<Value = Mass> {
    (0.05..2.0, 0.0..0.6, 0.0..0.2, 0.0..1.0, 0.0..1.0, -1.0..1.0, 0.0..3.0).prop_map(
        |(mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband)| Mass {
            mass,
            damping,
            cross_damping,
            bearing_stiffness,
            seal_stiffness,
            unbalance,
            deadband,
        },
    )
}

fn machine() -> impl Strategy<Value = (Rotor, Feedback)> {
    (1usize..=6).prop_flat_map(|n| {
        let weights = || prop::collection::vec(-1.0..1.0, n);
        let signal = (weights(), weights(), prop::array::uniform4(-2.0..2.0)).prop_map(|(d, v, gains)| {
            let mut signal = Signal::composite(&d, gains);
            signal.velocity = v;
            signal
        });
        (
            prop::collection::vec(mass(), n),
            prop::collection::vec(0.0..1.0, n - 1),
            prop::collection::vec(signal, 1..=3),
            0..n,
        )
            .prop_map(|(masses, shafts, signals, bearing)| {
                (Rotor::new("random", masses, shafts).expect("in range"), Feedback::new(bearing, signals))
            })
    })
}

fn plane(n: usize) -> impl Strategy<Value = Vec<C64>> {
    prop::collection::vec((-2.0..2.0, -2.0..2.0).prop_map(|(y, z)| C64::new(y, z)), n)
}

fn complex(real: &nalgebra::DMatrix<f64>) -> nalgebra::DMatrix<C64> {
    real.map(C64::from)
}

proptest! {
    /// The report's real matrix has the poles of the complex form and their conjugates.
    #[test]
    fn real_and_complex_forms_have_the_same_poles((rotor, feedback) in machine(), speed in 0.0..6.0) {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[]);
        let mut expected: Vec<C64> = Modes::of(&closed_loop).expect("converges").modes.iter()
            .flat_map(|m| [m.pole, m.pole.conj()]).collect();
        let real = report_form::closed_loop_matrix(&rotor, &feedback, speed);
        for pole in eigenvalues(complex(&real)).expect("converges") {
            let (at, distance) = expected.iter().enumerate()
                .map(|(i, e)| (i, (e - pole).norm())).min_by(|a, b| a.1.total_cmp(&b.1)).expect("one each");
            // Poles that nearly coincide move by the root of the rounding error.
            prop_assert!(distance < 1e-5, "{pole} is not among {expected:?}");
            expected.swap_remove(at);
        }
    }

    /// The sums over all poles are traces: of the matrix, and of its square.
    #[test]
    fn poles_sum_to_the_trace((rotor, feedback) in machine(), speed in 0.0..6.0) {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[]);
        let a = closed_loop.state_matrix();
        let poles = Modes::of(&closed_loop).expect("converges");
        let sum: C64 = poles.modes.iter().map(|m| m.pole).sum();
        let squares: C64 = poles.modes.iter().map(|m| m.pole * m.pole).sum();
        let scale = a.norm();
        prop_assert!((sum - a.trace()).norm() < 1e-11 * scale);
        prop_assert!((squares - (&a * &a).trace()).norm() < 1e-10 * scale * scale);
    }

    /// Every mode solves `A x = lambda x`, is scaled to a largest component of 1, and they come least damped first.
    #[test]
    fn shapes_are_eigenvectors((rotor, feedback) in machine(), speed in 0.0..6.0) {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &[]);
        let a = closed_loop.state_matrix();
        let modes = Modes::of(&closed_loop).expect("converges").modes;
        for mode in &modes {
            let x: Vec<C64> = mode.shape.iter().copied().chain(mode.shape.iter().map(|c| c * mode.pole)).collect();
            let x = DVector::from_vec(x);
            let residual = (&a * &x - &x * mode.pole).norm();
            prop_assert!(residual < 1e-6 * a.norm() * x.norm(), "residual {residual:e} at {}", mode.pole);
            let largest = mode.shape.iter().map(|c| c.norm()).fold(0.0, f64::max);
            prop_assert!((largest - 1.0).abs() < 1e-6);
            let zeta = mode.damping();
            if mode.pole.im != 0.0 && zeta.abs() < 0.999 {
                let textbook = std::f64::consts::TAU * zeta / (1.0 - zeta * zeta).sqrt();
                prop_assert!((mode.log_decrement() - textbook).abs() < 1e-6 * textbook.abs().max(1.0));
            }
        }
        prop_assert!(modes.windows(2).all(|w| w[0].damping() <= w[1].damping()));
        prop_assert!(modes.iter().all(|m| damping_ratio(m.pole.conj()) == m.damping()));
    }

    /// Turning the initial state turns the answer: nothing prefers a direction, deadband or not, once the unbalance is gone.
    #[test]
    fn motion_is_radially_symmetric((rotor, feedback) in machine(), speed in 0.0..4.0, turn in 0.0..std::f64::consts::TAU, seed in plane(12)) {
        let balanced = Rotor::new("balanced",
            rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect(), rotor.shafts().to_vec()).expect("valid");
        let closed_loop = ClosedLoop::new(&balanced, &feedback, speed, &balanced.deadbands());
        let n = balanced.len();
        let turned: Vec<C64> = seed.iter().map(|p| p * C64::cis(turn)).collect();
        let (mut straight, mut askew) = (stepper(&closed_loop), stepper(&closed_loop));
        straight.place(&seed[..n], &seed[6..6 + n]);
        askew.place(&turned[..n], &turned[6..6 + n]);
        for _ in 0..100 {
            straight.step(0.01);
            askew.step(0.01);
        }
        for (a, b) in straight.motion().displacement.iter().zip(askew.motion().displacement) {
            prop_assert!((a * C64::cis(turn) - b).norm() < 1e-9 * (1.0 + a.norm()));
        }
    }

    /// Without damping, cross-coupling, control and deadband the energy stays, to the order of the integrator.
    #[test]
    fn energy_is_conserved_without_seals((rotor, _) in machine(), seed in plane(12)) {
        let plain = Rotor::new("conservative", rotor.masses().iter().map(|m| Mass {
            damping: 0.0, cross_damping: 0.0, unbalance: 0.0, deadband: 0.0, ..*m }).collect(), rotor.shafts().to_vec()).expect("valid");
        let feedback = rotor::builtin::feedback(&plain, "off").expect("fits any");
        let n = plain.len();
        let mut motion = stepper(&ClosedLoop::new(&plain, &feedback, 3.0, &[]));
        motion.place(&seed[..n], &seed[6..6 + n]);
        let energy = |m: rotor::Motion<'_>| -> f64 {
            let own: f64 = plain.masses().iter().zip(m.displacement.iter().zip(m.velocity)).map(|(mass, (p, v))|
                mass.mass * v.norm_sqr() + (mass.bearing_stiffness + mass.seal_stiffness) * p.norm_sqr()).sum();
            let shafts: f64 = plain.shafts().iter().zip(m.displacement.windows(2)).map(|(k, p)| k * (p[0] - p[1]).norm_sqr()).sum();
            own + shafts
        };
        let before = energy(motion.motion());
        for _ in 0..500 {
            motion.step(0.002);
        }
        let after = energy(motion.motion());
        prop_assert!((after - before).abs() < 1e-8 * before.max(1.0), "{before} became {after}");
    }

    /// Same start, same bits.
    #[test]
    fn the_same_run_gives_the_same_bits((rotor, feedback) in machine(), seed in plane(12)) {
        let closed_loop = ClosedLoop::new(&rotor, &feedback, 1.7, &rotor.deadbands());
        let run = || {
            let mut motion = stepper(&closed_loop);
            motion.place(&seed[..rotor.len()], &[]);
            (0..200).for_each(|_| motion.step(0.01));
            motion.motion().displacement.iter().flat_map(|p| [p.re.to_bits(), p.im.to_bits()]).collect::<Vec<_>>()
        };
        prop_assert_eq!(run(), run());
    }

    /// A run that is taken up where it was, on the line of time it was on, goes on with the same bits.
    #[test]
    fn a_run_goes_on_from_any_step((rotor, feedback) in machine(), seed in plane(12), before in 0u64..100, changed in 1u64..100) {
        let n = rotor.len();
        let at = |speed| ClosedLoop::new(&rotor, &feedback, speed, &rotor.deadbands());
        let mut run = stepper(&at(1.7));
        run.place(&seed[..n], &[]);
        (0..before).for_each(|_| run.step(0.01));
        let line = (run.motion().tau, run.motion().angle);
        run.load(&at(2.3));
        (0..changed).for_each(|_| run.step(0.01));
        let mut again = stepper(&at(2.3));
        again.place(run.motion().displacement, run.motion().velocity);
        again.set_clock(line.0, line.1, changed, 0.01);
        for _ in 0..100 {
            let bits = |m: rotor::Motion<'_>| [m.tau.to_bits(), m.angle.to_bits(), m.displacement[0].re.to_bits(), m.velocity[n - 1].im.to_bits()];
            prop_assert_eq!(bits(run.motion()), bits(again.motion()));
            run.step(0.01);
            again.step(0.01);
        }
    }

    /// A matrix with anything in it that is not finite is refused by place, and never iterated on.
    #[test]
    fn what_is_not_finite_is_refused(size in 1usize..12, row in 0usize..12, column in 0usize..12, bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY])) {
        let (row, column) = (row % size, column % size);
        let mut matrix = nalgebra::DMatrix::<C64>::identity(size, size);
        matrix[(row, column)] = C64::new(0.0, bad);
        prop_assert_eq!(eigenvalues(matrix), Err(linear::EigenvalueError::NotFinite { row: row + 1, column: column + 1 }));
    }
}
