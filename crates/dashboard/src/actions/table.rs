//! The table itself.

use super::action::{Action, ReadoutMove};
use super::argument::{assignments, moves, number, run_up, scale, spectra, times, whole, within};
use crate::series::Strip;
use telemetry::view_time::SPANS;

/// One action.
pub(crate) struct ActionRow {
    /// Its name, as typed after `:` and in the configuration.
    pub(crate) name: &'static str,
    /// What must follow the name, in capitals; in brackets what may; empty if nothing does.
    pub(crate) argument: &'static str,
    /// What it does, as the command line tells it.
    pub(crate) meaning: &'static str,
    /// Its keys.
    pub(crate) keys: &'static [KeyBinding],
    /// What it makes of its argument.
    pub(super) make: fn(&str) -> Result<Action, String>,
}

/// Keys that do the same, more or less.
pub(crate) struct KeyBinding {
    /// Each with what follows the name of the action.
    pub(crate) chords: &'static [(&'static str, &'static str)],
    /// What they do.
    pub(crate) meaning: &'static str,
    /// The same in a word or two, if it is hinted at the foot of the screen.
    pub(crate) hint: Option<&'static str>,
}

const fn keys(
    chords: &'static [(&'static str, &'static str)],
    meaning: &'static str,
    hint: Option<&'static str>,
) -> KeyBinding {
    KeyBinding { chords, meaning, hint }
}

/// Every action, in the order of the help screen.
pub(crate) const ACTIONS: &[ActionRow] = &[
    ActionRow {
        name: "help",
        argument: "",
        meaning: "show and hide the help",
        keys: &[keys(&[("?", ""), ("f1", "")], "this help", Some("help"))],
        make: |_| Ok(Action::Help),
    },
    ActionRow {
        name: "quit",
        argument: "",
        meaning: "quit",
        keys: &[keys(&[("q", ""), ("ctrl-c", "")], "quit; where text is typed, ctrl-c does", Some("quit"))],
        make: |_| Ok(Action::Quit),
    },
    ActionRow {
        name: "command",
        argument: "[TEXT]",
        meaning: "type a command",
        keys: &[keys(
            &[(":", "")],
            "type a command: tab completes it, up recalls earlier ones, enter does it",
            Some("command"),
        )],
        make: |text| Ok(Action::Command(text.to_owned())),
    },
    ActionRow {
        name: "select",
        argument: "ROWS",
        meaning: "select the setting so many rows further down",
        keys: &[keys(&[("up", "-1"), ("down", "1"), ("k", "-1"), ("j", "1")], "select a setting", Some("select"))],
        make: |rows| whole(rows).and_then(moves).map(|rows| Action::Select(rows as isize)),
    },
    ActionRow {
        name: "nudge",
        argument: "STEPS",
        meaning: "raise the selected setting by so many steps",
        keys: &[
            keys(
                &[("left", "-1"), ("right", "1"), ("h", "-1"), ("l", "1")],
                "lower or raise it by one step",
                Some("nudge"),
            ),
            keys(&[("shift-left", "-10"), ("shift-right", "10"), ("H", "-10"), ("L", "10")], "by ten steps", None),
            keys(&[("ctrl-left", "-0.1"), ("ctrl-right", "0.1")], "by a tenth of a step", None),
        ],
        make: |steps| number(steps).and_then(moves).map(Action::Nudge),
    },
    ActionRow {
        name: "type",
        argument: "",
        meaning: "type a value for the selected setting",
        keys: &[keys(&[("enter", "")], "type a value: enter takes it, esc drops it", Some("type"))],
        make: |_| Ok(Action::Type),
    },
    ActionRow {
        name: "set",
        argument: "KEY=VALUE...",
        meaning: "set speed, gains ..., all at once; `speed 3` and `kd=0.1` will do too",
        keys: &[],
        make: assignments,
    },
    ActionRow {
        name: "undo",
        argument: "",
        meaning: "take back the last change of settings, whoever made it",
        keys: &[keys(&[("u", "")], "undo the last change, whoever made it", Some("undo"))],
        make: |_| Ok(Action::Undo),
    },
    ActionRow {
        name: "redo",
        argument: "",
        meaning: "make it again",
        keys: &[keys(&[("ctrl-r", "")], "redo it", None)],
        make: |_| Ok(Action::Redo),
    },
    ActionRow {
        name: "off",
        argument: "",
        meaning: "control off: all gains to zero",
        keys: &[keys(&[("0", "")], "control off: all gains to zero", Some("off"))],
        make: |_| Ok(Action::Off),
    },
    ActionRow {
        name: "hold",
        argument: "",
        meaning: "hold the present settings, to compare others with",
        keys: &[keys(&[("B", "")], "hold the present settings, to compare others with", None)],
        make: |_| Ok(Action::Hold),
    },
    ActionRow {
        name: "swap",
        argument: "",
        meaning: "switch between the held settings and the present ones",
        keys: &[keys(&[("b", "")], "switch between the held settings and the present ones", None)],
        make: |_| Ok(Action::Swap),
    },
    ActionRow {
        name: "save",
        argument: "NAME",
        meaning: "keep the gains under a name",
        keys: &[keys(&[("s", "")], "keep the gains under a name", None)],
        make: |name| Ok(Action::Save(name.to_owned())),
    },
    ActionRow {
        name: "load",
        argument: "NAME",
        meaning: "take gains that were kept",
        keys: &[keys(&[("o", "")], "take gains that were kept; lists them with their minimum damping", None)],
        make: |name| Ok(Action::Load(name.to_owned())),
    },
    ActionRow {
        name: "delete",
        argument: "NAME",
        meaning: "delete gains that were kept, after a yes",
        keys: &[keys(&[("D", "")], "delete gains that were kept", None)],
        make: |name| Ok(Action::Delete(name.to_owned())),
    },
    ActionRow {
        name: "search",
        argument: "[A..B] [robust|full]|stop",
        meaning: "search gains to past this speed, or over a range",
        keys: &[keys(&[("S", "")], "search better gains, to be seen before they apply", None)],
        make: |words| Ok(Action::Search(words.to_owned())),
    },
    ActionRow {
        name: "impulse",
        argument: "",
        meaning: "an impulse on the mass with the control bearing",
        keys: &[keys(&[("i", "")], "an impulse on the mass with the control bearing", Some("impulse"))],
        make: |_| Ok(Action::Impulse),
    },
    ActionRow {
        name: "run-up",
        argument: "[A..]B RATE",
        meaning: "the speed goes to B at RATE, up or down; from A if it is there",
        keys: &[],
        make: run_up,
    },
    ActionRow {
        name: "stay",
        argument: "",
        meaning: "the speed stays where it is on its way",
        keys: &[],
        make: |_| Ok(Action::Stay),
    },
    ActionRow {
        name: "restart",
        argument: "",
        meaning: "restart from rest, after a trip too",
        keys: &[keys(&[("R", "")], "restart from rest; after a trip too", Some("restart"))],
        make: |_| Ok(Action::Restart),
    },
    ActionRow {
        name: "note",
        argument: "TEXT",
        meaning: "put a note on the record, for everybody",
        keys: &[keys(&[("w", "")], "write a note on the record", None)],
        make: |text| Ok(Action::Note(text.to_owned())),
    },
    ActionRow {
        name: "pause",
        argument: "",
        meaning: "let the picture stand, or go on with the newest; data always go on",
        keys: &[keys(&[("space", "")], "pause the picture and go on; data always go on", Some("pause"))],
        make: |_| Ok(Action::Pause),
    },
    ActionRow {
        name: "seek",
        argument: "SECONDS",
        meaning: "look so many seconds further on; back if negative",
        keys: &[keys(
            &[("[", "-1"), ("]", "1"), ("{", "-10"), ("}", "10")],
            "look 1 s or 10 s back and forward; space returns to live",
            Some("time"),
        )],
        make: |seconds| number(seconds).and_then(moves).map(Action::Seek),
    },
    ActionRow {
        name: "step",
        argument: "STEPS",
        meaning: "look so many steps further on; back if negative",
        keys: &[keys(&[("<", "-1"), (">", "1")], "look one step back and forward", None)],
        make: |steps| whole(steps).and_then(moves).map(Action::Step),
    },
    ActionRow {
        name: "zoom",
        argument: "[TIMES]",
        meaning: "show so many times as much; without a number, as at the start",
        keys: &[keys(
            &[("+", "0.5"), ("-", "2"), ("=", "")],
            "less time, more, as at the start; in some plots frequency or speed",
            None,
        )],
        make: |by| match by {
            "" => Ok(Action::ZoomReset),
            by => number(by).and_then(times).map(Action::Zoom),
        },
    },
    ActionRow {
        name: "span",
        argument: "SECONDS",
        meaning: "show so many seconds",
        keys: &[],
        make: |seconds| number(seconds).and_then(|seconds| within(seconds, SPANS)).map(Action::Span),
    },
    ActionRow {
        name: "choose",
        argument: "PLOT|STEPS",
        meaning: "choose the plot whose scale and read-out keys change",
        keys: &[keys(&[("tab", "1"), ("shift-tab", "-1")], "choose the next plot, the one before; esc none", None)],
        make: |plot| Ok(Action::Choose(plot.to_owned())),
    },
    ActionRow {
        name: "scale",
        argument: "[PLOT] auto|TIMES|LOW..HIGH",
        meaning: "let values follow, show so many times as much, or fix their range",
        keys: &[keys(&[("z", "0.5"), ("Z", "2")], "the chosen plot's values closer, wider; = lets them follow", None)],
        make: scale,
    },
    ActionRow {
        name: "read",
        argument: "left|right|VALUE|off",
        meaning: "read the chosen plot at a frequency or speed, or the next mode",
        keys: &[keys(&[(",", "left"), (".", "right")], "the chosen plot's read-out to the left, to the right", None)],
        make: |there| match there {
            "left" => Ok(Action::Read(ReadoutMove::Move(-1))),
            "right" => Ok(Action::Read(ReadoutMove::Move(1))),
            "off" => Ok(Action::Read(ReadoutMove::Off)),
            value => number(value).map(|value| Action::Read(ReadoutMove::At(value))),
        },
    },
    ActionRow {
        name: "strips",
        argument: "SERIES...|auto",
        meaning: "what the strips show: a word each, as y.1+z.1 force; auto: the layout's",
        keys: &[],
        make: |words| match words {
            "auto" => Ok(Action::Strips(None)),
            words => Strip::read_all(words).map(|strips| Action::Strips(Some(strips))),
        },
    },
    ActionRow {
        name: "spectrum",
        argument: "MASS|LOW..HIGH|auto",
        meaning: "mass and frequencies of the spectra; auto: the bearing's mass, and all",
        keys: &[],
        make: spectra,
    },
    ActionRow {
        name: "record",
        argument: "",
        meaning: "record the bench, or end that",
        keys: &[keys(&[("r", "")], "record the bench; again ends it", Some("record"))],
        make: |_| Ok(Action::Record),
    },
    ActionRow {
        name: "acknowledge",
        argument: "",
        meaning: "acknowledge the alarms",
        keys: &[keys(&[("a", "")], "acknowledge the alarms", Some("alarms"))],
        make: |_| Ok(Action::Acknowledge),
    },
    ActionRow {
        name: "pace",
        argument: "STEPS",
        meaning: "play a recording faster by so many steps, or slower",
        keys: &[keys(&[("(", "-1"), (")", "1")], "recording: slower, faster", None)],
        make: |steps| whole(steps).and_then(moves).map(|steps| Action::Pace(steps as isize)),
    },
    ActionRow {
        name: "event",
        argument: "COUNT",
        meaning: "go so many events on in a recording, or back",
        keys: &[keys(&[("n", "1"), ("N", "-1")], "recording: to the next event, the one before", None)],
        make: |count| whole(count).and_then(moves).map(|count| Action::Event(count as isize)),
    },
    ActionRow {
        name: "go",
        argument: "TAU|first|last",
        meaning: "go to a time of a recording, its beginning or its end",
        keys: &[keys(
            &[("home", "first"), ("end", "last"), ("g", "")],
            "recording: to its beginning, its end, a tau that is typed",
            None,
        )],
        make: |there| match there {
            "first" => Ok(Action::End(false)),
            "last" => Ok(Action::End(true)),
            tau => number(tau).map(Action::GoTo),
        },
    },
    ActionRow {
        name: "loop",
        argument: "",
        meaning: "begin a loop in a recording, end it, drop it",
        keys: &[keys(&[("m", "")], "recording: a loop begins here, ends here, is dropped", None)],
        make: |_| Ok(Action::Loop),
    },
    ActionRow {
        name: "layout",
        argument: "NAME",
        meaning: "show another layout",
        keys: &[keys(
            &[
                ("1", "1"),
                ("2", "2"),
                ("3", "3"),
                ("4", "4"),
                ("5", "5"),
                ("6", "6"),
                ("7", "7"),
                ("8", "8"),
                ("9", "9"),
            ],
            "another layout: overview, operator, tuning, whirl, replay, diagnosis",
            Some("layout"),
        )],
        make: |name| Ok(Action::Layout(name.to_owned())),
    },
    ActionRow {
        name: "picture",
        argument: "[FILE]",
        meaning: "keep a picture of the screen as FILE.svg or FILE.txt, or else as both",
        keys: &[keys(&[("P", "")], "keep a picture of the screen, as SVG and as text", None)],
        make: |file| Ok(Action::FrameData(file.to_owned())),
    },
    ActionRow {
        name: "scroll",
        argument: "ROWS",
        meaning: "scroll the lists on the screen by so many rows",
        keys: &[keys(&[("pageup", "-5"), ("pagedown", "5")], "scroll the lists: events, alarms, modes, numbers", None)],
        make: |rows| whole(rows).and_then(moves).map(|rows| Action::Scroll(rows as isize)),
    },
    ActionRow {
        name: "filter",
        argument: "",
        meaning: "type what the lists shall show: events, alarms, modes, numbers, settings, this help",
        keys: &[keys(&[("/", "")], "type what the lists shall show; esc shows all again", None)],
        make: |_| Ok(Action::Filter),
    },
    ActionRow {
        name: "escape",
        argument: "",
        meaning: "close what lies on top",
        keys: &[keys(&[("esc", "")], "close what lies on top", None)],
        make: |_| Ok(Action::Escape),
    },
    ActionRow {
        name: "suspend",
        argument: "",
        meaning: "back to the shell; `fg` returns",
        keys: &[keys(&[("ctrl-z", "")], "back to the shell; `fg` returns", None)],
        make: |_| Ok(Action::Suspend),
    },
];

/// What the mouse does, in the help.
pub(crate) const MOUSE: [(&str, &str); 5] = [
    ("click", "choose a plot; select a setting, a mode, a frequency or a speed"),
    ("click on strips, damping", "look at that moment; the same on an event"),
    ("click on an alarm", "acknowledge it; look at the moment of one that is"),
    ("drag", "nudge the selected setting; on a plot, as click"),
    ("wheel", "next setting; more or less time (strips), frequency, speed, or value"),
];
