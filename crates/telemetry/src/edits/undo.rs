//! The changes of settings that can be taken back and made again, by whomever.
//!
//! A pure function of the events of one run: dashboards with the same events hold the same undo history, so that what
//! one undoes another can redo. An event has who, why and the settings after it; its why
//! tells undo and redo from changes.

use rotor::{Difference, Key, Settings};
use wire::Event;

use super::{NUDGED, REDO, UNDO};
use crate::settings_trail::{SettingsNews, SettingsTrail, reason};

/// Nudges of one key by the same hand that follow each other within these nanoseconds are undone together.
const ONE_GESTURE: u64 = 700_000_000;
/// Changes that can be taken back.
const REMEMBERED: usize = 256;

/// One change that can be taken back.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UndoableChange {
    /// What it changed.
    pub(crate) before: Settings,
    /// What it led to.
    pub(crate) after: Settings,
    /// Who made it.
    pub(crate) who: String,
    /// The key that was nudged, and when last.
    nudged: Option<(Key, u64)>,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct UndoHistory {
    trail: SettingsTrail,
    done: Vec<UndoableChange>,
    undone: Vec<UndoableChange>,
}

impl UndoHistory {
    /// Run and revision up to which changes are known.
    pub(crate) fn known_up_to(&self) -> (u64, u64) {
        self.trail.known_up_to()
    }

    /// The change that undo takes back.
    pub(crate) fn to_undo(&self) -> Option<&UndoableChange> {
        self.done.last()
    }

    /// The change that redo makes again.
    pub(crate) fn to_redo(&self) -> Option<&UndoableChange> {
        self.undone.last()
    }

    /// Takes in an event.
    pub(crate) fn push_event(&mut self, event: &Event) {
        let told = (event.run_id, event.revision, event.wall_ns);
        self.note(told, event.who.as_str(), reason(event), event.settings.get());
    }

    /// Takes in settings whose events did not come: what led to them counts as one change.
    pub(crate) fn push_missed(&mut self, run: u64, revision: u64, settings: &Settings, who: &str) {
        self.note((run, revision, 0), who, "", settings);
    }

    fn note(&mut self, (run, revision, wall_ns): (u64, u64, u64), who: &str, why: &str, settings: &Settings) {
        let before = match self.trail.take_in((run, revision), settings) {
            // What came before cannot be taken back.
            SettingsNews::First => {
                (self.done, self.undone) = (Vec::new(), Vec::new());
                return;
            }
            SettingsNews::Again => return,
            SettingsNews::After(before) => before,
        };
        let leads = |from: &Settings, to: &Settings| *from == before && to == settings;
        if why == UNDO && self.done.last().is_some_and(|step| leads(&step.after, &step.before)) {
            self.undone.extend(self.done.pop());
        } else if why == REDO && self.undone.last().is_some_and(|step| leads(&step.before, &step.after)) {
            self.done.extend(self.undone.pop());
        } else {
            self.undone.clear();
            let nudged = nudged_key(&before, settings).filter(|_| why == NUDGED).map(|key| (key, wall_ns));
            self.push(UndoableChange { before, after: settings.clone(), who: who.to_owned(), nudged });
        }
    }

    /// One more change, or the rest of the last one. The oldest is forgotten.
    fn push(&mut self, step: UndoableChange) {
        if let Some(last) = self.done.last_mut()
            && let (Some((key, at)), Some((same, then))) = (step.nudged, last.nudged)
            && (key, &step.who) == (same, &last.who)
            && at.saturating_sub(then) < ONE_GESTURE
        {
            (last.after, last.nudged) = (step.after, step.nudged);
            return;
        }
        if self.done.len() == REMEMBERED {
            self.done.remove(0);
        }
        self.done.push(step);
    }
}

/// The one key in which settings differ, if it is one.
fn nudged_key(before: &Settings, after: &Settings) -> Option<Key> {
    let difference = Difference::between(before, after);
    match (&difference.values[..], difference.law) {
        ([only], false) => Some(only.key),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use wire::{Happening, SettingsDocument, Text};

    use super::*;
    use crate::test_support::bench_status;

    fn start() -> Settings {
        bench_status("three-mass", "composite").settings.get().clone()
    }

    /// A change to `settings` as the simulation tells it.
    fn event(revision: u64, who: &str, why: &str, settings: &Settings) -> Box<Event> {
        let happening = if revision == 1 { Happening::Started } else { Happening::Settings };
        let mut event = happening.event();
        (event.run_id, event.revision, event.wall_ns) = (7, revision, revision * 1_000_000_000);
        (event.who, event.why) = (Text::new(who), Text::new(why));
        event.settings = SettingsDocument::of(settings);
        event
    }

    fn with(key: &str, value: f64, settings: &Settings) -> Settings {
        let mut settings = settings.clone();
        settings.set(key.parse().unwrap(), value).unwrap();
        settings
    }

    #[test]
    fn each_of_several_quick_changes_is_a_step_with_its_author() {
        let mut undo_history = UndoHistory::default();
        let a = with("speed", 3.0, &start());
        let b = with("kd", 0.1, &a);
        for (revision, who, settings) in [(1, "sim", &start()), (2, "set:1", &a), (3, "dash:2", &b)] {
            undo_history.push_event(&event(revision, who, "typed", settings));
        }
        let last = undo_history.to_undo().unwrap().clone();
        assert_eq!((&last.before, &last.after, &*last.who), (&a, &b, "dash:2"));
        undo_history.push_event(&event(4, "dash:9", UNDO, &a));
        let next = undo_history.to_undo().unwrap();
        assert_eq!((&next.before, &next.after, &*next.who), (&start(), &a, "set:1"));
        assert_eq!(undo_history.to_redo(), Some(&last), "what one has undone another can redo");
        undo_history.push_event(&event(4, "dash:9", UNDO, &a));
        assert_eq!(undo_history.to_redo(), Some(&last), "told twice is done once");
    }

    #[test]
    fn another_change_ends_redo_and_another_run_begins_anew() {
        let mut undo_history = UndoHistory::default();
        let [a, b] = [3.0, 4.0].map(|speed| with("speed", speed, &start()));
        undo_history.push_event(&event(1, "sim", "", &start()));
        undo_history.push_event(&event(2, "x", "", &a));
        undo_history.push_event(&event(3, "x", UNDO, &start()));
        assert!(undo_history.to_redo().is_some() && undo_history.to_undo().is_none());
        undo_history.push_event(&event(4, "x", "", &b));
        assert!(undo_history.to_redo().is_none() && undo_history.to_undo().is_some());
        // A person may say "undo" of what is none.
        undo_history.push_event(&event(5, "x", UNDO, &a));
        assert_eq!(undo_history.to_undo().map(|step| &step.after), Some(&a));
        let mut other = event(1, "sim", "", &b);
        other.run_id = 8;
        undo_history.push_event(&other);
        assert_eq!((undo_history.to_undo(), undo_history.known_up_to()), (None, (8, 1)));
    }

    #[test]
    fn changes_whose_events_are_lost_are_one_step() {
        let mut undo_history = UndoHistory::default();
        undo_history.push_event(&event(1, "sim", "", &start()));
        let later = with("speed", 3.0, &start());
        undo_history.push_missed(7, 5, &later, "set:3");
        assert_eq!(undo_history.to_undo().map(|step| &step.before), Some(&start()));
        undo_history.push_event(&event(4, "late", "", &start()));
        assert_eq!((undo_history.known_up_to(), undo_history.done.len()), ((7, 5), 1));
    }

    #[test]
    fn nudges_of_one_hand_on_one_key_are_one_step() {
        let mut undo_history = UndoHistory::default();
        undo_history.push_event(&event(1, "sim", "", &start()));
        for (revision, who, key, at) in
            [(2, "a", "kd", 0), (3, "a", "kd", 600), (4, "b", "kd", 700), (5, "b", "cd", 800), (6, "b", "cd", 2800)]
        {
            let settings = with(key, revision as f64, undo_history.trail.latest().unwrap());
            let mut event = event(revision, who, NUDGED, &settings);
            event.wall_ns = at * 1_000_000;
            undo_history.push_event(&event);
        }
        let whose: Vec<&str> = undo_history.done.iter().map(|step| &*step.who).collect();
        assert_eq!(whose, ["a", "b", "b", "b"]);
    }

    proptest! {
        /// Undoing all leads to the start through every settings that were; redoing all leads back.
        #[test]
        fn undo_and_redo_retrace_every_step(speeds in prop::collection::vec(0.0..9.0_f64, 1..40)) {
            let mut undo_history = UndoHistory::default();
            let mut told = vec![start()];
            undo_history.push_event(&event(1, "sim", "", &start()));
            for speed in speeds {
                let settings = with("speed", speed, &start());
                told.push(settings.clone());
                undo_history.push_event(&event(told.len() as u64, "x", "", &settings));
            }
            let mut revision = told.len() as u64;
            for settings in told.iter().rev().skip(1) {
                revision += 1;
                let before = undo_history.to_undo().unwrap().before.clone();
                prop_assert_eq!(&before, settings);
                undo_history.push_event(&event(revision, "y", UNDO, &before));
            }
            prop_assert!(undo_history.to_undo().is_none());
            for settings in told.iter().skip(1) {
                revision += 1;
                let after = undo_history.to_redo().unwrap().after.clone();
                prop_assert_eq!(&after, settings);
                undo_history.push_event(&event(revision, "z", REDO, &after));
            }
            prop_assert!(undo_history.to_redo().is_none());
        }
    }
}
