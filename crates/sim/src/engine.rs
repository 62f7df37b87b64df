//! The rotor on the stepping thread, and what it exchanges with the request thread. Nothing here allocates or frees.

use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::queue::ArrayQueue;
use machine::{Machine, Program, Words};
use rotor::C64;
use wire::message::{Flags, Trip};
use wire::{Channel, MAX_SNAPSHOT, Point, RowMut, SnapshotHead};

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
    pub(crate) words: Words,
}

impl Saved {
    pub(crate) fn with_room(room: usize) -> Box<Self> {
        Box::new(Self { is_taken: false, head: SnapshotHead::default(), words: Words::with_room(room) })
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
}

impl Engine {
    /// A machine at rest, of which a snapshot is taken every so many steps at least.
    pub(crate) fn new(program: Program, run_id: u64, save_every: u64) -> Self {
        Self { machine: Machine::new(program), run_id, seq: 0, revision: 1, save_every, save_at: 0 }
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
                }
                Order::Impulse { mass, velocity } => self.machine.kick(*mass, *velocity),
                Order::Restart => self.machine.restart(),
                Order::Mark => {}
            }
            // There is room: the request thread has no more orders under way than the queue holds.
            let _ = exchange.notices.push(Notice::Done { order, step: self.seq, tau: self.tau() });
            any = true;
        }
        any
    }

    /// Makes one step, unless the machine has tripped. Returns the trip if this step caused one.
    pub(crate) fn step(&mut self) -> Option<Trip> {
        let trip = self.machine.step()?;
        // A snapshot of the machine as it is held.
        self.save_at = self.seq + 1;
        Some(Trip::new(self.seq, trip.cause as u32, trip.station, [trip.radius, trip.limit]))
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
            (Flags::SATURATED, sample.output.saturated),
            (Flags::TRIPPED, self.machine.trip().is_some()),
            (Flags::LATE, is_late),
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
        row.set(Channel::SpeedRate, 0, if self.machine.trip().is_some() { 0.0 } else { sample.acceleration });
        row.set_pair([Channel::CommandY, Channel::CommandZ], 0, parts(sample.output.commanded));
        row.set_pair([Channel::ForceY, Channel::ForceZ], 0, parts(sample.output.delivered));
        for (mass, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
            row.set_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
            row.set_pair([Channel::ReadingY, Channel::ReadingZ], mass, parts(self.machine.reading(mass)));
        }
        self.seq += 1;
    }
}

#[cfg(test)]
mod tests {
    use rotor::{Rotor, Settings, builtin};
    use wire::{Layout, State, Step};

    use super::*;

    fn program(rotor: &Rotor, settings: &Settings, dtau: f64) -> Program {
        Program::in_substeps(rotor, settings, dtau, 1).unwrap()
    }

    fn engine(feedback: &str, speed: f64, dtau: f64) -> (Rotor, Settings, Engine) {
        let rotor = builtin::rotor("three-mass").unwrap();
        let settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
        let engine = Engine::new(program(&rotor, &settings, dtau), 7, 1000);
        (rotor, settings, engine)
    }

    fn sent(engine: &mut Engine) -> State {
        let mut state = State::new(Layout::new(3));
        engine.fill(&mut state.row_mut(), 0, false);
        state
    }

    #[test]
    fn an_unstable_rotor_trips_at_the_limit_and_is_held_there() {
        let (_, _, mut engine) = engine("off", 2.5, 0.01);
        let trip = (0..1_000_000).find_map(|_| {
            let trip = engine.step();
            sent(&mut engine);
            trip
        });
        let trip = trip.unwrap();
        assert_eq!((trip.cause, trip.limit), (1, 1000.0));
        assert!(trip.radius > 1000.0 && trip.radius < 1010.0, "{trip}");
        let held = sent(&mut engine);
        assert!(held.flags().has(Flags::TRIPPED));
        assert_eq!(engine.step(), None);
        let later = sent(&mut engine);
        assert_eq!(later, held.with_word(Channel::Seq, held.seq() + 1));
    }

    #[test]
    fn stepping_filling_and_taking_orders_allocate_nothing() {
        let (rotor, settings, mut engine) = engine("composite", 2.5, 0.01);
        let exchange = Exchange::default();
        let mut state = State::new(Layout::new(3));
        let other = Settings { speed: 3.0, ..settings };
        let mut orders = vec![
            Box::new(Order::Settings { program: Box::new(program(&rotor, &other, 0.01)), revision: 2 }),
            Box::new(Order::Impulse { mass: 0, velocity: C64::new(0.1, 0.0) }),
            Box::new(Order::Restart),
        ];
        let counted = allocation_counter::measure(|| {
            for step in 0..300 {
                if step % 100 == 50 {
                    let _ = exchange.orders.push(orders.pop().unwrap());
                }
                engine.take_orders(&exchange);
                engine.step();
                engine.fill(&mut state.row_mut(), step, false);
            }
        });
        assert_eq!(counted.count_total, 0, "{counted:?}");
        // The notices carry the orders back: freed here, as by the request thread.
        assert_eq!(std::iter::from_fn(|| exchange.notices.pop()).count(), 3);
    }

    #[test]
    fn what_is_not_finite_is_never_sent() {
        // A step far too large for these gains: the state doubles its digits with every step.
        let (rotor, mut settings, _) = engine("composite", 2.5, 1.0);
        settings.trip = 1e9;
        for key in ["kd", "cd", "kc", "cc"] {
            settings.assign(key, "1e6").unwrap();
        }
        for cause in [1, 2] {
            // A kick beyond which the next step leaves the range of numbers at once.
            let mut engine = Engine::new(program(&rotor, &settings, 1.0), 7, 1000);
            if cause == 2 {
                engine.machine.kick(0, C64::new(1e300, 0.0));
            }
            let mut causes = Vec::new();
            for _ in 0..2000 {
                causes.extend(engine.step().map(|trip| trip.cause));
                let state = sent(&mut engine);
                assert!(state.numbers().all(f64::is_finite), "{state:?}");
            }
            assert_eq!(causes, [cause]);
        }
    }

    #[test]
    fn orders_take_effect_between_two_steps_and_say_which() {
        let (rotor, settings, mut engine) = engine("composite", 2.5, 0.01);
        let exchange = Exchange::default();
        (0..10).for_each(|_| {
            engine.step();
            sent(&mut engine);
        });
        let mut faster = settings;
        faster.speed = 3.0;
        let order = Order::Settings { program: Box::new(program(&rotor, &faster, 0.01)), revision: 2 };
        exchange.orders.push(Box::new(order)).unwrap();
        exchange.orders.push(Box::new(Order::Impulse { mass: 1, velocity: C64::new(0.0, 2.0) })).unwrap();
        assert!(engine.take_orders(&exchange) && !engine.take_orders(&exchange));
        for _ in 0..2 {
            assert!(matches!(exchange.notices.pop(), Some(Notice::Done { step: 10, .. })));
        }
        engine.step();
        let state = sent(&mut engine);
        assert_eq!((state.seq(), state.revision(), state.speed()), (10, 2, 3.0));
        assert!(state.point(1).vz > 1.5, "the impulse shows: {:?}", state.point(1));
        exchange.orders.push(Box::new(Order::Restart)).unwrap();
        engine.take_orders(&exchange);
        engine.step();
        assert_eq!(sent(&mut engine).tau(), 0.01);
    }
    #[test]
    fn snapshots_are_taken_at_every_change_and_every_so_often_and_wait_for_room() {
        let (rotor, mut settings, mut engine) = engine("composite", 2.5, 0.01);
        let exchange = Exchange::new(engine.machine.words_at_most());
        let taken = |engine: &mut Engine, steps: u64| {
            let mut taken = Vec::new();
            for _ in 0..steps {
                let done = engine.take_orders(&exchange);
                engine.save(done, &exchange);
                while let Some(saved) = exchange.saved.pop() {
                    taken.extend(saved.is_taken.then(|| (saved.head.seq, saved.words.as_slice().len())));
                    exchange.blank.push(saved).unwrap();
                }
                engine.step();
                sent(engine);
            }
            taken
        };
        let seqs = |taken: Vec<(u64, usize)>| taken.into_iter().map(|(seq, _)| seq).collect::<Vec<_>>();
        assert_eq!(seqs(taken(&mut engine, 2500)), [0, 1000, 2000]);
        exchange.orders.push(Box::new(Order::Impulse { mass: 0, velocity: C64::new(0.1, 0.0) })).unwrap();
        assert_eq!(seqs(taken(&mut engine, 1500)), [2500, 3500]);
        // A loop that remembers needs more room than there is: what was given back comes back as it was until there is.
        settings.assign("delay", "0.5").unwrap();
        let program = Box::new(program(&rotor, &settings, 0.01));
        let needed = program.words_at_most();
        exchange.orders.push(Box::new(Order::Settings { program, revision: 2 })).unwrap();
        assert_eq!(taken(&mut engine, 1), []);
        exchange.make_room(needed);
        let large = taken(&mut engine, 100);
        assert_eq!((large.len(), large[0].0), (1, 4001), "{large:?}");
    }
}
