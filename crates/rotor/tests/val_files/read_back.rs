//! Laws: what is written reads back, and nothing makes a panic.

use proptest::prelude::*;
use rotor::file::{kind_of, read_feedback, read_rotor, write_feedback, write_rotor};
use rotor::{PhysicalMass, Rotor};
use text::{MAX_BYTES, utf8};

use crate::any::{any_feedback, any_rotor, mass_values};
use crate::table_4_2::{SI, distance};

proptest! {
    /// Writing and reading a rotor is the identity, down to the sign of a zero.
    #[test]
    fn a_rotor_reads_back_bit_for_bit(rotor in any_rotor()) {
        let written = write_rotor(&rotor);
        let read = read_rotor(&written, "x").expect("what we write is valid");
        prop_assert_eq!(format!("{read:?}"), format!("{rotor:?}"));
        prop_assert_eq!(write_rotor(&read), written);
    }

    /// Writing and reading feedback is the identity.
    #[test]
    fn feedback_reads_back_bit_for_bit((masses, feedback) in any_feedback()) {
        let written = write_feedback(&feedback);
        let read = read_feedback(&written, Some(masses)).expect("what we write is valid");
        prop_assert_eq!(format!("{read:?}"), format!("{feedback:?}"));
    }

    /// Grams or kilograms, minutes or seconds: the units cancel.
    #[test]
    fn other_units_give_the_same_dimensionless_rotor(
        masses in prop::collection::vec(mass_values(0.0..10.0), 3),
        shafts in prop::collection::vec(0.0..10.0, 2),
        kilogram in 1e-3..1e3, metre in 1e-3..1e3, second in 1e-3..1e3,
    ) {
        let stiffness = kilogram / (second * second);
        let damping = kilogram / second;
        let units = [kilogram, damping, damping, stiffness, stiffness, metre, metre];
        let of = |units: [f64; 7], shaft: f64| {
            let scaled = |m: &[f64; 7]| PhysicalMass::from_values(std::array::from_fn(|i| m[i] * units[i]));
            let shafts = shafts.iter().map(|k| k * shaft).collect();
            Rotor::from_si("x", masses.iter().map(scaled).collect(), shafts, None).expect("valid")
        };
        prop_assert!(distance(&of(units, stiffness), &of([1.0; 7], 1.0)) < 1e-12);
    }

    /// Random bytes never panic, whatever they are taken for.
    #[test]
    fn no_bytes_make_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(text) = utf8(&bytes, "a file") {
            read_anything(text);
        }
    }

    /// Nor does text made of the words of TOML files.
    #[test]
    fn no_words_make_a_panic(words in prop::collection::vec(prop::sample::select(vec![
        "[[mass]]\n", "[mass]\n", "[[signal]]\n", "[[shaft]]\n", "[loop]\n", "mass", "signal", "shaft", "kd", "bearing",
        "displacement", " = ", "1", "-1", "1.5", "nan", "inf", "1e999", "0x10", "99999999999999999999", "\"si\"", "units",
        "\n", "[", "]", "{", "}", ",", "speed", "value", "at_zero", "slope", ".", "'", "\"", "#", "\u{feff}", "\u{1b}",
    ]), 0..60)) {
        read_anything(&words.concat());
    }

    /// Nor does a valid file with some bytes overwritten, left out or doubled.
    #[test]
    fn no_damage_makes_a_panic(
        (masses, feedback) in any_feedback(),
        rotor in any_rotor(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0..3, any::<u8>()), 1..8),
    ) {
        for written in [write_rotor(&rotor), write_feedback(&feedback), SI.to_owned()] {
            let mut bytes = written.into_bytes();
            for (at, how, byte) in &damage {
                let at = at.index(bytes.len());
                match how {
                    0 => bytes[at] = *byte,
                    1 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, bytes[at]),
                }
            }
            if let Ok(text) = utf8(&bytes, "a file") {
                read_anything(text);
                let _ = read_feedback(text, Some(masses));
            }
        }
    }
}

/// Reads `text` as everything it could be; what is accepted must be sound.
fn read_anything(text: &str) {
    let _ = kind_of(text);
    if let Ok(rotor) = read_rotor(text, "x") {
        assert_eq!(read_rotor(&write_rotor(&rotor), "y").expect("reads back"), rotor);
    }
    for masses in [None, Some(1), Some(3)] {
        if let Ok(feedback) = read_feedback(text, masses) {
            let masses = masses.unwrap_or(feedback.bearings[0].signals[0].displacement.len());
            feedback.check(masses).expect("sound");
        }
    }
}

#[test]
fn deep_and_long_files_end_soon() {
    for unit in ["[", "{a=", "[[mass]]\n", "a.", "x = 1\n", "\"", "[a."] {
        let text = unit.repeat(MAX_BYTES / unit.len());
        assert!(read_rotor(&text, "x").is_err(), "{unit:?}");
        assert!(read_feedback(&text, None).is_err(), "{unit:?}");
    }
}
