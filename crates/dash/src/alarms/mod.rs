//! Alarms: what is past a limit, what has been, and whether a person has seen it.
//!
//! ```text
//!              rises                       acknowledged
//!   quiet ────────────▶ past, unseen ─────────────────────▶ past, seen
//!     ▲                     │ falls                             │ falls
//!     │    acknowledged     ▼                                   │
//!     └─────────────── within, unseen        quiet ◀────────────┘
//! ```
//!
//! An alarm stays until a person has acknowledged it, even if all is well again by then. A value must come back past its
//! limit by a margin before it counts as within: one that trembles about the limit is one alarm, not a hundred. Pure:
//! readings in, state out. How readings are taken is [`Gauge`]'s business, what they are held against [`Limits`]'s.

mod gauge;
mod limits;

use std::collections::VecDeque;

pub(crate) use gauge::Gauge;
pub(crate) use limits::Limit;
pub use limits::Limits;

/// Entries kept of what has been.
const KEPT: usize = 256;

/// What is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Watch {
    /// The smallest damping ratio of any mode.
    Damping,
    /// The largest distance of any mass from the centre, in `e_t`.
    Orbit,
    /// The largest control, in `m_b w0^2 e_t`.
    Force,
    /// Share of steps with the control bearing at its limit.
    Saturation,
    /// Share of steps sent late or given up.
    Lateness,
    /// Steps that did not reach us.
    Losses,
    /// The machine has tripped.
    Trip,
}

impl Watch {
    /// All, in the order of panels.
    pub(crate) const ALL: [Self; 7] =
        [Self::Trip, Self::Damping, Self::Orbit, Self::Force, Self::Saturation, Self::Lateness, Self::Losses];

    /// Its name in panels and in the configuration.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Damping => "damping",
            Self::Orbit => "orbit",
            Self::Force => "force",
            Self::Saturation => "saturation",
            Self::Lateness => "lateness",
            Self::Losses => "losses",
            Self::Trip => "trip",
        }
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    /// Within its limits.
    #[default]
    Fine,
    /// Worth a look.
    Warning,
    /// Worth a hand.
    Alarm,
}

/// What the watched things are at one moment; `None` is unknown, and changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Reading {
    /// When, nanoseconds since 1970.
    pub(crate) wall_ns: u64,
    pub(crate) damping: Option<f64>,
    pub(crate) orbit: Option<f64>,
    pub(crate) force: Option<f64>,
    pub(crate) saturation: Option<f64>,
    pub(crate) lateness: Option<f64>,
    pub(crate) losses: Option<f64>,
    /// Why it has tripped; empty while it runs.
    pub(crate) trip: Option<String>,
}

impl Reading {
    fn of(&self, watch: Watch) -> Option<f64> {
        match watch {
            Watch::Damping => self.damping,
            Watch::Orbit => self.orbit,
            Watch::Force => self.force,
            Watch::Saturation => self.saturation,
            Watch::Lateness => self.lateness,
            Watch::Losses => self.losses,
            Watch::Trip => self.trip.as_ref().map(|cause| f64::from(u8::from(!cause.is_empty()))),
        }
    }
}

/// One rise past a limit, and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) watch: Watch,
    /// The worst level that it reached.
    pub(crate) level: Level,
    /// The worst value.
    pub(crate) worst: f64,
    /// The limit of that level.
    pub(crate) limit: f64,
    /// Why, where there is more to say than the value.
    pub(crate) cause: String,
    /// When it rose, nanoseconds since 1970.
    pub(crate) rose_ns: u64,
    /// When it was within its limits again.
    pub(crate) fell_ns: Option<u64>,
    /// When a person acknowledged it.
    pub(crate) seen_ns: Option<u64>,
}

/// How one watched thing stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Standing {
    /// The level it is at, with the margin of [`Limit`].
    pub(crate) at: Level,
    /// The worst level that no one has acknowledged.
    pub(crate) unseen: Level,
    /// The last value known.
    pub(crate) value: Option<f64>,
}

impl Standing {
    /// What must be shown: where it is, or where it has been unseen.
    pub(crate) fn shown(&self) -> Level {
        self.at.max(self.unseen)
    }
}

/// The state of all alarms.
#[derive(Clone, Debug, Default)]
pub(crate) struct Alarms {
    limits: Limits,
    standings: [Standing; Watch::ALL.len()],
    entries: VecDeque<Entry>,
    rang: bool,
    last_ns: u64,
}

impl Alarms {
    /// Nothing has happened yet.
    pub(crate) fn new(limits: Limits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// Holds a reading against the limits. Returns whether anything that is shown has changed but the values.
    pub(crate) fn read(&mut self, reading: &Reading) -> bool {
        self.last_ns = reading.wall_ns;
        let mut changed = false;
        for (place, watch) in Watch::ALL.into_iter().enumerate() {
            let Some(value) = reading.of(watch).filter(|value| value.is_finite()) else { continue };
            let standing = &mut self.standings[place];
            standing.value = Some(value);
            let Some(limit) = self.limits.of(watch) else { continue };
            let before = standing.at;
            let level = limit.level(value, before);
            standing.at = level;
            changed |= level != before;
            if level > before {
                standing.unseen = standing.unseen.max(level);
                self.rang |= self.limits.bell;
                self.rise(watch, limit, value, level, reading);
            } else if level > Level::Fine {
                self.worsen(watch, limit, value);
            } else if before > Level::Fine
                && let Some(entry) = self.open(watch)
            {
                entry.fell_ns = Some(reading.wall_ns);
            }
        }
        changed
    }

    /// The entry of a watched thing that has not come back yet.
    fn open(&mut self, watch: Watch) -> Option<&mut Entry> {
        self.entries.iter_mut().rev().find(|entry| entry.watch == watch).filter(|entry| entry.fell_ns.is_none())
    }

    fn rise(&mut self, watch: Watch, limit: Limit, value: f64, level: Level, reading: &Reading) {
        if let Some(entry) = self.open(watch) {
            // A warning that grows into an alarm is one story, however often it does; it must be seen anew.
            entry.level = entry.level.max(level);
            entry.limit = limit.at(entry.level);
            entry.seen_ns = None;
            self.worsen(watch, limit, value);
            return;
        }
        if self.entries.len() == KEPT {
            self.entries.pop_front();
        }
        let cause = if watch == Watch::Trip { reading.trip.clone().unwrap_or_default() } else { String::new() };
        self.entries.push_back(Entry {
            watch,
            level,
            worst: value,
            limit: limit.at(level),
            cause,
            rose_ns: reading.wall_ns,
            fell_ns: None,
            seen_ns: None,
        });
    }

    fn worsen(&mut self, watch: Watch, limit: Limit, value: f64) {
        if let Some(entry) = self.open(watch)
            && limit.is_worse(value, entry.worst)
        {
            entry.worst = value;
        }
    }

    /// A person has seen it all. Returns how many there were to see.
    pub(crate) fn acknowledge(&mut self) -> usize {
        for standing in &mut self.standings {
            standing.unseen = Level::Fine;
        }
        let mut count = 0;
        for entry in self.entries.iter_mut().filter(|entry| entry.seen_ns.is_none()) {
            entry.seen_ns = Some(self.last_ns);
            count += 1;
        }
        count
    }

    /// Whether something has risen since this was last asked, and the bell is wanted.
    pub(crate) fn rings(&mut self) -> bool {
        std::mem::take(&mut self.rang)
    }

    /// How each watched thing stands, with its limit, if it has one.
    pub(crate) fn standings(&self) -> impl Iterator<Item = (Watch, Standing, Option<Limit>)> + '_ {
        Watch::ALL.into_iter().zip(self.standings).map(|(watch, standing)| (watch, standing, self.limits.of(watch)))
    }

    /// The force at which it is an alarm, if somebody has set one.
    pub(crate) fn force_limit(&self) -> Option<f64> {
        self.limits.force.map(|limit| limit.alarm)
    }

    /// The worst that must be shown.
    pub(crate) fn shown(&self) -> Level {
        self.standings.iter().map(Standing::shown).max().unwrap_or_default()
    }

    /// What has been, newest first.
    pub(crate) fn entries(&self) -> impl Iterator<Item = &Entry> + '_ {
        self.entries.iter().rev()
    }

    /// How many of them no one has acknowledged.
    pub(crate) fn unseen(&self) -> usize {
        self.entries.iter().filter(|entry| entry.seen_ns.is_none()).count()
    }
}

#[cfg(test)]
pub(crate) mod tests;
