//! Minimum damping over speed for the gains in force: how far this tuning carries.
//!
//! ```text
//! ┌ damping over speed  stable 0 to 7.07 ─┐
//! │ .15  ⡠⠒⠢⡀    ┃                        │   curve: the least damped mode at each speed, by its colour
//! │    ⡜⢕⢕⢕⢕⠱⡀  ┃                        │   shaded: where all modes decay
//! │  ⡠⢪⢕⢕⢕⢕⢕⠈⠢⡀┃                        │   ┃ the present speed
//! │ 0 ⠉⠉⠉⠉⠉⠉⠉⠉⠉⠙⠓⠦⣄⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉ │
//! │ R 2.5  0.0512 stable          R 0 to 8 │   or what it is at a speed that is pointed at: ┆ R 4  0.0401 stable
//! │ ? what if  0.0431 stable 0 to 6.1      │   dotted, while a value is being edited
//! └────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::style::Color;
use ratatui::text::{Line, Span};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::wheel_times;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_free, write_right};
use crate::fit_text::{longest, width};
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::selection::ReadoutMove;
use crate::selection::SelectedItem;
use crate::theme;
use crate::ticks;
use crate::view::View;
use telemetry::jobs::{PoleTrace, PoleTraceRequest};
use telemetry::units::ScreenUnits;
use text::number::{neat, nice_ceiling};

/// What the panel shows.
#[derive(Clone, Copy, Debug)]
struct Facts<'a> {
    /// Of the settings in force.
    pub(crate) pole_trace: &'a PoleTrace,
    /// The present speed, in units of `w0`.
    pub(crate) speed: f64,
    /// The minimum damping at that speed.
    pub(crate) min_damping: f64,
    /// What would be: its curve, once that is computed, its speed and its minimum damping there.
    pub(crate) candidate: Option<(Option<&'a PoleTrace>, f64, f64)>,
    /// A speed that is pointed at.
    pub(crate) selection: Option<f64>,
    pub(crate) units: ScreenUnits,
}

/// The panel: a click points at a speed, the wheel shows more or fewer of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct DampingOverSpeed {
    /// Speeds, as they stand on the axis.
    along: PlotAxis,
    value: PlotAxis,
    /// The speeds that were last shown, in units of `w0`, and over how many columns.
    shown: Option<([f64; 2], u16)>,
}

impl Panel for DampingOverSpeed {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, self, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        let inner = area.inner(Margin::new(1, 1));
        let ([low, high], _) = self.shown?;
        let along = (f64::from(at.x.checked_sub(inner.x)?) + 0.5) / f64::from(inner.width);
        let speed = low + along * (high - low);
        match mouse {
            Mouse::Wheel(notches) => {
                self.along.zoom(wheel_times(notches), Some(speed * view.data.units().speed.factor));
                None
            }
            Mouse::Click | Mouse::Drag(_) => {
                inner.contains(at).then_some(PanelRequest::Select(SelectedItem::Speed(speed)))
            }
        }
    }

    fn told_at(&self, view: &View<'_>, area: Rect, at: Position) -> Option<String> {
        let inner = area.inner(Margin::new(1, 1));
        let ([low, high], _) = self.shown.filter(|_| inner.contains(at))?;
        let speed = low + (f64::from(at.x - inner.x) + 0.5) / f64::from(inner.width) * (high - low);
        let pole_trace = view.jobs.pole_trace(&PoleTraceRequest::of(view.data.era.as_ref()?)?)?;
        let damping = pole_trace.min_damping_near(speed);
        let word = theme::verdict(damping).1;
        Some(format!("{}  minimum damping {damping:.4} {word}", view.data.units().speed_told(speed)))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => Some(self.value.take(*scalings.first()?, None)),
            PanelCommand::Along(scaling, _) => Some(self.along.take(*scaling, None)),
            _ => None,
        }
    }

    fn read(&mut self, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        let ([low, high], columns) = self.shown?;
        let before = view.selection.speed;
        let speed = match read {
            ReadoutMove::Off => before.unwrap_or(low),
            ReadoutMove::At(speed) => speed / view.data.units().speed.factor,
            ReadoutMove::Move(by) => {
                let present = view.data.era.as_ref().map_or(low, |era| era.speed);
                before.map_or(present, |speed| speed + f64::from(by) * (high - low) / f64::from(columns.max(1)))
            }
        };
        Some(SelectedItem::Speed(speed.clamp(low, high)))
    }
}

fn draw(view: &View<'_>, panel: &mut DampingOverSpeed, area: Rect, buffer: &mut Buffer) {
    let known = view.data.era.as_ref().filter(|era| !era.poles.is_empty());
    let asked = known.and_then(|era| Some((era, view.jobs.pole_trace(&PoleTraceRequest::of(era)?)?)));
    let Some((era, pole_trace)) = asked else {
        framed(Line::from(" damping over speed "), area, buffer);
        return;
    };
    let units = view.data.units();
    let selection = view.selection.speed;
    let (speed, min_damping) = (era.speed, era.min_damping);
    let would_be = view.what_if.and_then(|what_if| {
        let settings = &what_if.settings;
        let question = PoleTraceRequest::at(era.rotor.clone()?, settings.feedback.clone(), settings.speed);
        Some((view.jobs.pole_trace_of_candidate(&question), settings.speed, what_if.min_damping))
    });
    let candidate = would_be.as_ref().map(|(pole_trace, speed, damping)| (pole_trace.as_deref(), *speed, *damping));
    draw_facts(
        &Facts { pole_trace: &pole_trace, speed, min_damping, candidate, selection, units },
        panel,
        area,
        buffer,
    );
}

fn draw_facts(facts: &Facts<'_>, panel: &mut DampingOverSpeed, area: Rect, buffer: &mut Buffer) {
    let (pole_trace, units) = (facts.pole_trace, &facts.units);
    let (color, word) = theme::verdict(facts.min_damping);
    // The name goes before the range does.
    let stable = stable_words(pole_trace, units);
    let room = usize::from(area.width.saturating_sub(2));
    let name = longest(&[" damping over speed  ", " damping  ", " "], room.saturating_sub(width(&stable) + 1));
    let stable = if width(&stable) + 2 > room { stable.replace("stable ", "") } else { stable };
    let title = vec![
        Span::raw(name),
        Span::styled(stable, theme::loud(if pole_trace.stable.is_empty() { theme::BAD } else { theme::GOOD })),
        Span::raw(" "),
    ];
    let inner = framed(Line::from(title), area, buffer);
    let told = 1 + u16::from(facts.candidate.is_some());
    // The words below the plot matter more than the plot.
    let plotted = Rect { height: inner.height.saturating_sub(told), ..inner };
    // There is nothing to show below zero and beyond what was computed.
    let factor = units.speed.factor;
    let [from, to] = panel.along.over([0.0, pole_trace.top() * factor]).map(|end| end / factor);
    let from = from.clamp(0.0, 0.999 * pole_trace.top());
    let speeds = [from, to.clamp(from + 1e-3 * pole_trace.top(), pole_trace.top())];
    panel.shown = Some((speeds, plotted.width));
    draw_curves(facts, speeds, &mut panel.value, (area, plotted), buffer);
    let column = |speed: f64| {
        let along = (speed / factor - speeds[0]) / (speeds[1] - speeds[0]);
        (0.0..=1.0).contains(&along).then(|| plotted.x + (along * f64::from(plotted.width)) as u16)
    };
    ticks::level(area, speeds.map(|speed| speed * factor), column, buffer);

    let foot = plotted.bottom();
    let now = format!("{}  {:.4} {word}", units.speed_told(facts.speed), facts.min_damping);
    let [low, high] = speeds.map(|speed| units.speed(speed));
    let range = match units.scales {
        Some(_) => format!("{}{low} to {high} rpm", panel.along.sign()),
        None => format!("R {}{low} to {high}", panel.along.sign()),
    };
    let there = facts.selection.map(|speed| {
        let damping = pole_trace.min_damping_at(speed);
        let (color, word) = theme::verdict(damping);
        (format!("┆ {}  {damping:.4} {word}", units.speed_told(speed)), theme::loud(color))
    });
    let (right, style) = there.clone().unwrap_or((range, theme::quiet()));
    let room = usize::from(inner.width);
    match there {
        // What is pointed at matters more than the present, which stands above in large.
        Some((there, style)) if width(&now) + width(&there) + 2 > room => {
            write(buffer, inner, inner.left(), foot, &there, style);
        }
        _ => {
            write(buffer, inner, inner.left(), foot, &now, theme::loud(color));
            if width(&now) + width(&right) + 2 <= room {
                write_right(buffer, inner, foot, &right, style);
            }
        }
    }
    if let Some((candidate, _, min_damping)) = facts.candidate {
        let (color, word) = theme::verdict(min_damping);
        let range = candidate.map_or_else(|| "computing …".to_owned(), |curve| stable_words(curve, units));
        let would = format!("? {min_damping:.4} {word}");
        let bare = range.replace("stable ", "");
        let would = longest(&[&format!("{would}  {range}"), &format!("{would}  {bare}"), &would], room);
        write(buffer, inner, inner.left(), foot + 1, &would, theme::loud(color));
    }
}

fn draw_curves(
    facts: &Facts<'_>,
    speeds: [f64; 2],
    value: &mut PlotAxis,
    (frame, area): (Rect, Rect),
    buffer: &mut Buffer,
) {
    if area.is_empty() {
        return;
    }
    let pole_trace = facts.pole_trace;
    let would_be = facts.candidate.and_then(|(candidate, ..)| candidate);
    let all = would_be.iter().flat_map(|candidate| &candidate.min_damping).chain(&pole_trace.min_damping);
    let [low, high] = all.fold([0.0, 0.0], |[low, high]: [f64; 2], d| [low.min(*d), high.max(*d)]);
    let high = if high > 0.0 { high } else { 0.05 };
    let top = nice_ceiling(1.05 * high);
    // How unstable it gets is of less interest than how stable: no more room for that.
    let bottom = -nice_ceiling(-1.05 * low).min(top);
    let bottom = if low < 0.0 { bottom } else { -0.1 * top };
    let [bottom, top] = value.over([bottom, top]);
    let window = Window { x: speeds, y: [bottom, top] };
    let mut plot = Plot::new(area, window);

    shade(pole_trace, window, area, &mut plot);
    plot.line([0.0, 0.0], [pole_trace.top(), 0.0], theme::GRID);
    plot.line([facts.speed, bottom], [facts.speed, top], theme::CURSOR);
    if let Some(speed) = facts.selection {
        dotted_line(speed, [bottom, top], theme::CURSOR, area, &mut plot);
    }
    if let Some((candidate, speed, _)) = facts.candidate {
        if let Some(candidate) = candidate {
            curve(candidate, |_| theme::CANDIDATE, true, &mut plot);
        }
        if speed != facts.speed {
            dotted_line(speed, [bottom, top], theme::CANDIDATE, area, &mut plot);
        }
    }
    curve(pole_trace, |damping| theme::verdict(damping).0, false, &mut plot);
    plot.paint(buffer);

    write_free(buffer, area, area.left(), area.top(), &format!("{}{}", value.sign(), neat(top)), theme::quiet());
    if let Some((_, y)) = plot.cell(speeds[0], 0.0).filter(|(_, y)| *y > area.top()) {
        write(buffer, area, area.left(), y, "0", theme::quiet());
    }
    ticks::upright(frame, area, [bottom, top], |damping| plot.cell(speeds[0], damping).map(|(_, y)| y), neat, buffer);
    for (at, sign, color) in [
        Some((facts.speed, "◆", theme::verdict(facts.min_damping).0, facts.min_damping)),
        facts.candidate.map(|(_, speed, damping)| (speed, "◇", theme::CANDIDATE, damping)),
    ]
    .into_iter()
    .flatten()
    .filter_map(|(speed, sign, color, damping)| {
        Some((
            plot.cell(speed, damping.clamp(bottom + 1e-9 * (top - bottom), top - 1e-9 * (top - bottom)))?,
            sign,
            color,
        ))
    }) {
        write(buffer, area, at.0, at.1, sign, theme::loud(color));
    }
}

/// Every fourth dot between the curve and zero, over the speeds at which all modes decay.
fn shade(pole_trace: &PoleTrace, Window { x: [from, to], y: [bottom, top] }: Window, area: Rect, plot: &mut Plot) {
    let (columns, rows) = (usize::from(area.width) * 2, usize::from(area.height) * 4);
    for column in 0..columns {
        let speed = from + (column as f64 + 0.5) / columns as f64 * (to - from);
        if !pole_trace.stable.iter().any(|[from, to]| (*from..=*to).contains(&speed)) {
            continue;
        }
        let below = pole_trace.min_damping_near(speed);
        // On a fixed raster, so that shades of different heights match.
        for row in (0..rows).filter(|row| (column + 2 * row).is_multiple_of(4)) {
            let damping = top - (row as f64 + 0.5) / rows as f64 * (top - bottom);
            if damping > 0.0 && damping < below {
                plot.dot(speed, damping, theme::GRID);
            }
        }
    }
}

fn curve(pole_trace: &PoleTrace, color: impl Fn(f64) -> Color, dotted: bool, plot: &mut Plot) {
    let points = pole_trace.speeds.iter().zip(&pole_trace.min_damping);
    let points: Vec<[f64; 2]> = points.map(|(speed, damping)| [*speed, *damping]).collect();
    for (at, pair) in points.windows(2).enumerate() {
        if !dotted || at % 4 < 2 {
            plot.line(pair[0], pair[1], color(pair[1][1]));
        }
    }
}

fn dotted_line(speed: f64, [bottom, top]: [f64; 2], color: Color, area: Rect, plot: &mut Plot) {
    let dots = usize::from(area.height) * 4;
    for dot in (0..dots).step_by(2) {
        plot.dot(speed, bottom + (dot as f64 + 0.5) / dots as f64 * (top - bottom), color);
    }
}

/// Where all modes decay, in words.
pub(super) fn stable_words(pole_trace: &PoleTrace, units: &ScreenUnits) -> String {
    match &pole_trace.stable[..] {
        [] => "UNSTABLE throughout".to_owned(),
        ranges => format!("stable {}", telemetry::comparison::ranges_told(ranges, pole_trace.top(), units, ", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use telemetry::test_support::pole_trace;

    fn frame(facts: &Facts<'_>, width: u16, height: u16) -> String {
        drawn(width, height, |area, buffer| draw_facts(facts, &mut DampingOverSpeed::default(), area, buffer))
    }

    #[test]
    fn the_stable_range_is_shaded_and_told_and_the_speed_is_marked() {
        let composite = pole_trace("three-mass", "composite");
        let facts = Facts {
            pole_trace: &composite,
            speed: 2.5,
            min_damping: composite.min_damping_at(2.5),
            candidate: None,
            selection: None,
            units: ScreenUnits::DIMENSIONLESS,
        };
        insta::assert_snapshot!("damping_over_speed", frame(&facts, 60, 14));
        insta::assert_snapshot!("damping_over_speed_small", frame(&facts, 30, 6));
        insta::assert_snapshot!("damping_over_speed_large", frame(&facts, 120, 30));
        assert!(frame(&facts, 60, 14).contains("stable 0 to 7.0"));
        let data = telemetry::test_support::frame_data();
        let drawn = drawn(60, 14, |area, buffer| {
            DampingOverSpeed::default().draw(&crate::view::tests::view(&data), area, buffer);
        });
        assert_eq!(drawn, frame(&facts, 60, 14));
    }

    #[test]
    fn a_candidate_that_would_be_unstable_says_so_in_words() {
        let (now, off) = (pole_trace("three-mass", "composite"), pole_trace("three-mass", "off"));
        let candidate = Some((Some(&off), 2.5, off.min_damping_at(2.5)));
        let facts = Facts {
            pole_trace: &now,
            speed: 2.5,
            min_damping: now.min_damping_at(2.5),
            candidate,
            selection: None,
            units: ScreenUnits::DIMENSIONLESS,
        };
        let frame = frame(&facts, 60, 14);
        assert!(frame.contains("UNSTABLE  stable 0 to 1.776"), "{frame}");
        assert!(frame.contains('◆') && frame.contains('◇'), "{frame}");
        insta::assert_snapshot!("damping_over_speed_candidate", frame);
        let facts = Facts { candidate: Some((None, 2.5, off.min_damping_at(2.5))), ..facts };
        let frame = drawn(60, 16, |area, buffer| draw_facts(&facts, &mut DampingOverSpeed::default(), area, buffer));
        assert!(frame.contains("UNSTABLE  computing …"), "{frame}");
    }

    #[test]
    fn rotors_in_si_units_have_rpm() {
        let now = pole_trace("jeffcott", "off");
        let scales = rotor::Scales { w0: 100.0, k_t: 1e6, m_t: 100.0, e_t: 1e-5 };
        let units = ScreenUnits::of(Some(scales), rotor::ControlMasses::default());
        let (speed, min_damping) = (1.0, now.min_damping_at(1.0));
        let facts = Facts { pole_trace: &now, speed, min_damping, candidate: None, selection: Some(2.0), units };
        let frame = frame(&facts, 60, 10);
        // 2.209975 w0, in turns a minute.
        assert!(frame.contains("stable 0 to 2110") && frame.contains("│955 rpm"), "{frame}");
        assert!(frame.contains(&format!("┆ 1910 rpm  {:.4} stable", now.min_damping_at(2.0))), "{frame}");
    }
}
