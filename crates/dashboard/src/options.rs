//! How a dashboard shall be, and how it can end.

use std::io;
use std::path::PathBuf;

use alarms::Limits;

use crate::appearance::AppearanceOptions;
use crate::keymap::Keymap;
use crate::layout::{Layout, built_in};
use crate::on_alarm::OnAlarm;
use telemetry::history::BOUND;

/// Why the dashboard did not start, or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum DashboardError {
    /// Standard input or output is not a terminal.
    #[error(
        "no terminal here: `whirl sim` runs the simulation alone, `whirl tail` prints its telemetry, \
         `whirl set` changes its settings"
    )]
    NoTerminal,
    /// The terminal failed.
    #[error("the terminal failed: {0}")]
    Terminal(#[from] io::Error),
    /// A recording cannot be played.
    #[error("{0}")]
    Recording(String),
    /// A thread panicked; its message is on the terminal.
    #[error("the dashboard failed: the message above says where")]
    Panicked,
}

/// What ended a dashboard that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// A person quit.
    Quit,
    /// A signal came, or the terminal went away.
    Interrupted,
}

/// How the dashboard shall be.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Bytes that the steps it keeps may take; a few thousand steps are kept in any case.
    pub history: usize,
    /// Every layout that can be shown; never empty. A digit shows the one of its number.
    pub layouts: Vec<Layout>,
    /// The one that is shown first, by its place among them.
    pub layout: usize,
    /// Colours and glyphs.
    pub appearance: AppearanceOptions,
    /// Limits past which alarms rise.
    pub limits: Limits,
    /// What an alarm of the machine does to a speed that rises.
    pub on_alarm: OnAlarm,
    /// Whether the terminal's bell rings when one rises.
    pub bell: bool,
    /// What keys stand for.
    pub keys: Keymap,
    /// The folder in which gains are kept by name.
    pub presets: Option<PathBuf>,
    /// The file in which commands are kept from session to session.
    pub commands: Option<PathBuf>,
    /// The folder in which pictures of the screen are kept that are not told where.
    pub pictures: Option<PathBuf>,
    /// Frames a second that are drawn at most for what comes in by itself, at least 1; fewer where the terminal takes no more.
    pub fps: u32,
    /// Whether the machine is only looked at.
    pub read_only: bool,
    /// Whether keys leave the machine alone until a person unlocks it.
    pub locked: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            history: BOUND,
            layouts: built_in(),
            layout: 0,
            appearance: AppearanceOptions::default(),
            limits: Limits::default(),
            on_alarm: OnAlarm::default(),
            bell: false,
            keys: Keymap::default(),
            presets: None,
            commands: None,
            pictures: None,
            fps: 30,
            read_only: false,
            locked: false,
        }
    }
}
