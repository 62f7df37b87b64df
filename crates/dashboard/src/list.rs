//! Long lists: what of them the filter lets through, and which part of that is in view.

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};

use crate::drawing::write_right;
use crate::theme;

/// Where a list stands: so many rows from where it would by itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct List {
    offset: isize,
}

impl List {
    /// Moves the list on by so many rows.
    pub(crate) fn scroll(&mut self, rows: isize) {
        self.offset = self.offset.saturating_add(rows);
    }

    /// The rows in view of `count` where there is room for `height`; `first` is where the list would begin by itself. It is
    /// never scrolled further than to its ends.
    pub(crate) fn rows(&mut self, count: usize, height: u16, first: usize) -> Range<usize> {
        let height = usize::from(height);
        let last = count.saturating_sub(height);
        let from = first.min(last).saturating_add_signed(self.offset).min(last);
        self.offset = from as isize - first.min(last) as isize;
        from..(from + height).min(count)
    }
}

/// Which row inside the frame around `area` a position is in, the first one 0.
pub(crate) fn row_of(area: Rect, at: Position) -> Option<usize> {
    let inner = area.inner(Margin::new(1, 1));
    inner.contains(at).then(|| usize::from(at.y - inner.y))
}

/// Whether a row is shown under a filter: all words of it are in the row, in any order and case.
pub(crate) fn passes(filter: &str, row: &str) -> bool {
    if filter.is_empty() {
        return true;
    }
    let row = row.to_lowercase();
    filter.to_lowercase().split_whitespace().all(|word| row.contains(word))
}

/// The filter as a title tells it, with how many of how many rows pass; nothing if there is none.
pub(crate) fn filter_title(filter: &str, passed: usize, of: usize) -> String {
    if filter.trim().is_empty() { String::new() } else { format!(" /{} {passed} of {of} ", filter.trim()) }
}

/// Says how much there is beyond the rows in view, on the frame around `area`, where it covers nothing.
pub(crate) fn draw_overflow(rows: &Range<usize>, count: usize, area: Rect, buffer: &mut Buffer) {
    if area.width < 4 || area.height < 2 || rows.is_empty() {
        return;
    }
    let edge = Rect { width: area.width - 1, ..area };
    if rows.start > 0 {
        write_right(buffer, edge, area.top(), &format!(" {} more ▲ ", rows.start), theme::loud(theme::CURSOR));
    }
    if rows.end < count {
        let text = format!(" {} more ▼ ", count - rows.end);
        write_right(buffer, edge, area.bottom() - 1, &text, theme::loud(theme::CURSOR));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_scrolls_no_further_than_to_its_ends() {
        let mut list = List::default();
        assert_eq!(list.rows(10, 4, 0), 0..4);
        list.scroll(3);
        assert_eq!(list.rows(10, 4, 0), 3..7);
        list.scroll(1000);
        assert_eq!(list.rows(10, 4, 0), 6..10);
        list.scroll(-1);
        assert_eq!(list.rows(10, 4, 0), 5..9, "one back is one back from the end");
        assert_eq!(list.rows(3, 4, 0), 0..3);
        list.scroll(isize::MIN);
        assert_eq!(list.rows(10, 4, 5), 0..4);
        assert_eq!(List::default().rows(10, 4, 5), 5..9);
        assert_eq!(List::default().rows(0, 0, 7), 0..0);
    }

    #[test]
    fn a_filter_is_words_in_any_order_and_case() {
        assert!(passes("", "x") && passes("kd SET", "set kd = 1") && passes(" trip ", "Tripped"));
        assert!(!passes("kd cd", "kd"));
        assert_eq!((filter_title("kd", 3, 12), filter_title(" ", 3, 12)), (" /kd 3 of 12 ".into(), String::new()));
    }
}
