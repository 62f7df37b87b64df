//! What a changing speed costs: the same machine steady, on a ramp and coasting down, stepped in turn, so that whatever else goes on in the
//! computer meets all three. `cargo bench -p machine --bench ramps`; promised is at most 10 % more on a ramp.

#![allow(clippy::print_stdout, reason = "a table on stdout is what it is for")]

use std::time::Instant;

use machine::{Leg, Machine, Program};
use rotor::{Feedback, Gain, Rotor, Settings, builtin};

/// Steps in a turn, and turns.
const STEPS: usize = 2000;
const TURNS: usize = 400;
/// So slow that no measurement sees the end of it.
const RATE: f64 = 1e-9;

fn main() {
    // `cargo test --benches` runs this too, to see that it runs.
    let turns = if std::env::args().any(|arg| arg == "--bench") { TURNS } else { 1 };
    println!("a step, the median of {turns} turns of {STEPS}; beside it what it costs of a steady one");
    println!("{:44} {:>10} {:>20} {:>20}", "", "steady", "ramp", "coast-down");
    let tables = |feedback: &mut Feedback| {
        for gain in feedback.bearings[0].signals.iter_mut().flat_map(|signal| &mut signal.gains) {
            let here = gain.at(2.5);
            *gain = Gain::Table(vec![(0.0, 0.9 * here), (2.0, here), (7.0, 1.1 * here)]);
        }
    };
    let lag = |feedback: &mut Feedback| feedback.bearings[0].parts.lag = 0.02;
    measured("three masses, constant gains", "three-mass", "individual", &|_| (), turns);
    measured("three masses, gains as tables of speed", "three-mass", "individual", &tables, turns);
    measured("one mass, a gain in proportion to speed", "jeffcott", "cancel", &|_| (), turns);
    measured("three masses, a loop with an actuator lag", "three-mass", "individual", &lag, turns);
}

fn measured(what: &str, rotor: &str, gains: &str, change: &dyn Fn(&mut Feedback), turns: usize) {
    let rotor = builtin::rotor(rotor).expect("built in");
    let mut feedback = builtin::feedback(&rotor, gains).expect("built in");
    change(&mut feedback);
    let legs = [None, Some(Leg::To { speed: 2.5, rate: RATE }), Some(Leg::Decay { speed: 0.0, rate: RATE })];
    let mut machines = legs.map(|leg| machine(&rotor, &feedback, leg));
    let mut times = [const { Vec::new() }; 3];
    for _ in 0..turns {
        for (machine, times) in machines.iter_mut().zip(&mut times) {
            let began = Instant::now();
            for _ in 0..STEPS {
                machine.step();
            }
            times.push(began.elapsed().as_nanos() as f64 / STEPS as f64);
            assert!(machine.trip().is_none(), "it stands still");
        }
    }
    let [steady, ramp, decay] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let beside = |time: f64| format!("{time:.1} ns ({:+.1} %)", 100.0 * (time / steady - 1.0));
    println!("{what:44} {:>10} {:>20} {:>20}", format!("{steady:.1} ns"), beside(ramp), beside(decay));
}

/// At R = 2.5 with clearances in play, or on its way as `leg` says.
fn machine(rotor: &Rotor, feedback: &Feedback, leg: Option<Leg>) -> Machine {
    let mut settings = Settings::new(rotor, 2.5, feedback.clone());
    settings.deadband.fill(0.2);
    let program = Program::in_substeps(rotor, &settings, 0.01, 1).expect("can be stepped");
    match leg {
        None => Machine::new(program),
        Some(leg) => Machine::spinning(program.following(vec![leg]), 2.4),
    }
}
