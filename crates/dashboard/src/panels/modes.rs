//! The modes in a table, the least damped first.
//!
//! ```text
//! ┌ modes at R 2.5 ────────────────────────────────────────────┐
//! │   damping  log dec  frequency      /R  whirl     shape      │
//! │◆▲  0.0535   0.3363     2.2692   0.908  forward   1.00   0°  │   the largest mass is 1 at 0 degrees
//! │ ▼  0.0812   0.5117     1.0330   0.413  backward  0.61 -12°  │
//! └────────────────────────────────────────────────────────────┘
//! ```
//!
//! Of a shaft, where there is room, the mode that is pointed at stands below, bent and turning slowly; without one, the least damped of those
//! that count.

use std::sync::Arc;

use machine::{CountedModes, MachinePoles};
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use rotor::{C64, Mode, Whirl};

use super::bent_shaft;
use super::panel::{Panel, PanelRequest};
use crate::drawing::{framed, write};
use crate::input::Mouse;
use crate::list::{List, draw_overflow, filter_title, passes, row_of};
use crate::selection::SelectedItem;
use crate::theme;
use crate::view::View;
use telemetry::history::Era;
use telemetry::units::ScreenUnits;
use text::number::short;

/// Columns before the shape: heading, and width in cells.
const COLUMNS: [(&str, u16); 5] = [("damping", 9), ("log dec", 9), ("frequency", 11), ("/R", 8), ("whirl", 10)];
/// Width of the signs at the left.
const SIGNS: u16 = 2;
/// Width of one mass's part of a shape.
const PART: u16 = 12;
/// Rows below the heading, half of which a bent shaft may have.
const ROOM_FOR_SHAFT: u16 = 14;

/// The table; it keeps the modes of the settings that it last drew. A click points at a mode.
#[derive(Debug, Default)]
pub(crate) struct Modes {
    known: Option<(Arc<Era>, Vec<Mode>)>,
    list: List,
    /// The ranks of the modes in the rows that were last drawn, below the heading.
    drawn: Vec<usize>,
}

impl Panel for Modes {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let Some(era) = view.data.era.as_ref().filter(|era| !era.poles.is_empty()) else {
            framed(Line::from(" modes "), area, buffer);
            return;
        };
        let speed = era.settings.speed;
        let units = view.data.units();
        if self.known.as_ref().is_none_or(|(of, _)| !Arc::ptr_eq(of, era)) {
            self.known = Some((era.clone(), modes(era)));
        }
        let modes = self.known.as_ref().map_or(&[][..], |(_, modes)| modes);
        let words = |mode: &Mode| cells(mode, speed, &units).join(" ");
        let shown: Vec<(usize, &Mode)> =
            modes.iter().enumerate().filter(|(_, mode)| passes(view.filter, &words(mode))).collect();
        let title =
            format!(" modes at {} {}", units.speed_told(speed), filter_title(view.filter, shown.len(), modes.len()));
        let inner = framed(Line::from(title), area, buffer);
        heading(&units, inner, buffer);
        let mut below = Rect { y: inner.y + 1, height: inner.height.saturating_sub(1), ..inner };
        let shaft = era.rotor.as_ref().filter(|rotor| !rotor.is_chain() && below.height >= ROOM_FOR_SHAFT);
        if let Some(rotor) = shaft {
            let rows = below.height / 2;
            let shaft = Rect { y: below.bottom() - rows, height: rows, ..below };
            below.height -= rows;
            if let Some(mode) = pointed_at(view, modes, speed) {
                let words = format!(
                    "{} at {} {}",
                    mode.whirl(),
                    units.frequency.short(mode.frequency(), 4),
                    units.frequency.name
                );
                write(buffer, shaft, shaft.x, shaft.y, &words, theme::quiet());
                let step = view.data.now.map_or(0, |now| view.data.track.index_of(now));
                let drawn = Rect { y: shaft.y + 1, height: shaft.height - 1, ..shaft };
                bent_shaft::draw(rotor, mode, step as f64 * view.data.seconds, drawn, buffer);
            }
        }
        let rows = self.list.rows(shown.len(), below.height, 0);
        for (y, (rank, mode)) in (below.y..).zip(&shown[rows.clone()]) {
            let place = Rect { y, height: 1, ..below };
            row(mode, *rank == 0, (speed, &units), place, buffer);
            if view.selection.mode.is_some_and(|pole| is_same(pole, mode)) {
                write(buffer, place, place.x, y, "◈", theme::loud(theme::CURSOR));
                buffer.set_style(place, Style::new().add_modifier(Modifier::UNDERLINED));
            }
        }
        draw_overflow(&rows, shown.len(), area, buffer);
        self.drawn.clear();
        self.drawn.extend(shown[rows].iter().map(|(rank, _)| *rank));
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.scroll(3 * notches as isize);
        }
        let rank = *self.drawn.get(row_of(area, at)?.checked_sub(1)?).filter(|_| mouse == Mouse::Click)?;
        let (_, poles) = view.data.poles()?;
        Some(PanelRequest::Select(SelectedItem::Mode(*poles.get(rank)?)))
    }

    fn scroll(&mut self, rows: isize) {
        self.list.scroll(rows);
    }
}

/// The analysis here and that of the simulation differ in their last digits.
fn is_same(pole: C64, mode: &Mode) -> bool {
    (pole - mode.pole).norm() <= 1e-9 * (1.0 + pole.norm())
}

/// The mode that is selected; without one the least damped of those that whirl and count.
fn pointed_at<'a>(view: &View<'_>, modes: &'a [Mode], speed: f64) -> Option<&'a Mode> {
    let selected = view.selection.mode.and_then(|pole| modes.iter().find(|mode| is_same(pole, mode)));
    let counted = CountedModes::usual_among(modes.iter().map(|mode| mode.pole), speed);
    selected.or_else(|| modes.iter().find(|mode| mode.frequency() > 0.0 && counted.counts(mode.pole)))
}

/// The modes of some settings; only the poles that the simulation sent if their shapes cannot be had.
fn modes(era: &Era) -> Vec<Mode> {
    let shaped = era.rotor.as_ref().and_then(|rotor| MachinePoles::of(rotor, &era.settings).ok());
    let bare = || era.poles.iter().map(|pole| Mode { pole: *pole, shape: Vec::new() }).collect();
    shaped.map_or_else(bare, |poles| poles.modes)
}

fn heading(units: &ScreenUnits, area: Rect, buffer: &mut Buffer) {
    let mut x = area.x + SIGNS;
    for (name, width) in COLUMNS {
        let name = if name == "frequency" && units.scales.is_some() { "freq. Hz" } else { name };
        let text =
            if name == "whirl" { format!("  {name}") } else { format!("{name:>width$}", width = usize::from(width)) };
        write(buffer, area, x, area.y, &text, theme::quiet());
        x += width;
    }
    write(buffer, area, x, area.y, "  shape, by mass", theme::quiet());
}

/// What stands in the columns before the shape.
fn cells(mode: &Mode, speed: f64, units: &ScreenUnits) -> [String; 5] {
    let ratio = if speed > 0.0 { short(mode.frequency() / speed, 4) } else { "-".into() };
    [
        format!("{:.4}", mode.damping()),
        short(mode.log_decrement(), 5),
        units.frequency.short(mode.frequency(), 5),
        ratio,
        format!("  {}", mode.whirl()),
    ]
}

fn row(mode: &Mode, least: bool, (speed, units): (f64, &ScreenUnits), area: Rect, buffer: &mut Buffer) {
    let (sign, color) = match mode.whirl() {
        Whirl::Forward => ("▲", theme::FORWARD),
        Whirl::Backward => ("▼", theme::BACKWARD),
    };
    let (verdict, _) = theme::verdict(mode.damping());
    if least {
        write(buffer, area, area.x, area.y, "◆", theme::loud(verdict));
    }
    write(buffer, area, area.x + 1, area.y, sign, theme::loud(color));
    let cells = cells(mode, speed, units);
    let plain = if least { theme::loud(verdict) } else { Style::new() };
    let mut x = area.x + SIGNS;
    for ((name, width), text) in COLUMNS.into_iter().zip(cells) {
        let text = if name == "whirl" { text } else { format!("{text:>width$}", width = usize::from(width)) };
        // What goes wrong is told in its colour even where it is not the worst.
        let style = if name == "damping" { theme::loud(verdict) } else { plain };
        write(buffer, area, x, area.y, &text, style);
        x += width;
    }
    for part in &mode.shape {
        // Half a number would mislead.
        if x + PART > area.right() {
            write(buffer, area, x, area.y, " …", theme::quiet());
            break;
        }
        write(buffer, area, x, area.y, &part_text(*part), plain);
        x += PART;
    }
}

/// Size and phase of one mass in a shape.
fn part_text(part: C64) -> String {
    let degrees = part.arg().to_degrees().round();
    // -180 and 180 are the same; so are 0 and -0.
    let degrees = if degrees <= -180.0 { 180.0 } else { degrees + 0.0 };
    format!("{:>6.2} {degrees:>4.0}°", part.norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    fn frame(data: &FrameData, width: u16, height: u16) -> String {
        drawn(width, height, |area, buffer| Modes::default().draw(&view(data), area, buffer))
    }

    #[test]
    fn the_least_damped_mode_is_first_and_marked() {
        let data = tests::frame_data();
        let frame_of = |width, height| frame(&data, width, height);
        let frame = frame_of(96, 10);
        let rows: Vec<&str> = frame.lines().collect();
        let least = format!("{:.4}", data.era.as_ref().unwrap().min_damping);
        assert!(rows[2].starts_with("│◆") && rows[2].contains(&least), "{frame}");
        assert_eq!(frame.matches('◆').count(), 1);
        assert_eq!(frame.matches("forward").count() + frame.matches("backward").count(), 6);
        insta::assert_snapshot!("modes", frame);
        insta::assert_snapshot!("modes_small", frame_of(40, 6));
        insta::assert_snapshot!("modes_large", frame_of(140, 20));
    }

    /// The report's shapes at the thresholds: bounce, pitch and flexible, section 4.3.
    #[test]
    fn val_shapes_are_those_of_the_report() {
        let shape_at = |speed: f64| {
            let mut bench_status = tests::bench_status("three-mass", "off");
            let mut settings = bench_status.settings.get().clone();
            settings.speed = speed;
            bench_status.settings = wire::SettingsDocument::of(&settings);
            let mut feed = Feed::new("");
            feed.push_bench_status(bench_status);
            feed.push_step(&tests::state(3, 0), std::time::Instant::now());
            let data = feed.frame_data(&ViewTime::LIVE, std::time::Instant::now());
            // The mode on its threshold is the one next to zero damping.
            let modes = modes(data.era.as_ref().unwrap());
            let critical = modes.iter().min_by(|a, b| a.damping().abs().total_cmp(&b.damping().abs())).unwrap();
            [0, 1, 2].map(|mass| critical.shape[mass].re)
        };
        for (speed, shape) in
            [(1.775_522, [0.606, 1.0, 0.606]), (4.101_250, [1.0, 0.0, -1.0]), (4.650_456, [1.0, -0.587, 1.0])]
        {
            for (found, expected) in shape_at(speed).into_iter().zip(shape) {
                assert!((found - expected).abs() < 1e-3, "at {speed}: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn nothing_known_is_an_empty_table() {
        let empty = Feed::new("waiting").frame_data(&ViewTime::LIVE, std::time::Instant::now());
        assert!(frame(&empty, 40, 5).contains(" modes "));
    }
}
