//! The loop: input first, then answers, then the clock; and what each of them does.

mod past;
mod recording;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam::channel::{self, Receiver, Sender, select_biased};
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use rotor::{C64, Key};

use crate::alarms::{Alarms, Limits, Reading};
use crate::analysis::Desk;
use crate::clerk::{Edit, Outcome};
use crate::feed::Contact;
use crate::input::Input;
use crate::keymap::{self, Action};
use crate::layout::Layout;
use crate::link::{Shared, lock};
use crate::panels::registry::Panels;
use crate::panels::settings::{Cursor, rows};
use crate::panels::status::Message;
use crate::replay::Player;
use crate::screen::{self, View};
use crate::session::{DashError, Ended, Keeper, Options, Scribe};
use crate::terminal::Screen;
use crate::view_time::ViewTime;

/// Time between two frames while everything moves: 30 a second.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two looks while the picture is paused.
const PAUSED_FRAME: Duration = Duration::from_millis(250);
/// How often the age of silent data is drawn anew.
const SILENT_FRAME: Duration = Duration::from_millis(200);
/// How long a message stays at the foot.
const MESSAGE: Duration = Duration::from_secs(6);
/// The impulse of the impulse key, along y in `e_t` per unit of `tau`: the one of the report's Figs. 3.8 to 3.10.
const IMPULSE: f64 = -2.5;

/// All that the loop waits for, the most urgent first.
#[derive(Debug)]
pub(crate) struct Streams {
    /// Keys, signals, resizes.
    pub(crate) inputs: Receiver<Input>,
    /// What became of edits.
    pub(crate) outcomes: Receiver<Outcome>,
    /// A token when the reader has something that should not wait for the next frame.
    pub(crate) wakes: Receiver<()>,
}

/// What the dashboard knows beside the feed.
pub(crate) struct App<'a> {
    bench: String,
    feed: Shared,
    edits: Sender<Edit>,
    keeper: Option<&'a mut dyn Keeper>,
    cursor: Cursor,
    message: (Message, Instant),
    help: bool,
    /// Which moment is looked at.
    time: ViewTime,
    desk: Desk,
    alarms: Alarms,
    /// Told to the reader while the newest steps are not looked at.
    idle: Arc<AtomicBool>,
    layouts: Vec<Layout>,
    /// Which of them is shown.
    layout: usize,
    panels: Panels,
    told_end: bool,
    quit: Option<Ended>,
    /// Moves through a recording, if there is no bench.
    player: Option<Player>,
    scribe: Option<&'a mut dyn Scribe>,
}

impl<'a> App<'a> {
    /// A dashboard on which nothing has been pressed yet.
    pub(crate) fn new(
        bench: String,
        feed: Shared,
        edits: Sender<Edit>,
        keeper: Option<&'a mut dyn Keeper>,
        desk: Desk,
        idle: Arc<AtomicBool>,
        options: &Options,
    ) -> Self {
        Self {
            bench,
            feed,
            edits,
            keeper,
            cursor: Cursor::default(),
            message: (Message::Hints, Instant::now()),
            help: false,
            time: ViewTime::LIVE,
            desk,
            alarms: Alarms::new(Limits::default()),
            idle,
            layouts: options.layouts.clone(),
            layout: options.layout,
            panels: Panels::new(),
            told_end: false,
            quit: None,
            player: None,
            scribe: None,
        }
    }

    /// Shows the bench until a person, a signal or a failure ends it.
    pub(crate) fn run(&mut self, mut screen: Screen, streams: &Streams) -> Result<Ended, DashError> {
        let mut drawn = Drawn::default();
        loop {
            if let Some(ended) = self.quit {
                return Ok(ended);
            }
            let now = Instant::now();
            if self.is_due(&drawn, now) {
                let changes = lock(&self.feed).changes();
                self.draw(&mut screen)?;
                drawn = Drawn { at: Some(now), changes, stale: false };
            }
            let moving = self.player.as_ref().map_or_else(|| self.time.is_live(), Player::is_busy);
            let tick = channel::after(if moving { FRAME } else { PAUSED_FRAME });
            select_biased! {
                recv(streams.inputs) -> input => {
                    self.take(input.unwrap_or(Input::Closed));
                    // A burst of keys is one frame.
                    while let Ok(input) = streams.inputs.try_recv() {
                        self.take(input);
                    }
                    drawn.stale = true;
                }
                recv(streams.outcomes) -> outcome => {
                    if let Ok(outcome) = outcome {
                        self.tell(match outcome {
                            Outcome::Done(text) => Message::Good(text),
                            Outcome::Refused(text) => Message::Bad(text),
                        });
                    }
                    drawn.stale = true;
                }
                // A reader that has ended wakes nobody: then only the clock does.
                recv(streams.wakes) -> wake => drawn.stale |= wake.is_ok(),
                recv(tick) -> _ => drawn.stale |= self.tick(),
            }
            if Screen::is_broken() {
                return Err(DashError::Panicked);
            }
        }
    }

    /// Whether a frame would show something new.
    fn is_due(&self, drawn: &Drawn, now: Instant) -> bool {
        let Some(at) = drawn.at else { return true };
        if drawn.stale {
            return true;
        }
        if !self.time.is_live() {
            return false;
        }
        let age = now.saturating_duration_since(at);
        let feed = lock(&self.feed);
        (feed.changes() != drawn.changes && age >= FRAME.mul_f64(0.9))
            || (feed.heard().is_some() && age >= SILENT_FRAME)
    }

    fn draw(&mut self, screen: &mut Screen) -> io::Result<()> {
        let (mut picture, reading) = {
            let mut feed = lock(&self.feed);
            (feed.picture(&self.time, Instant::now()), feed.reading())
        };
        self.heed(&reading);
        if let Some(player) = &self.player {
            player.finish(&mut picture);
        }
        let typed = self.player.as_ref().and_then(|player| player.typed.as_ref());
        let going = typed.map(|typed| Message::Good(format!("go to tau {typed}_   enter goes, esc does not")));
        let view = View {
            picture: &picture,
            time: &self.time,
            bench: &self.bench,
            cursor: &self.cursor,
            message: going.as_ref().unwrap_or(&self.message.0),
            desk: &self.desk,
            alarms: &self.alarms,
            help: self.help,
            replay: self.player.as_ref().map(|player| player.shown(&picture)),
        };
        let (layout, panels) = (&self.layouts[self.layout], &mut self.panels);
        screen.draw(|frame| screen::draw(&view, layout, panels, frame.area(), frame.buffer_mut()))
    }

    /// What time alone brings. Returns whether it shows.
    fn tick(&mut self) -> bool {
        // Alarms go on while the view stands, and no peak falls between two frames.
        let reading = lock(&self.feed).reading();
        let mut shows = self.heed(&reading);
        let now = Instant::now();
        shows |= self.play(|player, feed, time| player.tick(feed, time, now)).unwrap_or(false);
        if self.message.0 != Message::Hints && self.message.1.elapsed() > MESSAGE {
            self.message.0 = Message::Hints;
            shows = true;
        }
        shows |= self.watch_scribe();
        if !self.told_end
            && let Some(keeper) = &mut self.keeper
            && let Some(how) = keeper.ended()
        {
            self.told_end = true;
            lock(&self.feed).stand(Contact::Gone);
            self.tell(Message::Bad(format!("the simulation has ended ({how}): R starts it again")));
            shows = true;
        }
        shows
    }

    /// Holds a reading against the limits. Returns whether an alarm rose or fell.
    fn heed(&mut self, reading: &Reading) -> bool {
        // What a recording tells is past, and comes in any order.
        if self.player.is_some() {
            return false;
        }
        let changed = self.alarms.read(reading);
        if self.alarms.rings() {
            Screen::ring();
        }
        changed
    }

    fn tell(&mut self, message: Message) {
        self.message = (message, Instant::now());
    }

    fn take(&mut self, input: Input) {
        match input {
            Input::Signal | Input::Closed => self.quit = Some(Ended::Interrupted),
            Input::Resized => {}
            Input::Key(key) => self.press(key),
        }
    }

    fn press(&mut self, key: KeyEvent) {
        if self.typing_time(key) {
            return;
        }
        if self.cursor.typed.is_some() && self.typing(key) {
            return;
        }
        match keymap::action(key) {
            Some(action) => self.act(action),
            None => self.help &= !matches!(key.code, KeyCode::Enter),
        }
    }

    /// A key while a value is being typed. Returns whether it was part of that.
    fn typing(&mut self, key: KeyEvent) -> bool {
        let Some(typed) = &mut self.cursor.typed else { return false };
        let plain = !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT);
        match key.code {
            KeyCode::Char(c @ ('0'..='9' | '.' | '-' | '+' | 'e' | 'E')) if plain => {
                if typed.len() < 16 {
                    typed.push(c);
                }
            }
            KeyCode::Backspace => {
                typed.pop();
            }
            KeyCode::Esc => self.cursor.typed = None,
            KeyCode::Enter => self.take_typed(),
            // Quitting works everywhere; other keys neither type nor act by accident.
            _ => return matches!(keymap::action(key), None | Some(Action::Nudge(_) | Action::Off)),
        }
        true
    }

    fn take_typed(&mut self) {
        let Some(typed) = self.cursor.typed.take() else { return };
        let Some(key) = self.selected() else { return };
        match typed.parse::<f64>() {
            Ok(value) => self.edit(Edit::Set(key, value)),
            Err(_) => self.tell(Message::Bad(format!("{key} = '{typed}': expected a number"))),
        }
    }

    /// The selected setting, if there is any yet.
    fn selected(&mut self) -> Option<Key> {
        let settings = lock(&self.feed).settings()?;
        let rows = rows(&settings);
        self.cursor.row = self.cursor.row.min(rows.len().saturating_sub(1));
        rows.get(self.cursor.row).copied()
    }

    fn edit(&mut self, edit: Edit) {
        if self.player.is_some() {
            if let Some(words) = self.play(|player, feed, time| player.edit(&edit, feed, time)) {
                self.tell(Message::Good(words));
            }
            return;
        }
        if self.edits.try_send(edit).is_err() {
            self.tell(Message::Bad("the simulation does not keep up with the changes: wait".into()));
        }
    }

    fn act(&mut self, action: Action) {
        if self.act_on_past(action) {
            return;
        }
        match action {
            Action::Quit => self.quit = Some(Ended::Quit),
            Action::Escape => {
                self.help = false;
                self.cursor.typed = None;
            }
            Action::Help => self.help = !self.help,
            Action::Select(rows_down) => {
                self.cursor.typed = None;
                let settings = lock(&self.feed).settings();
                let count = settings.map_or(0, |settings| rows(&settings).len());
                self.cursor.row = self.cursor.row.saturating_add_signed(rows_down).min(count.saturating_sub(1));
            }
            Action::Nudge(steps) => match self.selected() {
                Some(key) => self.edit(Edit::Nudge(key, steps * key.parameter.step)),
                None => self.tell(Message::Bad("no settings are known yet".into())),
            },
            Action::Type => self.cursor.typed = Some(String::new()),
            Action::Undo => self.edit(Edit::Undo),
            Action::Redo => self.edit(Edit::Redo),
            Action::Off => self.edit(Edit::Off),
            Action::Impulse => {
                let bearing = lock(&self.feed).settings().map(|s| s.feedback.bearing);
                if let Some(mass) = bearing {
                    self.edit(Edit::Impulse(mass, C64::new(IMPULSE, 0.0)));
                }
            }
            Action::Pause => {
                if self.time.is_live() {
                    self.time.pause(&self.kept().0);
                } else {
                    self.time.resume();
                }
                self.look();
            }
            Action::Layout(at) => match self.layouts.get(at) {
                Some(_) => self.layout = at,
                None => self.tell(Message::Bad(format!("no layout {}: there are {}", at + 1, self.layouts.len()))),
            },
            Action::Seek(by) => {
                let (kept, seconds) = self.kept();
                self.time.seek(by, &kept, seconds);
                self.look();
            }
            Action::Step(by) => {
                let (kept, seconds) = self.kept();
                self.time.step(by, &kept, seconds);
                self.look();
            }
            Action::Zoom(factor) => self.time.zoom(factor, self.kept().1),
            Action::ZoomReset => self.time.reset_span(self.kept().1),
            Action::Acknowledge => match self.alarms.acknowledge() {
                0 => self.tell(Message::Good("no alarm waits to be acknowledged".into())),
                1 => self.tell(Message::Good("1 alarm acknowledged".into())),
                count => self.tell(Message::Good(format!("{count} alarms acknowledged"))),
            },
            Action::Restart => self.restart(),
            Action::Record => self.record(),
            // These are for recordings alone.
            Action::Speed(_) | Action::Event(_) | Action::Loop | Action::GoTo | Action::End(_) => {}
        }
    }

    /// The steps that are kept, and the seconds between them.
    fn kept(&self) -> (std::ops::Range<u64>, f64) {
        let feed = lock(&self.feed);
        (feed.history().places(), feed.seconds())
    }

    /// Lets the reader know whether anybody watches the newest steps.
    fn look(&self) {
        self.idle.store(!self.time.is_live(), Ordering::Relaxed);
    }

    /// Restarts the rotor; or the simulation, if that has ended and was ours.
    fn restart(&mut self) {
        if let Some(keeper) = &mut self.keeper
            && keeper.ended().is_some()
        {
            let revived = keeper.revive();
            self.told_end = false;
            self.tell(match revived {
                Ok(()) => Message::Good("the simulation was started again".into()),
                Err(why) => Message::Bad(why),
            });
        } else {
            self.edit(Edit::Restart);
        }
    }
}

/// What was last drawn.
#[derive(Debug, Default)]
struct Drawn {
    at: Option<Instant>,
    changes: u64,
    /// Something other than the feed has changed since.
    stale: bool,
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::feed::{Feed, tests};

    /// Presses keys on a dashboard with a feed of the three-mass rotor, and returns what it then wants.
    fn pressed(keys: &[KeyCode]) -> (Vec<Edit>, Cursor, Message, bool) {
        let mut feed = Feed::new("");
        feed.read(tests::bulletin("three-mass", "composite"));
        feed.hear(&tests::state(3, 0), Instant::now());
        let (edits, taken) = channel::bounded(64);
        let feed = Arc::new(Mutex::new(feed));
        let mut app =
            App::new("default".into(), feed, edits, None, Desk::at_once(), Arc::default(), &Options::default());
        for code in keys {
            app.press(KeyEvent::new(*code, KeyModifiers::NONE));
        }
        (taken.try_iter().collect(), app.cursor, app.message.0, app.quit.is_some())
    }

    fn key(name: &str) -> Key {
        name.parse().unwrap()
    }

    use KeyCode::{Char, Down, Enter, Esc, Left, Right, Up};

    #[test]
    fn arrows_select_and_nudge() {
        let (edits, cursor, ..) = pressed(&[Down, Down, Right, Up, Left]);
        assert_eq!(cursor.row, 1);
        assert_eq!(
            edits,
            [Edit::Nudge(key("deadband"), 0.1), Edit::Nudge(key("trip"), -10.0)],
            "rows are speed, trip, deadband, ..."
        );
        let (_, top, ..) = pressed(&[Up]);
        let (_, bottom, ..) = pressed(&[Down; 40]);
        assert_eq!((top.row, bottom.row), (0, 6));
    }

    #[test]
    fn typing_a_number_sets_the_selected_row() {
        let (edits, cursor, ..) = pressed(&[Enter, Char('3'), Char('.'), Char('5'), Enter]);
        assert_eq!((edits, cursor.typed), (vec![Edit::Set(key("speed"), 3.5)], None));
        // 0 alone turns control off.
        let (edits, ..) = pressed(&[Enter, Char('0'), Char('.'), Char('5'), Enter, Char('0')]);
        assert_eq!(edits, [Edit::Set(key("speed"), 0.5), Edit::Off]);
        let (edits, cursor, ..) = pressed(&[Enter, Char('3'), Char('u'), Esc]);
        assert_eq!((edits, cursor.typed), (vec![Edit::Undo], None));
        let (edits, _, message, _) = pressed(&[Enter, Char('3'), Char('-'), Enter]);
        assert_eq!((edits.len(), message), (0, Message::Bad("speed = '3-': expected a number".into())));
    }

    #[test]
    fn quitting_works_from_everywhere() {
        for before in [&[][..], &[Char('?')], &[Char('3')], &[Char(' ')], &[Enter]] {
            assert!(pressed(&[before, &[Char('q')]].concat()).3, "{before:?}");
        }
    }

    #[test]
    fn an_impulse_strikes_the_mass_with_the_bearing() {
        assert_eq!(pressed(&[Char('i')]).0, [Edit::Impulse(0, C64::new(-2.5, 0.0))]);
        assert_eq!(pressed(&[Char('R')]).0, [Edit::Restart]);
    }
}
