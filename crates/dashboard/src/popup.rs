//! What can follow the command that is being typed, or what an answer to a question would change: a list above the line at
//! the foot.
//!
//! ```text
//! ┌ tab completes ────────────────────────────────┐
//! │ good    min damping 0.0535 at R 2.5, in force  │
//! │ stiff   min damping -0.0102 UNSTABLE at R 2.5  │
//! │ … 3 more                                      │
//! └───────────────────────────────────────────────┘
//!  :load _
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::widgets::{Block, Clear, Widget};

use crate::drawing::write;
use crate::theme;
use crate::view::PopupRow;

/// Over what a command may go on with.
pub(crate) const COMPLETES: &str = " tab completes ";
/// Over what is in force and what was found.
pub(crate) const BESIDE: &str = " in force, and found ";

/// Rows at most, with the one that counts the rest.
const ROWS: usize = 12;

/// Draws them at the lower left of `body`; nothing if there are none.
pub(crate) fn draw(title: &'static str, popup: &[PopupRow], body: Rect, buffer: &mut Buffer) {
    let room = usize::from(body.height / 2).saturating_sub(2).min(ROWS);
    if popup.is_empty() || room == 0 {
        return;
    }
    let shown = if popup.len() > room { room - 1 } else { popup.len() };
    let wide = crate::fit_text::width;
    let words = popup[..shown].iter().map(|offer| wide(&offer.word)).max().unwrap_or(0);
    let details = popup[..shown].iter().map(|offer| wide(&offer.detail)).max().unwrap_or(0);
    let width = (words + details + 6).max(20).min(usize::from(body.width)) as u16;
    let height = shown as u16 + u16::from(shown < popup.len()) + 2;
    let place = Rect { y: body.bottom() - height, width, height, ..body };
    Clear.render(place, buffer);
    let block = Block::bordered().border_style(theme::quiet()).title(title);
    let inner = block.inner(place);
    block.render(place, buffer);
    for (y, offer) in (inner.y..inner.bottom()).zip(&popup[..shown]) {
        write(buffer, inner, inner.x + 1, y, &offer.word, Style::new().bold());
        write(buffer, inner, inner.x + 3 + words as u16, y, &offer.detail, theme::quiet());
    }
    if shown < popup.len() {
        let more = format!("… {} more", popup.len() - shown);
        write(buffer, inner, inner.x + 1, inner.bottom() - 1, &more, theme::quiet());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;

    fn frame(count: usize, width: u16, height: u16) -> String {
        let popup: Vec<PopupRow> =
            (0..count).map(|i| PopupRow { word: format!("gains{i}"), detail: format!("min damping 0.0{i}") }).collect();
        drawn(width, height, |area, buffer| draw(COMPLETES, &popup, area, buffer))
    }

    #[test]
    fn what_can_follow_is_listed_with_what_it_means() {
        let frame_of = frame(3, 50, 20);
        assert!(frame_of.contains("│ gains2  min damping 0.02 │"), "{frame_of}");
        insta::assert_snapshot!("popup", frame(30, 40, 20));
        insta::assert_snapshot!("popup_small", frame(30, 24, 8));
        insta::assert_snapshot!("popup_large", frame(30, 120, 40));
        assert_eq!(frame(0, 50, 20).trim(), "");
    }
}
