//! Spectra of the mass that carries the control bearing, one row after the other: over time, or over speed.
//!
//! ```text
//! ┌ waterfall  mass 1 ──────────────────────────────┐
//! │-60s      ░      ▒     ░         │                │   the more ink and the hotter, the more motion
//! │          ░      ▓     ░                          │
//! │-30s      ░      █    ░                           │
//! │          ░      █   ░                            │
//! │ 0s       ░      █  ░                             │   the newest below; over speed, the fastest
//! │        -1X      0     1X                         │
//! └─────────────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::damping_over_speed::speed_text;
use super::spectrum::{observed, reach};
use super::{framed, write};
use crate::analysis::{Fall, Orbit, Over, Row, Waterfall};
use crate::plot::short;
use crate::screen::View;
use crate::theme;

/// Decades of density from the first sign of ink to the most: amplitudes down to a thousandth.
const DECADES: f64 = 6.0;
/// Ink, from none to full.
const INK: [&str; 5] = [" ", "░", "▒", "▓", "█"];
/// Seconds that a waterfall shows at least.
const SECONDS: f64 = 60.0;
/// Width of the labels at the left.
const LABEL: u16 = 6;

/// Rows over time.
pub(crate) fn draw_over_time(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    draw(view, Over::Time, area, buffer);
}

/// Rows over the speeds that were run through.
pub(crate) fn draw_over_speed(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    draw(view, Over::Speed, area, buffer);
}

fn draw(view: &View<'_>, over: Over, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let mass = observed(picture);
    let name = match over {
        Over::Time => "waterfall",
        Over::Speed => "waterfall over speed",
    };
    let inner = framed(Line::from(format!(" {name}  mass {} ", mass + 1)), area, buffer);
    let (Some(now), true) = (picture.now, picture.masses() > 0 && inner.height > 1 && inner.width > LABEL) else {
        return;
    };
    let rows = usize::from(inner.height) - 1;
    let shown = if picture.seconds > 0.0 { (SECONDS / picture.seconds) as usize } else { 0 };
    let hop = shown.max(picture.window.len()).div_ceil(rows).max(1);
    let reach = reach(picture);
    let orbit = Orbit::until(&picture.track, mass, now, 0, picture.seconds);
    let Some(answer) = view.desk.waterfall(&Fall { orbit, over, rows, hop, reach }) else { return };
    if answer.rows.is_empty() {
        write(buffer, inner, inner.left(), inner.top(), "too little motion yet", theme::quiet());
        return;
    }
    let plotted = Rect { x: inner.x + LABEL, width: inner.width - LABEL, height: rows as u16, ..inner };
    let most = answer.rows.iter().flat_map(|row| &row.density).copied().fold(0.0_f64, f64::max).log10();
    for (row, y) in rows_on_screen(&answer, over, plotted) {
        draw_row(row, most, Rect { y, height: 1, ..plotted }, buffer);
    }
    let scales = picture.rotor.as_ref().and_then(|rotor| rotor.scales().copied());
    let newest = picture.track.place_of(now);
    for (row, y) in
        rows_on_screen(&answer, over, plotted).into_iter().filter(|(_, y)| (plotted.bottom() - 1 - y).is_multiple_of(4))
    {
        let label = match over {
            Over::Time => format!("-{}s", short(newest.saturating_sub(row.end) as f64 * picture.seconds, 2)),
            Over::Speed => speed_text(row.speed, scales),
        };
        write(buffer, Rect { width: LABEL - 1, ..inner }, inner.x, y, &label, theme::quiet());
    }
    let speed = picture.track.speed(now);
    let foot = Rect { y: inner.bottom() - 1, height: 1, ..plotted };
    let mut mark = |frequency: f64, name: &str| {
        let at = (frequency / reach + 1.0) / 2.0 * f64::from(plotted.width);
        if (0.0..f64::from(plotted.width)).contains(&at) {
            let x = plotted.x + (at as u16).saturating_sub(name.len() as u16 / 2);
            write(buffer, foot, x, foot.y, name, theme::quiet());
        }
    };
    mark(0.0, "0");
    if speed > 0.0 && over == Over::Time {
        [(-1.0, "-1X"), (1.0, "1X")].into_iter().for_each(|(order, name)| mark(order * speed, name));
    } else {
        // Over speed an order is no fixed frequency.
        [-0.5, 0.5].into_iter().for_each(|share| mark(share * reach, &short(share * reach, 2)));
    }
}

/// The rows and where they stand: over time the newest below; over speed, each at its own, the fastest below.
fn rows_on_screen<'a>(answer: &'a Waterfall, over: Over, area: Rect) -> Vec<(&'a Row, u16)> {
    let place = |at: usize, row: &Row| match over {
        Over::Time => area.bottom().checked_sub((answer.rows.len() - at) as u16),
        Over::Speed => {
            let at = answer.edges.partition_point(|edge| *edge <= row.speed).saturating_sub(1);
            Some(area.y + (at as u16).min(area.height - 1))
        }
    };
    let on = |at: usize, row: &'a Row| Some((row, place(at, row).filter(|y| *y >= area.y)?));
    answer.rows.iter().enumerate().filter_map(|(at, row)| on(at, row)).collect()
}

fn draw_row(row: &Row, most: f64, area: Rect, buffer: &mut Buffer) {
    let (cells, bins) = (usize::from(area.width), row.density.len());
    if bins == 0 {
        return;
    }
    for cell in 0..cells {
        let (from, to) = (cell * bins / cells, ((cell + 1) * bins).div_ceil(cells));
        let highest = row.density[from..to.clamp(from + 1, bins)].iter().copied().fold(0.0_f64, f64::max).log10();
        // 0 at the first sign, 1 at the most.
        let heat = 1.0 + (highest - most) / DECADES;
        if heat <= 0.0 || !heat.is_finite() {
            continue;
        }
        let of = |steps: usize| ((heat * steps as f64) as usize).min(steps - 1);
        let ink = INK[1 + of(INK.len() - 1)];
        let color = theme::HEAT[of(theme::HEAT.len())];
        if let Some(cell) = buffer.cell_mut((area.x + cell as u16, area.y)) {
            cell.set_symbol(ink).set_fg(color);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::feed::{Feed, tests};
    use crate::panels::tests::drawn;
    use crate::picture::Picture;
    use crate::screen::tests::view;
    use crate::view_time::ViewTime;

    /// A run-up from R = 1 to 3 in forty seconds, with the motion in step: 1X throughout.
    fn run_up() -> Picture {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.read(tests::bulletin("three-mass", "composite"));
        for seq in 0..40_000_u64 {
            let mut state = tests::state(3, seq);
            state.speed = 1.0 + state.tau / 200.0;
            let angle = state.tau + state.tau * state.tau / 400.0;
            (state.masses[0].y, state.masses[0].z) = (angle.cos(), angle.sin());
            feed.hear(&state, now);
        }
        feed.picture(&ViewTime::LIVE, now)
    }

    /// Where the most ink is in a line of a frame, after the labels.
    fn hottest(line: &str) -> Option<usize> {
        line.chars().skip(1 + usize::from(LABEL)).position(|c| c == '█')
    }

    #[test]
    fn a_line_in_step_with_the_speed_leans_over_time_and_over_speed() {
        let picture = run_up();
        let times = drawn(64, 16, |area, buffer| draw_over_time(&view(&picture), area, buffer));
        let speeds = drawn(64, 16, |area, buffer| draw_over_speed(&view(&picture), area, buffer));
        for frame in [&times, &speeds] {
            let found: Vec<usize> = frame.lines().filter_map(hottest).collect();
            assert!(found.len() > 5 && found.is_sorted() && found[0] < found[found.len() - 1], "{found:?}\n{frame}");
        }
        insta::assert_snapshot!("waterfall_over_time", times);
        insta::assert_snapshot!("waterfall_over_speed", speeds);
        let small = drawn(24, 6, |area, buffer| draw_over_time(&view(&picture), area, buffer));
        insta::assert_snapshot!("waterfall_small", small);
        let large = drawn(120, 30, |area, buffer| draw_over_time(&view(&picture), area, buffer));
        insta::assert_snapshot!("waterfall_large", large);
    }

    #[test]
    fn too_little_motion_is_told() {
        let picture = tests::picture();
        let frame = drawn(40, 6, |area, buffer| draw_over_time(&view(&picture), area, buffer));
        assert!(frame.contains("too little motion yet"), "{frame}");
    }
}
