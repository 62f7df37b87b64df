//! The size of the loop's sensitivity `S = 1 / (1 + L)` over frequency, forward to the right and backward to the left, with the zones
//! of ISO 14839-3 that its peak is judged by.
//!
//! ```text
//! ┌ sensitivity |S| ──────────────────────┐
//! │11                        ◆           │   ◆ the peak
//! │                          ⡇           │
//! │⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⡇⠄⠄⠄⠄⠄ D │   zones A, B and C end at 3, 4 and 5
//! │⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⠄⡸⢣⠄⠄⠄⠄⠄ A │
//! │⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠢⣀⣀⠤⠒⠒⠒⠢⣀⡠⠔⠒⠉⠈⠒⠒⠒⠒⠒⠒⠒⠒│
//! │-6                0                  6│
//! └ ◆ 10.35 at 2.270  zone D  ? 1.192 A ──┘   ? what would be, while a value is edited: dotted
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Color;
use ratatui::text::Line;
use telemetry::jobs::LoopAnalysis;
use telemetry::jobs::loop_analysis::{ISO_14839_3, sensitivity_zone};
use text::number::{neat, nice_ceiling, short};

use super::loop_in_view::{LoopInView, why_none};
use super::panel::{Panel, PanelCommand, PanelRequest};
use super::wheel_times;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_free, write_right};
use crate::fit_text::longest;
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::selection::{ReadoutMove, SelectedItem};
use crate::theme;
use crate::view::View;

/// What is seen in any case, so that the zones are; and the most that is shown by itself.
const TOP: [f64; 2] = [6.0, 20.0];

/// The panel: a click points at a frequency, the wheel shows more or fewer of them.
#[derive(Debug, Default)]
pub(crate) struct SensitivityCurve {
    /// Frequencies, as they stand on the axis.
    along: PlotAxis,
    value: PlotAxis,
    /// The frequencies that were last shown, in units of `w0`, and where.
    shown: Option<([f64; 2], Rect)>,
}

impl Panel for SensitivityCurve {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let inner = framed(Line::from(" sensitivity |S| "), area, buffer);
        self.shown = None;
        if inner.is_empty() {
            return;
        }
        if let Some(facts) = LoopInView::of(view) {
            draw(view, &facts, self, (area, inner), buffer);
        }
    }

    fn mouse(&mut self, view: &View<'_>, _area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        let ([low, high], area) = self.shown?;
        let along = (f64::from(at.x.checked_sub(area.x)?) + 0.5) / f64::from(area.width);
        let frequency = low + along * (high - low);
        match mouse {
            Mouse::Wheel(notches) => {
                let about = self.along.is_fixed().then_some(frequency * view.data.units().frequency.factor);
                self.along.zoom(wheel_times(notches), about);
                None
            }
            Mouse::Click | Mouse::Drag(_) => {
                area.contains(at).then_some(PanelRequest::Select(SelectedItem::Frequency(frequency)))
            }
        }
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => Some(self.value.take(*scalings.first()?, None)),
            PanelCommand::Along(scaling, _) => Some(self.along.take(*scaling, None)),
            _ => None,
        }
    }

    fn read(&mut self, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        let ([low, high], area) = self.shown?;
        let before = view.selection.frequency;
        let frequency = match read {
            ReadoutMove::Off => before.unwrap_or(0.0),
            ReadoutMove::At(frequency) => frequency / view.data.units().frequency.factor,
            ReadoutMove::Move(by) => {
                let column = (high - low) / f64::from(area.width.max(1));
                before.map_or_else(|| peak_frequency(view).unwrap_or(0.0), |before| before + f64::from(by) * column)
            }
        };
        Some(SelectedItem::Frequency(frequency.clamp(low, high)))
    }
}

fn peak_frequency(view: &View<'_>) -> Option<f64> {
    LoopInView::of(view)?.now.peak()?.1
}

/// A round number of frequencies beyond everything that decides the margins, in units of `w0`.
fn reach(facts: &LoopInView) -> f64 {
    let told = [Some(&facts.now), facts.candidate.as_ref()].into_iter().flatten();
    let margins = told.filter_map(|of| of.margins.as_ref().ok()).map(|found| &found.margins);
    let crossings = margins.flat_map(|m| {
        let delay = m.delay.map(|delay| delay.frequency);
        let gains = [m.gain_up, m.gain_down].map(|gain| gain.map(|gain| gain.frequency));
        [m.forward.frequency, m.backward.frequency, delay, gains[0], gains[1]]
    });
    crossings.flatten().map(f64::abs).fold(facts.speed.abs().max(1.0), f64::max)
}

fn draw(
    view: &View<'_>,
    facts: &LoopInView,
    panel: &mut SensitivityCurve,
    (frame, area): (Rect, Rect),
    buffer: &mut Buffer,
) {
    let (now, units) = (&facts.now, view.data.units());
    let edge = Rect { width: frame.width.saturating_sub(2), ..frame };
    let foot = frame.bottom().saturating_sub(1);
    let found = match &now.margins {
        Ok(found) => found,
        Err(error) => {
            let told = format!(" {} ", why_none(error, &units));
            write(buffer, edge, frame.x + 1, foot, &told, theme::loud(theme::BAD));
            return;
        }
    };
    let plotted = Rect { height: area.height.saturating_sub(1), ..area };
    if plotted.is_empty() {
        return;
    }
    let factor = units.frequency.factor;
    let far = nice_ceiling(1.25 * reach(facts) * factor);
    let frequencies = panel.along.over([-far, far]).map(|end| end / factor);
    let peak = found.margins.sensitivity();
    let beside = facts.candidate.as_ref().and_then(|candidate| candidate.peak());
    let highest = beside.map_or(peak.amplitude, |(beside, _)| beside.max(peak.amplitude));
    let [bottom, top] = panel.value.over([0.0, (1.1 * highest).clamp(TOP[0], TOP[1])]);
    panel.shown = Some((frequencies, plotted));
    let mut plot = Plot::new(plotted, Window { x: frequencies, y: [bottom, top] });
    for (end, color) in ISO_14839_3.into_iter().zip([theme::GRID, theme::WARN, theme::BAD]) {
        dots(frequencies, 3, plotted.width, |frequency| plot.dot(frequency, end, color));
    }
    plot.line([0.0, bottom], [0.0, top], theme::GRID);
    if let Some(frequency) = view.selection.frequency {
        dots([bottom, top], 2, plotted.height * 2, |value| plot.dot(frequency, value, theme::CURSOR));
    }
    if let Some(candidate) = facts.candidate.as_ref().filter(|candidate| candidate.margins.is_ok()) {
        dots(frequencies, 2, plotted.width, |frequency| {
            if let Some(point) = candidate.at(frequency) {
                plot.dot(frequency, point.sensitivity(), theme::CANDIDATE);
            }
        });
    }
    for (is_backward, color) in [(true, theme::BACKWARD), (false, theme::FORWARD)] {
        let points = now.curve.iter().filter(|point| (point.frequency <= 0.0) == is_backward);
        plot.path(points.map(|point| [point.frequency, point.sensitivity()]), color);
    }
    plot.paint(buffer);

    let mut mark = |of: &LoopAnalysis, sign: &str, color: Color| {
        let place = of.peak().and_then(|(peak, at)| plot.cell(at?, peak.min(top - 1e-9 * (top - bottom))));
        if let Some((x, y)) = place {
            write(buffer, plotted, x, y, sign, theme::loud(color));
        }
    };
    if let Some(candidate) = &facts.candidate {
        mark(candidate, "◇", theme::CANDIDATE);
    }
    mark(now, "◆", theme::sensitivity(peak.amplitude));
    let highest = format!("{}{}", panel.value.sign(), neat(top));
    write_free(buffer, plotted, plotted.left(), plotted.top(), &highest, theme::quiet());
    // A zone's letter stands above its lower end, at the right.
    let floors = [0.0].into_iter().chain(ISO_14839_3).zip(["A", "B", "C", "D"]);
    for (floor, letter) in floors.filter(|_| plotted.height > 7) {
        let place = plot.cell(frequencies[0], floor.max(bottom + 1e-9 * (top - bottom)));
        if let Some((_, y)) = place.filter(|(_, y)| *y > plotted.top()) {
            write_free(buffer, plotted, plotted.right() - 1, y - 1, letter, theme::quiet());
        }
    }
    let ends = frequencies.map(|end| neat(end * factor));
    let unit = if units.scales.is_some() { format!(" {}", units.frequency.name) } else { String::new() };
    write(buffer, area, area.left(), plotted.bottom(), &format!("{}{}", panel.along.sign(), ends[0]), theme::quiet());
    write_right(buffer, area, plotted.bottom(), &format!("{}{unit}", ends[1]), theme::quiet());
    if let Some((x, _)) = plot.cell(0.0, bottom) {
        write_free(buffer, area, x, plotted.bottom(), "0", theme::quiet());
    }

    let at = |frequency: f64| units.frequency.told(frequency, 4);
    let (told, color) = match view.selection.frequency.and_then(|frequency| now.at(frequency)) {
        Some(point) => (format!("┆ {} at {}", short(point.sensitivity(), 4), at(point.frequency)), theme::CURSOR),
        None => {
            let where_at = peak.frequency.map_or_else(String::new, |frequency| format!(" at {}", at(frequency)));
            let zone = sensitivity_zone(peak.amplitude, ISO_14839_3);
            let told = format!("◆ {}{where_at}  zone {zone}", short(peak.amplitude, 4));
            (told, theme::sensitivity(peak.amplitude))
        }
    };
    let would = facts.candidate.as_ref().map(|candidate| match candidate.peak() {
        Some((peak, _)) => format!("  ? {} {}", short(peak, 4), sensitivity_zone(peak, ISO_14839_3)),
        None => "  ? UNSTABLE".to_owned(),
    });
    let both = format!(" {told}{} ", would.unwrap_or_default());
    let [size, bare] = match view.selection.frequency {
        Some(_) => [format!(" {told} "), String::new()],
        None => {
            let [size, zone] = [short(peak.amplitude, 4), sensitivity_zone(peak.amplitude, ISO_14839_3).to_owned()];
            [format!(" {told} "), format!(" ◆ {size}  zone {zone} ")]
        }
    };
    let told = longest(&[&both, &size, &bare], usize::from(edge.width)).to_owned();
    write(buffer, edge, frame.x + 1, foot, &told, theme::loud(color));
}

/// Values over a range, one for every so many columns of dots of an area that is `cells` wide.
fn dots([low, high]: [f64; 2], every: usize, cells: u16, mut at: impl FnMut(f64)) {
    let columns = 2 * usize::from(cells);
    for column in (0..columns).step_by(every) {
        at(low + (column as f64 + 0.5) / columns as f64 * (high - low));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::selection::Selection;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::what_if::WhatIf;

    #[test]
    fn the_peak_and_the_zones_are_seen() {
        let data = tests::frame_data();
        let frame = drawn(60, 16, |area, buffer| SensitivityCurve::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("◆ 2.903 at -0.504 w0  zone A"), "{frame}");
        for zone in ["A", "D"] {
            assert!(frame.lines().any(|line| line.trim_end_matches('│').ends_with(zone)), "{zone}:\n{frame}");
        }
        insta::assert_snapshot!("sensitivity", frame);
    }

    #[test]
    fn what_is_pointed_at_and_what_would_be_are_told() {
        let data = tests::frame_data();
        let (rotor, mut settings) = (data.rotor.clone().unwrap(), data.settings.clone().unwrap());
        settings.feedback = settings.feedback.off();
        let what_if = WhatIf::of(&rotor, settings);
        let selection = Selection { frequency: Some(0.0), ..Selection::default() };
        let frame = drawn(60, 16, |area, buffer| {
            let view = View { what_if: what_if.as_ref(), selection: &selection, ..view(&data) };
            SensitivityCurve::default().draw(&view, area, buffer);
        });
        assert!(frame.contains("? UNSTABLE") && frame.contains("┆ ") && frame.contains("at 0.000 w0"), "{frame}");
    }
}
