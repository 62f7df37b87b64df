//! The seven tasks of docs/book/src/console.md, one after another in one session, in terminals as small as people have them: each from what the help
//! on the screen tells, and with what it asks for read from the screen.

use promises::paper::paper;
use promises::{Root, Screen};

/// A task by its name in the document, and how it is done.
type Task = (&'static str, fn(&mut Screen));

/// The tasks in the order in which they are done here.
const TASKS: [Task; 7] = [
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
    let document = paper("docs/book/src/console.md");
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
    // A small panel says so in a word.
    let is_title = |line: &str| line.contains("┌ damping over speed") || line.contains("┌ damping ");
    screen.press_until("3", "damping over speed", |text| text.lines().any(is_title).then_some(()));
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
    // What stands now and how long it has: a table where there is room, a list where there is not.
    let told = |text: &str| text.lines().skip(1).any(|line| line.contains("!! ALARM  trip"));
    screen.press_until("2", "the alarms", |text| told(text).then_some(()));
    screen.wait("the alarm, at the top", |text| text.lines().next()?.contains("!! ALARM").then_some(()));
    screen.press_until("a", "its acknowledgement", |text| {
        (text.contains("alarm acknowledged") || text.contains("alarms acknowledged")).then_some(())
    });
    screen.press_for("u", "undone");
    screen.press_for("R", "RUNNING");
}

fn compare_two_gain_sets(screen: &mut Screen) {
    screen.press_for("1B", "held");
    screen.press_for(":kd=-0.4879", "kd=-0.4879_");
    // Beside what is in force stands what is held: the revision tells that the two have changed places.
    screen.press_for("\r", "rev 7");
    screen.press_for("b", "rev 8");
    screen.wait_words("-0.5879");
    screen.press_for("b", "rev 9");
    screen.wait_words("-0.4879");
}

fn save_the_gains(screen: &mut Screen) {
    screen.press_for("smine\r", "gains kept as 'mine'");
    let closed = |text: &str| (!text.contains("mine  min damping")).then_some(());
    screen.press_for("o", "mine  min damping ");
    screen.press_until("\x1b", "the list to close", closed);
}

fn go_back_and_read_the_force(screen: &mut Screen) {
    // A test has no half minute: as far back as there is, and then from now to the step where the force was largest.
    screen.press_for("{", "PAUSED");
    screen.press_for(" ", "RUNNING");
    let has_fallen = |text: &str| Some(2.0 * number_after(text, "│now")? < number_after(text, "│max")?);
    screen.wait("the force to fall", |text| has_fallen(text).filter(|fallen| *fallen));
    screen.press_for(" ", "PAUSED");
    let is_at_peak = |text: &str| number_after(text, "│was") == number_after(text, "│max");
    screen.press_until("p", "the force at its peak", |text| {
        number_after(text, "│max").filter(|most| *most > 0.0 && is_at_peak(text))
    });
    screen.press_for(" ", "RUNNING");
}

fn switch_the_layout(screen: &mut Screen) {
    screen.press_for(":layout whirl\r", "spectrum");
}
