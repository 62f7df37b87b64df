//! What lies on top of the panels: a stack of layers, the topmost of which gets the keys.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use rotor::Settings;

use crate::clerk::Edit;

/// The longest text that can be typed, in bytes: more than any command needs, less than a note may have.
const LONGEST: usize = 160;
/// The longest value.
const LONGEST_VALUE: usize = 16;

/// One layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layer {
    /// The help, from this line on.
    Help(usize),
    /// A value is being typed for the selected setting.
    Value(String),
    /// A command is being typed.
    Command(String),
    /// What the lists shall show is being typed.
    Filter(String),
    /// A change that would harm waits for a yes: the settings that it leads to, and how it would harm.
    Ask(Edit, Box<Settings>, String),
    /// A change is offered, and why.
    Offer(Edit, String),
}

/// What a key did to a text that is being typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Typed {
    /// It is part of it, or means nothing here.
    Taken,
    /// The text is complete.
    Done,
    /// It is given up.
    Dropped,
    /// Whatever can follow is asked for.
    Complete,
    /// It is no key for a text.
    Else,
}

/// A key for a command or another text.
pub(crate) fn type_text(text: &mut String, key: KeyEvent) -> Typed {
    let held = key.modifiers & (KeyModifiers::CONTROL | KeyModifiers::ALT);
    match (key.code, held) {
        (KeyCode::Char('u'), KeyModifiers::CONTROL) => text.clear(),
        (KeyCode::Char('w'), KeyModifiers::CONTROL) => {
            let kept = text.trim_end().rfind(' ').map_or(0, |at| at + 1);
            text.truncate(kept);
        }
        (KeyCode::Char(letter), KeyModifiers::NONE) => {
            if !letter.is_control() && text.len() + letter.len_utf8() <= LONGEST {
                text.push(letter);
            }
        }
        // Nothing left to take away: leave.
        (KeyCode::Backspace, _) => {
            if text.pop().is_none() {
                return Typed::Dropped;
            }
        }
        (KeyCode::Esc, _) => return Typed::Dropped,
        (KeyCode::Enter, _) => return Typed::Done,
        (KeyCode::Tab, _) => return Typed::Complete,
        _ => return Typed::Else,
    }
    Typed::Taken
}

/// A key for a number.
pub(crate) fn type_number(text: &mut String, key: KeyEvent) -> Typed {
    let plain = !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT);
    match key.code {
        KeyCode::Char(c @ ('0'..='9' | '.' | '-' | '+' | 'e' | 'E')) if plain => {
            if text.len() < LONGEST_VALUE {
                text.push(c);
            }
        }
        KeyCode::Backspace => {
            text.pop();
        }
        KeyCode::Esc => return Typed::Dropped,
        KeyCode::Enter => return Typed::Done,
        _ => return Typed::Else,
    }
    Typed::Taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_typed_mended_and_bounded() {
        let mut text = String::new();
        let mut press = |code, held| type_text(&mut text, KeyEvent::new(code, held));
        for letter in "note a ü q".chars() {
            assert_eq!(press(KeyCode::Char(letter), KeyModifiers::NONE), Typed::Taken);
        }
        press(KeyCode::Char('w'), KeyModifiers::CONTROL);
        press(KeyCode::Backspace, KeyModifiers::NONE);
        assert_eq!(press(KeyCode::Char('c'), KeyModifiers::CONTROL), Typed::Else);
        assert_eq!(press(KeyCode::Tab, KeyModifiers::NONE), Typed::Complete);
        for _ in 0..1000 {
            press(KeyCode::Char('ü'), KeyModifiers::NONE);
        }
        assert!(text.starts_with("note a ü") && text.len() <= LONGEST);
        type_text(&mut text, KeyEvent::new(KeyCode::Char('u'), KeyModifiers::CONTROL));
        assert_eq!(type_text(&mut text, KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE)), Typed::Dropped);
    }
}
