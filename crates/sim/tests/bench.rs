//! A whole simulation on the carrier for tests: pace, changes, trips, restarts.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rotor::{C64, Modes, Settings, builtin};
use sim::{Options, Summary};
use wire::message::Flags;
use wire::{
    Answer, BenchName, BenchStatus, Carrier, Change, Commander, Event, Glance, Happening, Listener, Memory, State,
    Step, WireError,
};

/// How long anything may take: far more than it does, because test machines are slow.
const PATIENCE: Duration = Duration::from_secs(120);

/// How many states wait for a reader that the machine does not let read: those of ten seconds at the highest rate.
const ROOM: usize = 500_000;

/// A running simulation of the three-mass rotor, and a reader of it.
struct Bench {
    listener: <Memory as Carrier>::Listener,
    commander: <Memory as Carrier>::Commander,
    carrier: Memory,
    bench_status: Option<Box<BenchStatus>>,
    states: Vec<State>,
    events: Vec<Event>,
}

impl Bench {
    /// Reads on until `found` sees what it wants.
    fn wait<T>(&mut self, what: &str, mut found: impl FnMut(&BenchStatus, &[State]) -> Option<T>) -> T {
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
    fn events(&mut self, count: usize) -> Vec<Event> {
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
    fn again(&self) -> <Memory as Carrier>::Listener {
        self.carrier.listen(&BenchName::default()).unwrap()
    }

    fn ask(&mut self, change: &Change) -> Answer {
        self.commander.ask(&change.request("test", "to see").unwrap(), PATIENCE).unwrap()
    }
}

/// Runs `act` beside a simulation at `rate_hz`, and returns how the simulation ended.
fn beside(feedback: &str, rate_hz: f64, act: impl FnOnce(&mut Bench, Settings)) -> Summary {
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

#[test]
fn every_step_is_sent_once_and_in_order() {
    // One step a wake-up, several, and more than are sent together.
    for rate_hz in [1000.0, 5000.0, 50_000.0] {
        let summary = beside("composite", rate_hz, |bench, _| {
            bench.wait("steps", |_, states| (states.len() >= 1000).then_some(()));
            for pair in bench.states.windows(2) {
                assert_eq!(pair[1].run_id(), pair[0].run_id());
                assert_eq!(pair[1].seq(), pair[0].seq() + 1, "at {rate_hz}");
                assert!(pair[1].wall_ns() > pair[0].wall_ns());
                assert!((pair[1].tau() - pair[0].tau() - 0.01).abs() < 1e-6);
            }
        });
        assert!(summary.health.steps >= 1000);
        let told = summary.to_string();
        assert!(told.starts_with("bench default: three-mass, ") && !told.contains('\n'), "{told}");
    }
}

#[test]
fn the_bench_status_tells_the_rotor_the_settings_and_the_poles() {
    beside("composite", 1000.0, |bench, settings| {
        let bench_status = bench.wait("poles", |b, _| (b.analysis.revision == 1).then(|| Box::new(b.clone())));
        let rotor = bench_status.rotor().unwrap();
        assert_eq!(rotor, builtin::rotor("three-mass").unwrap());
        assert_eq!(bench_status.settings.get().clone(), settings);
        let linear = Modes::of(&settings.closed_loop(&rotor)).unwrap();
        assert_eq!(bench_status.analysis.min_damping, linear.min_damping());
        let poles: Vec<C64> = bench_status.analysis.poles().collect();
        assert_eq!(poles, linear.modes.iter().map(|m| m.pole).collect::<Vec<_>>());
        assert_eq!((bench_status.rate_hz, bench_status.dtau, bench_status.pid), (1000.0, 0.01, std::process::id()));
    });
}

#[test]
fn a_change_of_settings_is_answered_with_the_step_that_took_it() {
    beside("composite", 1000.0, |bench, mut settings| {
        bench.wait("steps before the change", |_, states| (states.len() >= 5).then_some(()));
        settings.speed = 3.0;
        let answer = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!((answer.is_accepted(), answer.revision), (true, 2));
        let first = bench.wait("the new speed", |_, states| states.iter().position(|s| s.speed() == 3.0));
        let (before, after) = (bench.states[first - 1], bench.states[first]);
        assert_eq!((after.seq(), after.revision(), before.revision()), (answer.applied_at_step, 2, 1));
        let bench_status = bench.wait("its poles", |b, _| (b.analysis.revision == 2).then(|| Box::new(b.clone())));
        assert_eq!(bench_status.settings.get().clone(), settings);
        assert_eq!(bench_status.changed_by.as_str(), "test");
        // Based on a revision that is no longer in force: refused, and told why.
        let answer = bench.ask(&Change::Settings { base_revision: 1, settings });
        assert_eq!((answer.is_accepted(), answer.outdated, answer.revision), (false, 1, 2));
        assert!(answer.reason.as_str().contains("changed meanwhile by test"), "{:?}", answer.reason);
    });
}

#[test]
fn what_is_wrong_is_refused_whole() {
    beside("composite", 1000.0, |bench, settings| {
        let mut refused = |change: &Change, why: &str| {
            let answer = bench.ask(change);
            assert!(!answer.is_accepted() && answer.reason.as_str().contains(why), "{:?}", answer.reason);
            assert_eq!((answer.revision, answer.outdated), (1, 0));
        };
        let bad = Settings { speed: f64::NAN, ..settings.clone() };
        refused(&Change::Settings { base_revision: 1, settings: bad }, "speed = NaN: expected a number from 0 to 1000");
        let short = Settings { deadband: vec![0.0; 2], ..settings };
        refused(&Change::Settings { base_revision: 1, settings: short }, "2 deadbands for 3 masses");
        refused(&Change::Impulse { mass: 3, velocity: C64::new(1.0, 0.0) }, "no mass 4: there are 3");
        refused(&Change::Impulse { mass: 0, velocity: C64::new(f64::NAN, 0.0) }, "must be finite");
    });
}

#[test]
fn settings_that_are_in_force_already_make_no_new_revision() {
    beside("composite", 1000.0, |bench, mut settings| {
        let same = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!((same.is_accepted(), same.revision, same.applied_at_step), (true, 1, 0));
        settings.speed = 3.0;
        let change = Change::Settings { base_revision: 1, settings: settings.clone() };
        let (first, again) = (bench.ask(&change), bench.ask(&Change::Settings { base_revision: 2, settings }));
        assert_eq!(again, first, "it is in force from the step that took it");
        // What is told of both is the one change.
        let told = bench.events(2);
        assert_eq!((told[1].happening(), told[1].revision), (Some(Happening::Settings), 2));
        // Somebody who has not seen it yet is told to look again, even if it is what he wants.
        assert_eq!(bench.ask(&change).outdated, 1);
    });
}

#[test]
fn an_unstable_rotor_trips_holds_and_restarts() {
    let summary = beside("off", 20_000.0, |bench, mut settings| {
        settings.trip = 5.0;
        assert!(bench.ask(&Change::Settings { base_revision: 1, settings }).is_accepted());
        bench.ask(&Change::Impulse { mass: 1, velocity: C64::new(1.0, 0.0) });
        let trip = bench.wait("the trip", |b, _| b.trip.is_tripped().then_some(b.trip));
        assert_eq!((trip.cause, trip.limit), (1, 5.0));
        let at = bench.states.iter().position(|s| s.flags().has(Flags::TRIPPED)).unwrap();
        assert_eq!(bench.states[at].seq(), trip.step);
        let held = bench.states[at];
        assert!(held.points().any(|p| p.radius() > 5.0));
        let later = bench.wait("held steps", |_, states| states.get(at + 100).copied());
        assert!(later.numbers().eq(held.numbers()));
        let answer = bench.ask(&Change::Restart);
        assert!(answer.is_accepted());
        bench.wait("running again", |b, _| (!b.trip.is_tripped()).then_some(()));
        let again = bench
            .wait("motion from rest", |_, states| states.iter().find(|s| s.seq() == answer.applied_at_step).copied());
        assert_eq!((again.tau(), again.flags().has(Flags::TRIPPED)), (0.01, false));
    });
    assert!(!summary.trip.is_tripped() || summary.trip.cause == 1);
}

#[test]
fn what_happens_is_told_in_order_with_who_and_why_and_the_settings_after_it() {
    beside("composite", 1000.0, |bench, settings| {
        let faster = Settings { speed: 3.0, ..settings.clone() };
        let changed = bench.ask(&Change::Settings { base_revision: 1, settings: faster.clone() });
        let bad = Settings { speed: -1.0, ..settings.clone() };
        assert!(!bench.ask(&Change::Settings { base_revision: 2, settings: bad }).is_accepted());
        let outdated = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!(outdated.outdated, 1);
        let kick = Change::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) };
        let kicked = bench.ask(&kick);
        let noted = bench.ask(&Change::Note { text: "here it begins".into() });
        assert!(!bench.ask(&Change::Note { text: "  ".into() }).is_accepted());
        let restarted = bench.ask(&Change::Restart);
        let told = bench.events(7);
        let happened: Vec<_> = told.iter().map(|event| event.happening().unwrap()).collect();
        let reason = "speed = -1: expected a number from 0 to 1000".to_owned();
        assert_eq!(
            happened,
            [
                Happening::Started,
                Happening::Settings,
                Happening::Refused { asked: "settings", reason },
                Happening::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) },
                Happening::Note("here it begins".into()),
                Happening::Refused { asked: "note", reason: "a note must say something".into() },
                Happening::Restarted,
            ]
        );
        // Numbers without a gap, over all events.
        assert_eq!(
            bench.events.iter().map(|e| e.number).collect::<Vec<_>>(),
            (1..=bench.events.len() as u64).collect::<Vec<_>>()
        );
        assert_eq!((told[0].who.as_str(), told[0].seq, told[0].tau, told[0].revision), ("sim", 0, 0.0, 1));
        assert!(told[1..].iter().all(|e| e.who.as_str() == "test" && e.why.as_str() == "to see"));
        // Steps and times are those of the answers, and times those of the step before.
        bench.wait("the restart", |_, states| states.iter().find(|s| s.seq() == restarted.applied_at_step).map(drop));
        for (event, answer) in [(1, changed), (3, kicked), (4, noted), (6, restarted)] {
            assert_eq!((told[event].seq, told[event].tau), (answer.applied_at_step, answer.tau));
            let before = bench.states.iter().find(|s| s.seq() + 1 == answer.applied_at_step);
            assert!(event == 6 || before.is_none_or(|before| before.tau() == answer.tau), "{before:?}, {answer:?}");
        }
        assert_eq!(restarted.tau, 0.0);
        assert_eq!(told[0].settings.get().clone(), settings);
        assert!(told[1..].iter().all(|event| event.settings.get().clone() == faster && event.revision == 2));
        assert!(told.windows(2).all(|pair| pair[1].wall_ns >= pair[0].wall_ns && pair[1].seq >= pair[0].seq));
    });
}

#[test]
fn a_trip_is_told_with_its_cause_and_who_comes_late_hears_of_it() {
    let mut late = None;
    beside("off", 20_000.0, |bench, mut settings| {
        settings.trip = 5.0;
        bench.ask(&Change::Settings { base_revision: 1, settings });
        bench.ask(&Change::Impulse { mass: 1, velocity: C64::new(1.0, 0.0) });
        let trip = bench.wait("the trip", |b, _| b.trip.is_tripped().then_some(b.trip));
        let told = bench.events(4);
        assert_eq!(told[3].happening(), Some(Happening::Tripped(trip)));
        assert_eq!((told[3].who.as_str(), told[3].seq), ("sim", trip.step));
        let at = bench.wait("the step", |_, states| states.iter().find(|s| s.seq() == trip.step).copied());
        assert_eq!(told[3].tau, at.tau());
        // A note on a held machine has a step, and the time at which it is held.
        let noted = bench.ask(&Change::Note { text: "so that is how it goes".into() });
        assert!(noted.applied_at_step > trip.step && noted.tau == at.tau(), "{noted:?}");
        bench.events(5);
        let numbers = |events: &[Event]| events.iter().map(|event| event.number).collect::<Vec<_>>();
        let mut listener = bench.again();
        let mut heard = Vec::new();
        listener.events(|event| heard.push(event.clone())).unwrap();
        assert_eq!(numbers(&heard[..5]), numbers(&bench.events[..5]));
        late = Some(listener);
    });
    let mut last = None;
    late.unwrap().events(|event| last = event.happening()).unwrap();
    assert_eq!(last, Some(Happening::Ended));
}

#[test]
fn stiff_settings_are_stepped_finer_and_what_cannot_be_followed_is_refused_to_any_client() {
    beside("composite", 1000.0, |bench, settings| {
        let change = |revision, key: &str, value: &str| {
            let mut settings = settings.clone();
            settings.assign(key, value).unwrap();
            Change::Settings { base_revision: revision, settings }
        };
        let answer = bench.ask(&change(1, "kd", "90000"));
        assert!(answer.is_accepted() && answer.substeps[0] > 10 && answer.substeps[1] == 1, "{answer:?}");
        let told = bench.wait("substeps", |b, _| (b.revision == 2).then_some(b.substeps));
        assert_eq!(told, answer.substeps[0]);
        let refused = bench.ask(&change(2, "cd", "1000000"));
        assert!(!refused.is_accepted() && refused.outdated == 0);
        let reason = refused.reason.as_str();
        assert!(reason.contains("is too long for the mode at") && reason.ends_with("would do"), "{reason}");
        let slower = bench.ask(&change(2, "kd", "-0.5"));
        assert!(slower.is_accepted() && slower.substeps == [1, told], "{slower:?}");
        // Whatever else happens meanwhile: stiff gains may trip the machine.
        let substeps = |events: Vec<Event>| -> Vec<u32> {
            events.iter().filter(|event| event.kind == 2).map(|event| event.substeps).collect()
        };
        let substeps = (3..).map(|count| substeps(bench.events(count))).find(|told| told.len() == 2).unwrap();
        assert_eq!(substeps, [told, 1]);
    });
}

/// A gain that is stiff about R = 2 alone: a machine that is below it and was sent beyond comes through it, wherever else it is sent then.
#[test]
fn a_machine_on_its_way_is_stepped_as_fine_as_what_lies_between() {
    beside("composite", 1000.0, |bench, settings| {
        let mut settings = settings.clone();
        settings.ramp = 0.005;
        let gain = settings.feedback.first_mut().signals[0].gain_mut(rotor::GainKind::Kd);
        *gain = rotor::Gain::Table(vec![(1.9, gain.at(0.0)), (2.0, 90000.0), (2.1, gain.at(0.0))]);
        let mut ask = |revision, speed| {
            settings.speed = speed;
            bench.ask(&Change::Settings { base_revision: revision, settings: settings.clone() })
        };
        let through = ask(1, 1.5);
        assert!(through.is_accepted() && through.substeps[0] > 10, "{through:?}");
        // It is still above R = 2, though what is in force ends below.
        let back = ask(2, 1.4);
        assert!(back.is_accepted() && back.substeps[0] == through.substeps[0], "{back:?}");
    });
}

#[test]
fn wrong_options_and_taken_names_are_refused() {
    let rotor = builtin::rotor("jeffcott").unwrap();
    let settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "cancel").unwrap());
    let carrier = Memory::default();
    let never = AtomicBool::new(true);
    let told = |options: Options, settings: Settings| {
        sim::run(&carrier, &rotor, settings, &options, &never, || unreachable!("never ready")).unwrap_err().to_string()
    };
    let options = Options { bench: BenchName::default(), rate_hz: 1000.0, dtau: 0.01, ..Options::default() };
    let slow = Options { rate_hz: 0.0, ..options.clone() };
    assert_eq!(told(slow, settings.clone()), "rate = 0: expected 1 to 100000 steps a second");
    let coarse = Options { dtau: f64::NAN, ..options.clone() };
    assert_eq!(told(coarse, settings.clone()), "dtau = NaN: expected more than 0 and at most 1");
    let fast = Settings { speed: -1.0, ..settings.clone() };
    assert_eq!(told(options.clone(), fast), "speed = -1: expected a number from 0 to 1000");
    let _holder = carrier.host(&options.bench).unwrap();
    assert_eq!(told(options.clone(), settings), WireError::Taken(options.bench).to_string());
}

#[test]
fn a_snapshot_goes_on_to_the_last_bit_as_the_bench_did() {
    beside("individual", 1000.0, |bench, mut settings| {
        // A loop with states of its own, noise among them.
        for (key, value) in [("delay", "0.055"), ("noise", "0.001"), ("lag", "0.02"), ("sensor_lag", "0.01")] {
            settings.assign(key, value).unwrap();
        }
        let answer = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert!(answer.is_accepted(), "{answer:?}");
        assert!(bench.ask(&Change::Impulse { mass: 1, velocity: C64::new(0.5, 0.25) }).is_accepted());
        let start = Instant::now();
        let mut heard = Vec::new();
        let taken = loop {
            bench.listener.snapshots(|head, words| heard.push((*head, words.to_vec()))).unwrap();
            if let Some(taken) = heard.iter().find(|(head, _)| head.revision == 2) {
                break taken.clone();
            }
            assert!(start.elapsed() < PATIENCE, "no snapshot came");
            thread::sleep(Duration::from_millis(1));
        };
        assert_eq!(taken.0.seq, answer.applied_at_step, "it is taken with the change itself");
        // The last one, after the impulse: nothing is done to the machine from there on.
        let start = Instant::now();
        while !heard.iter().any(|(head, _)| head.seq > answer.applied_at_step) {
            bench.listener.snapshots(|head, words| heard.push((*head, words.to_vec()))).unwrap();
            assert!(start.elapsed() < PATIENCE, "no snapshot came");
            thread::sleep(Duration::from_millis(1));
        }
        let (head, words) = heard.pop().unwrap();
        bench.wait("a second of steps", |_, states| {
            states.last().is_some_and(|state| state.seq() > head.seq + 1000).then_some(())
        });
        let rotor = builtin::rotor("three-mass").unwrap();
        let pace = machine::Pace { dtau: 0.01, rate_hz: 1000.0 };
        let program = machine::Program::compile(&rotor, &settings, [settings.speed; 2], pace).unwrap();
        let mut machine = machine::Machine::new(program);
        assert!(machine.restore(&mut machine::StateWords::from_saved(words)));
        assert_eq!(machine.tau(), head.tau);
        for state in bench.states.iter().filter(|state| (head.seq..head.seq + 1000).contains(&state.seq())) {
            assert_eq!(machine.step(), None);
            let sample = machine.sample();
            let numbers = sample.displacement.iter().chain(sample.velocity).flat_map(|z| [z.re, z.im]);
            let told = state.points().flat_map(|p| [p.y, p.z]).chain(state.points().flat_map(|p| [p.vy, p.vz]));
            assert!(numbers.map(f64::to_bits).eq(told.map(f64::to_bits)), "step {} from {}", state.seq(), head.seq);
            let read = (0..3).map(|mass| machine.reading(mass)).flat_map(|z| [z.re, z.im]);
            assert!(read.eq((0..3).flat_map(|mass| state.reading(mass))), "step {}", state.seq());
        }
    });
}

#[test]
fn one_excitation_at_a_time_is_told_from_its_first_step_to_its_last() {
    beside("composite", 5000.0, |bench, settings| {
        let excite = |duration: f64, amplitude: f64| {
            let text = format!(
                "seed=1 period=5.0 lines=1..9 tones=9 away_from=2.5 amplitude={amplitude:?} duration={duration:?}"
            );
            Change::Excite(text.parse().unwrap())
        };
        let refused = |answer: Answer, why: &str| {
            assert!(!answer.is_accepted() && answer.reason.as_str().contains(why), "{}", answer.reason.as_str());
        };
        refused(bench.ask(&Change::EndExcitation), "nothing excites the loop");
        refused(bench.ask(&excite(1.0, 1e9)), "could trip the machine");
        refused(bench.ask(&excite(1.0, -1.0)), "amplitude = -1");
        // By itself.
        let begun = bench.ask(&excite(5.0, 1e-3));
        assert!(begun.is_accepted());
        let started = begun.applied_at_step;
        refused(bench.ask(&excite(5.0, 1e-3)), "excited already");
        let over = |event: &Event| event.happening() == Some(Happening::ExcitationOver);
        let told = bench.events(7);
        let [.., begins, _, ends] = &told[..] else { panic!("{told:?}") };
        assert!(matches!(begins.happening(), Some(Happening::Excited(_))) && begins.who.as_str() == "test");
        assert!(over(ends) && (ends.seq, ends.who.as_str()) == (started + 500, "sim"), "{ends:?}");
        // By whoever asked, and by a change.
        assert!(bench.ask(&excite(1000.0, 1e-3)).is_accepted());
        let ended = bench.ask(&Change::EndExcitation);
        assert!(bench.ask(&excite(1000.0, 1e-3)).is_accepted());
        let mut faster = settings;
        faster.assign("kd", "-0.5").unwrap();
        let changed = bench.ask(&Change::Settings { base_revision: 1, settings: faster });
        let told = bench.events(12);
        assert!(over(&told[8]) && told[8].seq == ended.applied_at_step && told[8].who.as_str() == "test");
        assert_eq!(told[10].happening(), Some(Happening::Settings));
        assert!(over(&told[11]) && told[11].seq == changed.applied_at_step, "{told:?}");
        assert!(bench.ask(&excite(1.0, 1e-3)).is_accepted(), "and another may begin");
    });
}
