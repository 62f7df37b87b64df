//! A line that is being typed: a command, a value, what lists shall show. All are edited alike, with the keys of a shell.

use std::fmt;

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};
use ratatui::style::{Modifier, Style};
use ratatui::text::Span;
use tui_input::backend::crossterm::to_input_request;
use tui_input::{Input, InputRequest};

/// The longest text that can be typed, in bytes: more than any command needs, less than a note may have.
const LONGEST: usize = 160;
/// The longest value.
const LONGEST_VALUE: usize = 16;

/// What a key did to a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineEvent {
    /// It is part of it, or means nothing here.
    Taken,
    /// The line is complete.
    Done,
    /// It is given up.
    Dropped,
    /// Whatever can follow is asked for.
    Complete,
    /// An earlier line is asked for (-1), or a later one (1).
    Earlier(isize),
    /// It is no key for a line.
    Else,
}

/// A line with a cursor in it.
#[derive(Clone, Default)]
pub(crate) struct LineEditor(Input);

impl LineEditor {
    /// What has been typed.
    pub(crate) fn text(&self) -> &str {
        self.0.value()
    }

    /// A key for a text.
    pub(crate) fn press(&mut self, key: KeyEvent) -> LineEvent {
        // Nothing left to take away: leave.
        if key.code == KeyCode::Backspace && self.text().is_empty() {
            return LineEvent::Dropped;
        }
        self.edit(key, LONGEST, |letter| !letter.is_control())
    }

    /// A key for a number.
    pub(crate) fn press_number(&mut self, key: KeyEvent) -> LineEvent {
        self.edit(key, LONGEST_VALUE, |letter| matches!(letter, '0'..='9' | '.' | '-' | '+' | 'e' | 'E'))
    }

    fn edit(&mut self, key: KeyEvent, longest: usize, fits: impl Fn(char) -> bool) -> LineEvent {
        match key.code {
            KeyCode::Esc => return LineEvent::Dropped,
            KeyCode::Enter => return LineEvent::Done,
            KeyCode::Tab => return LineEvent::Complete,
            KeyCode::Up => return LineEvent::Earlier(-1),
            KeyCode::Down => return LineEvent::Earlier(1),
            _ => {}
        }
        let Some(request) = to_input_request(&Event::Key(key)) else { return LineEvent::Else };
        if let InputRequest::InsertChar(letter) = request {
            if !fits(letter) {
                return LineEvent::Else;
            }
            if self.text().len() + letter.len_utf8() > longest {
                return LineEvent::Taken;
            }
        }
        let before = self.0.clone();
        self.0.handle(request);
        if self.text().len() > longest || !self.text().chars().all(fits) {
            // What was cut elsewhere does not fit here.
            self.0 = before;
        }
        LineEvent::Taken
    }

    /// The line as it is shown: what is under the cursor is turned over, and a bar stands for the end.
    pub(crate) fn spans(&self, style: Style) -> Vec<Span<'static>> {
        let at = self.text().char_indices().nth(self.0.cursor()).map_or(self.text().len(), |(at, _)| at);
        let (before, rest) = self.text().split_at(at);
        let mut letters = rest.chars();
        let mut spans = vec![Span::styled(before.to_owned(), style)];
        match letters.next() {
            None => spans.push(Span::styled("_", style)),
            Some(letter) => {
                let turned = if style.add_modifier.contains(Modifier::REVERSED) {
                    style.remove_modifier(Modifier::REVERSED)
                } else {
                    style.add_modifier(Modifier::REVERSED)
                };
                spans.push(Span::styled(letter.to_string(), turned));
                spans.push(Span::styled(letters.as_str().to_owned(), style));
            }
        }
        spans
    }
}

impl From<&str> for LineEditor {
    /// The line with the cursor at its end.
    fn from(text: &str) -> Self {
        Self(Input::from(text))
    }
}

impl PartialEq for LineEditor {
    fn eq(&self, other: &Self) -> bool {
        (self.text(), self.0.cursor()) == (other.text(), other.0.cursor())
    }
}

impl fmt::Debug for LineEditor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} at {}", self.text(), self.0.cursor())
    }
}

/// Whether a key types a letter.
pub(crate) fn is_letter(key: KeyEvent) -> bool {
    matches!(key.code, KeyCode::Char(_)) && key.modifiers.difference(KeyModifiers::SHIFT).is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use KeyCode::{Backspace, Char, Delete, Down, End, Home, Left, Right, Up};

    const NONE: KeyModifiers = KeyModifiers::NONE;
    const CTRL: KeyModifiers = KeyModifiers::CONTROL;

    fn typed(text: &str, keys: &[(KeyCode, KeyModifiers)]) -> LineEditor {
        let mut line = LineEditor::from(text);
        for (code, held) in keys {
            line.press(KeyEvent::new(*code, *held));
        }
        line
    }

    #[test]
    fn lines_are_edited_with_the_keys_of_a_shell() {
        for (keys, wanted) in [
            (&[(Char('c'), NONE)][..], "note a ü bc"),
            (&[(Left, NONE), (Char('x'), NONE)], "note a ü xb"),
            (&[(Home, NONE), (Delete, NONE), (Right, NONE), (Char('x'), NONE)], "oxte a ü b"),
            (&[(Char('a'), CTRL), (Char('x'), NONE), (Char('e'), CTRL), (Char('y'), NONE)], "xnote a ü by"),
            (&[(Char('w'), CTRL), (Char('w'), CTRL)], "note a "),
            (&[(Left, CTRL), (Left, CTRL), (Char('k'), CTRL)], "note a "),
            (&[(Char('u'), CTRL), (Char('x'), NONE), (End, NONE)], "x"),
            (&[(Left, NONE), (Left, NONE), (Backspace, NONE)], "note a  b"),
        ] {
            assert_eq!(typed("note a ü b", keys).text(), wanted, "{keys:?}");
        }
    }

    #[test]
    fn other_keys_are_told_and_length_is_bounded() {
        let mut line = LineEditor::default();
        let mut press = |code, held| line.press(KeyEvent::new(code, held));
        assert_eq!((press(Up, NONE), press(Down, NONE)), (LineEvent::Earlier(-1), LineEvent::Earlier(1)));
        assert_eq!((press(KeyCode::Tab, NONE), press(Char('c'), CTRL)), (LineEvent::Complete, LineEvent::Else));
        assert_eq!(press(Backspace, NONE), LineEvent::Dropped);
        for _ in 0..1000 {
            press(Char('ü'), NONE);
        }
        assert_eq!(press(Char('u'), CTRL), LineEvent::Taken);
        // What was cut comes back, no more often than there is room for.
        for _ in 0..10 {
            press(Char('y'), CTRL);
        }
        assert_eq!(line.text().len(), LONGEST);
    }

    #[test]
    fn a_number_takes_nothing_else() {
        let mut line = LineEditor::default();
        for letter in "3x.5 q1e-99999999999999".chars() {
            line.press_number(KeyEvent::new(Char(letter), NONE));
        }
        assert_eq!(line.text(), "3.51e-9999999999");
        assert_eq!(line.press_number(KeyEvent::new(Char('q'), NONE)), LineEvent::Else);
    }

    #[test]
    fn the_cursor_is_seen_without_colours() {
        let shown = |line: &LineEditor| {
            line.spans(Style::new()).iter().map(|span| span.content.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(shown(&LineEditor::from("abc")), ["abc", "_"]);
        let inside = typed("abc", &[(Left, NONE)]);
        assert_eq!(shown(&inside), ["ab", "c", ""]);
        let reversed = |style| inside.spans(style)[1].style.add_modifier.contains(Modifier::REVERSED);
        assert!(reversed(Style::new()) && !reversed(Style::new().reversed()));
    }
}
