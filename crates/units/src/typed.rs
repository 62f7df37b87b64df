//! Quantities as they are typed: a number, which may say what it is counted in.
//!
//! `3000rpm`, `50Hz`, `20um`, `2e5N/m`, `120 N s/m`; and `2.5w0`, `3e_t`, which are dimensionless whatever the machine. A number alone is
//! in whatever the one who reads it counts in.

use std::f64::consts::TAU;
use std::fmt;

use crate::{Dimension, Units};

/// What was typed for a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Typed {
    number: f64,
    counted: Counted,
}

/// What a number is counted in.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Counted {
    /// It does not say.
    Plain,
    /// The rotor's own scales, under this name.
    Dimensionless(&'static str),
    /// The SI unit of this name, which is so many times that of the table.
    Si(&'static str, f64),
}

/// Why what was typed is no value of a quantity. In words it is what was expected instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypedError {
    /// There is no number in front.
    #[error("expected a number")]
    NotANumber,
    /// What follows the number is no unit of the quantity.
    #[error("expected a number{}", in_one_of(.0))]
    Unit(Vec<&'static str>),
    /// An SI unit, of a rotor that has no scales.
    #[error("expected a number without a unit: the rotor is not one in SI units")]
    NoScales,
}

fn in_one_of(names: &[&str]) -> String {
    if names.is_empty() { " without a unit".to_owned() } else { format!(", alone or in {}", names.join(", ")) }
}

impl From<f64> for Typed {
    /// A number alone.
    fn from(number: f64) -> Self {
        Self::alone(number)
    }
}

impl fmt::Display for Typed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.counted {
            Counted::Plain => write!(f, "{}", self.number),
            Counted::Dimensionless(name) | Counted::Si(name, _) => write!(f, "{} {name}", self.number),
        }
    }
}

impl Typed {
    /// A number alone.
    #[must_use]
    pub const fn alone(number: f64) -> Self {
        Self { number, counted: Counted::Plain }
    }

    /// Reads a quantity.
    ///
    /// # Errors
    /// No number, or a unit of something else.
    pub fn read(dimension: Dimension, typed: &str) -> Result<Self, TypedError> {
        let typed = typed.trim();
        let (number, unit) = parts(typed).ok_or(TypedError::NotANumber)?;
        if unit.is_empty() {
            return Ok(number.into());
        }
        let unit = plain(unit);
        let own = dimension.unit();
        let names = dimension.names();
        let counted = match unit.as_str() {
            "tau" if dimension == Dimension::Time => Some(Counted::Dimensionless("tau")),
            unit if is_called(unit, own) => Some(Counted::Dimensionless(own)),
            unit => {
                names.iter().find(|(name, _)| is_called(unit, name)).map(|(name, factor)| Counted::Si(name, *factor))
            }
        };
        match counted {
            Some(counted) => Ok(Self { number, counted }),
            None => Err(TypedError::Unit(names.iter().map(|(name, _)| *name).collect())),
        }
    }

    /// The number that was typed, whatever it is counted in.
    #[must_use]
    pub fn number(self) -> f64 {
        self.number
    }

    /// Whether it does not say what it is counted in.
    #[must_use]
    pub fn is_alone(self) -> bool {
        self.counted == Counted::Plain
    }

    /// The same number, counted in what `other` is.
    #[must_use]
    pub fn counted_as(self, other: Self) -> Self {
        Self { number: self.number, ..other }
    }

    /// The dimensionless value; `alone` is that of a number that does not say what it is counted in.
    ///
    /// # Errors
    /// An SI unit where there are no scales.
    pub fn value(self, units: &Units, dimension: Dimension, alone: impl FnOnce(f64) -> f64) -> Result<f64, TypedError> {
        match self.counted {
            Counted::Plain => Ok(alone(self.number)),
            Counted::Dimensionless(_) => Ok(self.number),
            Counted::Si(..) if units.scales().is_none() => Err(TypedError::NoScales),
            Counted::Si(_, factor) => Ok(units.typed(dimension, self.number * factor)),
        }
    }
}

/// The number at the beginning of what was typed for a quantity, and what follows it: a unit, if it is one of the quantity's, or nothing.
#[must_use]
pub fn parts(typed: &str) -> Option<(f64, &str)> {
    let typed = typed.trim();
    if let Ok(number) = typed.parse::<f64>() {
        return Some((number, ""));
    }
    // The longest beginning that is a number: an `e` may be of its exponent, or of `e_t`.
    let mut ends = typed.char_indices().rev().map(|(at, _)| at).filter(|&at| at > 0);
    let (number, unit) = ends.find_map(|end| Some((typed[..end].trim_end().parse().ok()?, typed[end..].trim())))?;
    plain(unit).starts_with(char::is_alphanumeric).then_some((number, unit))
}

/// A unit as the table writes it: a blank for whatever people write between factors, and `u` for the two letters that mean micro.
fn plain(unit: &str) -> String {
    let letters = unit.chars().map(|c| if ['μ', 'µ'].contains(&c) { 'u' } else { c });
    let is_between = |c: char| c.is_whitespace() || ['.', '*', '·'].contains(&c);
    letters.collect::<String>().split(is_between).filter(|factor| !factor.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Whether what was typed, made [`plain`], is the unit of that name: `Ns/m` is `N s/m`, but `m m` is not `mm`.
fn is_called(typed: &str, name: &str) -> bool {
    let name = plain(name);
    typed == name || typed == name.replace(' ', "")
}

impl Dimension {
    /// The SI units that it may be typed in, and how many of the table's one of each is.
    #[must_use]
    pub const fn names(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Whole | Self::Number => &[],
            Self::Angle => &[("rad", 1.0), ("deg", TAU / 360.0)],
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)],
            Self::Length => &[("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9)],
            Self::Velocity => &[("m/s", 1.0), ("mm/s", 1e-3), ("um/s", 1e-6)],
            Self::Force => &[("N", 1.0), ("kN", 1e3), ("mN", 1e-3)],
            Self::ForceRate => &[("N/s", 1.0), ("kN/s", 1e3)],
            Self::Stiffness => &[("N/m", 1.0), ("kN/m", 1e3), ("MN/m", 1e6), ("N/mm", 1e3), ("N/um", 1e6)],
            Self::Damping => &[("N s/m", 1.0), ("kN s/m", 1e3), ("N s/mm", 1e3)],
            Self::Speed => &[("rpm", 1.0), ("Hz", 60.0), ("rad/s", 60.0 / TAU)],
            Self::SpeedRate => &[("rpm/s", 1.0), ("Hz/s", 60.0), ("rad/s^2", 60.0 / TAU)],
            Self::Frequency => &[("Hz", 1.0), ("kHz", 1e3), ("rpm", 1.0 / 60.0), ("rad/s", 1.0 / TAU)],
            Self::Rate => &[("1/s", 1.0), ("rad/s", 1.0)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scales;

    /// 10 of 40 kg, w0 = 300 rad/s, e_t = 20 um.
    fn units() -> Units {
        Units::of(Some(Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 }), 0.25)
    }

    fn read(dimension: Dimension, typed: &str) -> Result<f64, String> {
        let read = Typed::read(dimension, typed).and_then(|read| read.value(&units(), dimension, |alone| -alone));
        read.map_err(|error| error.to_string())
    }

    #[test]
    fn val_a_quantity_says_what_it_is_counted_in() {
        use Dimension::{Damping, Length, Speed, Stiffness, Time};
        for (dimension, typed, value) in [
            // 300 rad/s are 2864.789 rpm and 47.7465 Hz.
            (Speed, "2864.788975654116rpm", 1.0),
            (Speed, " 47.7464829275686 Hz ", 1.0),
            (Speed, "600rad/s", 2.0),
            (Speed, "2.5w0", 2.5),
            (Length, "20um", 1.0),
            (Length, "2e-5m", 1.0),
            (Length, "0.04 mm", 2.0),
            (Length, "20 μm", 1.0),
            (Length, "3e_t", 3.0),
            (Length, "1e-3e_t", 1e-3),
            // 10 kg (300/s)^2, and 10 kg 300/s.
            (Stiffness, "-9e5N/m", -1.0),
            (Stiffness, "1.8 N/um", 2.0),
            (Stiffness, "0.5w0^2", 0.5),
            (Damping, "3000N.s/m", 1.0),
            (Damping, "6 kN s/m", 2.0),
            (Damping, "3 N*s/mm", 1.0),
            (Damping, "6kNs/m", 2.0),
            (Time, "10ms", 3.0),
            (Time, "4tau", 4.0),
            (Stiffness, "5", -5.0),
        ] {
            let found = read(dimension, typed).expect(typed);
            assert!((found / value - 1.0).abs() < 1e-12, "{typed}: {found} for {value}");
        }
    }

    #[test]
    fn what_is_no_unit_of_the_quantity_is_told() {
        for (dimension, typed, why) in [
            (Dimension::Speed, "fast", "expected a number"),
            (Dimension::Speed, "", "expected a number"),
            (Dimension::Speed, "rpm", "expected a number"),
            (Dimension::Speed, "3-", "expected a number"),
            (Dimension::Speed, "3000N", "expected a number, alone or in rpm, Hz, rad/s"),
            (Dimension::Force, "3e5n", "expected a number, alone or in N, kN, mN"),
            (Dimension::Length, "3 m m", "expected a number, alone or in m, mm, um, nm"),
            (Dimension::Number, "3 s", "expected a number without a unit"),
        ] {
            assert_eq!(read(dimension, typed), Err(why.to_owned()), "{typed}");
        }
        let typed = Typed::read(Dimension::Speed, "3000rpm").expect("a speed");
        let found = typed.value(&Units::DIMENSIONLESS, Dimension::Speed, |alone| alone);
        assert_eq!(found, Err(TypedError::NoScales));
    }

    #[test]
    fn every_unit_of_the_table_can_be_typed() {
        for dimension in crate::dimension::tests::ALL {
            let unit = units().unit(dimension);
            let names = dimension.names();
            assert!(unit.name.is_empty() && names.is_empty() || names.contains(&(unit.name, 1.0)), "{dimension:?}");
        }
    }
}
