//! All that a frame shows, as panels see it: the moment, and what a person is doing with it.

use alarms::Alarms;

use crate::keymap::Keymap;
use crate::layers::Layer;
use crate::pointed::Pointed;
use crate::typing::Typing;
use telemetry::frame_data::Picture;
use telemetry::jobs::Desk;
use telemetry::replay::Show;
use telemetry::view_time::ViewTime;
use telemetry::what_if::WhatIf;

/// All that a frame shows.
#[derive(Debug)]
pub(crate) struct View<'a> {
    pub(crate) picture: &'a Picture,
    pub(crate) time: &'a ViewTime,
    pub(crate) bench: &'a str,
    pub(crate) cursor: &'a Cursor,
    pub(crate) message: &'a Message,
    /// Where to ask for what takes long to compute.
    pub(crate) desk: &'a Desk,
    pub(crate) alarms: &'a Alarms,
    /// What lies on top of the panels, the topmost last.
    pub(crate) layers: &'a [Layer],
    /// What can follow the command that is being typed.
    pub(crate) offers: &'a [Offer],
    /// What lists shall show; everything if it is empty.
    pub(crate) filter: &'a str,
    pub(crate) keymap: &'a Keymap,
    /// What the change that is being typed or asked about would mean.
    pub(crate) what_if: Option<&'a WhatIf>,
    pub(crate) read_only: bool,
    /// What a person points at.
    pub(crate) pointed: &'a Pointed,
    /// The player, if this is a recording.
    pub(crate) replay: Option<Show<'a>>,
}

/// What a person is doing with the settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cursor {
    /// The selected row.
    pub(crate) row: usize,
    /// What has been typed, while a value is being typed.
    pub(crate) typed: Option<Typing>,
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
pub(crate) struct Offer {
    /// What would be typed.
    pub(crate) word: String,
    /// What that means; may be empty.
    pub(crate) detail: String,
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::LazyLock;

    use super::*;

    static CURSOR: Cursor = Cursor { row: 0, typed: None };
    static HINTS: Message = Message::Hints;
    static KEYMAP: std::sync::LazyLock<Keymap> = std::sync::LazyLock::new(Keymap::default);
    static LIVE: ViewTime = ViewTime::LIVE;
    static DESK: LazyLock<Desk> = LazyLock::new(Desk::at_once);
    static NOTHING: Pointed = Pointed { plot: None, mode: None, frequency: None, speed: None };
    static ALARMS: LazyLock<Alarms> = LazyLock::new(Alarms::default);

    /// A view of `picture` by somebody who has pressed nothing yet.
    pub(crate) fn view(picture: &Picture) -> View<'_> {
        View {
            picture,
            time: &LIVE,
            bench: "default",
            cursor: &CURSOR,
            message: &HINTS,
            desk: &DESK,
            alarms: &ALARMS,
            layers: &[],
            offers: &[],
            filter: "",
            keymap: &KEYMAP,
            what_if: None,
            read_only: false,
            pointed: &NOTHING,
            replay: None,
        }
    }
}
