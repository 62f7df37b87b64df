//! One sitting at the dashboard: the threads, started and ended in order around the loop.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use alarms::Limits;
use crossbeam::channel;
use wire::{BenchName, Carrier};

use crate::analysis::Desk;
use crate::app::{App, Streams};
use crate::clerk;
use crate::feed::Feed;
use crate::history::BOUND;
use crate::input;
use crate::keymap::Keymap;
use crate::layout::{Layout, built_in};
use crate::link::{self, Shared, Wires};
use crate::looks::{Look, Wishes};
use crate::terminal::Screen;

/// News that may wait for the clerk, who may wait a second for an answer: all events that a late reader is told, and bulletins.
const NEWS_WAITING: usize = 2 * wire::EVENTS_KEPT;
/// Edits that may wait for the simulation; a key that repeats faster than it answers is not queued without end.
const EDITS_WAITING: usize = 64;

/// Why the dashboard did not start, or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum DashError {
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
    Past(String),
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
    pub wishes: Wishes,
    /// Limits past which alarms rise.
    pub limits: Limits,
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
    /// Whether the machine is only looked at.
    pub read_only: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            history: BOUND,
            layouts: built_in(),
            layout: 0,
            wishes: Wishes::default(),
            limits: Limits::default(),
            bell: false,
            keys: Keymap::default(),
            presets: None,
            commands: None,
            pictures: None,
            read_only: false,
        }
    }
}

/// Whoever started the simulation, if it was us.
pub trait Keeper {
    /// How the simulation ended, once it has.
    fn ended(&mut self) -> Option<String>;
    /// Starts it again.
    ///
    /// # Errors
    /// It cannot be started, in words.
    fn revive(&mut self) -> Result<(), String>;
}

/// Whoever can record the bench, in a process of its own.
pub trait Scribe {
    /// Starts a recording, and says in which file it will be. Does not wait for it.
    ///
    /// # Errors
    /// It cannot be started, in words.
    fn start(&mut self) -> Result<String, String>;
    /// Whether a recording that was started here has not said yet that it records.
    fn is_starting(&self) -> bool;
    /// Asks the recording that was started here to end in good order. Does not wait.
    fn stop(&mut self);
    /// Whether a recording that was started here has not ended yet.
    fn is_at_work(&self) -> bool;
    /// What has become of the recording that was started here: each thing is told once.
    fn news(&mut self) -> Option<ScribeNews>;
}

/// What becomes of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScribeNews {
    /// It records, in this file.
    Records(String),
    /// It has ended, in good order or not, in words.
    Ended(Result<String, String>),
}

/// Shows `bench` on the terminal until a person or a signal ends it.
///
/// # Errors
/// No terminal, or one that fails.
pub fn run<'a, C: Carrier>(
    carrier: C,
    bench: &BenchName,
    keeper: Option<&'a mut dyn Keeper>,
    scribe: Option<&'a mut dyn Scribe>,
    options: &Options,
) -> Result<Ended, DashError> {
    if !Screen::is_possible() {
        return Err(DashError::NoTerminal);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let why = format!("waiting for bench '{bench}'");
    let feed: Shared = Arc::new(Mutex::new(Feed::with_bound(&why, options.history)));
    let (send_news, news) = channel::bounded(NEWS_WAITING);
    let (edits, take_edits) = channel::bounded(EDITS_WAITING);
    let (send_outcome, outcomes) = channel::unbounded();
    let (send_input, inputs) = channel::unbounded();

    // Signals first: from here on they end us in good order.
    let signals = input::signals(send_input.clone())?;
    let (wake, wakes) = channel::bounded(1);
    let idle = Arc::new(AtomicBool::new(false));
    let desk = Desk::open(&wake)?;
    let wires = Wires { news: send_news, wake, idle: idle.clone(), stop: stop.clone() };
    let reader = link::spawn(carrier.clone(), bench.clone(), feed.clone(), wires)?;
    let clerk = clerk::spawn(carrier, bench.clone(), take_edits, news, send_outcome)?;
    let screen = Screen::take(Look::of_environment(options.wishes))?;
    input::keyboard(send_input, stop.clone())?;
    let mut app = App::new(bench.to_string(), feed, edits, keeper, desk, idle, options).recording_with(scribe);
    let ended = app.run(screen, &Streams { inputs, outcomes, wakes });
    stop.store(true, Ordering::Relaxed);
    signals.close();
    drop(app);
    // Both hold shared memory: they must have let go before we report that we are done.
    let _ = reader.join();
    let _ = clerk.join();
    ended
}
