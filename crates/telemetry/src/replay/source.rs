//! A source of the past: what the player needs of a recording, whatever it is kept in.

use std::ops::Range;

use alarms::{LevelChange, Limits};
use wire::{BenchStatus, Happening, Moment, State};

use crate::processes::OpaqueError;
use crate::units::ScreenUnits;

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedEvent {
    /// When; its step is the first made with it.
    pub at: Moment,
    /// What.
    pub what: RecordedKind,
    /// Who did it.
    pub who: String,
    /// Why; may be empty.
    pub why: String,
}

impl RecordedEvent {
    /// In a line, in the machine's `units`: what, by whom, why.
    pub(super) fn words(&self, units: &ScreenUnits) -> String {
        let Self { what, who, why, .. } = self;
        let by = if who.is_empty() || who == "sim" { String::new() } else { format!(" by {who}") };
        let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
        format!("{}{by}{why}", units.past(what))
    }
}

/// What happened.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordedKind {
    /// On the bench, as [`wire::Event`] tells it.
    Happening(Happening),
    /// Something went past its limit, or came back.
    Alarm(LevelChange),
    /// In the words of whoever recorded.
    Remark(String),
}

impl RecordedEvent {
    /// What happened on the bench, if that is what it tells of.
    pub fn happening(&self) -> Option<&Happening> {
        if let RecordedKind::Happening(happening) = &self.what { Some(happening) } else { None }
    }
}

impl std::fmt::Display for RecordedKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Happening(happening) => happening.fmt(f),
            Self::Alarm(turn) => turn.fmt(f),
            Self::Remark(words) => f.write_str(words),
        }
    }
}

/// Steps of one run, and what is known about them. Errors are in words, for the person at the terminal.
pub trait RecordingSource {
    /// What it is called: a file's name.
    fn name(&self) -> String;

    /// Its first step and its last; `None` if there is none.
    fn span(&self) -> Option<[Moment; 2]>;

    /// Visits every step there is with a number in `range`, in order, bit for bit as it was sent.
    ///
    /// # Errors
    /// It cannot be read.
    fn visit(&mut self, range: Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OpaqueError>;

    /// The bench status as it stood at step `seq`: rotor, settings, poles, trip, rate.
    fn bench_status_at(&mut self, seq: u64) -> Box<BenchStatus>;

    /// The first step made with each of the settings, ascending; the first may lie before the span.
    fn changes(&self) -> Vec<u64>;

    /// What happened, ascending in step; alarms among it, but for trips.
    fn events(&self) -> Vec<RecordedEvent>;

    /// Every turn of an alarm, trips among them, ascending in step.
    fn turns(&self) -> Vec<LevelChange>;

    /// What alarms were held against; `None` if nobody judged.
    fn limits(&self) -> Option<Limits>;

    /// Steps that are missing within the span, ascending.
    fn missing(&self) -> Vec<Range<u64>>;

    /// What a reader should be told: cut off, damaged, begun late.
    fn notices(&self) -> Vec<String>;

    /// All of the machine as [`machine::Machine::save`] wrote it just before some step, when all that happened before that step had
    /// been done, and the number of that step: the last one that is not after `seq`. `None` if there is none.
    ///
    /// # Errors
    /// It cannot be read.
    fn snapshot_before(&mut self, _seq: u64) -> Result<Option<(u64, Vec<u64>)>, OpaqueError> {
        Ok(None)
    }

    /// From which step on steps are how long, in `tau`, ascending, where they are not all as long as the bench status says.
    fn paces(&self) -> Vec<(u64, f64)> {
        Vec::new()
    }

    /// The last step at or before `tau`, in the latest stretch between two restarts that reaches it.
    ///
    /// # Errors
    /// It cannot be read.
    fn at_tau(&mut self, tau: f64) -> Result<u64, OpaqueError>;
}
