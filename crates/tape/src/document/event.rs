//! What happened, as documents: events of the bench, and what the recorder had to say.

use alarms::LevelChange;
use rotor::C64;
use serde::{Deserialize, Serialize};
use wire::message::Trip;
use wire::{Happening, Moment};

use crate::event::{Event, Remark, What};

/// An event of the bench, or a remark of the recorder: those have the kinds `begins`, `lost`, `ends`, `continues` and
/// `alarm`.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct EventDocument {
    kind: String,
    seq: u64,
    tau: f64,
    wall_ns: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    number: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    revision: Option<u64>,
    #[serde(skip_serializing_if = "String::is_empty")]
    who: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    why: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    change: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    text: String,
    /// Refused: what was asked for.
    #[serde(skip_serializing_if = "String::is_empty")]
    asked: String,
    /// Counted from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    mass: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trip: Option<TripDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alarm: Option<AlarmDocument>,
    /// Late: steps late, deadlines given up. Lost: steps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    count: Vec<u64>,
}

#[derive(Debug, Serialize, Deserialize)]
struct TripDocument {
    cause: u32,
    mass: u32,
    step: u64,
    radius: f64,
    limit: f64,
}

/// A turn of an alarm: names as [`alarms::Watch`] and [`alarms::Level`] have them.
#[derive(Debug, Serialize, Deserialize)]
struct AlarmDocument {
    watch: String,
    before: String,
    level: String,
    value: f64,
    limit: f64,
    worst: f64,
}

impl From<&LevelChange> for AlarmDocument {
    fn from(turn: &LevelChange) -> Self {
        let LevelChange { watch, before, level, value, limit, worst, .. } = turn;
        Self {
            watch: watch.name().to_owned(),
            before: before.name().to_owned(),
            level: level.name().to_owned(),
            value: *value,
            limit: *limit,
            worst: *worst,
        }
    }
}

impl AlarmDocument {
    /// `None` if it is of something that this version does not watch.
    fn read(&self, at: Moment) -> Option<LevelChange> {
        Some(LevelChange {
            at,
            watch: self.watch.parse().ok()?,
            before: self.before.parse().ok()?,
            level: self.level.parse().ok()?,
            value: self.value,
            limit: self.limit,
            worst: self.worst,
            cause: String::new(),
        })
    }
}

impl From<&Event> for EventDocument {
    fn from(e: &Event) -> Self {
        let Moment { seq, tau, wall_ns } = e.at;
        let mut document = Self {
            kind: e.happening.name().to_owned(),
            seq,
            tau,
            wall_ns,
            number: Some(e.number),
            revision: Some(e.revision),
            who: e.who.clone(),
            why: e.why.clone(),
            change: e.change.clone(),
            ..Self::default()
        };
        match &e.happening {
            Happening::Refused { asked, reason } => {
                document.asked = (*asked).to_owned();
                document.text.clone_from(reason);
            }
            Happening::Impulse { mass, velocity } => {
                document.mass = Some(mass + 1);
                document.velocity = Some([velocity.re, velocity.im]);
            }
            Happening::Tripped(Trip { cause, mass, step, radius, limit }) => {
                let (cause, mass, step, radius, limit) = (*cause, *mass, *step, *radius, *limit);
                document.trip = Some(TripDocument { cause, mass, step, radius, limit });
            }
            Happening::Late { late, missed } => document.count = vec![*late, *missed],
            Happening::Note(text) => document.text.clone_from(text),
            Happening::Excited(multisine) => document.text = multisine.to_string(),
            _ => {}
        }
        document
    }
}

impl From<&Remark> for EventDocument {
    fn from(r: &Remark) -> Self {
        let Moment { seq, tau, wall_ns } = r.at;
        let (kind, text, count) = match &r.what {
            What::Begins => ("begins", "", vec![]),
            What::Lost(count) => ("lost", "", vec![*count]),
            What::Ends(why) => ("ends", why.as_str(), vec![]),
            What::Continues(next) => ("continues", next.as_str(), vec![]),
            What::Alarm(_) => ("alarm", "", vec![]),
            What::Other(text) => ("other", text.as_str(), vec![]),
        };
        // Older versions know no alarms, and show the words of what they do not know.
        let (text, alarm) = match &r.what {
            What::Alarm(turn) => (turn.to_string(), Some(turn.into())),
            _ => (text.to_owned(), None),
        };
        Self { kind: kind.to_owned(), seq, tau, wall_ns, text, count, alarm, ..Self::default() }
    }
}

/// The name of a kind of request, among those that this version knows.
fn request_name(name: &str) -> &'static str {
    (1..16).map(wire::Change::kind_name).find(|known| *known == name).unwrap_or_else(|| wire::Change::kind_name(0))
}

/// What an [`EventDocument`] tells of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EventOrRemark {
    /// The bench.
    Event(Event),
    /// The recorder.
    Remark(Remark),
}

impl EventDocument {
    pub(crate) fn read(self) -> EventOrRemark {
        let at = Moment { seq: self.seq, tau: self.tau, wall_ns: self.wall_ns };
        let count = |i: usize| self.count.get(i).copied().unwrap_or_default();
        let remark = |what| EventOrRemark::Remark(Remark { at, what });
        let happening = match self.kind.as_str() {
            "begins" => return remark(What::Begins),
            "lost" => return remark(What::Lost(count(0))),
            "ends" => return remark(What::Ends(self.text)),
            "continues" => return remark(What::Continues(self.text)),
            "alarm" => {
                let turn = self.alarm.and_then(|alarm| alarm.read(at));
                return remark(turn.map_or(What::Other(self.text), What::Alarm));
            }
            "started" => Happening::Started,
            "settings" => Happening::Settings,
            "refused" => Happening::Refused { asked: request_name(&self.asked), reason: self.text },
            "impulse" => {
                let [re, im] = self.velocity.unwrap_or_default();
                Happening::Impulse { mass: self.mass.unwrap_or(1).max(1) - 1, velocity: C64::new(re, im) }
            }
            "restarted" => Happening::Restarted,
            "tripped" => Happening::Tripped(self.trip.map_or_else(Trip::default, |t| Trip {
                cause: t.cause,
                mass: t.mass,
                step: t.step,
                radius: t.radius,
                limit: t.limit,
            })),
            "late" => Happening::Late { late: count(0), missed: count(1) },
            "note" => Happening::Note(self.text),
            "ended" => Happening::Ended,
            "excited" => match self.text.parse() {
                Ok(multisine) => Happening::Excited(multisine),
                Err(error) => return remark(What::Other(error.to_string())),
            },
            "excitation over" => Happening::ExcitationOver,
            other => return remark(What::Other(format!("{other} {}", self.text).trim().to_owned())),
        };
        EventOrRemark::Event(Event {
            at,
            number: self.number.unwrap_or_default(),
            revision: self.revision.unwrap_or_default(),
            happening,
            who: self.who,
            why: self.why,
            change: self.change,
        })
    }
}
