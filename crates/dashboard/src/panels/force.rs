//! The control force: now, and the most since the settings last changed.
//!
//! ```text
//! ┌ control force  N  bar to 40 ────┐
//! │ now  1.423  ████████████░░░░░░░ │   "was" under a cursor in the past; the bar ends at the alarm's limit, or where it is fixed
//! │ max  2.655  since revision 3    │
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::panel::Panel;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_right};
use crate::fit_text::longest;
use crate::theme;
use crate::view::View;
use text::number::{neat, nice_ceiling, short};

/// Width of a label and its number.
const HEAD: u16 = 13;

/// The force; the wheel changes the scale of its bar.
#[derive(Debug, Default)]
pub(crate) struct Force {
    scale: PlotAxis,
}

impl Panel for Force {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, &mut self.scale, area, buffer);
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.scale)
    }
}

/// What the force under the cursor is called.
pub(super) fn when(view: &View<'_>) -> &'static str {
    if view.time.is_live() { "now" } else { "was" }
}

fn draw(view: &View<'_>, axis: &mut PlotAxis, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let unit = data.units().force;
    let name = format!(" control force  {} ", unit.name);
    let Some(at) = data.now else {
        framed(Line::from(name), area, buffer);
        return;
    };
    // Of several control bearings the one that works hardest, as if the first had to.
    let (masses, bearings) = (data.masses_of_bearings(), 0..data.track.layout().bearings());
    let size = |bearing: usize| {
        let [y, z] = data.track.forces(at, bearing)[1];
        masses.as_of_first(bearing, y.hypot(z))
    };
    let hardest = bearings.max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(0);
    let now = size(hardest) * unit.factor;
    let peak = data.peak_force() * unit.factor;
    // What the bearing may do, or else a round number: a bar against its own maximum says nothing.
    let limit = view.alarms.limits().of_bearing(hardest).map(|limit| limit.alarm * unit.factor);
    let [_, full] = axis.over([0.0, limit.unwrap_or_else(|| nice_ceiling(1.2 * peak))]);
    let past = |value: f64| match limit {
        Some(limit) if value > limit => theme::BAD,
        _ => theme::FORCE,
    };
    let to = format!("{name} bar to {} ", neat(full));
    let room = usize::from(area.width.saturating_sub(2));
    let inner = framed(Line::from(longest(&[&to, &name], room)), area, buffer);
    let mut line = |row: u16, name: &str, value: f64| {
        let text = format!("{name} {:>8}", short(value, 5));
        write(buffer, inner, inner.left(), inner.top() + row, &text, theme::loud(past(value)));
    };
    line(0, when(view), now);
    line(1, "max", peak);
    if inner.width > HEAD {
        let cells = inner.width - HEAD;
        let part = (now / full * f64::from(cells)).round().clamp(0.0, f64::from(cells));
        let filled = if full > 0.0 { part as usize } else { 0 };
        let bar = "█".repeat(filled) + &"░".repeat(usize::from(cells) - filled);
        write(buffer, inner, inner.left() + HEAD, inner.top(), &bar, theme::loud(past(now)));
    }
    if axis.is_fixed() {
        write_right(buffer, inner, inner.top() + 1, &format!("{} fixed", short(full, 3)), theme::quiet());
    } else {
        let since = data.era.as_ref().map_or_else(String::new, |era| format!("since revision {}", era.revision));
        let short = since.replace("revision", "rev").replace("since ", "");
        let since = longest(&[&since, &short], usize::from(inner.width.saturating_sub(HEAD)));
        write(buffer, inner, inner.left() + HEAD, inner.top() + 1, &since, theme::quiet());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;

    #[test]
    fn shows_the_force_now_and_at_most() {
        let data = tests::frame_data();
        let frame = drawn(40, 4, |area, buffer| Force::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("now   0.8000") && frame.contains("max   0.8000"), "{frame}");
        assert!(frame.contains("since revision 1"), "{frame}");
    }

    /// 2 on 30 kg is more than 3 on 10 kg.
    #[test]
    fn of_several_control_bearings_the_larger_force_is_shown() {
        let data = tests::frame_data_of_two_bearings();
        let frame = drawn(40, 4, |area, buffer| Force::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("now   108.00") && frame.contains("max   108.00"), "{frame}");
    }
}
