//! The report's two rotors (Tables 3.2 and 4.2), a machine on magnetic bearings, and the feedback that comes with each.

use crate::{Feedback, Gain, GainKind, Mass, Rotor, Signal};

/// Names of the built-in rotors, in the order they are listed.
pub const ROTORS: [&str; 3] = ["jeffcott", "three-mass", "rig"];

/// A test-rig rotor on two magnetic bearings, with the law of its controller.
const RIG: &str = include_str!("rig.toml");

/// The built-in rotor of that name, with its deadband at zero.
#[must_use]
pub fn rotor(name: &str) -> Option<Rotor> {
    let made = match name {
        "jeffcott" => Rotor::new(
            name,
            vec![Mass {
                mass: 1.0,
                damping: 0.5,
                cross_damping: 0.1,
                bearing_stiffness: 0.8,
                seal_stiffness: 0.2,
                unbalance: 1.0,
                deadband: 0.0,
            }],
            vec![],
        ),
        "three-mass" => {
            let end =
                Mass { mass: 0.25, damping: 0.25, cross_damping: 0.05, bearing_stiffness: 0.5, ..Mass::default() };
            let centre = Mass { mass: 0.5, unbalance: 1.0, ..Mass::default() };
            Rotor::new(name, vec![end, centre, end], vec![0.5, 0.5])
        }
        "rig" => return crate::file::read_rotor(RIG, name).ok(),
        _ => return None,
    };
    Some(made.expect("built-in parameters are valid"))
}

/// What a built-in rotor is, in a few words; empty if there is no such rotor.
#[must_use]
pub fn about(name: &str) -> &'static str {
    match name {
        "jeffcott" => "one mass between its bearings (the report's Table 3.2)",
        "rig" => "a flexible shaft with discs on two magnetic bearings, in SI units",
        "three-mass" => "a flexible shaft with three masses, bearings at its ends (Table 4.2)",
        _ => "",
    }
}

/// Names of the feedback that fits a rotor: `off` for any, `own` for one whose drawing has a law for its magnetic bearings, the rest for
/// the built-in rotor they were made for.
#[must_use]
pub fn feedback_names(rotor: &Rotor) -> &'static [&'static str] {
    if let Some(beam) = rotor.beam() {
        return if beam.own_feedback().is_some() { &["off", "own"] } else { &["off"] };
    }
    match (rotor.name(), rotor.len()) {
        ("jeffcott", 1) => &["off", "cancel"],
        ("three-mass", 3) => &["off", "composite", "individual"],
        _ => &["off"],
    }
}

/// The feedback that a live bench starts with: the first that stabilises, if the rotor has one.
#[must_use]
pub fn live_feedback_name(rotor: &Rotor) -> &'static str {
    feedback_names(rotor).get(1).copied().unwrap_or("off")
}

/// The feedback that analysis takes where none is named: `off`, the rotor as it is; but what hangs in magnetic bearings is no machine
/// without its law.
#[must_use]
pub fn analysis_feedback_name(rotor: &Rotor) -> &'static str {
    if rotor.beam().is_some() { live_feedback_name(rotor) } else { "off" }
}

/// The built-in feedback of that name for this rotor, with the control bearing of a chain at mass 1.
///
/// `off` has the structure of the rotor's first real feedback with every gain zero, so that it can be tuned up.
#[must_use]
pub fn feedback(rotor: &Rotor, name: &str) -> Option<Feedback> {
    if !feedback_names(rotor).contains(&name) {
        return None;
    }
    if let Some(beam) = rotor.beam() {
        return if name == "own" { beam.own_feedback() } else { Some(beam.no_feedback()) };
    }
    let signals = match name {
        "off" => {
            let structure = live_feedback_name(rotor);
            return Some(if structure == "off" {
                Feedback::new(0, vec![Signal::at_mass(0, rotor.len(), [0.0; 4])])
            } else {
                feedback(rotor, structure)?.off()
            });
        }
        // (3.43): kc = zeta (R0 - R) with R0 = 0 cancels the seal's cross-coupled stiffness.
        "cancel" => {
            let mut signal = Signal::at_mass(0, 1, [0.0; 4]);
            *signal.gain_mut(GainKind::Kc) = Gain::Linear { at_zero: 0.0, slope: -rotor.masses()[0].damping };
            vec![signal]
        }
        // The report's structure a = b = d = e = 1, c = f = 0, over as wide a range as it holds with something to spare:
        //     whirl tune three-mass --over 0..7 --signal composite --sensors 1,2
        // Damping at least 0.0036 from 0 to R = 7, stable to 7.07. At 7.19 no gains of this structure hold the whole range.
        "composite" => vec![Signal::composite(&[1.0, 1.0, 0.0], [-0.5879, 0.4948, -0.4847, 0.6483])],
        // Whatever deadband leaves of the stiffness of each bearing, with gains no larger than that takes:
        //     whirl tune three-mass --over 0..7.2 --signal individual --sensors 1,2 --robust deadband --bound 4
        // Damping at least 0.0113 over 0 <= R <= 7.2; within a bound of 3 it is 0.0002 at best.
        "individual" => vec![
            Signal::at_mass(0, 3, [4.0, 3.1168, 3.1241, 0.9175]),
            Signal::at_mass(1, 3, [-2.3419, 4.0, -3.7635, 4.0]),
        ],
        _ => return None,
    };
    Some(Feedback::new(0, signals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_gives_feedback_that_fits() {
        for name in ROTORS {
            let rotor = rotor(name).expect("listed");
            assert!(!about(name).is_empty());
            for feedback_name in feedback_names(&rotor) {
                let feedback = feedback(&rotor, feedback_name).expect("listed");
                feedback.check(rotor.len()).expect("fits");
                assert_eq!(feedback.is_off(), *feedback_name == "off");
            }
        }
        assert!(rotor("jefcott").is_none());
        assert!(feedback(&rotor("jeffcott").expect("listed"), "composite").is_none());
    }
}
