//! Every number of one step, as it came.
//!
//! ```text
//! ┌ step at tau 29.99 ────────────────────────┐
//! │ R 2.5   angle 74.975 rad   turn 11         │
//! │ mass        y        z       vy       vz  radius │
//! │    1   1.2345  -0.5432 ...                 │
//! │ u delivered  0.8000 -0.0123   |u| 0.8001   │
//! │ u commanded  0.8000 -0.0123                │
//! │ flags contact.1                            │
//! └────────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;

use super::list::{List, mark, passes, told};
use super::panel::Panel;
use super::{framed, write};
use crate::plot::short;
use crate::theme;
use crate::units::Unit;
use crate::view::View;

/// Digits of a number, and the width of its column.
const DIGITS: usize = 6;
const WIDTH: usize = 10;

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
    let (track, Some(now)) = (&view.picture.track, view.picture.now) else {
        framed(Line::from(" step "), area, buffer);
        return;
    };
    let units = view.picture.units();
    let numbers = |unit: &Unit, values: &[f64]| -> String {
        values.iter().map(|value| format!("{:>WIDTH$}", unit.short(*value, DIGITS))).collect()
    };
    let speed = match units.scales {
        Some(_) => units.speed.told(track.speed(now), DIGITS),
        None => format!("R {}", short(track.speed(now), DIGITS)),
    };
    let (angle, plain) = (track.angle(now), Style::new());
    let turns = (angle / std::f64::consts::TAU).floor();
    let mut lines = vec![
        (format!("{speed}  angle {} rad  turn {turns}", short(angle, 8)), plain),
        (format!("mass{:>7}{:>WIDTH$}{:>WIDTH$}{:>WIDTH$}{:>WIDTH$}", "y", "z", "vy", "vz", "radius"), theme::quiet()),
    ];
    for mass in 0..view.picture.masses() {
        let ([y, z], [vy, vz]) = (track.place(now, mass), track.velocity(now, mass));
        let parts = [(&units.length, [y, z]), (&units.velocity, [vy, vz])].map(|(unit, pair)| numbers(unit, &pair));
        let row = format!("{:>3}{}{}", mass + 1, &parts.concat()[2..], numbers(&units.length, &[y.hypot(z)]));
        lines.push((row, Style::new().fg(theme::TRACES[mass % theme::TRACES.len()])));
    }
    let ([y, z], [cy, cz]) = (track.force(now), track.commanded(now));
    lines.push((format!("u delivered {}", numbers(&units.force, &[y, z, y.hypot(z)])), Style::new().fg(theme::FORCE)));
    lines.push((format!("u commanded {}", numbers(&units.force, &[cy, cz, cy.hypot(cz)])), plain));
    let flags = track.flags(now).names().join(" ");
    lines.push((format!("flags {}", if flags.is_empty() { "none" } else { &flags }), plain));
    let all = lines.len();
    lines.retain(|(line, _)| passes(view.filter, line));
    let names = [units.length, units.velocity, units.force].map(|unit| unit.name).join("  ");
    let names = if units.scales.is_some() { format!(" {names} ") } else { String::new() };
    let title = format!(" step at tau {} {names}{}", short(track.tau(now), 8), told(view.filter, lines.len(), all));
    let inner = framed(Line::from(title), area, buffer);
    let rows = list.rows(lines.len(), inner.height, 0);
    for (y, (line, style)) in (inner.top()..inner.bottom()).zip(&lines[rows.clone()]) {
        write(buffer, inner, inner.left(), y, line, *style);
    }
    mark(&rows, lines.len(), area, buffer);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::{Feed, tests};
    use crate::panels::tests::drawn;
    use crate::view::tests::view;
    use crate::view_time::ViewTime;

    #[test]
    fn every_number_of_the_step_is_there() {
        let picture = tests::picture();
        let frame = drawn(64, 10, |area, buffer| Raw::default().draw(&view(&picture), area, buffer));
        insta::assert_snapshot!("raw", frame);
        let last = tests::state(3, 2999);
        for (mass, point) in last.points().iter().enumerate() {
            for value in [point.y, point.z, point.radius()] {
                assert!(frame.contains(&short(value, DIGITS)), "mass {mass}: {value}\n{frame}");
            }
        }
        assert!(frame.contains("tau 29.99") && frame.contains("flags none"), "{frame}");
    }

    #[test]
    fn flags_are_named_and_nothing_heard_is_nothing_shown() {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let empty = feed.picture(&ViewTime::LIVE, now);
        drawn(64, 10, |area, buffer| Raw::default().draw(&view(&empty), area, buffer));
        let flags = wire::message::Flags::contact(0b10) | wire::message::Flags::SATURATED;
        feed.hear(&wire::State { flags, ..tests::state(3, 0) }, now);
        let picture = feed.picture(&ViewTime::LIVE, now);
        let frame = drawn(64, 10, |area, buffer| Raw::default().draw(&view(&picture), area, buffer));
        assert!(frame.contains("flags contact.2 saturated"), "{frame}");
    }
}
