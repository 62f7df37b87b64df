//! What is typed in the units on the screen, and by how much a key press changes it.

use rotor::{GainKind, Key, Rotor, Settings, SettingsError};
use text::number::{nice_ceiling, significant};
use units::{Dimension, Typed, TypedError};

use super::ScreenUnits;

/// The part of the largest gain of a signal that a step of one of them is at least, but for rounding down.
const OF_LARGEST: f64 = 0.01;

impl ScreenUnits {
    /// The dimensionless value that was typed for a quantity, forces on the first control bearing; `alone` is that of a number without a
    /// unit.
    ///
    /// # Errors
    /// An SI unit where there are no scales.
    pub fn quantity(
        &self,
        dimension: Dimension,
        typed: Typed,
        alone: impl FnOnce(f64) -> f64,
    ) -> Result<f64, TypedError> {
        typed.value(&self.table(), dimension, alone)
    }

    /// What one key press adds to a setting, as it is shown: a round number.
    pub fn step(&self, key: Key) -> f64 {
        self.step_of(key, key.parameter.step)
    }

    /// The same among these settings: of a gain no less than a part of the largest gain of its signal, as gains in front of a filter are
    /// large, and what is round for those of others moves nothing.
    pub fn step_among(&self, key: Key, settings: &Settings) -> f64 {
        let own = key.parameter.step;
        if key.parameter.gain.is_none() {
            return self.step(key);
        }
        let signal = settings.feedback.signals().nth(key.index.unwrap_or(0));
        let gains =
            signal.into_iter().flat_map(|signal| GainKind::ALL.map(|kind| signal.gain(kind).at(settings.speed)));
        let largest = gains.map(f64::abs).fold(0.0, f64::max);
        if OF_LARGEST * largest <= own {
            return self.step(key);
        }
        let decade = 10_f64.powf(largest.log10().floor());
        let round = [5.0, 2.0, 1.0].into_iter().map(|digit| digit * decade).find(|round| *round <= largest);
        self.step_of(key, own.max(significant(OF_LARGEST * round.unwrap_or(decade), 4)))
    }

    fn step_of(&self, key: Key, step: f64) -> f64 {
        match self.setting(key).factor {
            1.0 => step,
            // What the product of round numbers leaves behind their digits is not part of them.
            factor => significant(nice_ceiling(step * factor), 4),
        }
    }

    /// Changes of `settings` as they were typed, dimensionless: what is typed for all control bearings is that for each.
    ///
    /// # Errors
    /// A clearance where nothing of `rotor`, if that is known, has play; an SI unit where there are no scales.
    pub fn settings_of_typed(
        &self,
        rotor: Option<&Rotor>,
        settings: &Settings,
        typed: &[(Key, Typed)],
    ) -> Result<Vec<(Key, f64)>, SettingsError> {
        let mut values = Vec::with_capacity(typed.len());
        for &(key, typed) in typed {
            let each = rotor.map_or_else(|| Ok(settings.each_bearing(key)), |rotor| settings.each(rotor, key))?;
            for key in each {
                let value = self.value_of(key, typed, |number| number / self.setting(key).factor);
                let no_value = |expected| SettingsError::NoValue {
                    key: key.to_string(),
                    found: typed.to_string(),
                    expected,
                    or_off: key.parameter.off.is_some(),
                };
                values.push((key, value.map_err(no_value)?));
            }
        }
        Ok(values)
    }

    /// The dimensionless value that was typed for a setting; `alone` is that of a number without a unit.
    ///
    /// # Errors
    /// An SI unit where there are no scales.
    pub fn value_of(&self, key: Key, typed: Typed, alone: impl FnOnce(f64) -> f64) -> Result<f64, TypedError> {
        typed.value(&self.table_of(key), key.parameter.dimension, alone)
    }
}
