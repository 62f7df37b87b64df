//! What numbers are typed and shown in: dimensionless, or SI for a rotor that has scales.
//!
//! The one place where a command converts, by the table of [`units`]. Everything inside, and all JSON, is dimensionless.

use rotor::{ControlMasses, Key, Rotor, Scales, Settings, SettingsError};
use serde::Serialize;
use text::number::significant;
use units::{Dimension, Typed};

use crate::failure::Failure;
use crate::output::rounded;
use crate::quantity::{QuantityRange, TypedQuantity};
use crate::range::Range;

/// The units of one machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommandUnits(Option<Scales>);

/// What the JSON of an SI rotor says beside its dimensionless numbers; nothing for others. To be flattened.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct UnitsDocument {
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scales: Option<Scales>,
}

impl CommandUnits {
    /// The units of this rotor.
    #[must_use]
    pub(crate) fn of(rotor: &Rotor) -> Self {
        Self(rotor.scales().copied())
    }

    /// The units of a rotor with these scales, if it has any.
    #[must_use]
    pub(crate) fn with(scales: Option<Scales>) -> Self {
        Self(scales)
    }

    /// The table of units, with the mass ratio `Rm` of the mass that carries the control bearing, by which control is a force.
    fn table(self, mass_ratio: f64) -> units::Units {
        units::Units::of(self.0, mass_ratio)
    }

    /// The dimensionless value of what was typed for an option.
    ///
    /// # Errors
    /// An SI unit for a rotor without scales.
    pub(crate) fn read(self, option: &str, typed: TypedQuantity) -> Result<f64, Failure> {
        self.read_on(1.0, option, typed)
    }

    /// The same; forces are on a mass of ratio `Rm`.
    ///
    /// # Errors
    /// The same.
    pub(crate) fn read_on(self, mass_ratio: f64, option: &str, typed: TypedQuantity) -> Result<f64, Failure> {
        let (table, dimension) = (self.table(mass_ratio), typed.dimension);
        let value = typed.typed.value(&table, dimension, |alone| table.typed(dimension, alone));
        value.map_err(|expected| Failure::Usage(format!("{option} '{typed}': {expected}")))
    }

    /// The same of an option whose numbers alone are dimensionless for any rotor.
    ///
    /// # Errors
    /// The same.
    pub(crate) fn read_dimensionless(self, option: &str, typed: TypedQuantity) -> Result<f64, Failure> {
        let value = typed.typed.value(&self.table(1.0), typed.dimension, |alone| alone);
        value.map_err(|expected| Failure::Usage(format!("{option} '{typed}': {expected}")))
    }

    /// The dimensionless ends of a range that was typed for an option.
    ///
    /// # Errors
    /// An SI unit for a rotor without scales, or an upper end that is not above the lower.
    pub(crate) fn read_range(self, option: &str, typed: QuantityRange) -> Result<Range, Failure> {
        let dimension = typed.dimension;
        self.read_ends(1.0, option, typed, |alone| self.table(1.0).typed(dimension, alone))
    }

    /// The same of a key; `alone` is the value of a number that does not say its unit, and forces are on a mass of ratio `Rm`.
    ///
    /// # Errors
    /// The same.
    pub(crate) fn read_ends(
        self,
        mass_ratio: f64,
        name: &str,
        typed: QuantityRange,
        alone: impl Fn(f64) -> f64,
    ) -> Result<Range, Failure> {
        let ends = typed.typed.value(&self.table(mass_ratio), typed.dimension, alone);
        let ends = ends.map_err(|error| Failure::Usage(format!("{name} '{typed}': {error}")));
        ends.map(|[from, to]| Range { from, to })
    }

    /// The scales of a machine in SI units.
    #[must_use]
    pub(crate) fn scales(self) -> Option<Scales> {
        self.0
    }

    /// One thing for dimensionless machines, another for those in SI units.
    #[must_use]
    pub(crate) fn pick<T>(self, dimensionless: T, si: T) -> T {
        if self.0.is_some() { si } else { dimensionless }
    }

    /// The unit of displacements, clearances and the trip limit.
    #[must_use]
    pub(crate) fn length_unit(self) -> &'static str {
        self.table(1.0).unit(Dimension::Length).name
    }

    /// A key with the unit that its numbers are shown in, where a machine has units: `speed (rpm)`.
    #[must_use]
    pub(crate) fn with_unit(self, key: &str, dimension: Dimension) -> String {
        match self.table(1.0).unit(dimension).name {
            "" => key.to_owned(),
            unit if self.0.is_some() => format!("{key} ({unit})"),
            _ => key.to_owned(),
        }
    }

    /// The unit of forces.
    #[must_use]
    pub(crate) fn force_unit(self) -> &'static str {
        self.table(1.0).unit(Dimension::Force).name
    }

    /// Spin speed as shown of a speed `R`.
    #[must_use]
    pub(crate) fn speed(self, speed: f64) -> f64 {
        self.table(1.0).shown(Dimension::Speed, speed)
    }

    /// Length as shown of a length in `e_t`.
    #[must_use]
    pub(crate) fn length(self, length: f64) -> f64 {
        self.table(1.0).shown(Dimension::Length, length)
    }

    /// Velocity as shown of a velocity in `e_t` per unit of `tau`.
    #[must_use]
    pub(crate) fn velocity(self, velocity: f64) -> f64 {
        self.table(1.0).shown(Dimension::Velocity, velocity)
    }

    /// Control force as shown of a control acceleration `u` on a mass of ratio `Rm`.
    #[must_use]
    pub(crate) fn force(self, acceleration: f64, mass_ratio: f64) -> f64 {
        self.table(mass_ratio).shown(Dimension::Force, acceleration)
    }

    /// The unit of stiffnesses.
    #[must_use]
    pub(crate) fn stiffness_unit(self) -> &'static str {
        self.pick("K_t", "N/m")
    }

    /// Stiffness as shown of one in `K_t`.
    #[must_use]
    pub(crate) fn stiffness(self, stiffness: f64) -> f64 {
        self.0.map_or(stiffness, |scales| stiffness * scales.k_t)
    }

    /// A time as shown: in `tau`, or in seconds.
    #[must_use]
    pub(crate) fn time(self, tau: f64) -> f64 {
        self.table(1.0).shown(Dimension::Time, tau)
    }

    /// Part of a pole as shown: per unit of `tau`, or per second.
    #[must_use]
    pub(crate) fn rate(self, rate: f64) -> f64 {
        self.table(1.0).shown(Dimension::Rate, rate)
    }

    /// A frequency as shown: in radians per unit of `tau`, or in Hz.
    #[must_use]
    pub(crate) fn frequency(self, frequency: f64) -> f64 {
        self.table(1.0).shown(Dimension::Frequency, frequency)
    }

    /// `R = 2.5`, or `7161.97 rpm (R = 2.5)`.
    #[must_use]
    pub(crate) fn speed_text(self, speed: f64) -> String {
        match self.0 {
            None => format!("R = {speed}"),
            Some(scales) => format!("{} rpm (R = {})", rounded(scales.rpm(speed)), rounded(speed)),
        }
    }

    /// `R = 2.51234`, or `7161.97 rpm`, of a speed that was found.
    #[must_use]
    pub(crate) fn speed_text_rounded(self, speed: f64) -> String {
        self.0.map_or_else(|| format!("R = {}", rounded(speed)), |scales| format!("{} rpm", rounded(scales.rpm(speed))))
    }

    /// `2.5`, or `7161.97 rpm`: where a heading says what it is.
    #[must_use]
    pub(crate) fn speed_cell(self, speed: f64) -> String {
        self.0.map_or_else(|| speed.to_string(), |scales| format!("{} rpm", rounded(scales.rpm(speed))))
    }

    /// `R in 0..6`, or `0..14324 rpm` of a range of speeds as typed.
    #[must_use]
    pub(crate) fn range_text(self, QuantityRange { typed, .. }: QuantityRange) -> String {
        match self.0 {
            None => format!("R in {}..{}", typed.from.number(), typed.to.number()),
            Some(_) if typed.to.is_alone() => format!("{typed} rpm"),
            Some(_) => typed.to_string(),
        }
    }

    /// `tau = 40`, or `0.133333 s (tau = 40)`.
    #[must_use]
    pub(crate) fn time_text(self, tau: f64) -> String {
        let dimensionless = format!("tau = {}", rounded(tau));
        self.0.map_or(dimensionless.clone(), |scales| format!("{} s ({dimensionless})", rounded(scales.seconds(tau))))
    }

    /// What JSON says of the units.
    #[must_use]
    pub(crate) fn document(self) -> UnitsDocument {
        UnitsDocument { units: self.0.map(|_| "si"), scales: self.0 }
    }

    /// A quantity as shown; forces on a mass of ratio `Rm`.
    #[must_use]
    pub(crate) fn quantity(self, dimension: Dimension, mass_ratio: f64, value: f64) -> f64 {
        self.table(mass_ratio).shown(dimension, value)
    }

    /// A setting as shown, on control bearings of these masses.
    #[must_use]
    pub(crate) fn value(self, masses: ControlMasses, key: Key, value: f64) -> f64 {
        self.table(masses.of_key(key)).shown(key.parameter.dimension, value)
    }

    /// What a setting is shown in, behind a blank; nothing for a pure number, or where a machine has no units.
    #[must_use]
    pub(crate) fn name_of(self, masses: ControlMasses, key: Key) -> String {
        match self.table(masses.of_key(key)).unit(key.parameter.dimension).name {
            unit if self.0.is_some() && !unit.is_empty() => format!(" {unit}"),
            _ => String::new(),
        }
    }

    /// Sets `key` to what was typed: numbers alone are rpm and m for an SI rotor, forces and gains by the mass that carries their
    /// control bearing.
    ///
    /// # Errors
    /// Out of range, told in the units it was typed in; a mass or signal that does not exist; a clearance where nothing has play. Nothing
    /// is set then.
    pub(crate) fn set(self, rotor: &Rotor, settings: &mut Settings, key: Key, typed: Typed) -> Result<(), Failure> {
        self.set_each(rotor, settings, key, |units, key| {
            let dimension = key.parameter.dimension;
            let value = typed.value(units, dimension, |alone| units.typed(dimension, alone));
            value.map_err(|expected| SettingsError::NoValue {
                key: key.to_string(),
                found: typed.to_string(),
                expected,
                or_off: key.parameter.off.is_some(),
            })
        })
    }

    /// The same of a key and a value as typed, which may say its unit.
    ///
    /// # Errors
    /// The same, or what is no value of the setting.
    pub(crate) fn assign(
        self,
        rotor: &Rotor,
        settings: &mut Settings,
        key: Key,
        (name, typed): (&str, &str),
    ) -> Result<(), Failure> {
        self.set_each(rotor, settings, key, |units, key| {
            key.value_of(name, typed, units, |alone| units.typed(key.parameter.dimension, alone))
        })
    }

    fn set_each(
        self,
        rotor: &Rotor,
        settings: &mut Settings,
        key: Key,
        value: impl Fn(&units::Units, Key) -> Result<f64, SettingsError>,
    ) -> Result<(), Failure> {
        let masses = ControlMasses::of(rotor, &settings.feedback);
        let mut changed = settings.clone();
        for key in settings.each(rotor, key)? {
            let (units, dimension) = (self.table(masses.of_key(key)), key.parameter.dimension);
            changed.set(key, value(&units, key)?).map_err(|error| match error {
                SettingsError::OutOfRange { found, min, max, or_off, .. }
                    if self.0.is_some() && dimension != Dimension::Number =>
                {
                    let (unit, key) = (units.unit(dimension), settings.label(key));
                    let typed = significant(units.shown(dimension, found), 12);
                    let [min, max] = [min, max].map(|end| rounded(units.shown(dimension, end)));
                    let or_off = if or_off { ", or off" } else { "" };
                    Failure::Usage(format!(
                        "{key} = {typed} {unit}: expected a number from {min} to {max} {unit}{or_off}"
                    ))
                }
                error => error.into(),
            })?;
        }
        *settings = changed;
        Ok(())
    }
}
