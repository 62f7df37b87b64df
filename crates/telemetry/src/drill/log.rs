//! Which fault is there, and what it was put in place of: a pure function of the events of a run, so that all who look have the same.

use rotor::{Key, Settings};
use wire::Event;

use super::CAUSE;
use crate::settings_trail::{SettingsNews, SettingsTrail, reason};

/// Faults that are remembered: as many as changes can be undone.
const REMEMBERED: usize = 256;

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
    trail: SettingsTrail,
    active: Option<ActiveFault>,
    /// Under which settings which fault was there: who comes back to them, by undo or redo, has it again.
    known: Vec<(Settings, ActiveFault)>,
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
        self.trail.known_up_to()
    }

    /// Takes in an event. Of events that come twice the second says nothing.
    pub fn push(&mut self, event: &Event) {
        self.note((event.run_id, event.revision), reason(event), event.settings.get());
    }

    pub(super) fn note(&mut self, at: (u64, u64), why: &str, settings: &Settings) {
        let before = match self.trail.take_in(at, settings) {
            SettingsNews::First => {
                (self.active, self.known) = (None, Vec::new());
                return;
            }
            SettingsNews::Again => return,
            SettingsNews::After(before) => before,
        };
        if let Some(told) = why.strip_prefix(CAUSE) {
            let mut back = self.active.take().map_or_else(Vec::new, |active| active.back);
            for key in settings.keys() {
                let (Ok(was), Ok(is)) = (before.get(key), settings.get(key)) else { continue };
                if was != is && !back.iter().any(|(known, _)| *known == key) {
                    back.push((key, was));
                }
            }
            self.active = Some(ActiveFault { told: told.to_owned(), back });
        } else if let Some((_, fault)) = self.known.iter().rev().find(|(known, _)| known == settings) {
            self.active = Some(fault.clone());
        }
        // What stands as it did before is put back, by whomever.
        if let Some(active) = &mut self.active {
            active.back.retain(|(key, was)| settings.get(*key) != Ok(*was));
        }
        self.active = self.active.take().filter(|active| !active.back.is_empty());
        if let Some(active) = &self.active {
            if self.known.len() == REMEMBERED {
                self.known.remove(0);
            }
            self.known.push((settings.clone(), active.clone()));
        }
    }
}
