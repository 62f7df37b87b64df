//! The reader thread: attaches to a bench, drains what it sends into the feed, and notices when it falls silent.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam::channel::Sender;
use wire::{BenchName, Carrier, HostState, Listener, WireError};

use crate::connection::Connection;
use crate::edits::BenchNews;
use crate::feed::Feed;

/// How often we look for new states: a fraction of a frame, and of the buffer at any rate.
const POLL: Duration = Duration::from_millis(4);
/// The same while the view is paused.
const IDLE_POLL: Duration = Duration::from_millis(40);
/// How often we look for a bench that is not there.
const RETRY: Duration = Duration::from_millis(25);
/// Silence after which we ask whether the simulation lives.
const SILENCE: Duration = Duration::from_millis(60);
/// Silence of a living simulation that counts as a stall.
const STALL: Duration = Duration::from_millis(250);

/// How often the status of a recorder is read: it sends one a few times a second.
const RECORDER: Duration = Duration::from_millis(250);

/// A feed that threads share. A poisoned lock means another thread has panicked: what came before is still whole.
pub type SharedFeed = Arc<Mutex<Feed>>;

/// The feed, to read or to write; threads that want it meanwhile wait.
pub fn lock(feed: &SharedFeed) -> MutexGuard<'_, Feed> {
    feed.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How the reader and the other threads of a console reach each other.
#[derive(Debug)]
pub struct ReaderChannels {
    /// Every bench status and every event, for the edit thread.
    pub news: Sender<BenchNews>,
    /// A token when something has come that should not wait for the next frame.
    pub wake: Sender<()>,
    /// Nobody watches the motion: there is no hurry.
    pub idle: Arc<AtomicBool>,
    /// End.
    pub stop: Arc<AtomicBool>,
}

/// Starts the reader.
pub fn spawn<C: Carrier>(
    carrier: C,
    bench: BenchName,
    feed: SharedFeed,
    channels: ReaderChannels,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("reader".into()).spawn(move || {
        while !channels.stop.load(Ordering::Relaxed) {
            match carrier.listen(&bench) {
                Ok(listener) => {
                    tracing::info!(%bench, "attached");
                    if let Err(error) = read(listener, &feed, &channels) {
                        tracing::warn!(%error, "lost the bench");
                        lock(&feed).set_connection(Connection::Waiting(error.to_string()));
                    }
                }
                Err(WireError::NoBench(_)) => {
                    let mut feed = lock(&feed);
                    if feed.last_step_at().is_none() {
                        feed.set_connection(Connection::Waiting(format!("waiting for bench '{bench}'")));
                    }
                }
                Err(error) => lock(&feed).set_connection(Connection::Waiting(error.to_string())),
            }
            std::thread::sleep(RETRY);
        }
    })
}

/// Reads until it is stopped; after a simulation has ended its successor is waited for.
fn read(mut listener: impl Listener, feed: &SharedFeed, channels: &ReaderChannels) -> Result<(), WireError> {
    let attached = Instant::now();
    let mut told = (0, false);
    let mut looked = attached;
    while !channels.stop.load(Ordering::Relaxed) {
        let bench_status = listener.bench_status()?;
        let now = Instant::now();
        if now - looked > RECORDER {
            looked = now;
            let status = listener.recorder()?;
            lock(feed).set_recorder(status);
        }
        let drained = {
            let mut feed = lock(feed);
            if let Some(bench_status) = bench_status {
                // If the edit thread is behind it has a newer one coming.
                let _ = channels.news.try_send(BenchNews::BenchStatus(Arc::new((*bench_status).clone())));
                let news = (bench_status.revision, bench_status.trip.is_tripped());
                if news != told {
                    told = news;
                    // A token that still lies there will do.
                    let _ = channels.wake.try_send(());
                }
                feed.push_bench_status(bench_status);
            }
            listener.events(|event| {
                // What does not fit there shows by its revision.
                let _ = channels.news.try_send(BenchNews::Event(Box::new(event.clone())));
                feed.push_event(event);
            })?;
            listener.drain(|step| feed.push_step(&step, now))?
        };
        let poll = if channels.idle.load(Ordering::Relaxed) { IDLE_POLL } else { POLL };
        if drained > 0 {
            std::thread::sleep(poll);
            continue;
        }
        let silence = lock(feed).last_step_at().unwrap_or(attached).elapsed();
        if silence > SILENCE {
            match listener.host() {
                HostState::Gone => report(feed, channels, Connection::Gone),
                HostState::Alive if silence > STALL => report(feed, channels, Connection::Stalled),
                HostState::Alive => {}
            }
            std::thread::sleep(RETRY);
        } else {
            std::thread::sleep(poll);
        }
    }
    Ok(())
}

/// Sets the connection, and wakes the screen if it is another.
fn report(feed: &SharedFeed, channels: &ReaderChannels, connection: Connection) {
    let mut feed = lock(feed);
    if *feed.connection() != connection {
        tracing::info!(?connection, "the simulation");
        feed.set_connection(connection);
        let _ = channels.wake.try_send(());
    }
}
