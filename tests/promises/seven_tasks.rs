//! The seven tasks of docs/console.md, one after another in one session, in terminals as small as people have them: each from what the help
//! on the screen tells, and with what it asks for read from the screen.

use promises::paper::paper;
use promises::{Root, Screen};

/// The tasks as the document has them, in the order in which they are done here.
const TASKS: [(&str, fn(&mut Screen)); 7] = [
    ("Find the least damped mode", find_the_least_damped_mode),
    ("Make the rotor unstable and bring it back", make_it_unstable_and_bring_it_back),
    ("Find the alarm that fired", find_the_alarm),
    ("Compare two gain sets", compare_two_gain_sets),
    ("Save the gains", save_the_gains),
    ("Go back 30 s and read the force at its peak", go_back_and_read_the_force),
    ("Switch the layout", switch_the_layout),
];

#[test]
fn the_seven_tasks_succeed_in_small_terminals() {
    let document = paper("docs/console.md");
    let listed = document.split("## Seven tasks").nth(1).expect("the tasks").split("\n## ").next().unwrap_or_default();
    let names: Vec<&str> = listed.split("\n**").skip(1).filter_map(|task| Some(task.split_once("**")?.0)).collect();
    assert_eq!(names, TASKS.map(|(name, _)| name));
    std::thread::scope(|scope| {
        for size in [(120, 40), (80, 24)] {
            scope.spawn(move || do_them_all(size));
        }
    });
}

fn do_them_all(size: (u16, u16)) {
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], size);
    screen.wait_words("RUNNING");
    screen.wait_words("R 2.5");
    for (_, task) in TASKS {
        task(&mut screen);
    }
    screen.press("q");
    assert!(screen.ended().success() && !screen.is_taken(), "{size:?}");
}

/// A number behind a word.
fn number_after(text: &str, word: &str) -> Option<f64> {
    text.split_once(word)?.1.split_whitespace().next()?.parse().ok()
}

fn find_the_least_damped_mode(screen: &mut Screen) {
    let poles = promises::run(&["poles", "--speed", "2.5", "--feedback", "composite", "--json"]).json();
    let least = poles["modes"][0]["re"].as_f64().expect("a pole");
    screen.press_for("3", "damping over speed");
    screen.wait_words(&format!("◆ {least:.4}"));
}

fn make_it_unstable_and_bring_it_back(screen: &mut Screen) {
    screen.press_for("0", "UNSTABLE with that: minimum damping -0.0306");
    screen.press_for("y", "control off, from step");
    screen.press_for("u", "undone");
    screen.press_for("R", "restarted from rest");
}

fn find_the_alarm(screen: &mut Screen) {
    screen.press_for(":trip=8\r", "trip = 8, from step");
    screen.press_for("0", "UNSTABLE with that");
    screen.press_for("y", "TRIPPED");
    screen.press_for("2", "warning    alarm");
    screen.wait("the alarm, at the top", |text| text.lines().next()?.contains("!! ALARM").then_some(()));
    screen.press_until("a", "its acknowledgement", |text| text.contains(" acknowledged").then_some(()));
    screen.press_for("u", "undone");
    screen.press_for("R", "RUNNING");
}

fn compare_two_gain_sets(screen: &mut Screen) {
    screen.press_for("1B", "held");
    screen.press_for(":kd=-0.4879", "kd=-0.4879_");
    screen.press_for("\r", "kd.1 = -0.4879, from step");
    screen.press_for("b", "from step");
    screen.wait_words("-0.5879");
    screen.press_for("b", "from step");
    screen.wait_words("-0.4879");
}

fn save_the_gains(screen: &mut Screen) {
    screen.press_for("smine\r", "gains kept as 'mine'");
    let closed = |text: &str| (!text.contains("mine  min damping")).then_some(());
    screen.press_for("o", "mine  min damping ");
    screen.press_until("\x1b", "the list to close", closed);
}

fn go_back_and_read_the_force(screen: &mut Screen) {
    // As long as a test has no half minute, back is as far as there is history: the key goes to its beginning.
    screen.press_for("{", "PAUSED");
    screen.press_for("p", "largest control force");
    screen.wait("the force there", |text| number_after(text, "│max").or_else(|| number_after(text, "max ")));
    screen.press_for(" ", "RUNNING");
}

fn switch_the_layout(screen: &mut Screen) {
    screen.press_for(":layout whirl\r", "spectrum");
}
