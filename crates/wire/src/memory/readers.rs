//! The readers' side of [`super::Memory`], and that of whoever asks for changes.

use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use super::{Bench, EventBox, Mailbox, SnapshotBox, lock};
use crate::delivery::ReceivedDocuments;
use crate::{
    Answer, BenchName, BenchStatus, Commander, Event, Glance, HostState, Listener, RecorderStatus, Request,
    SnapshotHead, Step, StepRow, WireError,
};

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryGlance {
    pub(super) bench: Arc<Bench>,
    pub(super) received: ReceivedDocuments,
    pub(super) seen: u64,
    /// The number of the recorder's last status that we know, and that status.
    pub(super) heard: u64,
    pub(super) recorder: Option<Box<RecorderStatus>>,
}

impl MemoryGlance {
    pub(super) fn of(bench: Arc<Bench>) -> Self {
        // The last word of a recorder that has left before us is not told.
        let recorded = lock(&bench.recorder).strong_count() > 0;
        let heard = if recorded { 0 } else { lock(&bench.recorder_status).0 };
        Self { bench, received: ReceivedDocuments::default(), seen: 0, heard, recorder: None }
    }

    /// Takes in what documents there are.
    fn read_documents(&mut self) {
        for (head, text) in lock(&self.bench.documents).iter() {
            self.received.put(*head, text.as_bytes());
        }
    }
}

impl Glance for MemoryGlance {
    fn bench_status(&mut self) -> Result<Option<Box<BenchStatus>>, WireError> {
        let (number, message) = *lock(&self.bench.bench_status);
        if number != self.seen && number > 0 {
            self.received.hold_bench_status(message);
        }
        self.seen = number;
        self.read_documents();
        Ok(self.received.bench_status())
    }

    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError> {
        let last = lock(&self.bench.recorder_status);
        if last.0 != self.heard {
            self.heard = last.0;
            self.recorder = Some(last.1.clone());
        }
        drop(last);
        let alive = lock(&self.bench.recorder).strong_count() > 0;
        Ok(self.recorder.as_ref().map(|status| Box::new(status.seen(alive))))
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryListener {
    pub(super) mailbox: Arc<Mailbox>,
    pub(super) events: Arc<EventBox>,
    pub(super) snapshots: Arc<SnapshotBox>,
    pub(super) glance: MemoryGlance,
}

impl Glance for MemoryListener {
    fn bench_status(&mut self) -> Result<Option<Box<BenchStatus>>, WireError> {
        self.glance.bench_status()
    }

    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError> {
        self.glance.recorder()
    }
}

impl Listener for MemoryListener {
    fn drain(&mut self, mut visit: impl FnMut(StepRow<'_>)) -> Result<usize, WireError> {
        let arrived = std::mem::take(&mut *lock(&self.mailbox));
        arrived.iter().flat_map(|state| StepRow::all(state.words())).for_each(&mut visit);
        Ok(arrived.len())
    }

    fn events(&mut self, mut visit: impl FnMut(&Event)) -> Result<usize, WireError> {
        let arrived = std::mem::take(&mut *lock(&self.events));
        arrived.into_iter().for_each(|event| self.glance.received.hold_event(event));
        self.glance.read_documents();
        let mut count = 0;
        while let Some(event) = self.glance.received.event() {
            visit(&event);
            count += 1;
        }
        Ok(count)
    }

    fn snapshots(&mut self, mut visit: impl FnMut(&SnapshotHead, &[u64])) -> Result<usize, WireError> {
        let arrived = std::mem::take(&mut *lock(&self.snapshots));
        arrived.iter().for_each(|(head, words)| visit(head, words));
        Ok(arrived.len())
    }

    fn host(&self) -> HostState {
        if lock(&self.glance.bench.host).strong_count() > 0 { HostState::Alive } else { HostState::Gone }
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryCommander {
    pub(super) bench: Arc<Bench>,
    pub(super) name: BenchName,
}

impl Commander for MemoryCommander {
    fn ask(&mut self, request: &Request, patience: Duration) -> Result<Answer, WireError> {
        let silent = || WireError::NoAnswer(self.name.clone());
        let deadline = Instant::now() + patience;
        let (reply, answer) = mpsc::channel();
        let mut envelope = (Box::new(request.clone()), reply);
        // Like shared memory, a request waits for an inbox that opens in time.
        loop {
            let inbox = lock(&self.bench.requests).clone();
            let sent = match inbox {
                Some(inbox) => inbox.send(envelope),
                None => Err(mpsc::SendError(envelope)),
            };
            match sent {
                Ok(()) => break,
                Err(mpsc::SendError(unsent)) => envelope = unsent,
            }
            if Instant::now() >= deadline {
                return Err(silent());
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        answer.recv_timeout(deadline.saturating_duration_since(Instant::now())).map_err(|_| silent())
    }
}
