//! What keys do: the topmost layer gets them, and what is typed there becomes actions.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use rotor::Settings;

use super::{App, LOCKED, Message};
use crate::actions::{self, Action};
use crate::complete;
use crate::layers::{Confirmed, Layer, LayerEvent};
use crate::line_editor::{LineEditor, is_letter};
use crate::options::Ended;
use crate::view::PopupRow;
use telemetry::frame_data::FrameData;

impl App<'_> {
    pub(crate) fn press(&mut self, key: KeyEvent) {
        // Who types does not point.
        self.pointer = None;
        let action = self.keymap.action(key);
        // These work whatever lies on top, unless they are a letter of a text.
        let is_text = self.layers.last().is_some_and(Layer::takes_letters) && is_letter(key);
        match action {
            // Quitting may end the machine: of a locked one ctrl-c alone does.
            Some(Action::Quit) if !is_text && self.locked && is_letter(key) => {
                self.tell(Message::Bad(LOCKED.into()));
                return;
            }
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
        let Some(layer) = self.layers.last_mut() else {
            if let Some(action) = action {
                self.act(action);
            }
            return;
        };
        let event = layer.press(key, action);
        if event.closes() {
            self.layers.pop();
        }
        match event {
            LayerEvent::Kept | LayerEvent::Closed => {}
            LayerEvent::Act(action) | LayerEvent::ClosedToAct(action) => self.act(action),
            LayerEvent::Value(text) => self.take_value(&text),
            LayerEvent::Command(line) => {
                self.command_history.push(&line);
                self.command(&line);
            }
            LayerEvent::CommandDropped => self.command_history.stop_browsing(),
            LayerEvent::Complete => self.complete(),
            LayerEvent::Earlier(by) => {
                if let Some(Layer::Command(line)) = self.layers.last_mut()
                    && let Some(earlier) = self.command_history.browse(by, line.text())
                {
                    *line = LineEditor::from(&*earlier);
                }
            }
            LayerEvent::Filter(words) => self.filter = words,
            LayerEvent::FilterDropped => self.filter.clear(),
            LayerEvent::Yes(confirmed) => {
                self.compared.clear();
                match confirmed {
                    Confirmed::Edit(edit) => self.send(edit),
                    Confirmed::Preset(change) => self.confirmed(change),
                }
            }
            LayerEvent::No => {
                self.compared.clear();
                self.tell(Message::Hints);
            }
        }
    }

    /// Takes what is pasted: letters of the line that is being typed, ends of lines as blanks, which complete nothing. Elsewhere it does
    /// nothing, whatever its letters stand for as keys.
    pub(crate) fn paste(&mut self, text: &str) {
        let parts = text.split(char::is_control).filter(|part| !part.is_empty());
        let line = parts.collect::<Vec<_>>().join(" ");
        let line = line.trim_end();
        let is_taken = match self.layers.last() {
            Some(Layer::Value(_)) => line.parse::<f64>().is_ok(),
            Some(layer) => layer.takes_letters(),
            None => false,
        };
        if !is_taken {
            let told = "what is pasted does nothing here: `:` takes it as a command, enter as a value";
            self.tell(Message::Bad(told.into()));
            return;
        }
        for letter in line.chars() {
            self.press(KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
        }
    }

    /// Carries out a command line.
    fn command(&mut self, line: &str) {
        if line.trim().is_empty() {
            return;
        }
        match actions::parse(&actions::with_keys(line, self.settings().as_ref())) {
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
                None => complete::meaning(&whole),
            };
            PopupRow { word, detail }
        };
        let popup = self.completions(line).into_iter().map(offer);
        // What stands there already is no way to go on, unless it is gains and what they would do.
        popup.filter(|offer| known.is_some() || !line.ends_with(&*offer.word)).collect()
    }

    /// The settings that an action would lead to, as they are shown while it is typed.
    pub(super) fn candidate(&self, action: &Action, present: &Settings) -> Option<Settings> {
        match action {
            // Where the speed is on its way to is no moment to judge the gains at.
            Action::RunUp { .. } | Action::Stay | Action::ToRest => None,
            _ => self.edit_of(action, present)?.ok()?.applied(present),
        }
    }
}

/// Whether names of kept gains follow.
fn is_of_presets(line: &str) -> bool {
    ["load ", "save ", "delete "].iter().any(|command| line.starts_with(command))
}
