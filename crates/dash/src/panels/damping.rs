//! The smallest damping ratio, large, with what it has been.
//!
//! ```text
//! ┌ minimum damping ────────────────┐
//! │ ▛▀▌   ▛▀▌ ▐▖▐ ▐▖▐ ▛▀▘  stable   │
//! │ ▌ ▌   ▌ ▌ ▀▀▜ ▀▀▜ ▀▀▖  log dec  │
//! │ ▙▄▌ ▖ ▙▄▌   ▐   ▐ ▄▄▘  0.2805   │
//! │ ⠤⠤⠤⠤⠤⠤⠤⠤⣀⣀⣀⣀⣀⣀⣀⣀⠤⠤⠤⠤⠤⠤⠤ 0.05 │
//! │ ⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒ 0    │   the line of zero is the limit of stability
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line;
use ratatui::widgets::Widget;
use tui_big_text::{BigText, PixelSize};

use super::{framed, write, write_right};
use crate::feed::Picture;
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::theme;

/// Values a second.
const PER_SECOND: usize = 10;
/// Values that the history shows, about: a minute.
const WINDOW: usize = 60 * PER_SECOND;
/// Height of the large digits, and width of each, in cells.
const DIGITS: (u16, u16) = (4, 4);

pub(crate) fn draw(picture: &Picture, area: Rect, buffer: &mut Buffer) {
    let inner = framed(Line::from(" minimum damping "), area, buffer);
    let Some((min_damping, poles)) = picture.poles() else { return };
    let (color, word) = theme::verdict(min_damping);
    let number = format!("{min_damping:.4}");
    let width = number.len() as u16 * DIGITS.1;
    // The word stands beside the digits, or on a line of its own below them.
    let beside = inner.left() + width + 1;
    let fits_beside = beside + word.len() as u16 <= inner.right();
    let height = DIGITS.0 + u16::from(!fits_beside);
    let large = inner.width >= width && inner.height > height;
    let [head, history] =
        Layout::vertical([Constraint::Length(if large { height } else { 1 }), Constraint::Min(0)]).areas(inner);
    let log_decrement =
        poles.first().map(|pole| std::f64::consts::TAU * -pole.re / pole.im.abs()).filter(|d| d.is_finite());
    let told = log_decrement.map(|d| short(d, 5));
    if large {
        BigText::builder()
            .pixel_size(PixelSize::Quadrant)
            .style(theme::loud(color))
            .lines([Line::from(number)])
            .build()
            .render(Rect { width, ..head }, buffer);
        if fits_beside {
            write(buffer, head, beside, head.top(), word, theme::loud(color));
            if let Some(log_decrement) = told {
                write(buffer, head, beside, head.top() + 1, "log dec", theme::quiet());
                write(buffer, head, beside, head.top() + 2, &log_decrement, theme::quiet());
            }
        } else {
            write(buffer, head, head.left(), head.bottom() - 1, word, theme::loud(color));
        }
    } else {
        write(buffer, head, head.left(), head.top(), &format!("{number} {word}"), theme::loud(color));
    }
    draw_history(&picture.damping, history, buffer);
}

fn draw_history(damping: &[f64], area: Rect, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    // The newest at the right edge; a column of dots shows the least of its values, so that no dip is lost.
    let columns = usize::from(area.width) * 2;
    let per_column = WINDOW.div_ceil(columns);
    let shown: Vec<f64> = damping
        .rchunks(per_column)
        .take(columns)
        .map(|values| values.iter().copied().fold(f64::INFINITY, f64::min))
        .collect();
    let shown: Vec<f64> = shown.into_iter().rev().collect();
    let top = nice_ceiling(shown.iter().copied().fold(0.0, f64::max) * 1.05);
    let bottom = shown.iter().copied().fold(0.0, f64::min);
    let bottom = if bottom < 0.0 { -nice_ceiling(-bottom * 1.05) } else { -0.15 * top };
    let mut plot = Plot::new(area, Window { x: [0.0, columns as f64], y: [bottom, top] });
    plot.line([0.0, 0.0], [columns as f64, 0.0], theme::GRID);
    let offset = (columns - shown.len()) as f64 + 0.5;
    for (at, pair) in shown.windows(2).enumerate() {
        let x = offset + at as f64;
        let color = theme::verdict(pair[1]).0;
        plot.line([x, pair[0]], [x + 1.0, pair[1]], color);
    }
    plot.paint(buffer);
    write(buffer, area, area.left(), area.top(), &short(top, 3), theme::quiet());
    if bottom < -0.2 * top {
        write(buffer, area, area.left(), area.bottom() - 1, &short(bottom, 3), theme::quiet());
    }
    let seconds = columns * per_column / PER_SECOND;
    if area.height > 2 {
        write_right(buffer, area, area.bottom() - 1, &format!("{seconds} s"), theme::quiet());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;
    use crate::panels::tests::drawn;

    #[test]
    fn a_stable_rotor_shows_its_damping_large() {
        let mut picture = tests::picture();
        picture.damping = (0..100).map(|i| if i < 50 { 0.03 } else { 0.05 }).collect();
        insta::assert_snapshot!("damping", drawn(44, 12, |area, buffer| draw(&picture, area, buffer)));
    }

    #[test]
    fn an_unstable_rotor_says_so_in_words() {
        let mut picture = tests::picture();
        picture.bulletin = Some(std::sync::Arc::from(tests::bulletin("three-mass", "off")));
        picture.damping = vec![0.05, -0.0306];
        for (width, height) in [(44, 12), (26, 7), (20, 3)] {
            let frame = drawn(width, height, |area, buffer| draw(&picture, area, buffer));
            assert!(frame.contains("UNSTABLE"), "{frame}");
        }
        let small = drawn(20, 3, |area, buffer| draw(&picture, area, buffer));
        assert!(small.contains("-0.0306"), "{small}");
    }
}
