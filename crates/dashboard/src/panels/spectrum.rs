//! The full spectrum of one mass, that with the control bearing unless another is chosen: forward whirl to the right,
//! backward to the left.
//!
//! ```text
//! ┌ full spectrum  mass 1  164 tau ────────────────┐
//! │1e1           ┊  ┊  ⡇  ┊  ┊       1X  0.8021 e_t │   the highest lines: order and radius of the orbit
//! │              ┊  ┊  ⡇  ⡇  ┊    -0.5X  0.0312     │
//! │        ⡀     ┊  ⡀  ⡇  ⡇  ┊                      │
//! │⣀⣀⣀⣀⣀⣀⣀⣠⣷⣀⣀⣀⣀⣀⣾⣄⣀⣀⡇⣀⣼⣧⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀│   density over frequency, eight decades from top to bottom
//! │      -2X -1X -.5X  0  .5X 1X ◈  2X              │   ◈ the mode that is pointed at
//! └ ┆ 1.250  0.5X  0.0312 e_t ─────────────────────┘   the line at the frequency that is pointed at
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use spectrum::Spectrum;

use super::spectral::{Spectral, SpectralPanel, shift, told};
use crate::drawing::{framed, write, write_right};
use crate::fit_text::width;
use crate::plot::{Plot, Window};
use crate::theme;
use crate::ticks;
use crate::view::View;
use telemetry::jobs::{OrbitSpectrum, SpectrumRequest};
use telemetry::units::ScreenUnits;

/// Orders that are marked, on both sides, the most important first.
const ORDERS: [(f64, &str); 3] = [(1.0, "1X"), (0.5, ".5X"), (2.0, "2X")];
/// Decades of density below the highest that are shown: amplitudes down to a ten-thousandth.
const DECADES: f64 = 8.0;
/// Lines that are named.
const NAMED: usize = 4;

/// The spectrum: a click points at a frequency, the wheel shows more or fewer of them.
pub(crate) fn panel() -> SpectralPanel {
    SpectralPanel::new(draw)
}

fn draw(view: &View<'_>, axes: &mut Spectral, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let mass = axes.mass(data);
    let word = axes.word();
    let title = |tau: &str| Line::from(format!(" full spectrum  mass {}{word}{tau} ", mass + 1));
    let asked = data.now.filter(|_| data.masses() > 0).and_then(|now| {
        let view_steps = data.window.len();
        view.jobs.spectrum(&SpectrumRequest::until(&data.track, mass, now, view_steps, data.seconds))
    });
    let Some(answer) = asked else {
        framed(title(""), area, buffer);
        return;
    };
    let inner = framed(title(&format!("  {}", data.units().time_told(answer.tau, 3))), area, buffer);
    match &answer.spectrum {
        Ok(spectrum) => draw_spectrum(spectrum, &answer, view, axes, (area, inner), buffer),
        // Standing still, or just begun.
        Err(why) => {
            write(buffer, inner, inner.left(), inner.top(), &why.to_string(), theme::quiet());
        }
    }
}

fn draw_spectrum(
    spectrum: &Spectrum,
    answer: &OrbitSpectrum,
    view: &View<'_>,
    axes: &mut Spectral,
    (frame, area): (Rect, Rect),
    buffer: &mut Buffer,
) {
    if area.is_empty() {
        return;
    }
    let (data, units) = (view.data, view.data.units());
    axes.units = units;
    let speed = data.now.map_or(0.0, |now| data.track.speed(now));
    let plotted = Rect { height: area.height.saturating_sub(1), ..area };
    let [low, high] = axes.over(data, plotted);
    let columns = usize::from(plotted.width) * 2;
    let densities = columns_of(spectrum, [low, high], columns, shift(&units));
    let top = densities.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil();
    let top = if top.is_finite() { top } else { 0.0 };
    let [bottom, top] = axes.value.over([top - DECADES, top]);
    let mut plot = Plot::new(plotted, Window { x: [low, high], y: [bottom, top] });
    let mut upright = |frequency: f64, every: usize, color| {
        // Dotted, so that a line of the spectrum stands out on it.
        let dots = usize::from(plotted.height) * 4;
        for dot in (0..dots).step_by(every) {
            let y = bottom + (dot as f64 + 0.5) / dots as f64 * (top - bottom);
            plot.dot(frequency, y, color);
        }
    };
    let marks = marks(speed, [low, high]);
    marks.iter().for_each(|(frequency, _)| upright(*frequency, 3, theme::GRID));
    if let Some(frequency) = view.selection.frequency {
        upright(frequency, 2, theme::CURSOR);
    }
    let at = |column: usize| low + (high - low) * (column as f64 + 0.5) / columns as f64;
    for (column, pair) in densities.windows(2).enumerate() {
        let color = if at(column) >= 0.0 { theme::FORWARD } else { theme::BACKWARD };
        plot.line([at(column), pair[0].max(bottom)], [at(column + 1), pair[1].max(bottom)], color);
    }
    plot.paint(buffer);

    let unit = if units.scales.is_some() {
        format!(" {}²/{}", units.length.name, units.frequency.name)
    } else {
        String::new()
    };
    let highest = match top.fract() {
        0.0 => format!("{}1e{top}{unit}", axes.value.sign()),
        _ => format!("{}{:.0e}{unit}", axes.value.sign(), 10_f64.powf(top)),
    };
    write(buffer, plotted, area.left(), area.top(), &highest, theme::quiet());
    let foot = area.bottom() - 1;
    let mut taken: Vec<[u16; 2]> = Vec::new();
    let mode = view.selection.mode.map(|pole| (pole.im, "◈".to_owned()));
    for (frequency, name) in mode.into_iter().chain(marks) {
        let width = width(&name) as u16;
        let Some((x, _)) = plot.cell(frequency, 0.5 * (top + bottom)) else { continue };
        let x = x.saturating_sub(width / 2).max(area.left());
        // A name that would run into another is left out: the important ones come first.
        if taken.iter().all(|[from, to]| x + width < *from || x > *to) {
            let style = if name == "◈" { theme::loud(theme::CURSOR) } else { theme::quiet() };
            write(buffer, area, x, foot, &name, style);
            taken.push([x, x + width]);
        }
    }
    ticks::upright(
        frame,
        plotted,
        [bottom, top],
        |decade| plot.cell(low, decade).map(|(_, y)| y),
        |decade| format!("1e{decade}"),
        buffer,
    );
    let factor = units.frequency.factor;
    let column = |shown: f64| plot.cell(shown / factor, 0.5 * (top + bottom)).map(|(x, _)| x);
    name_peaks(answer, &units, plotted, (frame, &densities, [bottom, top]), buffer);
    // A line is as wide as a column, and its window two bins: what is nearest is the line.
    let within = axes.half_column().max(1.01 * spectrum.resolution());
    if let Some(line) = view.selection.frequency.and_then(|frequency| spectrum.at(frequency, within, speed)) {
        let edge = Rect { width: frame.width.saturating_sub(1), ..frame };
        let text = told(&line, &units);
        write(buffer, edge, frame.x + 1, frame.bottom().saturating_sub(1), &text, theme::loud(theme::CURSOR));
    }
    ticks::level(frame, [low, high].map(|end| end * factor), column, buffer);
}

/// Names the highest lines in the upper corner in which more of them have room above the curve; where none has, the highest on the
/// frame.
fn name_peaks(
    answer: &OrbitSpectrum,
    units: &ScreenUnits,
    area: Rect,
    (frame, densities, [bottom, top]): (Rect, &[f64], [f64; 2]),
    buffer: &mut Buffer,
) {
    let told = |peak: &spectrum::Peak| {
        let color = if peak.frequency >= 0.0 { theme::FORWARD } else { theme::BACKWARD };
        let name = if peak.name.is_empty() { units.frequency.short(peak.frequency, 3) } else { peak.name.clone() };
        let radius = format!("{:>8} {}", units.length.short(peak.radius, 4), units.length.name);
        (format!("{name:>7} {radius}"), theme::loud(color))
    };
    let lines: Vec<_> = answer.peaks.iter().take(NAMED).map(told).collect();
    let wide = lines.iter().map(|(text, _)| width(text) as u16).max().unwrap_or(0);
    // Rows above the curve over these columns of dots.
    let free = |columns: std::ops::Range<usize>| {
        let highest = densities.get(columns).unwrap_or_default().iter().copied().fold(bottom, f64::max);
        ((top - highest) / (top - bottom) * f64::from(area.height)).floor().clamp(0.0, f64::from(area.height)) as usize
    };
    let cells = usize::from(wide) * 2;
    let right = free(densities.len().saturating_sub(cells)..densities.len());
    // Below the scale.
    let left = free(0..cells.min(densities.len())).saturating_sub(1);
    let has_room = wide + 8 <= area.width;
    if !has_room || (right, left) == (0, 0) {
        if let Some((text, style)) = lines.first() {
            let edge = Rect { width: frame.width.saturating_sub(1), ..frame };
            write_right(buffer, edge, frame.bottom().saturating_sub(1), &format!(" {} ", text.trim_start()), *style);
        }
        return;
    }
    for (row, (text, style)) in lines.iter().take(right.max(left)).enumerate() {
        if right >= left {
            write_right(buffer, area, area.top() + row as u16, text, *style);
        } else {
            write(buffer, area, area.left(), area.top() + 1 + row as u16, text, *style);
        }
    }
}

/// Where marks stand, and what they are called: zero and the orders that are in view.
fn marks(speed: f64, [low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let mut marks = vec![(0.0, "0".to_owned())];
    for (order, name) in ORDERS.into_iter().filter(|_| speed > 0.0) {
        marks.push((order * speed, name.to_owned()));
        marks.push((-order * speed, format!("-{name}")));
    }
    marks.retain(|(frequency, _)| (low..high).contains(frequency));
    marks
}

/// The decimal logarithm of the highest density in each of `columns` equal parts of a range of frequencies, raised by `shift`, so
/// that no line waterfalls between two columns; where a part has no bin of its own, that of the nearest one.
pub(crate) fn columns_of(spectrum: &Spectrum, [low, high]: [f64; 2], columns: usize, shift: f64) -> Vec<f64> {
    let bins = spectrum.frequency.len();
    let place = |frequency: f64| ((frequency - spectrum.frequency[0]) / spectrum.resolution()).round();
    let nearest = |frequency: f64| (place(frequency).max(0.0) as usize).min(bins - 1);
    let edge = |column: usize| low + (high - low) * column as f64 / columns as f64;
    (0..columns)
        .map(|column| {
            let [left, right] = [edge(column), edge(column + 1)];
            // Beyond what was measured nothing is known.
            if place(right) < 0.0 || place(left) > (bins - 1) as f64 {
                return f64::NEG_INFINITY;
            }
            let (from, to) = (nearest(left), nearest(right));
            shift + spectrum.density[from..=to.max(from)].iter().copied().fold(0.0, f64::max).log10()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use rotor::C64;

    use wire::{Point, Step};

    use super::*;
    use crate::axis::Scaling;
    use crate::drawing::tests::drawn;
    use crate::panels::panel::{Panel, PanelCommand};
    use crate::panels::spectral::reach;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    /// A mass that whirls forward at 1X and, less, backward at half of it.
    pub(crate) fn frame_data() -> FrameData {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        for seq in 0..17_000 {
            let state = tests::state(3, seq);
            let p = C64::from_polar(2.0, 2.5 * state.tau()) + C64::from_polar(0.05, -1.25 * state.tau());
            feed.push_step(&state.with_point(0, Point { y: p.re, z: p.im, ..Point::default() }), now);
        }
        feed.frame_data(&ViewTime::LIVE, now)
    }

    #[test]
    fn lines_are_named_and_stand_on_their_marks() {
        let data = frame_data();
        let frame_of = |width, height| drawn(width, height, |area, buffer| panel().draw(&view(&data), area, buffer));
        let frame = frame_of(72, 14);
        assert!(frame.contains("1X    2.000 e_t") && frame.contains("-0.5X    0.050 e_t"), "{frame}");
        insta::assert_snapshot!("spectrum", frame);
        insta::assert_snapshot!("spectrum_small", frame_of(28, 6));
        insta::assert_snapshot!("spectrum_large", frame_of(140, 24));
        // The highest column is that of 1X.
        let reach = reach(&data);
        let orbit = SpectrumRequest::until(&data.track, 0, data.now.unwrap(), 0, data.seconds);
        let columns = columns_of(&OrbitSpectrum::of(&orbit).spectrum.unwrap(), [-reach, reach], 140, 0.0);
        let highest = (0..140).max_by(|a, b| columns[*a].total_cmp(&columns[*b])).unwrap();
        let of_1x = (140.0 * (2.5 / reach + 1.0) / 2.0) as usize;
        assert!(highest.abs_diff(of_1x) <= 1, "{highest} and {of_1x}");
    }

    #[test]
    fn the_line_that_is_pointed_at_is_read_and_scales_stand_still() {
        let data = frame_data();
        let pole = rotor::C64::new(-0.1, 1.9);
        let selection = crate::selection::Selection {
            frequency: Some(2.47),
            mode: Some(pole),
            ..crate::selection::Selection::default()
        };
        let seen = View { selection: &selection, ..view(&data) };
        let mut shown = panel();
        shown.command(&PanelCommand::Value(&[Scaling::Fix([1e-4, 1e2])]));
        shown.command(&PanelCommand::Along(Scaling::Fix([1.0, 3.0]), &selection));
        let panel = std::cell::RefCell::new(shown);
        let frame = drawn(72, 14, |area, buffer| panel.borrow_mut().draw(&seen, area, buffer));
        assert!(frame.contains("mass 1 fixed ") && frame.contains("│=1e2"), "{frame}");
        assert!(frame.contains("└ ┆ 2.500  1X  2.000 e_t ─"), "{frame}");
        assert!(frame.contains('◈') && !frame.contains("-1X "), "backward is out of view, the mode is not:\n{frame}");
        let wrong = panel.borrow_mut().command(&PanelCommand::Value(&[Scaling::Fix([-1.0, 2.0])]));
        assert_eq!(wrong, Some(Err("-1..2: expected densities above 0, such as 1e-6..1e2".into())));
        insta::assert_snapshot!("spectrum_pointed", frame);
    }

    #[test]
    fn too_little_motion_is_told_in_words_and_no_bin_is_lost_between_columns() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        let empty = feed.frame_data(&ViewTime::LIVE, now);
        drawn(40, 8, |area, buffer| panel().draw(&view(&empty), area, buffer));
        (0..20).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame = drawn(60, 8, |area, buffer| panel().draw(&view(&data), area, buffer));
        assert!(frame.contains("20 samples are too few for a spectrum"), "{frame}");
        let frequency: Vec<f64> = (-50..50).map(f64::from).collect();
        let mut density = vec![1.0; 100];
        density[63] = 1e5;
        let spectrum = Spectrum { frequency, density, segments: 1, segment: 100 };
        for columns in [3, 10, 40, 99, 333] {
            let columns = columns_of(&spectrum, [-40.0, 40.0], columns, 0.0);
            assert_eq!(columns.iter().copied().fold(0.0, f64::max), 5.0);
        }
    }
}
