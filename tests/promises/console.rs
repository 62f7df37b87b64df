//! The dashboard in a real terminal, with real processes: what a newcomer does first.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::time::{Duration, Instant};

use promises::{Root, Screen, run};
use rustix::process::{Pid, Signal, kill_process, test_kill_process};

/// The whole number or fraction that follows `label` on the screen.
fn number_after(text: &str, label: &str) -> Option<f64> {
    let rest = &text[text.find(label)? + label.len()..];
    let number: String = rest.trim_start().chars().take_while(|c| c.is_ascii_digit() || "+-.e".contains(*c)).collect();
    number.parse().ok()
}

/// The log decrement that the damping panel prints.
fn log_decrement(text: &str) -> Option<f64> {
    let at = text.lines().position(|line| line.contains("log dec"))?;
    let line = text.lines().nth(at)?;
    let column = line[..line.find("log dec")?].chars().count();
    let below: String = text.lines().nth(at + 1)?.chars().skip(column).take_while(|c| !"│ ".contains(*c)).collect();
    below.parse().ok()
}

fn is_alive(pid: u32) -> bool {
    test_kill_process(Pid::from_raw(pid as i32).unwrap()).is_ok()
}

/// The simulation process of a bench under `root`.
fn simulation_of(root: &Root) -> u32 {
    root.run(&["status", "--json"]).json()["benches"][0]["pid"].as_u64().unwrap() as u32
}

#[test]
fn start_nudge_switch_off_trip_restart_and_quit() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (140, 45));
    screen.wait_words("RUNNING");
    screen.wait_words("three-mass");
    let pid = simulation_of(&root);
    assert!(is_alive(pid));

    // Live numbers move.
    let first = screen.wait("control force", |text| number_after(text, "│now "));
    screen.wait("another force", |text| number_after(text, "│now ").filter(|now| *now != first));

    // Nudge a gain: the panel shows it, and the minimum damping becomes what `whirl poles` gives for these gains.
    let before = screen.wait("the log decrement", log_decrement);
    screen.press_for("jjj", "▶ kd");
    screen.press_for("L", "-0.4879");
    screen.wait_words("rev 2");
    let state = root.run(&["tail", "--count", "1", "--json"]);
    assert!(state.stdout.contains("\"revision\":2"), "{}", state.stdout);
    let feedback = root.path().join("nudged.toml");
    let gains = "bearing = 1\n[[signal]]\ndisplacement = [1, 1, 0]\nvelocity = [1, 1, 0]\nkd = -0.4879\ncd = 0.4948\nkc = -0.4847\ncc = 0.6483\n";
    std::fs::write(&feedback, gains).unwrap();
    let poles = run(&["poles", "--speed", "2.5", "--feedback", feedback.to_str().unwrap(), "--json"]).json();
    let expected = poles["modes"][0]["log_dec"].as_f64().unwrap();
    let shown = screen.wait("the new log decrement", |text| log_decrement(text).filter(|now| *now != before));
    assert!((shown - expected).abs() < 1e-4, "shown {shown}, expected {expected}");
    let status = root.run(&["status", "--json"]).json();
    assert_eq!(status["benches"][0]["min_damping"], poles["min_damping"]);

    // Control off: unstable at once, and in time the trip.
    assert_eq!(root.run(&["set", "trip=8"]).code, Some(0));
    screen.press_for("0", "UNSTABLE with that: minimum damping -0.0306");
    screen.press_for("y", "control off, from step");
    screen.wait_words("TRIPPED");
    screen.wait_words("past the limit of 8 e_t");
    let (color, is_badge) = screen.color_of("TRIPPED").unwrap();
    assert_eq!((color, is_badge), (vt100::Color::Idx(1), true), "red, reversed");

    // Undo brings the gains back, R the rotor.
    screen.press_for("u", "undone");
    screen.press_for("R", "RUNNING");
    assert!(!screen.text().contains("UNSTABLE"));

    screen.press("q");
    let status = screen.ended();
    assert!(status.success(), "{status:?}");
    assert!(!screen.is_taken(), "the terminal is given back");
    assert!(!is_alive(pid), "the simulation has ended");
    assert_eq!(root.leftovers(), ["nudged.toml"], "nothing of the bench is left");
}

#[test]
fn a_small_window_says_what_it_needs_and_q_still_works() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    screen.wait_words("RUNNING");
    screen.resize(40, 10);
    screen.wait_words("needs 60 x 16");
    screen.resize(90, 28);
    screen.wait_words("minimum damping");
    screen.resize(50, 5);
    screen.wait_words("needs 60 x 16");
    screen.press("q");
    assert!(screen.ended().success());
    assert!(!screen.is_taken());
}

#[test]
fn help_pause_typing_undo_and_redo_work() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &["up", "jeffcott", "--speed", "3"], (140, 45));
    screen.wait_words("jeffcott");
    screen.press_for("?", "undo the last change, whoever made it");
    let closed = |text: &str| (!text.contains("undo the last change")).then_some(());
    screen.press_until("\x1b", "the help to close", closed);
    screen.press_for("\r4.5\r", "speed = 4.5, from step");
    screen.wait_words("R 4.5");
    screen.press_for("u", "R 3 ");
    screen.press_for("\x12", "R 4.5");
    screen.press_for("\r99999\r", "expected a number from 0 to 1000");
    screen.press_for("i", "impulse -2.5 on mass 1");
    screen.press_for(" ", "PAUSED");
    let still = screen.wait("a force", |text| number_after(text, "│was "));
    // The clock of the top line tells that frames are drawn meanwhile.
    let behind = |text: &str| number_after(text, "PAUSED   -");
    let before = screen.wait("how far behind it stands", behind);
    screen.wait("another frame", |text| behind(text).filter(|now| *now > before + 0.3));
    assert_eq!(number_after(&screen.text(), "│was "), Some(still));
    screen.press(" ");
    screen.wait("the motion to go on", |text| number_after(text, "│now ").filter(|now| *now != still));
    screen.press("\x03");
    assert!(screen.ended().success());
    assert!(!screen.is_taken());
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_dashboard_outlives_its_simulation_and_picks_up_the_next() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass"]);
    let mut screen = Screen::start(root.path(), &["dash"], (120, 40));
    screen.wait_words("three-mass");
    screen.wait_words("RUNNING");
    simulation.signal(Signal::STOP);
    screen.wait_words("STALLED");
    simulation.signal(Signal::CONT);
    screen.wait_words("RUNNING");
    let steps = root.run(&["tail", "--every", "100", "--count", "3"]);
    assert_eq!(steps.code, Some(0), "being stopped and continued is no harm: {steps:?}");
    simulation.signal(Signal::KILL);
    drop(simulation);
    screen.wait_words("SIMULATION GONE");
    assert!(screen.text().contains("orbits"), "the last picture stays");
    let refused = |text: &str| (text.contains("no bench") || text.contains("did not answer")).then_some(());
    screen.press_until("l", "a refusal", refused);
    let next = root.simulate(&["jeffcott"]);
    screen.wait_words("jeffcott");
    screen.wait_words("RUNNING");
    screen.press("q");
    assert!(screen.ended().success());
    assert_eq!(root.run(&["tail", "--count", "1"]).code, Some(0), "quitting `dash` leaves the simulation alone");
    assert_eq!(next.end().code, Some(0));
}

#[test]
fn killing_the_simulation_of_up_is_said_at_once_and_r_brings_it_back() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (120, 40));
    screen.wait_words("RUNNING");
    let pid = simulation_of(&root);
    kill_process(Pid::from_raw(pid as i32).unwrap(), Signal::KILL).unwrap();
    screen.wait_words("SIMULATION GONE");
    screen.wait_words("R starts it again");
    screen.press_for("R", "RUNNING");
    let second = simulation_of(&root);
    assert_ne!(second, pid);
    screen.press("q");
    assert!(screen.ended().success());
    assert!(!is_alive(second));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn signals_restore_the_terminal_and_end_the_simulation() {
    for signal in [Signal::INT, Signal::TERM, Signal::HUP] {
        let root = Root::new();
        let mut screen = Screen::start(root.path(), &[], (100, 30));
        screen.wait_words("RUNNING");
        let pid = simulation_of(&root);
        kill_process(Pid::from_raw(screen.pid() as i32).unwrap(), signal).unwrap();
        let status = screen.ended();
        assert_eq!(status.exit_code(), 130, "{signal:?}");
        assert!(!screen.is_taken(), "{signal:?}");
        assert!(!is_alive(pid), "{signal:?}");
        assert_eq!(root.leftovers(), Vec::<String>::new(), "{signal:?}");
    }
}

#[test]
fn a_panic_restores_the_terminal_tells_where_and_ends_the_simulation() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    screen.wait_words("RUNNING");
    let pid = simulation_of(&root);
    kill_process(Pid::from_raw(screen.pid() as i32).unwrap(), Signal::URG).unwrap();
    assert_eq!(screen.ended().exit_code(), 1);
    assert!(!screen.is_taken());
    assert!(screen.text().contains("a test asked for this panic"), "{}", screen.text());
    assert!(!is_alive(pid));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_killed_dashboard_takes_its_simulation_with_it() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    screen.wait_words("RUNNING");
    let pid = simulation_of(&root);
    kill_process(Pid::from_raw(screen.pid() as i32).unwrap(), Signal::KILL).unwrap();
    screen.ended();
    let start = Instant::now();
    while is_alive(pid) {
        assert!(start.elapsed() < promises::PATIENCE, "the simulation lives on");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(root.run(&["clean"]).code, Some(0));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_taken_name_is_refused_before_the_screen_is_taken_over() {
    let root = Root::new();
    let _simulation = root.simulate(&["--bench", "a"]);
    let mut screen = Screen::start(root.path(), &["up", "--bench", "a"], (100, 30));
    assert_eq!(screen.ended().exit_code(), 3);
    screen.wait_words("bench 'a' is taken by a running simulation");
    assert!(!screen.is_taken());
}
