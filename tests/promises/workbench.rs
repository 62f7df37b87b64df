//! What an engineer does at the dashboard, in a real terminal: each from what the help on the screen tells.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, Screen};
use rustix::process::{Pid, Signal, kill_process};

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
    screen.press_for("3", "damping over speed");
    screen.press_for(":lay\twhi\t\r", "spectrum");
    screen.press_for(":layout nope\r", "no layout 'nope'");
    quit(screen);
}

#[test]
fn two_gain_sets_are_compared_and_kept() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press_for("B", "held");
    screen.press_for("jjjL", "-0.4879");
    // What is held stands beside what is in force: the revision tells that the two have changed places.
    screen.press_for("b", "rev 3");
    screen.wait_words("-0.5879");
    screen.press_for("b", "rev 4");
    screen.wait_words("-0.4879");
    screen.press_for("smine\r", "gains kept as 'mine'");
    let kept = root.path().join("data/whirl/presets/mine.toml");
    let poles = promises::run(&["poles", "--speed", "2.5", "--feedback", kept.to_str().unwrap(), "--json"]).json();
    let status = root.run(&["status", "--json"]).json();
    assert_eq!(poles["min_damping"], status["benches"][0]["min_damping"]);
    screen.press_for("b", "rev 5");
    screen.wait_words("-0.5879");
    screen.press_for("o", "mine  min damping ");
    screen.press_for("mine\r", "rev 6");
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
    // Two changes by others within one bench status are two steps.
    assert_eq!(root.run(&["set", "speed=2.6"]).code, Some(0));
    assert_eq!(root.run(&["set", "deadband=0.5"]).code, Some(0));
    first.wait_words("R 2.6");
    first.press_for("u", "undone: deadband 0.5 -> 1, made by set:");
    first.press_for("u", "undone: speed 2.6 -> 2.5, made by set:");
    // The other sees who did it, and can do it again.
    second.wait_words("R 2.5 ");
    second.wait_words(&format!("by dash:{}", first.pid()));
    second.press_for("\x12", "done again: speed 2.5 -> 2.6, made by set:");
    first.wait_words(&format!("by dash:{}", second.pid()));
    // From unstable settings back to good ones nobody asks; forward again somebody does.
    first.press_for(":speed 9\r", "UNSTABLE with that");
    first.press_for("y", "speed = 9, from step");
    second.wait_words("R 9 ");
    second.press_for("u", "undone: speed 9 -> 2.6, made by dash:");
    second.press_for("\x12", "UNSTABLE with that");
    let closed = |text: &str| (!text.contains("UNSTABLE with that")).then_some(());
    second.press_until("n", "the question to close", closed);
    assert_eq!(root.run(&["status", "--json"]).json()["benches"][0]["speed"], 2.6);
    quit(first);
    quit(second);
    assert_eq!(simulation.end().code, Some(0));
}

/// The largest force that the panel of forces tells.
fn largest_force(text: &str) -> Option<f64> {
    text.split("│max").nth(1)?.split_whitespace().next()?.parse().ok()
}

/// The time that the picture stands at, if it stands.
fn tau(text: &str) -> Option<f64> {
    let top = text.lines().next().filter(|top| top.contains("PAUSED"))?;
    top.split("tau").nth(1)?.split_whitespace().next()?.parse().ok()
}

#[test]
fn seconds_back_the_force_is_read_at_its_peak_while_data_go_on() {
    let root = Root::new();
    let mut screen = started(&root);
    // What listens is there before the force counts, and into a file, so that it never waits for us.
    let path = root.path().join("heard.jsonl");
    let file = std::fs::File::create(&path).unwrap();
    let mut listens = root.whirl().args(["tail", "--json"]).stdout(file).spawn().unwrap();
    let heard = || std::fs::read_to_string(&path).unwrap();
    screen.wait("what listens to hear", |_| (!heard().is_empty()).then_some(()));
    // The force since the last change is told: a change begins it anew.
    screen.press_for(":trip=900\r", "trip = 900, from step");
    screen.press_for("i", "impulse -2.5 on mass 1");
    let after = heard().lines().count() + 4000;
    screen.wait("the stroke to die away", |_| (heard().lines().count() > after).then_some(()));
    kill_process(Pid::from_raw(listens.id() as i32).unwrap(), Signal::INT).unwrap();
    listens.wait().unwrap();
    let heard = heard();
    // The last line may have been cut short.
    let steps = heard.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let forces = steps.filter(|step| step["revision"] == 2).map(|step| {
        let force = &step["force"];
        force["y"].as_f64().unwrap().hypot(force["z"].as_f64().unwrap())
    });
    let peak = forces.fold(0.0, f64::max);
    // Then the bearing works harder than it did: it is struck as often as that takes, before a stroke has died away, so that they add up.
    let harder = |text: &str| largest_force(text).filter(|now| *now > 1.05 * peak);
    let began = std::time::Instant::now();
    while harder(&screen.text()).is_none() {
        screen.press("i");
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(began.elapsed() < promises::PATIENCE, "no stroke is felt:\n{}", screen.text());
    }
    let step = || root.run(&["tail", "--count", "1", "--json"]).stdout;
    assert_ne!(step(), step(), "data go on");
    // Back second by second, to where only the first stroke had been felt.
    screen.press_until(" ", "the picture to stand", tau);
    // The line at the top comes before the panels below it: what is read is what stays.
    let settled = |screen: &Screen| loop {
        let read = || (tau(&screen.text()), largest_force(&screen.text()));
        let before = read();
        std::thread::sleep(std::time::Duration::from_millis(300));
        if before == read() {
            return before.1.unwrap();
        }
    };
    while settled(&screen) > peak + 1e-3 {
        let before = screen.wait("where it stands", tau);
        screen.press_until("[", "a second earlier", |text| tau(text).filter(|now| now + 9.0 < before));
    }
    let then = settled(&screen);
    assert!((then - peak).abs() < 1e-3, "{then}, not {peak}");
    let (stands, step) =
        (tau(&screen.text()), || root.run(&["tail", "--every", "100", "--count", "3", "--json"]).stdout);
    assert_ne!(step(), step(), "data go on");
    assert_eq!((largest_force(&screen.text()), tau(&screen.text())), (Some(then), stands), "the picture stands");
    screen.press_for("+", "2.00 s");
    screen.press_for(" ", "RUNNING");
    screen.wait("the newest", harder);
    quit(screen);
}

#[test]
fn a_plot_is_chosen_its_scale_fixed_and_read_and_strips_show_what_was_asked_for() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press_for(":scale orbits -7..7\r", "±7.0 e_t fixed");
    screen.press_for("\t=", "┏ poles");
    screen.press_for(".", "◈ ");
    // Shift-tab as terminals send it.
    let another = |text: &str| (!text.contains("┏ poles") && text.contains('┏')).then_some(());
    screen.press_until("\x1b[Z", "another plot", another);
    let follows = |text: &str| (!text.contains("fixed")).then_some(());
    screen.press_until(":scale orbits auto\r", "a scale that follows", follows);
    screen.press_for(":strips radius.2 damping\r", "radius.2 ");
    screen.wait_words("damping  ");
    screen.press_for(":strips auto\r", "│u");
    quit(screen);
}

#[test]
fn the_alarm_that_fired_is_found_and_acknowledged() {
    let root = Root::new();
    let mut screen = started(&root);
    screen.press_for(":trip=8\r", "trip = 8, from step");
    screen.press_for("0", "UNSTABLE with that");
    screen.press_for("y", "TRIPPED");
    screen.wait_words("not acknowledged");
    screen.press_for("2", "now  warning    alarm");
    screen.wait("the alarm, at the top", |text| text.lines().next()?.contains("!! ALARM").then_some(()));
    screen.press_until("a", "its acknowledgement", |text| {
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
    screen.wait_words("now  warning    alarm");
    screen.press_for("x", "spectrum");
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
    screen.press_for("l0uR", "read-only: this dashboard changes nothing");
    // No shell waits here, so that the system lets it run on. RUNNING stood there before: that it stands there is no answer,
    // and until the terminal is raw again ctrl-c is a signal and no key.
    screen.press_until_taken_again("\x1a");
    screen.wait_words("RUNNING");
    quit(screen);
    assert_eq!(root.run(&["status", "--json"]).json()["benches"][0]["revision"], 1);
    assert_eq!(simulation.end().code, Some(0));
}
