//! Poles in the complex plane.
//!
//! ```text
//! ┌ poles ──────────────────────────┐
//! │ .1   .05  ⡇ Im           ±5    │   rays of equal damping lean left from the origin
//! │  ⠑⡀    ▲ ⡇                     │   ▲ forward, Im > 0
//! │    ⠑⡀  ▲ ⡇                     │
//! │      ⠑⡀  ⡇◆  unstable          │   ◆ the least damped mode; right of the line Re = 0 it grows
//! │⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⡏⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉│
//! │     ▼    ⡇                     │   ▼ backward, Im < 0; blue lines: where poles go over speed, from 0 up
//! └ ◆ -0.1216 +2.2693j ─────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use rotor::{C64, Whirl, damping_ratio};

use super::{framed, write, write_right};
use crate::analysis::Question;
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::screen::View;
use crate::theme;

/// Damping ratios that get a ray.
const RAYS: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

/// What the right side is called.
const UNSTABLE: &str = "unstable";

pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let inner = framed(Line::from(" poles ▲forward ▼backward "), area, buffer);
    let Some((_, poles)) = view.picture.poles() else { return };
    let candidates = view.what_if.iter().flat_map(|candidate| &candidate.poles);
    let reach = |part: fn(&C64) -> f64| poles.iter().chain(candidates.clone()).map(part).fold(0.0, f64::max);
    let top = nice_ceiling(reach(|p| p.im.abs()) * 1.05);
    let left = nice_ceiling(reach(|p| -p.re) * 1.05);
    // The unstable side is always in view, wide enough to see a pole arrive.
    let furthest = reach(|p| p.re);
    let right = if furthest > 0.0 { nice_ceiling(furthest * 1.05) } else { 0.0 }.max(0.25 * left);
    let mut plot = Plot::new(inner, Window { x: [-left, right], y: [-top, top] });
    trail(view, &mut plot);

    for zeta in RAYS {
        // Along a ray Re = -zeta |lambda|.
        let slope = (1.0 - zeta * zeta).sqrt() / zeta;
        let end = left.min(top / slope);
        for side in [1.0, -1.0] {
            plot.line([0.0, 0.0], [-end, side * end * slope], theme::GRID);
        }
    }
    plot.line([-left, 0.0], [right, 0.0], theme::GRID);
    plot.line([0.0, -top], [0.0, top], theme::WARN);
    plot.paint(buffer);

    for zeta in RAYS {
        let slope = (1.0 - zeta * zeta).sqrt() / zeta;
        let end = 0.97 * left.min(top / slope);
        if let Some((x, y)) = plot.cell(-end, end * slope) {
            write(buffer, inner, x, y, &format!("{zeta}"), theme::quiet());
        }
    }
    write_right(buffer, inner, inner.top(), &format!("Im ±{}", short(top, 2)), theme::quiet());
    let scale = format!("Re {} to {}", short(-left, 2), short(right, 2));
    write_right(buffer, inner, inner.bottom().saturating_sub(1), &scale, theme::quiet());
    if let Some((x, y)) = plot.cell(0.0, 0.9 * top).map(|(x, y)| (x + 2, y.max(inner.top() + 1))) {
        // Half a word would mislead.
        if x + UNSTABLE.len() as u16 <= inner.right() {
            write(buffer, inner, x, y, UNSTABLE, theme::quiet());
        }
    }

    // The least damped last, so that it lies on top.
    for (rank, pole) in poles.iter().enumerate().rev() {
        let Some((x, y)) = plot.cell(pole.re, pole.im) else { continue };
        let whirl = if pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward };
        let (sign, color) = match whirl {
            Whirl::Forward => ("▲", theme::FORWARD),
            Whirl::Backward => ("▼", theme::BACKWARD),
        };
        let (sign, color) = match rank {
            0 => ("◆", theme::verdict(damping_ratio(*pole)).0),
            _ => (sign, color),
        };
        write(buffer, inner, x, y, sign, theme::loud(color));
    }
    for pole in view.what_if.iter().flat_map(|candidate| &candidate.poles) {
        if let Some((x, y)) = plot.cell(pole.re, pole.im) {
            write(buffer, inner, x, y, "◇", theme::loud(theme::verdict(damping_ratio(*pole)).0));
        }
    }
    if let Some(least) = poles.first() {
        // On the lower edge of the frame, where no pole is hidden by it.
        let label = format!(" ◆ {} {:+.4}j ", short(least.re, 5), least.im);
        let style = theme::loud(theme::verdict(damping_ratio(*least)).0);
        write(
            buffer,
            Rect { width: area.width.saturating_sub(2), ..area },
            area.left() + 1,
            area.bottom().saturating_sub(1),
            &label,
            style,
        );
    }
}

/// Where the poles go over speed for the gains in force, faintly. Nothing where modes cannot be told
/// apart.
fn trail(view: &View<'_>, plot: &mut Plot) {
    let Some(question) = view.picture.era.as_ref().and_then(|era| Question::of(era)) else { return };
    let Some(over_speed) = view.desk.over_speed(&question) else { return };
    for branch in &over_speed.branches {
        for pair in branch.windows(2) {
            plot.line([pair[0].re, pair[0].im], [pair[1].re, pair[1].im], theme::TRAIL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::{Feed, tests};
    use crate::panels::tests::drawn;
    use crate::screen::tests::view;
    use crate::view_time::ViewTime;

    #[test]
    fn every_pole_has_its_sign_and_the_least_damped_is_marked() {
        let picture = tests::picture();
        let frame = drawn(60, 20, |area, buffer| draw(&view(&picture), area, buffer));
        // Six poles: three backward, two forward, and the least damped one; the title, which also has them, is left out.
        let count = |sign| frame.lines().skip(1).map(|line| line.matches(sign).count()).sum::<usize>();
        assert!((2..=3).contains(&count('▼')), "{frame}");
        assert!((1..=2).contains(&count('▲')), "{frame}");
        assert_eq!(count('◆'), 2, "the pole and its label:\n{frame}");
        assert!(frame.contains("unstable"), "{frame}");
        insta::assert_snapshot!("poles", frame);
    }

    #[test]
    fn nothing_known_is_an_empty_frame() {
        let empty = Feed::new("waiting").picture(&ViewTime::LIVE, std::time::Instant::now());
        let frame = drawn(30, 4, |area, buffer| draw(&view(&empty), area, buffer));
        assert_eq!(frame.lines().nth(1), Some(&*format!("│{}│", " ".repeat(28))));
    }
}
