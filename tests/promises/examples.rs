//! The examples of the crates do what they say: each is compiled into this test too, and its one function is called.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

#[path = "../../crates/machine/examples/poles.rs"]
#[allow(dead_code, reason = "its command line is not tried here")]
mod poles;
#[cfg(feature = "rerun")]
#[path = "../../crates/tape/examples/read_back.rs"]
#[allow(dead_code, reason = "its command line is not tried here")]
mod read_back;
#[path = "../../crates/tuner/examples/search.rs"]
#[allow(dead_code, reason = "its command line is not tried here")]
mod search;
#[path = "../../crates/wire/examples/watch.rs"]
#[allow(dead_code, reason = "its command line is not tried here")]
mod watch;

use promises::{PATIENCE, Root, run};
use wire::Carrier;

#[test]
fn the_poles_of_a_rotor_of_ones_own_are_those_of_the_command() {
    let mine = run(&["rotor", "show", "three-mass"]).stdout;
    let found = poles::poles(&mine, &[0.0, 2.5]).unwrap();
    for (speed, poles) in found {
        let told = run(&["poles", "three-mass", "--speed", &speed.to_string(), "--json"]).json();
        assert_eq!(poles.modes.len(), 6);
        for (mode, told) in poles.modes.iter().zip(told["modes"].as_array().unwrap()) {
            assert_eq!((told["re"].as_f64(), told["im"].as_f64()), (Some(mode.pole.re), Some(mode.pole.im)));
        }
    }
    assert!(poles::poles("[[mass]]\n", &[0.0]).is_err());
}

#[test]
fn the_search_finds_what_the_command_finds() {
    let found = search::search(4.0, 4.0).unwrap();
    let told = run(&["tune", "three-mass", "--speed", "4", "--bound", "5", "--json"]).json();
    assert!((told["min_damping"].as_f64().unwrap() - found.worst.value).abs() < 1e-6, "{told}");
}

#[test]
fn the_reader_of_telemetry_hears_a_bench() {
    let root = Root::new();
    let simulation = root.simulate(&["jeffcott", "--bench", "heard"]);
    let carrier = wire::SharedMemory::new(&wire::Root::at(root.path()).unwrap(), "watch").unwrap();
    let mut listener = carrier.listen(&"heard".parse().unwrap()).unwrap();
    let start = std::time::Instant::now();
    let (tau, radius) = loop {
        if let Some(heard) = watch::largest(&mut listener).unwrap() {
            break heard;
        }
        assert!(start.elapsed() < PATIENCE, "nothing is heard");
        std::thread::sleep(std::time::Duration::from_millis(10));
    };
    assert!(tau > 0.0 && radius > 0.0 && radius < 1000.0, "{radius} at {tau}");
    drop(listener);
    assert_eq!(simulation.end().code, Some(0));
}

#[cfg(feature = "rerun")]
#[test]
fn recordings_are_read_back_as_info_tells_them() {
    let path = promises::paper::top().join("recordings/run-up.rrd");
    let (speed, tau, radius) = read_back::widest(&path).unwrap();
    let told = run(&["info", path.to_str().unwrap(), "--json"]).json();
    assert_eq!(told["max_radius"]["value"].as_f64(), Some(radius));
    assert_eq!(told["max_radius"]["tau"].as_f64(), Some(tau));
    assert!(speed > 1.776, "past its threshold");
}
