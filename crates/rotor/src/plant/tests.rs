use nalgebra::DVector;

use super::*;
use crate::{ClosedLoop, Feedback, J, Signal, builtin};

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

fn off(masses: usize) -> Feedback {
    Feedback::new(0, vec![Signal::at_mass(0, masses, [0.0; 4])])
}

/// The same rotor in coordinates that mix its masses, as a foreign model has them.
fn mixed(rotor: &Rotor) -> Plant {
    let plant = Plant::of(rotor);
    let n = plant.order();
    let mix = DMatrix::from_fn(n, n, |i, k| C64::new(if i == k { 1.0 } else { 0.3 }, 0.1 * (i as f64 - k as f64)));
    let mass = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| C64::from(rotor.masses()[i].mass)));
    // q = mix x; the forces are projected on the rows of mix's adjoint.
    let project = mix.adjoint();
    let at = |speed: f64| plant.linear(&OperatingPoint { speed, contact_factors: vec![0.0; n] });
    let ([d0, s0], [d1, s1]) = (at(0.0), at(1.0));
    let through = |m: &DMatrix<C64>| &project * &mass * m * &mix;
    let forces = |i: usize| Direction::Dense((&project * Direction::Unit(i).dense(n)).iter().copied().collect());
    let given = Matrices {
        tabulated: vec![],
        mass: &project * &mass * &mix,
        damping: [through(&d0), through(&(d1 - &d0))],
        stiffness: [through(&s0), through(&(s1 - &s0))],
        stations: (0..n)
            .map(|i| Station { name: format!("{i}"), row: Direction::Dense(mix.row(i).iter().copied().collect()) })
            .collect(),
        contacts: (0..n)
            .map(|i| Contact {
                station: i,
                column: forces(i),
                stiffness: rotor.masses()[i].bearing_stiffness,
                is_touchdown: false,
            })
            .collect(),
        unbalance: (&project * &mass * DVector::from_column_slice(plant.unbalance())).iter().copied().collect(),
        columns: (0..n).map(forces).collect(),
    };
    Plant::of_matrices(given).expect("a plant")
}

#[test]
fn a_chain_has_the_state_matrix_that_the_fused_path_has() {
    let rotor = three_mass();
    let closed = ClosedLoop::new(&rotor, &off(3), 2.5, &[0.0; 3]);
    let expected = closed.state_matrix_with(&[0.3, 1.0, 0.7]);
    let [d, s] = Plant::of(&rotor).linear(&OperatingPoint { speed: 2.5, contact_factors: vec![0.3, 1.0, 0.7] });
    assert!((expected.view((3, 3), (3, 3)) - d).norm() < 1e-15);
    assert!((expected.view((3, 0), (3, 3)) - s).norm() < 1e-15);
}

#[test]
fn the_same_rotor_in_other_coordinates_moves_alike() {
    let rotor = three_mass();
    let (chain, mixed) = (Plant::of(&rotor), mixed(&rotor));
    let x = [C64::new(1.0, 0.2), C64::new(-0.7, 3.0), C64::new(0.4, -2.0)];
    let v = [C64::new(0.1, 0.5), C64::new(2.0, -1.0), C64::new(0.0, 0.3)];
    let read = |x: &[C64]| -> Vec<C64> { mixed.stations().iter().map(|s| s.row.read(x)).collect() };
    let (q, qv) = (read(&x), read(&v));
    let spin = Spin { speed: 2.5, acceleration: 0.2, direction: (J * 0.7).exp() };
    let clearances = [1.0, 0.0, 0.5];
    let (mut a, mut b) = ([C64::ZERO; 3], [C64::ZERO; 3]);
    chain.acceleration(&spin, &clearances, &q, &qv, &mut a);
    mixed.acceleration(&spin, &clearances, &x, &v, &mut b);
    for (a, b) in a.iter().zip(read(&b)) {
        assert!((a - b).norm() < 1e-12, "{a} {b}");
    }
}

#[test]
fn what_is_no_plant_is_refused_with_a_reason() {
    let one = DMatrix::<C64>::identity(1, 1);
    let given = Matrices {
        tabulated: vec![],
        mass: one.clone(),
        damping: [one.clone(), one.clone()],
        stiffness: [one.clone(), one],
        stations: vec![Station { name: "s".into(), row: Direction::Unit(0) }],
        contacts: vec![],
        unbalance: vec![C64::ONE],
        columns: vec![Direction::Unit(0)],
    };
    let told = |change: &dyn Fn(&mut Matrices)| {
        let mut changed = given.clone();
        change(&mut changed);
        Plant::of_matrices(changed).expect_err("refused").to_string()
    };
    assert_eq!(told(&|g| g.mass[(0, 0)] = C64::ZERO), "the mass matrix is singular: every coordinate needs a mass");
    assert_eq!(told(&|g| g.stiffness[1] = DMatrix::zeros(2, 2)), "stiffness does not fit 1 coordinates");
    assert_eq!(told(&|g| g.damping[0][(0, 0)].im = f64::NAN), "damping has an entry that is not finite");
    assert_eq!(told(&|g| g.columns = vec![Direction::Unit(1)]), "a control bearing does not fit 1 coordinates");
    assert_eq!(told(&|g| g.mass = DMatrix::zeros(0, 0)), "0 coordinates: expected 1 to 512");
}
