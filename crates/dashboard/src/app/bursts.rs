//! What comes in at once: keys that a person presses, or text that was pasted into a terminal that does not say so.

use std::collections::BTreeSet;

use crossterm::event::{KeyCode, KeyModifiers};

use super::App;
use crate::input::Input;
use crate::view::Message;

/// So many keys at once, of several kinds, come from no hand.
const BURST: usize = 8;
/// What is said of them.
pub(super) const TOO_FAST: &str = "keys that came all at once did nothing: `:` takes them as a command";
/// What is said of several lines at once.
pub(super) const LINES: &str = "of lines that came all at once the first waits for enter, the others did nothing";

impl App<'_> {
    /// Takes what has come in at once. Letters that no hand types so fast (text that was pasted into a terminal that does not say so) do
    /// nothing where they would act as keys or answer a question; a key that is held down, and a line that begins as a command, do. Of
    /// several lines the first waits for enter.
    pub(super) fn take_all(&mut self, inputs: Vec<Input>) {
        let letter = |input: &Input| match input {
            Input::Key(key) => match key.code {
                KeyCode::Char(letter) if !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) => {
                    Some(letter)
                }
                KeyCode::Enter => Some('\n'),
                _ => None,
            },
            _ => None,
        };
        let letters: Vec<char> = inputs.iter().filter_map(letter).collect();
        let kinds: BTreeSet<char> = letters.iter().copied().collect();
        let is_burst = letters.len() >= BURST && kinds.len() >= BURST / 2;
        let begins_a_line = match self.layers.last() {
            Some(layer) => !layer.is_question(),
            None => letters.first().is_some_and(|first| [':', '/'].contains(first)),
        };
        // A program that types sends a line with its end; what goes on behind that was pasted.
        let end = letters.iter().position(|letter| *letter == '\n');
        let goes_on = end.is_some_and(|end| letters[end + 1..].iter().any(|letter| !letter.is_whitespace()));
        let (kept, told) = match (is_burst, begins_a_line) {
            (true, false) => (0, Some(TOO_FAST)),
            (true, true) if goes_on => (end.unwrap_or(0), Some(LINES)),
            _ => (letters.len(), None),
        };
        let mut left = kept;
        for input in inputs {
            if letter(&input).is_some() {
                if left == 0 {
                    continue;
                }
                left -= 1;
            }
            self.take(input);
        }
        if let Some(told) = told {
            self.tell(Message::Bad(told.into()));
        }
    }
}
