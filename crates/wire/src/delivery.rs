//! Documents on their way: which of them have to be sent (again), and what a reader has to wait for.
//!
//! A document is sent before the first message that names it. Its service keeps the last [`DOCUMENTS_KEPT`] for readers that
//! come late or sleep; one that is named again after many others have been sent is sent again, so that all that the last
//! [`crate::EVENTS_KEPT`] events and the last bench status name are always among those kept.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::document::{
    Content, DOCUMENTS_KEPT, Document, DocumentError, DocumentHead, RotorDocument, SettingsDocument,
};
use crate::message::BenchStatusMessage;
use crate::{BenchStatus, Event, EventMessage};

/// A document that is among the last so many that were sent is not sent again.
const RECENT: usize = 8;
/// How long an event waits for the settings that it names: they were sent before it.
const PATIENCE: Duration = Duration::from_secs(2);

/// What has been sent lately.
#[derive(Debug, Default)]
pub(crate) struct SentDocuments {
    recent: VecDeque<u64>,
}

impl SentDocuments {
    /// Whether a document has to be sent before a message that names it; it is taken for sent from now on.
    pub(crate) fn is_due(&mut self, hash: u64) -> bool {
        let is_due = !self.recent.contains(&hash);
        if is_due {
            if self.recent.len() == RECENT {
                self.recent.pop_front();
            }
            self.recent.push_back(hash);
        }
        is_due
    }
}

/// What a reader has: documents, and messages that wait for theirs.
#[derive(Debug, Default)]
pub(crate) struct ReceivedDocuments {
    rotors: VecDeque<RotorDocument>,
    settings: VecDeque<SettingsDocument>,
    bench_status: Option<Box<BenchStatusMessage>>,
    events: VecDeque<(EventMessage, Instant)>,
}

fn put<T: Content>(received: &mut VecDeque<Document<T>>, hash: u64, bytes: &[u8]) -> Result<(), DocumentError> {
    if let Some(at) = received.iter().position(|document| document.hash() == hash) {
        // Sent again: it stays for as long as a new one.
        received.extend(received.get(at).cloned());
        received.remove(at);
        return Ok(());
    }
    let document = Document::received(hash, bytes)?;
    if received.len() == 2 * DOCUMENTS_KEPT {
        received.pop_front();
    }
    received.push_back(document);
    Ok(())
}

fn find<T: Content>(received: &VecDeque<Document<T>>, hash: u64) -> Option<Document<T>> {
    received.iter().rev().find(|document| document.hash() == hash).cloned()
}

impl ReceivedDocuments {
    /// Takes in a document. One that cannot be read, which only a foreign writer can send, is as if it had not come.
    pub(crate) fn put(&mut self, head: DocumentHead, bytes: &[u8]) {
        let taken = match head.kind {
            1 => put(&mut self.rotors, head.hash, bytes),
            2 => put(&mut self.settings, head.hash, bytes),
            _ => Ok(()),
        };
        if let Err(error) = taken {
            tracing::warn!(%error, "a document that cannot be read");
        }
    }

    /// Takes in the latest bench status.
    pub(crate) fn hold_bench_status(&mut self, message: BenchStatusMessage) {
        self.bench_status = Some(Box::new(message));
    }

    /// The latest bench status, once, when its documents are here.
    pub(crate) fn bench_status(&mut self) -> Option<Box<BenchStatus>> {
        let message = self.bench_status.as_ref()?;
        let (rotor, settings) = (find(&self.rotors, message.rotor)?, find(&self.settings, message.settings)?);
        let message = self.bench_status.take()?;
        Some(Box::new(BenchStatus::resolved(*message, rotor, settings)))
    }

    /// Takes in an event.
    pub(crate) fn hold_event(&mut self, message: EventMessage) {
        self.events.push_back((message, Instant::now()));
    }

    /// The next event, in order, if its settings are here. One whose settings do not come is lost, as its number shows.
    pub(crate) fn event(&mut self) -> Option<Event> {
        loop {
            let (message, since) = self.events.front()?;
            let found = find(&self.settings, message.settings);
            if found.is_none() && since.elapsed() < PATIENCE {
                return None;
            }
            let (message, _) = self.events.pop_front()?;
            if let Some(settings) = found {
                return Some(Event::resolved(message, settings));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EVENTS_KEPT;

    /// Whatever is changed and undone: what the last events and the last bench status name is among the last documents.
    #[test]
    fn what_can_still_be_named_is_kept() {
        let mut random = fastrand::Rng::with_seed(1);
        for spread in [1, 2, 7, 8, 9, 20, 64, 1000] {
            let (mut sent_documents, mut sent, mut named) = (SentDocuments::default(), Vec::new(), Vec::new());
            for _ in 0..5000 {
                let settings = random.u64(1..=spread);
                for hash in [0, settings] {
                    if sent_documents.is_due(hash) {
                        sent.push(hash);
                    }
                }
                named.push(settings);
                let kept = &sent[sent.len().saturating_sub(DOCUMENTS_KEPT)..];
                let last = &named[named.len().saturating_sub(EVENTS_KEPT)..];
                assert!(kept.contains(&0) && last.iter().all(|hash| kept.contains(hash)), "{spread}");
            }
        }
    }
}
