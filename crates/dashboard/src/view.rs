//! All that a frame shows, as panels see it: the moment, and what a person is doing with it.

use alarms::Alarms;
use rotor::Settings;
use wire::message::Flags;

use crate::keymap::Keymap;
use crate::layers::Layer;
use crate::line_editor::LineEditor;
use crate::selection::Selection;
use telemetry::connection::Connection;
use telemetry::frame_data::FrameData;
use telemetry::jobs::Jobs;
use telemetry::replay::ReplayStatus;
use telemetry::view_time::ViewTime;
use telemetry::what_if::WhatIf;

/// All that a frame shows.
#[derive(Debug)]
pub(crate) struct View<'a> {
    pub(crate) data: &'a FrameData,
    pub(crate) time: &'a ViewTime,
    pub(crate) bench: &'a str,
    pub(crate) cursor: &'a SettingsCursor,
    pub(crate) message: &'a Message,
    /// Where to ask for what takes long to compute.
    pub(crate) jobs: &'a Jobs,
    pub(crate) alarms: &'a Alarms,
    /// What lies on top of the panels, the topmost last.
    pub(crate) layers: &'a [Layer],
    /// The rows of the box above the foot: what can follow the command that is being typed, or gains in force beside those found.
    pub(crate) popup: &'a [PopupRow],
    /// What lists shall show; everything if it is empty.
    pub(crate) filter: &'a str,
    pub(crate) keymap: &'a Keymap,
    /// Settings that are held to compare with.
    pub(crate) held: Option<&'a Settings>,
    /// Where the mouse is, if it was moved after the last key.
    pub(crate) pointer: Option<(u16, u16)>,
    /// What the change that is being typed or asked about would mean.
    pub(crate) what_if: Option<&'a WhatIf>,
    pub(crate) read_only: bool,
    pub(crate) locked: bool,
    /// What a person points at.
    pub(crate) selection: &'a Selection,
    /// The player, if this is a recording.
    pub(crate) replay: Option<ReplayStatus<'a>>,
}

impl View<'_> {
    /// Why what the panels tell is no longer so, in a word: the machine is gone, silent, or held after a trip at the moment that is
    /// looked at. Nothing while it runs.
    pub(crate) fn standstill(&self) -> Option<&'static str> {
        let is_present = self.time.is_live() && self.replay.is_none();
        let flags = self.data.now.map(|now| self.data.track.flags(now));
        let coasts = flags.is_some_and(|flags| flags.has(Flags::COASTING));
        match self.data.connection {
            Connection::Gone if is_present => Some("gone"),
            Connection::Stalled if is_present => Some("stalled"),
            _ if is_present && self.data.tripped && !coasts => Some("tripped"),
            _ => flags.is_some_and(Flags::stands_still).then_some("tripped"),
        }
    }
}

/// What a person is doing with the settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SettingsCursor {
    /// The selected row.
    pub(crate) row: usize,
    /// What has been typed, while a value is being typed.
    pub(crate) typed: Option<LineEditor>,
}

/// What is told at the foot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Message {
    /// What the keys do.
    Hints,
    /// Something has been done.
    Good(String),
    /// Something has not.
    Bad(String),
}

/// One way to go on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PopupRow {
    /// What would be typed.
    pub(crate) word: String,
    /// What that means; may be empty.
    pub(crate) detail: String,
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::LazyLock;

    use super::*;

    static CURSOR: SettingsCursor = SettingsCursor { row: 0, typed: None };
    static HINTS: Message = Message::Hints;
    static KEYMAP: std::sync::LazyLock<Keymap> = std::sync::LazyLock::new(Keymap::default);
    static LIVE: ViewTime = ViewTime::LIVE;
    static JOBS: LazyLock<Jobs> = LazyLock::new(Jobs::inline);
    static NOTHING: Selection = Selection { plot: None, mode: None, frequency: None, speed: None };
    static ALARMS: LazyLock<Alarms> = LazyLock::new(Alarms::default);

    /// A view of `data` by somebody who has pressed nothing yet.
    pub(crate) fn view(data: &FrameData) -> View<'_> {
        View {
            data,
            time: &LIVE,
            bench: "default",
            cursor: &CURSOR,
            message: &HINTS,
            jobs: &JOBS,
            alarms: &ALARMS,
            layers: &[],
            popup: &[],
            filter: "",
            keymap: &KEYMAP,
            held: None,
            pointer: None,
            what_if: None,
            read_only: false,
            locked: false,
            selection: &NOTHING,
            replay: None,
        }
    }
}
