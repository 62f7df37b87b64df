//! A change of the machine that a person asks for, and what it makes of settings.

use rotor::{C64, Key, Settings, SettingsError};

use crate::units::ScreenUnits;

/// A change of the machine that a person asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Raise a setting.
    Nudge(Key, f64),
    /// Raise several of a kind alike.
    NudgeAll(Vec<Key>, f64),
    /// Set these, all at once.
    Set(Vec<(Key, f64)>),
    /// A fault of a drill is there from here on, or no longer: values by key, and the reason for the record.
    Drill(Vec<(Key, f64)>, String),
    /// All gains to zero.
    Off,
    /// Put other settings in force, and what to call that; only what differs from those that were looked at is changed.
    Become(Box<(Settings, Settings)>, String),
    /// Put settings that were held in force, whole.
    Swap(Box<Settings>),
    /// Put a note on the record.
    Note(String),
    /// Take back the last change, whoever made it.
    Undo,
    /// Make it again.
    Redo,
    /// A change of velocity of one mass.
    Impulse(usize, C64),
    /// Back to rest.
    Restart,
    /// The edit, though the rotor is unstable with it: a person has said yes to exactly these settings.
    Sure(Box<Edit>, Box<Settings>),
}

impl Edit {
    /// Makes the change in `settings`. Returns whether it is one of settings that are known here.
    ///
    /// # Errors
    /// It does not fit them.
    pub fn apply(&self, settings: &mut Settings) -> Result<bool, SettingsError> {
        match self {
            Self::Nudge(key, delta) => settings.nudge(*key, *delta)?,
            Self::NudgeAll(keys, delta) => keys.iter().try_for_each(|key| settings.nudge(*key, *delta))?,
            Self::Set(values) | Self::Drill(values, _) => {
                values.iter().try_for_each(|(key, value)| settings.set(*key, *value))?;
            }
            Self::Off => settings.feedback = settings.feedback.off(),
            Self::Become(change, _) => carry_over(&change.0, &change.1, settings),
            Self::Swap(held) => settings.clone_from(held),
            Self::Sure(edit, _) => return edit.apply(settings),
            Self::Undo | Self::Redo | Self::Impulse(..) | Self::Restart | Self::Note(_) => return Ok(false),
        }
        Ok(true)
    }

    /// What `settings` would become; `None` if the edit changes no settings that are known here, or does not fit them.
    pub fn applied(&self, settings: &Settings) -> Option<Settings> {
        let mut settings = settings.clone();
        self.apply(&mut settings).ok()?.then_some(settings)
    }

    /// What it has made of `settings`, for whoever asked for it, in the bench's `units`.
    pub fn describe_in(&self, settings: &Settings, units: &ScreenUnits) -> String {
        match self {
            Self::Nudge(key, _) => settings.label(*key),
            Self::NudgeAll(keys, _) => keys.iter().map(|key| settings.label(*key)).collect::<Vec<_>>().join(", "),
            Self::Set(values) => values
                .iter()
                .map(|(key, value)| format!("{} = {}", settings.label(*key), units.value(*key, *value)))
                .collect::<Vec<_>>()
                .join(", "),
            Self::Drill(values, why) => {
                let set = Self::Set(values.clone()).describe_in(settings, units);
                format!("{why}: {set}")
            }
            Self::Sure(edit, _) => edit.describe_in(settings, units),
            other => other.describe(units),
        }
    }

    /// What it is, without saying of which settings, in the bench's `units`.
    pub fn describe(&self, units: &ScreenUnits) -> String {
        match self {
            Self::Nudge(..) | Self::NudgeAll(..) => super::NUDGED.into(),
            Self::Set(_) => "typed".into(),
            Self::Drill(_, why) => why.clone(),
            Self::Off => "control off".into(),
            Self::Become(_, what) => what.clone(),
            Self::Swap(_) => "swapped".into(),
            Self::Note(_) => "noted".into(),
            Self::Undo => "undone".into(),
            Self::Redo => "done again".into(),
            Self::Impulse(mass, velocity) => {
                // Of a dimensionless rotor velocities have no name that says more than the number.
                let velocity = match units.scales {
                    Some(_) => units.velocity.told(velocity.re, 5),
                    None => velocity.re.to_string(),
                };
                format!("impulse {velocity} on mass {}", mass + 1)
            }
            Self::Restart => "restarted from rest".into(),
            Self::Sure(edit, _) => edit.describe(units),
        }
    }

    /// Why the settings change, for the record.
    pub fn reason(&self) -> String {
        match self {
            Self::Undo => super::UNDO.into(),
            Self::Redo => super::REDO.into(),
            Self::Sure(edit, _) => edit.reason(),
            // None of these has a number in it that is counted in anything.
            other => other.describe(&ScreenUnits::DIMENSIONLESS),
        }
    }
}

/// Makes in `settings` the changes that lead from `from` to `to`, and no others.
pub fn carry_over(from: &Settings, to: &Settings, settings: &mut Settings) {
    // Whole, so that a field that is added is not forgotten here.
    let Settings { speed, deadband, trip, ramp, coast_down, feedback, unbalance_added } = to;
    carry(&from.speed, speed, &mut settings.speed);
    carry(&from.trip, trip, &mut settings.trip);
    carry(&from.ramp, ramp, &mut settings.ramp);
    carry(&from.coast_down, coast_down, &mut settings.coast_down);
    carry(&from.feedback, feedback, &mut settings.feedback);
    let lists = [
        (&from.deadband, deadband, &mut settings.deadband),
        (&from.unbalance_added, unbalance_added, &mut settings.unbalance_added),
    ];
    for (from, to, places) in lists {
        for (place, (from, to)) in places.iter_mut().zip(from.iter().zip(to)) {
            carry(from, to, place);
        }
    }
}

fn carry<T: Clone + PartialEq>(from: &T, to: &T, into: &mut T) {
    if from != to {
        into.clone_from(to);
    }
}
