//! What an engineer does at the dashboard, in a real terminal: each from what the help on the screen tells.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, Screen};

const SIZE: (u16, u16) = (150, 50);

fn started(root: &Root) -> Screen {
    let screen = Screen::start(root.path(), &[], SIZE);
    screen.wait_words("RUNNING");
    screen.wait_words("three-mass");
    screen
}

fn quit(mut screen: Screen) {
    screen.press("\x03");
    assert!(screen.ended().success());
    assert!(!screen.is_taken());
}

#[test]
fn the_least_damped_mode_is_found_and_layouts_are_switched() {
    let root = Root::new();
    let mut screen = started(&root);
    let poles = promises::run(&["poles", "--speed", "2.5", "--feedback", "composite", "--json"]).json();
    let least = poles["modes"][0]["re"].as_f64().unwrap();
    screen.wait_words(&format!("◆ {least:.4}"));
    screen.press("3");
    screen.wait_words("damping over speed");
    screen.press(":lay\twhi\t\r");
    screen.wait_words("spectrum");
    screen.press(":layout nope\r");
    screen.wait_words("no layout 'nope'");
    quit(screen);
}

#[test]
fn two_gain_sets_are_compared_and_kept() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press("B");
    screen.wait_words("held");
    screen.press("jjjL");
    screen.wait_words("-0.4879");
    screen.press("b");
    screen.wait_words("-0.5879");
    screen.press("b");
    screen.wait_words("-0.4879");
    screen.press("smine\r");
    screen.wait_words("gains kept as 'mine'");
    let kept = root.path().join("data/whirl/presets/mine.toml");
    let poles = promises::run(&["poles", "--speed", "2.5", "--feedback", kept.to_str().unwrap(), "--json"]).json();
    let status = root.run(&["status", "--json"]).json();
    assert_eq!(poles["min_damping"], status["benches"][0]["min_damping"]);
    screen.press("b");
    screen.wait_words("-0.5879");
    screen.press("o");
    screen.wait_words("mine  min damping ");
    screen.press("mine\r");
    screen.wait_words("-0.4879");
    quit(screen);
}

#[test]
fn dashboards_share_one_history_of_changes_and_ask_before_undo_does_harm() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass"]);
    let mut first = Screen::start(root.path(), &["dash"], SIZE);
    let mut second = Screen::start(root.path(), &["dash"], SIZE);
    first.wait_words("RUNNING");
    second.wait_words("RUNNING");
    // Two changes by others within one bulletin are two steps.
    assert_eq!(root.run(&["set", "speed=2.6"]).code, Some(0));
    assert_eq!(root.run(&["set", "deadband=0.5"]).code, Some(0));
    first.wait_words("R 2.6");
    first.press("u");
    first.wait_words("undone: deadband 0.5 -> 1, made by set:");
    first.press("u");
    first.wait_words("undone: speed 2.6 -> 2.5, made by set:");
    // The other sees who did it, and can do it again.
    second.wait_words("R 2.5 ");
    second.wait_words(&format!("by dash:{}", first.pid()));
    second.press("\x12");
    second.wait_words("done again: speed 2.5 -> 2.6, made by set:");
    first.wait_words(&format!("by dash:{}", second.pid()));
    // From unstable settings back to good ones nobody asks; forward again somebody does.
    first.press(":speed 9\r");
    first.wait_words("UNSTABLE with that");
    first.press("y");
    first.wait_words("speed = 9, from step");
    second.wait_words("R 9 ");
    second.press("u");
    second.wait_words("undone: speed 9 -> 2.6, made by dash:");
    second.press("\x12");
    second.wait_words("UNSTABLE with that");
    second.press("n");
    second.wait("the question to close", |text| (!text.contains("UNSTABLE with that")).then_some(()));
    assert_eq!(root.run(&["status", "--json"]).json()["benches"][0]["speed"], 2.6);
    quit(first);
    quit(second);
    assert_eq!(simulation.end().code, Some(0));
}

/// The largest force that the panel of forces tells.
fn largest_force(text: &str) -> Option<f64> {
    text.split("│max").nth(1)?.split_whitespace().next()?.parse().ok()
}

#[test]
fn thirty_seconds_back_the_force_is_read_at_its_peak_while_data_go_on() {
    let root = Root::new();
    let mut screen = started(&root);
    // The force since the last change is told: a change begins it anew.
    screen.press(":trip=900\r");
    screen.wait_words("trip = 900, from step");
    let begun = std::time::Instant::now();
    let listens = root.whirl().args(["tail", "--count", "6000", "--json"]).stdout(std::process::Stdio::piped()).spawn();
    screen.press("i");
    screen.wait_words("impulse -2.5 on mass 1");
    let heard = String::from_utf8(listens.unwrap().wait_with_output().unwrap().stdout).unwrap();
    let forces = heard.lines().map(|line| {
        let force = &serde_json::from_str::<serde_json::Value>(line).unwrap()["force"];
        force["y"].as_f64().unwrap().hypot(force["z"].as_f64().unwrap())
    });
    let peak = forces.fold(0.0, f64::max);
    // Then the bearing works harder than it did.
    for _ in 0..4 {
        screen.press("i");
        std::thread::sleep(std::time::Duration::from_millis(120));
    }
    screen.wait("more force", |text| largest_force(text).filter(|now| *now > 1.05 * peak));
    std::thread::sleep(std::time::Duration::from_secs(33).saturating_sub(begun.elapsed()));
    screen.press("{{{");
    screen.wait_words("PAUSED   -30.");
    let then = screen.wait("the peak", |text| largest_force(text).filter(|then| (then - peak).abs() < 1e-3));
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert_eq!(largest_force(&screen.text()), Some(then), "the picture stands");
    screen.press("+");
    screen.wait_words("2.00 s");
    screen.press(" ");
    screen.wait_words("RUNNING");
    screen.wait("the newest", |text| largest_force(text).filter(|now| *now > 1.05 * peak));
    quit(screen);
}

#[test]
fn a_plot_is_chosen_its_scale_fixed_and_read_and_strips_show_what_was_asked_for() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press(":scale orbits -7..7\r");
    screen.wait_words("±7.0 e_t fixed");
    screen.press("\t=");
    screen.wait_words("┏ poles");
    screen.press(".");
    screen.wait_words("◈ ");
    // Shift-tab as terminals send it.
    screen.press("\x1b[Z");
    screen.wait("another plot", |text| (!text.contains("┏ poles") && text.contains('┏')).then_some(()));
    screen.press(":scale orbits auto\r");
    screen.wait("a scale that follows", |text| (!text.contains("fixed")).then_some(()));
    screen.press(":strips radius.2 damping\r");
    screen.wait_words("│radius.2 ");
    screen.wait_words("│damping ");
    screen.press(":strips auto\r");
    screen.wait_words("│u");
    quit(screen);
}

#[test]
fn the_alarm_that_fired_is_found_and_acknowledged() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press(":trip=8\r");
    screen.wait_words("trip = 8, from step");
    screen.press("0");
    screen.wait_words("UNSTABLE with that");
    screen.press("y");
    screen.wait_words("TRIPPED");
    screen.press("2");
    screen.wait_words("not acknowledged");
    screen.wait("the alarm, at the top", |text| text.lines().next()?.contains("!! ALARM").then_some(()));
    screen.press("a");
    screen.wait("its acknowledgement", |text| {
        (text.contains("alarm acknowledged") || text.contains("alarms acknowledged")).then_some(())
    });
    quit(screen);
}

#[test]
fn keys_of_ones_own_are_bound_and_mistakes_refused_before_anything_starts() {
    let root = Root::new();
    let folder = root.path().join("config/whirl");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("config.toml"), "layout = \"operator\"\n[keys]\nx = \"layout whirl\"\n").unwrap();
    let mut screen = Screen::start(root.path(), &[], SIZE);
    screen.wait_words("force budget");
    screen.press("x");
    screen.wait_words("spectrum");
    quit(screen);
    std::fs::write(folder.join("config.toml"), "[keys]\nx = \"undo\"\nx = \"redo\"\n").unwrap();
    let mut screen = Screen::start(root.path(), &[], SIZE);
    assert_eq!(screen.ended().exit_code(), 2);
    screen.wait_words("config.toml:3:1");
}

#[test]
fn a_read_only_dashboard_changes_nothing_and_ctrl_z_does_no_harm() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass"]);
    let mut screen = Screen::start(root.path(), &["dash", "--read-only"], SIZE);
    screen.wait_words("RUNNING");
    screen.press("l0uR");
    screen.wait_words("read-only: this dashboard changes nothing");
    // No shell waits here, so that the system lets it run on.
    screen.press("\x1a");
    screen.wait_words("RUNNING");
    quit(screen);
    assert_eq!(root.run(&["status", "--json"]).json()["benches"][0]["revision"], 1);
    assert_eq!(simulation.end().code, Some(0));
}
