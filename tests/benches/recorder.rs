//! Measures what a recorder costs the simulation that it records, on the machine at hand, and prints a table.
//!
//! `cargo bench -p promises --features rerun --bench recorder` (5 minutes, Linux). Benches with dashboard and without a
//! recorder take turns with benches that are recorded, so that what else the machine does falls on both alike. What differs
//! from bench to bench all the same falls away in the second table: there a recorder comes and goes on one bench. Then one is
//! recorded for a minute and its steps are counted. It judges nothing; machines and their load differ.

#![allow(clippy::print_stdout, reason = "a table on stdout is what it is for")]

mod shared;

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use promises::{Root, Screen};
use rustix::process::{Pid, Signal, kill_process};
use shared::{SIZE, machine, median, percentile, status};

/// How often a bench with and a bench without take turns.
const TURNS: usize = 5;
/// How often a recorder comes and goes.
const VISITS: usize = 10;
/// How long the bench is watched with it, and without.
const VISIT: Duration = Duration::from_secs(4);
/// What a recorder needs to be at work.
const START: Duration = Duration::from_secs(1);
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
    let (mut alone, mut visited) = visits();
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
    println!(
        "\n| processor time of the stepping thread a step, mean, one bench | without | with | change |\n|---|---|---|---|"
    );
    let mut ratios: Vec<f64> = alone.iter().zip(&visited).map(|(without, with)| with / without).collect();
    let spread = [0.0, 0.5, 1.0].map(|share| format!("{:+.1} %", (percentile(&mut ratios, share) - 1.0) * 100.0));
    let [least, middle, most] = spread;
    let (without, with) = (median(&mut alone), median(&mut visited));
    println!("| median of {VISITS} turns | {without:.3} us | {with:.3} us | {middle} ({least} to {most}) |");
    println!("\n{told}");
}

/// Processor time that the stepping thread of one simulation takes a step, in microseconds: turn by turn without a recorder
/// and with one.
fn visits() -> (Vec<f64>, Vec<f64>) {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &["up", "three-mass", "--rate", RATE], SIZE);
    screen.wait_words("RUNNING");
    let pid = status(&root)["pid"].as_u64().expect("a running simulation");
    let (mut without, mut with) = (Vec::new(), Vec::new());
    for turn in 0..VISITS {
        std::thread::sleep(START);
        without.push(processor_time(&root, pid));
        let path = root.path().join(format!("visit-{turn}.rrd"));
        let mut command = root.whirl();
        command.arg("record").arg(&path).stdout(Stdio::null()).stderr(Stdio::null());
        let mut recorder = command.spawn().expect("whirl starts");
        std::thread::sleep(START);
        with.push(processor_time(&root, pid));
        let recorder_pid = Pid::from_raw(recorder.id() as i32).expect("a process id");
        kill_process(recorder_pid, Signal::INT).expect("the recorder is there");
        recorder.wait().expect("it ends");
    }
    screen.press("q");
    screen.ended();
    (without, with)
}

/// Processor time a step of the main thread of a simulation, over one watch.
fn processor_time(root: &Root, pid: u64) -> f64 {
    let steps = || status(root)["steps"].as_u64().expect("a running simulation") as f64;
    // Nanoseconds on a processor come first.
    let busy = || {
        let told = fs::read_to_string(format!("/proc/{pid}/task/{pid}/schedstat")).expect("a running process");
        told.split_whitespace().next().and_then(|text| text.parse::<f64>().ok()).expect("a number")
    };
    let (first, before) = (steps(), busy());
    std::thread::sleep(VISIT);
    (busy() - before) / (steps() - first) / 1e3
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
