//! What a recording says in words: JSON documents beside the columns of numbers.
//!
//! Every field that a later version adds must be optional here, so that files without it stay readable. Numbers read back
//! to the last bit (`float_roundtrip` of serde_json); feedback is the text of its own file, which does so too.

pub(crate) mod event;

use std::collections::BTreeMap;

use alarms::{Limits, Watch};
use rotor::file::{read_feedback, read_rotor, write_feedback, write_rotor};
use rotor::{C64, Mass, Rotor, Scales, Settings};
use serde::{Deserialize, Serialize};
use wire::StepLayout;

use crate::schema::{self, NumberColumn};
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

fn one_bearing() -> usize {
    1
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
    /// How many control bearings there are; one in recordings made before there could be more.
    #[serde(default = "one_bearing")]
    bearings: usize,
    /// What alarms are held against: warning and alarm, or null where there is no limit. Absent if nobody judges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alarm_limits: Option<BTreeMap<String, Option<[f64; 2]>>>,
    /// What of it has limits that follow the machine's settings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    alarm_limits_of_machine: Vec<String>,
    rotor: RotorDocument,
    columns: Vec<ColumnDocument>,
}

#[derive(Debug, Serialize, Deserialize)]
struct RotorDocument {
    name: String,
    /// Per mass, the values of [`rotor::FIELDS`] by their keys; none of a rotor of shaft elements.
    masses: Vec<MassDocument>,
    shafts: Vec<f64>,
    /// A rotor of shaft elements or matrices as its file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drawing: Option<DrawingDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scales: Option<ScalesDocument>,
}

#[derive(Debug, Serialize, Deserialize)]
struct DrawingDocument {
    /// How many stations move: each has columns of its own.
    stations: usize,
    /// The text of the rotor's file.
    file: String,
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
        let column = |c: NumberColumn| ColumnDocument { name: c.name, unit: c.unit.to_owned(), meaning: c.meaning };
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
            bearings: session.bearings,
            alarm_limits: session.limits.as_ref().map(|limits| {
                let limited = Watch::ALL.into_iter().filter(|watch| watch.has_limits());
                limited.map(|watch| (watch.name().to_owned(), limits.pair(watch))).collect()
            }),
            alarm_limits_of_machine: session.limits.as_ref().map_or_else(Vec::new, |limits| {
                let following = Watch::ALL.into_iter().filter(|watch| limits.follows(*watch));
                following.map(|watch| watch.name().to_owned()).collect()
            }),
            rotor: RotorDocument {
                name: rotor.name().to_owned(),
                masses: rotor.masses().iter().map(mass).collect(),
                shafts: rotor.shafts().to_vec(),
                drawing: rotor.beam().map(|_| DrawingDocument { stations: rotor.len(), file: write_rotor(rotor) }),
                scales: scales.map(|Scales { w0, k_t, m_t, e_t }| ScalesDocument { w0, k_t, m_t, e_t }),
            },
            columns: schema::columns(StepLayout::new(rotor.len()).with_bearings(session.bearings))
                .into_iter()
                .map(column)
                .collect(),
        }
    }

    /// How many masses, or stations that move, the rotor has.
    pub(crate) fn masses(&self) -> usize {
        self.rotor.drawing.as_ref().map_or(self.rotor.masses.len(), |drawing| drawing.stations)
    }

    pub(crate) fn read(self) -> Result<(Session, Rotor, Option<Scales>), BadDocument> {
        let mass = |m: &MassDocument| {
            let MassDocument { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband } =
                *m;
            Mass { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
        };
        let RotorDocument { name, masses, shafts, drawing, scales } = self.rotor;
        let rotor = match drawing {
            None => Rotor::new(&name, masses.iter().map(mass).collect(), shafts).map_err(bad)?,
            Some(DrawingDocument { stations, file }) => {
                let rotor = read_rotor(&file, &name).map_err(bad)?;
                if rotor.len() != stations {
                    return Err(bad(format!(
                        "a rotor of {} stations: expected the {stations} that its head names",
                        rotor.len()
                    )));
                }
                rotor
            }
        };
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
            limits: self.alarm_limits.map(|set| limits_of(set, &self.alarm_limits_of_machine)).transpose()?,
            bearings: self.bearings,
        };
        Ok((session, rotor, scales))
    }
}

fn limits_of(document: BTreeMap<String, Option<[f64; 2]>>, of_machine: &[String]) -> Result<Limits, BadDocument> {
    let mut limits = Limits::none();
    // What a later version watches beyond that is not ours to judge.
    let known = document.into_iter().filter_map(|(name, pair)| Some((name.parse::<Watch>().ok()?, pair)));
    for (watch, pair) in known {
        limits.set(watch, pair).map_err(|expected| bad(format!("limits of {watch}: expected {expected}")))?;
    }
    let following = of_machine.iter().filter_map(|name| name.parse::<Watch>().ok());
    Ok(following.fold(limits, Limits::following))
}

fn one() -> u32 {
    1
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
    /// Greatest rate of change of the speed; absent where it jumps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ramp: Option<f64>,
    /// Rate at which the speed falls at first after a trip; absent where the machine is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coast_down: Option<f64>,
    deadband: Vec<f64>,
    /// Absent where none is added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    unbalance_added: Option<Vec<f64>>,
    /// Runge-Kutta steps that make one step; before it was told it was one.
    #[serde(default = "one")]
    substeps: u32,
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
            ramp: Some(r.settings.ramp).filter(|ramp| ramp.is_finite()),
            coast_down: Some(r.settings.coast_down).filter(|rate| *rate != 0.0),
            deadband: r.settings.deadband.clone(),
            unbalance_added: Some(r.settings.unbalance_added.clone())
                .filter(|added| added.iter().any(|added| *added != 0.0)),
            substeps: r.substeps,
            feedback: write_feedback(&r.settings.feedback),
            poles: r.poles.iter().map(|p| [p.re, p.im]).collect(),
            min_damping: r.min_damping,
        }
    }
}

impl RevisionDocument {
    pub(crate) fn read(self) -> Result<Revision, BadDocument> {
        let feedback = read_feedback(&self.feedback, Some(self.deadband.len())).map_err(bad)?;
        let unbalance_added = self.unbalance_added.unwrap_or_else(|| vec![0.0; self.deadband.len()]);
        Ok(Revision {
            from: self.from,
            revision: self.revision,
            who: self.who,
            why: self.why,
            substeps: self.substeps.max(1),
            settings: Settings {
                speed: self.speed,
                deadband: self.deadband,
                trip: self.trip,
                ramp: self.ramp.unwrap_or(f64::INFINITY),
                coast_down: self.coast_down.unwrap_or(0.0),
                feedback,
                unbalance_added,
            },
            poles: self.poles.into_iter().map(|[re, im]| C64::new(re, im)).collect(),
            min_damping: self.min_damping,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_two_bearings() -> Session {
        Session {
            schema: schema::VERSION,
            whirl: "0.1.0".into(),
            simulation: "0.1.0".into(),
            run_id: 7,
            bench: "rig".into(),
            source: Source::Live,
            started_ns: 1,
            rate_hz: 1000.0,
            dtau: 0.01,
            bearings: 2,
            limits: None,
        }
    }

    #[test]
    fn every_rotor_comes_back_from_a_head_with_its_stations_and_numbers() {
        for name in rotor::builtin::ROTORS {
            let rotor = rotor::builtin::rotor(name).unwrap();
            let session = of_two_bearings();
            let written = text(&SessionDocument::new(&session, &rotor, rotor.scales().copied()));
            let document = parse::<SessionDocument>(&written).unwrap();
            assert_eq!(document.masses(), rotor.len(), "{name}");
            assert_eq!(document.read().unwrap(), (session, rotor.clone(), rotor.scales().copied()), "{name}");
        }
        let rig = rotor::builtin::rotor("rig").unwrap();
        let written = text(&SessionDocument::new(&of_two_bearings(), &rig, None));
        let fewer = written.replace("\"stations\":12", "\"stations\":11");
        assert_ne!(fewer, written);
        let told = parse::<SessionDocument>(&fewer).unwrap().read().unwrap_err().to_string();
        assert_eq!(told, "a rotor of 12 stations: expected the 11 that its head names");
    }

    #[test]
    fn settings_recorded_before_there_were_substeps_were_stepped_with_one() {
        let rotor = rotor::builtin::rotor("jeffcott").unwrap();
        let settings = Settings::new(&rotor, 300.0, rotor::builtin::feedback(&rotor, "cancel").unwrap());
        let revision = crate::sink::revision_of(Some(&rotor), 1, 0, ("sim", ""), settings, 17);
        let written = text(&RevisionDocument::from(&revision));
        assert_eq!(parse::<RevisionDocument>(&written).unwrap().read().unwrap(), revision);
        let earlier = written.replace("\"substeps\":17,", "");
        assert_ne!(earlier, written);
        assert_eq!(parse::<RevisionDocument>(&earlier).unwrap().read().unwrap().substeps, 1);
    }
}
