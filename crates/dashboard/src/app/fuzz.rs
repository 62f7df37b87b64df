//! Random keys, mouse, resizes and telemetry: nothing panics, nothing sticks, and `q` always works.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use ratatui::buffer::Buffer;

use wire::Channel;

use super::*;
use telemetry::test_support::{bench_status, state};

/// Numbers that look random, the same every time.
struct Dice(fastrand::Rng);

impl Dice {
    fn of(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.0.u64(..bound)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.0.usize(..all.len())]
    }
}

const CODES: [KeyCode; 18] = [
    KeyCode::Up,
    KeyCode::Down,
    KeyCode::Left,
    KeyCode::Right,
    KeyCode::Enter,
    KeyCode::Enter,
    KeyCode::Esc,
    KeyCode::Tab,
    KeyCode::BackTab,
    KeyCode::Backspace,
    KeyCode::PageUp,
    KeyCode::PageDown,
    KeyCode::Home,
    KeyCode::F(1),
    KeyCode::Char(':'),
    KeyCode::Char('ü'),
    KeyCode::Char(' '),
    KeyCode::Null,
];
const HELD: [KeyModifiers; 5] =
    [KeyModifiers::NONE, KeyModifiers::NONE, KeyModifiers::SHIFT, KeyModifiers::CONTROL, KeyModifiers::ALT];
/// Commands that keys alone rarely spell.
const COMMANDS: [&str; 18] = [
    "scale orbits -3..3",
    "scale orbits 0.001",
    "scale poles -0.5..0.1 0..3",
    "scale spectrum 1e-6..1e2",
    "scale waterfall 1e-300..1e300",
    "scale y -1e9..1e9",
    "scale damping auto",
    "scale force 0..1e-9",
    "zoom 1e-6",
    "zoom 1e6",
    "choose damping-over-speed",
    "read 1e9",
    "read -1.25",
    "strips y.1+z.1 radius.3 vy damping command speed force u",
    "strips auto",
    "spectrum 3 -0.001..0.002",
    "spectrum 1 900..901",
    "spectrum auto",
];
const SIZES: [(u16, u16); 9] = [(0, 0), (1, 1), (59, 15), (60, 16), (61, 40), (80, 24), (140, 45), (200, 60), (3, 90)];

fn key(dice: &mut Dice) -> KeyEvent {
    let code = match dice.below(3) {
        0 => dice.one_of(&CODES),
        _ => KeyCode::Char(char::from(b' ' + dice.below(95) as u8)),
    };
    KeyEvent::new(code, dice.one_of(&HELD))
}

fn mouse(dice: &mut Dice) -> MouseEvent {
    let kind = dice.one_of(&[
        MouseEventKind::Down(MouseButton::Left),
        MouseEventKind::Drag(MouseButton::Left),
        MouseEventKind::Up(MouseButton::Left),
        MouseEventKind::ScrollUp,
        MouseEventKind::ScrollDown,
        MouseEventKind::Down(MouseButton::Right),
        MouseEventKind::Moved,
    ]);
    let (column, row) = (dice.below(220) as u16, dice.below(70) as u16);
    MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE }
}

/// Plays so many random events.
fn play(events: u64, seed: u64) {
    let mut dice = Dice::of(seed);
    let options = Options { history: 0, ..Options::default() };
    let (mut app, edits) = tests::dashboard(&options);
    let (mut seq, mut revision, mut run, mut masses) = (3000, 1, 7, 3);
    for event in 0..events {
        match dice.below(10) {
            5 if app.layers.is_empty() => {
                let line = dice.one_of(&COMMANDS);
                for letter in [':'].into_iter().chain(line.chars()) {
                    app.press(KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
                }
                app.press(KeyEvent::new(KeyCode::Enter, KeyModifiers::NONE));
            }
            0..=5 => app.press(key(&mut dice)),
            6 => app.mouse(mouse(&mut dice)),
            7 => {
                let (width, height) = dice.one_of(&SIZES);
                let area = Rect::new(0, 0, width, height);
                app.render(area, &mut Buffer::empty(area));
            }
            8 => {
                let mut feed = lock(&app.feed);
                for _ in 0..dice.below(40) {
                    seq += 1 + dice.below(50) / 49;
                    let mut one =
                        state(masses, seq).with_word(Channel::RunId, run).with_word(Channel::Revision, revision);
                    if dice.below(50) == 0 {
                        one = one.with_flags(wire::Flags::TRIPPED);
                    }
                    if dice.below(2000) == 0 {
                        let mut row = one.row_mut();
                        row.set(Channel::Y, 0, f64::INFINITY);
                        row.set_pair([Channel::ForceY, Channel::ForceZ], 0, [f64::NAN; 2]);
                    }
                    feed.push_step(&one, Instant::now());
                }
            }
            _ => {
                let mut feed = lock(&app.feed);
                match dice.below(4) {
                    0 => feed.set_connection(silence(dice.one_of(&[0, 1, 2]))),
                    1 if dice.below(20) == 0 => {
                        // Another machine takes the name.
                        (run, seq, masses) = (run + 1, 0, if masses == 3 { 1 } else { 3 });
                        let mut news = bench_status(if masses == 3 { "three-mass" } else { "jeffcott" }, "off");
                        news.run_id = run;
                        feed.push_bench_status(news);
                    }
                    _ => {
                        revision += 1;
                        let feedback = if dice.below(2) == 0 {
                            "off"
                        } else if masses == 3 {
                            "composite"
                        } else {
                            "cancel"
                        };
                        let mut news = bench_status(if masses == 3 { "three-mass" } else { "jeffcott" }, feedback);
                        (news.run_id, news.revision) = (run, revision);
                        feed.push_bench_status(news);
                    }
                }
            }
        }
        for edit in edits.try_iter() {
            // Every third would do harm.
            let settings = lock(&app.feed).settings();
            if let (Some(settings), 0) = (settings, dice.below(3)) {
                app.take_outcome(EditOutcome::Asks(
                    edit,
                    Box::new(settings),
                    vec![telemetry::edits::Harm::Unstable(-0.1)],
                ));
            }
        }
        if app.quit.is_some() {
            app.quit = None;
        }
        app.suspend = false;
        if event % 64 == 0 {
            // From wherever we are: out of a text at most once, then q ends it.
            let mut layers = app.layers.clone();
            if matches!(layers.last(), Some(Layer::Command(_) | Layer::Filter(_))) {
                app.press(KeyEvent::new(KeyCode::Esc, KeyModifiers::NONE));
                layers.pop();
            }
            assert!(app.layers.len() <= 3, "layers pile up: {:?}", app.layers);
            // A locked machine is unlocked first.
            app.locked = false;
            app.press(KeyEvent::new(KeyCode::Char('q'), KeyModifiers::NONE));
            assert_eq!(
                app.quit.take(),
                Some(Ended::Quit),
                "event {event} of seed {seed}: q does not quit from {layers:?}"
            );
            app.press(KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL));
            assert_eq!(app.quit.take(), Some(Ended::Quit));
        }
    }
}

/// One of the ways in which there is nobody to hear.
fn silence(number: i32) -> Connection {
    match number {
        0 => Connection::Gone,
        1 => Connection::Stalled,
        _ => Connection::Waiting("waiting".into()),
    }
}

#[test]
fn some_thousands_of_random_events_leave_the_dashboard_whole() {
    (1..=4).for_each(|seed| play(2000, seed));
}

#[test]
#[ignore = "a million events take a minute: cargo test --release -p dashboard -- --ignored a_million"]
fn a_million_random_events_leave_the_dashboard_whole() {
    (1..=10).for_each(|seed| play(100_000, 0x9e37_79b9 * seed));
}
