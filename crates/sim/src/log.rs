//! The log of events: numbers them, and says how far behind the simulation has fallen without flooding its readers.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use wire::{BenchStatus, Event, Happening, NewsSender, Request, Text, WireError};

use crate::engine::Exchange;

/// The name under which the simulation itself acts.
const OURSELVES: &str = "sim";

/// Events of this run, made by the request thread and sent in order.
#[derive(Debug, Default)]
pub(crate) struct Log {
    number: u64,
    waiting: Vec<Event>,
}

/// When something happened: the step and the time of the rotor that [`Event`] speaks of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct When {
    pub(crate) step: u64,
    pub(crate) tau: f64,
}

impl When {
    /// Now, as far as the stepping thread has told.
    pub(crate) fn now(exchange: &Exchange) -> Self {
        let counters = &exchange.counters;
        Self {
            step: counters.steps.load(Ordering::Relaxed),
            tau: f64::from_bits(counters.tau_bits.load(Ordering::Relaxed)),
        }
    }
}

impl Log {
    /// Notes what the simulation did by itself; `bench_status` has the settings now in force.
    pub(crate) fn note(&mut self, happening: &Happening, when: When, bench_status: &BenchStatus) {
        self.add(happening, when, bench_status, |event| event.who = Text::new(OURSELVES));
    }

    /// Notes what came of a request.
    pub(crate) fn note_request(
        &mut self,
        happening: &Happening,
        when: When,
        bench_status: &BenchStatus,
        request: &Request,
    ) {
        self.add(happening, when, bench_status, |event| {
            event.who = request.who;
            event.why = request.why;
        });
    }

    fn add(&mut self, happening: &Happening, when: When, bench_status: &BenchStatus, sign: impl FnOnce(&mut Event)) {
        self.number += 1;
        let mut event = happening.event();
        event.run_id = bench_status.run_id;
        event.number = self.number;
        event.seq = when.step;
        event.tau = when.tau;
        event.wall_ns = crate::wall_ns();
        event.revision = bench_status.revision;
        event.settings = bench_status.settings.clone();
        event.substeps = bench_status.substeps;
        sign(&mut event);
        self.waiting.push(*event);
    }

    /// Sends what has been noted.
    pub(crate) fn send(&mut self, news: &mut impl NewsSender) -> Result<(), WireError> {
        self.waiting.drain(..).try_for_each(|event| news.event(&event))
    }
}

/// Lateness worth an event: so much time's worth of steps. A single hiccup of the scheduler is no news.
const WORTH_TELLING: Duration = Duration::from_millis(20);
/// The first pause between two events of one spell of lateness; each is twice the one before.
const FIRST_PAUSE: Duration = Duration::from_secs(10);
/// The longest pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(640);

/// Gathers lateness into few events: the first of a spell is told at once, further ones ever more seldom, and a spell is
/// over when nothing came for as long as the last pause was.
#[derive(Debug)]
pub(crate) struct Lateness {
    /// How many late steps are worth telling.
    worth: u64,
    /// Counts that have been told: late, missed.
    told: [u64; 2],
    /// When, and how long to be silent from then on.
    last: Option<(Instant, Duration)>,
}

impl Lateness {
    pub(crate) fn new(period: Duration) -> Self {
        let worth = (WORTH_TELLING.as_secs_f64() / period.as_secs_f64()).ceil() as u64;
        Self { worth: worth.max(1), told: [0; 2], last: None }
    }

    /// Looks at the counts, and says if they are news.
    pub(crate) fn look(&mut self, late: u64, missed: u64, now: Instant) -> Option<Happening> {
        let new = [late - self.told[0], missed - self.told[1]];
        if new[0] < self.worth && new[1] == 0 {
            return None;
        }
        let pause = match self.last {
            Some((at, pause)) if now - at < pause => return None,
            Some((at, pause)) if now - at < 2 * pause => (2 * pause).min(LONGEST_PAUSE),
            _ => FIRST_PAUSE,
        };
        self.told = [late, missed];
        self.last = Some((now, pause));
        Some(Happening::Late { late: new[0], missed: new[1] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_hour_of_lateness_is_a_dozen_events_and_loses_no_count() {
        let start = Instant::now();
        let mut lateness = Lateness::new(Duration::from_millis(1));
        let mut told = Vec::new();
        for tenth in 0..36_000u64 {
            let now = start + Duration::from_millis(100 * tenth);
            if let Some(Happening::Late { late, missed }) = lateness.look(tenth * 5, tenth, now) {
                told.push((tenth, late, missed));
            }
        }
        assert_eq!(told[0].0, 1, "the first is told at once");
        assert!((6..=14).contains(&told.len()), "{told:?}");
        let (last, ..) = told[told.len() - 1];
        assert_eq!(told.iter().map(|(_, late, _)| late).sum::<u64>(), last * 5);
        assert_eq!(told.iter().map(|(.., missed)| missed).sum::<u64>(), last);
    }

    #[test]
    fn hiccups_are_no_news_and_a_new_spell_is_told_at_once() {
        let start = Instant::now();
        let mut lateness = Lateness::new(Duration::from_millis(1));
        assert_eq!(lateness.look(19, 0, start), None);
        assert_eq!(lateness.look(20, 0, start), Some(Happening::Late { late: 20, missed: 0 }));
        assert_eq!(lateness.look(90, 0, start + Duration::from_secs(9)), None);
        let later = start + Duration::from_secs(300);
        assert_eq!(lateness.look(90, 1, later), Some(Happening::Late { late: 70, missed: 1 }));
        assert_eq!(lateness.look(200, 1, later + Duration::from_secs(9)), None);
    }
}
