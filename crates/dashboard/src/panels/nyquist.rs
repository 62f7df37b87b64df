//! The gain of the opened loop in the complex plane, around the point -1: how near it comes to that is how near the machine is to
//! instability.
//!
//! ```text
//! ┌ Nyquist  forward backward ───────────┐
//! │ 1 + L ±1.5        ⡇     ⣀⠤⠒⠒⠤⣀       │   the scale, about -1
//! │           ⢀⠤⠤⡀    ⡇   ⡔⠁       ⠉⢆   │   circles about -1: |S| is 3 on the outermost, then 4 and 5,
//! │⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⢇⢎+⡱⡸⠤⠤⠤⡧⠤⠤⡇⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⡸⠤⠤│   where zones A, B and C of ISO 14839-3 end
//! │           ⠈◆⠒⠁    ⡇   ⠱⡀       ⢀⠎   │   ◆ where the sensitivity is largest, or ◈ at a frequency that is pointed at
//! └ ◆ |S| 10.35 at 2.270  zone D ───────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Color;
use ratatui::text::{Line, Span};
use telemetry::jobs::LoopAnalysis;
use telemetry::jobs::loop_analysis::{ISO_14839_3, LoopPoint, sensitivity_zone};
use text::number::{neat, short};

use super::loop_in_view::{LoopInView, why_none};
use super::panel::{Panel, PanelRequest};
use super::wheel_times;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_free};
use crate::fit_text::longest;
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::selection::SelectedItem;
use crate::theme;
use crate::view::View;

/// The least and the most that is shown around -1 by itself: the circles, and the origin with what is around it.
const REACH: [f64; 2] = [1.2, 2.5];
/// The furthest cells, as the eye counts them, from which a click still takes a point of the curve.
const GRASP: f64 = 3.0;

/// The panel: a click points at a frequency, the wheel changes the scale about -1.
#[derive(Debug, Default)]
pub(crate) struct Nyquist {
    scale: PlotAxis,
    shown: Option<(Rect, Window)>,
}

impl Panel for Nyquist {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let mut title = Line::from(" Nyquist ");
        let senses = [(" forward", theme::FORWARD), (" backward ", theme::BACKWARD)];
        if area.width > 30 {
            title.spans.extend(senses.map(|(sense, color)| Span::styled(sense, theme::loud(color))));
        }
        let inner = framed(title, area, buffer);
        self.shown = None;
        if inner.is_empty() {
            return;
        }
        if let Some(facts) = LoopInView::of(view) {
            draw(view, &facts, self, (area, inner), buffer);
        }
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.scale)
    }

    fn mouse(&mut self, view: &View<'_>, _area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        match mouse {
            Mouse::Wheel(notches) => {
                self.scale.zoom(wheel_times(notches), None);
                None
            }
            Mouse::Drag(_) => None,
            Mouse::Click => {
                let (area, window) = self.shown?;
                let (facts, plot) = (LoopInView::of(view)?, Plot::new(area, window));
                // A cell is twice as high as it is wide.
                let far = |point: &LoopPoint| {
                    let (x, y) = plot.cell(point.gain.re, point.gain.im)?;
                    Some((f64::from(x) - f64::from(at.x)).hypot(2.0 * (f64::from(y) - f64::from(at.y))))
                };
                let near = facts.now.curve.iter().filter_map(|point| Some((far(point)?, point.frequency)));
                let (_, frequency) = near.filter(|(far, _)| *far <= GRASP).min_by(|(a, _), (b, _)| a.total_cmp(b))?;
                Some(PanelRequest::Select(SelectedItem::Frequency(frequency)))
            }
        }
    }
}

fn draw(view: &View<'_>, facts: &LoopInView, panel: &mut Nyquist, (frame, area): (Rect, Rect), buffer: &mut Buffer) {
    let (now, units) = (&facts.now, view.data.units());
    let furthest = now.curve.iter().map(|point| (point.gain + 1.0).norm()).fold(0.0, f64::max);
    let reach = panel.scale.reach((1.05 * furthest).clamp(REACH[0], REACH[1]));
    let Window { x: [left, right], y } = Plot::round(area, reach);
    let window = Window { x: [left - 1.0, right - 1.0], y };
    panel.shown = Some((area, window));
    let mut plot = Plot::new(area, window);
    plot.line([left - 1.0, 0.0], [right - 1.0, 0.0], theme::GRID);
    plot.line([0.0, y[0]], [0.0, y[1]], theme::GRID);
    plot.circle(1.0, theme::GRID);
    for (peak, color) in ISO_14839_3.into_iter().zip([theme::CLEARANCE, theme::WARN, theme::BAD]) {
        plot.circle_about([-1.0, 0.0], peak.recip(), color);
    }
    if let Some(candidate) = &facts.candidate {
        curve(candidate, |_| theme::CANDIDATE, true, &mut plot);
    }
    let color = |backward: bool| if backward { theme::BACKWARD } else { theme::FORWARD };
    curve(now, color, false, &mut plot);
    plot.paint(buffer);

    let mut mark = |point: Option<LoopPoint>, sign: &str, color: Color| {
        if let Some((x, y)) = point.and_then(|point| plot.cell(point.gain.re, point.gain.im)) {
            write(buffer, area, x, y, sign, theme::loud(color));
        }
    };
    let peak_of = |of: &LoopAnalysis| of.peak().and_then(|(_, at)| of.at(at?));
    if let Some(candidate) = &facts.candidate {
        mark(peak_of(candidate), "◇", theme::CANDIDATE);
    }
    mark(peak_of(now), "◆", now.peak().map_or(theme::BAD, |(peak, _)| theme::sensitivity(peak)));
    let pointed = view.selection.frequency.and_then(|frequency| now.at(frequency));
    mark(pointed, "◈", theme::CURSOR);
    if let Some((x, y)) = plot.cell(-1.0, 0.0) {
        write(buffer, area, x, y, "+", theme::loud(theme::CURSOR));
    }
    let scale = format!("1 + L {}±{}", panel.scale.sign(), neat(reach));
    write_free(buffer, area, area.left(), area.top(), &scale, theme::quiet());

    let edge = Rect { width: frame.width.saturating_sub(2), ..frame };
    let (told, color) = match (pointed, &now.margins) {
        (Some(point), _) => {
            let [re, im] = [point.gain.re, point.gain.im].map(|part| short(part, 4));
            let plus = if point.gain.im < 0.0 { "" } else { "+" };
            let frequency = units.frequency.told(point.frequency, 4);
            let peak = short(point.sensitivity(), 4);
            (format!(" ◈ {frequency}  L {re} {plus}{im}j  |S| {peak} "), theme::CURSOR)
        }
        (None, Ok(found)) => {
            let peak = found.margins.sensitivity();
            let at = peak.frequency.map_or_else(String::new, |at| format!(" at {}", units.frequency.told(at, 4)));
            let zone = sensitivity_zone(peak.amplitude, ISO_14839_3);
            let size = short(peak.amplitude, 4);
            let told = [format!(" ◆ |S| {size}{at}  zone {zone} "), format!(" ◆ |S| {size}  zone {zone} ")];
            let told = longest(&[&told[0], &told[1]], usize::from(edge.width)).to_owned();
            (told, theme::sensitivity(peak.amplitude))
        }
        (None, Err(error)) => (format!(" {} ", why_none(error, &units)), theme::BAD),
    };
    write(buffer, edge, frame.x + 1, frame.bottom().saturating_sub(1), &told, theme::loud(color));
}

/// The gain over frequency: backward and forward by their colours; a candidate dotted.
fn curve(of: &LoopAnalysis, color: impl Fn(bool) -> Color, is_dotted: bool, plot: &mut Plot) {
    let place = |point: &LoopPoint| [point.gain.re, point.gain.im];
    if is_dotted {
        // By length, not by points: those lie close where the curve bends.
        let mut since = 0.0;
        for pair in of.curve.windows(2) {
            let step = (pair[1].gain - pair[0].gain).norm();
            since += step;
            if since > 0.05 {
                let [x, y] = place(&pair[1]);
                plot.dot(x, y, color(pair[1].frequency < 0.0));
                since = 0.0;
            }
        }
        return;
    }
    let zero = of.curve.partition_point(|point| point.frequency < 0.0);
    plot.path(of.curve[..(zero + 1).min(of.curve.len())].iter().map(place), color(true));
    plot.path(of.curve[zero..].iter().map(place), color(false));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::what_if::WhatIf;

    #[test]
    fn the_curve_passes_minus_one_at_its_peak() {
        let data = tests::frame_data();
        let frame = drawn(60, 24, |area, buffer| Nyquist::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("◆ |S| 2.903 at -0.504 w0  zone A"), "{frame}");
        assert_eq!(frame.matches('+').count(), 2, "-1, and the scale's word:\n{frame}");
        insta::assert_snapshot!("nyquist", frame);
    }

    #[test]
    fn a_candidate_lies_beside_and_a_loop_that_is_not_stable_says_so() {
        let data = tests::frame_data();
        let (rotor, mut settings) = (data.rotor.clone().unwrap(), data.settings.clone().unwrap());
        settings.feedback = rotor::builtin::feedback(&rotor, "individual").unwrap();
        let what_if = WhatIf::of(&rotor, settings);
        let frame = drawn(60, 24, |area, buffer| {
            let view = View { what_if: what_if.as_ref(), ..view(&data) };
            Nyquist::default().draw(&view, area, buffer);
        });
        assert!(frame.contains('◇') && frame.contains('◆'), "{frame}");
        let mut off = tests::frame_data();
        let mut era = (**off.era.as_ref().unwrap()).clone();
        era.settings.feedback.bearings[0].parts.delay = 1.0;
        off.era = Some(std::sync::Arc::new(era));
        let frame = drawn(60, 24, |area, buffer| Nyquist::default().draw(&view(&off), area, buffer));
        assert!(frame.contains("UNSTABLE: pole "), "{frame}");
    }

    #[test]
    fn a_click_on_the_curve_points_at_its_frequency() {
        let data = tests::frame_data();
        let view = view(&data);
        let mut panel = Nyquist::default();
        let area = Rect::new(0, 0, 60, 24);
        panel.draw(&view, area, &mut Buffer::empty(area));
        let (plotted, window) = panel.shown.unwrap();
        let peak = LoopInView::of(&view).unwrap().now.at(-0.504).unwrap();
        let (x, y) = Plot::new(plotted, window).cell(peak.gain.re, peak.gain.im).unwrap();
        let asked = panel.mouse(&view, area, Mouse::Click, Position::new(x, y));
        let Some(PanelRequest::Select(SelectedItem::Frequency(frequency))) = asked else { panic!("{asked:?}") };
        assert!((frequency + 0.504).abs() < 0.2, "{frequency}");
        assert_eq!(panel.mouse(&view, area, Mouse::Click, Position::new(1, 1)), None, "far from the curve");
    }
}
