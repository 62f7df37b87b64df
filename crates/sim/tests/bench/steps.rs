//! Steps, what the bench status tells of them, and options that make none.

use std::sync::atomic::AtomicBool;

use rotor::{C64, Modes, Settings, builtin};
use sim::Options;
use wire::{BenchName, Carrier, Memory, Step, WireError};

use crate::support::beside;

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
