//! Numbers with a unit behind them, as a person types them: `3000rpm`, `50Hz`, `12um`.

use std::f64::consts::TAU;

use crate::Dimension;

/// Units that can be typed: what they measure, and how many of the SI unit that [`Dimension::si`] counts in one of them is.
const TYPED: [(Dimension, &str, f64); 15] = [
    (Dimension::Speed, "rpm", 1.0),
    (Dimension::Speed, "Hz", 60.0),
    (Dimension::Speed, "rad/s", 60.0 / TAU),
    (Dimension::SpeedRate, "rpm/s", 1.0),
    (Dimension::SpeedRate, "Hz/s", 60.0),
    (Dimension::Length, "m", 1.0),
    (Dimension::Length, "mm", 1e-3),
    (Dimension::Length, "um", 1e-6),
    (Dimension::Length, "μm", 1e-6),
    (Dimension::Time, "s", 1.0),
    (Dimension::Time, "ms", 1e-3),
    (Dimension::Time, "us", 1e-6),
    (Dimension::Force, "N", 1.0),
    (Dimension::Force, "kN", 1e3),
    (Dimension::ForceRate, "N/s", 1.0),
];

/// A number with a unit that measures `dimension`, in the SI unit that [`Dimension::si`] counts in. Nothing for a number alone, for another
/// unit, and for what is no finite number.
///
/// ```
/// use units::{Dimension, typed_in_si};
/// assert_eq!(typed_in_si("3000rpm", Dimension::Speed), Some(3000.0));
/// assert_eq!(typed_in_si("50 Hz", Dimension::Speed), Some(3000.0));
/// assert_eq!(typed_in_si("3000", Dimension::Speed), None);
/// assert_eq!(typed_in_si("3000rpm", Dimension::Length), None);
/// ```
#[must_use]
pub fn typed_in_si(typed: &str, dimension: Dimension) -> Option<f64> {
    let of = TYPED.iter().filter(|(of, ..)| *of == dimension);
    let read = |(_, name, factor): &(Dimension, &str, f64)| {
        let number = typed.trim().strip_suffix(name)?.trim_end().parse::<f64>().ok()?;
        (number * factor).is_finite().then_some(number * factor)
    };
    of.filter_map(read).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_one_of_its_quantity_and_no_part_of_another() {
        for (typed, dimension, si) in [
            ("1.5mm", Dimension::Length, Some(1.5e-3)),
            ("12um", Dimension::Length, Some(12.0 * 1e-6)),
            ("12μm", Dimension::Length, Some(12.0 * 1e-6)),
            ("2m", Dimension::Length, Some(2.0)),
            ("20 ms", Dimension::Time, Some(0.02)),
            ("-1e3rpm/s", Dimension::SpeedRate, Some(-1000.0)),
            ("2kN", Dimension::Force, Some(2000.0)),
            ("2k", Dimension::Force, None),
            ("infrpm", Dimension::Speed, None),
            ("rpm", Dimension::Speed, None),
            ("3krpm", Dimension::Speed, None),
            ("1", Dimension::Number, None),
        ] {
            assert_eq!(typed_in_si(typed, dimension), si, "{typed}");
        }
        // A turn a second is sixty a minute and 2 pi radians a second.
        let [hertz, radians] =
            [format!("1Hz"), format!("{TAU}rad/s")].map(|typed| typed_in_si(&typed, Dimension::Speed));
        assert!(hertz == Some(60.0) && (radians.unwrap() - 60.0).abs() < 1e-12);
    }
}
