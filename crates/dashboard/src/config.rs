//! The configuration file: keys of a person's own, limits of alarms, looks, and the layout to start with.

use alarms::{AskedLimit, Limits, Watch};
use text::{Faults, Reader, Table, Value, as_number};

use crate::actions::ACTIONS;
use crate::appearance::ThemeName;
use crate::keymap::{Chord, Keymap};
use crate::on_alarm::OnAlarm;

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
    /// What an alarm of the machine does to a speed that rises.
    pub on_alarm: OnAlarm,
    /// Whether the terminal's bell rings when one rises.
    pub bell: bool,
}

impl Config {
    /// Reads the text of a configuration file.
    ///
    /// # Errors
    /// All that is wrong with it, by line and column: unknown keys and commands, and a key that is bound twice.
    pub fn read(text: &str) -> Result<Self, Faults> {
        let (mut reader, file) = Reader::parse(text)?;
        reader.only(&file, &["layout", "theme", "ascii", "keys", "alarms"]);
        let themes: Vec<String> = ThemeName::all().map(|(theme, _)| theme.to_string()).collect();
        let themes: Vec<&str> = themes.iter().map(String::as_str).collect();
        let mut config = Self {
            layout: reader.string(&file, "layout", "the name of a layout").map(str::to_owned),
            theme: reader.choice(&file, "theme", &themes).and_then(|theme| theme.parse().ok()),
            ascii: reader.boolean(&file, "ascii").unwrap_or_default(),
            ..Self::default()
        };
        if let Some(keys) = reader.table(&file, "keys") {
            config.bind(&mut reader, keys);
        }
        if let Some(alarms) = reader.table(&file, "alarms") {
            config.limit(&mut reader, alarms);
        }
        reader.finish(config)
    }

    /// Reads `[keys]`, in the order in which they stand.
    fn bind(&mut self, reader: &mut Reader<'_>, keys: &Table<'_>) {
        let mut entries: Vec<_> = keys.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let mut bound: Vec<(Chord, String)> = Vec::new();
        for (key, value) in entries {
            let name = &**key.get_ref();
            let Some(command) = value.get_ref().as_str() else {
                reader.wrong(name, value, "a command in quotes, such as \"nudge 5\"");
                continue;
            };
            let chord: Result<Chord, String> = name.parse();
            if let Some((_, other)) = chord.ok().and_then(|chord| bound.iter().find(|(other, _)| *other == chord)) {
                let expected = format!("one command a key: it is bound as '{other}' above");
                reader.fault(key.span(), format!("'{name}' again"), expected);
                continue;
            }
            match self.keys.bind(name, command) {
                Ok(chord) => bound.push((chord, name.to_owned())),
                Err(why) => reader.told(key.span(), &why, "a command"),
            }
        }
    }

    /// Reads `[alarms]`.
    fn limit(&mut self, reader: &mut Reader<'_>, alarms: &Table<'_>) {
        let known: Vec<&str> = ["bell", "run-up"].into_iter().chain(limited().map(Watch::name)).collect();
        reader.only(alarms, &known);
        self.bell = reader.boolean(alarms, "bell").unwrap_or_default();
        let chosen = reader.choice(alarms, "run-up", &OnAlarm::ALL.map(|(name, _)| name));
        let chosen = chosen.and_then(|chosen| OnAlarm::ALL.into_iter().find(|(name, _)| *name == chosen));
        self.on_alarm = chosen.map_or(OnAlarm::default(), |(_, on_alarm)| on_alarm);
        for watch in limited() {
            let Some(value) = alarms.get(watch.name()) else { continue };
            match limits(value).map(|asked| asked.set(&mut self.limits, watch)) {
                Some(Ok(())) => {}
                Some(Err(error)) => reader.wrong(watch.name(), value, error.to_string()),
                None => {
                    let or = if watch.can_follow() { ", \"off\" or \"machine\"" } else { ", or \"off\"" };
                    reader.wrong(watch.name(), value, format!("[warning, alarm], two numbers{or}"));
                }
            }
        }
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
        text += "\n# Alarms: [warning, alarm], or \"off\"; \"machine\" follows its clearances, its trip and its actuator. The bell is the \
                 terminal's.\n[alarms]\n# bell = false\n";
        text += "# What an alarm of the machine does to a speed that rises: \"go-on\", \"hold\", or \"coast-down\" to rest at the rate at which it rose.\n\
                 # run-up = \"go-on\"\n";
        let limits = Limits::default();
        for watch in limited() {
            let value = match limits.pair(watch) {
                _ if limits.follows(watch) => "\"machine\"".to_owned(),
                Some([warning, alarm]) => format!("[{warning:?}, {alarm:?}]"),
                None => "\"off\"".to_owned(),
            };
            text += &format!("# {}\n# {watch} = {value}\n", watch.meaning());
        }
        text
    }
}

/// What a person can set limits of.
fn limited() -> impl Iterator<Item = Watch> {
    Watch::ALL.into_iter().filter(|watch| watch.has_limits())
}

/// `[warning, alarm]`, `"off"` or `"machine"`; `None` is neither.
fn limits(value: &Value<'_>) -> Option<AskedLimit> {
    let content = value.get_ref();
    match content.as_str() {
        Some("off") => return Some(AskedLimit::Off),
        Some("machine") => return Some(AskedLimit::Machine),
        _ => {}
    }
    match content.as_array()?.iter().map(as_number).collect::<Option<Vec<_>>>()?[..] {
        [warning, alarm] => Some(AskedLimit::Pair([warning, alarm])),
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
        let read = Config::read(&all).unwrap_or_else(|faults| panic!("{faults}\n{all}"));
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
        assert!(limits.follows(Watch::Force) && !limits.follows(Watch::Orbit));
        assert_eq!(limits.pair(Watch::Lateness), Limits::default().pair(Watch::Lateness));
    }

    #[test]
    fn mistakes_are_told_by_line_and_column() {
        for (text, fault) in [
            ("theme = \"dark\"", "1:9: theme = \"dark\": expected one of default, full, contrast, colour-blind"),
            ("theme = 1", "1:9: theme = 1: expected one of default, full, contrast, colour-blind"),
            ("ascii = 1", "1:9: ascii = 1: expected true or false"),
            ("layout = 3", "1:10: layout = 3: expected the name of a layout"),
            ("colour = 1", "1:1: unknown key 'colour': expected one of layout, theme, ascii, keys, alarms"),
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
                "2:1: unknown key 'speed': expected one of bell, run-up, damping, sensitivity, delay-margin, orbit, force, saturation, lateness, losses",
            ),
            ("[alarms]\nrun-up = \"stop\"", "2:10: run-up = \"stop\": expected one of go-on, hold, coast-down"),
            ("[alarms]\norbit = [5, 3]", "2:9: orbit = [5, 3]: expected the alarm at or above the warning"),
            ("[alarms]\ndamping = [0, 0.1]", "2:11: damping = [0, 0.1]: expected the alarm at or below the warning"),
            (
                "[alarms]\nforce = [1]",
                "2:9: force = [1]: expected [warning, alarm], two numbers, \"off\" or \"machine\"",
            ),
            ("[alarms]\nlosses = 3", "2:10: losses = 3: expected [warning, alarm], two numbers, or \"off\""),
            (
                "[alarms]\ndamping = \"machine\"",
                "2:11: damping = \"machine\": expected a limit of its own: only orbit and force follow the machine",
            ),
            ("[alarms]\nforce = [1, inf]", "2:9: force = [1, inf]: expected finite numbers"),
            ("[alarms]\nbell = 1", "2:8: bell = 1: expected true or false"),
            ("[keys]\nx = 1", "2:5: x = 1: expected a command in quotes, such as \"nudge 5\""),
            (
                "[keys]\n\"ctrl-alt-x\" = \"undo\"\n\"alt-ctrl-x\" = \"redo\"",
                "3:1: 'alt-ctrl-x' again: expected one command a key: it is bound as 'ctrl-alt-x' above",
            ),
            ("[keys]\nq = \"undo\"", "2:1: 'q': expected another key: this one always quits"),
        ] {
            assert_eq!(Config::read(text).unwrap_err().to_string(), fault, "{text}");
        }
        assert!(Config::read("[keys]\nx = \"undo\"\nx = \"redo\"").unwrap_err().to_string().starts_with("3:1: "));
    }
}
