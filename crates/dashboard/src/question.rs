//! A question at the foot: what it is about, in parts that go whole where there is no room for all, and the keys that answer it, which
//! never do.
//!
//! ```text
//!  found over R 0..2.8: min damping 0.0925 at R 2.8 (proven)  y applies it, any other key forgets it
//!  found: min damping 0.0925  y applies it
//! ```

use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};

use crate::fit_text::{cut, width};
use crate::theme;

/// What is said of any other key than `y`, where there is room.
const ELSE: &str = ", any other key forgets it";

/// What is asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Question(Vec<(u8, String)>);

impl Question {
    /// Of parts, each with how soon it goes: those with the largest number go first, those of 0 never do. They stand behind each other as
    /// they are.
    pub(crate) fn of(parts: impl IntoIterator<Item = (u8, String)>) -> Self {
        Self(parts.into_iter().collect())
    }

    /// All of it.
    pub(crate) fn whole(&self) -> String {
        self.0.iter().map(|(_, part)| part.as_str()).collect()
    }

    /// As much of it as has room: parts go whole; what is left then is cut as a last resort.
    fn within(&self, room: usize) -> String {
        let mut parts = self.clone();
        while width(&parts.whole()) > room {
            let soonest = parts.0.iter().map(|(soon, _)| *soon).max().filter(|soon| *soon > 0);
            let Some(at) = soonest.and_then(|soonest| parts.0.iter().rposition(|(soon, _)| *soon == soonest)) else {
                break;
            };
            parts.0.remove(at);
        }
        cut(&parts.whole(), room).into_owned()
    }

    /// The line at the foot; `does` is what `y` does.
    pub(crate) fn line(&self, color: Color, does: &str, room: usize) -> Line<'static> {
        const KEY: &str = " y ";
        // The blanks of the badge, the key, and what it does.
        let needed = 2 + KEY.len() + width(does);
        let all = needed + width(&self.whole()) + width(ELSE) <= room;
        let told = if all { self.whole() } else { self.within(room.saturating_sub(needed)) };
        Line::from(vec![
            Span::styled(format!(" {told} "), theme::badge(color)),
            Span::styled(KEY, Style::new().bold()),
            Span::styled(if all { format!("{does}{ELSE}") } else { does.to_owned() }, theme::quiet()),
        ])
    }
}

impl From<String> for Question {
    fn from(all: String) -> Self {
        Self::of([(0, all)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_stands_at_any_width_and_what_is_needed_least_goes_first_and_whole() {
        let parts =
            [(0, "found"), (5, " over R 0..2.8"), (0, ": min damping 0.0925"), (7, " (proven)"), (3, ", MORE force")];
        let question = Question::of(parts.map(|(soon, part)| (soon, part.to_owned())));
        let line = |room| question.line(theme::CANDIDATE, "applies it", room).to_string();
        assert_eq!(
            line(120),
            " found over R 0..2.8: min damping 0.0925 (proven), MORE force  y applies it, any other key forgets it"
        );
        for (room, told) in [
            (80, "found over R 0..2.8: min damping 0.0925 (proven), MORE force"),
            (70, "found over R 0..2.8: min damping 0.0925, MORE force"),
            (60, "found: min damping 0.0925, MORE force"),
            (50, "found: min damping 0.0925"),
            (36, "found: min damping…"),
        ] {
            assert_eq!(line(room), format!(" {told}  y applies it"), "{room}");
        }
        for room in 15..140 {
            assert!(line(room).contains(" y applies it") && width(&line(room)) <= room, "{room}: {}", line(room));
        }
    }
}
