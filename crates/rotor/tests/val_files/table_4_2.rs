//! The machine of Table 4.2 in SI units, and how far another rotor is from it.

use rotor::{Mass, Rotor, builtin};

/// Table 4.2 as a machine of 40 kg with w0 = 300 rad/s and an unbalance of 20 um.
pub(crate) const SI: &str = r#"
name = "three-mass"
units = "si"
[[mass]]
mass = 10
damping = 1500
cross_damping = 300
bearing_stiffness = 1.8e6
deadband = 2e-5
[[mass]]
mass = 20
unbalance = 20e-6
[[mass]]
mass = 10
damping = 1500
cross_damping = 300
bearing_stiffness = 1.8e6
deadband = 20e-6
[[shaft]]
stiffness = 1.8e6
[[shaft]]
stiffness = 1.8e6
"#;

/// The report's rotor with a deadband of 1 at both ends.
pub(crate) fn report_rotor() -> Rotor {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let ends = |(i, m): (usize, &Mass)| Mass { deadband: if i == 1 { 0.0 } else { 1.0 }, ..*m };
    Rotor::new("three-mass", rotor.masses().iter().enumerate().map(ends).collect(), rotor.shafts().to_vec())
        .expect("valid")
}

/// Largest distance between the values of two rotors, relative to the larger of the value and 1.
pub(crate) fn distance(a: &Rotor, b: &Rotor) -> f64 {
    let values = |r: &Rotor| r.masses().iter().flat_map(Mass::values).chain(r.shafts().to_vec()).collect::<Vec<_>>();
    let (a, b) = (values(a), values(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
}
