//! Files that are well formed and made up, key by key, with numbers from all over the range.

use std::fmt::Write as _;

use proptest::prelude::*;

/// A number as it may stand in a file: mostly one of the size that is usual.
fn number(pick: u16) -> String {
    const MANTISSAS: [f64; 8] = [0.0, 1.0, 0.5, 0.25, 2.0, 3.3, 0.07, 9.99];
    let mantissa = MANTISSAS[usize::from(pick % 8)];
    let exponent = match (pick / 8) % 8 {
        0..=5 => 0,
        6 => i32::from(pick / 64 % 25) - 12,
        _ => i32::from(pick / 64 % 617) - 308,
    };
    format!("{mantissa:?}e{exponent}")
}

/// A rotor of 1 to 16 masses.
pub(crate) fn rotor() -> impl Strategy<Value = String> {
    (1_usize..=16, any::<bool>(), prop::collection::vec(any::<u16>(), 16 * 8)).prop_map(|(masses, si, picks)| {
        let mut picks = picks.into_iter();
        let mut pick = move || picks.next().unwrap_or(1);
        let mut text = if si { "units = \"si\"\n".to_owned() } else { String::new() };
        for _ in 0..masses {
            text += "[[mass]]\n";
            for field in rotor::FIELDS {
                let pick = pick();
                let value = match field.name {
                    "mass" if pick.is_multiple_of(8) => "1.0".to_owned(),
                    "mass" => number(pick),
                    // One in eight is left out.
                    _ if pick % 8 == 7 => continue,
                    _ => number(pick),
                };
                let _ = writeln!(text, "{} = {value}", field.name);
            }
        }
        for _ in 1..masses {
            let _ = writeln!(text, "[[shaft]]\nstiffness = {}", number(pick()));
        }
        text
    })
}

/// Feedback for a rotor of three masses.
pub(crate) fn feedback() -> impl Strategy<Value = String> {
    (1_usize..=3, 1_usize..=4, prop::collection::vec(any::<u16>(), 4 * 28)).prop_map(|(bearing, signals, picks)| {
        let mut picks = picks.into_iter();
        let mut pick = move || picks.next().unwrap_or(1);
        let mut text = format!("bearing = {bearing}\n");
        for _ in 0..signals {
            text += "[[signal]]\n";
            let (kind, mass) = (pick(), pick());
            if kind.is_multiple_of(2) {
                let _ = writeln!(text, "mass = {}", mass % 3 + 1);
            } else {
                let mut list = || [0; 3].map(|_| number(pick())).join(", ");
                let (displacement, velocity) = (list(), list());
                let _ = writeln!(text, "displacement = [{displacement}]\nvelocity = [{velocity}]");
            }
            for gain in ["kd", "cd", "kc", "cc"] {
                let (form, [a, b, c, d]) = (pick(), [0; 4].map(|_| number(pick())));
                let _ = match form % 4 {
                    0 => writeln!(text, "{gain} = {a}"),
                    1 => writeln!(text, "{gain} = {{ at_zero = {a}, slope = -{b} }}"),
                    2 => writeln!(text, "{gain} = {{ speed = [0, {a}, 7], value = [{b}, {c}, {d}] }}"),
                    _ => Ok(()),
                };
            }
        }
        text
    })
}
