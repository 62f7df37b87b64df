//! Which fault is there, and what it was put in place of: a pure function of the events of a run, so that all who look have the same.

use rotor::{Key, Settings};
use wire::{Event, Happening};

use super::CAUSE;

/// A fault that is there.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveFault {
    /// As it was asked for: `sensor-gain at=2 size=0.5`.
    pub told: String,
    /// What it has changed, with the values that were there before.
    pub back: Vec<(Key, f64)>,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct DrillLog {
    run: u64,
    revision: u64,
    settings: Option<Settings>,
    active: Option<ActiveFault>,
}

impl DrillLog {
    /// The fault that is there, as far as the events tell.
    #[must_use]
    pub fn active(&self) -> Option<&ActiveFault> {
        self.active.as_ref()
    }

    /// Run and revision up to which changes are known.
    #[must_use]
    pub fn known_up_to(&self) -> (u64, u64) {
        (self.run, self.revision)
    }

    /// Takes in an event. Of events that come twice the second says nothing.
    pub fn push(&mut self, event: &Event) {
        let why = match event.happening() {
            Some(Happening::Settings) => event.why.as_str(),
            _ => "",
        };
        self.note((event.run_id, event.revision), why, event.settings.get());
    }

    pub(super) fn note(&mut self, (run, revision): (u64, u64), why: &str, settings: &Settings) {
        let before = self.settings.take().filter(|_| run == self.run);
        let Some(before) = before else {
            // What came before another run, or before the first event that has come, is not known.
            *self = Self { run, revision, settings: Some(settings.clone()), active: None };
            return;
        };
        if revision <= self.revision {
            self.settings = Some(before);
            return;
        }
        self.revision = revision;
        if let Some(told) = why.strip_prefix(CAUSE) {
            let mut back = self.active.take().map_or_else(Vec::new, |active| active.back);
            for key in settings.keys() {
                let (Ok(was), Ok(is)) = (before.get(key), settings.get(key)) else { continue };
                if was != is && !back.iter().any(|(known, _)| *known == key) {
                    back.push((key, was));
                }
            }
            self.active = Some(ActiveFault { told: told.to_owned(), back });
        }
        // What stands as it did before is put back, by whomever.
        if let Some(active) = &mut self.active {
            active.back.retain(|(key, was)| settings.get(*key) != Ok(*was));
        }
        self.active = self.active.take().filter(|active| !active.back.is_empty());
        self.settings = Some(settings.clone());
    }
}
