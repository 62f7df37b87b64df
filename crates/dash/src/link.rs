//! The reader thread: attaches to a bench, drains what it sends into the feed, and notices when it falls silent.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam::channel::Sender;
use wire::{BenchName, Bulletin, Carrier, HostState, Listener, WireError};

use crate::feed::{Contact, Feed};

/// How often we look for new states: a fraction of a frame, and of the buffer at any rate.
const POLL: Duration = Duration::from_millis(4);
/// How often we look for a bench that is not there.
const RETRY: Duration = Duration::from_millis(25);
/// Silence after which we ask whether the simulation lives.
const SILENCE: Duration = Duration::from_millis(60);
/// Silence of a living simulation that counts as a stall.
const STALL: Duration = Duration::from_millis(250);

/// A feed that threads share. A poisoned lock means another thread has panicked: what was heard is still whole.
pub(crate) type Shared = Arc<Mutex<Feed>>;

pub(crate) fn lock(feed: &Shared) -> MutexGuard<'_, Feed> {
    feed.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts the reader. It ends when `stop` becomes true. Bulletins are also sent to `bulletins`.
pub(crate) fn spawn<C: Carrier>(
    carrier: C,
    bench: BenchName,
    feed: Shared,
    bulletins: Sender<Arc<Bulletin>>,
    stop: Arc<AtomicBool>,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("reader".into()).spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            match carrier.listen(&bench) {
                Ok(listener) => {
                    if let Err(error) = read(listener, &feed, &bulletins, &stop) {
                        tracing::warn!(%error, "lost the bench");
                        lock(&feed).stand(Contact::Waiting(error.to_string()));
                    }
                }
                Err(WireError::NoBench(_)) => {
                    let mut feed = lock(&feed);
                    if feed.heard().is_none() {
                        feed.stand(Contact::Waiting(format!("waiting for bench '{bench}'")));
                    }
                }
                Err(error) => lock(&feed).stand(Contact::Waiting(error.to_string())),
            }
            std::thread::sleep(RETRY);
        }
    })
}

/// Reads until told to stop; a simulation that ends is waited for, and its successor heard.
fn read(
    mut listener: impl Listener,
    feed: &Shared,
    bulletins: &Sender<Arc<Bulletin>>,
    stop: &AtomicBool,
) -> Result<(), WireError> {
    let attached = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        let bulletin = listener.bulletin()?;
        let now = Instant::now();
        let drained = {
            let mut feed = lock(feed);
            if let Some(bulletin) = bulletin {
                // If the clerk is behind it has a newer one coming.
                let _ = bulletins.try_send(Arc::new(*bulletin));
                feed.read(bulletin);
            }
            listener.drain(|state| feed.hear(state, now))?
        };
        if drained > 0 {
            std::thread::sleep(POLL);
            continue;
        }
        let silence = lock(feed).heard().unwrap_or(attached).elapsed();
        if silence > SILENCE {
            match listener.host() {
                HostState::Gone => lock(feed).stand(Contact::Gone),
                HostState::Alive if silence > STALL => lock(feed).stand(Contact::Stalled),
                HostState::Alive => {}
            }
            std::thread::sleep(RETRY);
        } else {
            std::thread::sleep(POLL);
        }
    }
    Ok(())
}
