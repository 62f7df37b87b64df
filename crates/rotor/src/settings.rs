//! All that can be changed on a running machine: see [`PARAMETERS`] for the table of its keys.
//!
//! Settings travel whole and are checked whole: a half-applied change cannot exist.

use std::borrow::Cow;

use units::Units;

use crate::{ClosedLoop, Feedback, Gain, Key, PARAMETERS, Parameter, Rotor, Scope, SettingsError};

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

    /// Every key these settings have: one a mass for deadbands, one a signal for gains, one a control bearing for what differs
    /// between several.
    #[must_use]
    pub fn keys(&self) -> Vec<Key> {
        let mut keys = Vec::new();
        let mut add = |scope: Scope, can_be_off: bool, of: fn(&Parameter) -> bool, index| {
            let rows = PARAMETERS.iter().filter(|p| p.scope == scope && p.off.is_some() == can_be_off && of(p));
            keys.extend(rows.map(|parameter| Key { parameter, index }));
        };
        let all = |_: &Parameter| true;
        add(Scope::Machine, false, all, None);
        (0..self.deadband.len()).for_each(|i| add(Scope::Mass, false, all, Some(i)));
        (0..self.feedback.signal_count()).for_each(|i| add(Scope::Signal, false, all, Some(i)));
        // What most machines do not have stands last.
        add(Scope::Machine, true, all, None);
        match self.feedback.bearings.len() {
            1 => add(Scope::Bearing, true, all, None),
            several => {
                add(Scope::Bearing, true, is_of_all, None);
                (0..several).for_each(|k| add(Scope::Bearing, true, |p| !is_of_all(p), Some(k)));
            }
        }
        (0..self.unbalance_added.len()).for_each(|i| add(Scope::Mass, true, all, Some(i)));
        keys
    }

    /// The key that is typed as `speed`, `deadband.2`, `kd.2`; where there are several control bearings also as `left.kd`, `left.kd.2`
    /// or `kd.1.2` (of bearing 1 the second signal) and `left.lag`.
    ///
    /// # Errors
    /// No such key, or a gain of one of several control bearings without saying of which.
    pub fn key(&self, typed: &str) -> Result<Key, SettingsError> {
        let words: Vec<&str> = typed.split('.').collect();
        let unknown = || SettingsError::UnknownKey(typed.to_owned());
        let row = |name: &str| PARAMETERS.iter().find(|p| p.name == name);
        let (parameter, bearing, rest) = match words[..] {
            [first, name, ref rest @ ..] if row(first).is_none() && row(name).is_some() => {
                let bearing = self.feedback.find(first).ok_or_else(unknown)?;
                (row(name).ok_or_else(unknown)?, Some(bearing), rest)
            }
            [name, first, second] if row(name).is_some_and(|p| p.scope == Scope::Signal) => {
                let bearing = self.feedback.find(first).ok_or_else(unknown)?;
                (row(name).ok_or_else(unknown)?, Some(bearing), &[second][..])
            }
            _ => {
                let key: Key = typed.parse()?;
                if key.parameter.scope == Scope::Signal && key.index.is_none() && self.feedback.only().is_none() {
                    let first = |k| format!("{}.{typed}", self.feedback.label(k));
                    let known = (0..self.feedback.bearings.len()).map(first).collect();
                    return Err(SettingsError::WhichBearing { key: typed.to_owned(), known });
                }
                return Ok(key);
            }
        };
        let bearing = bearing.ok_or_else(unknown)?;
        let place = match rest {
            [] => 0,
            [number] => number.parse::<usize>().ok().and_then(|n| n.checked_sub(1)).ok_or_else(unknown)?,
            _ => return Err(unknown()),
        };
        let of_bearing = &self.feedback.bearings[bearing];
        match parameter.scope {
            Scope::Bearing if rest.is_empty() => Ok(Key { parameter, index: Some(bearing) }),
            Scope::Signal if place < of_bearing.signals.len() => {
                let before: usize = self.feedback.bearings[..bearing].iter().map(|b| b.signals.len()).sum();
                Ok(Key { parameter, index: Some(before + place) })
            }
            Scope::Signal => {
                let (key, count) = (typed.to_owned(), of_bearing.signals.len());
                Err(SettingsError::NoSuchIndex { key, count, of: "signals" })
            }
            _ => Err(unknown()),
        }
    }

    /// The keys of one value each that a key means: itself, but of several control bearings one each where it is of all. What is typed for
    /// all of them may be another number for each ([`crate::ControlMasses`]).
    #[must_use]
    pub fn each_bearing(&self, key: Key) -> Vec<Key> {
        match (key.parameter.scope, key.index, self.feedback.bearings.len()) {
            (Scope::Bearing, None, count @ 2..) => (0..count).map(|k| Key { index: Some(k), ..key }).collect(),
            _ => vec![key],
        }
    }

    /// The same on `rotor`, of whose places a clearance is set only where a support bearing has one.
    ///
    /// # Errors
    /// The clearance of a place where nothing has play: to set it would do nothing.
    pub fn each(&self, rotor: &Rotor, key: Key) -> Result<Vec<Key>, SettingsError> {
        if key.parameter.scope != Scope::Mass || key.parameter.is_fault() {
            return Ok(self.each_bearing(key));
        }
        let met: Vec<usize> = (0..self.deadband.len()).filter(|place| rotor.has_contact(*place)).collect();
        let one = |place: usize| Key { index: Some(place), ..key };
        let refused = |place: String| {
            let known = met.iter().map(|place| match rotor.is_chain() {
                true => one(*place).to_string(),
                false => format!("{} ({})", one(*place), rotor.place_name(*place)),
            });
            Err(SettingsError::NoContact { key: key.to_string(), place, known: known.collect() })
        };
        match key.index {
            None if met.is_empty() => refused("the rotor".to_owned()),
            // What is set of a mass without a bearing is nothing, but told with the others.
            None if rotor.is_chain() => Ok(vec![key]),
            None => Ok(met.into_iter().map(one).collect()),
            Some(place) if place < self.deadband.len() && !met.contains(&place) => refused(rotor.place_name(place)),
            Some(_) => Ok(vec![key]),
        }
    }

    /// The control bearing, counted from 0, that a key belongs to; nothing of a key of the machine, of a mass, or of all bearings.
    #[must_use]
    pub fn bearing_of(&self, key: Key) -> Option<usize> {
        match key.parameter.scope {
            Scope::Bearing => key.index,
            Scope::Signal => Some(self.feedback.place_of_signal(key.index.unwrap_or(0))?.0),
            Scope::Machine | Scope::Mass => None,
        }
    }

    /// A key as a person reads it: with the name of its control bearing where there are several.
    #[must_use]
    pub fn label(&self, key: Key) -> String {
        let Key { parameter, index } = key;
        match (parameter.scope, index, self.feedback.only()) {
            (Scope::Bearing, Some(bearing), None) => format!("{}.{}", self.feedback.label(bearing), parameter.name),
            (Scope::Signal, Some(place), None) => match self.feedback.place_of_signal(place) {
                Some((bearing, own)) => {
                    let signals = self.feedback.bearings[bearing].signals.len();
                    let number = if signals > 1 { format!(".{}", own + 1) } else { String::new() };
                    format!("{}.{}{number}", self.feedback.label(bearing), parameter.name)
                }
                None => key.to_string(),
            },
            _ => key.to_string(),
        }
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

    /// The masses or signals that a key means: all masses or the first signal, where it does not say.
    fn places(&self, key: Key) -> Result<std::ops::Range<usize>, SettingsError> {
        let (count, all) = match key.parameter.scope {
            Scope::Machine => return Ok(0..1),
            Scope::Mass => (self.deadband.len(), self.deadband.len()),
            Scope::Signal => (self.feedback.signal_count(), 1),
            Scope::Bearing => (self.feedback.bearings.len(), self.feedback.bearings.len()),
        };
        match key.index {
            None if count > 0 => Ok(0..all),
            Some(place) if place < count => Ok(place..place + 1),
            _ => Err(self.no_such(key)),
        }
    }

    fn no_such(&self, key: Key) -> SettingsError {
        let (count, of) = match key.parameter.scope {
            Scope::Signal => (self.feedback.signal_count(), "signals"),
            Scope::Bearing => (self.feedback.bearings.len(), "control bearings"),
            Scope::Mass | Scope::Machine => (self.deadband.len(), "masses"),
        };
        SettingsError::NoSuchIndex { key: key.to_string(), count, of }
    }
}

/// Whether a part of the loop is the same for all control bearings: one computer samples and computes.
fn is_of_all(parameter: &Parameter) -> bool {
    matches!(parameter.name, "sample" | "delay")
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
mod tests {
    use super::*;
    use crate::GainKind;
    use crate::builtin;

    fn three_mass() -> (Rotor, Settings) {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let feedback = builtin::feedback(&rotor, "individual").expect("built in");
        let settings = Settings::new(&rotor, 2.5, feedback);
        (rotor, settings)
    }

    #[test]
    fn every_key_reads_back_what_was_set() {
        let (rotor, mut settings) = three_mass();
        let keys = settings.keys();
        assert_eq!(keys.len(), 4 + 16 + 3 + 3 + 4 * 2);
        for (i, &key) in keys.iter().enumerate() {
            // The sensor at a station is a whole number.
            let value = if key.parameter.name == "sensor_at" { 2.0 } else { 0.25 + i as f64 };
            assert_eq!(key.to_string().parse::<Key>().expect("its own name"), key);
            settings.set(key, value).expect("in range");
            assert_eq!(settings.get(key).expect("exists"), value, "{key}");
        }
        settings.check(&rotor).expect("all in range");
    }

    #[test]
    fn a_key_without_index_means_all_masses_or_the_first_signal() {
        let (_, mut settings) = three_mass();
        settings.assign("deadband", "2").expect("fine");
        settings.assign("deadband.2", "0.5").expect("fine");
        assert_eq!(settings.deadband, [2.0, 0.5, 2.0]);
        settings.assign("kd", "0.75").expect("fine");
        assert_eq!(settings.feedback.first().signals[0].gains[0], Gain::Constant(0.75));
    }

    #[test]
    fn refusals_change_nothing_and_say_why() {
        let (_, mut settings) = three_mass();
        let before = settings.clone();
        let none = |key: &str| {
            format!(
                "no setting '{key}': {}there are {}, with .N for mass, signal or control bearing N",
                crate::settings_error::meant(key),
                crate::settings_error::known_keys()
            )
        };
        assert!(none("sped").contains("did you mean 'speed'?"));
        assert!(none("").contains("speed, ramp, deadband, kd, cd, kc, cc, trip"), "{}", none(""));
        for (key, value, why) in [
            ("sped", "1", &*none("sped")),
            ("speed.1", "1", &*none("speed.1")),
            ("kd.0", "1", &*none("kd.0")),
            ("kd.3", "1", "no kd.3: there are 2 signals"),
            ("deadband.4", "1", "no deadband.4: there are 3 masses"),
            ("speed", "fast", "speed = 'fast': expected a number"),
            ("speed", "-1", "speed = -1: expected a number from 0 to 1000"),
            ("kd", "nan", "kd = NaN: expected a number from -1000000 to 1000000"),
            ("trip", "inf", "trip = inf: expected a number from 0.001 to 1000000000"),
            ("trip", "off", "trip = 'off': expected a number"),
            ("delay", "-0.1", "delay = -0.1: expected a number from 0.000000001 to 1000000, or off"),
            ("limit", "0", "limit = 0: expected a number from 0.000000001 to 1000000000000, or off"),
            ("sample", "soon", "sample = 'soon': expected a number, or off"),
        ] {
            assert_eq!(settings.assign(key, value).expect_err(key).to_string(), why);
        }
        assert_eq!(settings, before);
    }

    #[test]
    fn whole_settings_are_checked_against_their_rotor() {
        let (rotor, settings) = three_mass();
        let refused = |change: &dyn Fn(&mut Settings)| {
            let mut changed = settings.clone();
            change(&mut changed);
            changed.check(&rotor).expect_err("refused").to_string()
        };
        assert_eq!(refused(&|s| s.deadband = vec![1.0]), "1 deadbands for 3 masses");
        assert_eq!(refused(&|s| s.speed = f64::NAN), "speed = NaN: expected a number from 0 to 1000");
        assert_eq!(refused(&|s| s.deadband[1] = -1.0), "deadband.2 = -1: expected a number from 0 to 1000000");
        assert_eq!(
            refused(&|s| s.feedback.first_mut().signals[1].gains[2] = Gain::Table(vec![(0.0, 0.0), (1.0, 2e6)])),
            "kc.2 = 2000000: expected a number from -1000000 to 1000000"
        );
    }

    #[test]
    fn nudges_stay_on_round_numbers_and_in_range() {
        let (_, mut settings) = three_mass();
        let speed: Key = "speed".parse().expect("a key");
        settings.set(speed, 0.0).expect("in range");
        (0..10).for_each(|_| settings.nudge(speed, 0.1).expect("exists"));
        assert_eq!(settings.speed, 1.0);
        settings.nudge(speed, -7.0).expect("exists");
        assert_eq!(settings.speed, 0.0);
    }

    #[test]
    fn what_is_off_can_be_turned_on_and_off_again() {
        let (rotor, mut settings) = three_mass();
        for (key, on) in
            [("delay", "0.02"), ("limit", "20"), ("ramp", "0.01"), ("coast_down", "0.02"), ("sample", "0.05")]
        {
            settings.assign(key, on).expect("on");
            settings.check(&rotor).expect("allowed");
            assert_eq!(
                settings.get(key.parse().expect("a key")).expect("there is"),
                on.parse::<f64>().expect("a number")
            );
            settings.assign(key, "off").expect("off");
        }
        assert!(settings.feedback.is_ideal() && settings.ramp.is_infinite() && settings.coast_down == 0.0);
        let delay: Key = "delay".parse().expect("a key");
        settings.nudge(delay, 0.01).expect("exists");
        assert_eq!(settings.feedback.delay(), 0.01);
        settings.nudge(delay, -0.01).expect("exists");
        assert_eq!(settings.feedback.delay(), 0.0);
    }

    #[test]
    fn nudging_a_schedule_keeps_its_slope() {
        let rotor = builtin::rotor("jeffcott").expect("built in");
        let mut settings = Settings::new(&rotor, 2.0, builtin::feedback(&rotor, "cancel").expect("built in"));
        let kc: Key = "kc".parse().expect("a key");
        settings.nudge(kc, 0.25).expect("exists");
        assert_eq!(
            settings.feedback.first().signals[0].gain(GainKind::Kc),
            &Gain::Linear { at_zero: 0.25, slope: -0.5 }
        );
    }
}
