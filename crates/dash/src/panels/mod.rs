//! The panels: one file each, from a [`Picture`](crate::picture::Picture) and an area to cells of the screen. A panel keeps what is its own, such as
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

use crate::picture::Picture;
use crate::theme;
use panel::Intent;

/// Draws a frame with a title and returns the area inside it.
fn framed(title: Line<'_>, area: Rect, buffer: &mut Buffer) -> Rect {
    let block = Block::bordered().border_style(theme::quiet()).title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes `text` from `(x, y)` on, no further than `area`.
fn write(buffer: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) {
    if y >= area.top() && y < area.bottom() && x >= area.left() && x < area.right() {
        buffer.set_stringn(x, y, text, usize::from(area.right() - x), style);
    }
}

/// Writes `text` so that it ends at the right edge of `area`.
fn write_right(buffer: &mut Buffer, area: Rect, y: u16, text: &str, style: Style) {
    let width = text.chars().count() as u16;
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
