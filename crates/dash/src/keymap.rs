//! The one table of keys: it makes the keys work, and it makes the help screen and the hints at the foot.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    /// Select the setting so many rows further down.
    Select(isize),
    /// Raise the selected setting by so many of its steps.
    Nudge(f64),
    /// Start to type a value; enter takes it, esc drops it.
    Type,
    /// Take back the last change.
    Undo,
    /// Make it again.
    Redo,
    /// All gains to zero.
    Off,
    /// Strike the rotor.
    Impulse,
    /// Stop and go on with the picture.
    Pause,
    /// Show the layout of this number, counted from 0.
    Layout(usize),
    /// Move the cursor by so many seconds.
    Seek(f64),
    /// Move the cursor by so many steps.
    Step(i64),
    /// Show so many times as much time.
    Zoom(f64),
    /// Show as much time as at the start.
    ZoomReset,
    /// Start to record the bench, or end that.
    Record,
    /// A recording: play faster (1) or slower (-1).
    Speed(isize),
    /// A recording: to the next event (1) or the one before (-1).
    Event(isize),
    /// A recording: begin a loop, end it, drop it.
    Loop,
    /// A recording: type a time to go to.
    GoTo,
    /// A recording: to its end, or its beginning.
    End(bool),
    /// All alarms have been seen.
    Acknowledge,
    /// Restart from rest, or bring back a simulation that has ended.
    Restart,
    /// Show and hide the help.
    Help,
    /// Close the top layer.
    Escape,
    /// End.
    Quit,
}

/// One row of the table.
#[derive(Debug)]
pub(crate) struct Binding {
    /// Keys, as people read them.
    pub(crate) keys: &'static str,
    /// What they do.
    pub(crate) meaning: &'static str,
    /// The same in a word or two, if it is hinted at the foot of the screen.
    pub(crate) hint: Option<&'static str>,
    chords: &'static [(KeyCode, KeyModifiers, Action)],
}

const NONE: KeyModifiers = KeyModifiers::NONE;
const SHIFT: KeyModifiers = KeyModifiers::SHIFT;
const CTRL: KeyModifiers = KeyModifiers::CONTROL;

use KeyCode::{Char, Down, End, Enter, Esc, Home, Left, Right, Up};

/// Every key, in the order of the help screen. A shifted letter is its capital.
pub(crate) const BINDINGS: [Binding; 22] = [
    Binding { keys: "?", meaning: "this help", hint: Some("help"), chords: &[(Char('?'), NONE, Action::Help)] },
    Binding {
        keys: "q, ctrl-c",
        meaning: "quit",
        hint: Some("quit"),
        chords: &[(Char('q'), NONE, Action::Quit), (Char('c'), CTRL, Action::Quit), (Esc, NONE, Action::Escape)],
    },
    Binding {
        keys: "up down, k j",
        meaning: "select a setting",
        hint: Some("select"),
        chords: &[
            (Up, NONE, Action::Select(-1)),
            (Down, NONE, Action::Select(1)),
            (Char('k'), NONE, Action::Select(-1)),
            (Char('j'), NONE, Action::Select(1)),
        ],
    },
    Binding {
        keys: "left right, h l",
        meaning: "lower or raise it by one step",
        hint: Some("nudge"),
        chords: &[
            (Left, NONE, Action::Nudge(-1.0)),
            (Right, NONE, Action::Nudge(1.0)),
            (Char('h'), NONE, Action::Nudge(-1.0)),
            (Char('l'), NONE, Action::Nudge(1.0)),
        ],
    },
    Binding {
        keys: "shift-left shift-right, H L",
        meaning: "by ten steps",
        hint: None,
        chords: &[
            (Left, SHIFT, Action::Nudge(-10.0)),
            (Right, SHIFT, Action::Nudge(10.0)),
            (Char('H'), NONE, Action::Nudge(-10.0)),
            (Char('L'), NONE, Action::Nudge(10.0)),
        ],
    },
    Binding {
        keys: "ctrl-left ctrl-right",
        meaning: "by a tenth of a step",
        hint: None,
        chords: &[(Left, CTRL, Action::Nudge(-0.1)), (Right, CTRL, Action::Nudge(0.1))],
    },
    Binding {
        keys: "enter",
        meaning: "type a value: enter takes it, esc drops it",
        hint: Some("type"),
        chords: &[(Enter, NONE, Action::Type)],
    },
    Binding {
        keys: "u",
        meaning: "undo the last change",
        hint: Some("undo"),
        chords: &[(Char('u'), NONE, Action::Undo)],
    },
    Binding { keys: "ctrl-r", meaning: "redo it", hint: None, chords: &[(Char('r'), CTRL, Action::Redo)] },
    Binding {
        keys: "0",
        meaning: "control off: all gains to zero",
        hint: Some("off"),
        chords: &[(Char('0'), NONE, Action::Off)],
    },
    Binding {
        keys: "i",
        meaning: "an impulse on the mass with the control bearing",
        hint: Some("impulse"),
        chords: &[(Char('i'), NONE, Action::Impulse)],
    },
    Binding {
        keys: "space",
        meaning: "pause the picture and go on; data always go on",
        hint: Some("pause"),
        chords: &[(Char(' '), NONE, Action::Pause)],
    },
    Binding {
        keys: "1 to 9",
        meaning: "another layout: overview, operator, tuning, whirl, replay",
        hint: Some("layout"),
        chords: &[
            (Char('1'), NONE, Action::Layout(0)),
            (Char('2'), NONE, Action::Layout(1)),
            (Char('3'), NONE, Action::Layout(2)),
            (Char('4'), NONE, Action::Layout(3)),
            (Char('5'), NONE, Action::Layout(4)),
            (Char('6'), NONE, Action::Layout(5)),
            (Char('7'), NONE, Action::Layout(6)),
            (Char('8'), NONE, Action::Layout(7)),
            (Char('9'), NONE, Action::Layout(8)),
        ],
    },
    Binding {
        keys: "[ ], { }",
        meaning: "look 1 s or 10 s back and forward; space returns to live",
        hint: Some("time"),
        chords: &[
            (Char('['), NONE, Action::Seek(-1.0)),
            (Char(']'), NONE, Action::Seek(1.0)),
            (Char('{'), NONE, Action::Seek(-10.0)),
            (Char('}'), NONE, Action::Seek(10.0)),
        ],
    },
    Binding {
        keys: "< >",
        meaning: "look one step back and forward",
        hint: None,
        chords: &[(Char('<'), NONE, Action::Step(-1)), (Char('>'), NONE, Action::Step(1))],
    },
    Binding {
        keys: "+ - =",
        meaning: "show less time, more, as at the start",
        hint: None,
        chords: &[
            (Char('+'), NONE, Action::Zoom(0.5)),
            (Char('-'), NONE, Action::Zoom(2.0)),
            (Char('='), NONE, Action::ZoomReset),
        ],
    },
    Binding {
        keys: "r",
        meaning: "record the bench; again ends it",
        hint: Some("record"),
        chords: &[(Char('r'), NONE, Action::Record)],
    },
    Binding {
        keys: "( ), n N",
        meaning: "recording: slower, faster; to the next event, the one before",
        hint: None,
        chords: &[
            (Char('('), NONE, Action::Speed(-1)),
            (Char(')'), NONE, Action::Speed(1)),
            (Char('n'), NONE, Action::Event(1)),
            (Char('N'), NONE, Action::Event(-1)),
        ],
    },
    Binding {
        keys: "home end, g",
        meaning: "recording: to its beginning, its end, a tau that is typed",
        hint: None,
        chords: &[(Home, NONE, Action::End(false)), (End, NONE, Action::End(true)), (Char('g'), NONE, Action::GoTo)],
    },
    Binding {
        keys: "m",
        meaning: "recording: a loop begins here, ends here, is dropped",
        hint: None,
        chords: &[(Char('m'), NONE, Action::Loop)],
    },
    Binding {
        keys: "a",
        meaning: "acknowledge the alarms",
        hint: Some("alarms"),
        chords: &[(Char('a'), NONE, Action::Acknowledge)],
    },
    Binding {
        keys: "R",
        meaning: "restart from rest; after a trip too",
        hint: Some("restart"),
        chords: &[(Char('R'), NONE, Action::Restart)],
    },
];

/// What a key does while nothing is being typed.
pub(crate) fn action(key: KeyEvent) -> Option<Action> {
    let mut modifiers = key.modifiers & (SHIFT | CTRL | KeyModifiers::ALT);
    if matches!(key.code, Char(_)) {
        // A capital carries its shift in itself; terminals differ in whether they say so again.
        modifiers -= SHIFT;
    }
    let chords = BINDINGS.iter().flat_map(|binding| binding.chords);
    chords.copied().find(|(code, with, _)| (*code, *with) == (key.code, modifiers)).map(|(.., action)| action)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readme_has_the_same_table() {
        let readme = include_str!("../../../README.md");
        let table: String = BINDINGS.iter().map(|b| format!("| {} | {} |\n", b.keys, b.meaning)).collect();
        assert!(readme.contains(&table), "README.md should have these lines:\n{table}");
    }

    #[test]
    fn no_chord_is_bound_twice() {
        let mut seen = Vec::new();
        for (code, modifiers, _) in BINDINGS.iter().flat_map(|binding| binding.chords) {
            assert!(!seen.contains(&(code, modifiers)), "{code:?} {modifiers:?}");
            seen.push((code, modifiers));
        }
    }

    #[test]
    fn keys_do_what_the_table_says() {
        let does = |code, modifiers| action(KeyEvent::new(code, modifiers));
        assert_eq!(does(Char('q'), NONE), Some(Action::Quit));
        assert_eq!(does(Char('c'), CTRL), Some(Action::Quit));
        assert_eq!(does(Char('c'), NONE), None);
        assert_eq!(does(Char('R'), SHIFT), Some(Action::Restart));
        assert_eq!(does(Char('r'), CTRL), Some(Action::Redo));
        assert_eq!(does(Right, SHIFT), Some(Action::Nudge(10.0)));
        assert_eq!(does(Left, CTRL), Some(Action::Nudge(-0.1)));
    }
}
