//! What a controller's engineer should know while it works: said on stderr, when it changes.

use std::time::{Duration, Instant};

use wire::{BenchName, BenchStatus, Carrier, Glance, Readings, SharedMemory};

use crate::output;

/// How long nothing may come before that is said.
const SILENCE: Duration = Duration::from_secs(1);
/// Counts that go on rising are told no more often than this.
const APART: Duration = Duration::from_secs(5);

/// What has been said.
pub(super) struct Notices<'a> {
    carrier: &'a SharedMemory,
    bench: &'a BenchName,
    /// What tells why the bench is silent, while it is.
    glance: Option<<SharedMemory as Carrier>::Glance>,
    heard: Instant,
    silence: Silence,
    /// Whether its commands act, as last told.
    acting: bool,
    /// Late, missed and refused commands: at first those that were counted before this controller came, then as last told.
    counts: Option<[u64; 3]>,
    /// When they were told last.
    counted: Option<Instant>,
}

/// Whose silence has been told.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Silence {
    None,
    Bench,
    Program,
}

impl<'a> Notices<'a> {
    pub(super) fn new(carrier: &'a SharedMemory, bench: &'a BenchName) -> Self {
        let heard = Instant::now();
        Self { carrier, bench, glance: None, heard, silence: Silence::None, acting: false, counts: None, counted: None }
    }

    /// The bench has sent readings.
    pub(super) fn heard(&mut self, readings: &Readings) {
        (self.heard, self.silence, self.glance) = (Instant::now(), Silence::None, None);
        let acting = readings.acting != 0;
        if self.acting != acting {
            let tau = readings.tau;
            output::warn(&match acting {
                true => format!("commands from outside act from tau {tau:.6} on"),
                false => format!("the bench's own law acts from tau {tau:.6} on, for want of commands in time"),
            });
            self.acting = acting;
        }
        let counts = [readings.late, readings.missed, readings.refused];
        let before = *self.counts.get_or_insert(counts);
        if counts == before || self.counted.is_some_and(|told| told.elapsed() < APART) {
            return;
        }
        let words = ["too late (longer than the loop's delay)", "missing", "refused, as they are not finite"];
        let more = counts.iter().zip(before).map(|(now, before)| now.saturating_sub(before)).zip(words);
        let told: Vec<String> =
            more.filter(|(more, _)| *more > 0).map(|(more, what)| format!("{more} {what}")).collect();
        output::warn(&format!("commands: {}", told.join(", ")));
        (self.counts, self.counted) = (Some(counts), Some(Instant::now()));
    }

    /// Nothing has come from the bench just now.
    pub(super) fn bench_is_silent(&mut self) {
        if self.silence == Silence::Bench || self.heard.elapsed() < SILENCE {
            return;
        }
        if self.glance.is_none() {
            self.glance = self.carrier.glance(self.bench).ok();
        }
        // Without its status it is not known why.
        let Some(Ok(Some(status))) = self.glance.as_mut().map(Glance::bench_status) else { return };
        (self.silence, self.glance) = (Silence::Bench, None);
        output::warn(&why(&status, self.bench));
    }

    /// The program has not answered yet what it was given at a time.
    pub(super) fn program_is_silent(&mut self, name: &str, given: Instant, readings: &Readings) {
        if self.silence == Silence::Program || given.elapsed() < SILENCE {
            return;
        }
        self.silence = Silence::Program;
        output::warn(&format!(
            "{name} has not answered readings {} for a second: it is to write {} bytes for every {} that it reads, and to flush",
            readings.number,
            wire::ControlCommand::SIZE,
            Readings::SIZE
        ));
    }
}

/// Why a bench sends no readings.
fn why(status: &BenchStatus, bench: &BenchName) -> String {
    if status.trip.is_tripped() && !status.trip.coasts() {
        return format!("bench '{bench}' has tripped: it sends readings again once it is restarted");
    }
    match status.settings.get().feedback.external() {
        None => format!(
            "bench '{bench}' asks for no commands: it does once 'external' is set, as by whirl set --bench {bench} sample=0.02 delay=0.02 external=20"
        ),
        Some(_) => format!("bench '{bench}' sends no readings"),
    }
}
