//! What stands between displacement and force beside the law: the numbers of each part, and which are allowed.
//!
//! Not the parts at work: those are in [`crate::Controller`].

use units::Dimension;

/// One number of a loop: a row of [`PARTS`].
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its key, in files and among the settings.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// What it measures, and so its unit.
    pub dimension: Dimension,
    /// The least allowed value where the part is there.
    pub min: f64,
    /// The greatest allowed value where the part is there.
    pub max: f64,
    /// What one key press adds.
    pub step: f64,
    /// What an absent part counts as; typed as `off`.
    pub absent: f64,
    /// Where it stands in [`Parts`].
    pub get: fn(&Parts) -> f64,
    /// Puts it there.
    pub set: fn(&mut Parts, f64),
}

/// The loop around the law. The default is the ideal loop: exact, immediate, unlimited.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Parts {
    /// Time constant of the sensors, a first-order lag; 0 is none.
    pub sensor_lag: f64,
    /// Standard deviation of each component of a sensor's noise, per sample; without sampling, per step.
    pub noise: f64,
    /// Resolution of the sensors: readings are whole multiples of it; 0 is none.
    pub quantum: f64,
    /// Which noise: the same seed gives the same run, bit for bit.
    pub seed: f64,
    /// Sampling and hold period; 0 is a continuous loop.
    pub sample: f64,
    /// Delay of measurement and computation.
    pub delay: f64,
    /// Time constant of the actuator; 0 is none.
    pub lag: f64,
    /// Damping ratio of an actuator of second order, `lag^2 v'' + 2 lag_damping lag v' + v = u`; 0 is one of first order.
    pub lag_damping: f64,
    /// Largest magnitude of the force; infinite without a limit.
    #[serde(with = "unlimited")]
    pub limit: f64,
    /// Largest magnitude of the force's rate of change; infinite without a limit.
    #[serde(with = "unlimited")]
    pub slew: f64,
    /// Samples that a controller outside may leave without a command before the law here takes over; 0 is no controller outside.
    #[serde(skip_serializing_if = "is_absent")]
    pub external: f64,
    /// Samples without a command after which the machine trips; 0 is never.
    #[serde(skip_serializing_if = "is_absent")]
    pub external_trip: f64,
    /// What the sensors read of what is there, `r = sensor_gain (p + noise)`; 0 is a sensor that is lost.
    #[serde(skip_serializing_if = "is_whole")]
    pub sensor_gain: f64,
    /// The place whose sensor that is, counted from 1 as in `deadband.N`; 0 is every sensor of the bearing.
    #[serde(skip_serializing_if = "is_absent")]
    pub sensor_at: f64,
    /// Gain of the amplifier along y, behind the actuator's lag and before its limits; 0 is an axis that is lost.
    #[serde(skip_serializing_if = "is_whole")]
    pub amplifier_y: f64,
    /// The same along z.
    #[serde(skip_serializing_if = "is_whole")]
    pub amplifier_z: f64,
}

/// What is not there is not told, so that whoever knows nothing of it can read the rest.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_absent(samples: &f64) -> bool {
    *samples == 0.0
}

/// Nor is what is as it was designed.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_whole(gain: &f64) -> bool {
    *gain == 1.0
}

/// JSON has no infinity: no limit is `null` there.
mod unlimited {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
    pub(super) fn serialize<S: Serializer>(limit: &f64, to: S) -> Result<S::Ok, S::Error> {
        limit.is_finite().then_some(*limit).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

impl Default for Parts {
    fn default() -> Self {
        Self {
            sensor_lag: 0.0,
            noise: 0.0,
            quantum: 0.0,
            seed: 1.0,
            sample: 0.0,
            delay: 0.0,
            lag: 0.0,
            lag_damping: 0.0,
            limit: f64::INFINITY,
            slew: f64::INFINITY,
            external: 0.0,
            external_trip: 0.0,
            sensor_gain: 1.0,
            sensor_at: 0.0,
            amplifier_y: 1.0,
            amplifier_z: 1.0,
        }
    }
}

macro_rules! part {
    ($field:ident, $meaning:literal, $dimension:ident, $min:expr, $max:expr, $step:expr, $absent:expr) => {
        Part {
            name: stringify!($field),
            meaning: $meaning,
            dimension: Dimension::$dimension,
            min: $min,
            max: $max,
            step: $step,
            absent: $absent,
            get: |parts| parts.$field,
            set: |parts, value| parts.$field = value,
        }
    };
}

/// Every number of the loop, in the order in which a signal passes them; what is a fault stands last.
pub const PARTS: [Part; 16] = [
    part!(sensor_lag, "time constant of the sensors", Time, 1e-6, 1e6, 0.01, 0.0),
    part!(noise, "sensor noise, standard deviation per sample", Length, 1e-12, 1e6, 0.001, 0.0),
    part!(quantum, "resolution of the sensors", Length, 1e-12, 1e6, 0.001, 0.0),
    part!(seed, "which noise", Number, 0.0, 9_007_199_254_740_991.0, 1.0, 1.0),
    part!(sample, "sampling and hold period", Time, 1e-6, 1e6, 0.01, 0.0),
    part!(delay, "delay of measurement and computation", Time, 1e-9, 1e6, 0.01, 0.0),
    part!(lag, "time constant of the actuator", Time, 1e-6, 1e6, 0.01, 0.0),
    part!(lag_damping, "damping ratio of an actuator of second order", Number, 0.01, 100.0, 0.05, 0.0),
    part!(limit, "largest force |u|", Force, 1e-9, 1e12, 1.0, f64::INFINITY),
    part!(slew, "largest rate of force |du/dtau|", ForceRate, 1e-9, 1e12, 10.0, f64::INFINITY),
    part!(external, "samples that a controller outside may miss", Number, 1.0, 1e6, 1.0, 0.0),
    part!(external_trip, "samples missed by it that trip the machine", Number, 1.0, 1e6, 1.0, 0.0),
    part!(sensor_gain, "gain of the sensors, 1 as designed, 0 lost", Number, 0.0, 100.0, 0.1, 1.0),
    part!(sensor_at, "place of the one sensor with that gain, as in deadband.N", Number, 1.0, 16.0, 1.0, 0.0),
    part!(amplifier_y, "gain of the amplifier along y, 1 as designed, 0 lost", Number, 0.0, 100.0, 0.1, 1.0),
    part!(amplifier_z, "gain of the amplifier along z", Number, 0.0, 100.0, 0.1, 1.0),
];

/// Those that are faults while they are there, and no part of a loop as it was designed.
pub const FAULTS: [&str; 4] = ["sensor_gain", "sensor_at", "amplifier_y", "amplifier_z"];

/// Numbers that do nothing by themselves.
const ALONE: [&str; 4] = ["seed", "lag_damping", "external_trip", "sensor_at"];

impl Part {
    /// Whether a value is allowed: within its range, or absent.
    #[must_use]
    pub fn admits(&self, value: f64) -> bool {
        value == self.absent || (self.min..=self.max).contains(&value)
    }

    /// What is allowed, in words that follow "expected".
    #[must_use]
    pub fn words(&self) -> String {
        let Self { min, max, .. } = self;
        let absent = if self.absent.is_finite() { format!("{} or ", self.absent) } else { String::new() };
        format!("{absent}a number from {min} to {max}, or off")
    }
}

/// A number of the loop that is not allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {found}: expected {expected}")]
pub struct PartError {
    /// Its key.
    pub name: &'static str,
    /// The value.
    pub found: f64,
    /// What is allowed.
    pub expected: String,
}

impl Parts {
    /// Whether force follows displacement at once and exactly.
    #[must_use]
    pub fn is_ideal(&self) -> bool {
        PARTS.iter().filter(|part| !ALONE.contains(&part.name)).all(|p| (p.get)(self) == p.absent)
    }

    /// The gain of the sensor at a station, counted from 0.
    #[must_use]
    pub fn gain_of_sensor(&self, station: usize) -> f64 {
        let is_meant = self.sensor_at == 0.0 || self.sensor_at == (station + 1) as f64;
        if is_meant { self.sensor_gain } else { 1.0 }
    }

    /// The same without [`FAULTS`].
    #[must_use]
    pub fn sound(self) -> Self {
        let Self { sensor_gain, sensor_at, amplifier_y, amplifier_z, .. } = Self::default();
        Self { sensor_gain, sensor_at, amplifier_y, amplifier_z, ..self }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first that is not allowed, by name.
    pub fn check(&self) -> Result<(), PartError> {
        for part in &PARTS {
            let found = (part.get)(self);
            if !part.admits(found) {
                return Err(PartError { name: part.name, found, expected: part.words() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_ideal_and_allowed() {
        let parts = Parts::default();
        parts.check().expect("allowed");
        assert!(parts.is_ideal());
        for part in PARTS.iter().filter(|p| !ALONE.contains(&p.name)) {
            let mut changed = parts;
            (part.set)(&mut changed, part.step);
            assert!(!changed.is_ideal(), "{}", part.name);
            assert_eq!((part.get)(&changed), part.step);
            changed.check().expect("a step is allowed");
        }
    }

    #[test]
    fn what_is_not_allowed_is_named() {
        for (name, value) in [
            ("delay", -0.01),
            ("delay", f64::NAN),
            ("delay", f64::INFINITY),
            ("limit", 0.0),
            ("slew", 0.0),
            ("sample", -1.0),
            ("noise", f64::NEG_INFINITY),
        ] {
            let part = PARTS.iter().find(|part| part.name == name).expect("there is");
            let mut parts = Parts::default();
            (part.set)(&mut parts, value);
            let told = parts.check().unwrap_err().to_string();
            assert!(told.starts_with(&format!("{name} = {value}: expected ")), "{told}");
        }
    }
}
