mod kept;
mod lines;
mod mouse;
mod plots;
mod presses;
mod questions;
mod run_up;
mod scenarios;
mod search;

use std::sync::Mutex;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use rotor::{C64, Key};

use super::*;
use KeyCode::{Char, Down, Enter, Esc, Left, Right, Tab, Up};
use telemetry::feed::Feed;
use telemetry::test_support as tests;

/// A dashboard with a feed of the three-mass rotor, and where its edits go.
pub(super) fn dashboard(options: &Options) -> (App<'static>, Receiver<Edit>) {
    let mut feed = Feed::new("");
    feed.push_bench_status(tests::bench_status("three-mass", "composite"));
    (0..3000).for_each(|seq| feed.push_step(&tests::state(3, seq), Instant::now()));
    let (edits, taken) = channel::bounded(64);
    let feed = Arc::new(Mutex::new(feed));
    let mut app =
        App::new("default".into(), feed, edits, None, telemetry::jobs::Jobs::inline(), Arc::default(), options);
    frame(&mut app);
    (app, taken)
}

/// The frame, as text.
pub(super) fn frame(app: &mut App<'_>) -> String {
    let area = Rect::new(0, 0, 120, 40);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    app.render(area, &mut buffer);
    crate::screenshot::image::text(&buffer)
}

fn press(app: &mut App<'_>, keys: &[KeyCode]) {
    keys.iter().for_each(|code| app.press(KeyEvent::new(*code, KeyModifiers::NONE)));
}

fn type_in(app: &mut App<'_>, text: &str) {
    text.chars().for_each(|letter| press(app, &[Char(letter)]));
}

/// Presses keys, and returns what is then wanted.
fn pressed(keys: &[KeyCode]) -> (Vec<Edit>, App<'static>) {
    let (mut app, taken) = dashboard(&Options::default());
    press(&mut app, keys);
    (taken.try_iter().collect(), app)
}

fn key(name: &str) -> Key {
    name.parse().unwrap()
}

/// The edit thread asks whether all gains shall be zero.
fn asks_about_off(app: &mut App<'_>) -> Settings {
    let settings = tests::bench_status("three-mass", "off").settings.get().clone();
    app.take_outcome(EditOutcome::Asks(
        Edit::Off,
        Box::new(settings.clone()),
        vec![telemetry::edits::Harm::Unstable(-0.0306)],
    ));
    settings
}

fn command(app: &mut App<'_>, line: &str) {
    press(app, &[Char(':')]);
    type_in(app, line);
    press(app, &[Enter]);
}
