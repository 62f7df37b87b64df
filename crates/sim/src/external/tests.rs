use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use machine::{Machine, Pace, Program};
use proptest::prelude::*;
use rotor::builtin;
use wire::message::Flags;
use wire::{State, Step, StepLayout};

use super::*;

#[path = "../../../wire/examples/controller.rs"]
#[allow(dead_code, unreachable_pub, reason = "its law alone is tried here")]
mod controller;

/// A controller in the same thread that answers every reading at once, with nothing, unless it is silent.
#[derive(Clone, Default)]
struct Port(Rc<RefCell<Answers>>);

#[derive(Default)]
struct Answers {
    waiting: Option<ControlCommand>,
    sent: u64,
    is_silent: bool,
}

/// One that computes the law of the bench, but leaves some readings out, and sends every command so many looks later.
#[derive(Clone, Default)]
struct Law(Rc<RefCell<LawAnswers>>);

#[derive(Default)]
struct LawAnswers {
    left_out: Vec<u64>,
    lag: usize,
    looks: usize,
    waiting: VecDeque<(usize, ControlCommand)>,
}

impl ControlHost for Law {
    fn send(&mut self, readings: &Readings) -> Result<(), WireError> {
        let mut answers = self.0.borrow_mut();
        if !answers.left_out.contains(&readings.number) {
            let at = answers.looks + answers.lag;
            answers.waiting.push_back((at, readings.answer(controller::law(readings))));
        }
        Ok(())
    }

    fn commands(&mut self, mut visit: impl FnMut(&ControlCommand)) -> Result<usize, WireError> {
        let mut answers = self.0.borrow_mut();
        let (looks, mut count) = (answers.looks, 0);
        while answers.waiting.front().is_some_and(|(at, _)| *at <= looks) {
            answers.waiting.pop_front().iter().for_each(|(_, command)| visit(command));
            count += 1;
        }
        answers.looks += 1;
        Ok(count)
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        Ok(())
    }
}

impl ControlHost for Port {
    fn send(&mut self, readings: &Readings) -> Result<(), WireError> {
        let mut answers = self.0.borrow_mut();
        answers.sent += 1;
        answers.waiting = (!answers.is_silent).then(|| readings.answer([0.0; 2]));
        Ok(())
    }

    fn commands(&mut self, mut visit: impl FnMut(&ControlCommand)) -> Result<usize, WireError> {
        Ok(self.0.borrow_mut().waiting.take().iter().map(&mut visit).count())
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        Ok(())
    }
}

fn bench(set: &[(&str, &str)], lockstep: bool) -> (Engine, External<Port>, Port, Exchange) {
    let port = Port::default();
    let (engine, external, exchange) = with(port.clone(), set, lockstep);
    (engine, external, port, exchange)
}

fn program(set: &[(&str, &str)]) -> Program {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "individual").unwrap());
    for (key, value) in set {
        settings.assign(key, value).unwrap();
    }
    Program::compile(&rotor, &settings, [2.5; 2], Pace { dtau: 0.01, rate_hz: 1000.0 }).unwrap()
}

fn with<P: ControlHost>(port: P, set: &[(&str, &str)], lockstep: bool) -> (Engine, External<P>, Exchange) {
    let program = program(set);
    let exchange = Exchange::new(program.words_at_most());
    let options = Options { lockstep, ..Options::default() };
    (Engine::new(program, 7, 1000), External::new(port, 7, &options), exchange)
}

/// How so many steps with that controller went, beside a machine that nobody outside controls: the first step that differs in any bit, and
/// the steps over which a command was held.
fn beside_the_law(port: Law, set: &[(&str, &str)], count: u64) -> (Option<u64>, Vec<u64>, ExternalCounts) {
    let (mut engine, mut external, exchange) = with(port, set, false);
    let mut alone = Machine::new(program(set));
    alone.kick(0, rotor::C64::new(0.5, -0.25));
    engine.machine_mut().kick(0, rotor::C64::new(0.5, -0.25));
    let (mut differs, mut held) = (None, Vec::new());
    for step in 0..count {
        assert!(matches!(external.before_step(&mut engine, &exchange, 0).unwrap(), Ready::Yes));
        assert_eq!(engine.step(), None);
        alone.step();
        let mut state = State::new(StepLayout::new(3));
        engine.fill(&mut state.row_mut(), 0, false);
        if state.flags().has(Flags::HELD) {
            held.push(step);
        }
        let (ours, theirs) = (engine.machine().sample(), alone.sample());
        let same = ours.displacement == theirs.displacement
            && ours.velocity == theirs.velocity
            && engine.machine().outputs()[0].delivered == alone.outputs()[0].delivered;
        if !same && differs.is_none() {
            differs = Some(step);
        }
    }
    (differs, held, exchange.counters.external.now())
}

#[test]
fn regress_readings_that_a_controller_left_out_are_missed_and_held_where_their_command_should_act() {
    // As one does that answers the newest readings alone, on a busy machine.
    let port = Law::default();
    port.0.borrow_mut().left_out = vec![7, 8, 40, 41, 42];
    let set = [("sample", "0.01"), ("delay", "0.15"), ("external", "5")];
    let (differs, held, counts) = beside_the_law(port, &set, 200);
    // Readings 7 were made before step 6, and are answered 15 steps later.
    assert_eq!((differs, held), (Some(21), vec![21, 22, 54, 55, 56]));
    assert_eq!((counts.missed, counts.late, counts.lost), (5, 0, 0));
    assert_eq!(counts.taken + counts.missed, 199, "the last readings are not answered yet");
}

#[test]
fn what_is_not_finite_is_counted_whatever_it_answers() {
    let set = [("sample", "0.01"), ("delay", "0.01"), ("external", "5")];
    let (mut engine, mut external, port, exchange) = bench(&set, false);
    let bad = |number| ControlCommand { run_id: 7, number, command: [[f64::NAN; 2]; 8], ..ControlCommand::default() };
    assert_eq!(steps(&mut engine, &mut external, &exchange, 20), None);
    // Of readings that were answered long ago, of the newest, and of such as nobody has made.
    for number in [3, 20, 1000] {
        port.0.borrow_mut().waiting = Some(bad(number));
        assert_eq!(steps(&mut engine, &mut external, &exchange, 1), None);
    }
    // Meant for another run it is nothing of ours.
    port.0.borrow_mut().waiting = Some(ControlCommand { run_id: 8, ..bad(20) });
    assert_eq!(steps(&mut engine, &mut external, &exchange, 1), None);
    assert_eq!(exchange.counters.external.now().refused, 3);
}

proptest! {
    /// Whatever a controller leaves out and however late it is: until a step says that a command is held, the machine does what it does
    /// under the same law of its own, to the last bit.
    #[test]
    fn every_step_that_differs_from_the_law_is_behind_one_that_says_held(
        (sample, delay, part) in (1_u32..4, 1_u32..20, 0_u32..2),
        lag in 0_usize..25,
        left_out in prop::collection::vec(1_u64..120, 0..12),
    ) {
        let port = Law::default();
        (port.0.borrow_mut().left_out, port.0.borrow_mut().lag) = (left_out, lag);
        let [sample, delay] = [f64::from(sample) * 0.01, f64::from(delay) * 0.01 + f64::from(part) * 0.004];
        let [sample, delay] = [sample, delay].map(|time| time.to_string());
        let set = [("sample", &*sample), ("delay", &*delay), ("external", "4")];
        let (differs, held, counts) = beside_the_law(port, &set, 300);
        prop_assert!(differs.is_none_or(|step| held.first().is_some_and(|held| *held <= step)), "{differs:?} {held:?}");
        prop_assert!(counts.missed > 0 || held.is_empty());
        prop_assert_eq!(differs.is_some(), counts.missed > 0);
    }
}

fn steps(engine: &mut Engine, external: &mut External<Port>, exchange: &Exchange, count: u64) -> Option<Trip> {
    for _ in 0..count {
        match external.before_step(engine, exchange, 0).unwrap() {
            Ready::Tripped(trip) => return Some(trip),
            Ready::Yes => assert_eq!(engine.step(), None),
            Ready::NotYet => {}
        }
    }
    None
}

#[test]
fn nothing_is_allocated_on_the_stepping_thread() {
    for lockstep in [false, true] {
        let set = [("sample", "0.01"), ("delay", "0.02"), ("external", "3"), ("noise", "0.001")];
        let (mut engine, mut external, port, exchange) = bench(&set, lockstep);
        let counted = allocation_counter::measure(|| {
            assert_eq!(steps(&mut engine, &mut external, &exchange, 300), None);
            port.0.borrow_mut().is_silent = true;
            assert_eq!(steps(&mut engine, &mut external, &exchange, 300), None);
        });
        assert_eq!(counted.count_total, 0, "lockstep {lockstep}");
        assert!(exchange.counters.external.now().taken >= 200);
    }
}

#[test]
fn the_law_of_the_bench_acts_until_enough_came_in_time_and_when_too_many_are_missing() {
    let (mut engine, mut external, port, exchange) =
        bench(&[("sample", "0.02"), ("delay", "0.02"), ("external", "5")], false);
    // A command a sample, and a sample every two steps: the fifth is taken with the sixth sample's step.
    assert_eq!(steps(&mut engine, &mut external, &exchange, 9), None);
    assert!(!exchange.counters.external.now().acting);
    assert_eq!(steps(&mut engine, &mut external, &exchange, 3), None);
    let counts = exchange.counters.external.now();
    assert_eq!((counts.acting, counts.took_over, counts.late, counts.missed), (true, 1, 0, 0));
    port.0.borrow_mut().is_silent = true;
    let sent = port.0.borrow().sent;
    while exchange.counters.external.now().acting {
        assert_eq!(steps(&mut engine, &mut external, &exchange, 1), None);
    }
    let counts = exchange.counters.external.now();
    assert_eq!((counts.lost, counts.missed), (1, 6), "five may be missing");
    assert!(port.0.borrow().sent - sent <= 8);
    // And back again.
    port.0.borrow_mut().is_silent = false;
    assert_eq!(steps(&mut engine, &mut external, &exchange, 20), None);
    assert_eq!(exchange.counters.external.now().took_over, 2);
}

#[test]
fn it_trips_only_once_there_has_been_a_controller() {
    let set = [("sample", "0.01"), ("delay", "0.01"), ("external", "5"), ("external_trip", "20")];
    let (mut engine, mut external, port, exchange) = bench(&set, false);
    port.0.borrow_mut().is_silent = true;
    assert_eq!(steps(&mut engine, &mut external, &exchange, 200), None);
    port.0.borrow_mut().is_silent = false;
    assert_eq!(steps(&mut engine, &mut external, &exchange, 20), None);
    port.0.borrow_mut().is_silent = true;
    let trip = steps(&mut engine, &mut external, &exchange, 200).expect("a trip");
    assert_eq!(trip.cause, 3);
    assert!(engine.is_held());
}

#[test]
fn in_lockstep_a_step_waits_for_the_command_of_its_sample() {
    let (mut engine, mut external, port, exchange) = bench(&[("sample", "0.02"), ("external", "5")], true);
    port.0.borrow_mut().is_silent = true;
    let look = |engine: &mut Engine, external: &mut External<Port>| {
        matches!(external.before_step(engine, &exchange, 0).unwrap(), Ready::NotYet)
    };
    assert!(look(&mut engine, &mut external) && look(&mut engine, &mut external));
    assert_eq!(port.0.borrow().sent, 1, "asked once");
    // The answer to something else is none.
    let other = ControlCommand { run_id: 7, number: 2, ..ControlCommand::default() };
    port.0.borrow_mut().waiting = Some(other);
    assert!(look(&mut engine, &mut external));
    port.0.borrow_mut().waiting = Some(ControlCommand { number: 1, ..other });
    assert!(!look(&mut engine, &mut external));
    assert_eq!(engine.step(), None);
    // The next step is between two samples.
    assert!(!look(&mut engine, &mut external));
    assert_eq!(engine.step(), None);
    assert!(look(&mut engine, &mut external));
}
