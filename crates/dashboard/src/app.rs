//! The loop: input first, then answers, then the clock. What an action does is [`act`]'s.

mod act;
mod bursts;
mod edits;
#[cfg(test)]
mod fuzz;
mod keys;
mod mouse;
mod pacing;
mod playback;
mod plots;
mod recording;
mod search;
#[cfg(test)]
mod tests;
mod watch;

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use alarms::Alarms;
use crossbeam::channel::{self, Receiver, Sender, select_biased};
use ratatui::layout::Rect;
use rotor::Settings;

use crate::actions;
use crate::appearance::Look;
use crate::input::Input;
use crate::keymap::Keymap;
use crate::layers::Layer;
use crate::layout::Layout;
use crate::on_alarm::OnAlarm;
use crate::options::{DashboardError, Ended, Options};
use crate::panels::registry::Panels;
use crate::screen;
use crate::selection::Selection;
use crate::signals;
use crate::terminal::{self, Screen};
use crate::view::{Message, SettingsCursor, View};
use telemetry::command_history::CommandHistory;
use telemetry::connection::Connection;
use telemetry::edits::{Edit, EditOutcome};
use telemetry::frame_data::FrameData;
use telemetry::gain_search::GainSearch;
use telemetry::jobs::Jobs;
use telemetry::presets::Presets;
use telemetry::processes::{RecorderProcess, SimulationProcess};
use telemetry::reader::{SharedFeed, lock};
use telemetry::replay::Player;
use telemetry::view_time::ViewTime;
use telemetry::what_if::WhatIf;

use pacing::{FeedState, Pacing};

/// What is said of a key that would act on a locked machine.
const LOCKED: &str = "locked: ctrl-l unlocks the machine, ctrl-c quits";
/// How long a message stays at the foot.
const MESSAGE: Duration = Duration::from_secs(6);

/// All that the loop waits for, the most urgent first.
#[derive(Debug)]
pub(crate) struct Streams {
    /// Keys, the mouse, signals, resizes.
    pub(crate) inputs: Receiver<Input>,
    /// What became of edits.
    pub(crate) outcomes: Receiver<EditOutcome>,
    /// A token when the reader has something that should not wait for the next frame.
    pub(crate) wakes: Receiver<()>,
}

/// What the dashboard knows beside the feed.
pub(crate) struct App<'a> {
    bench: String,
    feed: SharedFeed,
    edits: Sender<Edit>,
    simulation: Option<&'a mut dyn SimulationProcess>,
    /// The selected row of the settings: here and not in their panel, because keys select, nudge and type on a layout without it too.
    row: usize,
    message: (Message, Instant),
    /// What lies on top of the panels.
    layers: Vec<Layer>,
    /// What lists shall show; everything if it is empty.
    filter: String,
    keymap: Keymap,
    /// Which moment is looked at.
    time: ViewTime,
    jobs: Jobs,
    alarms: Alarms,
    /// What an alarm does to a speed that rises.
    on_alarm: OnAlarm,
    /// Whether the terminal rings when something rises past a limit.
    bell: bool,
    /// Told to the reader while the newest steps are not looked at.
    idle: Arc<AtomicBool>,
    layouts: Vec<Layout>,
    /// Which of them is shown.
    layout: usize,
    panels: Panels,
    presets: Presets,
    command_history: CommandHistory,
    /// Settings to compare with.
    held: Option<Settings>,
    /// Frames a second that are drawn at most for what comes in by itself.
    fps: u32,
    read_only: bool,
    /// Whether keys leave the machine alone until it is unlocked.
    locked: bool,
    /// Where screenshots are kept, and how they look.
    pictures: Option<PathBuf>,
    look: Look,
    /// What the last frame was drawn on.
    area: Rect,
    /// Where the mouse is, where the terminal tells of it.
    pointer: Option<(u16, u16)>,
    /// Where a drag was last.
    dragged: Option<(u16, u16)>,
    /// What the loop is to do with the terminal before the next frame: stop, take it over anew, ring.
    suspend: bool,
    continued: bool,
    rings: bool,
    copies: Option<String>,
    /// Whether the end of the simulation has been told.
    told_end: bool,
    quit: Option<Ended>,
    /// Moves through a recording, if there is no bench.
    player: Option<Player>,
    recorder_process: Option<&'a mut dyn RecorderProcess>,
    /// Seconds of what is kept in memory that go before a recording that starts.
    past_to_record: Option<f64>,
    /// A gain search under way.
    search: Option<GainSearch>,
    /// What the gains in force do and what those do that a search found, while that waits for an answer.
    compared: Vec<crate::view::PopupRow>,
    /// What is pointed at beside a moment.
    selection: Selection,
}

impl<'a> App<'a> {
    /// A dashboard on which nothing has been pressed yet.
    pub(crate) fn new(
        bench: String,
        feed: SharedFeed,
        edits: Sender<Edit>,
        simulation: Option<&'a mut dyn SimulationProcess>,
        jobs: Jobs,
        idle: Arc<AtomicBool>,
        options: &Options,
    ) -> Self {
        Self {
            bench,
            feed,
            edits,
            simulation,
            row: 0,
            message: (Message::Hints, Instant::now()),
            layers: Vec::new(),
            filter: String::new(),
            keymap: options.keys.clone(),
            time: ViewTime::LIVE,
            jobs,
            alarms: Alarms::new(options.limits.clone()),
            on_alarm: options.on_alarm,
            bell: options.bell,
            idle,
            layouts: options.layouts.clone(),
            layout: options.layout,
            panels: Panels::new(),
            presets: Presets(options.presets.clone()),
            command_history: CommandHistory::read(options.commands.clone()),
            held: None,
            fps: options.fps,
            read_only: options.read_only,
            locked: options.locked,
            pictures: options.pictures.clone(),
            look: Look::of_screenshot(options.appearance),
            area: Rect::default(),
            pointer: None,
            dragged: None,
            suspend: false,
            continued: false,
            rings: false,
            copies: None,
            told_end: false,
            quit: None,
            player: None,
            recorder_process: None,
            past_to_record: None,
            search: None,
            compared: Vec::new(),
            selection: Selection::default(),
        }
    }

    /// Shows the bench until a person, a signal or a failure ends it.
    pub(crate) fn run(&mut self, mut screen: Screen, streams: &Streams) -> Result<Ended, DashboardError> {
        let mut pacing = Pacing::new(self.fps);
        loop {
            if let Some(ended) = self.quit {
                return Ok(ended);
            }
            match self.attend(&mut screen, &mut pacing) {
                Err(error) if terminal::is_gone(&error) => return Ok(Ended::Interrupted),
                done => done?,
            }
            let moving = self.player.as_ref().map_or_else(|| self.time.is_live(), Player::is_busy);
            let tick = channel::after(pacing.patience(moving, Instant::now()));
            select_biased! {
                recv(streams.inputs) -> input => {
                    // A burst of keys is one frame.
                    let first = input.unwrap_or(Input::Closed);
                    self.take_all(std::iter::once(first).chain(streams.inputs.try_iter()).collect());
                    pacing.ask();
                }
                recv(streams.outcomes) -> outcome => {
                    if let Ok(outcome) = outcome {
                        self.take_outcome(outcome);
                    }
                    pacing.ask();
                }
                // A reader that has ended wakes nobody: then only the clock does.
                recv(streams.wakes) -> wake => {
                    if wake.is_ok() {
                        pacing.ask();
                    }
                }
                recv(tick) -> _ => {
                    if self.tick() {
                        pacing.ask();
                    }
                }
            }
            if Screen::is_broken() {
                return Err(DashboardError::Panicked);
            }
        }
    }

    /// What the terminal is asked for: to be given away and taken back, to ring, and to show a frame.
    fn attend(&mut self, screen: &mut Screen, pacing: &mut Pacing) -> io::Result<()> {
        if std::mem::take(&mut self.suspend) {
            screen.suspend(signals::stop)?;
            pacing.ask();
        }
        if std::mem::take(&mut self.continued) {
            screen.take_again()?;
            pacing.ask();
        }
        self.watch_alarms();
        if std::mem::take(&mut self.rings) {
            screen.ring();
        }
        if let Some(text) = self.copies.take() {
            screen.copy(&text);
        }
        let (now, feed) = (Instant::now(), self.feed_state());
        if pacing.is_due(feed, now) {
            let taken = screen.draw(|frame| self.render(frame.area(), frame.buffer_mut()))?;
            pacing.drawn(feed.changes, Instant::now(), taken);
        }
        Ok(())
    }

    /// What a frame would be drawn from now.
    fn feed_state(&self) -> FeedState {
        let feed = lock(&self.feed);
        let has_steps = feed.last_step_at().is_some();
        FeedState { changes: feed.changes(), has_steps, is_live: self.time.is_live() }
    }

    /// Draws a frame, in roles: the last pass makes colours of them. Drawing does nothing else: what has come in is heeded between frames.
    pub(crate) fn render(&mut self, area: Rect, buffer: &mut ratatui::buffer::Buffer) {
        self.area = area;
        self.with_view(|view, layout, panels| screen::draw(view, layout, panels, area, buffer));
    }

    /// Does something with all that a frame shows at this moment.
    fn with_view<T>(&mut self, look: impl FnOnce(&View<'_>, &Layout, &mut Panels) -> T) -> T {
        let mut data = lock(&self.feed).frame_data(&self.time, Instant::now());
        data.recorder_starts =
            self.recorder_process.as_ref().is_some_and(|recorder_process| recorder_process.is_starting());
        if let Some(player) = &self.player {
            player.adapt(&mut data);
        }
        if let Some((_, poles)) = data.poles() {
            self.selection.follow(poles);
        }
        // What is typed comes first; then what is run on beside a recording.
        let beside = || self.player.as_ref().and_then(|player| player.what_if().cloned());
        let what_if = self.what_if(&data).or_else(beside);
        let typed = self.layers.iter().rev().find_map(|layer| match layer {
            Layer::Value(typed) => Some(typed.clone()),
            _ => None,
        });
        let popup = match self.layers.last() {
            Some(Layer::Command(line)) => self.popup(line.text(), &data),
            Some(Layer::AskFound(..) | Layer::AskUnstable(..)) => self.compared.clone(),
            _ => Vec::new(),
        };
        let view = View {
            data: &data,
            time: &self.time,
            bench: &self.bench,
            cursor: &SettingsCursor { row: self.row, typed },
            message: &self.message.0,
            layers: &self.layers,
            popup: &popup,
            filter: &self.filter,
            keymap: &self.keymap,
            held: self.held.as_ref(),
            pointer: self.pointer,
            what_if: what_if.as_ref(),
            read_only: self.read_only,
            locked: self.locked,
            jobs: &self.jobs,
            alarms: self.player.as_ref().map_or(&self.alarms, Player::alarms),
            selection: &self.selection,
            replay: self.player.as_ref().map(|player| player.status(&data)),
        };
        look(&view, &self.layouts[self.layout], &mut self.panels)
    }

    /// What the change that is being typed, or waits for a yes, would mean.
    fn what_if(&self, data: &FrameData) -> Option<WhatIf> {
        let present = data.settings.as_ref()?;
        let settings = match self.layers.last()? {
            Layer::Value(typed) => {
                let key = self.selected()?;
                let typed = [(key, key.parameter.read(typed.text()).ok()?)];
                let values = data.units().settings_of_typed(data.rotor.as_deref(), present, &typed).ok()?;
                Edit::Set(values).applied(present)?
            }
            Layer::Command(line) => {
                self.candidate(&actions::parse(&actions::with_keys(line.text(), Some(present))).ok()?, present)?
            }
            Layer::AskFound(edit, _) => edit.applied(present)?,
            Layer::AskUnstable(_, settings, _) => (**settings).clone(),
            _ => return None,
        };
        let (rotor, bench_status) = (data.rotor.as_ref()?, data.bench_status.as_ref()?);
        Some(WhatIf::of(rotor, settings)?.on(rotor, bench_status.dtau, bench_status.rate_hz))
    }

    /// What time alone brings. Returns whether it shows.
    pub(crate) fn tick(&mut self) -> bool {
        let mut shows = self.watch_alarms();
        let now = Instant::now();
        shows |= self.play(|player, feed, time| player.tick(feed, time, now)).unwrap_or(false);
        if self.message.0 != Message::Hints && self.message.1.elapsed() > MESSAGE {
            self.message.0 = Message::Hints;
            shows = true;
        }
        shows |= self.watch_recorder();
        shows |= self.watch_search();
        if !self.told_end
            && let Some(simulation) = &mut self.simulation
            && let Some(how) = simulation.ended()
        {
            self.told_end = true;
            lock(&self.feed).set_connection(Connection::Gone);
            self.tell(Message::Bad(format!("the simulation has ended ({how}): R starts it again")));
            shows = true;
        }
        shows
    }

    fn tell(&mut self, message: Message) {
        self.message = (message, Instant::now());
    }

    fn take(&mut self, input: Input) {
        match input {
            Input::Signal | Input::Closed => self.quit = Some(Ended::Interrupted),
            Input::Resized => {}
            Input::Stop => self.suspend = true,
            Input::Continued => self.continued = true,
            Input::Key(key) => self.press(key),
            Input::Mouse(event) => self.mouse(event),
            Input::Paste(text) => self.paste(&text),
        }
    }
}
