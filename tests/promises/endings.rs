//! Every way out of a dashboard, and into it again: the terminal is given back whole, and nothing hangs on it.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, Screen};
use rustix::process::{Pid, Signal, kill_process};

fn send(pid: u32, signal: Signal) {
    kill_process(Pid::from_raw(pid as i32).unwrap(), signal).unwrap();
}

/// The process of the dashboard on the only bench.
fn dashboard_of(root: &Root) -> u32 {
    let status = root.run(&["status", "--json"]).json();
    let attached = status["benches"][0]["attached"].as_array().unwrap().clone();
    let dash = attached.iter().find(|party| party["role"] != "sim").unwrap();
    dash["pid"].as_u64().unwrap() as u32
}

#[test]
fn sigquit_and_every_other_deadly_signal_give_the_terminal_back() {
    let root = Root::new();
    let _simulation = root.simulate(&[]);
    for signal in [Signal::QUIT, Signal::ABORT, Signal::ALARM, Signal::USR1, Signal::USR2, Signal::XCPU, Signal::TRAP] {
        let mut screen = Screen::start(root.path(), &["dash"], (100, 30));
        screen.wait_words("RUNNING");
        assert!(screen.is_taken() && screen.has_mouse() && !screen.is_cooked());
        send(screen.pid(), signal);
        assert!(!screen.ended().success(), "{signal:?}");
        assert!(!screen.is_taken() && !screen.has_mouse() && screen.is_cooked(), "{signal:?}");
    }
}

#[test]
fn a_stop_from_outside_gives_the_terminal_back_and_a_continue_takes_it_again() {
    let root = Root::new();
    let mut screen = Screen::shell(root.path(), (120, 40));
    screen.press("whirl\r");
    screen.wait_words("RUNNING");
    let pid = dashboard_of(&root);
    let stopped =
        |screen: &Screen| screen.wait("the shell", |text| text.to_lowercase().contains("stopped").then_some(()));
    send(pid, Signal::TSTP);
    stopped(&screen);
    assert!(!screen.is_taken() && !screen.has_mouse() && screen.is_cooked());
    screen.press("fg\r");
    screen.wait_words("orbits");
    assert!(screen.is_taken() && screen.has_mouse() && !screen.is_cooked());
    screen.press("q");
    screen.wait("the shell", |text| text.trim_end().ends_with("\nshell>").then_some(()));
    assert!(!screen.is_taken() && !screen.has_mouse() && screen.is_cooked());
    screen.press("exit\r");
    screen.ended();
}

#[test]
fn a_stop_that_cannot_be_caught_does_no_harm_once_it_is_continued() {
    let root = Root::new();
    let _simulation = root.simulate(&[]);
    let mut screen = Screen::start(root.path(), &["dash"], (100, 30));
    screen.wait_words("RUNNING");
    let pid = screen.pid();
    send(pid, Signal::STOP);
    let is_stopped = || {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
        stat.rsplit_once(") ").is_some_and(|(_, rest)| rest.starts_with('T'))
    };
    while !is_stopped() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    send(pid, Signal::CONT);
    screen.press("?");
    screen.wait_words("esc closes it");
    assert!(screen.is_taken() && screen.has_mouse() && !screen.is_cooked());
    screen.press("\u{1b}");
    screen.wait("the panels", |text| text.contains("poles").then_some(()));
    screen.press("q");
    assert!(screen.ended().success());
    assert!(!screen.is_taken() && !screen.has_mouse() && screen.is_cooked());
}

#[test]
fn the_bell_rings_at_every_alarm_and_the_dashboard_goes_on() {
    let root = Root::new();
    let folder = root.path().join("config/whirl");
    std::fs::create_dir_all(&folder).unwrap();
    // All that is watched is past its alarm from the first look on, and every option that does something is on.
    let config = "theme = \"full\"\nascii = true\nlayout = \"overview\"\n[alarms]\nbell = true\ndamping = [1e9, 1e8]\n\
                  orbit = [-2, -1]\nforce = [-2, -1]\nsaturation = [-2, -1]\nlateness = [-2, -1]\nlosses = [-2, -1]\n";
    std::fs::write(folder.join("config.toml"), config).unwrap();
    let mut screen = Screen::start(root.path(), &[], (200, 40));
    let all = |text: &str, names: &[&str]| {
        let top = text.lines().next().unwrap_or_default().to_owned();
        (top.contains("!! ALARM") && names.iter().all(|name| top.contains(name))).then_some(())
    };
    screen.wait("all alarms", |text| all(text, &["damping", "orbit", "force", "lateness"]));
    screen.wait("the bell", |_| (screen.bells() > 0).then_some(()));
    let before = screen.bells();
    screen.press_for(":set trip=0.001\r", "trips at once");
    screen.press("y");
    screen.wait("the trip", |text| (text.contains("TRIPPED") && all(text, &["trip"]).is_some()).then_some(()));
    screen.wait("the bell again", |_| (screen.bells() > before).then_some(()));
    screen.press("a");
    screen.wait_words("acknowledged");
    screen.press("q");
    assert!(screen.ended().success() && !screen.is_taken());
    // With its terminal closed it does not live on.
    let mut screen = Screen::start(root.path(), &[], (200, 40));
    screen.wait("all alarms", |text| all(text, &["damping", "orbit"]));
    screen.close();
    assert_eq!(screen.ended().exit_code(), 130);
}
