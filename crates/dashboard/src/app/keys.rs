//! What keys do: the topmost layer gets them, and what is typed there becomes actions.

use crossterm::event::{KeyCode, KeyEvent};
use rotor::Settings;

use super::{App, Message};
use crate::actions::{self, Action};
use crate::complete;
use crate::layers::Layer;
use crate::line_editor::{LineEditor, LineEvent, is_letter};
use crate::options::Ended;
use crate::view::PopupRow;
use telemetry::edits::Edit;
use telemetry::frame_data::FrameData;

impl App<'_> {
    pub(crate) fn press(&mut self, key: KeyEvent) {
        let action = self.keymap.action(key);
        // These work whatever lies on top, unless they are a letter of a text.
        let is_text = matches!(self.layers.last(), Some(Layer::Command(_) | Layer::Filter(_))) && is_letter(key);
        match action {
            Some(Action::Quit) if !is_text => {
                self.quit = Some(Ended::Quit);
                return;
            }
            Some(Action::Suspend) if !is_letter(key) => {
                self.suspend = true;
                return;
            }
            _ => {}
        }
        match self.layers.last_mut() {
            None => {
                if let Some(action) = action {
                    self.act(action);
                }
            }
            Some(Layer::Help(from)) => match action {
                Some(Action::Select(rows)) => *from = from.saturating_add_signed(rows).min(1000),
                Some(Action::Filter) => self.act(Action::Filter),
                Some(Action::Help | Action::Escape | Action::Type) => drop(self.layers.pop()),
                _ => match key.code {
                    KeyCode::PageDown | KeyCode::Char(' ') => *from = (*from + 10).min(1000),
                    KeyCode::PageUp => *from = from.saturating_sub(10),
                    _ => {}
                },
            },
            Some(Layer::Value(line)) => match line.press_number(key) {
                LineEvent::Done => self.take_typed(),
                LineEvent::Dropped => drop(self.layers.pop()),
                // Another row drops what was typed; other keys neither type nor act by accident.
                LineEvent::Earlier(_) | LineEvent::Else => {
                    if let Some(action @ (Action::Select(_) | Action::Help)) = action {
                        self.layers.pop();
                        self.act(action);
                    }
                }
                LineEvent::Taken | LineEvent::Complete => {}
            },
            Some(Layer::Command(line)) => match line.press(key) {
                LineEvent::Done => {
                    let line = std::mem::take(line);
                    self.layers.pop();
                    self.command_history.push(line.text());
                    self.command(line.text());
                }
                LineEvent::Dropped => {
                    self.layers.pop();
                    self.command_history.stop_browsing();
                }
                LineEvent::Complete => self.complete(),
                LineEvent::Earlier(by) => {
                    if let Some(earlier) = self.command_history.browse(by, line.text()) {
                        *line = LineEditor::from(&*earlier);
                    }
                }
                LineEvent::Taken | LineEvent::Else => {}
            },
            Some(Layer::Filter(line)) => match line.press(key) {
                LineEvent::Done => drop(self.layers.pop()),
                LineEvent::Dropped => {
                    self.layers.pop();
                    self.filter.clear();
                }
                LineEvent::Taken => line.text().clone_into(&mut self.filter),
                LineEvent::Complete | LineEvent::Earlier(_) | LineEvent::Else => {}
            },
            Some(Layer::AskUnstable(..) | Layer::AskFound(..) | Layer::AskPreset(..)) => {
                let asked = self.layers.pop();
                self.beside.clear();
                let yes = matches!(key.code, KeyCode::Char('y' | 'Y'));
                match asked {
                    Some(Layer::AskUnstable(edit, settings, _)) if yes => {
                        self.send(Edit::Sure(Box::new(edit), settings))
                    }
                    Some(Layer::AskFound(edit, _)) if yes => self.send(edit),
                    Some(Layer::AskPreset(deed, _)) if yes => self.confirmed(deed),
                    _ => self.tell(Message::Hints),
                }
            }
        }
    }

    /// Carries out a command line.
    fn command(&mut self, line: &str) {
        if line.trim().is_empty() {
            return;
        }
        match actions::parse(line) {
            Ok(action) => self.act(action),
            Err(why) => self.tell(Message::Bad(why)),
        }
    }

    /// Every way to go on with a command line.
    fn completions(&self, line: &str) -> Vec<String> {
        let layouts: Vec<String> = self.layouts.iter().map(|layout| layout.name().to_owned()).collect();
        let presets = if is_of_presets(line) { self.presets.names() } else { Vec::new() };
        complete::completions(line, &layouts, &presets)
    }

    /// Types on what all that can follow have in common.
    fn complete(&mut self) {
        let Some(Layer::Command(line)) = self.layers.last() else { return };
        let common = complete::common(&self.completions(line.text()));
        if let Some(Layer::Command(line)) = self.layers.last_mut()
            && common.len() > line.text().len()
        {
            *line = LineEditor::from(&*common);
        }
    }

    /// What can follow a command line, with what it means: kept gains with the minimum damping that they would give.
    pub(super) fn popup(&self, line: &str, data: &FrameData) -> Vec<PopupRow> {
        let known = data.rotor.as_ref().zip(data.settings.as_ref()).filter(|_| is_of_presets(line));
        let offer = |whole: String| {
            let word = whole.trim_end().rsplit(' ').next().unwrap_or_default().to_owned();
            let detail = match known {
                Some((rotor, settings)) => self.presets.describe(&word, rotor, settings),
                None => complete::meaning(&word),
            };
            PopupRow { word, detail }
        };
        let popup = self.completions(line).into_iter().map(offer);
        // What stands there already is no way to go on, unless it is gains and what they would do.
        popup.filter(|offer| known.is_some() || !line.ends_with(&*offer.word)).collect()
    }

    /// The settings that an action would lead to.
    pub(super) fn candidate(&self, action: &Action, present: &Settings) -> Option<Settings> {
        let edit = match action {
            Action::Set(values) => Edit::Set(self.units().settings_of_typed(values)),
            Action::Off => Edit::Off,
            Action::Nudge(steps) => {
                let key = self.selected()?;
                self.nudge(key, *steps)
            }
            Action::Swap => Edit::Swap(Box::new(self.held.clone()?)),
            Action::Load(name) => {
                let feedback = self.presets.load(name, present.deadband.len()).ok()?;
                return Some(Settings { feedback, ..present.clone() });
            }
            _ => return None,
        };
        edit.applied(present)
    }
}

/// Whether names of kept gains follow.
fn is_of_presets(line: &str) -> bool {
    ["load ", "save ", "delete "].iter().any(|command| line.starts_with(command))
}
