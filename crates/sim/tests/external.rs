//! A controller outside that does what the built-in law does: the machine must not tell the difference.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use machine::{Machine, Pace, Program};
use rotor::{Rotor, Settings, builtin};
use sim::{Options, Summary};
use wire::message::Flags;
use wire::{
    BenchName, Carrier, Change, Commander, ControlCommand, Controlling, Glance, Happening, Listener, Memory, Readings,
    Root, SharedMemory, State, Step, WireError,
};

#[path = "../../wire/examples/controller.rs"]
#[allow(dead_code, unreachable_pub, reason = "its law alone is tried here")]
mod controller;

/// How long anything may take: far more than it does, because test machines are slow.
const PATIENCE: Duration = Duration::from_secs(120);

fn three_mass(set: &[(&str, &str)]) -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "individual").unwrap());
    settings.deadband.fill(1.0);
    for (key, value) in set {
        settings.assign(key, value).unwrap();
    }
    (rotor, settings)
}

fn options(lockstep: bool) -> Options {
    Options { lockstep, ..Options::default() }
}

/// Runs `act` beside a simulation, and returns how that ended.
fn beside<C: Carrier>(
    carrier: &C,
    (rotor, settings): &(Rotor, Settings),
    options: &Options,
    act: impl FnOnce(C::Listener),
) -> Summary {
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let simulation = scope.spawn(|| sim::run(carrier, rotor, settings.clone(), options, &stop, || ()));
        let start = Instant::now();
        let listener = loop {
            match carrier.listen(&options.bench) {
                Ok(listener) => break listener,
                Err(error) => assert!(start.elapsed() < PATIENCE && !simulation.is_finished(), "{error}"),
            }
        };
        let acted = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| act(listener)));
        stop.store(true, Ordering::Relaxed);
        let summary = simulation.join().unwrap().unwrap();
        acted.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        summary
    })
}

/// Answers readings by the law until `done` says so; `done` is asked between any two looks.
fn control<C: Controlling>(controller: &mut C, mut done: impl FnMut() -> bool) -> u64 {
    let (mut count, start) = (0, Instant::now());
    while !done() {
        assert!(start.elapsed() < PATIENCE, "not done after {count} commands");
        // The newest: what waits before them would be answered too late.
        match std::iter::from_fn(|| controller.readings().unwrap()).last() {
            Some(readings) => {
                let mut command = readings.answer(controller::law(&readings));
                command.stamp();
                controller.command(&command).unwrap();
                count += 1;
            }
            None => thread::yield_now(),
        }
    }
    count
}

/// The machine that nobody outside controls, step by step.
fn alone((rotor, settings): &(Rotor, Settings)) -> Machine {
    let pace = Pace { dtau: Options::DEFAULT_DTAU, rate_hz: Options::DEFAULT_RATE_HZ };
    Machine::new(Program::compile(rotor, settings, [settings.speed; 2], pace).unwrap())
}

/// Everything of a step that the law has a part in, as bits.
fn bits(machine: &Machine) -> Vec<u64> {
    let sample = machine.sample();
    let force = machine.outputs()[0].delivered;
    let numbers = sample.displacement.iter().chain(sample.velocity).chain([&force]);
    numbers.flat_map(|z| [z.re.to_bits(), z.im.to_bits()]).collect()
}

fn bits_of(state: &State) -> Vec<u64> {
    let points: Vec<_> = state.points().collect();
    let places = points.iter().flat_map(|p| [p.y, p.z]);
    let velocities = points.iter().flat_map(|p| [p.vy, p.vz]);
    places.chain(velocities).chain(state.force_delivered()).map(f64::to_bits).collect()
}

/// What the bench did, from its first step on, beside the machine that nobody outside controls.
fn agree_to_the_last_bit(states: &[State], machine_and_settings: &(Rotor, Settings)) {
    let mut machine = alone(machine_and_settings);
    let first = states[0].seq();
    for _ in 0..first {
        machine.step();
    }
    for (k, state) in states.iter().enumerate() {
        machine.step();
        assert_eq!(state.seq(), first + k as u64, "a step is missing");
        assert_eq!(state.tau().to_bits(), machine.tau().to_bits());
        assert_eq!(bits_of(state), bits(&machine), "step {k}");
    }
}

fn lockstep_on<C: Carrier>(carrier: &C, set: &[(&str, &str)], steps: usize) {
    let loops = three_mass(set);
    let options = options(true);
    let mut states = Vec::new();
    let summary = beside(carrier, &loops, &options, |mut listener| {
        let mut controller = carrier.controller(&options.bench).unwrap();
        let enough = || {
            listener.drain(|state| states.push(State::of(&state))).unwrap();
            states.len() >= steps
        };
        control(&mut controller, enough);
    });
    agree_to_the_last_bit(&states, &loops);
    assert!(states.iter().all(|state| state.flags().has(Flags::EXTERNAL) && !state.flags().has(Flags::HELD)));
    let counts = summary.external.unwrap();
    assert_eq!((counts.late, counts.missed, counts.refused, counts.lost), (0, 0, 0, 0), "{counts}");
}

/// Loops that are everything a controller can be outside of: sampled at once, seldom and late, with sensors and an actuator.
const LOOPS: [&[(&str, &str)]; 3] = [
    &[("sample", "0.01"), ("external", "20")],
    &[("sample", "0.03"), ("delay", "0.047"), ("lag", "0.02"), ("limit", "9"), ("external", "1")],
    &[
        ("sample", "0.02"),
        ("noise", "0.01"),
        ("quantum", "0.001"),
        ("sensor_lag", "0.02"),
        ("delay", "0.02"),
        ("external", "5"),
    ],
];

#[test]
fn val_in_lockstep_a_controller_outside_is_the_law_here_to_the_last_bit() {
    for set in LOOPS {
        lockstep_on(&Memory::with_room(100_000), set, 3000);
        let folder = tempfile::tempdir().unwrap();
        let root = Root::at(folder.path()).unwrap();
        lockstep_on(&SharedMemory::new(&root, "test").unwrap(), set, 3000);
    }
}

#[test]
fn val_in_real_time_it_stays_within_a_tenth_of_the_law_here_where_no_command_is_lost() {
    let loops = three_mass(&[("sample", "0.01"), ("delay", "0.15"), ("external", "5")]);
    let carrier = Memory::with_room(100_000);
    let mut states: Vec<State> = Vec::new();
    let summary = beside(&carrier, &loops, &options(false), |mut listener| {
        let mut controller = carrier.controller(&BenchName::default()).unwrap();
        let enough = || {
            listener.drain(|state| states.push(State::of(&state))).unwrap();
            let taken = states.iter().filter(|state| state.flags().has(Flags::EXTERNAL)).count();
            taken >= 1000
        };
        control(&mut controller, enough);
    });
    let counts = summary.external.unwrap();
    assert!(counts.took_over >= 1, "{counts}");
    // What is late is held until it comes, a few steps later: no more than that is between the two.
    if counts.lost == 0 && counts.missed < 5 {
        let mut machine = alone(&loops);
        for _ in 0..states[0].seq() {
            machine.step();
        }
        for state in &states {
            machine.step();
            let sample = machine.sample();
            for (point, p) in state.points().zip(sample.displacement) {
                assert!((point.y - p.re).hypot(point.z - p.im) < 0.1, "step {}", state.seq());
            }
        }
    }
}

#[test]
fn without_commands_the_law_here_takes_over_and_gives_back_and_what_is_amiss_is_told() {
    let loops = three_mass(&[("sample", "0.01"), ("delay", "0.15"), ("external", "5")]);
    let carrier = Memory::with_room(100_000);
    let summary = beside(&carrier, &loops, &options(false), |mut listener| {
        let mut last = None;
        let notes: RefCell<Vec<String>> = RefCell::default();
        let name = BenchName::default();
        let mut acts = |external: bool, listener: &mut <Memory as Carrier>::Listener| {
            listener.drain(|state| last = Some(State::of(&state))).unwrap();
            listener
                .events(|event| {
                    if let Some(Happening::Note(text)) = event.happening() {
                        notes.borrow_mut().push(text);
                    }
                })
                .unwrap();
            last.is_some_and(|state| state.flags().has(Flags::EXTERNAL) == external)
        };
        let mut controller = carrier.controller(&name).unwrap();
        assert_eq!(carrier.controller(&name).err(), Some(WireError::Controlled(name.clone())));
        let told = |words: &str| notes.borrow().iter().any(|note| note.contains(words));
        control(&mut controller, || acts(true, &mut listener) && told("a controller outside acts"));
        // Silent: the bench goes on by itself.
        let start = Instant::now();
        while !acts(false, &mut listener) {
            assert!(start.elapsed() < PATIENCE);
            thread::sleep(Duration::from_millis(1));
        }
        // What is no command, or not for this run, gives it nothing.
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < PATIENCE);
            let Some(readings) = std::iter::from_fn(|| controller.readings().unwrap()).last() else { continue };
            if readings.refused > 0 {
                break;
            }
            let bad = ControlCommand { command: [[f64::NAN; 2]; 8], ..readings.answer([0.0; 2]) };
            controller.command(&bad).unwrap();
            controller.command(&ControlCommand { run_id: 1, ..readings.answer([1e300; 2]) }).unwrap();
            controller.command(&ControlCommand { number: u64::MAX, ..readings.answer([1e300; 2]) }).unwrap();
        }
        // The next one of its kind takes its place.
        drop(controller);
        let mut controller = carrier.controller(&name).unwrap();
        control(&mut controller, || acts(true, &mut listener));
        let start = Instant::now();
        loop {
            acts(true, &mut listener);
            let _ = controller.readings().unwrap();
            if told("the controller outside was lost") && told("missed") {
                break;
            }
            assert!(start.elapsed() < PATIENCE, "{notes:?}");
            thread::sleep(Duration::from_millis(1));
        }
    });
    let counts = summary.external.unwrap();
    assert!(counts.took_over >= 2 && counts.lost >= 1 && counts.missed >= 5 && counts.refused >= 1, "{counts:?}");
    assert!(!summary.trip.is_tripped());
    assert!(summary.to_string().contains(" refused, lost "), "{summary}");
}

#[test]
fn a_machine_that_is_to_trip_without_commands_does() {
    let loops = three_mass(&[("sample", "0.01"), ("delay", "0.15"), ("external", "5"), ("external_trip", "40")]);
    let carrier = Memory::with_room(100_000);
    let summary = beside(&carrier, &loops, &options(false), |mut listener| {
        let mut flags = Flags::default();
        let mut controller = carrier.controller(&BenchName::default()).unwrap();
        // Before there has been a controller nothing is missed.
        let start = Instant::now();
        let mut steps = 0;
        while steps < 100 {
            steps += listener.drain(|state| flags = state.flags()).unwrap();
            assert!(start.elapsed() < PATIENCE && !flags.has(Flags::TRIPPED));
        }
        control(&mut controller, || {
            listener.drain(|state| flags = state.flags()).unwrap();
            flags.has(Flags::EXTERNAL)
        });
        while !flags.has(Flags::TRIPPED) {
            listener.drain(|state| flags = state.flags()).unwrap();
            assert!(start.elapsed() < PATIENCE, "it did not trip");
            thread::sleep(Duration::from_millis(1));
        }
    });
    assert_eq!(summary.trip.cause, 3);
    assert!(summary.trip.to_string().starts_with("no command came from the controller outside"), "{}", summary.trip);
}

#[test]
fn in_lockstep_it_waits_takes_changes_and_goes_on_with_the_next_controller() {
    let loops = three_mass(&[("sample", "0.01"), ("external", "20")]);
    let folder = tempfile::tempdir().unwrap();
    let root = Root::at(folder.path()).unwrap();
    let carrier = SharedMemory::new(&root, "test").unwrap();
    let name = BenchName::default();
    beside(&carrier, &loops, &options(true), |mut listener| {
        let mut commander = carrier.command(&name).unwrap();
        let mut steps = 0;
        let mut controller = carrier.controller(&name).unwrap();
        control(&mut controller, || {
            steps += listener.drain(|_| ()).unwrap();
            steps >= 50
        });
        drop(controller);
        // Nobody there: it stands, and can be changed.
        steps += listener.drain(|_| ()).unwrap();
        let before = steps;
        let ask = |commander: &mut _, change: Change| {
            let request = change.request("test", "").unwrap();
            Commander::ask(commander, &request, PATIENCE).unwrap()
        };
        let other = Settings { speed: 3.0, ..loops.1.clone() };
        let answer = ask(&mut commander, Change::Settings { base_revision: 1, settings: other.clone() });
        assert!(answer.is_accepted(), "{}", answer.reason.as_str());
        let mut off = other;
        off.assign("external", "off").unwrap();
        let refused = ask(&mut commander, Change::Settings { base_revision: 2, settings: off });
        assert!(refused.reason.as_str().starts_with("lockstep without a controller outside"), "{refused:?}");
        steps += listener.drain(|_| ()).unwrap();
        assert!(steps - before <= 1, "it waits");
        let mut next = carrier.controller(&name).unwrap();
        let (mut speed, mut first) = (0.0, None);
        control(&mut next, || {
            steps += listener
                .drain(|state| {
                    first = first.or(Some(state.seq()));
                    speed = state.speed();
                })
                .unwrap();
            steps >= before + 50
        });
        assert_eq!(speed, 3.0);
        assert!(listener.bench_status().unwrap().is_some_and(|status| status.revision == 2));
    });
}

#[test]
fn what_cannot_work_is_refused_at_the_start() {
    let told = |set: &[(&str, &str)], options: &Options| {
        let (rotor, settings) = three_mass(set);
        options.check(&rotor, &settings).unwrap_err().to_string()
    };
    let real_time = options(false);
    assert!(told(&[("external", "5")], &real_time).starts_with("external = 5 without sample: expected sample = T"));
    assert!(
        told(&[("sample", "0.01"), ("delay", "0.01"), ("external_trip", "5")], &real_time)
            .starts_with("external_trip = 5 without external")
    );
    let between = told(&[("sample", "0.015"), ("delay", "0.1"), ("external", "5")], &real_time);
    assert!(between.starts_with("external: sample = 0.015 is 1.500000 steps of 0.01"), "{between}");
    let at_once = told(&[("sample", "0.01"), ("external", "5")], &real_time);
    assert!(at_once.starts_with("external: delay = 0: expected at least 0.01, the 1 steps"), "{at_once}");
    let fast = Options { rate_hz: 10_000.0, ..options(false) };
    let shared = told(&[("sample", "0.01"), ("delay", "0.05"), ("external", "5")], &fast);
    assert!(shared.contains("expected at least 0.1, the 10 steps"), "{shared}");
    let alone = told(&[], &options(true));
    assert!(alone.starts_with("lockstep without a controller outside: expected external = N"), "{alone}");
}

/// Readings name the sample that they are of, and have what the sensors read and nothing else.
#[test]
fn readings_are_those_of_the_machine() {
    let loops = three_mass(&[("sample", "0.02"), ("external", "5")]);
    let carrier = Memory::with_room(100_000);
    let mut seen: Vec<Readings> = Vec::new();
    beside(&carrier, &loops, &options(true), |_listener| {
        let mut controller = carrier.controller(&BenchName::default()).unwrap();
        let start = Instant::now();
        while seen.len() < 100 {
            assert!(start.elapsed() < PATIENCE);
            if let Some(readings) = controller.readings().unwrap() {
                controller.command(&readings.answer(controller::law(&readings))).unwrap();
                seen.push(readings);
            }
        }
    });
    let mut machine = alone(&loops);
    for (k, readings) in seen.iter().enumerate() {
        assert_eq!((readings.number, readings.seq, readings.deadline_ns), (k as u64 + 1, 2 * k as u64, 0));
        assert_eq!((readings.masses, readings.bearings, readings.lockstep, readings.answered), (3, 1, 1, k as u64));
        let sample = machine.sample();
        assert_eq!((readings.tau, readings.speed, readings.angle), (sample.tau, 2.5, sample.angle));
        for (mass, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
            assert_eq!(readings.readings[mass], [p.re, p.im, v.re, v.im]);
        }
        assert_eq!(readings.readings[3], [0.0; 4]);
        machine.step();
        machine.step();
    }
}
