//! Every number of one step, as it came.
//!
//! ```text
//! ┌ step at tau 29.99 ────────────────────────┐
//! │ R 2.5  angle 74.975 rad  turn 11  rate 0   │
//! │ mass               y         z        vy        vz    radius │
//! │   1           1.2345   -0.5432 ...         │
//! │ u delivered   0.8000   -0.0123                        0.8001 │
//! │ u commanded   0.8000   -0.0123                        0.8001 │
//! │ flags contact.1                            │
//! │ reads 1       1.2345   -0.5432                        1.3487 │
//! └────────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;

use units::Dimension;
use wire::Channel;

use super::panel::Panel;
use crate::drawing::{framed, write};
use crate::list::{List, draw_overflow, filter_title, passes};
use crate::theme;
use crate::view::View;
use telemetry::history::StepQuantity;
use text::number::short;

/// Digits of a number, and the width of its column.
const DIGITS: usize = 6;
const WIDTH: usize = 10;
/// Width of the names of the rows.
const NAME: usize = 11;
/// The same two where there is less room.
const NARROW: (usize, usize) = (5, 9);

/// The table.
#[derive(Debug, Default)]
pub(crate) struct Raw {
    list: List,
}

impl Panel for Raw {
    fn scroll(&mut self, rows: isize) {
        self.list.scroll(rows);
    }

    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(&mut self.list, view, area, buffer);
    }
}

fn draw(list: &mut List, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let (track, Some(now)) = (&view.data.track, view.data.now) else {
        framed(Line::from(" step "), area, buffer);
        return;
    };
    let units = view.data.units();
    let speed = match units.scales {
        Some(_) => units.speed.told(track.speed(now), DIGITS),
        None => format!("R {}", short(track.speed(now), DIGITS)),
    };
    let rate = track.value(StepQuantity::Of(Channel::SpeedRate, 0), now);
    let rate = units.of_dimension(Dimension::SpeedRate).told(rate, DIGITS);
    // Words go before numbers.
    let is_wide = usize::from(area.width.saturating_sub(2)) >= NAME + 5 * WIDTH;
    let widths = if is_wide { (NAME, WIDTH) } else { NARROW };
    let [delivered, commanded] = if is_wide { ["u delivered", "u commanded"] } else { ["u", "u cmd"] };
    let reads = if is_wide { "reads " } else { "rd " };
    let row = |name: &str, cells: [String; 5]| row(widths, name, &cells);
    let (angle, plain) = (track.angle(now), Style::new());
    let turns = (angle / std::f64::consts::TAU).floor();
    let mut lines = vec![
        (format!("{speed}  angle {} rad  turn {turns}  rate {rate}", short(angle, 8)), plain),
        (row("mass", ["y", "z", "vy", "vz", "radius"].map(str::to_owned)), theme::quiet()),
    ];
    for mass in 0..view.data.masses() {
        let ([y, z], [vy, vz]) = (track.displacement(now, mass), track.velocity(now, mass));
        let [y, z, radius] = [y, z, y.hypot(z)].map(|value| units.length.short(value, DIGITS));
        let [vy, vz] = [vy, vz].map(|value| units.velocity.short(value, DIGITS));
        let name = format!("{:>3}", mass + 1);
        lines.push((row(&name, [y, z, vy, vz, radius]), Style::new().fg(theme::TRACES[mass % theme::TRACES.len()])));
    }
    // Below the headings of the masses: along y, along z, and in all.
    let force = |name: &str, bearing: usize, [y, z]: [f64; 2]| {
        let [y, z, size] = [y, z, y.hypot(z)].map(|value| units.force_of(bearing).short(value, DIGITS));
        row(name, [y, z, String::new(), String::new(), size])
    };
    let bearings = track.layout().bearings();
    for bearing in 0..bearings {
        let [asked, given] = track.forces(now, bearing);
        let name = |what: &str| if bearings > 1 { format!("{what} {}", bearing + 1) } else { what.to_owned() };
        lines.push((force(&name(delivered), bearing, given), Style::new().fg(theme::FORCE)));
        lines.push((force(&name(commanded), bearing, asked), plain));
    }
    let flags = track.flags(now).names().join(" ");
    lines.push((format!("flags {}", if flags.is_empty() { "none" } else { &flags }), plain));
    for sensor in 0..track.layout().sensors() {
        let [y, z] = [Channel::ReadingY, Channel::ReadingZ].map(|of| track.value(StepQuantity::Of(of, sensor), now));
        let [y, z, size] = [y, z, y.hypot(z)].map(|value| units.length.short(value, DIGITS));
        lines.push((row(&format!("{reads}{}", sensor + 1), [y, z, String::new(), String::new(), size]), plain));
    }
    let all = lines.len();
    lines.retain(|(line, _)| passes(view.filter, line));
    let names = [units.length, units.velocity, units.force].map(|unit| unit.name).join("  ");
    let names = if units.scales.is_some() { format!(" {names} ") } else { String::new() };
    let title = format!(
        " step at {} {names}{}",
        units.moment_told(track.tau(now), 8),
        filter_title(view.filter, lines.len(), all)
    );
    let inner = framed(Line::from(title), area, buffer);
    let rows = list.rows(lines.len(), inner.height, 0);
    for (y, (line, style)) in (inner.top()..inner.bottom()).zip(&lines[rows.clone()]) {
        write(buffer, inner, inner.left(), y, line, *style);
    }
    draw_overflow(&rows, lines.len(), area, buffer);
}

/// A row of the table: a name, and as many cells as there are headings, each with a blank in front of it.
fn row((first, width): (usize, usize), name: &str, cells: &[String; 5]) -> String {
    let cells: String = cells.iter().map(|cell| format!(" {cell:>width$}", width = width - 1)).collect();
    format!("{name:<first$}{cells}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use wire::Step;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn cells_stand_below_their_headings_and_never_touch() {
        let heading = row((NAME, WIDTH), "mass", &["y", "z", "vy", "vz", "radius"].map(str::to_owned));
        let cells = ["-1.49496", "-99999.9", "", "", "-1.0e-5"].map(str::to_owned);
        let cells = row((NAME, WIDTH), "u delivered", &cells);
        assert!(cells.contains(" -1.49496 ") && cells.contains(" -99999.9 "), "{cells}");
        for (name, cell) in [(" y", "-1.49496"), (" z", "-99999.9"), ("radius", "-1.0e-5")] {
            let [name_ends, cell_ends] =
                [(&heading, name), (&cells, cell)].map(|(row, what)| row.find(what).unwrap() + what.len());
            assert_eq!(name_ends, cell_ends, "{name}:\n{heading}\n{cells}");
        }
    }

    #[test]
    fn every_number_of_the_step_is_there() {
        let data = tests::frame_data();
        let frame = drawn(64, 13, |area, buffer| Raw::default().draw(&view(&data), area, buffer));
        insta::assert_snapshot!("raw", frame);
        let last = tests::state(3, 2999);
        for (mass, point) in last.points().enumerate() {
            for value in [point.y, point.z, point.radius()] {
                assert!(frame.contains(&short(value, DIGITS)), "mass {mass}: {value}\n{frame}");
            }
        }
        assert!(frame.contains("tau 29.99") && frame.contains("flags none"), "{frame}");
    }

    #[test]
    fn every_channel_of_the_table_that_is_a_number_is_shown() {
        // A value of its own for each, of three digits so that no other number has it.
        let mut state = tests::state(3, 0);
        let columns: Vec<_> = state.layout().number_columns().collect();
        for (at, column) in columns.iter().enumerate() {
            state = state.with(column.channel, column.index, 1000.0 + 7.0 * at as f64);
        }
        let mut feed = Feed::new("");
        let now = std::time::Instant::now();
        feed.push_step(&state, now);
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame = drawn(64, 13, |area, buffer| Raw::default().draw(&view(&data), area, buffer));
        for (at, column) in columns.iter().enumerate() {
            assert!(frame.contains(&format!(" {}", 1000 + 7 * at)), "{}:\n{frame}", column.name());
        }
    }

    #[test]
    fn the_force_of_each_control_bearing_is_in_newtons_of_its_own() {
        let data = tests::frame_data_of_two_bearings();
        let frame = drawn(70, 13, |area, buffer| Raw::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("54.0000") && frame.contains("108.000"), "{frame}");
    }

    #[test]
    fn flags_are_named_and_nothing_heard_is_nothing_shown() {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let empty = feed.frame_data(&ViewTime::LIVE, now);
        drawn(64, 10, |area, buffer| Raw::default().draw(&view(&empty), area, buffer));
        let flags = wire::message::Flags::contact(0b10) | wire::message::Flags::SATURATED;
        feed.push_step(&tests::state(3, 0).with_flags(flags), now);
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame = drawn(64, 13, |area, buffer| Raw::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("flags contact.2 saturated"), "{frame}");
    }
}
