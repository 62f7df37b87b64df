//! Spectra of one mass, that with the control bearing unless another is chosen, one row after the other: over time, or over speed.
//!
//! ```text
//! ┌ waterfall  mass 1 ──────────────────────────────┐
//! │-60s      ░      ▒     ░         │                │   the more ink and the hotter, the more motion
//! │          ░      ▓     ░                          │
//! │-30s      ░      █    ░                           │
//! │          ░      █   ░                            │
//! │ 0s       ░      █  ░                             │   the newest below; over speed, the fastest
//! │        -1X      0     1X                         │
//! └ ┆ 1.250  0.5X  0.0312 e_t ──────────────────────┘   the newest row at the frequency that is pointed at
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use spectrum::Peak;

use super::spectral::{Spectral, SpectralPanel, shift, told};
use crate::drawing::{framed, write, write_right};
use crate::fit_text::longest;
use crate::theme;
use crate::view::View;
use telemetry::jobs::{SpectrumRequest, Waterfall, WaterfallOrder, WaterfallRequest, WaterfallRow};
use text::number::short;

/// Decades of density from the first sign of ink to the most: amplitudes down to a thousandth.
const DECADES: f64 = 6.0;
/// Ink, from none to full.
const INK: [&str; 5] = [" ", "░", "▒", "▓", "█"];
/// Seconds that a waterfall shows at least.
const SECONDS: f64 = 60.0;
/// Orders that are marked over speed.
const ORDERS: [f64; 6] = [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0];
/// Width of the labels at the left.
const LABEL: u16 = 6;

/// Rows over time.
pub(crate) fn over_time() -> SpectralPanel {
    SpectralPanel::new(|view, axes, area, buffer| draw(view, WaterfallOrder::Time, axes, area, buffer))
}

/// Rows over the speeds that were run through.
pub(crate) fn over_speed() -> SpectralPanel {
    SpectralPanel::new(|view, axes, area, buffer| draw(view, WaterfallOrder::Speed, axes, area, buffer))
}

fn draw(view: &View<'_>, over: WaterfallOrder, axes: &mut Spectral, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let mass = axes.mass(data);
    let name = match over {
        WaterfallOrder::Time => "waterfall",
        WaterfallOrder::Speed => "waterfall over speed",
    };
    let word = if axes.value.is_fixed() { " fixed" } else { axes.word() };
    let inner = framed(Line::from(format!(" {name}  mass {}{word} ", mass + 1)), area, buffer);
    let (Some(now), true) = (data.now, data.masses() > 0 && inner.height > 1 && inner.width > LABEL) else {
        return;
    };
    let units = data.units();
    axes.units = units;
    let rows = usize::from(inner.height) - 1;
    let plotted = Rect { x: inner.x + LABEL, width: inner.width - LABEL, height: rows as u16, ..inner };
    let range = axes.over(data, plotted);
    let shown = if data.seconds > 0.0 { (SECONDS / data.seconds) as usize } else { 0 };
    let hop = shown.max(data.window.len()).div_ceil(rows).max(1);
    // Rows are alike on both sides of zero: as far as the further end.
    let reach = range[0].abs().max(range[1].abs());
    // Over speed all that is kept counts, up to the moment that is looked at.
    let orbit = match over {
        WaterfallOrder::Time => SpectrumRequest::until(&data.track, mass, now, 0, data.seconds),
        WaterfallOrder::Speed => {
            let now = (data.track.index_of(now) - data.kept.index_of(0)) as usize;
            SpectrumRequest::until(&data.kept, mass, now, 0, data.seconds)
        }
    };
    let Some(answer) = view.jobs.waterfall(&WaterfallRequest { orbit, over, rows, hop, reach }) else { return };
    if answer.rows.is_empty() {
        let (has, needs) = (answer.longest, WaterfallRow::STEPS);
        let seconds = |steps: usize| short(steps as f64 * data.seconds, 3);
        let full = format!("too little motion yet: {} of {} s without a gap", seconds(has), seconds(needs));
        let brief = format!("{} of {} s", seconds(has), seconds(needs));
        let told = longest(&[&full, &format!("too little yet: {brief}"), &brief], usize::from(inner.width));
        write(buffer, inner, inner.left(), inner.top(), &told, theme::quiet());
        return;
    }
    let shift = shift(&units);
    let most = shift + answer.rows.iter().flat_map(|row| &row.density).copied().fold(0.0_f64, f64::max).log10();
    let [least, most] = axes.value.over([most - DECADES, most]).map(|end| end - shift);
    let placed = rows_on_screen(&answer, over, plotted);
    for (row, y) in &placed {
        draw_row(row, (reach, range), [least, most], Rect { y: *y, height: 1, ..plotted }, buffer);
    }
    let newest = data.track.index_of(now);
    for (row, y) in placed.iter().filter(|(_, y)| (plotted.bottom() - 1 - y).is_multiple_of(4)) {
        let label = match over {
            WaterfallOrder::Time => format!("-{}s", short(newest.saturating_sub(row.end) as f64 * data.seconds, 2)),
            WaterfallOrder::Speed => units.speed(row.speed),
        };
        write(buffer, Rect { width: LABEL - 1, ..inner }, inner.x, *y, &label, theme::quiet());
    }
    let speed = data.track.speed(now);
    let foot = Rect { y: inner.bottom() - 1, height: 1, ..plotted };
    let column = |frequency: f64| {
        let at = (frequency - range[0]) / (range[1] - range[0]) * f64::from(plotted.width);
        (0.0..f64::from(plotted.width)).contains(&at).then_some(plotted.x + at as u16)
    };
    let mut mark = |frequency: f64, name: &str| {
        if let Some(x) = column(frequency) {
            write(
                buffer,
                foot,
                x.saturating_sub(crate::fit_text::width(name) as u16 / 2),
                foot.y,
                name,
                theme::quiet(),
            );
        }
    };
    mark(0.0, "0");
    if speed > 0.0 && over == WaterfallOrder::Time {
        [(-1.0, "-1X"), (1.0, "1X")].into_iter().for_each(|(order, name)| mark(order * speed, name));
    } else {
        // Over speed an order is no fixed frequency.
        let quarter = |share: f64| range[0] + share * (range[1] - range[0]);
        [0.25, 0.75].into_iter().for_each(|share| mark(quarter(share), &units.frequency.short(quarter(share), 2)));
    }
    if units.scales.is_some() {
        write_right(buffer, foot, foot.y, units.frequency.name, theme::quiet());
    }
    if over == WaterfallOrder::Speed {
        draw_orders(&answer, &column, plotted, buffer);
    }
    let Some(frequency) = view.selection.frequency else { return };
    if let Some(x) = column(frequency) {
        for y in plotted.top()..plotted.bottom() {
            // Ink is not written over.
            if buffer.cell((x, y)).is_some_and(|cell| cell.symbol() == " ") {
                write(buffer, plotted, x, y, "┆", theme::quiet());
            }
        }
        write(buffer, foot, x, foot.y, "┆", theme::loud(theme::CURSOR));
    }
    let newest = answer.rows.iter().max_by_key(|row| row.end);
    if let Some(line) = newest.and_then(|row| line_at(row, reach, frequency, speed)) {
        let edge = Rect { width: area.width.saturating_sub(1), ..area };
        let text = told(&line, &units);
        write(buffer, edge, area.x + 1, area.bottom().saturating_sub(1), &text, theme::loud(theme::CURSOR));
    }
}

/// Where the orders lie at the speeds of the rows, faintly, and nowhere on ink.
fn draw_orders(fall: &Waterfall, column: &impl Fn(f64) -> Option<u16>, area: Rect, buffer: &mut Buffer) {
    for (y, ends) in (area.top()..area.bottom()).zip(fall.edges.windows(2)) {
        let speed = 0.5 * (ends[0] + ends[1]);
        for order in ORDERS {
            let at = column(order * speed).and_then(|x| buffer.cell_mut((x, y)));
            if let Some(cell) = at.filter(|cell| cell.symbol() == " ") {
                cell.set_symbol("·").set_fg(theme::GRID);
            }
        }
    }
}

/// What a row has at a frequency: the line that its bin would be the middle of.
fn line_at(row: &WaterfallRow, reach: f64, frequency: f64, speed: f64) -> Option<Peak> {
    let bins = row.density.len();
    let bin = 2.0 * reach / bins as f64;
    let at = ((frequency + reach) / bin).floor();
    let density = *row.density.get(usize::try_from(at as i64).ok()?)?;
    let order = (speed > 0.0).then(|| frequency / speed);
    let name = order.map_or_else(String::new, |order| format!("{}X", short(order, 3)));
    // The equivalent noise bandwidth of the window is 1.5 bins.
    Some(Peak { frequency, order, name, density, radius: (density * 1.5 * bin).sqrt() })
}

/// The rows and where they stand: over time the newest below; over speed, each at its own, the fastest below.
fn rows_on_screen<'a>(answer: &'a Waterfall, over: WaterfallOrder, area: Rect) -> Vec<(&'a WaterfallRow, u16)> {
    let place = |at: usize, row: &WaterfallRow| match over {
        WaterfallOrder::Time => area.bottom().checked_sub((answer.rows.len() - at) as u16),
        WaterfallOrder::Speed => {
            let at = answer.edges.partition_point(|edge| *edge <= row.speed).saturating_sub(1);
            Some(area.y + (at as u16).min(area.height - 1))
        }
    };
    let on = |at: usize, row: &'a WaterfallRow| Some((row, place(at, row).filter(|y| *y >= area.y)?));
    answer.rows.iter().enumerate().filter_map(|(at, row)| on(at, row)).collect()
}

fn draw_row(
    row: &WaterfallRow,
    (reach, range): (f64, [f64; 2]),
    [least, most]: [f64; 2],
    area: Rect,
    buffer: &mut Buffer,
) {
    let (cells, bins) = (usize::from(area.width), row.density.len());
    if bins == 0 {
        return;
    }
    // The bin at an edge of a cell.
    let bin = |cell: usize| {
        let frequency = range[0] + (range[1] - range[0]) * cell as f64 / cells as f64;
        (frequency + reach) / (2.0 * reach) * bins as f64
    };
    for cell in 0..cells {
        let (from, to) =
            ((bin(cell) + 1e-9).floor().max(0.0) as usize, (bin(cell + 1) - 1e-9).ceil().max(0.0) as usize);
        let from = from.min(bins - 1);
        let highest = row.density[from..to.clamp(from + 1, bins)].iter().copied().fold(0.0_f64, f64::max).log10();
        // 0 at the first sign, 1 at the most.
        let heat = (highest - least) / (most - least);
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

    use wire::{Channel, Point, Step};

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::panels::panel::Panel;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    /// A run-up from R = 1 to 3 in forty seconds, with the motion in step: 1X throughout.
    fn run_up() -> FrameData {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        for seq in 0..40_000_u64 {
            let state = tests::state(3, seq);
            let tau = state.tau();
            let (sin, cos) = (tau + tau * tau / 400.0).sin_cos();
            let state = state.with_point(0, Point { y: cos, z: sin, ..Point::default() });
            feed.push_step(&state.with(Channel::Speed, 0, 1.0 + tau / 200.0), now);
        }
        feed.frame_data(&ViewTime::LIVE, now)
    }

    /// Where the most ink is in a line of a frame, after the labels.
    fn hottest(line: &str) -> Option<usize> {
        line.chars().skip(1 + usize::from(LABEL)).position(|c| c == '█')
    }

    #[test]
    fn a_line_in_step_with_the_speed_leans_over_time_and_over_speed() {
        let data = run_up();
        let times = drawn(64, 16, |area, buffer| over_time().draw(&view(&data), area, buffer));
        let speeds = drawn(64, 16, |area, buffer| over_speed().draw(&view(&data), area, buffer));
        for frame in [&times, &speeds] {
            let found: Vec<usize> = frame.lines().filter_map(hottest).collect();
            assert!(found.len() > 5 && found.is_sorted() && found[0] < found[found.len() - 1], "{found:?}\n{frame}");
        }
        insta::assert_snapshot!("waterfall_over_time", times);
        insta::assert_snapshot!("waterfall_over_speed", speeds);
        let small = drawn(24, 6, |area, buffer| over_time().draw(&view(&data), area, buffer));
        insta::assert_snapshot!("waterfall_small", small);
        let large = drawn(120, 30, |area, buffer| over_time().draw(&view(&data), area, buffer));
        insta::assert_snapshot!("waterfall_large", large);
    }

    #[test]
    fn the_newest_row_is_read_at_the_frequency_that_is_pointed_at() {
        // 1 e_t at 1X, which is R = 3 by the end; a row is some turns of a run-up, so its line is a little broad and low.
        let data = run_up();
        let selection = crate::selection::Selection { frequency: Some(2.97), ..crate::selection::Selection::default() };
        let seen = View { selection: &selection, ..view(&data) };
        let frame = drawn(64, 16, |area, buffer| over_time().draw(&seen, area, buffer));
        let told = frame.lines().last().unwrap();
        let radius: f64 = told.split_whitespace().nth_back(2).unwrap().parse().unwrap();
        assert!(told.starts_with("└ ┆ 2.970  0.99X  ") && (0.3..1.1).contains(&radius), "{frame}");
        assert!(frame.lines().filter(|line| line.contains('┆')).count() > 3, "{frame}");
    }

    #[test]
    fn too_little_motion_is_told() {
        let data = tests::frame_data();
        let frame = drawn(40, 6, |area, buffer| over_time().draw(&view(&data), area, buffer));
        assert!(frame.contains("too little yet: 3.00 of 4.10 s"), "{frame}");
    }
}
