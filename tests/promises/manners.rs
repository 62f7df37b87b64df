//! The dashboard among other programs: shells, windows that change and close, files, other dashboards.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::time::{Duration, Instant};

use promises::{PATIENCE, Root, Screen};
use rustix::process::{Pid, test_kill_process};

fn is_alive(pid: u32) -> bool {
    test_kill_process(Pid::from_raw(pid as i32).unwrap()).is_ok()
}

fn simulation_of(root: &Root) -> u32 {
    root.run(&["status", "--json"]).json()["benches"][0]["pid"].as_u64().unwrap() as u32
}

/// Waits for the shell to have its terminal back from the last command, and leaves it.
fn leave(mut screen: Screen) {
    screen.wait("the shell", |text| text.trim_end().ends_with("\nshell>").then_some(()));
    assert!(!screen.is_taken());
    screen.press("exit\r");
    screen.ended();
}

#[test]
fn ctrl_z_gives_the_terminal_back_and_fg_returns() {
    let root = Root::new();
    let mut screen = Screen::shell(root.path(), (120, 40));
    screen.press("whirl\r");
    screen.wait_words("RUNNING");
    let pid = simulation_of(&root);
    // While a command is being typed too.
    for (round, typed) in ["", ":note a"].into_iter().enumerate() {
        if !typed.is_empty() {
            screen.press_for(typed, typed);
        }
        // The word of the round before stands on the shell's screen still.
        let stopped = |text: &str| (text.to_lowercase().matches("stopped").count() > round).then_some(());
        screen.press_until("\x1a", "the shell", stopped);
        assert!(!screen.is_taken(), "the terminal is the shell's");
        screen.press_for(&format!("echo back$((40 + {round}))\r"), &format!("back{}", 40 + round));
        assert!(is_alive(pid));
        // The simulation goes on meanwhile.
        let step = || root.run(&["tail", "--count", "1", "--json"]).stdout;
        assert_ne!(step(), step());
        screen.press_until_taken_again("fg\r");
        screen.wait_words("RUNNING");
        screen.wait_words("orbits");
    }
    screen.press("\x03");
    leave(screen);
    assert!(!is_alive(pid));
}

#[test]
fn a_closed_terminal_ends_the_dashboard_and_its_simulation() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    screen.wait_words("RUNNING");
    let pid = simulation_of(&root);
    screen.close();
    assert_eq!(screen.ended().exit_code(), 130);
    let start = Instant::now();
    while is_alive(pid) {
        assert!(start.elapsed() < PATIENCE, "the simulation lives on");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(root.leftovers(), Vec::<String>::new());
}

#[test]
fn a_storm_of_resizes_leaves_a_whole_screen() {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (140, 45));
    screen.wait_words("RUNNING");
    for round in 0..300_u16 {
        screen.resize(20 + round * 37 % 180, 3 + round * 13 % 60);
        if round % 50 == 0 {
            screen.press("3");
        }
    }
    screen.resize(130, 42);
    // Every row is drawn for the last size: the frames of the panels are closed at its right edge.
    screen.wait("a whole screen", |text| {
        let rows: Vec<&str> = text.lines().collect();
        let closed = |row: &&str| row.chars().count() == 130 && row.ends_with(['│', '┐', '┘']);
        (rows.len() == 42 && rows[0].contains("RUNNING") && rows[1..41].iter().all(closed)).then_some(())
    });
    // The title once the curve is there, however long that takes.
    screen.wait_words("damping  stable 0 to 7.074");
    screen.press("q");
    assert!(screen.ended().success() && !screen.is_taken());
}

#[test]
fn where_things_are_is_printed() {
    let root = Root::new();
    let folder = |name: &str| root.path().join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let mut command = root.whirl();
        let homes = ["config", "data", "state"].map(|name| (format!("XDG_{}_HOME", name.to_uppercase()), folder(name)));
        let output = command.args(arguments).envs(homes).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let paths = run(&["config", "path"]);
    for path in ["config/whirl/config.toml", "config/whirl/layouts", "data/whirl/presets", "state/whirl/commands"] {
        assert!(paths.contains(&folder(path)), "{path}:\n{paths}");
    }
    let defaults = run(&["config", "defaults"]);
    for words in ["# layout = \"overview\"", "# theme = \"default\"", "# ascii = false", "[keys]", "[alarms]"] {
        assert!(defaults.contains(words), "{words}:\n{defaults}");
    }
    // What is printed can be put where the path says, and holds.
    let file = root.path().join("config/whirl/config.toml");
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(&file, defaults.replace("# ascii = false", "ascii = true")).unwrap();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    screen.wait_words("RUNNING");
    screen.wait("ASCII alone", |text| text.is_ascii().then_some(()));
    assert!(run(&["status"]).contains(&folder("dash.log")));
    screen.press_for(":note remember\r", "noted, from step");
    screen.press("q");
    assert!(screen.ended().success());
    assert_eq!(std::fs::read_to_string(root.path().join("state/whirl/commands")).unwrap(), "note remember\n");
    std::fs::write(&file, "theme = \"dark\"\n").unwrap();
    let mut screen = Screen::start(root.path(), &[], (100, 30));
    assert_eq!(screen.ended().exit_code(), 2);
    screen.wait_words("config.toml:1:9");
}

#[test]
fn a_log_is_written_where_status_says_and_never_on_the_screen() {
    let root = Root::new();
    let log = root.run(&["status", "--json"]).json()["log"].as_str().unwrap().to_owned();
    let mut screen = Screen::shell(root.path(), (120, 40));
    screen.press("WHIRL_LOG=trace whirl\r");
    screen.wait_words("RUNNING");
    screen.wait("a log", |_| std::fs::metadata(&log).is_ok_and(|file| file.len() > 0).then_some(()));
    assert!(!screen.text().contains("TRACE") && !screen.text().contains("DEBUG"));
    screen.press("q");
    leave(screen);
}

#[test]
fn a_picture_is_kept_where_the_dashboard_was_started_and_replaces_nothing() {
    let root = Root::new();
    let folder = tempfile::tempdir().unwrap();
    let mut screen = Screen::start_in(folder.path(), root.path(), &[], (110, 34));
    screen.wait_words("RUNNING");
    screen.wait_words("three-mass");
    screen.press_for(":picture now.svg\r", "picture kept: ");
    let svg = std::fs::read_to_string(folder.path().join("now.svg")).unwrap();
    assert!(svg.contains("minimum damping") && svg.contains("three-mass"), "{svg}");
    screen.press_for(":picture now.svg\r", "now.svg is there already: nothing is overwritten");
    screen.press_for("P", ".svg and .txt");
    let mut kinds: Vec<String> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().path().extension().unwrap().to_string_lossy().into_owned())
        .collect();
    kinds.sort();
    assert_eq!(kinds, ["svg", "svg", "txt"]);
    screen.press("q");
    assert!(screen.ended().success());
}
