//! The configuration file: keys of a person's own, limits of alarms, looks, and the layout to start with.

use alarms::{Limits, Watch};
use text::{Fault as Problem, Faults as Problems};
use toml::de::{DeTable, DeValue};

use crate::actions::ACTIONS;
use crate::appearance::ThemeName;
use crate::keymap::{Chord, Keymap};

/// What a configuration file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Keys and what they stand for.
    pub keys: Keymap,
    /// The layout to start with, by name or file.
    pub layout: Option<String>,
    /// The theme.
    pub theme: Option<ThemeName>,
    /// Nothing but ASCII, whatever the locale says.
    pub ascii: bool,
    /// Limits past which alarms rise, here and in recordings.
    pub limits: Limits,
    /// Whether the terminal's bell rings when one rises.
    pub bell: bool,
}

impl Config {
    /// Reads the text of a configuration file.
    ///
    /// # Errors
    /// All that is wrong with it, by line and column: unknown keys and commands, and a key that is bound twice.
    pub fn read(text: &str) -> Result<Self, Problems> {
        let mut problems = Vec::new();
        let mut config = Self::default();
        let (table, errors) = DeTable::parse_recoverable(text);
        for error in &errors {
            problems.push(Problem::at(text, error.span().unwrap_or(0..0), error.message(), "TOML"));
        }
        if let Some(problems) = Problems::some(problems) {
            return Err(problems);
        }
        let mut problems = Vec::new();
        let mut problem =
            |at: usize, found: &str, expected: &str| problems.push(Problem::at(text, at..at, found, expected));
        for (key, value) in table.get_ref() {
            let written = text.get(value.span()).unwrap_or_default();
            match (&**key.get_ref(), value.get_ref()) {
                ("layout", DeValue::String(layout)) => config.layout = Some(layout.to_string()),
                ("layout", _) => problem(value.span().start, written, "the name of a layout"),
                ("theme", DeValue::String(name)) => match name.parse() {
                    Ok(theme) => config.theme = Some(theme),
                    Err(_) => problem(value.span().start, written, &ThemeName::expected()),
                },
                ("theme", _) => problem(value.span().start, written, &ThemeName::expected()),
                ("ascii", DeValue::Boolean(ascii)) => config.ascii = *ascii,
                ("ascii", _) => problem(value.span().start, written, "true or false"),
                ("keys", DeValue::Table(keys)) => {
                    let mut entries: Vec<_> = keys.iter().collect();
                    entries.sort_by_key(|(key, _)| key.span().start);
                    let mut bound: Vec<(Chord, String)> = Vec::new();
                    for (key, value) in entries {
                        let at = key.span().start;
                        let DeValue::String(command) = value.get_ref() else {
                            let written = text.get(value.span()).unwrap_or_default();
                            problem(value.span().start, written, "a command in quotes, such as \"nudge 5\"");
                            continue;
                        };
                        let name = &**key.get_ref();
                        let chord: Result<Chord, String> = name.parse();
                        let twice = chord.ok().and_then(|chord| bound.iter().find(|(other, _)| *other == chord));
                        if let Some((_, other)) = twice {
                            problem(
                                at,
                                &format!("'{name}' again"),
                                &format!("one command a key: it is bound as '{other}' above"),
                            );
                            continue;
                        }
                        match config.keys.bind(name, command) {
                            Ok(chord) => bound.push((chord, name.to_owned())),
                            Err(why) => {
                                let (found, expected) = why.split_once(": expected ").unwrap_or((&*why, "a command"));
                                problem(at, found, expected);
                            }
                        }
                    }
                }
                ("keys", _) => problem(value.span().start, written, "[keys], with a command for each key"),
                ("alarms", DeValue::Table(alarms)) => {
                    for (key, value) in alarms {
                        let written = text.get(value.span()).unwrap_or_default();
                        let name = &**key.get_ref();
                        let watch = limited().find(|watch| watch.name() == name);
                        let read = match (name, watch, limits(value.get_ref())) {
                            ("bell", ..) => match value.get_ref() {
                                DeValue::Boolean(bell) => {
                                    config.bell = *bell;
                                    Ok(())
                                }
                                _ => Err("true or false".into()),
                            },
                            (_, Some(watch), Some(limits)) => {
                                config.limits.set(watch, limits).map_err(|error| error.to_string())
                            }
                            (_, Some(_), None) => Err("[warning, alarm], two numbers, or \"off\"".into()),
                            (_, None, _) => {
                                let expected = "bell, damping, orbit, force, saturation, lateness or losses";
                                problem(key.span().start, &format!("'{name}'"), expected);
                                Ok(())
                            }
                        };
                        if let Err(expected) = read {
                            problem(value.span().start, written, &expected);
                        }
                    }
                }
                ("alarms", _) => problem(value.span().start, written, "[alarms], with limits"),
                (other, _) => {
                    problem(key.span().start, &format!("'{other}'"), "layout, theme, ascii, [keys] or [alarms]");
                }
            }
        }
        Problems::some(problems).map_or(Ok(config), Err)
    }

    /// A configuration file that says what holds without one, with every action explained.
    #[must_use]
    pub fn defaults() -> String {
        let mut text = String::from(
            "# Whirl's dashboard. What stands here is what holds without a file: change a line and take its # away.\n\n\
             # The layout to start with: a name, or a file.\n# layout = \"overview\"\n\n",
        );
        text += "# Colours. Full and colour-blind need a terminal with true colours.\n";
        for (theme, meaning) in ThemeName::all() {
            text += &format!("#   {theme}: {meaning}\n");
        }
        text += &format!("# theme = \"{}\"\n\n", ThemeName::default());
        text += "# Nothing but ASCII on the screen, whatever the locale says.\n# ascii = false\n\n";
        text.push_str(
            "\
             # A key stands for a command; \"\" takes a key away. Commands: whatever can be typed after `:`.\n[keys]\n",
        );
        let keymap = Keymap::default();
        for row in ACTIONS {
            let name = format!("{} {}", row.name, row.argument);
            text += &format!("# {}: {}\n", name.trim_end(), row.meaning);
            for (chord, command) in keymap.all().filter(|(_, command)| command.split(' ').next() == Some(row.name)) {
                text += &format!("# {chord:?} = {command:?}\n");
            }
        }
        text += "\n# Alarms: [warning, alarm], or \"off\". The bell is the terminal's.\n[alarms]\n# bell = false\n";
        let limits = Limits::default();
        for watch in limited() {
            let value = limits.pair(watch).map_or_else(|| "\"off\"".to_owned(), |[w, a]| format!("[{w:?}, {a:?}]"));
            text += &format!("# {}\n# {watch} = {value}\n", watch.meaning());
        }
        text
    }
}

/// What a person can set limits of.
fn limited() -> impl Iterator<Item = Watch> {
    Watch::ALL.into_iter().filter(|watch| watch.has_limits())
}

/// `[warning, alarm]`, or `"off"`; the outer `None` is neither.
fn limits(value: &DeValue<'_>) -> Option<Option<[f64; 2]>> {
    let number = |value: &DeValue<'_>| match value {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse::<f64>().ok(),
        DeValue::Float(number) => number.as_str().parse::<f64>().ok(),
        _ => None,
    };
    match value {
        DeValue::String(off) if off == "off" => Some(None),
        DeValue::Array(pair) => match pair.iter().map(|value| number(value.get_ref())).collect::<Option<Vec<_>>>()?[..]
        {
            [warning, alarm] => Some(Some([warning, alarm])),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_what_holds_without_a_file() {
        let text = Config::defaults();
        assert_eq!(Config::read(&text).unwrap(), Config::default());
        // With every line in force too: they are what holds.
        let bare = |line: &str| line.strip_prefix("# ").filter(|rest| rest.contains(" = ")).unwrap_or(line).to_owned();
        let all: String = text.lines().map(|line| bare(line) + "\n").collect();
        let read = Config::read(&all).unwrap_or_else(|problems| panic!("{problems}\n{all}"));
        let sorted = |config: &Config| {
            let mut keys: Vec<(String, String)> = config.keys.all().map(|(k, c)| (k, c.to_owned())).collect();
            keys.sort();
            keys
        };
        assert_eq!(sorted(&read), sorted(&Config::default()));
        assert_eq!(read.layout.as_deref(), Some("overview"));
        assert_eq!((read.theme, read.ascii), (Some(ThemeName::default()), false));
    }

    #[test]
    fn limits_of_alarms_are_read() {
        let read =
            Config::read("[alarms]\nbell = true\norbit = [2, 3.5]\nlosses = \"off\"\ndamping = [0.05, 0.01]").unwrap();
        let limits = &read.limits;
        assert!(read.bell);
        assert_eq!((limits.pair(Watch::Orbit), limits.pair(Watch::Losses)), (Some([2.0, 3.5]), None));
        assert_eq!((limits.pair(Watch::Damping), limits.pair(Watch::Force)), (Some([0.05, 0.01]), None));
        assert_eq!(limits.pair(Watch::Lateness), Limits::default().pair(Watch::Lateness));
    }

    #[test]
    fn mistakes_are_told_by_line_and_column() {
        for (text, problem) in [
            ("theme = \"dark\"", "1:9: \"dark\": expected default, full, contrast or colour-blind"),
            ("theme = 1", "1:9: 1: expected default, full, contrast or colour-blind"),
            ("ascii = 1", "1:9: 1: expected true or false"),
            ("layout = 3", "1:10: 3: expected the name of a layout"),
            ("colour = 1", "1:1: 'colour': expected layout, theme, ascii, [keys] or [alarms]"),
            (
                "[keys]\n\"x\" = \"fly\"",
                "2:1: no command 'fly': tab shows what there is, ? the help: expected a command",
            ),
            (
                "[keys]\n\"F1\" = \"undo\"",
                "2:1: 'F1': expected a key such as x, X, ctrl-x, alt-x, shift-left, f5, space or enter",
            ),
            (
                "[alarms]\nspeed = [1, 2]",
                "2:1: 'speed': expected bell, damping, orbit, force, saturation, lateness or losses",
            ),
            ("[alarms]\norbit = [5, 3]", "2:9: [5, 3]: expected the alarm at or above the warning"),
            ("[alarms]\ndamping = [0, 0.1]", "2:11: [0, 0.1]: expected the alarm at or below the warning"),
            ("[alarms]\nforce = [1]", "2:9: [1]: expected [warning, alarm], two numbers, or \"off\""),
            ("[alarms]\nforce = [1, inf]", "2:9: [1, inf]: expected finite numbers"),
            ("[alarms]\nbell = 1", "2:8: 1: expected true or false"),
            ("[keys]\nx = 1", "2:5: 1: expected a command in quotes, such as \"nudge 5\""),
            (
                "[keys]\n\"ctrl-alt-x\" = \"undo\"\n\"alt-ctrl-x\" = \"redo\"",
                "3:1: 'alt-ctrl-x' again: expected one command a key: it is bound as 'ctrl-alt-x' above",
            ),
            ("[keys]\nq = \"undo\"", "2:1: 'q': expected another key: this one always quits"),
        ] {
            assert_eq!(Config::read(text).unwrap_err().to_string(), problem, "{text}");
        }
        assert!(Config::read("[keys]\nx = \"undo\"\nx = \"redo\"").unwrap_err().to_string().starts_with("3:1: "));
    }
}
