//! All that can be changed on a running machine: see [`crate::PARAMETERS`] for the table of its keys.
//!
//! Settings travel whole and are checked whole: a half-applied change cannot exist.

mod keys;

use std::borrow::Cow;

use units::Units;

use crate::{ClosedLoop, Feedback, Gain, Key, Parameter, Rotor, SettingsError};

/// The settings of a running machine, whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Spin speed `R`.
    pub speed: f64,
    /// Clearance of every mass's support bearing, in `e_t`.
    pub deadband: Vec<f64>,
    /// Orbit radius at which the machine trips, in `e_t`.
    pub trip: f64,
    /// Greatest rate of change of the speed, per unit of `tau`; infinite where it jumps.
    pub ramp: f64,
    /// Rate at which the speed falls at first, per unit of `tau`, once an orbit has tripped the machine: from there on in proportion to what
    /// is left, as [`crate::profile::Leg::Decay`]. 0 where the machine is held as it was.
    pub coast_down: f64,
    /// The control law.
    pub feedback: Feedback,
    /// Unbalance added at every place: `U / (m_t e_t)`, so the eccentricity that it would give to the mass of the whole rotor; in the plane
    /// of the rotor's own.
    pub unbalance_added: Vec<f64>,
}

impl Settings {
    /// The default trip limit, in `e_t`.
    pub const DEFAULT_TRIP: f64 = 1000.0;

    /// Settings for `rotor` at `speed` under `feedback`: its own deadbands, the default trip limit.
    #[must_use]
    pub fn new(rotor: &Rotor, speed: f64, feedback: Feedback) -> Self {
        let (deadband, unbalance_added) = (rotor.deadbands(), vec![0.0; rotor.len()]);
        let (trip, ramp, coast_down) = (Self::DEFAULT_TRIP, f64::INFINITY, 0.0);
        Self { speed, deadband, trip, ramp, coast_down, feedback, unbalance_added }
    }

    /// The rotor as it turns under these settings: with the unbalance that is added to its own.
    #[must_use]
    pub fn unbalanced<'a>(&self, rotor: &'a Rotor) -> Cow<'a, Rotor> {
        match self.unbalance_added.iter().all(|added| *added == 0.0) {
            true => Cow::Borrowed(rotor),
            false => Cow::Owned(rotor.with_unbalance(&self.unbalance_added)),
        }
    }

    /// Checks everything against the rotor it is for.
    ///
    /// # Errors
    /// The first value that does not fit, by key.
    pub fn check(&self, rotor: &Rotor) -> Result<(), SettingsError> {
        if self.deadband.len() != rotor.len() {
            return Err(SettingsError::Deadbands { found: self.deadband.len(), masses: rotor.len() });
        }
        if self.unbalance_added.len() != rotor.len() {
            return Err(SettingsError::Unbalances { found: self.unbalance_added.len(), masses: rotor.len() });
        }
        self.feedback.check(rotor.len())?;
        for key in self.keys() {
            let values: Vec<f64> = match self.gain(key) {
                Some(Gain::Table(points)) => points.iter().map(|&(_, value)| value).collect(),
                _ => vec![self.get(key)?],
            };
            for value in values {
                in_range(key, value)?;
            }
        }
        Ok(())
    }

    /// The value of `key`, a scheduled gain at the present speed. For all masses at once, the largest.
    ///
    /// # Errors
    /// A mass or signal that does not exist.
    pub fn get(&self, key: Key) -> Result<f64, SettingsError> {
        let Parameter { get, .. } = *key.parameter;
        Ok(self.places(key)?.map(|place| get(self, place)).reduce(f64::max).unwrap_or_default())
    }

    /// Sets `key`: a scheduled gain becomes constant.
    ///
    /// # Errors
    /// A value that is not finite or out of range, or a mass or signal that does not exist; nothing changes then.
    pub fn set(&mut self, key: Key, value: f64) -> Result<(), SettingsError> {
        in_range(key, value)?;
        let Parameter { set, .. } = *key.parameter;
        self.places(key)?.for_each(|place| set(self, place, value));
        Ok(())
    }

    /// Raises `key` by `delta`, held within its range; a scheduled gain is raised at every speed, and what is off stays off.
    ///
    /// # Errors
    /// A mass or signal that does not exist.
    pub fn nudge(&mut self, key: Key, delta: f64) -> Result<(), SettingsError> {
        let Parameter { min, max, off, gain, get, set, .. } = *key.parameter;
        let raised = |value: f64| {
            // From off the first step leads into the range; back below the range it is off again, where off is 0.
            match off {
                Some(off) if off.is_infinite() && value == off => value,
                Some(0.0) if tidy(value + delta, delta) < min => 0.0,
                _ => tidy(value + delta, delta).clamp(min, max),
            }
        };
        for place in self.places(key)? {
            match gain.and_then(|kind| Some(self.feedback.signal_mut(place)?.gain_mut(kind))) {
                Some(gain) if !matches!(gain, Gain::Constant(_)) => *gain = gain.shifted(delta),
                _ => set(self, place, raised(get(self, place))),
            }
        }
        Ok(())
    }

    /// Sets `key` to what was typed for it.
    ///
    /// # Errors
    /// An unknown key, a value that is not a number, or what [`Settings::set`] refuses; nothing changes then.
    pub fn assign(&mut self, key: &str, value: &str) -> Result<(), SettingsError> {
        let parsed = self.key(key)?;
        let value = parsed.value_of(key, value, &Units::DIMENSIONLESS, |alone| alone)?;
        self.set(parsed, value)
    }

    /// The equations of motion under these settings, which must have passed [`Settings::check`].
    #[must_use]
    pub fn closed_loop(&self, rotor: &Rotor) -> ClosedLoop {
        ClosedLoop::new(rotor, &self.feedback, self.speed, &self.deadband)
    }

    /// The schedule behind a gain, if `key` is one.
    #[must_use]
    pub fn gain(&self, key: Key) -> Option<&Gain> {
        let signal = self.feedback.signal(key.index.unwrap_or(0))?;
        key.parameter.gain.map(|kind| signal.gain(kind))
    }
}

fn in_range(key: Key, value: f64) -> Result<(), SettingsError> {
    let Parameter { min, max, off, .. } = *key.parameter;
    if key.parameter.admits(value) {
        Ok(())
    } else {
        Err(SettingsError::OutOfRange { key: key.to_string(), found: value, min, max, or_off: off.is_some() })
    }
}

/// Rounds away the dust of binary fractions, three digits below the step: ten nudges of 0.1 make 1, not 0.9999999999999999.
fn tidy(value: f64, step: f64) -> f64 {
    if step == 0.0 {
        return value;
    }
    let digits = 1e3 / step.abs();
    let rounded = (value * digits).round() / digits;
    if rounded.is_finite() { rounded } else { value }
}

#[cfg(test)]
mod tests;
