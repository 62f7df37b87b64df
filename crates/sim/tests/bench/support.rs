//! A simulation on the carrier for tests, and a reader of it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rotor::{Settings, builtin};
use sim::{Options, Summary};
use wire::{
    Answer, BenchName, BenchStatus, Carrier, Change, Commander, Event, Glance, Happening, Listener, Memory, State,
};

/// How long anything may take: far more than it does, because test machines are slow.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// How many states wait for a reader that the machine does not let read: those of ten seconds at the highest rate.
pub(crate) const ROOM: usize = 500_000;

/// A running simulation of the three-mass rotor, and a reader of it.
pub(crate) struct Bench {
    pub(crate) listener: <Memory as Carrier>::Listener,
    pub(crate) commander: <Memory as Carrier>::Commander,
    pub(crate) carrier: Memory,
    pub(crate) bench_status: Option<Box<BenchStatus>>,
    pub(crate) states: Vec<State>,
    pub(crate) events: Vec<Event>,
}

impl Bench {
    /// Reads on until `found` sees what it wants.
    pub(crate) fn wait<T>(&mut self, what: &str, mut found: impl FnMut(&BenchStatus, &[State]) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            let states = &mut self.states;
            self.listener.drain(|state| states.push(State::of(&state))).unwrap();
            if let Some(bench_status) = self.listener.bench_status().unwrap() {
                self.bench_status = Some(bench_status);
            }
            if let Some(found) = self.bench_status.as_ref().and_then(|bench_status| found(bench_status, &self.states)) {
                return found;
            }
            assert!(start.elapsed() < PATIENCE, "{what} did not come");
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Reads on until there are `count` events beside those of lost pace, and returns them.
    pub(crate) fn events(&mut self, count: usize) -> Vec<Event> {
        let start = Instant::now();
        loop {
            let events = &mut self.events;
            self.listener.events(|event| events.push(event.clone())).unwrap();
            let told: Vec<Event> =
                events.iter().filter(|e| !matches!(e.happening(), Some(Happening::Late { .. }))).cloned().collect();
            if told.len() >= count {
                return told;
            }
            assert!(start.elapsed() < PATIENCE, "{count} events did not come: {}", told.len());
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Another listener, which comes late.
    pub(crate) fn again(&self) -> <Memory as Carrier>::Listener {
        self.carrier.listen(&BenchName::default()).unwrap()
    }

    pub(crate) fn ask(&mut self, change: &Change) -> Answer {
        self.commander.ask(&change.request("test", "to see").unwrap(), PATIENCE).unwrap()
    }
}

/// Runs `act` beside a simulation at `rate_hz`, and returns how the simulation ended.
pub(crate) fn beside(feedback: &str, rate_hz: f64, act: impl FnOnce(&mut Bench, Settings)) -> Summary {
    let rotor = builtin::rotor("three-mass").unwrap();
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
    let carrier = Memory::with_room(ROOM);
    let options = Options { bench: BenchName::default(), rate_hz, dtau: 0.01, ..Options::default() };
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let simulation = scope.spawn(|| sim::run(&carrier, &rotor, settings.clone(), &options, &stop, || ()));
        let start = Instant::now();
        let listener = loop {
            match carrier.listen(&options.bench) {
                Ok(listener) => break listener,
                Err(error) => assert!(start.elapsed() < PATIENCE, "{error}"),
            }
        };
        let commander = carrier.command(&options.bench).unwrap();
        let mut bench = Bench {
            listener,
            commander,
            carrier: carrier.clone(),
            bench_status: None,
            states: Vec::new(),
            events: Vec::new(),
        };
        // A failed assertion must end the simulation too, or the scope would wait for it for ever.
        let acted = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| act(&mut bench, settings.clone())));
        stop.store(true, Ordering::Relaxed);
        let summary = simulation.join().unwrap().unwrap();
        acted.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        summary
    })
}
