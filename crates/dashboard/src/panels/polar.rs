//! The first order of one mass as a polar plot over a run: a circle about each critical speed that was passed.
//!
//! ```text
//! ┌ polar 1X  mass 1  ±4.0 e_t ─┐
//! │          ⡇   ⢀⡠⠤⠒⠢⡀         │   amplitude from the centre, phase counter-clockwise from the right
//! │⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⡷⠶⠮⠤⠤⠤⠤⢤⠧⠤⠤⠤⠤    │   solid while the speed rises, dotted while it falls
//! │          ⡇      ◉⠎          │   ◉ the moment that is looked at
//! └ ┃ R 2.31  0.812 e_t  -93 deg ┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::text::Line;
use telemetry::jobs::run_up::TrackedTurn;
use text::number::{nice_ceiling, short};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::run_up::{legs_of, mark, mass_of, place_in_view, stroke, told};
use super::wheel_times;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write};
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::theme;
use crate::view::View;

/// The panel: a click looks at the moment of a point, the wheel changes the scale.
#[derive(Debug, Default)]
pub(crate) struct Polar {
    mass: Option<usize>,
    /// As it stands on the axis.
    scale: PlotAxis,
    shown: Option<(Window, Rect)>,
}

fn place(turn: &TrackedTurn) -> [f64; 2] {
    [turn.first_order.re, turn.first_order.im]
}

impl Panel for Polar {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let mass = mass_of(self.mass, view);
        let unit = view.data.units().length;
        let legs = legs_of(mass, view);
        let most = legs.as_ref().and_then(|legs| legs.highest()).map_or(0.0, |turn| turn.first_order.norm());
        let reach = self.scale.reach(nice_ceiling(1.05 * most * unit.factor));
        let title = format!(" polar 1X  mass {}  ±{} {}{} ", mass + 1, short(reach, 2), unit.name, self.scale.word());
        let inner = framed(Line::from(title), area, buffer);
        self.shown = None;
        let Some(legs) = legs.filter(|_| !inner.is_empty()) else { return };
        let window = Plot::round(inner, reach / unit.factor);
        self.shown = Some((window, inner));
        let mut plot = Plot::new(inner, window);
        plot.line([window.x[0], 0.0], [window.x[1], 0.0], theme::GRID);
        plot.line([0.0, window.y[0]], [0.0, window.y[1]], theme::GRID);
        plot.circle(0.5 * reach / unit.factor, theme::GRID);
        for leg in &legs.legs {
            stroke(leg, place, |_, _| false, window, &mut plot);
        }
        plot.paint(buffer);
        let here = place_in_view(view).and_then(|place| legs.at(place));
        mark(buffer, &plot, here, place, theme::CURSOR);
        if let Some(here) = here {
            let edge = Rect { width: area.width.saturating_sub(2), ..area };
            write(buffer, edge, area.x + 1, area.bottom() - 1, &told(here, view), theme::loud(theme::CURSOR));
        }
    }

    fn mouse(&mut self, view: &View<'_>, _area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.scale.zoom(wheel_times(notches), None);
            return None;
        }
        let (window, area) = self.shown?;
        let legs = legs_of(mass_of(self.mass, view), view)?;
        let plot = Plot::new(area, window);
        let far = |turn: &TrackedTurn| {
            let (x, y) = plot.cell(turn.first_order.re, turn.first_order.im)?;
            Some((f64::from(x) - f64::from(at.x)).hypot(2.0 * (f64::from(y) - f64::from(at.y))))
        };
        let known = legs.turns().filter_map(|turn| Some((far(turn)?, turn.place)));
        let (_, place) = known.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| area.contains(at))?;
        Some(PanelRequest::LookAtStep(place))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => Some(self.scale.take(*scalings.first()?, None)),
            PanelCommand::Mass(mass) => {
                self.mass = *mass;
                Some(Ok(()))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::panels::run_up::tests::run;
    use crate::view::tests::view;

    #[test]
    fn a_critical_speed_is_a_circle() {
        let data = run();
        let frame = drawn(50, 22, |area, buffer| Polar::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("polar 1X  mass 1  ±6.0 e_t") && frame.contains('◉'), "{frame}");
        insta::assert_snapshot!("polar", frame);
    }
}
