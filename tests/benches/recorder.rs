//! Measures what a recorder costs the simulation that it records, on the machine at hand, and prints a table.
//!
//! `cargo bench -p promises --features rerun --bench recorder` (5 minutes). Benches with dashboard and without a recorder
//! take turns with benches that are recorded, so that what else the machine does falls on both alike; then one is recorded
//! for a minute and its steps are counted. It judges nothing; machines and their load differ.

#![allow(clippy::print_stdout, reason = "a table on stdout is what it is for")]

mod shared;

use std::path::Path;
use std::time::Duration;

use promises::{Root, Screen};
use shared::{SIZE, machine, median, status};

/// How often a bench with and a bench without take turns.
const TURNS: usize = 9;
/// How long each is watched.
const WATCH: Duration = Duration::from_secs(10);
/// How long losses are watched.
const LONG_WATCH: Duration = Duration::from_secs(60);
/// Steps a second.
const RATE: &str = "20000";

fn main() {
    // Both percentiles of the step cost in microseconds, without a recorder and with one.
    let (mut without, mut with) = ([const { Vec::new() }; 2], [const { Vec::new() }; 2]);
    for _ in 0..TURNS {
        for (costs, recorded) in [(&mut without, false), (&mut with, true)] {
            let [p50, p99] = watch(recorded, WATCH, |_| ());
            costs[0].push(p50);
            costs[1].push(p99);
        }
    }
    let mut told = String::new();
    watch(true, LONG_WATCH, |recording| {
        let info = promises::run(&["info", recording, "--json"]).json();
        told = format!("{} of {} steps lost in {} s", info["lost"], info["steps"], LONG_WATCH.as_secs());
    });

    println!("{}\n", machine());
    println!(
        "| step cost at {RATE} steps/s, n = 3, with dashboard | without recorder | with | change |\n|---|---|---|---|"
    );
    for (name, (without, with)) in ["median", "99th percentile"].iter().zip(without.iter_mut().zip(&mut with)) {
        let mut ratios: Vec<f64> = without.iter().zip(with.iter()).map(|(without, with)| with / without).collect();
        let change = (median(&mut ratios) - 1.0) * 100.0;
        println!("| {name} | {:.3} us | {:.3} us | {change:+.1} % |", median(without), median(with));
    }
    println!("\n{told}");
}

/// Runs a bench with a dashboard, recorded or not, and returns both percentiles of its step cost. Then lets `look` see the
/// recording.
fn watch(recorded: bool, duration: Duration, mut look: impl FnMut(&str)) -> [f64; 2] {
    let root = Root::new();
    let path = root.path().join("recording.rrd");
    let path: &str = Path::to_str(&path).expect("a path in words");
    let mut arguments = vec!["up", "three-mass", "--rate", RATE];
    if recorded {
        arguments.extend(["--record", path]);
    }
    let mut screen = Screen::start(root.path(), &arguments, SIZE);
    screen.wait_words("RUNNING");
    std::thread::sleep(duration);
    let bench = status(&root);
    screen.press("q");
    screen.ended();
    if recorded {
        look(path);
    }
    ["p50", "p99"].map(|of| bench["step_cost_us"][of].as_f64().expect("a cost"))
}
