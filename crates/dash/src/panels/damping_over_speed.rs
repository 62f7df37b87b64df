//! Minimum damping over speed for the gains in force: how far this tuning carries.
//!
//! ```text
//! ┌ damping over speed  stable 0 to 7.07 ─┐
//! │ .15  ⡠⠒⠢⡀    ┃                        │   curve: the least damped mode at each speed, by its colour
//! │    ⡜⢕⢕⢕⢕⠱⡀  ┃                        │   shaded: where all modes decay
//! │  ⡠⢪⢕⢕⢕⢕⢕⠈⠢⡀┃                        │   ┃ the present speed
//! │ 0 ⠉⠉⠉⠉⠉⠉⠉⠉⠉⠙⠓⠦⣄⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉ │
//! │ R 2.5  0.0512 stable          R 0 to 8 │
//! │ ? what if  0.0431 stable 0 to 6.1      │   dotted, while a value is being edited
//! └────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::text::{Line, Span};
use rotor::Scales;

use super::{framed, write, write_right};
use crate::analysis::{OverSpeed, Question};
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::screen::View;
use crate::theme;

/// What the panel shows.
#[derive(Clone, Copy, Debug)]
struct Facts<'a> {
    /// Of the settings in force.
    pub(crate) over_speed: &'a OverSpeed,
    /// The present speed, in units of `w0`.
    pub(crate) speed: f64,
    /// The minimum damping at that speed.
    pub(crate) min_damping: f64,
    /// What would be: its curve, once that is computed, its speed and its minimum damping there.
    pub(crate) candidate: Option<(Option<&'a OverSpeed>, f64, f64)>,
    /// Scales of an SI rotor: its speeds are shown in rpm.
    pub(crate) scales: Option<Scales>,
}

pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let known = view.picture.era.as_ref().filter(|era| !era.poles.is_empty());
    let asked = known.and_then(|era| Some((era, view.desk.over_speed(&Question::of(era)?)?)));
    let Some((era, over_speed)) = asked else {
        framed(Line::from(" damping over speed "), area, buffer);
        return;
    };
    let scales = era.rotor.as_ref().and_then(|rotor| rotor.scales().copied());
    let (speed, min_damping) = (era.settings.speed, era.min_damping);
    let would_be = view.what_if.and_then(|what_if| {
        let settings = &what_if.settings;
        let question = Question::at(era.rotor.clone()?, settings.feedback.clone(), settings.speed);
        Some((view.desk.over_speed_of_candidate(&question), settings.speed, what_if.min_damping))
    });
    let candidate = would_be.as_ref().map(|(over_speed, speed, damping)| (over_speed.as_deref(), *speed, *damping));
    draw_facts(&Facts { over_speed: &over_speed, speed, min_damping, candidate, scales }, area, buffer);
}

fn draw_facts(facts: &Facts<'_>, area: Rect, buffer: &mut Buffer) {
    let over_speed = facts.over_speed;
    let speed_of = |speed: f64| speed_text(speed, facts.scales);
    let (color, word) = theme::verdict(facts.min_damping);
    let title = vec![
        Span::raw(" damping over speed  "),
        Span::styled(
            stable_words(over_speed, facts.scales),
            theme::loud(if over_speed.stable.is_empty() { theme::BAD } else { theme::GOOD }),
        ),
        Span::raw(" "),
    ];
    let inner = framed(Line::from(title), area, buffer);
    let told = 1 + u16::from(facts.candidate.is_some());
    // The words below the plot matter more than the plot.
    let plotted = Rect { height: inner.height.saturating_sub(told), ..inner };
    draw_curves(facts, plotted, buffer);

    let unit = if facts.scales.is_some() { "rpm" } else { "R" };
    let foot = plotted.bottom();
    let now = format!("{unit} {}  {:.4} {word}", speed_of(facts.speed), facts.min_damping);
    write(buffer, inner, inner.left(), foot, &now, theme::loud(color));
    let range = format!("{unit} 0 to {}", speed_of(over_speed.top()));
    if now.len() + range.len() + 2 <= usize::from(inner.width) {
        write_right(buffer, inner, foot, &range, theme::quiet());
    }
    if let Some((candidate, _, min_damping)) = facts.candidate {
        let (color, word) = theme::verdict(min_damping);
        let range = candidate.map_or_else(|| "computing …".to_owned(), |curve| stable_words(curve, facts.scales));
        let would = format!("? {min_damping:.4} {word}  {range}");
        write(buffer, inner, inner.left(), foot + 1, &would, theme::loud(color));
    }
}

fn draw_curves(facts: &Facts<'_>, area: Rect, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    let over_speed = facts.over_speed;
    let would_be = facts.candidate.and_then(|(candidate, ..)| candidate);
    let all = would_be.iter().flat_map(|candidate| &candidate.min_damping).chain(&over_speed.min_damping);
    let [low, high] = all.fold([0.0, 0.0], |[low, high]: [f64; 2], d| [low.min(*d), high.max(*d)]);
    let high = if high > 0.0 { high } else { 0.05 };
    let top = nice_ceiling(1.05 * high);
    // How unstable it gets is of less interest than how stable: no more room for that.
    let bottom = -nice_ceiling(-1.05 * low).min(top);
    let bottom = if low < 0.0 { bottom } else { -0.1 * top };
    let mut plot = Plot::new(area, Window { x: [0.0, over_speed.top()], y: [bottom, top] });

    shade(over_speed, [bottom, top], area, &mut plot);
    plot.line([0.0, 0.0], [over_speed.top(), 0.0], theme::GRID);
    plot.line([facts.speed, bottom], [facts.speed, top], theme::CURSOR);
    if let Some((candidate, speed, _)) = facts.candidate {
        if let Some(candidate) = candidate {
            curve(candidate, |_| theme::CANDIDATE, true, &mut plot);
        }
        if speed != facts.speed {
            dotted_line(speed, [bottom, top], area, &mut plot);
        }
    }
    curve(over_speed, |damping| theme::verdict(damping).0, false, &mut plot);
    plot.paint(buffer);

    write(buffer, area, area.left(), area.top(), &short(top, 2), theme::quiet());
    if let Some((_, y)) = plot.cell(0.0, 0.0).filter(|(_, y)| *y > area.top()) {
        write(buffer, area, area.left(), y, "0", theme::quiet());
    }
    for (at, sign, color) in [
        Some((facts.speed, "◆", theme::verdict(facts.min_damping).0, facts.min_damping)),
        facts.candidate.map(|(_, speed, damping)| (speed, "◇", theme::CANDIDATE, damping)),
    ]
    .into_iter()
    .flatten()
    .filter_map(|(speed, sign, color, damping)| {
        Some((plot.cell(speed, damping.clamp(bottom + 1e-9 * top, top * (1.0 - 1e-9)))?, sign, color))
    }) {
        write(buffer, area, at.0, at.1, sign, theme::loud(color));
    }
}

/// Every fourth dot between the curve and zero, over the speeds at which all modes decay.
fn shade(over_speed: &OverSpeed, [bottom, top]: [f64; 2], area: Rect, plot: &mut Plot) {
    let (columns, rows) = (usize::from(area.width) * 2, usize::from(area.height) * 4);
    for column in 0..columns {
        let speed = (column as f64 + 0.5) / columns as f64 * over_speed.top();
        if !over_speed.stable.iter().any(|[from, to]| (*from..=*to).contains(&speed)) {
            continue;
        }
        let below = over_speed.near(speed);
        // On a fixed raster, so that shades of different heights match.
        for row in (0..rows).filter(|row| (column + 2 * row).is_multiple_of(4)) {
            let damping = top - (row as f64 + 0.5) / rows as f64 * (top - bottom);
            if damping > 0.0 && damping < below {
                plot.dot(speed, damping, theme::GRID);
            }
        }
    }
}

fn curve(over_speed: &OverSpeed, color: impl Fn(f64) -> Color, dotted: bool, plot: &mut Plot) {
    let points = over_speed.speeds.iter().zip(&over_speed.min_damping);
    let points: Vec<[f64; 2]> = points.map(|(speed, damping)| [*speed, *damping]).collect();
    for (at, pair) in points.windows(2).enumerate() {
        if !dotted || at % 4 < 2 {
            plot.line(pair[0], pair[1], color(pair[1][1]));
        }
    }
}

fn dotted_line(speed: f64, [bottom, top]: [f64; 2], area: Rect, plot: &mut Plot) {
    let dots = usize::from(area.height) * 4;
    for dot in (0..dots).step_by(2) {
        plot.dot(speed, bottom + (dot as f64 + 0.5) / dots as f64 * (top - bottom), theme::CANDIDATE);
    }
}

/// A speed as people read it: `R`, or rpm for a rotor in SI units.
pub(crate) fn speed_text(speed: f64, scales: Option<Scales>) -> String {
    match scales {
        Some(scales) => format!("{:.0}", scales.rpm(speed)),
        None => format!("{}", (speed * 1000.0).round() / 1000.0),
    }
}

/// Where all modes decay, in words.
fn stable_words(over_speed: &OverSpeed, scales: Option<Scales>) -> String {
    let ranges: Vec<String> = over_speed
        .stable
        .iter()
        .map(|[from, to]| format!("{} to {}", speed_text(*from, scales), speed_text(*to, scales)))
        .collect();
    match ranges.len() {
        0 => "UNSTABLE throughout".to_owned(),
        _ => format!("stable {}", ranges.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::tests::over_speed;
    use crate::panels::tests::drawn;

    fn frame(facts: &Facts<'_>, width: u16, height: u16) -> String {
        drawn(width, height, |area, buffer| draw_facts(facts, area, buffer))
    }

    #[test]
    fn the_stable_range_is_shaded_and_told_and_the_speed_is_marked() {
        let composite = over_speed("three-mass", "composite");
        let facts =
            Facts { over_speed: &composite, speed: 2.5, min_damping: composite.at(2.5), candidate: None, scales: None };
        insta::assert_snapshot!("damping_over_speed", frame(&facts, 60, 14));
        insta::assert_snapshot!("damping_over_speed_small", frame(&facts, 30, 6));
        insta::assert_snapshot!("damping_over_speed_large", frame(&facts, 120, 30));
        assert!(frame(&facts, 60, 14).contains("stable 0 to 7.0"));
        let picture = crate::feed::tests::picture();
        let drawn = drawn(60, 14, |area, buffer| draw(&crate::screen::tests::view(&picture), area, buffer));
        assert_eq!(drawn, frame(&facts, 60, 14));
    }

    #[test]
    fn a_candidate_that_would_be_unstable_says_so_in_words() {
        let (now, off) = (over_speed("three-mass", "composite"), over_speed("three-mass", "off"));
        let candidate = Some((Some(&off), 2.5, off.at(2.5)));
        let facts = Facts { over_speed: &now, speed: 2.5, min_damping: now.at(2.5), candidate, scales: None };
        let frame = frame(&facts, 60, 14);
        assert!(frame.contains("UNSTABLE  stable 0 to 1.776"), "{frame}");
        assert!(frame.contains('◆') && frame.contains('◇'), "{frame}");
        insta::assert_snapshot!("damping_over_speed_candidate", frame);
        let facts = Facts { candidate: Some((None, 2.5, off.at(2.5))), ..facts };
        let frame = drawn(60, 16, |area, buffer| draw_facts(&facts, area, buffer));
        assert!(frame.contains("UNSTABLE  computing …"), "{frame}");
    }

    #[test]
    fn rotors_in_si_units_have_rpm() {
        let now = over_speed("jeffcott", "off");
        let scales = Scales { w0: 100.0, k_t: 1e6, m_t: 100.0, e_t: 1e-5 };
        let facts =
            Facts { over_speed: &now, speed: 1.0, min_damping: now.at(1.0), candidate: None, scales: Some(scales) };
        let frame = frame(&facts, 60, 10);
        // 2.209975 w0, in turns a minute.
        assert!(frame.contains("stable 0 to 2110") && frame.contains("rpm 955"), "{frame}");
    }
}
