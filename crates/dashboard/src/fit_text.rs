//! Text in a room that may be too small for it. A number that is cut reads as another number, so it never is: it stands whole
//! or not at all, and an ellipsis tells that something is missing. Where what is told can be told shorter, whoever tells it
//! offers the shorter ways too ([`longest`]): words go first, and numbers stay.
//!
//! Widths are those of the terminal library: a Chinese character takes two cells, an accent none.

use std::borrow::Cow;

use ratatui::text::{Line, Span};

/// What stands for all that is left out.
const ELLIPSIS: &str = "…";

/// Cells that a text takes.
pub(crate) fn width(text: &str) -> usize {
    Span::raw(text).width()
}

/// `text`, with blanks behind it up to `wide` cells.
pub(crate) fn padded(text: &str, wide: usize) -> String {
    format!("{text}{}", " ".repeat(wide.saturating_sub(width(text))))
}

/// As much of `text` as has room in so many cells, with an ellipsis for what has not.
pub(crate) fn cut(text: &str, room: usize) -> Cow<'_, str> {
    if width(text) <= room {
        return Cow::Borrowed(text);
    }
    // Blanks behind it are the first to go.
    let text = text.trim_end();
    if width(text) <= room {
        return Cow::Borrowed(text);
    }
    match kept(text, room) {
        _ if room == 0 => Cow::Borrowed(""),
        kept => Cow::Owned(format!("{kept}{ELLIPSIS}")),
    }
}

/// The same for a line of several styles.
pub(crate) fn cut_line(line: Line<'_>, room: usize) -> Line<'_> {
    if line.width() <= room || line.width() == 0 {
        return line;
    }
    let whole: String = line.spans.iter().map(|span| &*span.content).collect();
    let mut left = if room == 0 { 0 } else { kept(&whole, room).len() };
    let mut spans = Vec::new();
    for span in &line.spans {
        let take = span.content.len().min(left);
        left -= take;
        if take < span.content.len() {
            let content = span.content.get(..take).unwrap_or_default();
            let ellipsis = if room == 0 { "" } else { ELLIPSIS };
            spans.push(Span::styled(format!("{content}{ellipsis}"), span.style));
            break;
        }
        spans.push(Span::styled(span.content.to_string(), span.style));
    }
    Line { spans, style: line.style, alignment: line.alignment }
}

/// The first of these that has room, from the longest to the shortest; the shortest is cut if need be.
pub(crate) fn longest(ways: &[&str], room: usize) -> String {
    let fits = ways.iter().find(|way| width(way) <= room);
    fits.map_or_else(|| cut(ways.last().unwrap_or(&""), room).into_owned(), |way| (*way).to_owned())
}

/// What has room beside an ellipsis, without a word of digits that would be cut, and without blanks at its end.
fn kept(text: &str, room: usize) -> &str {
    let mut end = 0;
    for (at, letter) in text.char_indices() {
        let next = at + letter.len_utf8();
        if width(&text[..next]) + 1 > room {
            break;
        }
        end = next;
    }
    let begin = text[..end].trim_end_matches(|letter: char| !letter.is_whitespace()).len();
    let word = text[begin..].split(char::is_whitespace).next().unwrap_or_default();
    let is_whole = begin + word.len() <= end;
    if !is_whole && word.contains(|letter: char| letter.is_ascii_digit()) {
        end = begin;
    }
    text[..end].trim_end()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn a_number_stands_whole_or_not_at_all_and_other_text_ends_with_an_ellipsis() {
        for (text, room, told) in [
            ("stable 0 to 7.074", 17, "stable 0 to 7.074"),
            ("stable 0 to 7.074", 16, "stable 0 to…"),
            ("stable 0 to 7.074", 9, "stable 0…"),
            ("stable 0 to 7.074", 4, "sta…"),
            ("7.074", 4, "…"),
            ("7.074", 0, ""),
            ("since revision 12", 16, "since revision…"),
            ("漢字漢字", 5, "漢字…"),
            ("漢字漢字", 4, "漢…"),
        ] {
            assert_eq!(cut(text, room), told, "{text} in {room}");
            let line = Line::from(vec![
                Span::raw(&text[..3.min(text.len())]),
                Span::styled(&text[3.min(text.len())..], Style::new()),
            ]);
            assert_eq!(cut_line(line, room).to_string(), told, "{text} in {room}, of two styles");
        }
    }

    #[test]
    fn words_go_before_numbers() {
        let ways = ["damping over speed  stable 0 to 7.074", "stable 0 to 7.074", "0 to 7.074"];
        assert_eq!(longest(&ways, 60), ways[0]);
        assert_eq!(longest(&ways, 36), ways[1]);
        assert_eq!(longest(&ways, 12), ways[2]);
        assert_eq!(longest(&ways, 9), "0 to…");
        assert_eq!(longest(&[], 9), "");
    }

    proptest! {
        #[test]
        fn what_is_cut_has_room_and_every_number_in_it_is_one_of_the_text(text in "[a-z0-9.漢 -]{0,40}", room in 0_usize..50) {
            let told = cut(&text, room);
            prop_assert!(width(&told) <= room, "{told}");
            let whole: Vec<&str> = text.split_whitespace().collect();
            for word in told.split_whitespace().map(|word| word.trim_end_matches('…')) {
                prop_assert!(!word.contains(|c: char| c.is_ascii_digit()) || whole.contains(&word), "{word} of {text}");
            }
        }
    }
}
