//! A screenshot of a running bench without a terminal: what a dashboard shows after some keys.

use std::io;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crossbeam::channel;
use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use wire::{BenchName, Carrier};

use crate::app::App;
use crate::keymap::Chord;
use crate::options::Options;
use crate::screenshot::image::Screenshot;
use crate::session::{EDITS_WAITING, NEWS_WAITING};
use telemetry::edits;
use telemetry::feed::Feed;
use telemetry::jobs::Jobs;
use telemetry::reader::{self, ReaderChannels, SharedFeed, lock};

/// How often what has come in is held against the alarms' limits.
const LOOK: Duration = Duration::from_millis(100);
/// How long an edit may wait for what became of it.
const ANSWER: Duration = Duration::from_secs(3);

/// What happens before a picture is taken.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Press(KeyEvent),
    Wait(Duration),
}

/// Keys to press before a picture is taken: letters as they are, others by name in angle brackets (`<enter>`, `<ctrl-r>`,
/// `<<>`), and `<3s>` for three seconds of waiting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeyPresses(Vec<Step>);

#[cfg(test)]
impl KeyPresses {
    /// The keys, without waiting between them.
    pub(crate) fn keys(&self) -> impl Iterator<Item = KeyEvent> + '_ {
        self.0.iter().filter_map(|step| if let Step::Press(key) = step { Some(*key) } else { None })
    }
}

impl FromStr for KeyPresses {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut steps = Vec::new();
        let mut rest = text;
        while let Some(letter) = rest.chars().next() {
            let name = match letter {
                '<' => {
                    // A name is a letter at least, which may be the bracket itself.
                    let end = rest.char_indices().skip(2).find(|(_, c)| *c == '>').map(|(at, _)| at);
                    let end = end.ok_or_else(|| format!("'{rest}': expected a name and '>' after '<'"))?;
                    let name = &rest[1..end];
                    rest = &rest[end + 1..];
                    name
                }
                _ => {
                    let (first, others) = rest.split_at(letter.len_utf8());
                    rest = others;
                    if first == " " { "space" } else { first }
                }
            };
            let seconds = name.strip_suffix('s').and_then(|number| number.parse::<u16>().ok());
            steps.push(match seconds {
                Some(seconds) => Step::Wait(Duration::from_secs(seconds.into())),
                None => Step::Press(name.parse::<Chord>()?.event()),
            });
        }
        Ok(Self(steps))
    }
}

/// Attaches to `bench`, listens for `after`, presses keys, and takes a picture of what a dashboard of `width` by `height`
/// cells then shows. `None` if nothing was heard of the bench until then.
///
/// # Errors
/// A thread cannot be started.
pub fn take_screenshot<C: Carrier>(
    carrier: C,
    bench: &BenchName,
    options: &Options,
    (width, height): (u16, u16),
    after: Duration,
    presses: &KeyPresses,
) -> io::Result<Option<Screenshot>> {
    let feed: SharedFeed = Arc::new(Mutex::new(Feed::with_bound("waiting", options.history)));
    let stop = Arc::new(AtomicBool::new(false));
    let (send_news, news) = channel::bounded(NEWS_WAITING);
    let (wake, _never) = channel::bounded(1);
    let (send_edit, wanted) = channel::bounded(EDITS_WAITING);
    let (carry, edits) = channel::bounded(1);
    let (send_outcome, outcomes) = channel::unbounded();
    let channels = ReaderChannels { news: send_news, wake, idle: Arc::default(), stop: stop.clone() };
    let reader = reader::spawn(carrier.clone(), bench.clone(), feed.clone(), channels)?;
    let editor = edits::spawn(carrier, bench.clone(), feed.clone(), edits, news, send_outcome)?;
    let area = Rect::new(0, 0, width, height);
    let mut app = App::new(bench.to_string(), feed.clone(), send_edit, None, Jobs::inline(), Arc::default(), options);
    let wait = |app: &mut App<'_>, time: Duration| {
        let start = Instant::now();
        while start.elapsed() < time {
            std::thread::sleep(LOOK.min(time.saturating_sub(start.elapsed())));
            app.tick();
        }
    };
    wait(&mut app, after);
    for step in &presses.0 {
        match step {
            Step::Wait(time) => wait(&mut app, *time),
            Step::Press(key) => app.press(*key),
        }
        // What a key asks for is there before the next is pressed.
        for edit in wanted.try_iter() {
            if carry.send(edit).is_ok()
                && let Ok(outcome) = outcomes.recv_timeout(ANSWER)
            {
                app.take_outcome(outcome);
            }
        }
    }
    let heard = lock(&feed).last_step_at().is_some();
    let screenshot = heard.then(|| app.screenshot(area));
    stop.store(true, Ordering::Relaxed);
    drop((app, carry));
    // Both hold shared memory: they must have let go before we report that we are done.
    let _ = reader.join();
    let _ = editor.join();
    Ok(screenshot)
}

#[cfg(test)]
mod tests {
    use crossterm::event::{KeyCode, KeyModifiers};

    use super::*;

    #[test]
    fn presses_are_letters_names_and_times() {
        let KeyPresses(steps) = ":kd <enter><<><ctrl-r>ü<3s>s".parse().unwrap();
        let press = |code, held| Step::Press(KeyEvent::new(code, held));
        let letter = |letter| press(KeyCode::Char(letter), KeyModifiers::NONE);
        assert_eq!(
            steps,
            [
                letter(':'),
                letter('k'),
                letter('d'),
                letter(' '),
                press(KeyCode::Enter, KeyModifiers::NONE),
                letter('<'),
                press(KeyCode::Char('r'), KeyModifiers::CONTROL),
                letter('ü'),
                Step::Wait(Duration::from_secs(3)),
                letter('s'),
            ]
        );
        assert_eq!("x<enter".parse::<KeyPresses>(), Err("'<enter': expected a name and '>' after '<'".into()));
        assert!("<nokey>".parse::<KeyPresses>().unwrap_err().contains("expected a key such as"));
    }
}
