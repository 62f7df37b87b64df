//! The request thread: checks requests, hands them over, computes poles, and publishes bench statuses and events.

mod excite;
mod external;
mod orders;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use machine::MachinePoles;
use rotor::profile::Profile;
use rotor::{Rotor, Settings};
use wire::message::{Analysis, BenchStatusMessage, Health, Trip};
use wire::{BenchStatus, Change, Happening, Host, Inbox, NewsSender, SettingsDocument, Text, WireError};

use crate::Options;
use crate::engine::{Exchange, Notice};
use crate::excitation::Excited;
use crate::health::PaceStatistics;
use crate::log::{Lateness, Log, When};

/// How often a bench status goes out when nothing changes.
const HEARTBEAT: Duration = Duration::from_millis(100);

/// Bench statuses over which the largest orbit is kept in mind: two seconds.
const RADII: usize = 20;

/// What the request thread knows.
pub(crate) struct RequestThread<'a> {
    rotor: &'a Rotor,
    settings: Settings,
    /// What the speed follows until it is set to something else.
    profile: Option<Profile>,
    bench_status: Box<BenchStatus>,
    exchange: &'a Exchange,
    pace: PaceStatistics,
    log: Log,
    lateness: Lateness,
    period: Duration,
    /// Words of a snapshot under the settings in force, at most.
    snapshot_words: usize,
    /// When the settings in force were taken.
    applied: When,
    /// What excites the loop, if anything does.
    excited: Option<Excited>,
    /// The largest orbits between bench statuses, of the last few.
    radii: VecDeque<f64>,
    /// What was told of a controller outside, and when.
    controller: external::ExternalReports,
    /// What does not change of how the bench runs.
    options: Options,
    /// Something has changed that readers have not been told.
    news: bool,
}

impl<'a> RequestThread<'a> {
    pub(crate) fn new(
        rotor: &'a Rotor,
        settings: Settings,
        substeps: u32,
        options: &Options,
        (run_id, started_ns): (u64, u64),
        exchange: &'a Exchange,
    ) -> Self {
        let mut bench_status = Box::new(BenchStatus::from(BenchStatusMessage {
            run_id,
            started_ns,
            pid: std::process::id(),
            version: Text::new(env!("CARGO_PKG_VERSION")),
            rate_hz: options.rate_hz,
            dtau: options.dtau,
            substeps,
            revision: 1,
            changed_by: Text::new("start"),
            ..BenchStatusMessage::default()
        }));
        bench_status.set_rotor(rotor);
        let period = Duration::from_secs_f64(1.0 / options.rate_hz);
        Self {
            rotor,
            settings,
            profile: options.profile.clone(),
            bench_status,
            exchange,
            pace: PaceStatistics::new(),
            log: Log::default(),
            lateness: Lateness::new(period),
            period,
            snapshot_words: 0,
            applied: When { step: 0, tau: 0.0 },
            excited: None,
            radii: VecDeque::from([0.0; RADII]),
            controller: external::ExternalReports::default(),
            options: options.clone(),
            news: true,
        }
    }

    /// Serves until `stop`, and returns how the run went.
    pub(crate) fn run<H: Host>(mut self, host: &H, stop: &AtomicBool) -> Result<(Health, Trip), WireError> {
        let mut inbox = host.inbox()?;
        let mut news = host.news()?;
        self.bench_status.settings = SettingsDocument::of(&self.settings);
        self.analyse();
        self.log.note(&Happening::Started, When { step: 0, tau: 0.0 }, &self.bench_status);
        if let Some(profile) = &self.profile {
            // Nothing else of a bench tells of legs that are to come.
            let told = Happening::Note(fitting(&profile.told(self.rotor.scales().copied())));
            self.log.note(&told, When { step: 0, tau: 0.0 }, &self.bench_status);
        }
        let mut beat = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            if self.news || beat.elapsed() >= HEARTBEAT {
                self.pace.gather(self.exchange);
                self.radii.rotate_left(1);
                self.radii[RADII - 1] = self.exchange.counters.take_radius();
                self.watch_excitation();
                if self.speed() != self.bench_status.analysis.speed {
                    self.analyse();
                }
                news.welcome()?;
                self.publish(&mut news, host.listeners())?;
                self.watch_pace();
                self.watch_controller();
                beat = Instant::now();
            }
            self.log.send(&mut news)?;
            self.send_snapshots(&mut news)?;
            let patience = HEARTBEAT.saturating_sub(beat.elapsed());
            inbox.serve(patience, |request| self.answer(request))?;
            while let Some(notice) = self.exchange.notices.pop() {
                self.note(notice);
            }
        }
        self.pace.gather(self.exchange);
        self.log.note(&Happening::Ended, When::now(self.exchange), &self.bench_status);
        self.log.send(&mut news)?;
        Ok((self.pace.health(self.exchange, host.listeners()), self.bench_status.trip))
    }

    fn publish(&mut self, news: &mut impl NewsSender, listeners: usize) -> Result<(), WireError> {
        self.bench_status.number += 1;
        self.bench_status.wall_ns = crate::wall_ns();
        self.bench_status.health = self.pace.health(self.exchange, listeners);
        self.bench_status.control = self.pace.control(self.exchange);
        self.bench_status.leg = self.leg();
        self.news = false;
        news.bench_status(&self.bench_status)
    }

    /// The leg of its profile that the speed is on, and how many there are. A speed that coasts down after a trip is on none.
    fn leg(&self) -> [u16; 2] {
        let Some(profile) = self.profile.as_ref().filter(|_| !self.bench_status.trip.coasts()) else { return [0; 2] };
        let tau = f64::from_bits(self.exchange.counters.tau_bits.load(Ordering::Relaxed));
        profile.leg_at(tau).map_or([0; 2], |leg| [leg as u16 + 1, profile.legs.len() as u16])
    }

    /// Sends the snapshots that the stepping thread has taken, and gives it their buffers back, with the room that it needs.
    fn send_snapshots(&mut self, news: &mut impl NewsSender) -> Result<(), WireError> {
        while let Some(saved) = self.exchange.saved.pop() {
            if saved.is_taken {
                news.snapshot(&saved.head, saved.words.as_slice())?;
            }
            let _ = self.exchange.blank.push(saved);
        }
        self.exchange.make_room(self.snapshot_words);
        Ok(())
    }

    /// Notes that the simulation has fallen behind, if it has.
    fn watch_pace(&mut self) {
        let counters = &self.exchange.counters;
        let (late, missed) = (counters.late.load(Ordering::Relaxed), counters.missed.load(Ordering::Relaxed));
        if let Some(behind) = self.lateness.look(late, missed, Instant::now()) {
            self.log.note(&behind, When::now(self.exchange), &self.bench_status);
        }
    }

    /// Takes note of what the stepping thread has done. Says when an order was carried out.
    fn note(&mut self, notice: Notice) -> Option<When> {
        match notice {
            // Here, not on the stepping thread, the order's memory is freed.
            Notice::Done { order, step, tau } => {
                drop(order);
                Some(When { step, tau })
            }
            Notice::Tripped { trip, tau } => {
                self.bench_status.trip = trip;
                let when = When { step: trip.step, tau };
                self.log.note(&Happening::Tripped(trip), when, &self.bench_status);
                self.excitation_over(when);
                self.news = true;
                None
            }
        }
    }

    /// The speed of this moment: as it is set, unless it is on its way.
    fn speed(&self) -> f64 {
        if self.settings.ramp.is_finite() || self.profile.is_some() || self.bench_status.trip.is_tripped() {
            f64::from_bits(self.exchange.counters.speed_bits.load(Ordering::Relaxed))
        } else {
            self.settings.speed
        }
    }

    /// Recomputes the poles for the settings in force, at the speed of this moment.
    fn analyse(&mut self) {
        let speed = self.speed();
        let mut analysis = Analysis { revision: self.bench_status.revision, speed, ..Analysis::default() };
        let settings = Settings { speed, ..self.settings.clone() };
        match MachinePoles::of(self.rotor, &settings) {
            Ok(spectrum) => {
                // Of a loop with many states, the least damped.
                analysis.count = spectrum.modes.len().min(analysis.poles.len()) as u32;
                analysis.min_damping = spectrum.counted_damping(self.rotor, speed);
                for (place, mode) in analysis.poles.iter_mut().zip(&spectrum.modes) {
                    *place = [mode.pole.re, mode.pole.im];
                }
            }
            Err(error) => tracing::warn!(%error, "no poles for these settings"),
        }
        self.bench_status.analysis = analysis;
    }
}

/// As much of a note as fits into one.
fn fitting(told: &str) -> String {
    if told.len() <= Change::MAX_NOTE {
        return told.to_owned();
    }
    format!("{} ...", &told[..told.floor_char_boundary(Change::MAX_NOTE - 4)])
}
