//! The one table of actions: it makes the keys, the command line with its completion, the help screen, the hints at the
//! foot, the README's table and the default configuration.
//!
//! A key stands for a command line, such as `nudge -1`; what is typed after `:` goes through the same [`parse`].

use rotor::{Key, PARAMETERS};

use crate::axis::Scaling;
use crate::panels::registry::plots;
use crate::panels::series::{self, Strip};

/// What a person asks of the dashboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Select the setting so many rows further down.
    Select(isize),
    /// Raise the selected setting by so many of its steps.
    Nudge(f64),
    /// Start to type a value; enter takes it, esc drops it.
    Type,
    /// Set these, all at once.
    Set(Vec<(Key, f64)>),
    /// Take back the last change, whoever made it.
    Undo,
    /// Make it again.
    Redo,
    /// All gains to zero.
    Off,
    /// Search gains; this says for what.
    Search(String),
    /// Strike the rotor.
    Impulse,
    /// Restart from rest, or bring back a simulation that has ended.
    Restart,
    /// Hold the present settings to compare with.
    Hold,
    /// Change places between the held settings and the present ones.
    Swap,
    /// Keep the gains under a name.
    Save(String),
    /// Take gains kept under a name.
    Load(String),
    /// Delete gains kept under a name.
    Delete(String),
    /// Put a note on the record.
    Note(String),
    /// Stop and go on with the picture.
    Pause,
    /// Move the cursor by so many seconds.
    Seek(f64),
    /// Move the cursor by so many steps.
    Step(i64),
    /// Show so many times as much time.
    Zoom(f64),
    /// Show so many seconds.
    Span(f64),
    /// Show as much time as at the start.
    ZoomReset,
    /// Choose a plot by name, or the next (`1`) or the one before (`-1`).
    Choose(String),
    /// The scale of the values of a plot: of the named one, or of the chosen one.
    Scale(Option<String>, Vec<Scaling>),
    /// Move the read-out of the chosen plot.
    Read(Read),
    /// What the strips show; what the layout says if there is none.
    Strips(Option<Vec<Strip>>),
    /// The mass, counted from 0, and the frequencies of the spectra: `None` leaves them as they are.
    Spectra(Option<Option<usize>>, Option<Scaling>),
    /// Start to record the bench, or end that.
    Record,
    /// All alarms have been seen.
    Acknowledge,
    /// A recording: play faster (1) or slower (-1).
    Pace(isize),
    /// A recording: to the next event (1) or the one before (-1).
    Event(isize),
    /// A recording: begin a loop, end it, drop it.
    Loop,
    /// A recording: to a dimensionless time.
    GoTo(f64),
    /// A recording: to its end, or its beginning.
    End(bool),
    /// Keep a picture of the screen, in this file or in one named by bench and time.
    Picture(String),
    /// Another layout, by its number counted from 1 or its name.
    Layout(String),
    /// Start to type a command; this much is typed already.
    Command(String),
    /// Move the lists by so many rows.
    Scroll(isize),
    /// Start to type what the lists shall show.
    Filter,
    /// Show and hide the help.
    Help,
    /// Close the top layer.
    Escape,
    /// Give the terminal back until the shell continues us.
    Suspend,
    /// End.
    Quit,
}

/// Where the read-out of a plot shall stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Read {
    /// So many columns, or modes, further on.
    Move(i32),
    /// At a value as it stands on the axis.
    At(f64),
    /// Nowhere.
    Off,
}

/// One action.
pub(crate) struct Row {
    /// Its name, as typed after `:` and in the configuration.
    pub(crate) name: &'static str,
    /// What must follow the name, in capitals; in brackets what may; empty if nothing does.
    pub(crate) argument: &'static str,
    /// What it does, as the command line tells it.
    pub(crate) meaning: &'static str,
    /// Its keys.
    pub(crate) keys: &'static [Keys],
    make: fn(&str) -> Result<Action, String>,
}

/// Keys that do the same, more or less.
pub(crate) struct Keys {
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
) -> Keys {
    Keys { chords, meaning, hint }
}

/// Every action, in the order of the help screen.
pub(crate) const ACTIONS: &[Row] = &[
    Row {
        name: "help",
        argument: "",
        meaning: "show and hide the help",
        keys: &[keys(&[("?", ""), ("f1", "")], "this help", Some("help"))],
        make: |_| Ok(Action::Help),
    },
    Row {
        name: "quit",
        argument: "",
        meaning: "quit",
        keys: &[keys(&[("q", ""), ("ctrl-c", "")], "quit; where text is typed, ctrl-c does", Some("quit"))],
        make: |_| Ok(Action::Quit),
    },
    Row {
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
    Row {
        name: "select",
        argument: "ROWS",
        meaning: "select the setting so many rows further down",
        keys: &[keys(&[("up", "-1"), ("down", "1"), ("k", "-1"), ("j", "1")], "select a setting", Some("select"))],
        make: |rows| whole(rows).map(|rows| Action::Select(rows as isize)),
    },
    Row {
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
        make: |steps| number(steps).map(Action::Nudge),
    },
    Row {
        name: "type",
        argument: "",
        meaning: "type a value for the selected setting",
        keys: &[keys(&[("enter", "")], "type a value: enter takes it, esc drops it", Some("type"))],
        make: |_| Ok(Action::Type),
    },
    Row {
        name: "set",
        argument: "KEY=VALUE...",
        meaning: "set speed, gains ..., all at once; `speed 3` and `kd=0.1` will do too",
        keys: &[],
        make: assignments,
    },
    Row {
        name: "undo",
        argument: "",
        meaning: "take back the last change of settings, whoever made it",
        keys: &[keys(&[("u", "")], "undo the last change, whoever made it", Some("undo"))],
        make: |_| Ok(Action::Undo),
    },
    Row {
        name: "redo",
        argument: "",
        meaning: "make it again",
        keys: &[keys(&[("ctrl-r", "")], "redo it", None)],
        make: |_| Ok(Action::Redo),
    },
    Row {
        name: "off",
        argument: "",
        meaning: "control off: all gains to zero",
        keys: &[keys(&[("0", "")], "control off: all gains to zero", Some("off"))],
        make: |_| Ok(Action::Off),
    },
    Row {
        name: "hold",
        argument: "",
        meaning: "hold the present settings, to compare others with",
        keys: &[keys(&[("B", "")], "hold the present settings, to compare others with", None)],
        make: |_| Ok(Action::Hold),
    },
    Row {
        name: "swap",
        argument: "",
        meaning: "switch between the held settings and the present ones",
        keys: &[keys(&[("b", "")], "switch between the held settings and the present ones", None)],
        make: |_| Ok(Action::Swap),
    },
    Row {
        name: "save",
        argument: "NAME",
        meaning: "keep the gains under a name",
        keys: &[keys(&[("s", "")], "keep the gains under a name", None)],
        make: |name| Ok(Action::Save(name.to_owned())),
    },
    Row {
        name: "load",
        argument: "NAME",
        meaning: "take gains that were kept",
        keys: &[keys(&[("o", "")], "take gains that were kept; lists them with their minimum damping", None)],
        make: |name| Ok(Action::Load(name.to_owned())),
    },
    Row {
        name: "delete",
        argument: "NAME",
        meaning: "delete gains that were kept, after a yes",
        keys: &[keys(&[("D", "")], "delete gains that were kept", None)],
        make: |name| Ok(Action::Delete(name.to_owned())),
    },
    Row {
        name: "search",
        argument: "[A..B] [robust]|stop",
        meaning: "search gains for the present speed or a range; robust: for any deadband",
        keys: &[keys(&[("S", "")], "search better gains, to be seen before they apply", None)],
        make: |words| Ok(Action::Search(words.to_owned())),
    },
    Row {
        name: "impulse",
        argument: "",
        meaning: "an impulse on the mass with the control bearing",
        keys: &[keys(&[("i", "")], "an impulse on the mass with the control bearing", Some("impulse"))],
        make: |_| Ok(Action::Impulse),
    },
    Row {
        name: "restart",
        argument: "",
        meaning: "restart from rest, after a trip too",
        keys: &[keys(&[("R", "")], "restart from rest; after a trip too", Some("restart"))],
        make: |_| Ok(Action::Restart),
    },
    Row {
        name: "note",
        argument: "TEXT",
        meaning: "put a note on the record, for everybody",
        keys: &[keys(&[("w", "")], "write a note on the record", None)],
        make: |text| Ok(Action::Note(text.to_owned())),
    },
    Row {
        name: "pause",
        argument: "",
        meaning: "let the picture stand, or go on with the newest; data always go on",
        keys: &[keys(&[("space", "")], "pause the picture and go on; data always go on", Some("pause"))],
        make: |_| Ok(Action::Pause),
    },
    Row {
        name: "seek",
        argument: "SECONDS",
        meaning: "look so many seconds further on; back if negative",
        keys: &[keys(
            &[("[", "-1"), ("]", "1"), ("{", "-10"), ("}", "10")],
            "look 1 s or 10 s back and forward; space returns to live",
            Some("time"),
        )],
        make: |seconds| number(seconds).map(Action::Seek),
    },
    Row {
        name: "step",
        argument: "STEPS",
        meaning: "look so many steps further on; back if negative",
        keys: &[keys(&[("<", "-1"), (">", "1")], "look one step back and forward", None)],
        make: |steps| whole(steps).map(Action::Step),
    },
    Row {
        name: "zoom",
        argument: "[TIMES]",
        meaning: "show so many times as much; without a number, as at the start",
        keys: &[keys(
            &[("+", "0.5"), ("-", "2"), ("=", "")],
            "less time, more, as at the start; in some plots frequency or speed",
            None,
        )],
        make: |times| match times {
            "" => Ok(Action::ZoomReset),
            times => number(times).and_then(positive).map(Action::Zoom),
        },
    },
    Row {
        name: "span",
        argument: "SECONDS",
        meaning: "show so many seconds",
        keys: &[],
        make: |seconds| number(seconds).and_then(positive).map(Action::Span),
    },
    Row {
        name: "choose",
        argument: "PLOT|STEPS",
        meaning: "choose the plot whose scale and read-out keys change",
        keys: &[keys(&[("tab", "1"), ("shift-tab", "-1")], "choose the next plot, the one before; esc none", None)],
        make: |plot| Ok(Action::Choose(plot.to_owned())),
    },
    Row {
        name: "scale",
        argument: "[PLOT] auto|TIMES|LOW..HIGH",
        meaning: "let values follow, show so many times as much, or fix their range",
        keys: &[keys(&[("z", "0.5"), ("Z", "2")], "the chosen plot's values closer, wider; = lets them follow", None)],
        make: scale,
    },
    Row {
        name: "read",
        argument: "left|right|VALUE|off",
        meaning: "read the chosen plot at a frequency or speed, or the next mode",
        keys: &[keys(&[(",", "left"), (".", "right")], "the chosen plot's read-out to the left, to the right", None)],
        make: |there| match there {
            "left" => Ok(Action::Read(Read::Move(-1))),
            "right" => Ok(Action::Read(Read::Move(1))),
            "off" => Ok(Action::Read(Read::Off)),
            value => number(value).map(|value| Action::Read(Read::At(value))),
        },
    },
    Row {
        name: "strips",
        argument: "SERIES...|auto",
        meaning: "what the strips show: a word each, as y.1+z.1 force; auto: the layout's",
        keys: &[],
        make: |words| match words {
            "auto" => Ok(Action::Strips(None)),
            words => Strip::read_all(words).map(|strips| Action::Strips(Some(strips))),
        },
    },
    Row {
        name: "spectrum",
        argument: "MASS|LOW..HIGH|auto",
        meaning: "mass and frequencies of the spectra; auto: the bearing's mass, and all",
        keys: &[],
        make: spectra,
    },
    Row {
        name: "record",
        argument: "",
        meaning: "record the bench, or end that",
        keys: &[keys(&[("r", "")], "record the bench; again ends it", Some("record"))],
        make: |_| Ok(Action::Record),
    },
    Row {
        name: "acknowledge",
        argument: "",
        meaning: "acknowledge the alarms",
        keys: &[keys(&[("a", "")], "acknowledge the alarms", Some("alarms"))],
        make: |_| Ok(Action::Acknowledge),
    },
    Row {
        name: "pace",
        argument: "STEPS",
        meaning: "play a recording faster by so many steps, or slower",
        keys: &[keys(&[("(", "-1"), (")", "1")], "recording: slower, faster", None)],
        make: |steps| whole(steps).map(|steps| Action::Pace(steps as isize)),
    },
    Row {
        name: "event",
        argument: "COUNT",
        meaning: "go so many events on in a recording, or back",
        keys: &[keys(&[("n", "1"), ("N", "-1")], "recording: to the next event, the one before", None)],
        make: |count| whole(count).map(|count| Action::Event(count as isize)),
    },
    Row {
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
    Row {
        name: "loop",
        argument: "",
        meaning: "begin a loop in a recording, end it, drop it",
        keys: &[keys(&[("m", "")], "recording: a loop begins here, ends here, is dropped", None)],
        make: |_| Ok(Action::Loop),
    },
    Row {
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
    Row {
        name: "picture",
        argument: "[FILE]",
        meaning: "keep a picture of the screen: FILE.svg or FILE.txt, else both, named by bench and time",
        keys: &[keys(&[("P", "")], "keep a picture of the screen, as SVG and as text", None)],
        make: |file| Ok(Action::Picture(file.to_owned())),
    },
    Row {
        name: "scroll",
        argument: "ROWS",
        meaning: "scroll the lists on the screen by so many rows",
        keys: &[keys(&[("pageup", "-5"), ("pagedown", "5")], "scroll the lists: events, alarms, modes, numbers", None)],
        make: |rows| whole(rows).map(|rows| Action::Scroll(rows as isize)),
    },
    Row {
        name: "filter",
        argument: "",
        meaning: "type what the lists shall show: events, alarms, modes, numbers, settings, this help",
        keys: &[keys(&[("/", "")], "type what the lists shall show; esc shows all again", None)],
        make: |_| Ok(Action::Filter),
    },
    Row {
        name: "escape",
        argument: "",
        meaning: "close what lies on top",
        keys: &[keys(&[("esc", "")], "close what lies on top", None)],
        make: |_| Ok(Action::Escape),
    },
    Row {
        name: "suspend",
        argument: "",
        meaning: "back to the shell; `fg` returns",
        keys: &[keys(&[("ctrl-z", "")], "back to the shell; `fg` returns", None)],
        make: |_| Ok(Action::Suspend),
    },
];

/// The manual's table of keys: each with what it does.
#[must_use]
pub fn manual_keys() -> Vec<(String, &'static str)> {
    let keymap = crate::keymap::Keymap::default();
    let keys = ACTIONS.iter().flat_map(|row| row.keys.iter().map(move |keys| (row, keys)));
    keys.map(|(row, keys)| (keymap.shown(row, keys), keys.meaning)).collect()
}

/// The manual's table of commands that can be typed: each with what it does.
#[must_use]
pub fn manual_commands() -> Vec<(String, &'static str)> {
    let command = |row: &Row| (format!("{} {}", row.name, row.argument).trim_end().to_owned(), row.meaning);
    ACTIONS.iter().map(command).collect()
}

/// What the mouse does, in the help.
pub(crate) const MOUSE: [(&str, &str); 5] = [
    ("click", "choose a plot; select a setting, a mode, a frequency or a speed"),
    ("click on strips, damping", "look at that moment; the same on an event"),
    ("click on an alarm", "acknowledge it; look at the moment of one that is"),
    ("drag", "nudge the selected setting; on a plot, as click"),
    ("wheel", "next setting; more or less time (strips), frequency, speed, or value"),
];

fn number(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("'{text}': expected a number"))
}

fn positive(number: f64) -> Result<f64, String> {
    if number > 0.0 { Ok(number) } else { Err(format!("{number}: expected a number above 0")) }
}

fn whole(text: &str) -> Result<i64, String> {
    text.parse().map_err(|_| format!("'{text}': expected a whole number"))
}

/// `LOW..HIGH`.
pub(crate) fn range(text: &str) -> Option<[f64; 2]> {
    let (low, high) = text.split_once("..")?;
    Some([number(low).ok()?, number(high).ok()?])
}

/// `poles -1..0.1 0..3`, `0.5`, `orbits auto`.
fn scale(text: &str) -> Result<Action, String> {
    let of = |word: &str| match (word, range(word)) {
        ("auto", _) => Some(Scaling::Auto),
        (_, Some(range)) => Some(Scaling::Fix(range)),
        (word, None) => number(word).and_then(positive).ok().map(Scaling::Times),
    };
    let mut words = text.split_whitespace().peekable();
    let plot = words.next_if(|word| of(word).is_none()).map(str::to_owned);
    let scalings = words.map(|word| of(word).ok_or(word)).collect::<Result<Vec<_>, _>>();
    match scalings {
        Err(found) => Err(format!("'{found}': expected auto, TIMES above 0 or LOW..HIGH")),
        Ok(scalings) if scalings.is_empty() => {
            Err(format!("{text}: expected auto, TIMES or LOW..HIGH").trim_start().into())
        }
        Ok(scalings) => Ok(Action::Scale(plot, scalings)),
    }
}

/// `2`, `2 -3..3`, `auto`.
fn spectra(text: &str) -> Result<Action, String> {
    let (mut mass, mut along) = (None, None);
    for word in text.split_whitespace() {
        match (word, range(word), word.parse::<usize>()) {
            ("auto", ..) => (mass, along) = (Some(None), Some(Scaling::Auto)),
            (_, Some(range), _) => along = Some(Scaling::Fix(range)),
            (_, _, Ok(number @ 1..)) => mass = Some(Some(number - 1)),
            _ => return Err(format!("'{word}': expected a mass, LOW..HIGH or auto")),
        }
    }
    Ok(Action::Spectra(mass, along))
}

/// `kd=0.1 speed=3`, or `speed 3`.
fn assignments(text: &str) -> Result<Action, String> {
    let spaced = text.replace('=', " = ");
    let words: Vec<&str> = spaced.split_whitespace().filter(|word| *word != "=").collect();
    let mut set = Vec::new();
    for pair in words.chunks(2) {
        let key: Key = pair[0].parse().map_err(|error: rotor::SettingsError| error.to_string())?;
        let value = pair.get(1).ok_or_else(|| format!("{key}: expected {key}=VALUE"))?;
        set.push((key, number(value).map_err(|error| format!("{key} = {error}"))?));
    }
    Ok(Action::Set(set))
}

/// Whether a word is a setting, with or without an index.
fn is_setting(word: &str) -> bool {
    word.parse::<Key>().is_ok()
}

/// What a command line asks for.
///
/// # Errors
/// In words: no such command, or what is wrong with its argument.
pub(crate) fn parse(line: &str) -> Result<Action, String> {
    let line = line.trim();
    let end = line.find([' ', '=']).unwrap_or(line.len());
    let (name, rest) = line.split_at(end);
    let Some(row) = ACTIONS.iter().find(|row| row.name == name) else {
        if is_setting(name) {
            return assignments(line);
        }
        return Err(format!("no command '{name}': tab shows what there is, ? the help"));
    };
    let argument = rest.trim();
    match (row.argument, argument) {
        ("", "") => {}
        ("", found) => return Err(format!("{name} '{found}': expected nothing after {name}")),
        (wanted, "") if !wanted.starts_with('[') => return Err(format!("{name}: expected {name} {wanted}")),
        _ => {}
    }
    (row.make)(argument).map_err(|error| format!("{name} {error}"))
}

/// Every way to go on with a command line: whole lines.
pub(crate) fn completions(line: &str, layouts: &[String], presets: &[String]) -> Vec<String> {
    let (before, word) = line.rsplit_once(' ').map_or(("", line), |(before, word)| (before, word));
    let settings = || PARAMETERS.iter().map(|parameter| format!("{}=", parameter.name));
    let first = before.split_whitespace().next();
    let candidates: Vec<String> = match first {
        None => {
            let named = ACTIONS.iter().map(|row| {
                let space = if row.argument.is_empty() { "" } else { " " };
                format!("{}{space}", row.name)
            });
            named.chain(settings()).collect()
        }
        Some("layout") => layouts.to_vec(),
        Some("load" | "save" | "delete") => presets.to_vec(),
        Some("set") => settings().collect(),
        Some("search") => ["robust", "stop"].map(str::to_owned).to_vec(),
        Some("choose") => plots().map(str::to_owned).collect(),
        Some("scale") => plots().chain(["auto"]).map(str::to_owned).collect(),
        Some("strips") => series::names().chain(["auto"]).map(str::to_owned).collect(),
        Some("spectrum") => vec!["auto".to_owned()],
        Some("read") => ["left", "right", "off"].map(str::to_owned).to_vec(),
        Some(_) => Vec::new(),
    };
    let whole = |candidate: String| if before.is_empty() { candidate } else { format!("{before} {candidate}") };
    candidates.into_iter().filter(|candidate| candidate.starts_with(word)).map(whole).collect()
}

/// What a completion means: what a command does, what a setting is. Empty for anything else.
pub(crate) fn meaning(word: &str) -> String {
    let word = word.trim_end();
    if let Some(row) = ACTIONS.iter().find(|row| row.name == word) {
        return format!("{} {}", row.argument, row.meaning).trim_start().to_owned();
    }
    let setting = word.strip_suffix('=').and_then(|name| PARAMETERS.iter().find(|parameter| parameter.name == name));
    setting.map_or_else(String::new, |parameter| parameter.meaning.to_owned())
}

/// What all of some lines begin with.
pub(crate) fn common(lines: &[String]) -> String {
    let Some((first, rest)) = lines.split_first() else { return String::new() };
    let alike = |at: usize, c: char| rest.iter().all(|line| line[at.min(line.len())..].starts_with(c));
    let end = first.char_indices().find(|(at, c)| !alike(*at, *c)).map_or(first.len(), |(at, _)| at);
    first[..end].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_and_every_key_is_a_command_that_parses() {
        for row in ACTIONS {
            assert!(ACTIONS.iter().filter(|other| other.name == row.name).count() == 1, "{} twice", row.name);
            assert!(!is_setting(row.name), "{} is a setting", row.name);
            for (chord, argument) in row.keys.iter().flat_map(|keys| keys.chords) {
                let line = format!("{} {argument}", row.name);
                // Keys of commands that take a text open the command line with the name in it.
                let needs_text = !row.argument.is_empty() && !row.argument.starts_with('[') && argument.is_empty();
                assert!(needs_text || parse(&line).is_ok(), "{chord}: {line}: {:?}", parse(&line));
            }
        }
    }

    #[test]
    fn commands_are_parsed_and_mistakes_told() {
        let key = |name: &str| name.parse::<Key>().unwrap();
        assert_eq!(parse("seek -30"), Ok(Action::Seek(-30.0)));
        assert_eq!(parse("  note two words "), Ok(Action::Note("two words".into())));
        assert_eq!(parse("speed 6"), Ok(Action::Set(vec![(key("speed"), 6.0)])));
        assert_eq!(parse("kd.2=-1e-3"), Ok(Action::Set(vec![(key("kd.2"), -1e-3)])));
        assert_eq!(parse("set kd=1 speed = 3"), Ok(Action::Set(vec![(key("kd"), 1.0), (key("speed"), 3.0)])));
        assert_eq!(parse("zoom"), Ok(Action::ZoomReset));
        let fix = |low, high| Scaling::Fix([low, high]);
        assert_eq!(parse("scale 0.5"), Ok(Action::Scale(None, vec![Scaling::Times(0.5)])));
        assert_eq!(parse("scale auto"), Ok(Action::Scale(None, vec![Scaling::Auto])));
        assert_eq!(
            parse("scale poles -1..0.1 0..3"),
            Ok(Action::Scale(Some("poles".into()), vec![fix(-1.0, 0.1), fix(0.0, 3.0)]))
        );
        assert_eq!(parse("strips auto"), Ok(Action::Strips(None)));
        assert!(matches!(parse("strips y.1+z.1 force"), Ok(Action::Strips(Some(strips))) if strips.len() == 2));
        assert_eq!(parse("spectrum 2 -3..3"), Ok(Action::Spectra(Some(Some(1)), Some(fix(-3.0, 3.0)))));
        assert_eq!(parse("spectrum auto"), Ok(Action::Spectra(Some(None), Some(Scaling::Auto))));
        assert_eq!(parse("read -1.25"), Ok(Action::Read(Read::At(-1.25))));
        for (line, complaint) in [
            ("scale", "scale : expected auto, TIMES or LOW..HIGH"),
            ("scale orbits", "scale orbits: expected auto, TIMES or LOW..HIGH"),
            ("scale orbits 1..x", "scale '1..x': expected auto, TIMES above 0 or LOW..HIGH"),
            ("scale orbits -2", "scale '-2': expected auto, TIMES above 0 or LOW..HIGH"),
            ("strips y.1+speed", "strips 'y.1+speed': expected series of one unit, and speed has another"),
            ("spectrum 0", "spectrum '0': expected a mass, LOW..HIGH or auto"),
            ("read there", "read 'there': expected a number"),
            ("fly", "no command 'fly': tab shows what there is, ? the help"),
            ("seek", "seek: expected seek SECONDS"),
            ("seek x", "seek 'x': expected a number"),
            ("seek NaN", "seek 'NaN': expected a number"),
            ("zoom 0", "zoom 0: expected a number above 0"),
            ("undo it", "undo 'it': expected nothing after undo"),
            ("kd", "kd: expected kd=VALUE"),
            ("kd=much", "kd = 'much': expected a number"),
            ("", "no command '': tab shows what there is, ? the help"),
        ] {
            assert_eq!(parse(line), Err(complaint.to_owned()), "{line}");
        }
    }

    #[test]
    fn completion_offers_names_settings_and_what_commands_take() {
        let layouts = ["operator".to_owned(), "overview".to_owned()];
        let complete = |line: &str| completions(line, &layouts, &["good".to_owned()]);
        assert_eq!(complete("se"), ["select ", "set ", "search ", "seek "]);
        assert_eq!(complete("layout o"), ["layout operator", "layout overview"]);
        assert_eq!(complete("load "), ["load good"]);
        assert_eq!(complete("strips y.1 rad"), ["strips y.1 radius"]);
        assert_eq!(complete("scale po"), ["scale poles"]);
        assert!(complete("choose ").contains(&"choose spectrum".to_owned()));
        assert_eq!(complete("set kd=1 sp"), ["set kd=1 speed="]);
        assert!(complete("").len() > 20 && complete("").contains(&"speed=".to_owned()));
        assert_eq!(common(&complete("se")), "se");
        assert_eq!(common(&complete("layout ")), "layout o");
        assert_eq!(common(&["ä".to_owned(), "ö".to_owned()]), "");
        assert_eq!(common(&[]), "");
    }
}
