//! The services of a bench, by name: the one list of them.

use std::fmt;

/// One of the iceoryx2 services of a bench: that of the bench `NAME` is called `whirl/NAME/state` and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Every step.
    State,
    /// Rotor and settings as text.
    Document,
    /// How the bench stands: the whole slow picture.
    Status,
    /// What happens.
    Event,
    /// All that decides how the machine goes on.
    Snapshot,
    /// How a recorder stands.
    Recorder,
    /// Requests for changes, and their answers.
    Command,
    /// That a request waits.
    Wake,
    /// What a controller outside is given.
    Reading,
    /// What it commands.
    Control,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::State,
        Self::Document,
        Self::Status,
        Self::Event,
        Self::Snapshot,
        Self::Recorder,
        Self::Command,
        Self::Wake,
        Self::Reading,
        Self::Control,
    ];

    /// The last part of its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::State => "state",
            Self::Document => "document",
            Self::Status => "status",
            Self::Event => "event",
            Self::Snapshot => "snapshot",
            Self::Recorder => "recorder",
            Self::Command => "command",
            Self::Wake => "wake",
            Self::Reading => "reading",
            Self::Control => "control",
        }
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
