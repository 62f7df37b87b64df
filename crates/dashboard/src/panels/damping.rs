//! The smallest damping ratio, large, with what it has been.
//!
//! ```text
//! ┌ minimum damping ────────────────┐
//! │ ▛▀▌   ▛▀▌ ▐▖▐ ▐▖▐ ▛▀▘  stable   │
//! │ ▌ ▌   ▌ ▌ ▀▀▜ ▀▀▜ ▀▀▖  log dec  │
//! │ ▙▄▌ ▖ ▙▄▌   ▐   ▐ ▄▄▘  0.2805   │
//! │ but whirls at 112 e_t           │   what the clearances make of it, and how far it holds
//! │ ⠤⠤⠤⠤⠤⠤⠤⠤⣀⣀⣀⣀⣀⣀⣀⣀⠤⠤⠤⠤⠤⠤⠤ 0.05 │
//! │ ⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒ 0    │   the line of zero is the limit of stability
//! └─────────────────────────────────┘
//! ```

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Margin, Position, Rect};
use ratatui::text::Line;
use ratatui::widgets::Widget;
use tui_big_text::{BigText, PixelSize};

use telemetry::jobs::pole_trace::PoleTraceRequest;

use super::panel::{Panel, PanelRequest};
use super::verdict::notes;
use super::{look_at, wheel_times};
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_right};
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::theme;
use crate::view::View;
use text::number::{nice_ceiling, short};

/// Height of the large digits, and width of each, in cells.
const DIGITS: (u16, u16) = (4, 4);

/// The minimum damping; a click on its history looks at a moment, the wheel changes the scale of that.
#[derive(Debug, Default)]
pub(crate) struct Damping {
    scale: PlotAxis,
}

impl Panel for Damping {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, &mut self.scale, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.scale.zoom(wheel_times(notches), None);
            return None;
        }
        let data = view.data;
        let inner = area.inner(Margin::new(1, 1));
        let min_damping = data.poles()?.0;
        let word = view.standstill().unwrap_or(theme::verdict(min_damping).1);
        let history = parts(inner, min_damping, word, notes(view, usize::from(inner.width)).len()).history;
        look_at(data, &data.overview, history, at)
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.scale)
    }
}

/// Where things are.
struct Parts {
    notes: Rect,
    /// Whether the digits are large, and whether the words have room beside them.
    large: bool,
    fits_beside: bool,
    head: Rect,
    history: Rect,
}

fn parts(inner: Rect, min_damping: f64, word: &str, notes: usize) -> Parts {
    let width = format!("{min_damping:.4}").len() as u16 * DIGITS.1;
    // The word stands beside the digits, or on a line of its own below them.
    let fits_beside = inner.left() + width + 1 + word.len() as u16 <= inner.right();
    let height = DIGITS.0 + u16::from(!fits_beside);
    let large = inner.width >= width && inner.height > height;
    let head = if large { height } else { 1 };
    // What is told in words comes before the history, but for a row or two of that.
    let left = inner.height.saturating_sub(head);
    let notes = (notes as u16).min(left.saturating_sub(2).max(left.min(1)));
    let heights = [Constraint::Length(head), Constraint::Length(notes), Constraint::Min(0)];
    let [head, notes, history] = Layout::vertical(heights).areas(inner);
    Parts { notes, large, fits_beside, head, history }
}

fn draw(view: &View<'_>, axis: &mut PlotAxis, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let inner = framed(Line::from(" minimum damping "), area, buffer);
    let Some((min_damping, _)) = data.poles() else { return };
    let (color, word) = theme::verdict(min_damping);
    let word = view.standstill().unwrap_or(word);
    let number = format!("{min_damping:.4}");
    let width = number.len() as u16 * DIGITS.1;
    let beside = inner.left() + width + 1;
    let notes = notes(view, usize::from(inner.width));
    let Parts { notes: below, large, fits_beside, head, history } = parts(inner, min_damping, word, notes.len());
    let log_decrement =
        data.least_damped().map(|pole| std::f64::consts::TAU * -pole.re / pole.im.abs()).filter(|d| d.is_finite());
    let told = log_decrement.map(|d| short(d, 5));
    let then = view.what_if.map(|candidate| {
        let (color, word) = theme::verdict(candidate.min_damping);
        // A machine that runs on beside a recording is there already.
        let when = if view.replay.is_some() { "what if" } else { "then" };
        match &candidate.refusal {
            None => (format!("{when} {:.4} {word}", candidate.min_damping), theme::loud(color)),
            Some(_) => (
                format!("{when} {:.4}: REFUSED, too fast for the step", candidate.min_damping),
                theme::loud(theme::BAD),
            ),
        }
    });
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
    for (y, (text, style)) in (below.top()..below.bottom()).zip(&notes) {
        write(buffer, below, below.left(), y, text, *style);
    }
    draw_history(view, axis, history, buffer);
    if let Some((text, style)) = then {
        // On the upper edge of the frame, where it covers nothing that is in force.
        let edge = Rect { width: area.width.saturating_sub(1), ..area };
        write_right(buffer, edge, area.top(), &format!(" {text} "), style);
    }
}

fn draw_history(view: &View<'_>, axis: &mut PlotAxis, area: Rect, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    let data = view.data;
    // The end of the window at the right edge; a column of dots shows the least of its values, so that no dip is lost.
    let columns = usize::from(area.width) * 2;
    let steps: Vec<_> = data.track.columns(data.overview.clone(), columns).collect();
    // While the speed is on its way the damping is that of each moment's speed.
    let pole_trace = data.era.as_ref().and_then(|era| Some((era, view.jobs.pole_trace(&PoleTraceRequest::of(era)?)?)));
    let least = |steps: &Range<usize>| {
        let told = data.least_damping(steps)?;
        let (era, pole_trace) = pole_trace.as_ref()?;
        let speed = data.track.speed(steps.end.max(steps.start + 1) - 1);
        let is_on_its_way = data.era_of(steps).is_some_and(|of| of.revision == era.revision && of.speed != speed);
        Some(if is_on_its_way { pole_trace.min_damping_near(speed) } else { told })
    };
    let shown: Vec<f64> =
        steps.iter().map(|steps| least(steps).or_else(|| data.least_damping(steps)).unwrap_or(f64::NAN)).collect();
    let top = nice_ceiling(shown.iter().copied().fold(0.0, f64::max) * 1.05);
    let bottom = shown.iter().copied().fold(0.0, f64::min);
    let bottom = if bottom < 0.0 { -nice_ceiling(-bottom * 1.05) } else { -0.15 * top };
    let [bottom, top] = axis.over([bottom, top]);
    let [left, right] = [data.overview.start as f64, data.overview.end as f64];
    let mut plot = Plot::new(area, Window { x: [left, right], y: [bottom, top] });
    plot.line([left, 0.0], [right, 0.0], theme::GRID);
    if let Some(now) = data.now.filter(|_| !view.time.is_live()) {
        plot.line([now as f64 + 0.5, bottom], [now as f64 + 0.5, top], theme::CURSOR);
    }
    for (steps, pair) in steps.windows(2).zip(shown.windows(2)) {
        let [x, next] = [0, 1].map(|at| 0.5 * (steps[at].start + steps[at].end) as f64);
        let color = theme::verdict(pair[1]).0;
        plot.line([x, pair[0]], [next, pair[1]], color);
    }
    plot.paint(buffer);
    write(buffer, area, area.left(), area.top(), &format!("{}{}", axis.sign(), short(top, 3)), theme::quiet());
    if axis.is_fixed() || bottom < -0.2 * top {
        write(buffer, area, area.left(), area.bottom() - 1, &short(bottom, 3), theme::quiet());
    }
    let seconds = short(data.overview.len() as f64 * data.seconds, 2);
    if area.height > 2 && !data.overview.is_empty() {
        write_right(buffer, area, area.bottom() - 1, &format!("{seconds} s"), theme::quiet());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::history::Era;
    use telemetry::test_support as tests;

    #[test]
    fn a_stable_rotor_shows_its_damping_large() {
        let mut data = tests::frame_data();
        let (first, era) = data.eras[0].clone();
        let lower = Era { min_damping: 0.03, ..(*era).clone() };
        data.eras = vec![(first, std::sync::Arc::new(lower)), (1500, era)];
        insta::assert_snapshot!(
            "damping",
            drawn(44, 12, |area, buffer| Damping::default().draw(&view(&data), area, buffer))
        );
    }

    #[test]
    fn an_unstable_rotor_says_so_in_words() {
        let mut data = tests::frame_data();
        let era = std::sync::Arc::new(Era::of(&tests::bench_status("three-mass", "off"), None));
        data.eras.push((2000, era.clone()));
        data.era = Some(era);
        for (width, height) in [(44, 12), (26, 7), (20, 3)] {
            let frame = drawn(width, height, |area, buffer| Damping::default().draw(&view(&data), area, buffer));
            assert!(frame.contains("UNSTABLE"), "{frame}");
        }
        let small = drawn(20, 3, |area, buffer| Damping::default().draw(&view(&data), area, buffer));
        assert!(small.contains("-0.0306"), "{small}");
    }
}
