//! What happened during a session, and when: the events of the bench, and the recorder's own remarks.

use alarms::{Level, LevelChange, Watch};
use wire::message::Trip;
use wire::{Happening, Moment};

/// Something that happened on the bench: a [`wire::Event`] without the settings, which [`crate::Revision`]s hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When, as the bench counts it: see the fields of [`wire::Event`].
    pub at: Moment,
    /// Its number in the run.
    pub number: u64,
    /// Revision of the settings in force after it.
    pub revision: u64,
    /// What happened.
    pub happening: Happening,
    /// Who did it.
    pub who: String,
    /// Why; may be empty.
    pub why: String,
    /// Which settings it changed, from what to what; empty if none.
    pub change: String,
}

impl Event {
    /// One line for people: what, by whom, why.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.happening.to_string();
        if !self.change.is_empty() {
            text = format!("{text}: {}", self.change);
        }
        if !self.who.is_empty() && self.who != "sim" {
            text = format!("{text} by {}", self.who);
        }
        if !self.why.is_empty() {
            text = format!("{text} ({})", self.why);
        }
        text
    }
}

impl From<&wire::Event> for Event {
    fn from(event: &wire::Event) -> Self {
        Self {
            at: event.into(),
            number: event.number,
            revision: event.revision,
            // A kind that this version does not know is not sent to it: the schema version keeps the two apart.
            happening: event.happening().unwrap_or_else(|| Happening::Note(format!("event of kind {}", event.kind))),
            who: event.who.as_str().to_owned(),
            why: event.why.as_str().to_owned(),
            change: String::new(),
        }
    }
}

/// Something that the recorder itself has to say.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// When.
    pub at: Moment,
    /// What.
    pub what: What,
}

/// What a recorder has to say.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// The file begins here.
    Begins,
    /// So many steps before this one did not reach the recorder, or not the file.
    Lost(u64),
    /// The file ends here as it should, for this reason.
    Ends(String),
    /// The file ends here as it should, and the recording goes on in the next, which has this name.
    Continues(String),
    /// Something went past one of the limits of alarms, or came back.
    Alarm(LevelChange),
    /// What a later version has to say.
    Other(String),
}

impl Remark {
    /// One line for people.
    #[must_use]
    pub fn text(&self) -> String {
        match &self.what {
            What::Begins => "recording begins".to_owned(),
            What::Lost(count) => format!("{count} steps lost"),
            What::Ends(why) => format!("recording ends: {why}"),
            What::Continues(next) => format!("recording goes on in {next}"),
            What::Alarm(turn) => turn.to_string(),
            What::Other(what) => what.clone(),
        }
    }
}

/// A trip, or the restart after one, as the turn of an alarm: recordings hold them as events already.
pub(crate) fn turn_of(at: Moment, tripped: Option<&Trip>) -> LevelChange {
    let on = tripped.is_some();
    let [level, before] = if on { [Level::Alarm, Level::Fine] } else { [Level::Fine, Level::Alarm] };
    let cause = tripped.map_or_else(String::new, ToString::to_string);
    LevelChange { at, watch: Watch::Trip, before, level, value: f64::from(u8::from(on)), limit: 0.5, worst: 1.0, cause }
}
