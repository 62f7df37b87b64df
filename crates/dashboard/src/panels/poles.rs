//! Poles in the complex plane.
//!
//! ```text
//! ┌ poles ──────────────────────────┐
//! │ ζ .1 ζ .05⡇ Im           ±5    │   rays of equal damping lean left from the origin
//! ├2 ⠑⡀    ▲ ⡇                     │   ▲ forward, Im > 0; round values of both axes on the frame
//! │    ⠑⡀  ▲ ⡇                     │
//! │      ⠑⡀  ⡇◆  unstable          │   ◆ the least damped mode; right of the line Re = 0 it grows
//! │⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⡏⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉│
//! │     ▼    ⡇                     │   ▼ backward, Im < 0; blue lines: where poles go over speed, from 0 up
//! └ ◆ -0.1216 +2.2693j  ζ 0.0535 ─0─┘   of the least damped mode, or ◈ of the one that is pointed at
//! ```

use machine::CountedModes;
use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::text::Line;
use rotor::{C64, Whirl, damping_ratio};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::wheel_times;
use crate::axis::{PlotAxis, Scaling};
use crate::drawing::{framed, write, write_free, write_right};
use crate::fit_text::{longest, width};
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::selection::ReadoutMove;
use crate::selection::SelectedItem;
use crate::theme;
use crate::ticks;
use crate::view::View;
use telemetry::history::Era;
use telemetry::jobs::PoleTraceRequest;
use telemetry::units::ScreenUnits;
use text::number::{neat, nice_ceiling, short};

/// Damping ratios that get a ray.
const RAYS: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

/// What is damped better than this whirls little: it is a state of the loop.
const WHIRLS: f64 = 0.75;

/// What the right side is called.
const UNSTABLE: &str = "unstable";

/// The furthest cells, as the eye counts them, from which a click still takes a pole.
const GRASP: f64 = 4.0;

/// The poles: a click takes a mode, the wheel changes the scale.
#[derive(Debug, Default)]
pub(crate) struct Poles {
    re: PlotAxis,
    im: PlotAxis,
}

impl Panel for Poles {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let window = self.window(view);
        let beyond = window.zip(view.data.poles()).map_or(0, |(window, (_, poles))| {
            let is_in = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
            poles.iter().filter(|pole| !is_in(pole.re, window.x) || !is_in(pole.im, window.y)).count()
        });
        // What is out of sight is said to be there.
        let title = match beyond {
            0 => " poles ▲forward ▼backward ".to_owned(),
            _ => {
                let ways = [" poles ▲forward ▼backward  ", " poles ▲▼  ", " poles "]
                    .map(|name| format!("{name}{beyond} further out "));
                longest(&ways.each_ref().map(String::as_str), usize::from(area.width.saturating_sub(2)))
            }
        };
        let inner = framed(Line::from(title), area, buffer);
        if let Some(window) = window {
            draw(view, self, window, area, inner, buffer);
        }
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        match mouse {
            Mouse::Wheel(notches) => {
                self.re.zoom(wheel_times(notches), None);
                self.im.zoom(wheel_times(notches), None);
                None
            }
            Mouse::Drag(_) => None,
            Mouse::Click => {
                let plot = Plot::new(area.inner(Margin::new(1, 1)), self.window(view)?);
                let (_, poles) = view.data.poles()?;
                // A cell is twice as high as it is wide.
                let far = |pole: &C64| {
                    let (x, y) = plot.cell(pole.re, pole.im)?;
                    Some((f64::from(x) - f64::from(at.x)).hypot(2.0 * (f64::from(y) - f64::from(at.y))))
                };
                let near = poles.iter().filter_map(|pole| Some((far(pole)?, *pole))).filter(|(far, _)| *far <= GRASP);
                let (_, pole) = near.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
                Some(PanelRequest::Select(SelectedItem::Mode(pole)))
            }
        }
    }

    fn told_at(&self, view: &View<'_>, area: Rect, at: Position) -> Option<String> {
        let inner = area.inner(Margin::new(1, 1));
        let factor = view.data.units().rate.factor;
        let [re, im] = [self.re.shown()?, self.im.shown()?].map(|range| range.map(|end| end / factor));
        let along = |cell: u16, cells: u16| (f64::from(cell) + 0.5) / f64::from(cells);
        let here = inner.contains(at).then(|| {
            let x = re[0] + along(at.x - inner.x, inner.width) * (re[1] - re[0]);
            C64::new(x, im[1] - along(at.y - inner.y, inner.height) * (im[1] - im[0]))
        })?;
        Some(told(here, &view.data.units(), usize::from(u16::MAX)))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        let PanelCommand::Value(scalings) = command else { return None };
        let re = self.re.take(*scalings.first()?, None);
        // One scale but a range is for both: a range is that of Re, a second one that of Im.
        let im = match scalings {
            [scaling @ (Scaling::Auto | Scaling::Times(_))] | [_, scaling] => self.im.take(*scaling, None),
            _ => Ok(()),
        };
        Some(re.and(im))
    }

    fn read(&mut self, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        next_mode(view, read).map(SelectedItem::Mode)
    }
}

/// The mode that a read-out moves on to: modes are in order of their damping.
pub(super) fn next_mode(view: &View<'_>, read: ReadoutMove) -> Option<C64> {
    let (_, poles) = view.data.poles()?;
    let at = view.selection.mode.and_then(|mode| poles.iter().position(|pole| *pole == mode));
    let at = match (read, at) {
        (ReadoutMove::Off, at) => at.unwrap_or(0),
        (ReadoutMove::Move(by), Some(at)) => at.saturating_add_signed(by as isize).min(poles.len() - 1),
        (ReadoutMove::Move(_), None) => 0,
        // By its frequency.
        (ReadoutMove::At(frequency), _) => {
            let frequency = frequency / view.data.units().frequency.factor;
            let far = |pole: &C64| (pole.im - frequency).abs();
            (0..poles.len()).min_by(|a, b| far(&poles[*a]).total_cmp(&far(&poles[*b])))?
        }
    };
    poles.get(at).copied()
}

/// A pole in words: where it is, its damping ratio, and, where there is room, its frequency and sense.
fn told(pole: C64, units: &ScreenUnits, width: usize) -> String {
    let (re, im) = (pole.re * units.rate.factor, pole.im * units.rate.factor);
    let place = format!("{} {}{}j", short(re, 5), if im < 0.0 { "" } else { "+" }, short(im, 5));
    let whirl = if pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward };
    let ratio = format!("ζ {:.4}", damping_ratio(pole));
    let both = format!("{place}  {ratio}");
    let full = format!("{both}  {}  {whirl}", units.frequency.told(pole.im.abs(), 4));
    [full, both, place].into_iter().find(|text| crate::fit_text::width(text) + 4 <= width).unwrap_or(ratio)
}

impl Poles {
    /// The part of the plane to show, in units of `w0`; nothing as long as no poles are known.
    fn window(&mut self, view: &View<'_>) -> Option<Window> {
        let (_, poles) = view.data.poles()?;
        let factor = view.data.units().rate.factor;
        let candidates = view.what_if.iter().flat_map(|candidate| &candidate.poles);
        let near = view.data.era.as_ref().map_or(f64::INFINITY, |era| within(era, poles));
        let shown = || poles.iter().chain(candidates.clone()).filter(|pole| pole.norm() <= near || pole.re >= 0.0);
        let reach = |part: fn(&C64) -> f64| factor * shown().map(part).fold(0.0, f64::max);
        let top = nice_ceiling(reach(|p| p.im.abs()) * 1.05);
        // Of shafts, whose loop has states far left on the real axis, as far as what whirls, and far enough to tell rays apart.
        let whirls = |p: &C64| if near.is_finite() && damping_ratio(*p) > WHIRLS { 0.0 } else { -p.re };
        let furthest_left = factor * shown().map(whirls).fold(0.0, f64::max);
        let left = nice_ceiling((furthest_left * 1.05).max(if near.is_finite() { 0.1 * top } else { 0.0 }));
        // The unstable side is always in view, wide enough to see a pole arrive.
        let furthest = reach(|p| p.re);
        let right = if furthest > 0.0 { nice_ceiling(furthest * 1.05) } else { 0.0 }.max(0.25 * left);
        let dimensionless = |range: [f64; 2]| range.map(|end| end / factor);
        Some(Window { x: dimensionless(self.re.over([-left, right])), y: dimensionless(self.im.over([-top, top])) })
    }
}

/// How far from the origin poles are shown unasked: all of a chain; of shaft elements, whose fastest modes are decades away from those that
/// anybody turns, those that count.
fn within(era: &Era, poles: &[C64]) -> f64 {
    let counted = era.rotor.as_ref().map(|rotor| CountedModes::at(rotor, era.speed, poles.iter().copied()));
    counted.and_then(|counted| counted.below()).unwrap_or(f64::INFINITY)
}

/// Writes a scale at the right of the first of these rows in which no mark would hide a part of its numbers; else nowhere.
fn write_beside(buffer: &mut Buffer, area: Rect, marks: &[(u16, u16)], rows: impl Iterator<Item = u16>, text: &str) {
    let from = area.right().saturating_sub(width(text) as u16).max(area.left());
    let is_free = |y: &u16| !marks.iter().any(|(mark_x, mark_y)| mark_y == y && *mark_x >= from);
    if let Some(y) = rows.into_iter().find(is_free) {
        write_right(buffer, area, y, text, theme::quiet());
    }
}

fn draw(view: &View<'_>, axes: &Poles, window: Window, area: Rect, inner: Rect, buffer: &mut Buffer) {
    let Some((_, poles)) = view.data.poles() else { return };
    let units = view.data.units();
    let Window { x: [left, right], y: [bottom, top] } = window;
    let mut plot = Plot::new(inner, window);
    trail(view, &mut plot);

    for zeta in RAYS {
        // Along a ray Re = -zeta |lambda|.
        let slope = (1.0 - zeta * zeta).sqrt() / zeta;
        // Far enough to leave the window on either side.
        let end = (-left).max(0.0);
        for side in [1.0, -1.0] {
            plot.line([0.0, 0.0], [-end, side * end * slope], theme::GRID);
        }
    }
    plot.line([left, 0.0], [right, 0.0], theme::GRID);
    plot.line([0.0, bottom], [0.0, top], theme::CURSOR);
    plot.paint(buffer);

    let factor = units.rate.factor;
    let [shown_re, shown_im] = [[left, right], [bottom, top]].map(|range| range.map(|end| end * factor));
    let row = |im: f64| plot.cell(left, im / factor).map(|(_, y)| y);
    ticks::upright(area, inner, shown_im, row, neat, buffer);
    // A scale that stands still was chosen: it is told as it is.
    let number = |value: f64| match axes.re.is_fixed() || axes.im.is_fixed() {
        true => neat(value * units.rate.factor),
        false => units.rate.short(value, 2),
    };
    let symmetric = top == -bottom;
    let im = if symmetric { format!("±{}", number(top)) } else { format!("{} to {}", number(bottom), number(top)) };
    let name = if units.scales.is_some() { " 1/s" } else { "" };
    let im = format!("Im {}{im}{name}", axes.im.sign());
    let beside = view.what_if.iter().flat_map(|candidate| &candidate.poles);
    let marks: Vec<_> = poles.iter().chain(beside).filter_map(|pole| plot.cell(pole.re, pole.im)).collect();
    let rows = inner.top()..inner.bottom();
    write_beside(buffer, inner, &marks, rows.clone().take(3), &im);
    let scale = format!("Re {}{} to {}{name}", axes.re.sign(), number(left), number(right));
    write_beside(buffer, inner, &marks, rows.rev().take(3), &scale);
    if let Some((x, y)) = plot.cell(0.0, bottom + 0.95 * (top - bottom)).map(|(x, y)| (x + 2, y.max(inner.top() + 1))) {
        // Half a word would mislead.
        write_free(buffer, inner, x, y, UNSTABLE, theme::quiet());
    }

    // The least damped last, so that it lies on top.
    for (rank, pole) in poles.iter().enumerate().rev() {
        let Some((x, y)) = plot.cell(pole.re, pole.im) else { continue };
        let whirl = if pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward };
        let (sign, color) = match whirl {
            Whirl::Forward => ("▲", theme::FORWARD),
            Whirl::Backward => ("▼", theme::BACKWARD),
        };
        let (sign, color) = match rank {
            0 => ("◆", theme::verdict(damping_ratio(*pole)).0),
            _ => (sign, color),
        };
        write(buffer, inner, x, y, sign, theme::loud(color));
    }
    for pole in view.what_if.iter().flat_map(|candidate| &candidate.poles) {
        if let Some((x, y)) = plot.cell(pole.re, pole.im) {
            write(buffer, inner, x, y, "◇", theme::loud(theme::verdict(damping_ratio(*pole)).0));
        }
    }
    for zeta in RAYS {
        let slope = (1.0 - zeta * zeta).sqrt() / zeta;
        let end = 0.97 * (-left).min(top / slope);
        if let Some((x, y)) = plot.cell(-end, end * slope) {
            write_free(buffer, inner, x, y, &format!("ζ {zeta}"), theme::quiet());
        }
    }
    let selection = view.selection.mode;
    if let Some((x, y)) = selection.and_then(|pole| plot.cell(pole.re, pole.im)) {
        write(buffer, inner, x, y, "◈", theme::loud(theme::CURSOR));
    }
    if let Some((sign, pole)) = selection.map(|pole| ("◈", pole)).or(view.data.least_damped().map(|pole| ("◆", pole)))
    {
        // On the lower edge of the frame, where no pole is hidden by it.
        let edge = Rect { width: area.width.saturating_sub(2), ..area };
        let label = format!(" {sign} {} ", told(pole, &units, usize::from(edge.width)));
        let style = theme::loud(theme::verdict(damping_ratio(pole)).0);
        write(buffer, edge, area.left() + 1, area.bottom().saturating_sub(1), &label, style);
    }
    ticks::level(area, shown_re, |re| plot.cell(re / factor, 0.5 * (bottom + top)).map(|(x, _)| x), buffer);
}

/// Where the poles go over speed for the gains in force, faintly. Nothing where modes cannot be told
/// apart.
fn trail(view: &View<'_>, plot: &mut Plot) {
    let Some(question) = view.data.era.as_ref().and_then(|era| PoleTraceRequest::of(era)) else { return };
    let Some(pole_trace) = view.jobs.pole_trace(&question) else { return };
    for branch in &pole_trace.branches {
        for pair in branch.windows(2) {
            plot.line([pair[0].re, pair[0].im], [pair[1].re, pair[1].im], theme::TRAIL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn every_pole_has_its_sign_and_the_least_damped_is_marked() {
        let data = tests::frame_data();
        let frame = drawn(60, 20, |area, buffer| Poles::default().draw(&view(&data), area, buffer));
        // Six poles: three backward, two forward, and the least damped one; the title, which also has them, is left out.
        let count = |sign| frame.lines().skip(1).map(|line| line.matches(sign).count()).sum::<usize>();
        assert!((2..=3).contains(&count('▼')), "{frame}");
        assert!((1..=2).contains(&count('▲')), "{frame}");
        assert_eq!(count('◆'), 2, "the pole and its label:\n{frame}");
        assert!(frame.contains("unstable"), "{frame}");
        insta::assert_snapshot!("poles", frame);
    }

    #[test]
    fn of_shafts_the_modes_that_count_fill_the_view_and_the_rest_is_named() {
        let data = tests::frame_data_of_shafts();
        let mut panel = Poles::default();
        let area = Rect::new(0, 0, 60, 20);
        let mut buffer = ratatui::buffer::Buffer::empty(area);
        panel.draw(&view(&data), area, &mut buffer);
        // As `whirl poles rig` has them: up to 1750 Hz, the least damped of those at -66.84 +7337.7j 1/s.
        let [re, im] = [panel.re.shown().unwrap(), panel.im.shown().unwrap()];
        assert!(im[1] >= 7337.7 && im[1] <= 11_000.0, "{im:?}");
        assert!(re[0] <= -66.0 && re[0] >= -1500.0 && re[1] > 0.0, "{re:?}");
        let frame = crate::screenshot::image::text(&buffer);
        assert!(frame.contains("◆ -66.840 +7337.7j") && frame.contains(" further out "), "{frame}");
    }

    #[test]
    fn nothing_known_is_an_empty_frame() {
        let empty = Feed::new("waiting").frame_data(&ViewTime::LIVE, std::time::Instant::now());
        let frame = drawn(30, 4, |area, buffer| Poles::default().draw(&view(&empty), area, buffer));
        assert_eq!(frame.lines().nth(1), Some(&*format!("│{}│", " ".repeat(28))));
    }
}
