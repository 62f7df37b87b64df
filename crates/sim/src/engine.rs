//! The rotor on the stepping thread, and what it exchanges with the intake. Nothing here allocates or frees.

use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::queue::ArrayQueue;
use rotor::{C64, ClosedLoop, MAX_MASSES, Rotor, Settings, Stepper};
use wire::State;
use wire::message::{Flags, Point, Trip};

use crate::pacer::Wake;

/// Orders that may be under way at once; the intake hands over one at a time.
const MAX_PENDING_CHANGES: usize = 4;

/// What the intake tells the stepping thread to do before its next step. Boxed by the intake, and freed by it.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "an order is boxed whole")]
pub(crate) enum Order {
    /// New settings: the equations of motion made from them, the substeps that these need, and the rest.
    Settings { closed_loop: ClosedLoop, substeps: u32, trip_limit: f64, revision: u64 },
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

/// The queues between the two threads: bounded and lock-free.
#[derive(Debug)]
pub(crate) struct Exchange {
    pub(crate) orders: ArrayQueue<Box<Order>>,
    pub(crate) notices: ArrayQueue<Notice>,
    pub(crate) measures: ArrayQueue<Measure>,
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
}

impl Counters {
    pub(crate) fn count(&self, wake: &Wake, tau: f64) {
        self.tau_bits.store(tau.to_bits(), Ordering::Relaxed);
        self.steps.fetch_add(u64::from(wake.steps), Ordering::Relaxed);
        if wake.is_late {
            self.late.fetch_add(u64::from(wake.steps), Ordering::Relaxed);
        }
    }
}

impl Default for Exchange {
    fn default() -> Self {
        Self {
            orders: ArrayQueue::new(MAX_PENDING_CHANGES),
            // Every order that can be under way, and the trips that those orders can lead to.
            notices: ArrayQueue::new(4 * MAX_PENDING_CHANGES),
            // Two seconds of wake-ups: the intake looks ten times a second.
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

/// The rotor in motion, with the settings in force.
pub(crate) struct Engine {
    stepper: Box<dyn Stepper>,
    dtau: f64,
    /// Runge-Kutta steps that make one step.
    substeps: u32,
    run_id: u64,
    /// The number of the next step.
    seq: u64,
    speed: f64,
    trip_limit: f64,
    revision: u64,
    tripped: bool,
    /// The last state in which everything was finite: position and velocity.
    good: ([C64; MAX_MASSES], [C64; MAX_MASSES]),
    masses: usize,
    control: C64,
}

impl Engine {
    pub(crate) fn new(rotor: &Rotor, settings: &Settings, dtau: f64, substeps: u32, run_id: u64) -> Self {
        Self {
            stepper: rotor::stepper(&settings.closed_loop(rotor)),
            dtau,
            substeps,
            run_id,
            seq: 0,
            speed: settings.speed,
            trip_limit: settings.trip,
            revision: 1,
            tripped: false,
            good: ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]),
            masses: rotor.len(),
            control: C64::ZERO,
        }
    }

    /// Carries out what the intake has ordered. Returns whether there was anything.
    pub(crate) fn take_orders(&mut self, exchange: &Exchange) -> bool {
        let mut any = false;
        while let Some(order) = exchange.orders.pop() {
            match &*order {
                Order::Settings { closed_loop, substeps, trip_limit, revision } => {
                    self.stepper.load(closed_loop);
                    self.substeps = *substeps;
                    self.speed = closed_loop.speed();
                    self.trip_limit = *trip_limit;
                    self.revision = *revision;
                }
                Order::Impulse { mass, velocity } => self.stepper.kick(*mass, *velocity),
                Order::Restart => {
                    self.stepper.rest();
                    self.tripped = false;
                }
                Order::Mark => {}
            }
            // There is room: the intake has no more orders under way than the queue holds.
            let _ = exchange.notices.push(Notice::Done { order, step: self.seq, tau: self.tau() });
            any = true;
        }
        any
    }

    /// Makes one step, unless the machine has tripped. Returns the trip if this step caused one.
    ///
    /// A value that is not finite stops here: the rotor is put back where it last was finite, and held there.
    pub(crate) fn step(&mut self) -> Option<Trip> {
        if self.tripped {
            return None;
        }
        let n = self.masses;
        self.stepper.advance(self.dtau, self.substeps);
        let motion = self.stepper.motion();
        let control = self.stepper.control();
        let radius = motion.largest_radius();
        if motion.is_finite() && radius.is_finite() && control.re.is_finite() && control.im.is_finite() {
            self.good.0[..n].copy_from_slice(motion.displacement);
            self.good.1[..n].copy_from_slice(motion.velocity);
            self.control = control;
            if radius <= self.trip_limit {
                return None;
            }
            self.tripped = true;
            Some(self.trip(1))
        } else {
            self.stepper.place(&self.good.0[..n], &self.good.1[..n]);
            self.control = self.stepper.control();
            self.tripped = true;
            Some(self.trip(2))
        }
    }

    /// Time of the rotor now.
    pub(crate) fn tau(&self) -> f64 {
        self.stepper.motion().tau
    }

    fn trip(&self, cause: u32) -> Trip {
        let furthest = (0..self.masses).max_by(|a, b| self.good.0[*a].norm().total_cmp(&self.good.0[*b].norm()));
        let mass = furthest.unwrap_or(0);
        Trip { cause, mass: mass as u32 + 1, step: self.seq, radius: self.good.0[mass].norm(), limit: self.trip_limit }
    }

    /// Writes the present state into the sample that is about to be sent, and counts it.
    pub(crate) fn fill(&mut self, state: &mut State, due_ns: u64, is_late: bool) {
        let motion = self.stepper.motion();
        let force = [self.control.re, self.control.im];
        let mut flags = Flags::contact(self.stepper.contact());
        if self.tripped {
            flags |= Flags::TRIPPED;
        }
        if is_late {
            flags |= Flags::LATE;
        }
        state.run_id = self.run_id;
        state.seq = self.seq;
        state.tau = motion.tau;
        state.angle = motion.angle;
        state.wall_ns = due_ns;
        state.speed = self.speed;
        state.force_commanded = force;
        state.force_delivered = force;
        state.revision = self.revision;
        state.flags = flags;
        state.count = self.masses as u32;
        for (place, (p, v)) in state.masses.iter_mut().zip(motion.displacement.iter().zip(motion.velocity)) {
            *place = Point { y: p.re, z: p.im, vy: v.re, vz: v.im };
        }
        self.seq += 1;
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn engine(feedback: &str, speed: f64, dtau: f64) -> (Rotor, Settings, Engine) {
        let rotor = builtin::rotor("three-mass").unwrap();
        let settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
        let engine = Engine::new(&rotor, &settings, dtau, 1, 7);
        (rotor, settings, engine)
    }

    fn sent(engine: &mut Engine) -> State {
        let mut state = State::default();
        engine.fill(&mut state, 0, false);
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
        assert!(held.flags.has(Flags::TRIPPED));
        assert_eq!(engine.step(), None);
        let later = sent(&mut engine);
        assert_eq!((later.seq, later.tau, later.masses), (held.seq + 1, held.tau, held.masses));
    }

    #[test]
    fn what_is_not_finite_is_never_sent() {
        // A step far too large for these gains: the state doubles its digits with every step.
        let (rotor, mut settings, _) = engine("composite", 2.5, 1.0);
        settings.trip = 1e9;
        for key in ["kd", "cd", "kc", "cc"] {
            settings.assign(key, "1e6").unwrap();
        }
        for trip_limit in [1e9, f64::INFINITY] {
            let mut engine = Engine::new(&rotor, &settings, 1.0, 1, 7);
            engine.trip_limit = trip_limit;
            let mut causes = Vec::new();
            for _ in 0..2000 {
                causes.extend(engine.step().map(|trip| trip.cause));
                let state = sent(&mut engine);
                let numbers = state.points().iter().flat_map(|p| [p.y, p.z, p.vy, p.vz]);
                assert!(numbers.chain(state.force_commanded).chain([state.tau, state.angle]).all(f64::is_finite));
            }
            assert_eq!(causes, [if trip_limit.is_finite() { 1 } else { 2 }]);
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
        let closed_loop = faster.closed_loop(&rotor);
        let order = Order::Settings { closed_loop, substeps: 1, trip_limit: 5.0, revision: 2 };
        exchange.orders.push(Box::new(order)).unwrap();
        exchange.orders.push(Box::new(Order::Impulse { mass: 1, velocity: C64::new(0.0, 2.0) })).unwrap();
        assert!(engine.take_orders(&exchange) && !engine.take_orders(&exchange));
        for _ in 0..2 {
            assert!(matches!(exchange.notices.pop(), Some(Notice::Done { step: 10, .. })));
        }
        engine.step();
        let state = sent(&mut engine);
        assert_eq!((state.seq, state.revision, state.speed), (10, 2, 3.0));
        assert!(state.masses[1].vz > 1.5, "the impulse shows: {:?}", state.masses[1]);
        exchange.orders.push(Box::new(Order::Restart)).unwrap();
        engine.take_orders(&exchange);
        engine.step();
        assert_eq!(sent(&mut engine).tau, 0.01);
    }
}
