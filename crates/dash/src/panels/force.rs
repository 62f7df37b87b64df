//! The control force: now, and the most since the settings last changed.
//!
//! ```text
//! ┌ control force  m_b w0² e_t ─────┐
//! │ now  1.423  ████████████░░░░░░░ │
//! │ max  2.655  since revision 3    │
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{framed, write};
use crate::plot::short;
use crate::screen::View;
use crate::theme;

/// Width of a label and its number.
const HEAD: u16 = 13;

pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let inner = framed(Line::from(" control force  m_b w0² e_t "), area, buffer);
    let Some(at) = picture.now else { return };
    let [y, z] = picture.track.force(at);
    let (now, peak) = (y.hypot(z), picture.peak_force);
    write(buffer, inner, inner.left(), inner.top(), &format!("now {:>8}", short(now, 5)), theme::loud(theme::FORCE));
    if inner.width > HEAD {
        let cells = inner.width - HEAD;
        let full =
            if peak > 0.0 { (now / peak * f64::from(cells)).round().clamp(0.0, f64::from(cells)) as usize } else { 0 };
        let bar = "█".repeat(full) + &"░".repeat(usize::from(cells) - full);
        write(buffer, inner, inner.left() + HEAD, inner.top(), &bar, theme::loud(theme::FORCE));
    }
    write(
        buffer,
        inner,
        inner.left(),
        inner.top() + 1,
        &format!("max {:>8}", short(peak, 5)),
        theme::loud(theme::FORCE),
    );
    let since = picture.era.as_ref().map_or_else(String::new, |era| format!("since revision {}", era.revision));
    write(buffer, inner, inner.left() + HEAD, inner.top() + 1, &since, theme::quiet());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;
    use crate::panels::tests::drawn;
    use crate::screen::tests::view;

    #[test]
    fn shows_the_force_now_and_at_most() {
        let picture = tests::picture();
        let frame = drawn(40, 4, |area, buffer| draw(&view(&picture), area, buffer));
        assert!(frame.contains("now   0.8000") && frame.contains("max   0.8000"), "{frame}");
        assert!(frame.contains("since revision 1"), "{frame}");
    }
}
