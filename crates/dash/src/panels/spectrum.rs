//! The full spectrum of the mass that carries the control bearing: forward whirl to the right, backward to the left.
//!
//! ```text
//! ┌ full spectrum  mass 1  164 tau ────────────────┐
//! │1e1           ┊  ┊  ⡇  ┊  ┊       1X  0.8021 e_t │   the highest lines: order and radius of the orbit
//! │              ┊  ┊  ⡇  ⡇  ┊    -0.5X  0.0312     │
//! │        ⡀     ┊  ⡀  ⡇  ⡇  ┊                      │
//! │⣀⣀⣀⣀⣀⣀⣀⣠⣷⣀⣀⣀⣀⣀⣾⣄⣀⣀⡇⣀⣼⣧⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀│   density over frequency, eight decades from top to bottom
//! │      -2X -1X -.5X  0  .5X 1X    2X              │
//! └────────────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use spectrum::Spectrum;

use super::{framed, write, write_right};
use crate::analysis::{Orbit, OrbitSpectrum};
use crate::picture::Picture;
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::screen::View;
use crate::theme;

/// Orders that are marked, on both sides, the most important first.
const ORDERS: [(f64, &str); 3] = [(1.0, "1X"), (0.5, ".5X"), (2.0, "2X")];
/// Decades of density below the highest that are shown: amplitudes down to a ten-thousandth.
const DECADES: f64 = 8.0;
/// Lines that are named.
const NAMED: usize = 4;

pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let mass = observed(picture);
    let title = |tau: &str| Line::from(format!(" full spectrum  mass {}{tau} ", mass + 1));
    let asked = picture.now.filter(|_| picture.masses() > 0).and_then(|now| {
        let view_steps = picture.window.len();
        view.desk.spectrum(&Orbit::until(&picture.track, mass, now, view_steps, picture.seconds))
    });
    let Some(answer) = asked else {
        framed(title(""), area, buffer);
        return;
    };
    let inner = framed(title(&format!("  {} tau", short(answer.tau, 3))), area, buffer);
    match &answer.spectrum {
        Ok(spectrum) => draw_spectrum(spectrum, &answer, picture, inner, buffer),
        // Standing still, or just begun.
        Err(why) => write(buffer, inner, inner.left(), inner.top(), &why.to_string(), theme::quiet()),
    }
}

/// The mass that is looked at: the one with the control bearing.
pub(crate) fn observed(picture: &Picture) -> usize {
    let bearing = picture.era.as_ref().map_or(0, |era| era.settings.feedback.bearing);
    bearing.min(picture.masses().saturating_sub(1))
}

/// The highest frequency that is shown: beyond twice the speed, and beyond every mode.
pub(crate) fn reach(picture: &Picture) -> f64 {
    let speed = picture.now.map_or(0.0, |now| picture.track.speed(now));
    let highest = picture.poles().map_or(0.0, |(_, poles)| poles.iter().map(|pole| pole.im.abs()).fold(0.0, f64::max));
    nice_ceiling((2.2 * speed).max(1.2 * highest).max(0.1))
}

fn draw_spectrum(spectrum: &Spectrum, answer: &OrbitSpectrum, picture: &Picture, area: Rect, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    let speed = picture.now.map_or(0.0, |now| picture.track.speed(now));
    let reach = reach(picture).min(-spectrum.frequency.first().copied().unwrap_or(-1.0));
    let plotted = Rect { height: area.height.saturating_sub(1), ..area };
    let columns = usize::from(plotted.width) * 2;
    let highest = columns_of(spectrum, reach, columns);
    let top = highest.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil();
    let top = if top.is_finite() { top } else { 0.0 };
    let bottom = top - DECADES;
    let mut plot = Plot::new(plotted, Window { x: [-reach, reach], y: [bottom, top] });
    for (frequency, _) in marks(speed, reach) {
        // Dotted, so that a line of the spectrum stands out on it.
        let dots = usize::from(plotted.height) * 4;
        for dot in (0..dots).step_by(3) {
            let y = bottom + (dot as f64 + 0.5) / dots as f64 * (top - bottom);
            plot.dot(frequency, y, theme::GRID);
        }
    }
    let at = |column: usize| reach * ((2.0 * column as f64 + 1.0) / columns as f64 - 1.0);
    for (column, pair) in highest.windows(2).enumerate() {
        let color = if at(column) >= 0.0 { theme::FORWARD } else { theme::BACKWARD };
        plot.line([at(column), pair[0].max(bottom)], [at(column + 1), pair[1].max(bottom)], color);
    }
    plot.paint(buffer);

    write(buffer, plotted, area.left(), area.top(), &format!("1e{top}"), theme::quiet());
    let foot = area.bottom() - 1;
    let mut taken: Vec<[u16; 2]> = Vec::new();
    for (frequency, name) in marks(speed, reach) {
        let width = name.chars().count() as u16;
        let Some((x, _)) = plot.cell(frequency, 0.5 * (top + bottom)) else { continue };
        let x = x.saturating_sub(width / 2).max(area.left());
        // A name that would run into another is left out: the important ones come first.
        if taken.iter().all(|[from, to]| x + width < *from || x > *to) {
            write(buffer, area, x, foot, &name, theme::quiet());
            taken.push([x, x + width]);
        }
    }
    for (row, peak) in answer.peaks.iter().take(NAMED).enumerate() {
        let y = area.top() + row as u16;
        if y < plotted.bottom() && area.width > 30 {
            let color = if peak.frequency >= 0.0 { theme::FORWARD } else { theme::BACKWARD };
            let name = if peak.name.is_empty() { short(peak.frequency, 3) } else { peak.name.clone() };
            write_right(buffer, area, y, &format!("{name:>7} {:>8} e_t", short(peak.radius, 4)), theme::loud(color));
        }
    }
}

/// Where marks stand, and what they are called: zero and the orders that are in view.
fn marks(speed: f64, reach: f64) -> Vec<(f64, String)> {
    let mut marks = vec![(0.0, "0".to_owned())];
    for (order, name) in ORDERS.into_iter().filter(|(order, _)| speed > 0.0 && order * speed < reach) {
        marks.push((order * speed, name.to_owned()));
        marks.push((-order * speed, format!("-{name}")));
    }
    marks
}

/// The decimal logarithm of the highest density in each of `columns` equal parts of `-reach..reach`, so that no line falls between
/// two columns; where a part has no bin of its own, that of the nearest one.
pub(crate) fn columns_of(spectrum: &Spectrum, reach: f64, columns: usize) -> Vec<f64> {
    let bins = spectrum.frequency.len();
    let nearest = |frequency: f64| {
        let at = (frequency - spectrum.frequency[0]) / spectrum.resolution();
        (at.round().max(0.0) as usize).min(bins - 1)
    };
    let edge = |column: usize| reach * (2.0 * column as f64 / columns as f64 - 1.0);
    (0..columns)
        .map(|column| {
            let (from, to) = (nearest(edge(column)), nearest(edge(column + 1)));
            spectrum.density[from..=to.max(from)].iter().copied().fold(0.0, f64::max).log10()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use rotor::C64;

    use super::*;
    use crate::feed::{Feed, tests};
    use crate::panels::tests::drawn;
    use crate::screen::tests::view;
    use crate::view_time::ViewTime;

    /// A mass that whirls forward at 1X and, less, backward at half of it.
    pub(crate) fn picture() -> Picture {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.read(tests::bulletin("three-mass", "composite"));
        for seq in 0..17_000 {
            let mut state = tests::state(3, seq);
            let p = C64::from_polar(2.0, 2.5 * state.tau) + C64::from_polar(0.05, -1.25 * state.tau);
            (state.masses[0].y, state.masses[0].z) = (p.re, p.im);
            feed.hear(&state, now);
        }
        feed.picture(&ViewTime::LIVE, now)
    }

    #[test]
    fn lines_are_named_and_stand_on_their_marks() {
        let picture = picture();
        let frame_of = |width, height| drawn(width, height, |area, buffer| draw(&view(&picture), area, buffer));
        let frame = frame_of(72, 14);
        assert!(frame.contains("1X    2.000 e_t") && frame.contains("-0.5X    0.050 e_t"), "{frame}");
        insta::assert_snapshot!("spectrum", frame);
        insta::assert_snapshot!("spectrum_small", frame_of(28, 6));
        insta::assert_snapshot!("spectrum_large", frame_of(140, 24));
        // The highest column is that of 1X.
        let reach = reach(&picture);
        let orbit = Orbit::until(&picture.track, 0, picture.now.unwrap(), 0, picture.seconds);
        let columns = columns_of(&OrbitSpectrum::of(&orbit).spectrum.unwrap(), reach, 140);
        let highest = (0..140).max_by(|a, b| columns[*a].total_cmp(&columns[*b])).unwrap();
        let of_1x = (140.0 * (2.5 / reach + 1.0) / 2.0) as usize;
        assert!(highest.abs_diff(of_1x) <= 1, "{highest} and {of_1x}");
    }

    #[test]
    fn too_little_motion_is_told_in_words_and_no_bin_is_lost_between_columns() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        let empty = feed.picture(&ViewTime::LIVE, now);
        drawn(40, 8, |area, buffer| draw(&view(&empty), area, buffer));
        (0..20).for_each(|seq| feed.hear(&tests::state(3, seq), now));
        let picture = feed.picture(&ViewTime::LIVE, now);
        let frame = drawn(60, 8, |area, buffer| draw(&view(&picture), area, buffer));
        assert!(frame.contains("20 samples are too few for a spectrum"), "{frame}");
        let frequency: Vec<f64> = (-50..50).map(f64::from).collect();
        let mut density = vec![1.0; 100];
        density[63] = 1e5;
        let spectrum = Spectrum { frequency, density, segments: 1, segment: 100 };
        for columns in [3, 10, 40, 99, 333] {
            let columns = columns_of(&spectrum, 40.0, columns);
            assert_eq!(columns.iter().copied().fold(0.0, f64::max), 5.0);
        }
    }
}
