//! Which keys some settings have, what a typed one means, and how one is told.

use super::Settings;
use crate::{Key, PARAMETERS, Parameter, Rotor, Scope, SettingsError};

impl Settings {
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

    /// The masses or signals that a key means: all masses or the first signal, where it does not say.
    pub(super) fn places(&self, key: Key) -> Result<std::ops::Range<usize>, SettingsError> {
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
