use rotor::{Rotor, Settings, builtin};
use wire::{State, Step, StepLayout};

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
    let mut state = State::new(StepLayout::new(3));
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
fn a_rotor_that_coasts_down_after_a_trip_is_told_step_by_step() {
    let (rotor, mut settings, _) = engine("off", 2.5, 0.01);
    (settings.trip, settings.coast_down) = (5.0, 0.5);
    let mut engine = Engine::new(program(&rotor, &settings, 0.01), 7, 1000);
    let trip = (0..1_000_000).find_map(|_| engine.step()).unwrap();
    assert!(trip.coasts(), "{trip}");
    assert!(trip.to_string().ends_with("past the limit of 5 e_t, and the speed coasts down"), "{trip}");
    let before = sent(&mut engine);
    (0..100).for_each(|_| assert_eq!(engine.step(), None));
    let after = sent(&mut engine);
    for state in [&before, &after] {
        assert!(state.flags().has(Flags::TRIPPED | Flags::COASTING) && !state.flags().stands_still());
        assert!((state.speed_rate() + 0.2 * state.speed()).abs() < 1e-9, "a rate in proportion to the speed");
    }
    assert!((after.tau() - before.tau() - 1.0).abs() < 1e-9 && after.speed() < before.speed());
}

#[test]
fn stepping_filling_and_taking_orders_allocate_nothing() {
    let (rotor, settings, mut engine) = engine("composite", 2.5, 0.01);
    let exchange = Exchange::default();
    let mut state = State::new(StepLayout::new(3));
    let other = Settings { speed: 3.0, ..settings };
    let multisine =
        "seed=1 period=50.0 lines=1..40 tones=20 away_from=2.5 amplitude=0.01 duration=250.0".parse().unwrap();
    let mut orders = vec![
        Box::new(Order::Settings { program: Box::new(program(&rotor, &other, 0.01)), revision: 2 }),
        Box::new(Order::Impulse { mass: 0, velocity: C64::new(0.1, 0.0) }),
        Box::new(Order::Restart),
        Box::new(Order::Excite(Some(Box::new(Excitation::of(&multisine).unwrap())))),
    ];
    let counted = allocation_counter::measure(|| {
        for step in 0..400 {
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
    assert_eq!(std::iter::from_fn(|| exchange.notices.pop()).count(), 4);
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
