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
//! limit by a margin before it counts as within, and one of a motion, which may beat, must stay there for a while: one that trembles about
//! the limit, or beats across it, is one alarm, not a hundred. How readings are taken is [`crate::Sampler`]'s business, what they are held against [`Limits`]'s.

use std::collections::VecDeque;

use wire::{BenchStatus, Moment};

use crate::{Level, LevelChange, Limit, Limits, Reading, Sample, Watch};

/// Entries kept of what has been read.
const KEPT: usize = 256;

/// How long a motion must have stayed within its limits to count as within, nanoseconds.
const CALM_NS: u64 = 5_000_000_000;

/// One rise past a limit, and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// What rose.
    pub watch: Watch,
    /// The worst level that it reached.
    pub level: Level,
    /// The worst value.
    pub worst: f64,
    /// The limit of that level.
    pub limit: f64,
    /// Why, where there is more to say than the value.
    pub cause: String,
    /// When it rose.
    pub rose: Moment,
    /// When it was within its limits again.
    pub fell: Option<Moment>,
    /// When a person acknowledged it, nanoseconds since 1970.
    pub seen_ns: Option<u64>,
}

/// How one watched thing stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// The level it is at, with the margin of [`Limit`].
    pub at: Level,
    /// The worst level that no one has acknowledged.
    pub unseen: Level,
    /// The last value known.
    pub value: Option<f64>,
    /// What it was held against: of several control bearings each has its own.
    limit: Option<Limit>,
    /// When it was last as bad as the level it is at, nanoseconds since 1970.
    bad_ns: u64,
    /// The worst that it has been since.
    since: Level,
}

impl Standing {
    /// The level of something that may beat and is at `level` now: it stays where it was until it has been better for a while.
    fn calmed(&mut self, mut level: Level, now_ns: u64) -> Level {
        if level >= self.at {
            (self.bad_ns, self.since) = (now_ns, Level::Fine);
            return level;
        }
        // A clock that is set back keeps nothing waiting longer.
        self.bad_ns = self.bad_ns.min(now_ns);
        self.since = self.since.max(level);
        if now_ns - self.bad_ns < CALM_NS {
            return self.at;
        }
        (self.bad_ns, level) = (now_ns, self.since);
        self.since = Level::Fine;
        level
    }

    /// What must be shown: where it is, or where it has been unseen.
    #[must_use]
    pub fn shown(&self) -> Level {
        self.at.max(self.unseen)
    }
}

/// The state of all alarms.
#[derive(Clone, Debug, Default)]
pub struct Alarms {
    limits: Limits,
    standings: [Standing; Watch::COUNT],
    entries: VecDeque<Entry>,
    rose: bool,
    last_ns: u64,
}

impl Alarms {
    /// Nothing has happened yet.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// How things stood after these turns, which somebody else has judged and seen. Every entry stays.
    #[must_use]
    pub fn recalled<'a>(limits: Limits, turns: impl IntoIterator<Item = &'a LevelChange>) -> Self {
        let mut alarms = Self::new(limits);
        turns.into_iter().for_each(|turn| alarms.follow(turn));
        alarms.acknowledge();
        alarms
    }

    /// Holds a reading against the limits. Returns every crossing.
    pub fn read(&mut self, reading: &Reading) -> Vec<LevelChange> {
        self.last_ns = reading.at.wall_ns;
        let mut turns = Vec::new();
        for watch in Watch::ALL {
            if reading.forgets(watch) {
                // What is past a limit stays there: it has not come back.
                self.standings[watch as usize].value = None;
            }
            let held = self.limits.held(reading, watch).filter(|(sample, _)| sample.value.is_finite());
            let Some((sample, limit)) = held else { continue };
            let (value, standing) = (sample.value, &mut self.standings[watch as usize]);
            (standing.value, standing.limit) = (Some(value), limit);
            let before = standing.at;
            let Some(limit) = limit else {
                turns.extend(self.let_go(watch, sample));
                continue;
            };
            let level = match limit.level(value, before) {
                level if watch.may_beat() => standing.calmed(level, sample.at.wall_ns),
                level => level,
            };
            let worst = if before > Level::Fine { self.worsen(watch, limit, value) } else { value };
            if level == before {
                continue;
            }
            let turn = LevelChange {
                at: sample.at,
                watch,
                before,
                level,
                value,
                limit: limit.at(level.max(before)),
                worst,
                cause: if watch == Watch::Trip { reading.cause.clone() } else { String::new() },
            };
            self.follow(&turn);
            turns.push(turn);
            if self.entries.len() > KEPT {
                self.entries.pop_front();
            }
        }
        turns
    }

    /// What is past a limit that is no more is within it again.
    fn let_go(&mut self, watch: Watch, Sample { value, at }: Sample) -> Option<LevelChange> {
        let before = self.standings[watch as usize].at;
        let entry = self.open(watch).filter(|_| before > Level::Fine)?;
        let (limit, worst, cause) = (entry.limit, entry.worst, String::new());
        let turn = LevelChange { at, watch, before, level: Level::Fine, value, limit, worst, cause };
        self.follow(&turn);
        Some(turn)
    }

    /// Takes the machine as a bench tells of it, for limits that follow it.
    pub fn learn(&mut self, bench_status: &BenchStatus) {
        self.limits.follow(bench_status);
    }

    /// Sets other limits; what is past them is told by the next reading.
    pub fn limit(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// Takes a turn as it was taken by whoever judged.
    pub fn follow(&mut self, turn: &LevelChange) {
        self.last_ns = self.last_ns.max(turn.at.wall_ns);
        let standing = &mut self.standings[turn.watch as usize];
        standing.at = turn.level;
        standing.value = Some(turn.value);
        if turn.rises() {
            standing.unseen = standing.unseen.max(turn.level);
            self.rose = true;
            self.rise(turn);
        } else if let Some(entry) = self.open(turn.watch) {
            entry.worst = turn.worst;
            entry.fell = (turn.level == Level::Fine).then_some(turn.at);
        }
    }

    /// The entry of a watched thing that has not come back yet.
    fn open(&mut self, watch: Watch) -> Option<&mut Entry> {
        self.entries.iter_mut().rev().find(|entry| entry.watch == watch).filter(|entry| entry.fell.is_none())
    }

    fn rise(&mut self, turn: &LevelChange) {
        if let Some(entry) = self.open(turn.watch) {
            // A warning that grows into an alarm is one story, however often it does; it must be seen anew.
            entry.level = entry.level.max(turn.level);
            entry.limit = turn.limit;
            entry.worst = turn.worst;
            entry.seen_ns = None;
            return;
        }
        self.entries.push_back(Entry {
            watch: turn.watch,
            level: turn.level,
            worst: turn.worst,
            limit: turn.limit,
            cause: turn.cause.clone(),
            rose: turn.at,
            fell: None,
            seen_ns: None,
        });
    }

    /// Takes a value of something past its limit. Returns the worst since it rose.
    fn worsen(&mut self, watch: Watch, limit: Limit, value: f64) -> f64 {
        let Some(entry) = self.open(watch) else { return value };
        if limit.is_worse(value, entry.worst) {
            entry.worst = value;
        }
        entry.worst
    }

    /// A person has seen it all. Returns how many there were to see.
    pub fn acknowledge(&mut self) -> usize {
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

    /// Takes what is known of something, without judging it.
    pub fn see(&mut self, watch: Watch, value: Option<f64>) {
        self.standings[watch as usize].value = value;
    }

    /// Whether something has risen since this was last asked.
    pub fn has_risen(&mut self) -> bool {
        std::mem::take(&mut self.rose)
    }

    /// How each watched thing stands, with its limit, if it has one.
    pub fn standings(&self) -> impl Iterator<Item = (Watch, Standing, Option<Limit>)> + '_ {
        let limit = |watch, standing: &Standing| match self.limits.of(watch) {
            Some(_) if watch == Watch::Force && self.limits.follows(watch) => standing.limit.or(self.limits.of(watch)),
            limit => limit,
        };
        let all = Watch::ALL.into_iter().zip(self.standings);
        all.map(move |(watch, standing)| (watch, standing, limit(watch, &standing)))
    }

    /// The limits that readings are held against.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The worst that must be shown.
    #[must_use]
    pub fn shown(&self) -> Level {
        self.standings.iter().map(Standing::shown).max().unwrap_or_default()
    }

    /// What has been, newest first.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> + '_ {
        self.entries.iter().rev()
    }

    /// How many of them no one has acknowledged.
    #[must_use]
    pub fn unseen(&self) -> usize {
        self.entries.iter().filter(|entry| entry.seen_ns.is_none()).count()
    }
}

#[cfg(test)]
mod tests;
