//! The README's first five minutes at the console, key by key, in a real terminal.

use promises::paper::paper;
use promises::{Root, Screen};

/// What the table of the README has to press, in its order; how that is typed; the words that it brings; and what closes it
/// again, before the next.
const STEPS: [(&str, &str, &str, &str); 11] = [
    ("0", "0", "UNSTABLE with that", ""),
    ("y", "y", "control off, from step", ""),
    ("u", "u", "undone", ""),
    ("R", "R", "restarted from rest", ""),
    ("3", "3", "damping over speed", ""),
    (":kd=-0.2", ":kd=-0.2", "kd=-0.2_", "\x1b"),
    ("S", "S", "found ", "n"),
    ("i", "i", "impulse -2.5 on mass 1", ""),
    ("{", "{", "PAUSED", " "),
    ("?", "?", "undo the last change, whoever made it", "\x1b"),
    ("q", "q", "", ""),
];

#[test]
fn the_first_five_minutes_are_as_the_readme_has_them() {
    let readme = paper("README.md");
    let table = readme.split("| press | and see |").nth(1).expect("a table of keys");
    let rows = table.trim_start().lines().skip(1).take_while(|line| line.starts_with('|'));
    let pressed: Vec<&str> =
        rows.filter_map(|row| row.strip_prefix("| `")?.split_once('`')).map(|(key, _)| key).collect();
    assert_eq!(pressed, STEPS.map(|(key, ..)| key));

    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (160, 50));
    screen.wait_words("RUNNING");
    screen.wait_words("R 2.5");
    for (_, keys, words, close) in STEPS {
        if words.is_empty() {
            screen.press(keys);
            continue;
        }
        screen.press_for(keys, words);
        if !close.is_empty() {
            let closed = |text: &str| (!text.contains(words)).then_some(());
            screen.press_until(close, "it to close", closed);
        }
    }
    assert!(screen.ended().success() && !screen.is_taken());
    assert_eq!(root.leftovers(), [""; 0], "left behind");
}
