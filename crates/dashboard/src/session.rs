//! One sitting at the dashboard: the threads, started and ended in order around the loop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crossbeam::channel;
use wire::{BenchName, Carrier};

use crate::app::{App, Streams};
use crate::appearance::Look;
use crate::input;
use crate::options::{DashboardError, Ended, Options};
use crate::signals;
use crate::terminal::Screen;
use telemetry::edits;
use telemetry::feed::Feed;
use telemetry::jobs::Jobs;
use telemetry::processes::{RecorderProcess, SimulationProcess};
use telemetry::reader::{self, ReaderChannels, SharedFeed};

/// News that may wait for the edit thread, which may wait a second for an answer: all events that a late reader is told, and bench statuses.
pub(crate) const NEWS_WAITING: usize = 2 * wire::EVENTS_KEPT;
/// Edits that may wait for the simulation; a key that repeats faster than it answers is not queued without end.
pub(crate) const EDITS_WAITING: usize = 64;

/// Shows `bench` on the terminal until a person or a signal ends it.
///
/// # Errors
/// No terminal, or one that fails.
pub fn run<'a, C: Carrier>(
    carrier: C,
    bench: &BenchName,
    simulation: Option<&'a mut dyn SimulationProcess>,
    recorder_process: Option<&'a mut dyn RecorderProcess>,
    options: &Options,
) -> Result<Ended, DashboardError> {
    if !Screen::is_possible() {
        return Err(DashboardError::NoTerminal);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let why = format!("waiting for bench '{bench}'");
    let feed: SharedFeed = Arc::new(Mutex::new(Feed::with_bound(&why, options.history)));
    let (send_news, news) = channel::bounded(NEWS_WAITING);
    let (edits, take_edits) = channel::bounded(EDITS_WAITING);
    let (send_outcome, outcomes) = channel::unbounded();
    let (send_input, inputs) = channel::unbounded();

    // Signals first: from here on they end us in good order.
    let signals = signals::listen(send_input.clone())?;
    let (wake, wakes) = channel::bounded(1);
    let idle = Arc::new(AtomicBool::new(false));
    let jobs = Jobs::start(&wake)?;
    let channels = ReaderChannels { news: send_news, wake, idle: idle.clone(), stop: stop.clone() };
    let reader = reader::spawn(carrier.clone(), bench.clone(), feed.clone(), channels)?;
    let editor = edits::spawn(carrier, bench.clone(), feed.clone(), take_edits, news, send_outcome)?;
    let screen = Screen::take(Look::of_environment(options.appearance))?;
    input::keyboard(send_input, stop.clone())?;
    let mut app =
        App::new(bench.to_string(), feed, edits, simulation, jobs, idle, options).recording_with(recorder_process);
    let ended = app.run(screen, &Streams { inputs, outcomes, wakes });
    stop.store(true, Ordering::Relaxed);
    signals.close();
    drop(app);
    // Both hold shared memory: they must have let go before we report that we are done.
    let _ = reader.join();
    let _ = editor.join();
    ended
}
