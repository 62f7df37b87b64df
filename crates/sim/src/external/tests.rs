use std::cell::RefCell;
use std::rc::Rc;

use machine::{Pace, Program};
use rotor::builtin;

use super::*;

/// A controller in the same thread that answers every reading at once, with nothing, unless it is silent.
#[derive(Clone, Default)]
struct Port(Rc<RefCell<Answers>>);

#[derive(Default)]
struct Answers {
    waiting: Option<ControlCommand>,
    sent: u64,
    is_silent: bool,
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
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "individual").unwrap());
    for (key, value) in set {
        settings.assign(key, value).unwrap();
    }
    let program = Program::compile(&rotor, &settings, 2.5, Pace { dtau: 0.01, rate_hz: 1000.0 }).unwrap();
    let exchange = Exchange::new(program.words_at_most());
    let port = Port::default();
    let options = Options { lockstep, ..Options::default() };
    (Engine::new(program, 7, 1000), External::new(port.clone(), 7, &options), port, exchange)
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
    assert!(engine.is_tripped());
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
