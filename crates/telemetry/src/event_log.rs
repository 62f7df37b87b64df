//! What has happened on the bench: who changed what and why, trips, notes. Bounded; the newest stay.

use std::sync::Arc;

use alarms::Level;
use rotor::Settings;
use wire::{Event, Happening};

use crate::replay::{RecordedEvent, RecordedKind};
use crate::units::ScreenUnits;

/// Entries kept.
const KEPT: usize = 500;

/// One thing that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedEvent {
    /// When, nanoseconds since 1970.
    pub wall_ns: u64,
    /// The rotor's time then.
    pub tau: f64,
    /// What, in words.
    pub what: String,
    /// What kind of thing.
    pub happening: Happening,
    /// How bad it is, of an alarm.
    pub level: Level,
    /// Who did it.
    pub who: String,
    /// Why; may be empty.
    pub why: String,
}

/// All that has been told, the oldest first.
#[derive(Clone, Debug, Default)]
pub struct EventLog {
    entries: Arc<Vec<LoggedEvent>>,
    /// Run and number of the newest event: what has been told already is told again to who attaches anew.
    newest: (u64, u64),
    settings: Option<Settings>,
}

impl EventLog {
    /// Takes in an event, and puts it in words with the bench's `units`. Returns whether it was news.
    pub fn push(&mut self, event: &Event, units: &ScreenUnits) -> bool {
        let (run, number) = self.newest;
        if event.run_id == run && event.number <= number {
            return false;
        }
        self.newest = (event.run_id, event.number);
        let before = self.settings.replace(event.settings.get().clone()).filter(|_| event.run_id == run);
        let Some(happening) = event.happening() else { return false };
        let difference = match (&happening, &before, &self.settings) {
            (Happening::Settings, Some(before), Some(after)) => units.difference(before, after),
            _ => String::new(),
        };
        let what = if difference.is_empty() { units.happening(&happening) } else { difference };
        let (who, why) = (event.who.as_str().to_owned(), event.why.as_str().to_owned());
        self.keep(LoggedEvent {
            wall_ns: event.wall_ns,
            tau: event.tau,
            what,
            happening,
            level: Level::Fine,
            who,
            why,
        });
        true
    }

    /// Takes in an event of a recording; of a change with what it changed, in words.
    pub fn push_past(&mut self, event: &RecordedEvent, difference: Option<String>, units: &ScreenUnits) {
        let what = difference.unwrap_or_else(|| units.past(&event.what));
        let (happening, level) = match &event.what {
            RecordedKind::Happening(happening) => (happening.clone(), Level::Fine),
            RecordedKind::Alarm(turn) => (Happening::Note(what.clone()), turn.level),
            RecordedKind::Remark(words) => (Happening::Note(words.clone()), Level::Fine),
        };
        // There are as many as there are: all of them stay.
        Arc::make_mut(&mut self.entries).push(LoggedEvent {
            wall_ns: event.at.wall_ns,
            tau: event.at.tau,
            what,
            happening,
            level,
            who: event.who.clone(),
            why: event.why.clone(),
        });
    }

    fn keep(&mut self, entry: LoggedEvent) {
        let entries = Arc::make_mut(&mut self.entries);
        if entries.len() >= KEPT {
            entries.remove(0);
        }
        entries.push(entry);
    }

    /// The entries, the oldest first.
    pub fn entries(&self) -> Arc<Vec<LoggedEvent>> {
        self.entries.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{bench_status, event};

    #[test]
    fn changes_are_told_in_words_and_once() {
        let mut settings = bench_status("three-mass", "composite").settings.get().clone();
        let mut log = EventLog::default();
        assert!(log.push(&event(1, &Happening::Started, &settings), &ScreenUnits::DIMENSIONLESS));
        settings.set("kd".parse().unwrap(), 0.1).unwrap();
        let change = event(2, &Happening::Settings, &settings);
        assert!(
            log.push(&change, &ScreenUnits::DIMENSIONLESS) && !log.push(&change, &ScreenUnits::DIMENSIONLESS),
            "told again to who attaches anew"
        );
        log.push(&event(3, &Happening::Note("here it hums".into()), &settings), &ScreenUnits::DIMENSIONLESS);
        let told: Vec<String> = log.entries().iter().map(|entry| entry.what.clone()).collect();
        assert_eq!(told[0], "started");
        assert!(told[1].contains("kd") && told[1].contains("-0.5879 -> 0.1"), "{told:?}");
        assert_eq!(told[2], "note: here it hums");
    }

    #[test]
    fn another_run_is_news_and_the_newest_stay() {
        let settings = bench_status("three-mass", "composite").settings.get().clone();
        let mut log = EventLog::default();
        for number in 1..=KEPT as u64 + 5 {
            log.push(&event(number, &Happening::Restarted, &settings), &ScreenUnits::DIMENSIONLESS);
        }
        let mut other = event(1, &Happening::Started, &settings);
        other.run_id = 8;
        assert!(log.push(&other, &ScreenUnits::DIMENSIONLESS));
        let entries = log.entries();
        assert_eq!((entries.len(), entries.last().unwrap().happening.clone()), (KEPT, Happening::Started));
    }
}
