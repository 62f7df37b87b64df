//! The rotor on the stepping thread, and what it exchanges with the request thread. Nothing here allocates or frees.

use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::queue::ArrayQueue;
use machine::{Excitation, Machine, Program, StateWords};
use rotor::C64;
use wire::message::{Flags, Trip};
use wire::{Channel, MAX_SNAPSHOT, Point, RowMut, SnapshotHead};

use crate::external::ExternalCounters;
use crate::pacer::Wake;

/// Orders that may be under way at once; the request thread hands over one at a time.
const MAX_PENDING_CHANGES: usize = 4;

/// What the request thread tells the stepping thread to do before its next step. Boxed by the request thread, and freed by it.
#[derive(Debug)]
pub(crate) enum Order {
    /// New settings, compiled; once carried out, the ones before are in their place.
    Settings { program: Box<Program>, revision: u64 },
    /// A change of velocity.
    Impulse { mass: usize, velocity: C64 },
    /// Back to rest; a trip is reset.
    Restart,
    /// Tones added to the loop's command from here on, or no longer; once carried out, what was there before is in their place.
    Excite(Option<Box<Excitation>>),
    /// Nothing: only the step and the time are wanted.
    Mark,
}

/// What the stepping thread has done.
#[derive(Debug)]
pub(crate) enum Notice {
    /// An order, given back, the first step made with it, and the time when it was carried out.
    Done { order: Box<Order>, step: u64, tau: f64 },
    /// The machine has tripped, at this time.
    Tripped { trip: Trip, tau: f64 },
}

/// Lateness of a wake-up and cost of a step in it, in nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    pub(crate) lateness_ns: u64,
    pub(crate) cost_ns: u64,
}

/// A snapshot on its way, in a buffer that comes back.
#[derive(Debug)]
pub(crate) struct Saved {
    /// Whether it is one: else it comes back because it has not room enough.
    pub(crate) is_taken: bool,
    pub(crate) head: SnapshotHead,
    pub(crate) words: StateWords,
}

impl Saved {
    pub(crate) fn with_room(room: usize) -> Box<Self> {
        Box::new(Self { is_taken: false, head: SnapshotHead::default(), words: StateWords::with_room(room) })
    }
}

/// Buffers for snapshots: one at every change, and the request thread looks ten times a second.
const SAVES: usize = 4;

/// The queues between the two threads: bounded and lock-free.
#[derive(Debug)]
pub(crate) struct Exchange {
    pub(crate) orders: ArrayQueue<Box<Order>>,
    pub(crate) notices: ArrayQueue<Notice>,
    pub(crate) measures: ArrayQueue<Measure>,
    /// How old commands from outside were when they were sent, in nanoseconds.
    pub(crate) ages: ArrayQueue<u64>,
    /// Snapshots that were taken, and buffers for the next.
    pub(crate) saved: ArrayQueue<Box<Saved>>,
    pub(crate) blank: ArrayQueue<Box<Saved>>,
    pub(crate) counters: Counters,
}

/// Counts since the start.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    pub(crate) steps: AtomicU64,
    pub(crate) late: AtomicU64,
    pub(crate) missed: AtomicU64,
    /// Time of the rotor after the last wake-up: the bits of an `f64`.
    pub(crate) tau_bits: AtomicU64,
    /// Spin speed then, likewise.
    pub(crate) speed_bits: AtomicU64,
    /// The largest orbit since it was asked for last, likewise.
    pub(crate) radius_bits: AtomicU64,
    /// How a controller outside does.
    pub(crate) external: ExternalCounters,
}

impl Counters {
    pub(crate) fn count(&self, wake: &Wake, tau: f64, speed: f64) {
        self.speed_bits.store(speed.to_bits(), Ordering::Relaxed);
        self.tau_bits.store(tau.to_bits(), Ordering::Relaxed);
        self.steps.fetch_add(u64::from(wake.steps), Ordering::Relaxed);
        if wake.is_late {
            self.late.fetch_add(u64::from(wake.steps), Ordering::Relaxed);
        }
    }
}

impl Counters {
    /// An orbit of this radius; bits of numbers that are not negative are in order as the numbers are.
    pub(crate) fn reach(&self, radius: f64) {
        self.radius_bits.fetch_max(radius.to_bits(), Ordering::Relaxed);
    }

    /// The largest orbit since the last call.
    pub(crate) fn take_radius(&self) -> f64 {
        f64::from_bits(self.radius_bits.swap(0, Ordering::Relaxed))
    }
}

impl Exchange {
    /// For a program whose snapshots have at most so many words.
    pub(crate) fn new(words: usize) -> Self {
        let made = Self::default();
        for _ in 0..SAVES {
            let _ = made.blank.push(Saved::with_room(words.min(MAX_SNAPSHOT)));
        }
        made
    }

    /// Gives the buffers that are not in use room for so many words. On the request thread's thread: this allocates.
    pub(crate) fn make_room(&self, words: usize) {
        for _ in 0..self.blank.len() {
            let Some(blank) = self.blank.pop() else { return };
            let is_small = blank.words.room() < words.min(MAX_SNAPSHOT);
            let _ = self.blank.push(if is_small { Saved::with_room(words.min(MAX_SNAPSHOT)) } else { blank });
        }
    }
}

impl Default for Exchange {
    fn default() -> Self {
        Self {
            saved: ArrayQueue::new(SAVES),
            blank: ArrayQueue::new(SAVES),
            orders: ArrayQueue::new(MAX_PENDING_CHANGES),
            // Every order that can be under way, and the trips that those orders can lead to.
            notices: ArrayQueue::new(4 * MAX_PENDING_CHANGES),
            // Two seconds of wake-ups: the request thread looks ten times a second.
            measures: ArrayQueue::new(2048),
            ages: ArrayQueue::new(2048),
            counters: Counters::default(),
        }
    }
}

impl Exchange {
    /// A full queue drops the measure: statistics may have gaps, steps may not.
    pub(crate) fn measure(&self, lateness_ns: u64, cost_ns: u64) {
        let _ = self.measures.push(Measure { lateness_ns, cost_ns });
    }

    /// The state's flags tell of a trip as well, so that a full queue loses only its cause.
    pub(crate) fn report_trip(&self, trip: Trip, tau: f64) {
        let _ = self.notices.push(Notice::Tripped { trip, tau });
    }
}

/// The machine in motion, and what its states are told with.
pub(crate) struct Engine {
    machine: Machine,
    run_id: u64,
    /// The number of the next step.
    seq: u64,
    revision: u64,
    /// Steps from one snapshot to the next where nothing happens.
    save_every: u64,
    /// The step before which the next one is due.
    save_at: u64,
    /// How often the loop or its time has begun anew: by settings, and by a restart.
    generation: u64,
    /// Whether commands come from a controller outside, and whether the last one is held for want of a newer.
    external: [bool; 2],
}

impl Engine {
    /// A machine at rest, of which a snapshot is taken every so many steps at least.
    pub(crate) fn new(program: Program, run_id: u64, save_every: u64) -> Self {
        Self {
            machine: Machine::new(program),
            run_id,
            seq: 0,
            revision: 1,
            save_every,
            save_at: 0,
            generation: 0,
            external: [false; 2],
        }
    }

    /// Takes a snapshot of the machine before its next step, if one is due: because something was `done` to it, because it has
    /// tripped, or because the last one is old. Waits for a buffer that is free and large enough.
    pub(crate) fn save(&mut self, done: bool, exchange: &Exchange) {
        if done {
            self.save_at = self.seq;
        }
        if self.seq < self.save_at {
            return;
        }
        let room = self.machine.words_at_most();
        if room > MAX_SNAPSHOT {
            self.save_at = self.seq + self.save_every;
            return;
        }
        let Some(mut saved) = exchange.blank.pop() else { return };
        saved.is_taken = saved.words.room() >= room;
        if !saved.is_taken {
            // The request thread gives it more.
            let _ = exchange.saved.push(saved);
            return;
        }
        saved.words.clear();
        self.machine.save(&mut saved.words);
        saved.head =
            SnapshotHead { run_id: self.run_id, seq: self.seq, revision: self.revision, tau: self.machine.tau() };
        // There is room: there are no more buffers than it holds.
        let _ = exchange.saved.push(saved);
        self.save_at = self.seq + self.save_every;
    }

    /// Carries out what the request thread has ordered. Returns whether there was anything.
    pub(crate) fn take_orders(&mut self, exchange: &Exchange) -> bool {
        let mut any = false;
        while let Some(mut order) = exchange.orders.pop() {
            match &mut *order {
                Order::Settings { program, revision } => {
                    self.machine.load(program);
                    self.revision = *revision;
                    self.generation += 1;
                }
                Order::Impulse { mass, velocity } => self.machine.kick(*mass, *velocity),
                Order::Restart => {
                    self.machine.restart();
                    self.generation += 1;
                }
                Order::Excite(excitation) => self.machine.excite(0, excitation),
                Order::Mark => {}
            }
            // There is room: the request thread has no more orders under way than the queue holds.
            let _ = exchange.notices.push(Notice::Done { order, step: self.seq, tau: self.tau() });
            any = true;
        }
        any
    }

    /// Makes one step, unless the machine is held. Returns the trip if this step caused one.
    pub(crate) fn step(&mut self) -> Option<Trip> {
        let trip = self.machine.step()?;
        // A snapshot of the machine as it is held, or begins to coast down.
        self.save_at = self.seq + 1;
        Some(Trip::new(self.seq, trip.cause as u32, trip.station, [trip.radius, trip.limit]))
    }

    /// Trips it for want of commands from outside.
    pub(crate) fn trip_for_want_of_commands(&mut self) -> Option<Trip> {
        let trip = self.machine.trip_for_want_of_commands()?;
        self.save_at = self.seq + 1;
        Some(Trip::new(self.seq, trip.cause as u32, trip.station, [trip.radius, trip.limit]))
    }

    pub(crate) fn machine(&self) -> &Machine {
        &self.machine
    }

    pub(crate) fn machine_mut(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// Whether the machine stands still after a trip.
    pub(crate) fn is_held(&self) -> bool {
        self.machine.is_held()
    }

    /// The number of the next step.
    pub(crate) fn seq(&self) -> u64 {
        self.seq
    }

    /// How often the loop or its time has begun anew.
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// From here on commands come from outside, or from the law of the bench again.
    pub(crate) fn set_external(&mut self, external: bool) {
        self.machine.set_external(external);
        self.external = [external, false];
    }

    /// Whether the last command from outside is held for want of a newer.
    pub(crate) fn set_held(&mut self, held: bool) {
        self.external[1] = held;
    }

    /// The farthest that a mass is from its centre.
    pub(crate) fn largest_radius(&self) -> f64 {
        let places = self.machine.sample().displacement.iter();
        places.map(|p| p.norm_sqr()).fold(0.0, f64::max).sqrt()
    }

    /// Spin speed now.
    pub(crate) fn speed(&self) -> f64 {
        self.machine.sample().speed
    }

    /// Time of the rotor now.
    pub(crate) fn tau(&self) -> f64 {
        self.machine.tau()
    }

    /// Writes the present state into the sample that is about to be sent, and counts it.
    pub(crate) fn fill(&mut self, row: &mut RowMut<'_>, due_ns: u64, is_late: bool) {
        let sample = self.machine.sample();
        let mut flags = Flags::contact(sample.contact);
        for (flag, is_set) in [
            (Flags::SATURATED, sample.outputs.iter().any(|output| output.saturated)),
            (Flags::TRIPPED, self.machine.trip().is_some()),
            (Flags::LATE, is_late),
            (Flags::EXTERNAL, self.external[0]),
            (Flags::HELD, self.external[1]),
            (Flags::COASTING, self.machine.trip().is_some() && !self.is_held()),
        ] {
            if is_set {
                flags |= flag;
            }
        }
        let parts = |z: C64| [z.re, z.im];
        row.set_word(Channel::RunId, self.run_id);
        row.set_word(Channel::Seq, self.seq);
        row.set_word(Channel::WallNs, due_ns);
        row.set_word(Channel::Revision, self.revision);
        row.set_flags(flags);
        row.set(Channel::Tau, 0, sample.tau);
        row.set(Channel::Angle, 0, sample.angle);
        row.set(Channel::Speed, 0, sample.speed);
        row.set(Channel::SpeedRate, 0, if self.is_held() { 0.0 } else { sample.acceleration });
        for (bearing, output) in sample.outputs.iter().enumerate() {
            row.set_force(bearing, [output.commanded, output.delivered].map(parts));
        }
        for (mass, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
            row.set_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
            row.set_pair([Channel::ReadingY, Channel::ReadingZ], mass, parts(self.machine.reading(mass)));
        }
        self.seq += 1;
    }
}

#[cfg(test)]
mod tests;
