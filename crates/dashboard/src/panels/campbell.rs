//! Campbell diagram: the frequencies of all modes over speed for the gains in force, and the line of the spin. Where a mode of forward whirl
//! crosses that, unbalance meets it: a critical speed.
//!
//! ```text
//! ┌ Campbell  critical 0.92, 2.27 ────────┐
//! │3                        ⡠⠔⠉           │   rising line: 1X, the frequency of the spin
//! ├2 ⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉●⠒⠒⠒⠒⠒⠒⠒⠒   ┃              │   ● a critical speed; ┃ the present speed
//! ├1 ⠒⠒⠒●⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒   ┃              │   forward and backward by colour, red where a mode grows
//! └─────────2─────────4───────────────────┘
//! ```

use machine::CountedModes;
use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::text::Line;
use rotor::C64;
use telemetry::jobs::{PoleTrace, PoleTraceRequest};
use text::number::{neat, nice_ceiling};

use super::panel::{Panel, PanelCommand, PanelRequest};
use crate::axis::PlotAxis;
use crate::drawing::{framed, write};
use crate::fit_text::longest;
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::selection::SelectedItem;
use crate::theme;
use crate::ticks;
use crate::view::View;

/// A frequency below this part of the highest is no whirl: a mode that only creeps has no critical speed.
const WHIRLS: f64 = 1e-3;

/// The diagram; a click points at a speed, the wheel changes the scale of the frequencies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Campbell {
    value: PlotAxis,
    /// The highest speed that was last shown, in units of `w0`.
    top: Option<f64>,
}

impl Panel for Campbell {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, self, area, buffer);
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.value)
    }

    fn mouse(&mut self, _view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.value.zoom(super::wheel_times(notches), None);
            return None;
        }
        let inner = area.inner(Margin::new(1, 1));
        let along = (f64::from(at.x.checked_sub(inner.x)?) + 0.5) / f64::from(inner.width);
        let speed = self.top? * along;
        inner.contains(at).then_some(PanelRequest::Select(SelectedItem::Speed(speed)))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        let PanelCommand::Value([scaling, ..]) = command else { return None };
        Some(self.value.take(*scaling, None))
    }
}

fn draw(view: &View<'_>, panel: &mut Campbell, area: Rect, buffer: &mut Buffer) {
    let known = view.data.era.as_ref().filter(|era| !era.poles.is_empty());
    let asked = known.and_then(|era| Some((era, view.jobs.pole_trace(&PoleTraceRequest::of(era)?)?)));
    let Some((era, pole_trace)) = asked else {
        framed(Line::from(" Campbell "), area, buffer);
        return;
    };
    let units = view.data.units();
    let critical = critical_speeds(&pole_trace);
    let told: Vec<String> = critical.iter().map(|speed| units.speed(*speed)).collect();
    let told = if told.is_empty() { "no critical speed".to_owned() } else { format!("critical {}", told.join(", ")) };
    let title = format!(" Campbell{}  {told} ", panel.value.word());
    let room = usize::from(area.width.saturating_sub(2));
    let title = longest(&[&title, &format!(" {told} "), " Campbell "], room);
    let inner = framed(Line::from(title), area, buffer);
    let top = pole_trace.top();
    panel.top = Some(top);
    // Of shafts those that count: the fastest are decades above any speed. The scale reaches them.
    let poles = pole_trace.branches.iter().filter_map(|branch| branch.last().copied());
    let counted = era.rotor.as_ref().and_then(|rotor| CountedModes::at(rotor, top, poles).below());
    let reach = counted.unwrap_or(f64::INFINITY);
    let highest = pole_trace.branches.iter().flatten().filter(|pole| pole.norm() <= reach).map(|pole| pole.im.abs());
    let highest = highest.fold(top * f64::from(u8::from(reach.is_finite())), f64::max);
    let factor = units.frequency.factor;
    let [bottom, most] = panel.value.over([0.0, nice_ceiling(1.05 * highest * factor)]);
    let [bottom, most] = [bottom, most].map(|end| end / factor);
    let mut plot = Plot::new(inner, Window { x: [0.0, top], y: [bottom, most] });
    plot.line([0.0, 0.0], [top, top], theme::GRID);
    plot.line([era.speed, bottom], [era.speed, most], theme::CURSOR);
    if let Some(speed) = view.selection.speed {
        let dots = usize::from(inner.height) * 4;
        for dot in (0..dots).step_by(2) {
            plot.dot(speed, bottom + (dot as f64 + 0.5) / dots as f64 * (most - bottom), theme::CURSOR);
        }
    }
    for branch in &pole_trace.branches {
        let points: Vec<(f64, C64)> = pole_trace.speeds.iter().copied().zip(branch.iter().copied()).collect();
        for pair in points.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            let color = match b {
                b if b.re > 0.0 => theme::BAD,
                b if b.im < 0.0 => theme::BACKWARD,
                _ => theme::FORWARD,
            };
            plot.line([from, a.im.abs()], [to, b.im.abs()], color);
        }
    }
    plot.paint(buffer);
    for speed in &critical {
        if let Some((x, y)) = plot.cell(*speed, *speed) {
            write(buffer, inner, x, y, "●", theme::loud(theme::KEYPHASOR));
        }
    }
    let row = |shown: f64| plot.cell(0.0, shown / factor).map(|(_, y)| y);
    ticks::upright(area, inner, [bottom * factor, most * factor], row, neat, buffer);
    let speed_factor = units.speed.factor;
    let column = |shown: f64| plot.cell(shown / speed_factor, 0.5 * (bottom + most)).map(|(x, _)| x);
    ticks::level(area, [0.0, top * speed_factor], column, buffer);
}

/// The speeds at which a mode of forward whirl turns with the spin, rising: between two speeds of the trace by straight lines.
fn critical_speeds(pole_trace: &PoleTrace) -> Vec<f64> {
    let least = WHIRLS * pole_trace.top();
    let mut found = Vec::new();
    for branch in &pole_trace.branches {
        for (speeds, poles) in pole_trace.speeds.windows(2).zip(branch.windows(2)) {
            let [before, after] = [0, 1].map(|at| poles[at].im - speeds[at]);
            if (before > 0.0) != (after > 0.0) && poles[1].im > least {
                found.push(speeds[0] + (speeds[1] - speeds[0]) * before / (before - after));
            }
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_shafts_the_speeds_and_the_modes_that_count_fill_the_view() {
        let data = telemetry::test_support::frame_data_of_shafts();
        let mut panel = Campbell::default();
        let area = Rect::new(0, 0, 80, 24);
        panel.draw(&crate::view::tests::view(&data), area, &mut Buffer::empty(area));
        // Speeds to 15942 rpm are 266 Hz; four forward modes reach to 1168 Hz, and the fastest of the shaft to 15 kHz.
        let [_, top] = panel.value.shown().expect("drawn");
        assert!((1168.0..3000.0).contains(&top), "{top}");
    }
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support::{frame_data, pole_trace};

    #[test]
    fn val_critical_speeds_of_an_undamped_rotor_are_its_natural_frequencies() {
        // The report's Jeffcott rotor on a rigid support: frequency 1, whatever the speed; crossed where R is it.
        let off = pole_trace("jeffcott", "off");
        let critical = critical_speeds(&off);
        let crossing = |speed: f64| {
            let at = off.speeds.partition_point(|known| *known < speed);
            off.branches.iter().any(|branch| (branch[at].im - speed).abs() < 2.0 * (off.speeds[1] - off.speeds[0]))
        };
        assert!(!critical.is_empty() && critical.iter().all(|speed| crossing(*speed)), "{critical:?}");
    }

    #[test]
    fn modes_and_critical_speeds_are_drawn() {
        let data = frame_data();
        let frame = drawn(64, 18, |area, buffer| Campbell::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("critical ") && frame.contains('●'), "{frame}");
        insta::assert_snapshot!("campbell", frame);
    }
}
