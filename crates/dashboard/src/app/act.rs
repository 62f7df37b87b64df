//! What actions and the mouse do. What keys do is [`super::keys`]'s.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use crossterm::event::{MouseButton, MouseEvent, MouseEventKind};
use ratatui::layout::Position;
use rotor::{C64, Key, Rotor, Settings};

use super::{App, Message, Mouse, PanelRequest, lock};
use crate::actions::Action;
use crate::layers::{Layer, PresetChange};
use crate::line_editor::LineEditor;
use crate::options::Ended;
use crate::panels::registry::PANELS;
use crate::panels::settings::{rows, shown_rows};
use crate::screen;
use crate::screenshot::image::Screenshot;
use telemetry::edits::Edit;
use telemetry::units::Units;

/// The impulse of the impulse key, along y in `e_t` per unit of `tau`: the one of the report's Figs. 3.8 to 3.10.
const IMPULSE: f64 = -2.5;

impl App<'_> {
    pub(super) fn take_typed(&mut self) {
        let Some(Layer::Value(typed)) = self.layers.pop() else { return };
        let Some(key) = self.selected() else { return };
        match key.parameter.parse(typed.text()) {
            Some(value) => self.send(Edit::Set(self.units().settings_of_typed(&[(key, value)]))),
            None => {
                let or_off = if key.parameter.off.is_some() { ", or off" } else { "" };
                self.tell(Message::Bad(format!("{key} = '{}': expected a number{or_off}", typed.text())));
            }
        }
    }

    /// The units that settings are typed and shown in.
    pub(super) fn units(&self) -> Units {
        lock(&self.feed).units()
    }

    /// A setting raised by so many of its steps.
    pub(super) fn nudge(&self, key: Key, steps: f64) -> Edit {
        let units = self.units();
        Edit::Nudge(key, steps * units.step(key) / units.setting(key).factor)
    }

    /// The selected setting, if there is any yet.
    pub(super) fn selected(&self) -> Option<Key> {
        let settings = lock(&self.feed).settings()?;
        let rows = rows(&settings);
        rows.get(self.row.min(rows.len().saturating_sub(1))).copied()
    }

    pub(super) fn settings(&self) -> Option<Settings> {
        lock(&self.feed).settings()
    }

    /// The spin speed of the newest step.
    pub(super) fn present_speed(&self) -> Option<f64> {
        let feed = lock(&self.feed);
        let places = feed.history().kept();
        let last = places.end.checked_sub(1).filter(|last| *last >= places.start)?;
        let track = feed.history().track(&(last..last + 1));
        (track.len() > 0).then(|| track.speed(0))
    }

    /// The change that sends the speed on its way, of speeds and a rate as typed.
    fn run_up(&self, from: Option<f64>, to: f64, rate: f64) -> Result<Edit, String> {
        let keys = ["speed", "ramp"].map(|key| key.parse().map_err(|error: rotor::SettingsError| error.to_string()));
        let [speed, ramp] = keys;
        let values = self.units().settings_of_typed(&[(speed?, to), (ramp?, rate)]);
        let units = self.units();
        if let (Some(from), Some(now)) = (from, self.present_speed()) {
            let typed = now * units.speed.factor;
            if (typed - from).abs() > 1e-3 * from.abs().max(units.speed.factor) {
                let now = units.speed_told(now);
                return Err(format!("it spins at {now}, not at {from}: `:run-up {from} {rate}` goes there first"));
            }
        }
        Ok(Edit::Set(values))
    }

    /// The change that keeps the speed where it is; nothing if it is not on its way.
    fn stay(&self) -> Option<Edit> {
        let now = self.present_speed()?;
        let key = "speed".parse().ok()?;
        (self.settings()?.speed != now).then(|| Edit::Set(vec![(key, now)]))
    }

    /// Says of a row of settings which of them nothing is left of, on a rotor with so many masses.
    fn overridden(&self, values: &[(rotor::Key, f64)]) -> Option<String> {
        let masses = lock(&self.feed).rotor().map_or(rotor::MAX_MASSES, |rotor| rotor.len());
        let mut assigned = rotor::typed::Assigned::new(masses);
        let noted = values.iter().try_for_each(|(key, value)| assigned.key(*key, &format!("{key}={value}")));
        noted.err().map(|undone| undone.to_string())
    }

    /// What is known of the bench: its settings and rotor. Says so if that is nothing yet.
    pub(super) fn machine(&mut self) -> Option<(Settings, Arc<Rotor>)> {
        let known = {
            let feed = lock(&self.feed);
            feed.settings().zip(feed.rotor())
        };
        if known.is_none() {
            self.tell(Message::Bad("no settings are known yet".into()));
        }
        known
    }

    /// Has something done. On a bench the edit thread does it, and asks first if it would make a stable rotor unstable.
    pub(super) fn send(&mut self, edit: Edit) {
        if self.player.is_some() {
            let before = self.settings();
            if let Some(words) = self.play(|player, feed, time| player.edit(&edit, feed, time)) {
                if matches!(edit, Edit::Swap(_)) {
                    self.held = before;
                }
                self.tell(Message::Good(words));
            }
        } else if self.read_only {
            self.tell(Message::Bad("read-only: this dashboard changes nothing".into()));
        } else if self.edits.try_send(edit).is_err() {
            self.tell(Message::Bad("the simulation does not keep up with the changes: wait".into()));
        }
    }

    pub(super) fn act(&mut self, action: Action) {
        if self.act_on_recording(&action) {
            return;
        }
        match action {
            Action::Quit => self.quit = Some(Ended::Quit),
            Action::Escape => {
                // One thing at a time, the topmost first.
                if self.layers.pop().is_none() && !self.selection.clear() {
                    self.filter.clear();
                }
            }
            Action::Help => self.layers.push(Layer::Help(0)),
            Action::Command(line) => self.layers.push(Layer::Command(LineEditor::from(&*line))),
            Action::Filter => self.layers.push(Layer::Filter(LineEditor::from(&*self.filter))),
            Action::Suspend => self.suspend = true,
            Action::Select(rows_down) => {
                let keys = self.settings().map(|settings| rows(&settings)).unwrap_or_default();
                let shown = shown_rows(&keys, &self.filter, self.row);
                let at = shown.iter().position(|row| *row == self.row).unwrap_or(shown.len());
                let to = at.saturating_add_signed(rows_down).min(shown.len().saturating_sub(1));
                self.row = shown.get(to).copied().unwrap_or(0);
            }
            Action::Nudge(steps) => match self.selected() {
                Some(key) => self.send(self.nudge(key, steps)),
                None => self.tell(Message::Bad("no settings are known yet".into())),
            },
            Action::Type => self.layers.push(Layer::Value(LineEditor::default())),
            Action::Set(values) => match self.overridden(&values) {
                Some(why) => self.tell(Message::Bad(why)),
                None => self.send(Edit::Set(self.units().settings_of_typed(&values))),
            },
            Action::Undo => self.send(Edit::Undo),
            Action::Redo => self.send(Edit::Redo),
            Action::Off => self.send(Edit::Off),
            Action::Impulse => {
                let bearing = self.settings().map(|s| s.feedback.bearing);
                if let Some(mass) = bearing {
                    self.send(Edit::Impulse(mass, C64::new(IMPULSE, 0.0)));
                }
            }
            Action::Note(text) => self.send(Edit::Note(text)),
            Action::Acknowledge => match self.alarms.acknowledge() {
                0 => self.tell(Message::Good("no alarm waits to be acknowledged".into())),
                1 => self.tell(Message::Good("1 alarm acknowledged".into())),
                count => self.tell(Message::Good(format!("{count} alarms acknowledged"))),
            },
            Action::RunUp { from, to, rate } => match self.run_up(from, to, rate) {
                Ok(edit) => self.send(edit),
                Err(why) => self.tell(Message::Bad(why)),
            },
            Action::Stay => match self.stay() {
                Some(edit) => self.send(edit),
                None => self.tell(Message::Bad("the speed is not on its way".into())),
            },
            Action::Restart => self.restart(),
            Action::Record => self.record(),
            Action::Search(words) => self.search(&words),
            Action::Hold | Action::Swap | Action::Save(_) | Action::Load(_) | Action::Delete(_) => self.compare(action),
            Action::Pause if self.time.is_live() => self.look(|time, kept, _| time.pause(kept)),
            Action::Pause => self.look(|time, _, _| time.resume()),
            Action::Seek(by) => self.look(|time, kept, seconds| time.seek(by, kept, seconds)),
            Action::Step(by) => self.look(|time, kept, seconds| time.step(by, kept, seconds)),
            Action::Zoom(factor) => self.zoom(factor),
            Action::Span(span) => self.look(|time, _, seconds| time.set_span(span, seconds)),
            Action::Scroll(rows) => self.scroll(rows),
            Action::ZoomReset => self.zoom_reset(),
            Action::Choose(plot) => self.choose(&plot),
            Action::Scale(plot, scalings) => self.scale(plot.as_deref(), &scalings),
            Action::Read(read) => self.read(read),
            Action::Strips(strips) => self.show_strips(strips.as_deref()),
            Action::Spectra(mass, along) => self.show_spectra(mass, along),
            Action::Layout(name) => self.show(&name),
            Action::FrameData(file) => self.keep_screenshot(&file),
            // These are for recordings alone.
            Action::Pace(_) | Action::Event(_) | Action::Loop | Action::GoTo(_) | Action::End(_) => {}
        }
    }

    /// What compares settings: holding some, keeping some, and going back to them.
    fn compare(&mut self, action: Action) {
        let Some(settings) = self.settings() else {
            self.tell(Message::Bad("no settings are known yet".into()));
            return;
        };
        match action {
            Action::Hold => {
                self.held = Some(settings);
                self.tell(Message::Good("held: change the settings, then swap switches between the two".into()));
            }
            Action::Swap => match self.held.clone() {
                Some(held) => self.send(Edit::Swap(Box::new(held))),
                None => self.tell(Message::Bad("nothing is held to switch to: hold the settings first".into())),
            },
            Action::Save(name) if self.presets.has(&name) => {
                let why = format!("'{name}' is kept already{}: replace?", self.effect_of(&name));
                self.layers.push(Layer::AskPreset(PresetChange::Replace(name), why));
            }
            Action::Save(name) => self.save(&name, &settings),
            Action::Delete(name) if self.presets.has(&name) => {
                let why = format!("delete the gains '{name}'{}?", self.effect_of(&name));
                self.layers.push(Layer::AskPreset(PresetChange::Delete(name), why));
            }
            Action::Delete(name) => self.tell(Message::Bad(self.presets.not_found(&name))),
            Action::Load(name) => match self.presets.load(&name, settings.deadband.len()) {
                Ok(feedback) => {
                    let wanted = Settings { feedback, ..settings.clone() };
                    self.send(Edit::Become(Box::new((settings, wanted)), format!("gains '{name}'")));
                }
                Err(why) => self.tell(Message::Bad(why)),
            },
            _ => {}
        }
    }

    /// What gains that are kept would do, in brackets.
    fn effect_of(&mut self, name: &str) -> String {
        let known = self.machine();
        known.map_or_else(String::new, |(settings, rotor)| {
            format!(" ({})", self.presets.describe(name, &rotor, &settings))
        })
    }

    fn save(&mut self, name: &str, settings: &Settings) {
        self.tell(match self.presets.save(name, &settings.feedback) {
            Ok(file) => Message::Good(format!("gains kept as '{name}': {}", file.display())),
            Err(why) => Message::Bad(why),
        });
    }

    /// Does to files what a person has said yes to.
    pub(super) fn confirmed(&mut self, deed: PresetChange) {
        match deed {
            PresetChange::Replace(name) => {
                if let Some((settings, _)) = self.machine() {
                    self.save(&name, &settings);
                }
            }
            PresetChange::Delete(name) => self.tell(match self.presets.delete(&name) {
                Ok(file) => Message::Good(format!("gains '{name}' deleted: {}", file.display())),
                Err(why) => Message::Bad(why),
            }),
        }
    }

    /// A screenshot of what it shows now.
    pub(crate) fn screenshot(&mut self, area: ratatui::layout::Rect) -> Screenshot {
        let mut buffer = ratatui::buffer::Buffer::empty(area);
        self.watch_alarms();
        self.render(area, &mut buffer);
        self.look.finish(&mut buffer);
        Screenshot::of(&buffer)
    }

    /// Moves the lists on the screen.
    fn scroll(&mut self, rows: isize) {
        let area = self.area;
        self.with_view(|view, layout, panels| {
            for (kind, _) in screen::panels(view, layout, area) {
                panels.scroll(kind, rows);
            }
        });
    }

    /// Keeps a screenshot of what the screen shows without what lies on top.
    fn keep_screenshot(&mut self, file: &str) {
        let Some(folder) = self.pictures.clone() else {
            self.tell(Message::Bad("there is no folder for pictures here".into()));
            return;
        };
        self.tell(Message::Hints);
        let screenshot = self.screenshot(self.area);
        self.tell(match crate::screenshot::file::keep(&screenshot, &folder, &self.bench, file) {
            Ok(told) => Message::Good(format!("picture kept: {told}")),
            Err(why) => Message::Bad(format!("picture: {why}")),
        });
    }

    /// Shows another layout, by number or name.
    fn show(&mut self, name: &str) {
        let by_number = || name.parse::<usize>().ok()?.checked_sub(1).filter(|at| *at < self.layouts.len());
        match self.layouts.iter().position(|layout| layout.name() == name).or_else(by_number) {
            Some(at) => self.layout = at,
            None => {
                let names: Vec<&str> = self.layouts.iter().map(crate::layout::Layout::name).collect();
                let message = format!("no layout '{name}': there are {}", names.join(", "));
                self.tell(Message::Bad(message));
            }
        }
    }

    /// Changes the moment that is looked at, and lets the reader know whether anybody watches the newest steps.
    pub(super) fn look(
        &mut self,
        change: impl FnOnce(&mut telemetry::view_time::ViewTime, &std::ops::Range<u64>, f64),
    ) {
        let (kept, seconds) = {
            let feed = lock(&self.feed);
            (feed.history().kept(), feed.step_seconds())
        };
        change(&mut self.time, &kept, seconds);
        self.idle.store(!self.time.is_live(), Ordering::Relaxed);
    }

    /// Restarts the rotor; or the simulation, if that has ended and was ours.
    fn restart(&mut self) {
        if let Some(simulation) = &mut self.simulation
            && simulation.ended().is_some()
        {
            let revived = simulation.restart();
            self.told_end = false;
            self.tell(match revived {
                Ok(()) => Message::Good("the simulation was started again".into()),
                Err(why) => Message::Bad(why.to_string()),
            });
        } else {
            self.send(Edit::Restart);
        }
    }

    /// The mouse: what lies on top first, then the panel under it.
    pub(super) fn mouse(&mut self, event: MouseEvent) {
        let at = (event.column, event.row);
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
        match (self.layers.last_mut(), mouse) {
            (Some(Layer::Help(from)), Mouse::Wheel(lines)) => {
                *from = from.saturating_add_signed(3 * lines as isize).min(1000);
                return;
            }
            (Some(Layer::Help(_) | Layer::AskUnstable(..) | Layer::AskFound(..) | Layer::AskPreset(..)), _) => return,
            _ => {}
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
            Some(PanelRequest::Do(action)) => self.act(action),
            None => {}
        }
    }
}
