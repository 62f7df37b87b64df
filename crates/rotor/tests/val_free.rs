//! Rotors that nothing holds: they move as a whole at poles of exactly 0, and bend as a free shaft does.

use rotor::{C64, Characteristic, LinearForm, OperatingPoint, Plant, Rotor, Stability, file};

const STEEL: &str = "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n";

/// A tube of 1.2 m with an uneven disc, so that its centre of mass is nowhere in particular.
fn rotor(held: &str) -> Rotor {
    let text = format!(
        "{STEEL}{}[[disc]]\nstation = 2\nmass = 12.0\npolar_inertia = 0.11\ndiametral_inertia = 0.06\n{held}",
        "[[section]]\nlength = 0.4\nouter = 0.08\ninner = 0.03\nelements = 4\n".repeat(3)
    );
    file::read_rotor(&text, "free").expect("a rotor")
}

/// The poles in 1/s, least in size first.
fn poles(rotor: &Rotor, rpm: f64) -> Vec<C64> {
    let scales = rotor.scales().expect("SI");
    let feedback = rotor.beam().expect("shaft elements").no_feedback();
    let form = LinearForm::of(&Plant::of(rotor), &feedback, &OperatingPoint::at(scales.speed(rpm))).expect("fits");
    let roots = Characteristic::of(&form).expect("finite").roots().expect("found");
    let mut poles: Vec<C64> = roots.iter().map(|root| root.pole * scales.w0).collect();
    poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    poles
}

/// Polar inertia, and inertia about a diameter through the centre of mass, of all of it.
fn inertia(rotor: &Rotor) -> [f64; 2] {
    let full = rotor.beam().expect("shaft elements").full();
    let motions = full.free_motions();
    let [_, tilt] = &motions[..] else { panic!("two motions") };
    // As `psi` is 1: the second coordinate of any node.
    let tilt = tilt / tilt[1];
    let of = |matrix: &nalgebra::DMatrix<f64>| tilt.dot(&(matrix * &tilt));
    [of(&full.gyroscopic), of(&full.mass)]
}

/// A rigid body in space: at rest nothing; spinning, it drifts and tilts for nothing and nutates at `Ip / It` of the spin.
#[test]
fn val_a_free_rotor_nutates_as_a_rigid_body_and_bends_as_a_free_shaft() {
    let free = rotor("");
    let [polar, diametral] = inertia(&free);
    for (rotor, within) in [(free.clone(), 1e-4), (free.in_full().expect("a plant"), 1e-8)] {
        let bending = |rpm: f64| {
            let full = free.beam().expect("shaft elements").full();
            let mut all = full.eigenvalues(rpm * std::f64::consts::PI / 30.0).expect("found");
            all.retain(|pole| pole.norm() > 0.5 * full.bending_frequency());
            all.into_iter().take(4).collect::<Vec<_>>()
        };
        for rpm in [0.0, 60.0, 6000.0, 30_000.0] {
            let found = poles(&rotor, rpm);
            let still = found.iter().filter(|pole| **pole == C64::ZERO).count();
            assert_eq!(still, if rpm == 0.0 { 4 } else { 3 }, "{:?} at {rpm}", &found[..6]);
            assert!(found.iter().take(8).all(|pole| Stability::of(*pole) == Stability::Marginal), "{found:?}");
            if rpm > 0.0 {
                let spin = rpm * std::f64::consts::PI / 30.0;
                let (nutation, bending) = (polar / diametral * spin, rotor.scales().expect("SI").w0);
                // The faster it spins the more it bends while it nutates.
                let within = 1e-6 + 0.1 * (spin / bending).powi(2);
                assert!((found[3].im - nutation).abs() < within * nutation, "{} for {nutation} at {rpm}", found[3]);
            }
            for exact in bending(rpm) {
                let off = found.iter().map(|pole| (pole - exact).norm()).fold(f64::INFINITY, f64::min);
                assert!(off < within * exact.norm(), "{exact} at {rpm} is off by {off}");
            }
        }
    }
}

/// Its scale is its first bending frequency, so that numbers are of the order of 1.
#[test]
fn a_free_rotor_is_measured_by_its_first_bending_frequency() {
    let free = rotor("");
    let scales = free.scales().expect("SI");
    let first = poles(&free, 0.0)[4].norm();
    assert!((scales.w0 - first).abs() < 1e-4 * first, "{} and {first}", scales.w0);
    assert!((scales.k_t - scales.m_t * scales.w0 * scales.w0).abs() < 1e-9 * scales.k_t);
}

/// On one bearing it swings about that, freely; a damper alone stops its drift, not its place.
#[test]
fn val_a_rotor_held_in_part_is_free_in_the_rest() {
    let pinned = poles(&rotor("[[bearing]]\nstation = 1\nstiffness = 1e8\n"), 0.0);
    assert_eq!(pinned.iter().filter(|pole| **pole == C64::ZERO).count(), 2, "{:?}", &pinned[..4]);
    let damped = poles(&rotor("[[seal]]\nstation = 1\ndamping = 300.0\n[[seal]]\nstation = 4\ndamping = 300.0\n"), 0.0);
    assert_eq!(damped.iter().filter(|pole| **pole == C64::ZERO).count(), 2, "{:?}", &damped[..5]);
    assert!(damped.iter().skip(2).all(|pole| pole.re < 0.0), "{damped:?}");
    // Moving sideways alone, the mass against both dampers, if there were no tilt: near to that.
    let mass = rotor("").scales().expect("SI").m_t;
    assert!(damped[2..4].iter().any(|pole| (pole.re + 600.0 / mass).abs() < 0.1 * 600.0 / mass), "{:?}", &damped[..5]);
}

/// What another program made of it is free too.
#[test]
fn val_matrices_of_a_free_rotor_are_free() {
    let full = rotor("").beam().expect("shaft elements").full().clone();
    let rows = |matrix: &nalgebra::DMatrix<f64>| {
        let row = |i: usize| matrix.row(i).iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(", ");
        (0..matrix.nrows()).map(|i| format!("[{}]", row(i))).collect::<Vec<_>>().join(",\n")
    };
    let text = format!(
        "units = 'si'\n[plant]\nstations = [1, 9, 17, 25]\npositions = [0.0, 0.4, 0.8, 1.2]\nmass = [{}]\nstiffness = [{}]\ngyroscopic = [{}]\n",
        rows(&full.mass),
        rows(&full.stiffness),
        rows(&full.gyroscopic)
    );
    let given = file::read_rotor(&text, "given").expect("a rotor");
    let (found, known) = (poles(&given.in_full().expect("a plant"), 6000.0), poles(&rotor(""), 6000.0));
    assert_eq!(found.iter().filter(|pole| **pole == C64::ZERO).count(), 3, "{:?}", &found[..6]);
    for (found, known) in found.iter().zip(&known).take(8) {
        assert!((found - known).norm() < 1e-4 * (1.0 + known.norm()), "{found} and {known}");
    }
}
