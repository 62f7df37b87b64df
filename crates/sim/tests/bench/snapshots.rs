//! Snapshots, from which a machine goes on.

use std::thread;
use std::time::{Duration, Instant};

use rotor::{C64, builtin};
use wire::{Change, Listener, Step};

use crate::support::{PATIENCE, beside};

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
