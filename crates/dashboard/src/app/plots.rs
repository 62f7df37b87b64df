//! The chosen plot: its scale and its read-out.

use units::Dimension;

use super::App;
use crate::actions::{Action, TypedScaling};
use crate::axis::Scaling;
use crate::panels::panel::PanelCommand;
use crate::panels::registry::{PANELS, plots};
use crate::screen;
use crate::selection::ReadoutMove;
use crate::series::Strip;
use crate::view::Message;
use telemetry::reader::lock;

impl App<'_> {
    /// The plots of the layout, in the order of its picture.
    fn shown_plots(&mut self) -> Vec<usize> {
        let area = self.area;
        let places = self.with_view(|view, layout, _| screen::panels(view, layout, area));
        places.into_iter().map(|(kind, _)| kind).filter(|kind| PANELS[*kind].is_plot).collect()
    }

    /// The chosen plot, if it is on the screen.
    fn chosen(&mut self) -> Option<usize> {
        let plot = self.selection.plot?;
        self.shown_plots().contains(&plot).then_some(plot)
    }

    /// The chosen plot; says so if there is none.
    fn chosen_or_told(&mut self) -> Option<usize> {
        let chosen = self.chosen();
        if chosen.is_none() {
            self.tell(Message::Bad("no plot is chosen: tab or a click chooses one".into()));
        }
        chosen
    }

    /// Chooses a plot by name, or so many on in the order of the layout.
    pub(super) fn choose(&mut self, which: &str) {
        let shown = self.shown_plots();
        if let Ok(steps) = which.parse::<isize>() {
            let count = shown.len() as isize;
            let before = shown.iter().position(|kind| Some(*kind) == self.selection.plot);
            let next = match before {
                _ if count == 0 => None,
                Some(at) => Some((at as isize + steps % count).rem_euclid(count)),
                None => Some(if steps < 0 { count - 1 } else { 0 }),
            };
            self.selection.plot = next.map(|at| shown[at as usize]);
            return;
        }
        match shown.iter().find(|kind| PANELS[**kind].name == which) {
            Some(kind) => self.selection.plot = Some(*kind),
            None => {
                let names: Vec<&str> = shown.iter().map(|kind| PANELS[*kind].name).collect();
                self.tell(Message::Bad(format!("no plot '{which}' on this screen: there are {}", names.join(", "))));
            }
        }
    }

    /// Another scale of the values of a plot.
    pub(super) fn scale(&mut self, plot: Option<&str>, scalings: &[Scaling]) {
        let is_strip = |name: &str| !PANELS.iter().any(|kind| kind.is_plot && kind.name == name);
        if let (Some(name), true) = (plot.filter(|name| is_strip(name)), scalings.len() > 1) {
            return self.tell(Message::Bad(format!("{name}: expected one scale, for its one axis of values")));
        }
        let kind = match plot {
            None => self.chosen_or_told(),
            Some(name) => {
                let kind = PANELS.iter().position(|kind| kind.is_plot && kind.name == name);
                // What is no plot may be a strip.
                let done = kind.is_none().then(|| self.panels.command_any(&PanelCommand::Strip(name, scalings)));
                match done {
                    Some(Some(Ok(()))) => return,
                    Some(Some(Err(why))) => return self.tell(Message::Bad(format!("{name} {why}"))),
                    Some(None) => {
                        let names: Vec<&str> = plots().collect();
                        let names = names.join(", ");
                        return self.tell(Message::Bad(format!("no plot or strip '{name}': plots are {names}")));
                    }
                    None => kind,
                }
            }
        };
        let Some(kind) = kind else { return };
        let name = PANELS[kind].name;
        // Of all plots that of the poles alone has two axes of values.
        if scalings.len() > 1 && name != "poles" {
            return self.tell(Message::Bad(format!("{name}: expected one scale, for its one axis of values")));
        }
        // A strip of the same name shows the same quantity.
        if let Some(plot) = plot {
            let _ = self.panels.command_any(&PanelCommand::Strip(plot, scalings));
        }
        if let Some(Err(why)) = self.panels.command(kind, &PanelCommand::Value(scalings)) {
            self.tell(Message::Bad(format!("{name} {why}")));
        }
    }

    /// Shows less or more of the chosen plot's horizontal axis: of time, where it has no other.
    pub(super) fn zoom(&mut self, times: f64) {
        let selection = self.selection;
        let its_own = self
            .chosen()
            .and_then(|kind| self.panels.command(kind, &PanelCommand::Along(Scaling::Times(times), &selection)));
        if its_own.is_none() {
            self.look(|time, _, seconds| time.zoom(times, seconds));
        }
    }

    /// The chosen plot as at the start, and time with it where that is its horizontal axis.
    pub(super) fn zoom_reset(&mut self) {
        let (chosen, selection) = (self.chosen(), self.selection);
        let mut reset = |command: &PanelCommand<'_>| chosen.and_then(|kind| self.panels.command(kind, command));
        reset(&PanelCommand::Value(&[Scaling::Auto, Scaling::Auto]));
        if reset(&PanelCommand::Along(Scaling::Auto, &selection)).is_none() {
            self.look(|time, _, seconds| time.reset_span(seconds));
        }
    }

    /// Looks at the step of a place in the history.
    pub(super) fn look_at(&mut self, place: u64) {
        if self.player.is_some() {
            self.play(|player, feed, time| player.go_to_index(place, feed, time));
        } else {
            self.look(|time, kept, seconds| time.look_at(place, kept, seconds));
        }
    }

    /// Looks at what was at a time of the wall clock, which was `tau` for the rotor.
    pub(super) fn look_when(&mut self, wall_ns: u64, tau: f64) {
        if self.player.is_some() {
            return self.act(Action::GoTo(tau));
        }
        let place = lock(&self.feed).history().index_at(wall_ns);
        match place {
            Some(place) => self.look_at(place),
            None => self.tell(Message::Bad("that moment is not kept here".into())),
        }
    }

    /// Other strips, or those of the layout.
    pub(super) fn show_strips(&mut self, strips: Option<&[Strip]>) {
        let masses = lock(&self.feed).rotor().map_or(0, |rotor| rotor.len());
        let bearings = self.settings().map_or(1, |settings| settings.feedback.bearings.len());
        let layout = wire::StepLayout::new(masses).with_bearings(bearings);
        let empty = strips.into_iter().flatten().find(|strip| masses > 0 && strip.traces(layout).is_empty());
        if let Some(strip) = empty {
            self.tell(Message::Bad(format!("strips '{}': expected a mass from 1 to {masses}", strip.name)));
            return;
        }
        self.panels.command_any(&PanelCommand::Strips(strips));
    }

    /// Another mass, or other frequencies, in everything that shows spectra.
    pub(super) fn show_spectra(&mut self, mass: Option<Option<usize>>, along: Option<TypedScaling>) {
        let masses = lock(&self.feed).rotor().map_or(0, |rotor| rotor.len());
        if let Some(Some(mass)) = mass.filter(|mass| mass.is_some_and(|mass| mass >= masses)) {
            self.tell(Message::Bad(format!("spectrum {}: expected a mass from 1 to {masses}", mass + 1)));
            return;
        }
        let along = match along {
            None => None,
            Some(TypedScaling::Auto) => Some(Scaling::Auto),
            Some(TypedScaling::Fix(range)) => {
                let units = lock(&self.feed).units();
                let factor = units.frequency.factor;
                match range.value(&units.table(), Dimension::Frequency, |alone| alone / factor) {
                    Ok(ends) => Some(Scaling::Fix(ends.map(|end| end * factor))),
                    Err(why) => {
                        self.tell(Message::Bad(format!("spectrum '{range}': {why}")));
                        return;
                    }
                }
            }
        };
        if let Some(mass) = mass {
            self.panels.command_any(&PanelCommand::Mass(mass));
        }
        if let Some(along) = along
            && let Some(Err(why)) = self.panels.command_any(&PanelCommand::Frequencies(along))
        {
            self.tell(Message::Bad(format!("spectrum {why}")));
        }
    }

    /// Moves the read-out of the chosen plot.
    pub(super) fn read(&mut self, read: ReadoutMove) {
        let Some(kind) = self.chosen_or_told() else { return };
        let before = self.selection;
        match self.with_view(|view, _, panels| panels.read(kind, view, read)) {
            // Where it stands already it stays.
            Some(point) => {
                let mut after = before;
                after.set(point, read != ReadoutMove::Off);
                self.selection = after;
            }
            None => {
                let name = PANELS[kind].name;
                self.tell(Message::Bad(format!("{name} is read at the moment under the cursor: [ ] < > move it")));
            }
        }
    }
}
