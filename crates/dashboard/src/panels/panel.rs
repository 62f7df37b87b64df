//! What a panel is, and what is asked of one and by one.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::wheel_times;
use crate::axis::{PlotAxis, Scaling};
use crate::input::Mouse;
use crate::selection::{ReadoutMove, SelectedItem, Selection};
use crate::series::Strip;
use crate::view::View;

/// A part of the screen. It owns its state and draws its own frame.
pub(crate) trait Panel {
    /// Draws it; any area must do.
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer);

    /// Moves its list, if it is one, by so many rows.
    fn scroll(&mut self, _rows: isize) {}

    /// The scale of its values, if it has one and no more to say about it.
    fn scale(&mut self) -> Option<&mut PlotAxis> {
        None
    }

    /// What the mouse at a position of its area asks for. The wheel moves a list, and changes a scale.
    fn mouse(&mut self, _view: &View<'_>, _area: Rect, mouse: Mouse, _at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            match self.scale() {
                Some(scale) => scale.zoom(wheel_times(notches), None),
                None => self.scroll(3 * notches as isize),
            }
        }
        None
    }

    /// What is told of what the mouse is over, in a line.
    fn told_at(&self, _view: &View<'_>, _area: Rect, _at: Position) -> Option<String> {
        None
    }

    /// Changes a scale or what it shows; `None` if that is no matter of this panel.
    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        let PanelCommand::Value([scaling, ..]) = command else { return None };
        self.scale().map(|scale| scale.take(*scaling, None))
    }

    /// Where its read-out goes from what is pointed at now.
    fn read(&mut self, _view: &View<'_>, _read: ReadoutMove) -> Option<SelectedItem> {
        None
    }
}

/// What is wished of a plot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PanelCommand<'a> {
    /// Another scale of its values; the second is that of the other axis, where both are values.
    Value(&'a [Scaling]),
    /// Another scale of its horizontal axis, where that is not time. What is pointed at stays where it is.
    Along(Scaling, &'a Selection),
    /// Another scale of the strip of this name.
    Strip(&'a str, &'a [Scaling]),
    /// Other strips; those of the layout if there are none.
    Strips(Option<&'a [Strip]>),
    /// What strips the layout has, if it says so.
    StripsOfLayout(Option<&'a [Strip]>),
    /// Spectra of this mass, counted from 0; of the one with the control bearing if there is none.
    Mass(Option<usize>),
    /// Spectra over other frequencies.
    Frequencies(Scaling),
}

/// What a panel asks of the dashboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PanelRequest {
    /// Select this row of the settings.
    SelectSetting(usize),
    /// Look at the step of this place in the history.
    LookAtStep(u64),
    /// Point at this.
    Select(SelectedItem),
    /// Look at what was at this time, in nanoseconds since 1970 and in that of the rotor.
    LookAtTime { wall_ns: u64, tau: f64 },
    /// Show so many times as much time.
    ZoomTime(f64),
    /// Select the setting so many rows further down.
    SelectRows(isize),
    /// Raise the selected setting by so many of its steps.
    Nudge(f64),
    /// Every alarm has been seen.
    Acknowledge,
}

/// A panel without a state of its own is just its drawing.
impl<F: FnMut(&View<'_>, Rect, &mut Buffer)> Panel for F {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        self(view, area, buffer);
    }
}
