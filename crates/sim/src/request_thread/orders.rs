//! From a request to its answer: checked whole, made an order, and carried out between two steps.

use std::time::{Duration, Instant};

use machine::{Pace, Program};
use rotor::Settings;
use wire::message::{BenchStatusMessage, Trip};
use wire::{Answer, Change, Happening, Request, SettingsDocument};

use super::RequestThread;
use crate::engine::Order;
use crate::excitation::Excited;
use crate::log::When;

/// How long the stepping thread may take to carry out an order, beyond one step period.
const HANDOVER: Duration = Duration::from_secs(1);

impl RequestThread<'_> {
    /// Checks a request whole, has it carried out between two steps, and says with which step.
    pub(super) fn answer(&mut self, request: &Request) -> Answer {
        let revision = self.bench_status.revision;
        if request.asks_for_settings() && request.base_revision != revision {
            // No event: whoever asked looks again and asks again.
            let why = format!(
                "the settings were changed meanwhile by {} (revision {revision}, yours was {})",
                self.bench_status.changed_by.as_str(),
                request.base_revision
            );
            return Answer {
                outdated: 1,
                settings: self.bench_status.settings.hash(),
                ..Answer::refused(revision, &why)
            };
        }
        self.watch_excitation();
        let before = self.bench_status.substeps;
        if request.asks_for_settings()
            && Change::of(request).is_ok_and(|change| change.settings() == Some(&self.settings))
        {
            // In force already: nothing happens, and nobody's undo is in the way of it.
            let done = Answer::accepted(revision, self.applied.step, self.applied.tau);
            return Answer { substeps: [before; 2], settings: self.bench_status.settings.hash(), ..done };
        }
        let carried = self.order(request).and_then(|(change, order)| {
            let behind = || String::from("the simulation is too far behind to take changes");
            let substeps = if let Order::Settings { program, .. } = &order { program.substeps() } else { before };
            Ok((change, substeps, self.carry_out(order).ok_or_else(behind)?))
        });
        let (change, substeps, when) = match carried {
            Ok(done) => done,
            Err(reason) => {
                let settings = self.bench_status.settings.hash();
                let answer = Answer { substeps: [before; 2], settings, ..Answer::refused(revision, &reason) };
                let refused = Happening::Refused { asked: Change::kind_name(request.kind), reason };
                self.log.note_request(&refused, When::now(self.exchange), &self.bench_status, request);
                return answer;
            }
        };
        let (mut left, mut ends_excitation) = (false, false);
        let happened = match change {
            Change::Settings { settings, .. } => {
                self.bench_status.settings = SettingsDocument::of(&settings);
                self.bench_status.substeps = substeps;
                if self.leaves_profile(&settings) {
                    left = self.profile.take().is_some();
                }
                self.settings = settings;
                self.bench_status.revision = revision + 1;
                self.bench_status.applied_at_step = when.step;
                self.applied = when;
                self.bench_status.changed_by = request.who;
                self.analyse();
                ends_excitation = true;
                Happening::Settings
            }
            Change::Restart => {
                ends_excitation = true;
                self.bench_status.trip = Trip::default();
                Happening::Restarted
            }
            Change::Impulse { mass, velocity } => Happening::Impulse { mass, velocity },
            Change::Note { text } => Happening::Note(text),
            Change::Excite(multisine) => {
                self.excited = Some(Excited::new(when, &multisine, self.bench_status.dtau));
                Happening::Excited(multisine)
            }
            Change::EndExcitation => {
                self.excited = None;
                Happening::ExcitationOver
            }
        };
        self.log.note_request(&happened, when, &self.bench_status, request);
        if ends_excitation {
            self.excitation_over(when);
        }
        if left {
            // After the change itself, whose settings it carries.
            self.log.note(&Happening::Note("the speed leaves its profile".into()), when, &self.bench_status);
        }
        self.news = true;
        let settings = self.bench_status.settings.hash();
        Answer {
            substeps: [substeps, before],
            settings,
            ..Answer::accepted(self.bench_status.revision, when.step, when.tau)
        }
    }

    /// Checks a request, and makes the order that carries it out; or says why not.
    fn order(&mut self, request: &Request) -> Result<(Change, Order), String> {
        let change = Change::of(request).map_err(|error| error.to_string())?;
        let order = match &change {
            Change::Settings { settings, .. } => {
                settings.check(self.rotor).map_err(|error| error.to_string())?;
                crate::external::check(settings, &self.options).map_err(|error| error.to_string())?;
                let BenchStatusMessage { dtau, rate_hz, .. } = **self.bench_status;
                let pace = Pace { dtau, rate_hz };
                let program = match &self.profile {
                    Some(profile) if !self.leaves_profile(settings) => {
                        Program::compile_profile(self.rotor, settings, profile, pace).map_err(|error| error.to_string())
                    }
                    _ => {
                        let have = self.speeds_ahead(settings);
                        Program::compile(self.rotor, settings, have, pace).map_err(|error| error.to_string())
                    }
                };
                let program = Box::new(program?);
                // Before it is at work, so that the snapshot of the change is taken with it.
                self.snapshot_words = program.words_at_most();
                self.exchange.make_room(self.snapshot_words);
                Order::Settings { program, revision: self.bench_status.revision + 1 }
            }
            Change::Impulse { mass, velocity } => {
                let size = velocity.norm();
                if *mass >= self.rotor.len() {
                    return Err(format!("no mass {}: there are {}", mass + 1, self.rotor.len()));
                }
                if size.is_nan() || size > 1e6 {
                    return Err("an impulse must be finite and at most 1000000".into());
                }
                Order::Impulse { mass: *mass, velocity: *velocity }
            }
            Change::Restart => Order::Restart,
            Change::Note { text } if text.trim().is_empty() => return Err("a note must say something".into()),
            Change::Note { .. } => Order::Mark,
            Change::Excite(multisine) => Order::Excite(Some(self.excitation(multisine)?)),
            Change::EndExcitation if self.excited.is_none() => return Err("nothing excites the loop".into()),
            Change::EndExcitation => Order::Excite(None),
        };
        Ok((change, order))
    }

    /// Between which speeds the machine is when new settings are taken: at theirs if it jumps there; otherwise between where it is now and
    /// where it goes meanwhile.
    fn speeds_ahead(&self, settings: &Settings) -> [f64; 2] {
        if self.bench_status.trip.coasts() {
            return [0.0, self.speed()];
        }
        match &self.profile {
            _ if settings.ramp.is_infinite() => [settings.speed; 2],
            Some(profile) => profile.speeds(),
            None => [self.speed(), self.settings.speed],
        }
    }

    /// Whether these settings give the speed another aim than its profile has.
    fn leaves_profile(&self, settings: &Settings) -> bool {
        settings.speed != self.settings.speed || settings.ramp != self.settings.ramp
    }

    /// Hands an order to the stepping thread and waits until it has been carried out. Says when that was.
    fn carry_out(&mut self, order: Order) -> Option<When> {
        self.exchange.orders.push(Box::new(order)).ok()?;
        let deadline = Instant::now() + self.period + HANDOVER;
        loop {
            while let Some(notice) = self.exchange.notices.pop() {
                if let Some(when) = self.note(notice) {
                    return Some(when);
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
    fn late_notice(&mut self) -> Option<When> {
        let deadline = Instant::now() + HANDOVER;
        while Instant::now() < deadline {
            if let Some(when) = self.exchange.notices.pop().and_then(|notice| self.note(notice)) {
                return Some(when);
            }
            std::thread::park_timeout(Duration::from_millis(1));
        }
        None
    }
}
