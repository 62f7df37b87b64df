//! The settings of a run, change after change, as its events tell them: for all that is a pure function of those events.

use rotor::Settings;
use wire::{Event, Happening};

/// Up to which change the settings of a run are known, and what they are then.
#[derive(Clone, Debug, Default)]
pub(crate) struct SettingsTrail {
    run: u64,
    revision: u64,
    settings: Option<Settings>,
}

/// What settings that are told are to those that were known.
#[derive(Debug)]
pub(crate) enum SettingsNews {
    /// The first of a run that are known: what came before them is not.
    First,
    /// Known already: of events that come twice the second says nothing.
    Again,
    /// Others, in place of these.
    After(Settings),
}

impl SettingsTrail {
    /// Run and revision up to which changes are known.
    pub(crate) fn known_up_to(&self) -> (u64, u64) {
        (self.run, self.revision)
    }

    /// The settings that are known last.
    #[cfg(test)]
    pub(crate) fn latest(&self) -> Option<&Settings> {
        self.settings.as_ref()
    }

    /// Takes in the settings of a run at a revision.
    pub(crate) fn take_in(&mut self, (run, revision): (u64, u64), settings: &Settings) -> SettingsNews {
        let before = self.settings.take().filter(|_| run == self.run);
        let told = match before {
            None => SettingsNews::First,
            Some(before) if revision <= self.revision => {
                self.settings = Some(before);
                return SettingsNews::Again;
            }
            Some(before) => SettingsNews::After(before),
        };
        *self = Self { run, revision, settings: Some(settings.clone()) };
        told
    }
}

/// Why settings were changed, as an event tells it; nothing of events that are no change of settings.
pub(crate) fn reason(event: &Event) -> &str {
    match event.happening() {
        Some(Happening::Settings) => event.why.as_str(),
        _ => "",
    }
}
