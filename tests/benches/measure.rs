//! Measures what docs/book/src/measurements.md promises of the live bench, on the machine at hand, and prints a table.
//!
//! `cargo bench -p promises --bench measure`. It drives the real program in a real pseudo-terminal and reads the
//! processes' own accounts in `/proc`: Linux only. It judges nothing; machines and their load differ.

#![allow(clippy::print_stdout, reason = "a table on stdout is what it is for")]

mod shared;

use std::fs;
use std::time::{Duration, Instant};

use promises::{Root, Screen};
use shared::{SIZE, machine, median, percentile, status};

/// How long processor time is watched.
const WATCH: Duration = Duration::from_secs(10);
/// How long sequence numbers are watched.
const LONG_WATCH: Duration = Duration::from_secs(60);
/// Keys pressed to time their answers.
const PRESSES: usize = 101;
/// Clock ticks a second in `/proc/PID/stat`: fixed on Linux.
const TICKS: f64 = 100.0;

fn main() {
    let mut rows: Vec<(&str, String, &str)> = Vec::new();
    let root = Root::new();

    let mut starts: Vec<f64> = (0..9).map(|_| first_frame(&root)).collect();
    rows.push(("first frame with live data after `whirl up`", format!("{:.0} ms", median(&mut starts)), "under 1 s"));

    let mut screen = Screen::start(root.path(), &[], SIZE);
    screen.wait_words("RUNNING");
    screen.wait_words("three-mass");
    let simulation = simulation_of(&root);
    let dashboard = screen.pid();

    rows.push((
        "key to screen, with the simulation's answer",
        told(&mut key_to_screen(&mut screen)),
        "median under 50 ms",
    ));

    let watched = Instant::now();
    let lost_before = lost(&screen);
    let steps_before = status(&root)["steps"].as_u64().unwrap_or(0);
    let running = (busy(simulation), busy(dashboard));
    std::thread::sleep(WATCH);
    let after = (busy(simulation), busy(dashboard));
    let share = |from: f64, to: f64| format!("{:.1} % of a core", (to - from) / WATCH.as_secs_f64() * 100.0);
    rows.push(("simulation, 1000 steps/s, n = 3", share(running.0, after.0), "under 5 %"));
    rows.push(("dashboard, 200 x 60, 30 frames/s", share(running.1, after.1), "under 10 %"));

    screen.press(" ");
    screen.wait_words("PAUSED");
    let paused = busy(dashboard);
    std::thread::sleep(WATCH);
    rows.push(("dashboard, paused", share(paused, busy(dashboard)), "near zero"));
    screen.press(" ");
    screen.wait_words("RUNNING");

    std::thread::sleep(LONG_WATCH.saturating_sub(watched.elapsed()));
    let bench = status(&root);
    let steps = bench["steps"].as_u64().unwrap_or(0) - steps_before;
    let lost = lost(&screen) - lost_before;
    let seen = format!("{lost} of {steps} lost in {:.0} s", watched.elapsed().as_secs_f64());
    rows.push(("sequence numbers seen by the dashboard", seen, "none lost"));
    let number = |field: &str, of: &str| bench[field][of].as_f64().unwrap_or(f64::NAN);
    let cost = format!(
        "{:.1} us median, {:.1} us at the 99th percentile",
        number("step_cost_us", "p50"),
        number("step_cost_us", "p99")
    );
    rows.push(("step, fill and send", cost, "median under 10 us"));
    let late = ["p50", "p99", "max"].map(|of| format!("{:.0}", number("lateness_us", of))).join(" / ");
    rows.push(("lateness of a step: median / 99th percentile / worst", late + " us", ""));
    rows.push(("memory of the simulation", resident(simulation), "under 50 MB"));
    rows.push(("memory of the dashboard", resident(dashboard), "under 50 MB"));
    screen.press("q");
    screen.ended();

    let mut screen = Screen::start(root.path(), &["up", "--rate", "20000"], SIZE);
    screen.wait_words("RUNNING");
    screen.wait_words("three-mass");
    let answers = told(&mut key_to_screen(&mut screen));
    rows.push(("key to screen at 20 000 steps/s", answers, "median under 20 ms, under 50 ms at the 99th percentile"));
    screen.press("q");
    screen.ended();

    println!("{}\n", machine());
    println!("| what | measured | promised |\n|---|---|---|");
    for (what, measured, promised) in rows {
        println!("| {what} | {measured} | {promised} |");
    }
}

/// Times in words.
fn told(times: &mut [f64]) -> String {
    let worst = percentile(times, 0.99);
    format!("{:.1} ms median, {worst:.1} ms at the 99th percentile", median(times))
}

/// Milliseconds from the start of `whirl up` to a frame with a moving rotor.
fn first_frame(root: &Root) -> f64 {
    let start = Instant::now();
    let mut screen = Screen::start(root.path(), &[], SIZE);
    screen.wait("a first frame", |text| (text.contains("RUNNING") && text.contains("│now ")).then_some(()));
    let elapsed = start.elapsed();
    screen.press("q");
    screen.ended();
    elapsed.as_secs_f64() * 1e3
}

/// Milliseconds from a key to the frame with the simulation's answer to it, for many keys.
fn key_to_screen(screen: &mut Screen) -> Vec<f64> {
    let revision = |text: &str| -> Option<u64> {
        let rest = &text[text.find("settings  rev ")? + "settings  rev ".len()..];
        rest.split_whitespace().next()?.parse().ok()
    };
    let mut times = Vec::new();
    for press in 0..PRESSES {
        let before = screen.wait("a revision", revision);
        let start = Instant::now();
        screen.press(if press % 2 == 0 { "l" } else { "h" });
        screen.wait("the answer", |text| (revision(text)? > before).then_some(()));
        times.push(start.elapsed().as_secs_f64() * 1e3);
        // Keys come at any time between two frames.
        std::thread::sleep(Duration::from_millis(20 + (press as u64 * 7) % 40));
    }
    times
}

fn simulation_of(root: &Root) -> u32 {
    status(root)["pid"].as_u64().expect("a running simulation") as u32
}

/// The count of lost steps on the status line.
fn lost(screen: &Screen) -> u64 {
    screen.wait("the count of losses", |text| text[text.find("lost ")? + 5..].split_whitespace().next()?.parse().ok())
}

/// Processor seconds that a process has used.
fn busy(pid: u32) -> f64 {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).expect("a running process");
    // The name, in brackets, may hold blanks.
    let fields: Vec<&str> = stat[stat.rfind(')').expect("a name") + 1..].split_whitespace().collect();
    let ticks = |at: usize| fields[at].parse::<f64>().expect("a number of ticks");
    (ticks(11) + ticks(12)) / TICKS
}

/// Resident memory of a process.
fn resident(pid: u32) -> String {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).expect("a running process");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("an account of memory");
    let kilobytes: f64 = line.split_whitespace().nth(1).and_then(|text| text.parse().ok()).expect("a number");
    format!("{:.1} MB", kilobytes / 1024.0)
}
