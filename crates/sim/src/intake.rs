//! The intake thread: checks requests, hands them over, computes poles, and publishes bulletins.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rotor::{Rotor, Settings, Spectrum};
use wire::message::{Analysis, Health, Request, Trip};
use wire::{Answer, Bulletin, BulletinSender, Change, Host, Inbox, SettingsMessage, Text, WireError};

use crate::Options;
use crate::engine::{Exchange, Notice, Order};
use crate::health::Gauge;

/// How often a bulletin goes out when nothing changes.
const HEARTBEAT: Duration = Duration::from_millis(100);

/// How long the stepping thread may take to carry out an order, beyond one step period.
const HANDOVER: Duration = Duration::from_secs(1);

/// What the intake knows.
pub(crate) struct Intake<'a> {
    rotor: &'a Rotor,
    settings: Settings,
    bulletin: Box<Bulletin>,
    exchange: &'a Exchange,
    gauge: Gauge,
    period: Duration,
    /// Something has changed that readers have not been told.
    news: bool,
}

impl<'a> Intake<'a> {
    pub(crate) fn new(
        rotor: &'a Rotor,
        settings: Settings,
        options: &Options,
        run_id: u64,
        started_ns: u64,
        exchange: &'a Exchange,
    ) -> Self {
        let mut bulletin = Box::new(Bulletin {
            run_id,
            started_ns,
            pid: std::process::id(),
            version: Text::new(env!("CARGO_PKG_VERSION")),
            rate_hz: options.rate_hz,
            dtau: options.dtau,
            revision: 1,
            changed_by: Text::new("start"),
            ..Bulletin::default()
        });
        bulletin.set_rotor(rotor);
        Self {
            rotor,
            settings,
            bulletin,
            exchange,
            gauge: Gauge::new(),
            period: Duration::from_secs_f64(1.0 / options.rate_hz),
            news: true,
        }
    }

    /// Serves until `stop`, and returns how the run went.
    pub(crate) fn run<H: Host>(mut self, host: &H, stop: &AtomicBool) -> Result<(Health, Trip), WireError> {
        let mut inbox = host.inbox()?;
        let mut bulletins = host.bulletins()?;
        self.bulletin.settings = SettingsMessage::pack(&self.settings)?;
        self.analyse();
        let mut beat = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            if self.news || beat.elapsed() >= HEARTBEAT {
                self.gauge.gather(self.exchange);
                self.publish(&mut bulletins, host.listeners())?;
                beat = Instant::now();
            }
            let patience = HEARTBEAT.saturating_sub(beat.elapsed());
            inbox.serve(patience, |request| self.answer(request))?;
            while let Some(notice) = self.exchange.notices.pop() {
                self.note(notice);
            }
        }
        self.gauge.gather(self.exchange);
        Ok((self.gauge.health(self.exchange, host.listeners()), self.bulletin.trip))
    }

    fn publish(&mut self, bulletins: &mut impl BulletinSender, listeners: usize) -> Result<(), WireError> {
        self.bulletin.number += 1;
        self.bulletin.wall_ns = crate::wall_ns();
        self.bulletin.health = self.gauge.health(self.exchange, listeners);
        self.news = false;
        bulletins.send(&self.bulletin)
    }

    /// Checks a request whole, has it carried out between two steps, and says with which step.
    fn answer(&mut self, request: &Request) -> Answer {
        let revision = self.bulletin.revision;
        let Some(change) = Change::of(request) else {
            return Answer::refused(revision, &format!("unknown request {}", request.kind));
        };
        let order = match &change {
            Change::Settings { base_revision, .. } if *base_revision != revision => {
                let why = format!(
                    "the settings were changed meanwhile by {} (revision {revision}, yours was {base_revision})",
                    self.bulletin.changed_by.as_str()
                );
                return Answer { outdated: 1, ..Answer::refused(revision, &why) };
            }
            Change::Settings { settings, .. } => {
                if let Err(error) = settings.check(self.rotor) {
                    return Answer::refused(revision, &error.to_string());
                }
                let closed_loop = settings.closed_loop(self.rotor);
                Order::Settings { closed_loop, trip_limit: settings.trip, revision: revision + 1 }
            }
            Change::Impulse { mass, velocity } => {
                let size = velocity.norm();
                if *mass >= self.rotor.len() {
                    let masses = self.rotor.len();
                    return Answer::refused(revision, &format!("no mass {}: there are {masses}", mass + 1));
                }
                if size.is_nan() || size > 1e6 {
                    return Answer::refused(revision, "an impulse must be finite and at most 1000000");
                }
                Order::Impulse { mass: *mass, velocity: *velocity }
            }
            Change::Restart => Order::Restart,
        };
        let Some(step) = self.carry_out(order) else {
            return Answer::refused(revision, "the simulation is too far behind to take changes");
        };
        match change {
            Change::Settings { settings, .. } => {
                // What has been unpacked from one message fits into another.
                self.bulletin.settings = request.settings;
                self.settings = settings;
                self.bulletin.revision = revision + 1;
                self.bulletin.applied_at_step = step;
                self.bulletin.changed_by = request.who;
                self.analyse();
            }
            Change::Restart => self.bulletin.trip = Trip::default(),
            Change::Impulse { .. } => {}
        }
        self.news = true;
        Answer::accepted(self.bulletin.revision, step)
    }

    /// Hands an order to the stepping thread and waits until it has been carried out. Returns the step.
    fn carry_out(&mut self, order: Order) -> Option<u64> {
        self.exchange.orders.push(Box::new(order)).ok()?;
        let deadline = Instant::now() + self.period + HANDOVER;
        loop {
            while let Some(notice) = self.exchange.notices.pop() {
                if let Some(step) = self.note(notice) {
                    return Some(step);
                }
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                // Taken back, if it still lies there: a change that was refused must not happen later.
                return if self.exchange.orders.pop().is_some() { None } else { self.late_notice() };
            }
            std::thread::park_timeout(left);
        }
    }

    /// The order was picked up at the last moment: its notice follows within the step.
    fn late_notice(&mut self) -> Option<u64> {
        let deadline = Instant::now() + HANDOVER;
        while Instant::now() < deadline {
            if let Some(step) = self.exchange.notices.pop().and_then(|notice| self.note(notice)) {
                return Some(step);
            }
            std::thread::park_timeout(Duration::from_millis(1));
        }
        None
    }

    /// Takes note of what the stepping thread has done. Returns the step of an order that was carried out.
    fn note(&mut self, notice: Notice) -> Option<u64> {
        match notice {
            // Here, not on the stepping thread, the order's memory is freed.
            Notice::Done { order, step } => {
                drop(order);
                Some(step)
            }
            Notice::Tripped(trip) => {
                self.bulletin.trip = trip;
                self.news = true;
                None
            }
        }
    }

    /// Recomputes the poles for the settings in force.
    fn analyse(&mut self) {
        let mut analysis = Analysis { revision: self.bulletin.revision, ..Analysis::default() };
        match Spectrum::of(&self.settings.closed_loop(self.rotor)) {
            Ok(spectrum) => {
                analysis.count = spectrum.modes.len() as u32;
                analysis.min_damping = spectrum.min_damping();
                for (place, mode) in analysis.poles.iter_mut().zip(&spectrum.modes) {
                    *place = [mode.pole.re, mode.pole.im];
                }
            }
            Err(error) => tracing::warn!(%error, "no poles for these settings"),
        }
        self.bulletin.analysis = analysis;
    }
}
