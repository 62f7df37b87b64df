//! The table of units: what a quantity measures, and what it is counted in.

use std::f64::consts::TAU;
use std::fmt;

use text::number::short;

use crate::Scales;

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// A whole number, or bits.
    Whole,
    /// A pure number.
    Number,
    /// An angle.
    Angle,
    /// A time `tau = w0 t`.
    Time,
    /// A displacement or a clearance.
    Length,
    /// Velocity of a mass.
    Velocity,
    /// Control: the force on the control bearing, divided by the mass that carries it.
    Force,
    /// Its rate of change.
    ForceRate,
    /// Control for a displacement: a gain `kd` or `kc`.
    Stiffness,
    /// Control for a velocity: a gain `cd` or `cc`.
    Damping,
    /// A spin speed `R = w / w0`.
    Speed,
    /// Its rate of change.
    SpeedRate,
    /// A frequency of whirl.
    Frequency,
    /// A part of a pole: a rate of growth, or an angular frequency.
    Rate,
}

/// What something is counted in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// How many of it one dimensionless unit is; greater than 0.
    pub factor: f64,
    /// Its name; empty for a pure number.
    pub name: &'static str,
}

impl Unit {
    /// A dimensionless value in this unit, in about `digits` characters.
    #[must_use]
    pub fn short(&self, value: f64, digits: usize) -> String {
        short(value * self.factor, digits)
    }

    /// The same with the unit: `10.00 N`.
    #[must_use]
    pub fn told(&self, value: f64, digits: usize) -> String {
        format!("{} {}", self.short(value, digits), self.name).trim_end().to_owned()
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}

impl Dimension {
    /// The name of the dimensionless unit; empty for a pure number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Whole | Self::Number => "",
            Self::Angle => "rad",
            Self::Time => "1/w0",
            Self::Length => "e_t",
            Self::Velocity => "w0 e_t",
            Self::Force => "w0^2 e_t",
            Self::ForceRate => "w0^3 e_t",
            Self::Speed | Self::Frequency | Self::Rate | Self::Damping => "w0",
            Self::SpeedRate | Self::Stiffness => "w0^2",
        }
    }

    /// What one dimensionless unit is in SI units; `mass_ratio` is `Rm` of the mass that carries the control bearing.
    #[must_use]
    pub fn si(self, scales: &Scales, mass_ratio: f64) -> Unit {
        let (factor, name) = match self {
            Self::Whole | Self::Number => (1.0, ""),
            Self::Angle => (1.0, "rad"),
            Self::Time => (scales.seconds(1.0), "s"),
            Self::Length => (scales.metres(1.0), "m"),
            Self::Velocity => (scales.metres(1.0) * scales.w0, "m/s"),
            Self::Force => (scales.newtons(1.0, mass_ratio), "N"),
            Self::ForceRate => (scales.newtons(1.0, mass_ratio) * scales.w0, "N/s"),
            Self::Stiffness => (mass_ratio * scales.k_t, "N/m"),
            Self::Damping => (mass_ratio * scales.k_t / scales.w0, "N s/m"),
            Self::Speed => (scales.rpm(1.0), "rpm"),
            Self::SpeedRate => (scales.rpm(1.0) * scales.w0, "rpm/s"),
            Self::Frequency => (scales.w0 / TAU, "Hz"),
            Self::Rate => (scales.w0, "1/s"),
        };
        Unit { factor, name }
    }
}

/// What the quantities of one machine are typed and shown in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    scales: Option<Scales>,
    mass_ratio: f64,
}

impl Units {
    /// Those of a rotor without scales.
    pub const DIMENSIONLESS: Self = Self { scales: None, mass_ratio: 1.0 };

    /// Those of a rotor with these scales, if it has any; `mass_ratio` is `Rm` of the mass that carries the control bearing, by
    /// which control is a force.
    #[must_use]
    pub fn of(scales: Option<Scales>, mass_ratio: f64) -> Self {
        Self { scales, mass_ratio }
    }

    /// The scales of a machine in SI units.
    #[must_use]
    pub fn scales(&self) -> Option<Scales> {
        self.scales
    }

    /// What a quantity is counted in.
    #[must_use]
    pub fn unit(&self, dimension: Dimension) -> Unit {
        let own = Unit { factor: 1.0, name: dimension.unit() };
        self.scales.map_or(own, |scales| dimension.si(&scales, self.mass_ratio))
    }

    /// A dimensionless value as it is shown.
    #[must_use]
    pub fn shown(&self, dimension: Dimension, value: f64) -> f64 {
        let Some(scales) = self.scales else { return value };
        // What Scales has a function for is rounded as little as can be.
        match dimension {
            Dimension::Time => scales.seconds(value),
            Dimension::Length => scales.metres(value),
            Dimension::Velocity => scales.metres(value) * scales.w0,
            Dimension::Force => scales.newtons(value, self.mass_ratio),
            Dimension::Speed => scales.rpm(value),
            Dimension::Frequency => value * scales.w0 / TAU,
            _ => value * dimension.si(&scales, self.mass_ratio).factor,
        }
    }

    /// The dimensionless value of what was typed.
    #[must_use]
    pub fn typed(&self, dimension: Dimension, typed: f64) -> f64 {
        let Some(scales) = self.scales else { return typed };
        match dimension {
            Dimension::Time => scales.tau(typed),
            Dimension::Length => scales.length(typed),
            Dimension::Velocity => scales.length(typed) / scales.w0,
            Dimension::Force => scales.acceleration(typed, self.mass_ratio),
            Dimension::ForceRate => scales.acceleration(typed, self.mass_ratio) / scales.w0,
            Dimension::Speed => scales.speed(typed),
            Dimension::SpeedRate => scales.speed(typed) / scales.w0,
            _ => typed / dimension.si(&scales, self.mass_ratio).factor,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use proptest::prelude::*;

    use super::*;

    pub(crate) const ALL: [Dimension; 14] = [
        Dimension::Whole,
        Dimension::Number,
        Dimension::Angle,
        Dimension::Time,
        Dimension::Length,
        Dimension::Velocity,
        Dimension::Force,
        Dimension::ForceRate,
        Dimension::Stiffness,
        Dimension::Damping,
        Dimension::Speed,
        Dimension::SpeedRate,
        Dimension::Frequency,
        Dimension::Rate,
    ];

    /// 40 kg, w0 = 300 rad/s, e_t = 20 um.
    const SCALES: Scales = Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };

    #[test]
    fn val_a_rotor_of_forty_kilograms_is_told_in_si_units() {
        let units = Units::of(Some(SCALES), 0.25);
        for (dimension, shown, name) in [
            (Dimension::Time, 1.0 / 300.0, "s"),
            (Dimension::Length, 20e-6, "m"),
            // 300 * 20e-6.
            (Dimension::Velocity, 6e-3, "m/s"),
            // An acceleration of w0^2 e_t = 1.8 m/s^2 on 10 kg.
            (Dimension::Force, 18.0, "N"),
            (Dimension::ForceRate, 5400.0, "N/s"),
            // 10 kg (300/s)^2, and 10 kg 300/s.
            (Dimension::Stiffness, 9e5, "N/m"),
            (Dimension::Damping, 3000.0, "N s/m"),
            // 300 rad/s are 300 / (2 pi) turns a second.
            (Dimension::Speed, 2_864.788_975_654_116, "rpm"),
            (Dimension::SpeedRate, 859_436.692_696_234_8, "rpm/s"),
            (Dimension::Frequency, 47.746_482_927_568_6, "Hz"),
            (Dimension::Rate, 300.0, "1/s"),
        ] {
            let unit = units.unit(dimension);
            assert_eq!(unit.name, name);
            for found in [unit.factor, units.shown(dimension, 1.0)] {
                assert!((found / shown - 1.0).abs() < 1e-14, "{dimension:?}: {found} and {shown}");
            }
        }
    }

    #[test]
    fn a_rotor_without_scales_is_told_as_it_is() {
        for dimension in ALL {
            let units = Units::DIMENSIONLESS;
            assert_eq!(units.unit(dimension), Unit { factor: 1.0, name: dimension.unit() });
            assert_eq!((units.shown(dimension, 0.3), units.typed(dimension, 0.3)), (0.3, 0.3));
        }
    }

    proptest! {
        /// What is shown and typed again is the same but for rounding, in every dimension and for any scales.
        #[test]
        fn what_is_shown_can_be_typed_again(
            scales in [1e-3..1e6, 1e-3..1e9, 1e-6..1e6, 1e-9..1.0].prop_map(|[w0, k_t, m_t, e_t]| Scales { w0, k_t, m_t, e_t }),
            mass_ratio in 1e-3..1.0,
            value in -1e6..1e6,
        ) {
            let units = Units::of(Some(scales), mass_ratio);
            for dimension in ALL {
                let shown = units.shown(dimension, value);
                prop_assert!((units.typed(dimension, shown) - value).abs() <= 8.0 * f64::EPSILON * value.abs(), "{dimension:?}");
                let counted = value * units.unit(dimension).factor;
                prop_assert!((shown - counted).abs() <= 8.0 * f64::EPSILON * shown.abs(), "{dimension:?}");
            }
        }
    }
}
