//! Which key stands for which command line: the defaults of [`ACTIONS`], and what the configuration puts in their place.

use std::fmt;
use std::str::FromStr;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use crate::actions::{ACTIONS, Action, ActionRow, KeyBinding, parse};

/// A key with what is held down, spelled as in configuration files.
///
/// Read here and not by a library: crokey 1.5 reads `X` as `x` and shows `-` as `Hyphen`, so keys that people have in their
/// files would come to mean others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Chord(KeyCode, KeyModifiers);

/// Keys that are not characters, by name.
const NAMED: [(&str, KeyCode); 15] = [
    ("up", KeyCode::Up),
    ("down", KeyCode::Down),
    ("left", KeyCode::Left),
    ("right", KeyCode::Right),
    ("enter", KeyCode::Enter),
    ("esc", KeyCode::Esc),
    ("space", KeyCode::Char(' ')),
    ("tab", KeyCode::Tab),
    ("backspace", KeyCode::Backspace),
    ("delete", KeyCode::Delete),
    ("insert", KeyCode::Insert),
    ("home", KeyCode::Home),
    ("end", KeyCode::End),
    ("pageup", KeyCode::PageUp),
    ("pagedown", KeyCode::PageDown),
];

/// What is held down, by name.
const HELD: [(&str, KeyModifiers); 3] =
    [("ctrl-", KeyModifiers::CONTROL), ("alt-", KeyModifiers::ALT), ("shift-", KeyModifiers::SHIFT)];

impl Chord {
    /// The chord of a key press.
    pub(crate) fn of(key: KeyEvent) -> Self {
        let mut held = key.modifiers & (KeyModifiers::SHIFT | KeyModifiers::CONTROL | KeyModifiers::ALT);
        if matches!(key.code, KeyCode::Char(_)) {
            // A capital carries its shift in itself; terminals differ in whether they say so again.
            held -= KeyModifiers::SHIFT;
        }
        if key.code == KeyCode::BackTab {
            return Self(KeyCode::Tab, held | KeyModifiers::SHIFT);
        }
        Self(key.code, held)
    }
}

impl Chord {
    /// The press of it.
    pub(crate) fn event(self) -> KeyEvent {
        KeyEvent::new(self.0, self.1)
    }
}

impl FromStr for Chord {
    type Err = String;

    /// Reads `x`, `X`, `?`, `ctrl-x`, `shift-left`, `f5`, `space` ...
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}': expected a key such as x, X, ctrl-x, alt-x, shift-left, f5, space or enter");
        let (mut rest, mut held) = (text, KeyModifiers::NONE);
        while let Some((name, modifier)) =
            HELD.iter().find(|(name, _)| rest.starts_with(name) && rest.len() > name.len())
        {
            rest = &rest[name.len()..];
            held |= *modifier;
        }
        let mut letters = rest.chars();
        let code = match (letters.next(), letters.next()) {
            (Some(letter), None) => KeyCode::Char(letter),
            _ => {
                let named = NAMED.iter().find(|(name, _)| *name == rest).map(|(_, code)| *code);
                let function = || rest.strip_prefix('f')?.parse().ok().filter(|n| (1..=24).contains(n)).map(KeyCode::F);
                named.or_else(function).ok_or_else(wrong)?
            }
        };
        if matches!(code, KeyCode::Char(_)) && held.contains(KeyModifiers::SHIFT) {
            return Err(format!("'{text}': expected the capital instead of shift"));
        }
        Ok(Self(code, held))
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, modifier) in HELD {
            if self.1.contains(modifier) {
                f.write_str(name)?;
            }
        }
        match (NAMED.iter().find(|(_, code)| *code == self.0), self.0) {
            (Some((name, _)), _) => f.write_str(name),
            (None, KeyCode::Char(letter)) => write!(f, "{letter}"),
            (None, KeyCode::F(number)) => write!(f, "f{number}"),
            (None, other) => write!(f, "{other}"),
        }
    }
}

/// Keys and the command lines they stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct Keymap(Vec<(Chord, String)>);

impl Default for Keymap {
    fn default() -> Self {
        let mut bound = Vec::new();
        for row in ACTIONS {
            for (chord, argument) in row.keys.iter().flat_map(|keys| keys.chords) {
                let chord = chord.parse().expect("a test reads them all");
                bound.push((chord, line(row, argument)));
            }
        }
        Self(bound)
    }
}

/// The command line of a row with an argument.
fn line(row: &ActionRow, argument: &str) -> String {
    format!("{} {argument}", row.name).trim_end().to_owned()
}

impl Keymap {
    /// Lets `key` stand for `command` in place of what it stood for; for nothing if that is empty.
    ///
    /// # Errors
    /// In words: no such key or command, or a key that must stay what it is.
    pub(crate) fn bind(&mut self, key: &str, command: &str) -> Result<Chord, String> {
        let chord: Chord = key.parse()?;
        let keeps = self.0.iter().find(|(bound, line)| *bound == chord && line == "quit");
        if keeps.is_some() && command != "quit" {
            return Err(format!("'{key}': expected another key: this one always quits"));
        }
        let starts_typing = ACTIONS.iter().any(|row| row.name == command);
        if !command.is_empty() && !starts_typing {
            parse(command)?;
        }
        self.0.retain(|(bound, _)| *bound != chord);
        if !command.is_empty() {
            self.0.push((chord, command.to_owned()));
        }
        Ok(chord)
    }

    /// What a key does while nothing is being typed.
    pub(crate) fn action(&self, key: KeyEvent) -> Option<Action> {
        let chord = Chord::of(key);
        let line = self.0.iter().find(|(bound, _)| *bound == chord).map(|(_, line)| line)?;
        // A command that lacks its argument is typed on from there.
        Some(parse(line).unwrap_or_else(|_| Action::Command(format!("{line} "))))
    }

    /// The keys of one line of the help, as people read them; empty if the configuration has taken them away.
    pub(crate) fn shown(&self, row: &ActionRow, keys: &KeyBinding) -> String {
        let lines: Vec<String> = keys.chords.iter().map(|(_, argument)| line(row, argument)).collect();
        let bound = self.0.iter().filter(|(_, bound)| lines.contains(bound));
        let mut mine: Vec<String> = bound.map(|(chord, _)| chord.to_string()).collect();
        // Keys of another line of the same action are told there.
        if keys.chords.len() == 9 && mine == ["1", "2", "3", "4", "5", "6", "7", "8", "9"] {
            mine = vec!["1 to 9".to_owned()];
        }
        mine.join(" ")
    }

    /// Keys that stand for command lines of their own, which no default does.
    pub(crate) fn own(&self) -> impl Iterator<Item = (String, &str)> {
        let known = |bound: &str| {
            ACTIONS.iter().any(|row| {
                row.keys.iter().flat_map(|keys| keys.chords).any(|(_, argument)| line(row, argument) == bound)
            })
        };
        self.0.iter().filter(move |(_, bound)| !known(bound)).map(|(chord, bound)| (chord.to_string(), &**bound))
    }

    /// Every key and its command line.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &str)> {
        self.0.iter().map(|(chord, bound)| (chord.to_string(), &**bound))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use KeyCode::{Char, Left, Right};
    use telemetry::edits::Edit;

    const NONE: KeyModifiers = KeyModifiers::NONE;
    const SHIFT: KeyModifiers = KeyModifiers::SHIFT;
    const CTRL: KeyModifiers = KeyModifiers::CONTROL;

    #[test]
    fn no_key_is_bound_twice_and_names_read_back() {
        let keymap = Keymap::default();
        for (at, (chord, _)) in keymap.0.iter().enumerate() {
            assert!(keymap.0[..at].iter().all(|(other, _)| other != chord), "{chord}");
            assert_eq!(chord.to_string().parse(), Ok(*chord));
        }
        for (name, _) in NAMED {
            assert_eq!(name.parse::<Chord>().unwrap().to_string(), name);
        }
    }

    #[test]
    fn keys_do_what_the_table_says() {
        let keymap = Keymap::default();
        let does = |code, modifiers| keymap.action(KeyEvent::new(code, modifiers));
        assert_eq!(does(Char('q'), NONE), Some(Action::Quit));
        assert_eq!(does(Char('c'), CTRL), Some(Action::Quit));
        assert_eq!(does(Char('c'), NONE), Some(Action::Copy(false)));
        assert_eq!(does(Char('v'), NONE), Some(Action::Stay));
        assert_eq!(does(Char('v'), CTRL), None);
        assert_eq!(does(KeyCode::BackTab, SHIFT), Some(Action::Choose("-1".into())));
        assert_eq!(does(Char('R'), SHIFT), Some(Action::Edit(Edit::Restart)));
        assert_eq!(does(Char('r'), CTRL), Some(Action::Edit(Edit::Redo)));
        assert_eq!(does(Right, SHIFT), Some(Action::NudgeSelected(10.0)));
        assert_eq!(does(Left, CTRL), Some(Action::NudgeSelected(-0.1)));
        assert_eq!(does(Char('s'), NONE), Some(Action::Command("save ".into())));
        assert_eq!(does(Char('3'), NONE), Some(Action::Layout("3".into())));
    }

    #[test]
    fn keys_can_be_bound_anew() {
        let mut keymap = Keymap::default();
        keymap.bind("x", "speed 3").unwrap();
        keymap.bind("u", "").unwrap();
        keymap.bind("f5", "undo").unwrap();
        let does = |code| keymap.action(KeyEvent::new(code, NONE));
        assert!(matches!(does(Char('x')), Some(Action::SetTyped(_))));
        assert_eq!((does(Char('u')), does(KeyCode::F(5))), (None, Some(Action::Edit(Edit::Undo))));
        assert_eq!(keymap.own().collect::<Vec<_>>(), [("x".to_owned(), "speed 3")]);
        for (key, command, complaint) in [
            ("q", "undo", "'q': expected another key: this one always quits"),
            ("ctrl-c", "", "'ctrl-c': expected another key: this one always quits"),
            ("nokey", "undo", "'nokey': expected a key such as x, X, ctrl-x, alt-x, shift-left, f5, space or enter"),
            ("shift-x", "undo", "'shift-x': expected the capital instead of shift"),
            ("y", "fly", "no command 'fly': tab shows what there is, ? the help"),
        ] {
            assert_eq!(keymap.bind(key, command), Err(complaint.to_owned()));
        }
    }
}
