//! A controller outside: what is sent to it before a step, what of its answers is taken, and who acts when none comes.
//!
//! In real time the machine waits for nobody. A command that is there by the deadline of its sample (`delay` after it) acts just then, as one
//! of the bench's own law would; one that comes later acts when it comes, and counts as late; until then the last one is held. Where more
//! samples than `external` says are without their command the law of the bench takes over; and the controller takes over, at first and again, after
//! that many commands in time. In lockstep the machine waits for the command of every sample, and so `delay` can be 0.

mod answered;
mod counts;

use std::sync::atomic::Ordering;

use rotor::{MAX_BEARINGS, MAX_MASSES, Settings};
use wire::message::Trip;
use wire::{ControlCommand, ControlHost, Readings, WireError};

use self::answered::Answered;
pub(crate) use self::counts::ExternalCounters;
pub use self::counts::ExternalCounts;
use crate::Options;
use crate::engine::{Engine, Exchange};
use crate::pacer::Pacer;

/// Times that differ by less than this share of a step are one.
const SAME: f64 = 1e-6;

/// Why a controller outside cannot work like this.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExternalError {
    /// Samples between two steps, where nobody outside can be asked.
    #[error("external: sample = {sample} is {:.6} steps of {dtau}: expected a whole number of them, at which the controller outside is asked", sample / dtau)]
    Between {
        /// The period.
        sample: f64,
        /// The step.
        dtau: f64,
    },
    /// No time to answer.
    #[error(
        "external: delay = {delay}: expected at least {least}, the {steps} steps until which a command can be there in real time (in lockstep the machine waits)"
    )]
    NoTime {
        /// The delay.
        delay: f64,
        /// The least that can be.
        least: f64,
        /// How many steps that is.
        steps: u32,
    },
    /// A bench that would wait for nobody.
    #[error("lockstep without a controller outside: expected external = N among the settings, and sample = T")]
    Alone,
}

/// Whether a controller outside can work under these settings.
///
/// # Errors
/// See [`ExternalError`].
pub(crate) fn check(settings: &Settings, options: &Options) -> Result<(), ExternalError> {
    let Options { dtau, rate_hz, lockstep, .. } = *options;
    if settings.feedback.external().is_none() {
        return if lockstep { Err(ExternalError::Alone) } else { Ok(()) };
    }
    let (sample, delay) = (settings.feedback.sample(), settings.feedback.delay());
    let steps = sample / dtau;
    if (steps - steps.round()).abs() > SAME || steps.round() < 1.0 {
        return Err(ExternalError::Between { sample, dtau });
    }
    // Steps that share a wake-up are made at once: what the first of them asks is answered after the last.
    let share = Pacer::steps_a_wake_up(rate_hz);
    let least = f64::from(share) * dtau;
    if !lockstep && delay < least * (1.0 - SAME) {
        return Err(ExternalError::NoTime { delay, least, steps: share });
    }
    Ok(())
}

/// What comes of looking before a step.
pub(crate) enum Ready {
    /// The step can be made.
    Yes,
    /// In lockstep: the command is not there yet.
    NotYet,
    /// The machine has tripped for want of commands.
    Tripped(Trip),
}

/// The bench's side of a controller outside, on the stepping thread.
pub(crate) struct External<P> {
    port: P,
    run_id: u64,
    lockstep: bool,
    /// Wall time of a unit of `tau`, in nanoseconds.
    tau_ns: f64,
    /// The engine's generation that the numbers below are of.
    generation: u64,
    /// The number of the last readings that were sent.
    number: u64,
    /// Readings up to this one are answered by nobody any more.
    closed: u64,
    /// The newest readings that were answered.
    answered: u64,
    /// Which of the latest were.
    which: Answered,
    /// The newest readings whose command should have been there.
    due: u64,
    /// The first readings that a controller answered of those whose commands act.
    since: u64,
    /// Commands in time, one after the other.
    in_time: u64,
    acting: bool,
    /// Whether commands from outside have acted since the last restart or change.
    has_acted: bool,
    /// Whether the last readings wait for their command, in lockstep.
    waiting: bool,
    /// When the latest readings were sent, by their number.
    sent_ns: Box<[u64]>,
}

/// A command, as far as it is looked at.
#[derive(Clone, Copy)]
struct Taken {
    number: u64,
    /// When it was sent; 0 if it is not told.
    wall_ns: u64,
    command: [[f64; 2]; MAX_BEARINGS],
}

impl<P: ControlHost> External<P> {
    pub(crate) fn new(port: P, run_id: u64, options: &Options) -> Self {
        Self {
            port,
            run_id,
            lockstep: options.lockstep,
            tau_ns: 1e9 / options.rate_hz / options.dtau,
            generation: 0,
            number: 0,
            closed: 0,
            answered: 0,
            which: Answered::default(),
            due: 0,
            since: 0,
            in_time: 0,
            acting: false,
            has_acted: false,
            waiting: false,
            sent_ns: vec![0; TIMED].into(),
        }
    }

    /// Gives the last readings to whoever has come since.
    pub(crate) fn welcome(&mut self) -> Result<(), WireError> {
        self.port.welcome()
    }

    /// Takes what commands are there, and sends the readings of the sample that is due with the next step, if one is.
    pub(crate) fn before_step(
        &mut self,
        engine: &mut Engine,
        exchange: &Exchange,
        now_ns: u64,
    ) -> Result<Ready, WireError> {
        if engine.generation() != self.generation {
            // What was asked before was asked of another loop, or at another time.
            self.generation = engine.generation();
            (self.closed, self.answered, self.due) = (self.number, self.number, self.number);
            (self.in_time, self.waiting, self.has_acted) = (0, false, self.acting);
        }
        let Some(allowed) = engine.machine().external() else {
            self.act(engine, exchange, false);
            return Ok(Ready::Yes);
        };
        if engine.is_held() {
            return Ok(Ready::Yes);
        }
        if self.lockstep {
            return self.in_lockstep(engine, exchange, now_ns);
        }
        self.take(engine, exchange, allowed)?;
        let is_read = engine.machine_mut().sense();
        if is_read {
            self.number += 1;
            self.which.set(self.number, false);
        }
        let overdue = self.look_for_missing(engine, exchange, allowed);
        if self.has_acted && engine.machine().external_trip().is_some_and(|most| overdue > most) {
            return Ok(engine.trip_for_want_of_commands().map_or(Ready::Yes, Ready::Tripped));
        }
        if is_read {
            self.send(engine, exchange, now_ns)?;
        }
        Ok(Ready::Yes)
    }

    /// Counts the samples whose command should act within the step to come and is not there, and hands the machine to its own law where too
    /// many are. Returns how many in a row, up to the newest, are without.
    fn look_for_missing(&mut self, engine: &mut Engine, exchange: &Exchange, allowed: u64) -> u64 {
        let due = engine.machine().external_due().map_or(0, |back| self.number.saturating_sub(back));
        let overdue = due.saturating_sub(self.answered);
        let counters = &exchange.counters.external;
        for number in self.due + 1..=due {
            // What was read before the controller had the machine was answered by the law here.
            if self.acting && number >= self.since && !self.which.has(number) {
                counters.missed.fetch_add(1, Ordering::Relaxed);
            }
        }
        self.due = self.due.max(due);
        if self.acting && overdue > allowed {
            self.act(engine, exchange, false);
            counters.lost.fetch_add(1, Ordering::Relaxed);
        }
        let is_held = due > self.closed && due >= self.since && !self.which.has(due);
        engine.set_held(self.acting && is_held);
        overdue
    }

    /// Takes the commands that have come, each for its sample.
    fn take(&mut self, engine: &mut Engine, exchange: &Exchange, allowed: u64) -> Result<(), WireError> {
        let mut found: [Option<Taken>; MAX_TAKEN] = [None; MAX_TAKEN];
        let count = self.receive(engine.machine().outputs().len(), exchange, &mut found)?;
        let counters = &exchange.counters.external;
        for Taken { number, wall_ns, command } in found.into_iter().take(count).flatten() {
            let back = self.number - number;
            self.answered = number;
            self.which.set(number, true);
            self.age(number, wall_ns, exchange);
            let put = |engine: &mut Engine| engine.machine_mut().command_from_outside(complex(&command), back);
            let in_time = put(engine);
            counters.taken.fetch_add(1, Ordering::Relaxed);
            if in_time {
                self.in_time += 1;
            } else {
                counters.late.fetch_add(1, Ordering::Relaxed);
                self.in_time = 0;
            }
            if in_time && !self.acting && self.in_time >= allowed {
                self.act(engine, exchange, true);
                self.since = number;
                put(engine);
                counters.took_over.fetch_add(1, Ordering::Relaxed);
            }
        }
        Ok(())
    }

    /// Waits, a look at a time, for the command of every sample.
    fn in_lockstep(&mut self, engine: &mut Engine, exchange: &Exchange, now_ns: u64) -> Result<Ready, WireError> {
        if engine.machine_mut().sense() {
            self.number += 1;
            self.waiting = true;
            self.send(engine, exchange, now_ns)?;
        }
        if !self.waiting {
            return Ok(Ready::Yes);
        }
        let mut found: [Option<Taken>; MAX_TAKEN] = [None; MAX_TAKEN];
        let count = self.receive(engine.machine().outputs().len(), exchange, &mut found)?;
        let wanted = self.number;
        let Some(taken) = found.into_iter().take(count).flatten().find(|taken| taken.number == wanted) else {
            return Ok(Ready::NotYet);
        };
        let counters = &exchange.counters.external;
        if !self.acting {
            self.act(engine, exchange, true);
            counters.took_over.fetch_add(1, Ordering::Relaxed);
        }
        engine.machine_mut().command_from_outside(complex(&taken.command), 0);
        counters.taken.fetch_add(1, Ordering::Relaxed);
        self.age(wanted, taken.wall_ns, exchange);
        (self.answered, self.waiting) = (wanted, false);
        Ok(Ready::Yes)
    }

    /// The commands that have come and mean something, oldest first. Returns how many there are.
    fn receive(
        &mut self,
        bearings: usize,
        exchange: &Exchange,
        found: &mut [Option<Taken>; MAX_TAKEN],
    ) -> Result<usize, WireError> {
        let Self { port, run_id, number, closed, answered, .. } = self;
        let (mut count, mut newest) = (0, *answered);
        port.commands(|message: &ControlCommand| {
            // What was meant for another run is no command.
            if message.run_id != *run_id {
                return;
            }
            // Before its number is looked at: who sends such things is told, also where another command was there first.
            if !message.is_finite(bearings) {
                exchange.counters.external.refused.fetch_add(1, Ordering::Relaxed);
                return;
            }
            // What came twice is none either, nor is the answer to what nobody asked.
            if message.number > *number || message.number <= newest.max(*closed) || count == MAX_TAKEN {
                return;
            }
            newest = message.number;
            found[count] = Some(Taken { number: message.number, wall_ns: message.wall_ns, command: message.command });
            count += 1;
        })?;
        Ok(count)
    }

    /// Notes how long after its readings a command was sent, if it tells that.
    fn age(&self, number: u64, wall_ns: u64, exchange: &Exchange) {
        if wall_ns > 0 && self.number - number < TIMED as u64 {
            let sent_ns = self.sent_ns[number as usize % TIMED];
            // A full queue drops it: statistics may have gaps, steps may not.
            let _ = exchange.ages.push(wall_ns.saturating_sub(sent_ns));
        }
    }

    /// From here on commands from outside act, or the law of the bench does.
    fn act(&mut self, engine: &mut Engine, exchange: &Exchange, acting: bool) {
        if acting == self.acting {
            return;
        }
        self.acting = acting;
        self.has_acted |= acting;
        self.in_time = 0;
        engine.set_external(acting);
        exchange.counters.external.acting.store(acting, Ordering::Relaxed);
    }

    fn send(&mut self, engine: &Engine, exchange: &Exchange, now_ns: u64) -> Result<(), WireError> {
        let machine = engine.machine();
        let sample = machine.sample();
        let delay = machine.external_delay();
        let counts = exchange.counters.external.now();
        let deadline_ns = if self.lockstep { 0 } else { now_ns + (delay * self.tau_ns) as u64 };
        let mut readings = Readings {
            run_id: self.run_id,
            number: self.number,
            seq: engine.seq(),
            wall_ns: crate::wall_ns(),
            deadline_ns,
            tau: sample.tau,
            angle: sample.angle,
            speed: sample.speed,
            masses: sample.displacement.len().min(MAX_MASSES) as u32,
            bearings: sample.outputs.len() as u32,
            lockstep: u32::from(self.lockstep),
            acting: u32::from(self.acting),
            answered: self.answered,
            late: counts.late,
            missed: counts.missed,
            refused: counts.refused,
            readings: [[0.0; 4]; MAX_MASSES],
        };
        for (place, read) in readings.readings.iter_mut().zip(machine.sensed()) {
            let (p, v) = (read.displacement, read.velocity);
            *place = [p.re, p.im, v.re, v.im];
        }
        self.sent_ns[self.number as usize % TIMED] = readings.wall_ns;
        self.port.send(&readings)
    }
}

/// Readings of which it is known when they were sent.
const TIMED: usize = 1024;

/// Commands that are looked at before a step: as many as can wait.
const MAX_TAKEN: usize = 8;

fn complex(command: &[[f64; 2]; MAX_BEARINGS]) -> impl Iterator<Item = rotor::C64> + '_ {
    command.iter().map(|[y, z]| rotor::C64::new(*y, *z))
}

#[cfg(test)]
mod tests;
