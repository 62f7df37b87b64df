//! What happens on a bench, one message each: who changed what and why, trips, notes, restarts, lost pace.
//!
//! Events are numbered, so that a loss shows, and the last [`EVENTS_KEPT`] of them reach readers that come later. Each
//! names the settings in force after it, whose document is sent before it: whoever reads them can put any earlier ones back.

use std::fmt;
use std::ops::{Deref, DerefMut};

use control::Multisine;
use rotor::{C64, Scales};
use text::number::significant;
use units::{Dimension, Units};

use crate::document::SettingsDocument;
use crate::message::Trip;
use crate::wire_struct::message;
use crate::{Change, Text};
use iceoryx2::prelude::ZeroCopySend;

/// How many events a reader that comes late is told, and how many wait for one that sleeps.
pub const EVENTS_KEPT: usize = 64;

message! {
    "whirl.Event"
    /// Something that has happened. [`EventMessage::happening`] says what; [`Event`] is it with the settings in force after it.
    pub struct EventMessage {
        /// Which run of which process: as in the steps.
        pub run_id: u64,
        /// Number of this event in its run: 1 is the start, and each further one is up by 1.
        pub number: u64,
        /// The first step made with it; for a trip the step that tripped; for what is no order (a refusal, lost pace, the
        /// end) the next step to be made when it was noticed.
        pub seq: u64,
        /// Time of the rotor when it happened: for an order that of the step before `seq`, 0 after a restart.
        pub tau: f64,
        /// Wall clock when it was noted, nanoseconds since 1970.
        pub wall_ns: u64,
        /// Revision of the settings in force after it.
        pub revision: u64,
        /// Hash of the document of those settings.
        pub settings: u64,
        /// 1 started, 2 settings, 3 refused, 4 impulse, 5 restarted, 6 tripped, 7 late, 8 note, 9 ended, 10 excited, 11 excitation
        /// over.
        pub kind: u32,
        /// Impulse: the mass, counted from 0. Refused: the kind of the request (see [`crate::message::RequestMessage::kind`]).
        pub detail: u32,
        /// Runge-Kutta steps that make one step under `settings`, as [`crate::message::BenchStatusMessage::substeps`].
        pub substeps: u32,
        /// Always 0.
        pub reserved: u32,
        /// Impulse: change of velocity `[vy, vz]`.
        pub impulse: [f64; 2],
        /// Tripped: what tripped.
        pub trip: Trip,
        /// Late: steps sent late, and deadlines given up, since the last such event.
        pub late: [u64; 2],
        /// Who did it; `sim` for what the simulation did by itself.
        pub who: Text<32>,
        /// Why, in the words of who asked: `undo`, `typed`, or a reason that a person gave. May be empty.
        pub why: Text<120>,
        /// Note: what it says. Refused: the reason. Excited: the tones, as in [`crate::message::RequestMessage::text`].
        pub text: Text<240>,
    }
}

/// An event as it is read: the message, with the settings that it names.
#[derive(Clone, Debug, Default)]
pub struct Event {
    message: EventMessage,
    /// The settings in force after it.
    pub settings: SettingsDocument,
}

impl Event {
    pub(crate) fn resolved(message: EventMessage, settings: SettingsDocument) -> Self {
        Self { message, settings }
    }

    /// The message, which names the settings.
    #[must_use]
    pub fn message(&self) -> EventMessage {
        EventMessage { settings: self.settings.hash(), ..self.message }
    }
}

impl From<EventMessage> for Event {
    fn from(message: EventMessage) -> Self {
        Self { message, settings: SettingsDocument::default() }
    }
}

impl Deref for Event {
    type Target = EventMessage;

    fn deref(&self) -> &EventMessage {
        &self.message
    }
}

impl DerefMut for Event {
    fn deref_mut(&mut self) -> &mut EventMessage {
        &mut self.message
    }
}

/// What has happened, as people think of it; [`Happening::event`] packs it.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// The simulation began.
    Started,
    /// New settings came into force.
    Settings,
    /// A request was refused. (One based on settings that had changed meanwhile is asked anew, and makes no event.)
    Refused {
        /// What was asked for: settings, an impulse ...
        asked: &'static str,
        /// Why it was refused.
        reason: String,
    },
    /// A change of velocity of one mass.
    Impulse {
        /// The mass, counted from 0.
        mass: usize,
        /// The change, in `e_t` per unit of `tau`.
        velocity: C64,
    },
    /// Back to rest at `tau = 0`.
    Restarted,
    /// The machine tripped, and is held since, or coasts down.
    Tripped(Trip),
    /// The simulation fell behind its pace. Told once a burst: at once, then ever more seldom while it goes on.
    Late {
        /// Steps sent late since the last such event.
        late: u64,
        /// Deadlines given up since then.
        missed: u64,
    },
    /// A marker with a note.
    Note(String),
    /// The simulation ended in good order.
    Ended,
    /// Tones are added to the loop's command from here on.
    Excited(Multisine),
    /// They no longer are: their time was over, somebody ended them, or a change, a restart or a trip did.
    ExcitationOver,
}

impl EventMessage {
    /// What has happened; `None` for a kind that this version does not know.
    #[must_use]
    pub fn happening(&self) -> Option<Happening> {
        let text = || self.text.as_str().to_owned();
        Some(match self.kind {
            1 => Happening::Started,
            2 => Happening::Settings,
            3 => Happening::Refused { asked: Change::kind_name(self.detail), reason: text() },
            4 => {
                Happening::Impulse { mass: self.detail as usize, velocity: C64::new(self.impulse[0], self.impulse[1]) }
            }
            5 => Happening::Restarted,
            6 => Happening::Tripped(self.trip),
            7 => Happening::Late { late: self.late[0], missed: self.late[1] },
            8 => Happening::Note(text()),
            9 => Happening::Ended,
            10 => Happening::Excited(self.text.as_str().parse().ok()?),
            11 => Happening::ExcitationOver,
            _ => return None,
        })
    }
}

impl Happening {
    /// The message that tells of this; where, when, who and the settings are still to be filled in.
    #[must_use]
    pub fn event(&self) -> Box<Event> {
        let mut event = Box::<Event>::default();
        event.kind = match self {
            Self::Started => 1,
            Self::Settings => 2,
            Self::Refused { asked, reason } => {
                event.detail = Change::kind_of_name(asked);
                event.text = Text::new(reason);
                3
            }
            Self::Impulse { mass, velocity } => {
                event.detail = *mass as u32;
                event.impulse = [velocity.re, velocity.im];
                4
            }
            Self::Restarted => 5,
            Self::Tripped(trip) => {
                event.trip = *trip;
                6
            }
            Self::Late { late, missed } => {
                event.late = [*late, *missed];
                7
            }
            Self::Note(text) => {
                event.text = Text::new(text);
                8
            }
            Self::Ended => 9,
            Self::Excited(multisine) => {
                event.text = Text::new(&multisine.to_string());
                10
            }
            Self::ExcitationOver => 11,
        };
        event
    }

    /// One word for it, as scripts read it: `started`, `settings`, `refused`, `impulse`, `restarted`, `tripped`, `late`,
    /// `note`, `ended`, `excited`, `excitation over`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Started => "started",
            Self::Settings => "settings",
            Self::Refused { .. } => "refused",
            Self::Impulse { .. } => "impulse",
            Self::Restarted => "restarted",
            Self::Tripped(_) => "tripped",
            Self::Late { .. } => "late",
            Self::Note(_) => "note",
            Self::Ended => "ended",
            Self::Excited(_) => "excited",
            Self::ExcitationOver => "excitation over",
        }
    }
}

impl Happening {
    /// In words, in metres and metres a second where the rotor has scales.
    #[must_use]
    pub fn told(&self, scales: Option<Scales>) -> String {
        match (self, scales) {
            (Self::Tripped(trip), scales) => format!("tripped: {}", trip.told(scales)),
            (Self::Impulse { mass, velocity }, Some(scales)) => {
                let units = Units::of(Some(scales), 1.0);
                let [vy, vz] =
                    [velocity.re, velocity.im].map(|part| significant(units.shown(Dimension::Velocity, part), 6));
                format!("impulse on mass {}: vy {vy} m/s, vz {vz} m/s", mass + 1)
            }
            (Self::Excited(multisine), scales) => excited(multisine, Units::of(scales, 1.0)),
            _ => self.to_string(),
        }
    }
}

/// `excited by 40 tones from 0.126 to 5.03, for 250 tau`.
fn excited(multisine: &Multisine, units: Units) -> String {
    let tones = multisine.tones().unwrap_or_default();
    let sizes = || tones.iter().map(|tone| tone.frequency.abs());
    let told = |dimension, value| significant(units.shown(dimension, value), 3);
    let [from, to] = [sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)];
    let [from, to] = [from, to].map(|frequency| told(Dimension::Frequency, frequency));
    let unit = |dimension| match units.unit(dimension).name {
        "" => String::new(),
        name => format!(" {name}"),
    };
    let time = told(Dimension::Time, multisine.duration);
    let [per, lasts] = [unit(Dimension::Frequency), unit(Dimension::Time)];
    format!("excited by {} tones from {from} to {to}{per}, for {time}{lasts}", tones.len())
}

impl fmt::Display for Happening {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Started => f.write_str("started"),
            Self::Settings => f.write_str("settings changed"),
            Self::Refused { asked, reason } => write!(f, "{asked} refused: {reason}"),
            Self::Impulse { mass, velocity } => {
                write!(f, "impulse on mass {}: vy {}, vz {}", mass + 1, velocity.re, velocity.im)
            }
            Self::Restarted => f.write_str("restarted from rest"),
            Self::Tripped(trip) => write!(f, "tripped: {trip}"),
            Self::Late { late, missed } => write!(f, "fell behind: {late} steps late, {missed} deadlines given up"),
            Self::Note(text) => write!(f, "note: {text}"),
            Self::Ended => f.write_str("ended"),
            Self::Excited(multisine) => f.write_str(&excited(multisine, Units::DIMENSIONLESS)),
            Self::ExcitationOver => f.write_str("excitation over"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_happening_survives_the_journey() {
        let trip = Trip { cause: 1, mass: 2, step: 77, radius: 5.25, limit: 5.0 };
        let all = [
            Happening::Started,
            Happening::Settings,
            Happening::Refused { asked: "impulse", reason: "no mass 4".into() },
            Happening::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) },
            Happening::Restarted,
            Happening::Tripped(trip),
            Happening::Late { late: 120, missed: 7 },
            Happening::Note("here it begins".into()),
            Happening::Ended,
            Happening::Excited(Multisine {
                seed: 1,
                period: 50.0,
                lines: [1, 40],
                tones: 20,
                away_from: 2.5,
                amplitude: 0.125,
                duration: 250.0,
            }),
            Happening::ExcitationOver,
        ];
        let mut kinds = Vec::new();
        for happening in all {
            let event = happening.event();
            kinds.push(event.kind);
            assert_eq!(event.happening().as_ref(), Some(&happening));
        }
        assert_eq!(kinds, (1..=11).collect::<Vec<_>>());
        let foreign = |kind| EventMessage { kind, ..EventMessage::default() }.happening();
        assert_eq!((foreign(0), foreign(10), foreign(12)), (None, None, None));
    }
}
