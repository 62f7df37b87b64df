//! What lies on top of the panels: a stack of layers, the topmost of which gets the keys.

use rotor::Settings;

use crate::line_editor::LineEditor;
use telemetry::edits::Edit;

/// One layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layer {
    /// The help, from this line on.
    Help(usize),
    /// A value is being typed for the selected setting.
    Value(LineEditor),
    /// A command is being typed.
    Command(LineEditor),
    /// What the lists shall show is being typed.
    Filter(LineEditor),
    /// A change that would harm waits for a yes: the settings that it leads to, and how it would harm.
    AskUnstable(Edit, Box<Settings>, String),
    /// A change is offered, and why.
    AskFound(Edit, String),
    /// Something that cannot be undone waits for a yes, and what it would do away with.
    AskPreset(PresetChange, String),
}

/// What is done to files only after a yes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PresetChange {
    /// Keep the gains under a name that is taken.
    Replace(String),
    /// Delete the gains kept under a name.
    Delete(String),
}
