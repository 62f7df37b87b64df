//! What actions do. What keys and the mouse do is [`super::keys`]'s and [`super::mouse`]'s, and changes of the machine are [`super::edits`]'s.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use alarms::{AskedLimit, Watch};
use rotor::{Key, Rotor, Settings};
use units::Typed;

use super::{App, LOCKED, Message, lock};
use crate::actions::{Action, TypedLimit};
use crate::layers::{Layer, PresetChange};
use crate::line_editor::LineEditor;
use crate::options::Ended;
use crate::panels::settings::{every_row, rows, shown_rows};
use crate::question::Question;
use crate::screen;
use crate::screenshot::image::Screenshot;
use telemetry::edits::Edit;
use telemetry::units::ScreenUnits;

impl App<'_> {
    /// The units that settings are typed and shown in.
    pub(super) fn units(&self) -> ScreenUnits {
        lock(&self.feed).units()
    }

    /// The selected setting, if there is any yet.
    pub(super) fn selected(&self) -> Option<Key> {
        let (settings, rotor) = self.settings_and_rotor();
        let rows = rows(&settings?, rotor.as_deref());
        rows.get(self.row.min(rows.len().saturating_sub(1))).copied()
    }

    /// The settings in force and the rotor, of one moment.
    pub(super) fn settings_and_rotor(&self) -> (Option<Settings>, Option<Arc<Rotor>>) {
        let feed = lock(&self.feed);
        (feed.settings(), feed.rotor())
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
        (!track.is_empty()).then(|| track.speed(0))
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

    pub(super) fn act(&mut self, action: Action) {
        // What went wrong before is over with the next thing done, though that says nothing itself.
        if matches!(self.message.0, Message::Bad(_)) {
            self.tell(Message::Hints);
        }
        if self.act_on_recording(&action) {
            return;
        }
        match action {
            // As the key: of a locked machine ctrl-c alone quits.
            Action::Quit if self.locked => self.tell(Message::Bad(LOCKED.into())),
            Action::Quit => self.quit = Some(Ended::Quit),
            Action::Escape => {
                // One thing at a time, the topmost first.
                if self.layers.pop().is_none() && !self.selection.clear() {
                    self.filter.clear();
                }
            }
            Action::Help => self.layers.push(Layer::Help(0)),
            Action::Copy(all) => self.copy(all),
            Action::Log => self.layers.push(Layer::Log(0)),
            Action::Peak(reset) => self.peak(reset),
            Action::Command(line) => self.layers.push(Layer::Command(LineEditor::from(&*line))),
            Action::Filter => self.layers.push(Layer::Filter(LineEditor::from(&*self.filter))),
            Action::Suspend => self.suspend = true,
            Action::Lock => {
                self.locked = !self.locked;
                let told = if self.locked { LOCKED } else { "unlocked: keys act on the machine" };
                self.tell(Message::Good(told.into()));
            }
            Action::Edit(Edit::Restart) if self.locked => self.tell(Message::Bad(LOCKED.into())),
            Action::Select(rows_down) => {
                let (settings, rotor) = self.settings_and_rotor();
                let shown = |now: &Settings| shown_rows(now, rotor.as_deref(), &self.filter, self.row);
                let shown = settings.as_ref().map(shown).unwrap_or_default();
                let at = shown.iter().position(|row| *row == self.row).unwrap_or(shown.len());
                let to = at.saturating_add_signed(rows_down).min(shown.len().saturating_sub(1));
                self.row = shown.get(to).copied().unwrap_or(0);
            }
            Action::Type => self.layers.push(Layer::Value(LineEditor::default())),
            Action::Edit(Edit::Restart) => self.restart(),
            Action::Edit(edit) => self.send(edit),
            Action::NudgeSelected(_)
            | Action::SetTyped(_)
            | Action::RunUp { .. }
            | Action::Stay
            | Action::ToRest
            | Action::Drill(_)
            | Action::StrikeBearing
            | Action::SwapHeld
            | Action::Load(_) => self.change(&action),
            Action::Acknowledge => match self.alarms.acknowledge() {
                0 => self.tell(Message::Good("no alarm waits to be acknowledged".into())),
                1 => self.tell(Message::Good("1 alarm acknowledged".into())),
                count => self.tell(Message::Good(format!("{count} alarms acknowledged"))),
            },
            Action::Limit(watch, asked) => self.limit(watch, asked),
            Action::Record => self.record(None),
            Action::RecordLast(seconds) => self.record(Some(seconds)),
            Action::Search(words) => self.search(&words),
            Action::Hold | Action::Save(_) | Action::Delete(_) => self.keep(action),
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

    /// Has settings put on the clipboard, as `:set` and `--set` take them.
    fn copy(&mut self, all: bool) {
        let (Some(settings), rotor) = self.settings_and_rotor() else {
            self.tell(Message::Bad("no settings are known yet".into()));
            return;
        };
        let units = self.units();
        let told = |key: &Key| {
            let value = settings.get(*key).ok()?;
            Some(if key.parameter.off == Some(value) && key.parameter.name != "seed" {
                format!("{}=off", settings.label(*key))
            } else {
                // With its unit, as a number alone is in micrometres here and in metres there; in one word.
                let (name, unit) = (settings.label(*key), units.setting(*key));
                let said = if units.scales.is_some() { unit.name.replace(' ', ".") } else { String::new() };
                format!("{name}={}{said}", text::number::significant(value * unit.factor, 15))
            })
        };
        let keys = if all { every_row(&settings, rotor.as_deref()) } else { self.selected().into_iter().collect() };
        let words: Vec<String> = keys.iter().filter_map(told).collect();
        let words = words.join(" ");
        self.tell(Message::Good(format!("to the terminal's clipboard: {words}")));
        self.copies = Some(words);
    }

    /// Looks at the step with the largest control force of those that count, or has the count begin anew.
    fn peak(&mut self, reset: bool) {
        if reset {
            lock(&self.feed).reset_peak();
            self.tell(Message::Good("the largest force counts from now on".into()));
            return;
        }
        let now = self.with_view(|view, _, _| view.data.now.map(|now| view.data.track.index_of(now)));
        let found = now.and_then(|now| lock(&self.feed).history().peak_place(now));
        match found {
            Some(place) => self.look(|time, kept, seconds| time.look_at(place, kept, seconds)),
            None => self.tell(Message::Bad("no step with a control force is kept".into())),
        }
    }

    /// Sets the limits of something that is watched, typed in the units of the bench.
    fn limit(&mut self, watch: Watch, asked: TypedLimit) {
        if self.player.is_some() {
            self.tell(Message::Bad("what a recording tells of alarms was judged when it was made".into()));
            return;
        }
        // Those of the panels, which know the bearing's mass.
        let units = self.with_view(|view, _, _| view.data.units());
        let unit = crate::panels::alarms::unit_of(watch, &units);
        let asked = match asked {
            TypedLimit::Off => AskedLimit::Off,
            TypedLimit::Machine => AskedLimit::Machine,
            TypedLimit::Pair(pair) => {
                let of = |typed: Typed| {
                    let value =
                        units.quantity(telemetry::units::dimension_of(watch), typed, |alone| alone / unit.factor);
                    value.map_err(|expected| format!("alarm {watch} '{typed}': {expected}"))
                };
                match (of(pair[0]), of(pair[1])) {
                    (Ok(warning), Ok(alarm)) => AskedLimit::Pair([warning, alarm]),
                    (Err(why), _) | (_, Err(why)) => {
                        self.tell(Message::Bad(why));
                        return;
                    }
                }
            }
        };
        let mut limits = self.alarms.limits().clone();
        if let Err(expected) = asked.set(&mut limits, watch) {
            self.tell(Message::Bad(format!("alarm {watch}: expected {expected}")));
            return;
        }
        if let Some(bench_status) = lock(&self.feed).bench_status() {
            limits.follow(bench_status);
        }
        let follows = if limits.follows(watch) { ", following the machine" } else { "" };
        let told = limits.pair(watch).map_or_else(
            || "no limit".to_owned(),
            |[warning, alarm]| format!("warning {}, alarm {}", unit.told(warning, 5), unit.told(alarm, 5)),
        );
        self.alarms.limit(limits);
        self.tell(Message::Good(format!("{watch}: {told}{follows}")));
    }

    /// Keeps the settings in force to compare with, for the moment or under a name; or does away with what is kept.
    fn keep(&mut self, action: Action) {
        let Some(settings) = self.settings() else {
            self.tell(Message::Bad("no settings are known yet".into()));
            return;
        };
        match action {
            Action::Hold => {
                self.held = Some(settings);
                self.tell(Message::Good("held: change the settings, then swap switches between the two".into()));
            }
            Action::Save(name) if self.presets.has(&name) => {
                let parts = [
                    (0, format!("'{name}' is kept already")),
                    (1, self.effect_of(&name)),
                    (0, ": replace?".to_owned()),
                ];
                self.layers.push(Layer::AskPreset(PresetChange::Replace(name), Question::of(parts)));
            }
            Action::Save(name) => self.save(&name, &settings),
            Action::Delete(name) if self.presets.has(&name) => {
                let parts =
                    [(0, format!("delete the gains '{name}'")), (1, self.effect_of(&name)), (0, "?".to_owned())];
                self.layers.push(Layer::AskPreset(PresetChange::Delete(name), Question::of(parts)));
            }
            Action::Delete(name) => self.tell(Message::Bad(self.presets.not_found(&name).to_string())),
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
            Err(why) => Message::Bad(why.to_string()),
        });
    }

    /// Does to files what a person has said yes to.
    pub(super) fn confirmed(&mut self, change: PresetChange) {
        match change {
            PresetChange::Replace(name) => {
                if let Some((settings, _)) = self.machine() {
                    self.save(&name, &settings);
                }
            }
            PresetChange::Delete(name) => self.tell(match self.presets.delete(&name) {
                Ok(file) => Message::Good(format!("gains '{name}' deleted: {}", file.display())),
                Err(why) => Message::Bad(why.to_string()),
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
                let meant = text::meant(name, &names);
                let message = format!("no layout '{name}': {meant}there are {}", names.join(", "));
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
}
