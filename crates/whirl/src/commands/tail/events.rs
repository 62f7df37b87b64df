//! `whirl tail --events`: what has happened on a bench, and what happens, one line an event.

use rotor::{ChangedValue, ControlMasses, Difference, Rotor, Settings};
use serde::Serialize;
use serde_json::{Map, Value};
use wire::message::Trip;
use wire::{Event, EventMessage, Happening};

use crate::output::{padded, rounded};
use crate::units::CommandUnits;

/// One JSON line.
#[derive(Debug, Serialize)]
struct EventLine<'a> {
    number: u64,
    /// Events that came before this one, after the line before it, and did not reach us.
    lost: u64,
    event: &'static str,
    seq: u64,
    tau: f64,
    wall_ns: u64,
    who: &'a str,
    why: &'a str,
    text: String,
    #[serde(flatten)]
    detail: Detail,
    revision: u64,
    settings: Map<String, Value>,
    run_id: String,
}

/// What only some events have.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Detail {
    Plain {},
    Settings { changed: Option<Vec<String>> },
    Impulse { mass: usize, vy: f64, vz: f64 },
    Tripped { cause: &'static str, mass: u32, radius: f64, limit: f64 },
    Late { late: u64, missed: u64 },
}

/// Puts events in words. It remembers the settings after the last one, to say what the next one changes.
#[derive(Debug, Default)]
pub(super) struct Teller {
    last: Option<(u64, u64, Settings)>,
    /// For forces in newtons.
    rotor: Option<Rotor>,
    /// Events whose numbers are missing.
    pub(super) lost: u64,
}

impl Teller {
    /// Tells of a bench on which this rotor runs.
    pub(super) fn of(rotor: Option<&Rotor>) -> Self {
        Self { rotor: rotor.cloned(), ..Self::default() }
    }

    /// The line of one event, without its end.
    pub(super) fn line(&mut self, event: &Event, units: CommandUnits, json: bool) -> String {
        let settings = event.settings.get().clone();
        let known = self.last.take().filter(|(run_id, ..)| *run_id == event.run_id);
        let lost = known.as_ref().map_or(0, |(_, number, _)| event.number.saturating_sub(number + 1));
        self.lost += lost;
        let changed = known.map(|(.., before)| Difference::between(&before, &settings));
        let happening = event.happening();
        let masses = self.rotor.as_ref().map(|rotor| ControlMasses::of(rotor, &settings.feedback));
        let units = (units, masses.unwrap_or_default());
        let line = if json {
            let line = document(event, lost, happening.as_ref(), changed.as_ref(), &settings);
            // A line of plain numbers and words always serialises.
            serde_json::to_string(&line).unwrap_or_default()
        } else {
            super::gap(lost, "events") + &for_people(event, happening.as_ref(), changed.as_ref(), units)
        };
        self.last = Some((event.run_id, event.number, settings));
        line
    }
}

/// `speed 2.5 -> 3`, in the units of the machine.
fn words(difference: &Difference, (units, masses): (CommandUnits, ControlMasses)) -> Vec<String> {
    let values = difference.values.iter();
    let values = values.map(|ChangedValue { key, label, was, is }| {
        let [was, is] = [*was, *is].map(|value| units.value(masses, *key, value));
        let unit = units.name_of(masses, *key);
        format!("{label} {} -> {}{unit}", plain(was), plain(is))
    });
    values.chain(difference.law.then(|| "another feedback".to_owned())).collect()
}

/// A number as it was typed; conversion leaves dust behind the sixth digit.
fn plain(number: f64) -> String {
    let short = number.to_string();
    if short.len() <= 10 { short } else { rounded(number) }
}

fn for_people(
    event: &Event,
    happening: Option<&Happening>,
    changed: Option<&Difference>,
    units: (CommandUnits, ControlMasses),
) -> String {
    let mut words_of = match (happening, changed) {
        (Some(Happening::Settings), Some(changed)) if !changed.is_empty() => words(changed, units).join(", "),
        (Some(happening), _) => happening.told(units.0.scales()),
        (None, _) => format!("unknown event {}", event.kind),
    };
    let why = event.why.as_str();
    if !why.is_empty() {
        words_of += &format!(" ({why})");
    }
    let EventMessage { number, seq, tau, .. } = **event;
    format!("{number:>4}  step {seq:>9}  tau {tau:>10.3}  {}  {words_of}", padded(event.who.as_str(), 12))
}

fn document<'a>(
    event: &'a Event,
    lost: u64,
    happening: Option<&Happening>,
    changed: Option<&Difference>,
    settings: &Settings,
) -> EventLine<'a> {
    let number = |key| Value::from(settings.get(key).ok());
    let values = settings.keys().into_iter().map(|key| (key.to_string(), number(key)));
    EventLine {
        number: event.number,
        lost,
        event: happening.map_or("unknown", Happening::name),
        seq: event.seq,
        tau: event.tau,
        wall_ns: event.wall_ns,
        who: event.who.as_str(),
        why: event.why.as_str(),
        text: match happening {
            Some(Happening::Note(text)) => text.clone(),
            Some(happening) => happening.to_string(),
            None => String::new(),
        },
        detail: match happening {
            Some(Happening::Settings) => Detail::Settings {
                changed: changed.map(|changed| words(changed, (CommandUnits::with(None), ControlMasses::default()))),
            },
            Some(Happening::Impulse { mass, velocity }) => {
                Detail::Impulse { mass: mass + 1, vy: velocity.re, vz: velocity.im }
            }
            Some(Happening::Tripped(Trip { cause, mass, radius, limit, .. })) => Detail::Tripped {
                cause: match *cause {
                    1 => "limit",
                    3 => "no command",
                    4 => "coast-down",
                    _ => "not finite",
                },
                mass: *mass,
                radius: *radius,
                limit: *limit,
            },
            Some(Happening::Late { late, missed }) => Detail::Late { late: *late, missed: *missed },
            _ => Detail::Plain {},
        },
        revision: event.revision,
        settings: values.collect(),
        run_id: format!("{:016x}", event.run_id),
    }
}
