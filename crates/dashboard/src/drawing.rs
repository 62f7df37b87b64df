//! Text and frames on the screen, within an area: what has no room is left out as [`crate::fit_text`] has it.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;
use ratatui::widgets::{Block, Widget};

use crate::fit_text::{cut, cut_line, width};
use crate::theme;

/// Draws a frame with a title and returns the area inside it.
pub(crate) fn framed(title: Line<'_>, area: Rect, buffer: &mut Buffer) -> Rect {
    let title = cut_line(title, usize::from(area.width.saturating_sub(2)));
    #[cfg(test)]
    tests::note(area.y, &title.to_string());
    let block = Block::bordered().border_style(theme::quiet()).title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes `text` from `(x, y)` on, no further than `area`, and returns the column behind it. What has no room is left out as
/// [`crate::fit_text`] has it.
pub(crate) fn write(buffer: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) -> u16 {
    if y >= area.top() && y < area.bottom() && x >= area.left() && x < area.right() {
        let room = usize::from(area.right() - x);
        #[cfg(test)]
        tests::note(y, text);
        return buffer.set_stringn(x, y, cut(text, room), room, style).0;
    }
    x
}

/// Writes a line of several styles over all of `area`, cut like any other text.
pub(crate) fn write_line(buffer: &mut Buffer, area: Rect, line: Line<'_>) {
    #[cfg(test)]
    tests::note(area.y, &line.to_string());
    cut_line(line, usize::from(area.width)).render(area, buffer);
}

/// Whether in the row of a text that is `wide`, and beside it, stands only what `may` be there.
fn is_clear(buffer: &Buffer, area: Rect, [x, y]: [u16; 2], wide: u16, may: impl Fn(&str) -> bool) -> bool {
    let end = x.saturating_add(wide).saturating_add(1).min(area.right());
    let mut cells = (x.saturating_sub(1).max(area.left())..end).map(|x| (x, y));
    cells.all(|at| buffer.cell(at).is_some_and(|cell| may(cell.symbol())))
}

/// Writes `text` whole where nothing but a plot's lines is in its way and beside it; else not at all.
pub(crate) fn write_free(buffer: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) {
    let wide = width(text) as u16;
    let is_line = |symbol: &str| symbol.chars().all(|glyph| matches!(glyph, ' ' | '\u{2800}'..='\u{28ff}'));
    if x.saturating_add(wide) <= area.right() && is_clear(buffer, area, [x, y], wide, is_line) {
        write(buffer, area, x, y, text, style);
    }
}

/// Writes `text` in the uppermost row of a plot where nothing at all is in its way or beside it, at the right edge or else at the left one;
/// nowhere if there is no such row.
pub(crate) fn write_beside_lines(buffer: &mut Buffer, area: Rect, text: &str, style: Style) {
    let wide = width(text) as u16;
    let Some(right) = area.right().checked_sub(wide).filter(|x| *x >= area.left()) else { return };
    let mut places = (area.top()..area.bottom()).flat_map(|y| [[right, y], [area.left(), y]]);
    let is_blank = |symbol: &str| matches!(symbol, " " | "\u{2800}");
    if let Some([x, y]) = places.find(|place| is_clear(buffer, area, *place, wide, is_blank)) {
        write(buffer, area, x, y, text, style);
    }
}

/// Writes `text` so that it ends at the right edge of `area`.
pub(crate) fn write_right(buffer: &mut Buffer, area: Rect, y: u16, text: &str, style: Style) {
    let width = width(text) as u16;
    write(buffer, area, area.right().saturating_sub(width).max(area.left()), y, text, style);
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::screenshot::image::text;

    thread_local! {
        /// Everything that was written since this was last emptied, with its row, before any of it was cut.
        static WRITTEN: std::cell::RefCell<Vec<(u16, String)>> = const { std::cell::RefCell::new(Vec::new()) };
    }

    /// Keeps what is written for [`written`].
    pub(crate) fn note(y: u16, text: &str) {
        WRITTEN.with_borrow_mut(|written| written.push((y, text.to_owned())));
    }

    /// What was written since this was last asked.
    pub(crate) fn written() -> Vec<(u16, String)> {
        WRITTEN.take()
    }

    /// What a panel draws, as lines of text. Every panel is also drawn at every small size, and must not panic.
    pub(crate) fn drawn(width: u16, height: u16, draw: impl Fn(Rect, &mut Buffer)) -> String {
        for (w, h) in (0..12).flat_map(|w| (0..8).map(move |h| (w, h))).chain([(80, 1), (1, 80), (80, 24), (200, 60)]) {
            let area = Rect::new(0, 0, w, h);
            draw(area, &mut Buffer::empty(area));
        }
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        draw(area, &mut buffer);
        text(&buffer)
    }
}
