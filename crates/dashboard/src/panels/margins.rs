//! The margins of the loop at the speed of the moment, large where there is room, and beside them those of what would be.
//!
//! ```text
//! ┌ margins  R 6 ─────────────────────────┐
//! │ delay margin      gain up to          │
//! │ ▛▀▌  ▐▖ ▐▖ ▝▀▌    ▐▖  ▐▖ ▐▖           │
//! │ ▙▄▌▗ ▐▌ ▐▌  ▐     ▐▌▗ ▐▌ ▐▌           │
//! │             now          would be     │
//! │ delay       0.1128 tau   0.2322 tau   │   what delay more it bears
//! │ gain up     x 1.119      any to x 100 │   factors on the gain at which it is unstable
//! │ gain down   x 0.8159     x 0.3804     │
//! │ phase       7.463 deg    49.64 deg    │
//! │ |S| peak    10.35 D      1.192 A      │   with its zone by ISO 14839-3
//! └───────────────────────────────────────┘
//! ```

use machine::{MachineMargins, STRONGEST_LATE};
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::text::Line;
use ratatui::widgets::Widget;
use telemetry::jobs::LoopAnalysis;
use telemetry::jobs::loop_analysis::{ISO_14839_3, sensitivity_zone};
use telemetry::units::ScreenUnits;
use text::number::short;
use tui_big_text::{BigText, PixelSize};

use super::loop_in_view::{LoopInView, why_none};
use crate::drawing::{framed, write};
use crate::fit_text::width;
use crate::theme;
use crate::view::View;

/// Height of a large number with the words above it, and width of the widest with what is left free beside it, in cells.
const LARGE: (u16, u16) = (5, 22);
/// Rows of the table, with its heading.
const ROWS: u16 = 6;
/// Columns of the table: the name, and each value.
const COLUMNS: [u16; 2] = [11, 14];

/// One of the margins.
struct MarginRow {
    name: &'static str,
    /// In large: above the number.
    caption: &'static str,
    /// The number alone.
    number: String,
    /// The number with what it is counted in.
    value: String,
    frequency: Option<f64>,
    color: Option<Color>,
}

fn rows(found: &MachineMargins, units: &ScreenUnits) -> [MarginRow; 5] {
    let margins = &found.margins;
    // No such crossing: any delay will do, or any gain that is smaller.
    let any = || ["any".to_owned(), "any".to_owned()];
    // A larger one, as far as is looked.
    let far = || [format!(">{STRONGEST_LATE}"), format!("any to x {STRONGEST_LATE}")];
    let row = |name, caption, [number, value]: [String; 2], frequency| MarginRow {
        name,
        caption,
        number,
        value,
        frequency,
        color: None,
    };
    let times = |factor: f64| [short(factor, 4), format!("x {}", short(factor, 4))];
    let delay = margins.delay.map_or_else(any, |d| [short(d.delay, 4), units.time_told(d.delay, 4)]);
    let peak = margins.sensitivity();
    let zone = sensitivity_zone(peak.amplitude, ISO_14839_3);
    let told = [short(peak.amplitude, 4), format!("{} {zone}", short(peak.amplitude, 4))];
    let phase = margins.phase.map_or_else(any, |p| {
        let degrees = short(p.angle.to_degrees(), 4);
        [degrees.clone(), format!("{degrees} deg")]
    });
    [
        row("delay", "delay margin", delay, margins.delay.map(|d| d.frequency)),
        row(
            "gain up",
            "gain up to x",
            margins.gain_up.map_or_else(far, |g| times(g.factor)),
            margins.gain_up.map(|g| g.frequency),
        ),
        row(
            "gain down",
            "gain down to x",
            margins.gain_down.map_or_else(any, |g| times(g.factor)),
            margins.gain_down.map(|g| g.frequency),
        ),
        row("phase", "phase, degrees", phase, margins.phase.map(|p| p.frequency)),
        MarginRow {
            color: Some(theme::sensitivity(peak.amplitude)),
            ..row("|S| peak", "peak of |S|", told, peak.frequency)
        },
    ]
}

/// Draws the panel.
pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let units = view.data.units();
    let facts = LoopInView::of(view);
    let title = match &facts {
        Some(facts) => format!(" margins  {} ", units.speed_told(facts.speed)),
        None => " margins ".to_owned(),
    };
    let inner = framed(Line::from(title), area, buffer);
    let Some(facts) = facts else { return };
    let now = match &facts.now.margins {
        Ok(found) => rows(found, &units),
        Err(error) => {
            let told = format!("{}, no margins", why_none(error, &units));
            write(buffer, inner, inner.left(), inner.top(), &told, theme::loud(theme::BAD));
            if let Some(candidate) = &facts.candidate {
                let below = Rect { y: inner.y + 1, height: inner.height.saturating_sub(1), ..inner };
                draw_alone(candidate, &units, below, buffer);
            }
            return;
        }
    };
    let longest = now.iter().map(|row| width(&row.value) as u16 + 2).fold(COLUMNS[1], u16::max);
    let table = match place_of_large(inner, COLUMNS[0] + 2 * longest) {
        Some((large, table)) => {
            draw_large(&now, large, buffer);
            table
        }
        None => inner,
    };
    let beside = facts.candidate.as_ref().map(|candidate| match &candidate.margins {
        Ok(found) => rows(found, &units).map(|row| (row.value, row.color)).to_vec(),
        Err(_) => vec![("UNSTABLE".to_owned(), Some(theme::BAD))],
    });
    draw_table(&now, beside.as_deref(), &units, table, buffer);
}

/// Where the large numbers go, and the table then: above it, or right of it where there is no room above; nowhere in a small panel.
fn place_of_large(area: Rect, table: u16) -> Option<(Rect, Rect)> {
    let (height, width) = LARGE;
    if area.height >= height + ROWS {
        let [large, below] = Layout::vertical([Constraint::Length(height), Constraint::Fill(1)]).areas(area);
        Some((large, below))
    } else if area.height >= height && area.width >= table + width {
        let [left, right] = Layout::horizontal([Constraint::Length(table), Constraint::Fill(1)]).areas(area);
        Some((Rect { height, ..right }, left))
    } else {
        None
    }
}

/// The margins of what would be, where what is has none.
fn draw_alone(candidate: &LoopAnalysis, units: &ScreenUnits, area: Rect, buffer: &mut Buffer) {
    match &candidate.margins {
        Ok(found) => draw_table(&rows(found, units), None, units, area, buffer),
        Err(error) => {
            let told = format!("? {}", why_none(error, units));
            write(buffer, area, area.left(), area.top(), &told, theme::loud(theme::BAD));
        }
    }
}

/// As many as have room, the most telling first.
fn draw_large(rows: &[MarginRow; 5], area: Rect, buffer: &mut Buffer) {
    let order = [&rows[0], &rows[4], &rows[1], &rows[2], &rows[3]];
    let count = usize::from(area.width / LARGE.1).min(order.len());
    let wide = area.width / u16::try_from(count.max(1)).unwrap_or(1);
    for (row, x) in order.into_iter().take(count).zip((area.left()..).step_by(usize::from(wide.max(1)))) {
        let place = Rect { x, width: wide, ..area };
        let style = row.color.map_or_else(Style::new, theme::loud);
        write(buffer, place, x, area.top(), row.caption, theme::quiet());
        let number = Rect { y: area.top() + 1, height: area.height - 1, ..place };
        BigText::builder()
            .pixel_size(PixelSize::Quadrant)
            .style(style)
            .lines([Line::from(row.number.clone())])
            .build()
            .render(number, buffer);
    }
}

fn draw_table(
    rows: &[MarginRow; 5],
    beside: Option<&[(String, Option<Color>)]>,
    units: &ScreenUnits,
    area: Rect,
    buffer: &mut Buffer,
) {
    let [names, values] = COLUMNS;
    let lines: Vec<Rect> = area.rows().collect();
    let Some(heading) = lines.first() else { return };
    // The heading goes where there is no room for it and nothing stands beside.
    let headed = usize::from(beside.is_some() || lines.len() > rows.len());
    let right = area.left() + names + values;
    if headed > 0 {
        write(buffer, *heading, area.left() + names, heading.y, "now", theme::quiet());
        let other = if beside.is_some() { "would be" } else { "at" };
        write(buffer, *heading, right, heading.y, other, theme::quiet());
    }
    for (at, (row, line)) in rows.iter().zip(lines.into_iter().skip(headed)).enumerate() {
        write(buffer, line, line.x, line.y, row.name, theme::quiet());
        let style = row.color.map_or_else(Style::new, theme::loud);
        let end = write(buffer, line, line.x + names, line.y, &row.value, style);
        let from = right.max(end + 2);
        match beside {
            Some(beside) => {
                if let Some((value, color)) = beside.get(at) {
                    let style = theme::loud(color.unwrap_or(theme::CANDIDATE));
                    write(buffer, line, from, line.y, value, style);
                }
            }
            None => {
                let told = row.frequency.map(|frequency| units.frequency.told(frequency, 4)).unwrap_or_default();
                // Whole or not at all.
                if from + width(&told) as u16 <= line.right() {
                    write(buffer, line, from, line.y, &told, theme::quiet());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::what_if::WhatIf;

    fn at_six() -> FrameData {
        let mut data = tests::frame_data();
        let era = data.era.as_ref().unwrap().at_speed(6.0);
        data.era = era.map(Arc::new);
        data
    }

    #[test]
    fn val_the_report_s_composite_gains_have_the_margins_that_python_control_finds() {
        let data = at_six();
        let frame = drawn(60, 8, |area, buffer| draw(&view(&data), area, buffer));
        for told in ["margins  R 6", "0.113 tau", "x 1.119", "x 0.816", "7.463 deg", "10.35 D", "2.270 w0"] {
            assert!(frame.contains(told), "{told}:\n{frame}");
        }
        insta::assert_snapshot!("margins", frame);
        insta::assert_snapshot!("margins_large", drawn(110, 13, |area, buffer| draw(&view(&data), area, buffer)));
        // As wide and as low as the layout `loop` has it at 200 x 60 and 120 x 40.
        insta::assert_snapshot!("margins_beside", drawn(152, 12, |area, buffer| draw(&view(&data), area, buffer)));
        insta::assert_snapshot!("margins_beside_narrow", drawn(90, 9, |area, buffer| draw(&view(&data), area, buffer)));
    }

    #[test]
    fn what_would_be_stands_beside_and_no_margins_are_said() {
        let data = at_six();
        let (rotor, mut settings) = (data.rotor.clone().unwrap(), data.settings.clone().unwrap());
        settings.speed = 6.0;
        settings.feedback = rotor::builtin::feedback(&rotor, "individual").unwrap();
        let what_if = WhatIf::of(&rotor, settings.clone());
        let frame = drawn(60, 8, |area, buffer| {
            draw(&View { what_if: what_if.as_ref(), ..view(&data) }, area, buffer);
        });
        for told in ["would be", "0.232 tau", "any", "x 0.380", "49.64 deg", "1.192 A"] {
            assert!(frame.contains(told), "{told}:\n{frame}");
        }
        settings.feedback = settings.feedback.off();
        let off = WhatIf::of(&rotor, settings);
        let frame = drawn(60, 8, |area, buffer| {
            draw(&View { what_if: off.as_ref(), ..view(&data) }, area, buffer);
        });
        assert!(frame.contains("UNSTABLE") && frame.contains("10.35 D"), "{frame}");
        let mut late = at_six();
        let mut era = (**late.era.as_ref().unwrap()).clone();
        era.settings.feedback.bearings[0].parts.delay = 0.2;
        late.era = Some(Arc::new(era));
        let frame = drawn(60, 8, |area, buffer| {
            draw(&View { what_if: what_if.as_ref(), ..view(&late) }, area, buffer);
        });
        assert!(frame.contains("no margins") && frame.contains("1.192 A"), "{frame}");
    }
}
