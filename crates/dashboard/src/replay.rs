//! One sitting at a recording: the threads, started and ended in order around the loop. There are fewer than on a live
//! bench: nobody sends anything, and what is done to the machine is done here.

#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crossbeam::channel;

use crate::app::{App, Streams};
use crate::appearance::Look;
use crate::input;
use crate::options::{DashboardError, Ended, Options};
use crate::signals;
use crate::terminal::Screen;
use telemetry::feed::Feed;
use telemetry::jobs::Jobs;
use telemetry::reader::SharedFeed;
use telemetry::replay::{Player, RecordingSource};

/// Plays `past` on the terminal until a person or a signal ends it.
///
/// # Errors
/// No steps, or steps that cannot be read; no terminal, or one that fails.
pub fn replay(past: Box<dyn RecordingSource>, options: &Options) -> Result<Ended, DashboardError> {
    if !Screen::is_possible() {
        return Err(DashboardError::NoTerminal);
    }
    let name = past.name();
    let mut feed = Feed::with_bound("", options.history);
    let mut time = telemetry::view_time::ViewTime::LIVE;
    let player =
        Player::new(past, &mut feed, &mut time).map_err(|why| DashboardError::Recording(format!("{name}: {why}")))?;
    let feed: SharedFeed = Arc::new(Mutex::new(feed));
    let stop = Arc::new(AtomicBool::new(false));
    let (send_input, inputs) = channel::unbounded();
    let signals = signals::listen(send_input.clone())?;
    let screen = Screen::take(Look::of_environment(options.appearance))?;
    input::keyboard(send_input, stop.clone())?;
    // Nobody at the other end of these: edits go to the player, and nothing comes by itself.
    let (edits, _nobody) = channel::bounded(1);
    let (wake, wakes) = channel::bounded(1);
    let jobs = Jobs::start(&wake)?;
    let mut app = App::new(name, feed, edits, None, jobs, Arc::default(), options).playing(player, time);
    let ended = app.run(screen, &Streams { inputs, outcomes: channel::never(), wakes });
    stop.store(true, Ordering::Relaxed);
    signals.close();
    drop(app);
    ended
}
