//! Numbers as people read them, in the units on the screen.

use rotor::{ChangedValue, Difference, Key, Settings, SettingsError};
use text::number::{short, significant};

use super::ScreenUnits;

/// Significant digits of a value in a message.
const DIGITS: usize = 7;

impl ScreenUnits {
    /// A time as people read it: `30.0 tau`, of a rotor in SI units `30.0 tau = 100 ms`.
    pub fn time_told(&self, tau: f64, digits: usize) -> String {
        format!("{} tau{}", short(tau, digits), self.seconds_told(tau, digits))
    }

    /// The moment of a step as people read it: `tau 30.0`, or `tau 30.0 = 100 ms`.
    pub fn moment_told(&self, tau: f64, digits: usize) -> String {
        format!("tau {}{}", short(tau, digits), self.seconds_told(tau, digits))
    }

    fn seconds_told(&self, tau: f64, digits: usize) -> String {
        let told = |seconds: f64| {
            let (per_second, unit) = match seconds.abs() {
                // Of nothing too.
                0.0 | 1.0.. => (1.0, "s"),
                1e-3.. => (1e3, "ms"),
                _ => (1e6, "μs"),
            };
            format!(" = {} {unit}", short(seconds * per_second, digits))
        };
        self.scales.map_or_else(String::new, |scales| told(scales.seconds(tau)))
    }

    /// A value of a setting as people read it: with its unit where that is none of the machine's own.
    pub fn value(&self, key: Key, value: f64) -> String {
        self.value_in(key, value, DIGITS)
    }

    fn value_in(&self, key: Key, value: f64, digits: usize) -> String {
        if key.parameter.off == Some(value) && value != 0.0 {
            return "off".to_owned();
        }
        let unit = self.setting(key);
        let told = significant(value * unit.factor, digits).to_string();
        if unit.factor == 1.0 { told } else { format!("{told} {}", unit.name) }
    }

    /// A number without a unit as people read it.
    pub fn value_digits(&self, value: f64) -> f64 {
        significant(value, DIGITS)
    }

    /// What is wrong with a change, in the units that it was typed in.
    pub fn fault(&self, error: &SettingsError) -> String {
        if let SettingsError::OutOfRange { key, found, min, max, or_off } = error
            && let Ok(of) = key.parse::<Key>()
            && self.setting(of).factor != 1.0
        {
            let [found, min, max] = [found, min, max].map(|value| self.value(of, *value));
            let off = if *or_off { ", or off" } else { "" };
            return format!("{key} = {found}: expected a number from {min} to {max}{off}");
        }
        error.to_string()
    }

    /// What has changed, as people read it.
    pub fn difference(&self, before: &Settings, after: &Settings) -> String {
        let Difference { values, law } = Difference::between(before, after);
        // As few digits as tell the two apart, but for a few that read well.
        let one = |ChangedValue { key, label, was, is }: &ChangedValue| {
            let told = |digits| [*was, *is].map(|value| self.value_in(*key, value, digits));
            let [was, is] = (DIGITS..17).map(told).find(|[was, is]| was != is).unwrap_or_else(|| told(17));
            format!("{label} {was} -> {is}")
        };
        let told = values.iter().map(one).chain(law.then(|| "another feedback".to_owned()));
        told.collect::<Vec<_>>().join(", ")
    }

    /// A spin speed as people read it.
    pub fn speed(&self, speed: f64) -> String {
        match self.scales {
            Some(scales) => format!("{:.0}", scales.rpm(speed)),
            None => format!("{}", (speed * 1000.0).round() / 1000.0),
        }
    }

    /// The same with its name: `R 2.5`, or `955 rpm`.
    pub fn speed_told(&self, speed: f64) -> String {
        match self.scales {
            Some(_) => format!("{} rpm", self.speed(speed)),
            None => format!("R {}", self.speed(speed)),
        }
    }
}
