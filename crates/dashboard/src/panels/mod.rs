//! The panels: one file each, from a [`Picture`](telemetry::frame_data::Picture) and an area to cells of the screen. A panel keeps what is its own, such as
//! the scale of its axes; what is selected, typed or pointed at for all comes in as an argument.

pub(crate) mod alarms;
pub(crate) mod damping;
pub(crate) mod damping_over_speed;
pub(crate) mod events;
pub(crate) mod force;
pub(crate) mod force_budget;
pub(crate) mod help;
pub(crate) mod list;
pub(crate) mod modes;
pub(crate) mod offers;
pub(crate) mod orbits;
pub(crate) mod panel;
pub(crate) mod poles;
pub(crate) mod raw;
pub(crate) mod registry;
pub(crate) mod series;
pub(crate) mod settings;
pub(crate) mod spectral;
pub(crate) mod spectrum;
pub(crate) mod status;
pub(crate) mod strips;
pub(crate) mod time_line;
pub(crate) mod waterfall;

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::text::Line;
use ratatui::widgets::{Block, Widget};

use crate::fit::{cut, cut_line, width};
use crate::theme;
use panel::Intent;
use telemetry::frame_data::Picture;

/// Draws a frame with a title and returns the area inside it.
fn framed(title: Line<'_>, area: Rect, buffer: &mut Buffer) -> Rect {
    let title = cut_line(title, usize::from(area.width.saturating_sub(2)));
    #[cfg(test)]
    tests::note(area.y, &title.to_string());
    let block = Block::bordered().border_style(theme::quiet()).title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes `text` from `(x, y)` on, no further than `area`, and returns the column behind it. What has no room is left out as
/// [`crate::fit`] has it.
fn write(buffer: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) -> u16 {
    if y >= area.top() && y < area.bottom() && x >= area.left() && x < area.right() {
        let room = usize::from(area.right() - x);
        #[cfg(test)]
        tests::note(y, text);
        return buffer.set_stringn(x, y, cut(text, room), room, style).0;
    }
    x
}

/// Writes a line of several styles over all of `area`, cut like any other text.
fn write_line(buffer: &mut Buffer, area: Rect, line: Line<'_>) {
    #[cfg(test)]
    tests::note(area.y, &line.to_string());
    cut_line(line, usize::from(area.width)).render(area, buffer);
}

/// Writes `text` whole where nothing but a plot's lines is in its way and beside it; else not at all.
fn write_free(buffer: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) {
    let end = x.saturating_add(width(text) as u16);
    let is_line = |symbol: &str| symbol.chars().all(|glyph| matches!(glyph, ' ' | '\u{2800}'..='\u{28ff}'));
    let mut cells = (x.saturating_sub(1).max(area.left())..(end + 1).min(area.right())).map(|x| (x, y));
    if end <= area.right() && cells.all(|at| buffer.cell(at).is_some_and(|cell| is_line(cell.symbol()))) {
        write(buffer, area, x, y, text, style);
    }
}

/// Writes `text` so that it ends at the right edge of `area`.
fn write_right(buffer: &mut Buffer, area: Rect, y: u16, text: &str, style: Style) {
    let width = width(text) as u16;
    write(buffer, area, area.right().saturating_sub(width).max(area.left()), y, text, style);
}

/// What a click asks for where the steps `over` of the picture are drawn across `area`: to look at the one there.
fn look_at(picture: &Picture, over: &Range<usize>, area: Rect, at: Position) -> Option<Intent> {
    if over.is_empty() || !area.contains(at) {
        return None;
    }
    let along = (f64::from(at.x - area.x) + 0.5) / f64::from(area.width);
    let step = over.start + (along * over.len() as f64) as usize;
    Some(Intent::Look(picture.track.first() + step as u64))
}

/// How many times as much a plot shows after so many notches of the wheel towards us.
fn wheel_times(notches: i32) -> f64 {
    1.25_f64.powi(notches.clamp(-50, 50))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::looks::still::text;

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
