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
    heard: Instant,
    silence: Silence,
    /// Whether its commands act, as last told.
    acting: Option<bool>,
    /// Late, missed and refused commands, as last told, and when.
    counts: [u64; 3],
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
        Self { carrier, bench, heard, silence: Silence::None, acting: None, counts: [0; 3], counted: None }
    }

    /// The bench has sent readings.
    pub(super) fn heard(&mut self, readings: &Readings) {
        (self.heard, self.silence) = (Instant::now(), Silence::None);
        let acting = readings.acting != 0;
        if self.acting != Some(acting) && (acting || self.acting.is_some()) {
            let tau = readings.tau;
            output::warn(&match acting {
                true => format!("commands from outside act from tau {tau:.6} on"),
                false => format!("the bench's own law acts from tau {tau:.6} on, for want of commands in time"),
            });
            self.acting = Some(acting);
        }
        // What was counted before this controller came is nothing of its own.
        let counts = [readings.late, readings.missed, readings.refused];
        let Some(counted) = self.counted else {
            (self.counts, self.counted) = (counts, Some(Instant::now() - APART));
            return;
        };
        if counts != self.counts && counted.elapsed() >= APART {
            let mut told = Vec::new();
            for (k, what) in ["too late (longer than the loop's delay)", "missing", "refused, as they are not finite"]
                .iter()
                .enumerate()
            {
                match counts[k].saturating_sub(self.counts[k]) {
                    0 => {}
                    more => told.push(format!("{more} {what}")),
                }
            }
            output::warn(&format!("commands: {}", told.join(", ")));
            (self.counts, self.counted) = (counts, Some(Instant::now()));
        }
    }

    /// Nothing has come from the bench just now.
    pub(super) fn bench_is_silent(&mut self) {
        if self.silence == Silence::Bench || self.heard.elapsed() < SILENCE {
            return;
        }
        // Without its status it is not known why.
        let status = self.carrier.glance(self.bench).ok().and_then(|mut glance| first(&mut glance));
        let Some(status) = status else { return };
        self.silence = Silence::Bench;
        let bench = self.bench;
        output::warn(&match why(&status) {
            Some(Why::NotAsked) => format!(
                "bench '{bench}' asks for no commands: it does once 'external' is set, as by whirl set --bench {bench} sample=0.02 delay=0.02 external=20"
            ),
            Some(Why::Tripped) => format!("bench '{bench}' has tripped: it sends readings again once it is restarted"),
            None => format!("bench '{bench}' sends no readings"),
        });
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
enum Why {
    NotAsked,
    Tripped,
}

fn why(status: &BenchStatus) -> Option<Why> {
    if status.trip.is_tripped() && !status.trip.coasts() {
        return Some(Why::Tripped);
    }
    status.settings.get().feedback.external().is_none().then_some(Why::NotAsked)
}

fn first(glance: &mut impl Glance) -> Option<Box<BenchStatus>> {
    let began = Instant::now();
    while began.elapsed() < SILENCE {
        if let Ok(Some(status)) = glance.bench_status() {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    None
}
