//! What the mouse does.

use crossterm::event::{MouseButton, MouseEvent, MouseEventKind};
use ratatui::layout::Position;

use super::App;
use crate::actions::Action;
use crate::input::Mouse;
use crate::panels::panel::PanelRequest;
use crate::panels::registry::PANELS;
use crate::screen;

impl App<'_> {
    /// The mouse: what lies on top first, then the panel under it.
    pub(super) fn mouse(&mut self, event: MouseEvent) {
        let at = (event.column, event.row);
        self.pointer = Some(at);
        let mouse = match event.kind {
            MouseEventKind::ScrollUp => Mouse::Wheel(-1),
            MouseEventKind::ScrollDown => Mouse::Wheel(1),
            MouseEventKind::Down(MouseButton::Left) => {
                self.dragged = Some(at);
                Mouse::Click
            }
            MouseEventKind::Drag(MouseButton::Left) => {
                let Some(before) = self.dragged.replace(at) else { return };
                Mouse::Drag(i32::from(at.0) - i32::from(before.0))
            }
            MouseEventKind::Up(_) => {
                self.dragged = None;
                return;
            }
            _ => return,
        };
        if self.layers.last_mut().is_some_and(|layer| layer.mouse(mouse)) {
            return;
        }
        let (area, position) = (self.area, Position::new(at.0, at.1));
        let hit = self.with_view(|view, layout, panels| {
            let places = screen::panels(view, layout, area);
            let (kind, place) = places.into_iter().find(|(_, place)| place.contains(position))?;
            Some((kind, panels.mouse(kind, view, place, mouse, position)))
        });
        let Some((kind, intent)) = hit else { return };
        if mouse == Mouse::Click && PANELS[kind].is_plot {
            self.selection.plot = Some(kind);
        }
        match intent {
            Some(PanelRequest::SelectSetting(row)) => {
                self.layers.clear();
                self.row = row;
            }
            // A click on the same again takes it back; a drag within one cell does not.
            Some(PanelRequest::Select(point)) if mouse == Mouse::Click => self.selection.toggle(point),
            Some(PanelRequest::Select(point)) => self.selection.set(point, true),
            Some(PanelRequest::LookAtStep(place)) => self.look_at(place),
            Some(PanelRequest::LookAtTime { wall_ns, tau }) => self.look_when(wall_ns, tau),
            Some(PanelRequest::ZoomTime(times)) => self.look(|time, _, seconds| time.zoom(times, seconds)),
            Some(PanelRequest::SelectRows(rows)) => self.act(Action::Select(rows)),
            Some(PanelRequest::Nudge(steps)) => self.act(Action::NudgeSelected(steps)),
            Some(PanelRequest::Acknowledge) => self.act(Action::Acknowledge),
            None => {}
        }
    }
}
