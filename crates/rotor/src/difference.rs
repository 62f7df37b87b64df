//! What differs between two settings: for logs of changes, by key.

use std::fmt;

use crate::{Key, Settings};

/// One value that has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangedValue {
    /// Which.
    pub key: Key,
    /// The key as a person reads it ([`Settings::label`]), with its control bearing where there are several.
    pub label: String,
    /// The value before.
    pub was: f64,
    /// The value after.
    pub is: f64,
}

/// What has changed from one [`Settings`] to another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// The keys whose value differs: before and after; a scheduled gain at the speed of either. One row for the
    /// deadbands of all masses if they were, and are, all alike.
    pub values: Vec<ChangedValue>,
    /// Whether the control law differs in more than its gains' values: bearing, signals, weights, schedules.
    pub law: bool,
}

impl Difference {
    /// What has changed from `before` to `after`.
    #[must_use]
    pub fn between(before: &Settings, after: &Settings) -> Self {
        let mut difference = Self::default();
        let (old, new) = (&before.feedback, &after.feedback);
        let bearings_differ = old.bearings.len() != new.bearings.len()
            || old
                .bearings
                .iter()
                .zip(&new.bearings)
                .any(|(a, b)| (a.station, &a.name, a.signals.len()) != (b.station, &b.name, b.signals.len()));
        let weights_differ = bearings_differ
            || old
                .signals()
                .zip(new.signals())
                .any(|(a, b)| a.displacement != b.displacement || a.velocity != b.velocity);
        difference.law = weights_differ;
        let alike = |g: &[f64]| g.windows(2).all(|pair| pair[0] == pair[1]);
        let all_alike = alike(&before.deadband) && alike(&after.deadband);
        for mut key in after.keys() {
            let is_gain = after.gain(key).is_some();
            if is_gain && (weights_differ || before.gain(key) == after.gain(key)) {
                continue;
            }
            let (Ok(was), Ok(is)) = (before.get(key), after.get(key)) else { continue };
            if was == is {
                // A schedule that meets the old value at this speed.
                difference.law |= is_gain;
                continue;
            }
            if key.parameter.name == "deadband" && all_alike {
                if key.index != Some(0) {
                    continue;
                }
                key.index = None;
            }
            difference.values.push(ChangedValue { key, label: after.label(key), was, is });
        }
        difference
    }

    /// Whether nothing differs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty() && !self.law
    }
}

impl fmt::Display for Difference {
    /// `speed 2.5 -> 3, kd.1 -0.5879 -> 0.1`; dimensionless.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, ChangedValue { label, was, is, .. }) in self.values.iter().enumerate() {
            write!(f, "{}{label} {was} -> {is}", if i > 0 { ", " } else { "" })?;
        }
        match (self.law, self.values.is_empty()) {
            (true, true) => f.write_str("another feedback"),
            (true, false) => f.write_str(", another feedback"),
            (false, _) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gain, builtin};

    fn told(change: impl FnOnce(&mut Settings)) -> String {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let before = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").expect("built in"));
        let mut after = before.clone();
        change(&mut after);
        let difference = Difference::between(&before, &after);
        assert_eq!(difference.is_empty(), before == after);
        difference.to_string()
    }

    #[test]
    fn changes_are_told_by_key() {
        assert_eq!(told(|_| ()), "");
        assert_eq!(told(|s| s.speed = 3.0), "speed 2.5 -> 3");
        assert_eq!(told(|s| s.deadband.fill(1.5)), "deadband 0 -> 1.5");
        assert_eq!(told(|s| s.deadband[1] = 0.5), "deadband.2 0 -> 0.5");
        assert_eq!(
            told(|s| {
                s.trip = 5.0;
                s.feedback.first_mut().signals[0].gains[0] = Gain::Constant(0.25);
            }),
            "trip 1000 -> 5, kd.1 -0.5879 -> 0.25"
        );
        assert_eq!(told(|s| s.feedback.first_mut().station = 2), "another feedback");
        let same_here = Gain::Table(vec![(0.0, -0.5879), (9.0, -0.5879)]);
        assert_eq!(told(|s| s.feedback.first_mut().signals[0].gains[0] = same_here), "another feedback");
        assert_eq!(
            told(|s| {
                s.speed = 1.0;
                s.feedback.first_mut().signals.clear();
            }),
            "speed 2.5 -> 1, another feedback"
        );
    }

    #[test]
    fn of_several_control_bearings_a_change_names_its_own() {
        let rotor = builtin::rotor("rig").expect("built in");
        let before = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "own").expect("built in"));
        let mut after = before.clone();
        let key = after.key("right.kd").expect("a key");
        let was = before.get(key).expect("a gain");
        after.set(key, 3.0).expect("in range");
        assert_eq!(Difference::between(&before, &after).to_string(), format!("right.kd {was} -> 3"));
    }
}
