//! What a recording says in words: JSON documents beside the columns of numbers.
//!
//! Every field that a later version adds must be optional here, so that files without it stay readable. Numbers read back
//! to the last bit (`float_roundtrip` of serde_json); feedback is the text of its own file, which does so too.

use std::collections::BTreeMap;

use alarms::{Limits, Turn, Watch};
use rotor::file::{read_feedback, write_feedback};
use rotor::{C64, Mass, Rotor, Scales, Settings};
use serde::{Deserialize, Serialize};
use wire::message::Trip;
use wire::{Happening, Moment};

use crate::event::{Event, Remark, What};
use crate::schema::{self, Column};
use crate::session::{Revision, Session, Source};

/// A document that is not one of ours.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub(crate) struct BadDocument(String);

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
fn bad(error: impl ToString) -> BadDocument {
    BadDocument(error.to_string())
}

/// Any document as its text.
pub(crate) fn text(document: &impl Serialize) -> String {
    // Plain numbers and words: this cannot fail.
    serde_json::to_string(document).unwrap_or_default()
}

/// A document from its text.
pub(crate) fn parse<'a, D: Deserialize<'a>>(text: &'a str) -> Result<D, BadDocument> {
    serde_json::from_str(text).map_err(bad)
}

/// About the whole file.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SessionDocument {
    pub(crate) schema: u32,
    whirl: String,
    simulation: String,
    run_id: String,
    bench: String,
    source: String,
    started_ns: u64,
    rate_hz: f64,
    dtau: f64,
    /// What alarms are held against: warning and alarm, or null where there is no limit. Absent if nobody judges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alarm_limits: Option<BTreeMap<String, Option<[f64; 2]>>>,
    rotor: RotorDocument,
    columns: Vec<ColumnDocument>,
}

#[derive(Debug, Serialize, Deserialize)]
struct RotorDocument {
    name: String,
    /// Per mass, the values of [`rotor::FIELDS`] by their keys.
    masses: Vec<MassDocument>,
    shafts: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scales: Option<ScalesDocument>,
}

#[derive(Debug, Serialize, Deserialize)]
struct MassDocument {
    mass: f64,
    damping: f64,
    cross_damping: f64,
    bearing_stiffness: f64,
    seal_stiffness: f64,
    unbalance: f64,
    deadband: f64,
}

#[derive(Debug, Serialize, Deserialize)]
struct ScalesDocument {
    w0: f64,
    k_t: f64,
    m_t: f64,
    e_t: f64,
}

#[derive(Debug, Serialize, Deserialize)]
struct ColumnDocument {
    name: String,
    unit: String,
    meaning: String,
}

impl SessionDocument {
    pub(crate) fn new(session: &Session, rotor: &Rotor, scales: Option<Scales>) -> Self {
        let mass = |m: &Mass| {
            let Mass { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband } = *m;
            MassDocument { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
        };
        let column = |c: Column| ColumnDocument { name: c.name, unit: c.unit.to_owned(), meaning: c.meaning };
        Self {
            schema: session.schema,
            whirl: session.whirl.clone(),
            simulation: session.simulation.clone(),
            run_id: format!("{:016x}", session.run_id),
            bench: session.bench.clone(),
            source: session.source.name().to_owned(),
            started_ns: session.started_ns,
            rate_hz: session.rate_hz,
            dtau: session.dtau,
            alarm_limits: session.limits.as_ref().map(|limits| {
                let limited = Watch::ALL.into_iter().filter(|watch| watch.has_limits());
                limited.map(|watch| (watch.name().to_owned(), limits.pair(watch))).collect()
            }),
            rotor: RotorDocument {
                name: rotor.name().to_owned(),
                masses: rotor.masses().iter().map(mass).collect(),
                shafts: rotor.shafts().to_vec(),
                scales: scales.map(|Scales { w0, k_t, m_t, e_t }| ScalesDocument { w0, k_t, m_t, e_t }),
            },
            columns: schema::columns(rotor.len()).into_iter().map(column).collect(),
        }
    }

    /// How many masses the rotor has.
    pub(crate) fn masses(&self) -> usize {
        self.rotor.masses.len()
    }

    pub(crate) fn read(self) -> Result<(Session, Rotor, Option<Scales>), BadDocument> {
        let mass = |m: &MassDocument| {
            let MassDocument { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband } =
                *m;
            Mass { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
        };
        let RotorDocument { name, masses, shafts, scales } = self.rotor;
        let rotor = Rotor::new(&name, masses.iter().map(mass).collect(), shafts).map_err(bad)?;
        let scales = scales.map(|ScalesDocument { w0, k_t, m_t, e_t }| Scales { w0, k_t, m_t, e_t });
        let session = Session {
            schema: self.schema,
            whirl: self.whirl,
            simulation: self.simulation,
            run_id: u64::from_str_radix(&self.run_id, 16).map_err(bad)?,
            bench: self.bench,
            source: Source::of(&self.source),
            started_ns: self.started_ns,
            rate_hz: self.rate_hz,
            dtau: self.dtau,
            limits: self.alarm_limits.map(limits_of).transpose()?,
        };
        Ok((session, rotor, scales))
    }
}

fn limits_of(document: BTreeMap<String, Option<[f64; 2]>>) -> Result<Limits, BadDocument> {
    let mut limits = Limits::none();
    // What a later version watches beyond that is not ours to judge.
    let known = document.into_iter().filter_map(|(name, pair)| Some((name.parse::<Watch>().ok()?, pair)));
    for (watch, pair) in known {
        limits.set(watch, pair).map_err(|expected| bad(format!("limits of {watch}: expected {expected}")))?;
    }
    Ok(limits)
}

/// Settings, whole, and the poles under them.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct RevisionDocument {
    from: u64,
    revision: u64,
    who: String,
    #[serde(default)]
    why: String,
    speed: f64,
    trip: f64,
    deadband: Vec<f64>,
    /// The text of a feedback file.
    feedback: String,
    /// `[re, im]`, least damped first.
    poles: Vec<[f64; 2]>,
    min_damping: f64,
}

impl From<&Revision> for RevisionDocument {
    fn from(r: &Revision) -> Self {
        Self {
            from: r.from,
            revision: r.revision,
            who: r.who.clone(),
            why: r.why.clone(),
            speed: r.settings.speed,
            trip: r.settings.trip,
            deadband: r.settings.deadband.clone(),
            feedback: write_feedback(&r.settings.feedback),
            poles: r.poles.iter().map(|p| [p.re, p.im]).collect(),
            min_damping: r.min_damping,
        }
    }
}

impl RevisionDocument {
    pub(crate) fn read(self) -> Result<Revision, BadDocument> {
        let feedback = read_feedback(&self.feedback, Some(self.deadband.len())).map_err(bad)?;
        Ok(Revision {
            from: self.from,
            revision: self.revision,
            who: self.who,
            why: self.why,
            settings: Settings { speed: self.speed, deadband: self.deadband, trip: self.trip, feedback },
            poles: self.poles.into_iter().map(|[re, im]| C64::new(re, im)).collect(),
            min_damping: self.min_damping,
        })
    }
}

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

impl From<&Turn> for AlarmDocument {
    fn from(turn: &Turn) -> Self {
        let Turn { watch, before, level, value, limit, worst, .. } = turn;
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
    fn read(&self, at: Moment) -> Option<Turn> {
        Some(Turn {
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
pub(crate) enum Told {
    /// The bench.
    Event(Event),
    /// The recorder.
    Remark(Remark),
}

impl EventDocument {
    pub(crate) fn read(self) -> Told {
        let at = Moment { seq: self.seq, tau: self.tau, wall_ns: self.wall_ns };
        let count = |i: usize| self.count.get(i).copied().unwrap_or_default();
        let remark = |what| Told::Remark(Remark { at, what });
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
            other => return remark(What::Other(format!("{other} {}", self.text).trim().to_owned())),
        };
        Told::Event(Event {
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
