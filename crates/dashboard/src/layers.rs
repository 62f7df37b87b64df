//! What lies on top of the panels: a stack of layers, the topmost of which gets the keys and the mouse. A layer owns its keys:
//! it says what a key means on it, and whoever holds the stack carries that out.

use crossterm::event::{KeyCode, KeyEvent};
use rotor::Settings;
use telemetry::edits::Edit;

use crate::actions::Action;
use crate::input::Mouse;
use crate::line_editor::{LineEditor, LineEvent};
use crate::question::Question;

/// The last line from which help and log can be shown: they stop at their end by themselves.
const LAST_LINE: usize = 5000;

/// One layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layer {
    /// The help, from this line on.
    Help(usize),
    /// Every event and alarm in full, from this line on.
    Log(usize),
    /// A value is being typed for the selected setting.
    Value(LineEditor),
    /// A command is being typed.
    Command(LineEditor),
    /// What the lists shall show is being typed.
    Filter(LineEditor),
    /// A change that would harm waits for a yes: the settings that it leads to, and how it would harm.
    AskUnstable(Edit, Box<Settings>, Question),
    /// Gains that a search found wait for a yes, and what they are.
    AskFound(Edit, Question),
    /// Something that cannot be undone waits for a yes, and what it would do away with.
    AskPreset(PresetChange, Question),
}

/// What is done to files only after a yes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PresetChange {
    /// Keep the gains under a name that is taken.
    Replace(String),
    /// Delete the gains kept under a name.
    Delete(String),
}

/// What a key asks for on a layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LayerEvent {
    /// Nothing beyond the layer.
    Kept,
    /// The layer goes.
    Closed,
    /// Something is done, and the layer stays.
    Act(Action),
    /// The layer goes, and something is done.
    ClosedToAct(Action),
    /// A value is typed to its end.
    Value(String),
    /// A command is typed to its end.
    Command(String),
    /// A command is given up.
    CommandDropped,
    /// Whatever can follow what is typed is to be typed on, as far as it is the same for all.
    Complete,
    /// The command before (-1) or after (1) this one is to be shown in its place.
    Earlier(isize),
    /// Lists shall show this and no more.
    Filter(String),
    /// Lists shall show everything again.
    FilterDropped,
    /// A question is answered with yes: this is to be done.
    Yes(Confirmed),
    /// A question is answered with anything else.
    No,
}

/// What a person has said yes to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Confirmed {
    /// A change of the machine.
    Edit(Edit),
    /// A change of files.
    Preset(PresetChange),
}

impl LayerEvent {
    /// Whether the layer that it comes from goes.
    pub(crate) fn closes(&self) -> bool {
        match self {
            Self::Kept | Self::Act(_) | Self::Complete | Self::Earlier(_) | Self::Filter(_) => false,
            Self::Closed
            | Self::ClosedToAct(_)
            | Self::Value(_)
            | Self::Command(_)
            | Self::CommandDropped
            | Self::FilterDropped
            | Self::Yes(_)
            | Self::No => true,
        }
    }
}

impl Layer {
    /// Whether it waits for a yes.
    pub(crate) fn is_question(&self) -> bool {
        matches!(self, Self::AskUnstable(..) | Self::AskFound(..) | Self::AskPreset(..))
    }

    /// Whether letters are typed on it, whatever they stand for elsewhere.
    pub(crate) fn takes_letters(&self) -> bool {
        matches!(self, Self::Command(_) | Self::Filter(_))
    }

    /// What a key means on it; `action` is what it stands for where nothing lies on top.
    pub(crate) fn press(&mut self, key: KeyEvent, action: Option<Action>) -> LayerEvent {
        match self {
            Self::Help(from) | Self::Log(from) => scroll(from, key, action),
            Self::Value(line) => match line.press_number(key) {
                LineEvent::Done => LayerEvent::Value(line.text().to_owned()),
                LineEvent::Dropped => LayerEvent::Closed,
                // Another row drops what was typed; other keys neither type nor act by accident.
                LineEvent::Earlier(_) | LineEvent::Else => match action {
                    Some(action @ (Action::Select(_) | Action::Help)) => LayerEvent::ClosedToAct(action),
                    _ => LayerEvent::Kept,
                },
                LineEvent::Taken | LineEvent::Complete => LayerEvent::Kept,
            },
            Self::Command(line) => match line.press(key) {
                LineEvent::Done => LayerEvent::Command(line.text().to_owned()),
                LineEvent::Dropped => LayerEvent::CommandDropped,
                LineEvent::Complete => LayerEvent::Complete,
                LineEvent::Earlier(by) => LayerEvent::Earlier(by),
                LineEvent::Taken | LineEvent::Else => LayerEvent::Kept,
            },
            Self::Filter(line) => match line.press(key) {
                LineEvent::Done => LayerEvent::Closed,
                LineEvent::Dropped => LayerEvent::FilterDropped,
                LineEvent::Taken => LayerEvent::Filter(line.text().to_owned()),
                LineEvent::Complete | LineEvent::Earlier(_) | LineEvent::Else => LayerEvent::Kept,
            },
            Self::AskUnstable(..) | Self::AskFound(..) | Self::AskPreset(..) if !is_yes(key) => LayerEvent::No,
            Self::AskUnstable(edit, settings, _) => {
                LayerEvent::Yes(Confirmed::Edit(Edit::Sure(Box::new(edit.clone()), settings.clone())))
            }
            Self::AskFound(edit, _) => LayerEvent::Yes(Confirmed::Edit(edit.clone())),
            Self::AskPreset(change, _) => LayerEvent::Yes(Confirmed::Preset(change.clone())),
        }
    }

    /// Lets the mouse act on it. Returns whether it does: what is typed at the foot leaves the panels to the mouse.
    pub(crate) fn mouse(&mut self, mouse: Mouse) -> bool {
        match (self, mouse) {
            (Self::Help(from) | Self::Log(from), Mouse::Wheel(lines)) => {
                *from = from.saturating_add_signed(3 * lines as isize).min(LAST_LINE);
                true
            }
            (Self::Help(_) | Self::Log(_) | Self::AskUnstable(..) | Self::AskFound(..) | Self::AskPreset(..), _) => {
                true
            }
            (Self::Value(_) | Self::Command(_) | Self::Filter(_), _) => false,
        }
    }
}

fn scroll(from: &mut usize, key: KeyEvent, action: Option<Action>) -> LayerEvent {
    let by = match (action, key.code) {
        (Some(action @ Action::Filter), _) => return LayerEvent::Act(action),
        (Some(Action::Help | Action::Log | Action::Escape | Action::Type), _) => return LayerEvent::Closed,
        (Some(Action::Select(rows)), _) => rows,
        (_, KeyCode::PageDown | KeyCode::Char(' ')) => 10,
        (_, KeyCode::PageUp) => -10,
        _ => return LayerEvent::Kept,
    };
    *from = from.saturating_add_signed(by).min(LAST_LINE);
    LayerEvent::Kept
}

fn is_yes(key: KeyEvent) -> bool {
    matches!(key.code, KeyCode::Char('y' | 'Y'))
}

#[cfg(test)]
mod tests {
    use crossterm::event::KeyModifiers;

    use super::*;

    fn press(layer: &mut Layer, code: KeyCode) -> LayerEvent {
        let key = KeyEvent::new(code, KeyModifiers::NONE);
        let action = crate::keymap::Keymap::default().action(key);
        layer.press(key, action)
    }

    #[test]
    fn a_question_is_answered_by_y_and_by_nothing_else() {
        let asked = Layer::AskFound(Edit::Off, "why".to_owned().into());
        for code in [KeyCode::Enter, KeyCode::Esc, KeyCode::Char('n'), KeyCode::Char(' '), KeyCode::Left] {
            assert_eq!(press(&mut asked.clone(), code), LayerEvent::No, "{code:?}");
        }
        for code in [KeyCode::Char('y'), KeyCode::Char('Y')] {
            assert_eq!(press(&mut asked.clone(), code), LayerEvent::Yes(Confirmed::Edit(Edit::Off)));
        }
    }

    #[test]
    fn what_closes_a_layer_is_told() {
        let mut help = Layer::Help(0);
        assert!(!press(&mut help, KeyCode::PageDown).closes() && help == Layer::Help(10));
        assert!(!press(&mut help, KeyCode::Up).closes() && help == Layer::Help(9));
        assert!(!press(&mut help, KeyCode::Char('0')).closes(), "nothing is turned off behind it");
        assert!(press(&mut help, KeyCode::Esc).closes());
        let mut value = Layer::Value("3".into());
        assert_eq!(press(&mut value, KeyCode::Char('u')), LayerEvent::Kept);
        assert_eq!(press(&mut value, KeyCode::Down), LayerEvent::ClosedToAct(Action::Select(1)));
        assert_eq!(press(&mut value, KeyCode::Enter), LayerEvent::Value("3".into()));
    }

    #[test]
    fn the_mouse_reaches_the_panels_past_what_is_typed_alone() {
        let mut help = Layer::Help(2);
        assert!(help.mouse(Mouse::Wheel(1)) && help == Layer::Help(5));
        assert!(Layer::AskFound(Edit::Off, String::new().into()).mouse(Mouse::Click));
        assert!(!Layer::Command("x".into()).mouse(Mouse::Click));
    }
}
