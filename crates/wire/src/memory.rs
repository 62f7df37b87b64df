//! The carrier for tests: queues in this process, with the manners of shared memory.

mod control;
mod readers;

use std::collections::{HashMap, VecDeque};
use std::sync::mpsc;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use control::ControlBox;
pub(crate) use control::{MemoryControlHost, MemoryController};
pub(crate) use readers::{MemoryCommander, MemoryGlance, MemoryListener};

use crate::delivery::SentDocuments;
use crate::document::{Content, DOCUMENTS_KEPT, Document, DocumentHead};
use crate::message::BenchStatusMessage;
use crate::ports::{check_burst, check_document, check_snapshot};
use crate::snapshot::{SNAPSHOTS_BUFFERED, SnapshotHead};
use crate::{
    Answer, BenchName, BenchStatus, Carrier, EVENTS_KEPT, Event, EventMessage, Host, Inbox, MAX_READERS, NewsSender,
    RecorderSender, RecorderStatus, Request, RowMut, State, StateSender, StepLayout, WireError,
};

/// How many states a sleeping listener keeps if nobody says more: the oldest are dropped beyond that.
const STATES_KEPT: usize = 1024;

/// Carries messages within this process. Clones share their benches.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    benches: Arc<Mutex<HashMap<BenchName, Arc<Bench>>>>,
    room: Option<usize>,
}

type Mailbox = Mutex<VecDeque<State>>;
type EventBox = Mutex<VecDeque<EventMessage>>;
type SnapshotBox = Mutex<VecDeque<(SnapshotHead, Arc<[u64]>)>>;
type Envelope = (Box<Request>, mpsc::Sender<Answer>);

/// What outlives a host, so that listeners hear the next one.
#[derive(Debug, Default)]
struct Bench {
    /// How many states a sleeping listener keeps.
    room: Option<usize>,
    host: Mutex<Weak<()>>,
    mailboxes: Mutex<Vec<Weak<Mailbox>>>,
    bench_status: Mutex<(u64, BenchStatusMessage)>,
    documents: Mutex<VecDeque<(DocumentHead, Arc<str>)>>,
    events: Mutex<EventLog>,
    snapshots: Mutex<Vec<Weak<SnapshotBox>>>,
    last_snapshot: Mutex<Option<(SnapshotHead, Arc<[u64]>)>>,
    recorder: Mutex<Weak<()>>,
    recorder_status: Mutex<(u64, Box<RecorderStatus>)>,
    requests: Mutex<Option<mpsc::Sender<Envelope>>>,
    control: Mutex<ControlBox>,
    controller: Mutex<Weak<()>>,
}

/// The last events, and the readers of further ones.
#[derive(Debug, Default)]
struct EventLog {
    kept: VecDeque<EventMessage>,
    mailboxes: Vec<Weak<EventBox>>,
}

/// Adds to a queue of events, whose oldest one goes if it is full.
fn keep(queue: &mut VecDeque<EventMessage>, event: EventMessage) {
    if queue.len() == EVENTS_KEPT {
        queue.pop_front();
    }
    queue.push_back(event);
}

/// A poisoned lock means a test has already failed elsewhere: the data is still whole.
fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Memory {
    /// A carrier whose listeners keep so many states while they sleep: for tests that must hear every step, however
    /// seldom the machine lets them listen.
    #[must_use]
    pub fn with_room(states: usize) -> Self {
        Self { room: Some(states), ..Self::default() }
    }

    fn existing(&self, name: &BenchName) -> Result<Arc<Bench>, WireError> {
        let found = lock(&self.benches).get(name).cloned();
        found.filter(|bench| lock(&bench.host).strong_count() > 0).ok_or_else(|| WireError::NoBench(name.clone()))
    }
}

impl Carrier for Memory {
    type Host = MemoryHost;
    type Listener = MemoryListener;
    type Glance = MemoryGlance;
    type Commander = MemoryCommander;
    type Recorder = MemoryRecorder;
    type Controller = MemoryController;

    fn host(&self, name: &BenchName) -> Result<MemoryHost, WireError> {
        let bench = lock(&self.benches)
            .entry(name.clone())
            .or_insert_with(|| Arc::new(Bench { room: self.room, ..Bench::default() }))
            .clone();
        let mut holder = lock(&bench.host);
        if holder.strong_count() > 0 {
            return Err(WireError::Taken(name.clone()));
        }
        let claim = Arc::new(());
        *holder = Arc::downgrade(&claim);
        drop(holder);
        lock(&bench.bench_status).0 = 0;
        lock(&bench.events).kept.clear();
        *lock(&bench.last_snapshot) = None;
        *lock(&bench.control) = ControlBox::default();
        Ok(MemoryHost { bench, claim })
    }

    fn listen(&self, name: &BenchName) -> Result<MemoryListener, WireError> {
        let bench = self.existing(name)?;
        let mailbox = Arc::new(Mailbox::default());
        let mut mailboxes = lock(&bench.mailboxes);
        mailboxes.retain(|mailbox| mailbox.strong_count() > 0);
        if mailboxes.len() == MAX_READERS {
            return Err(WireError::Full { bench: name.clone(), what: "readers", most: MAX_READERS });
        }
        mailboxes.push(Arc::downgrade(&mailbox));
        drop(mailboxes);
        let mut log = lock(&bench.events);
        let events = Arc::new(EventBox::new(log.kept.clone()));
        log.mailboxes.push(Arc::downgrade(&events));
        drop(log);
        let snapshots = Arc::new(SnapshotBox::new(lock(&bench.last_snapshot).iter().cloned().collect()));
        lock(&bench.snapshots).push(Arc::downgrade(&snapshots));
        Ok(MemoryListener { mailbox, events, snapshots, glance: MemoryGlance::of(bench) })
    }

    fn glance(&self, name: &BenchName) -> Result<MemoryGlance, WireError> {
        Ok(MemoryGlance::of(self.existing(name)?))
    }

    fn command(&self, name: &BenchName) -> Result<MemoryCommander, WireError> {
        Ok(MemoryCommander { bench: self.existing(name)?, name: name.clone() })
    }

    fn recorder(&self, name: &BenchName) -> Result<MemoryRecorder, WireError> {
        let bench = self.existing(name)?;
        let mut holder = lock(&bench.recorder);
        if holder.strong_count() > 0 {
            return Err(WireError::Recorded(name.clone()));
        }
        let claim = Arc::new(());
        *holder = Arc::downgrade(&claim);
        drop(holder);
        Ok(MemoryRecorder { bench, _claim: claim })
    }

    fn controller(&self, name: &BenchName) -> Result<MemoryController, WireError> {
        let bench = self.existing(name)?;
        let mut holder = lock(&bench.controller);
        if holder.strong_count() > 0 {
            return Err(WireError::Controlled(name.clone()));
        }
        let claim = Arc::new(());
        *holder = Arc::downgrade(&claim);
        drop(holder);
        Ok(MemoryController { bench, _claim: claim })
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryHost {
    bench: Arc<Bench>,
    claim: Arc<()>,
}

impl Host for MemoryHost {
    type States = MemoryStates;
    type News = MemoryNews;
    type Inbox = MemoryInbox;
    type Control = MemoryControlHost;

    fn states(&self, layout: StepLayout) -> Result<MemoryStates, WireError> {
        Ok(MemoryStates { layout, bench: self.bench.clone(), _claim: self.claim.clone() })
    }

    fn news(&self) -> Result<MemoryNews, WireError> {
        Ok(MemoryNews {
            bench: self.bench.clone(),
            sent_documents: SentDocuments::default(),
            _claim: self.claim.clone(),
        })
    }

    fn inbox(&self) -> Result<MemoryInbox, WireError> {
        let (sender, receiver) = mpsc::channel();
        *lock(&self.bench.requests) = Some(sender);
        Ok(MemoryInbox { receiver, _claim: self.claim.clone() })
    }

    fn control(&self) -> Result<MemoryControlHost, WireError> {
        Ok(MemoryControlHost { bench: self.bench.clone(), _claim: self.claim.clone() })
    }

    fn listeners(&self) -> usize {
        lock(&self.bench.mailboxes).iter().filter(|mailbox| mailbox.strong_count() > 0).count()
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryStates {
    layout: StepLayout,
    bench: Arc<Bench>,
    _claim: Arc<()>,
}

impl StateSender for MemoryStates {
    fn send(&mut self, count: usize, mut fill: impl FnMut(usize, &mut RowMut<'_>)) -> Result<(), WireError> {
        check_burst(count)?;
        let mut states = vec![State::new(self.layout); count];
        states.iter_mut().enumerate().for_each(|(place, state)| fill(place, &mut state.row_mut()));
        let room = self.bench.room.unwrap_or(STATES_KEPT);
        lock(&self.bench.mailboxes).retain(|mailbox| {
            let Some(mailbox) = mailbox.upgrade() else { return false };
            let mut mailbox = lock(&mailbox);
            mailbox.extend(&states);
            let surplus = mailbox.len().saturating_sub(room);
            mailbox.drain(..surplus);
            true
        });
        Ok(())
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryNews {
    bench: Arc<Bench>,
    sent_documents: SentDocuments,
    _claim: Arc<()>,
}

impl MemoryNews {
    fn document<T: Content>(&mut self, document: &Document<T>) -> Result<(), WireError> {
        check_document(document.text())?;
        if self.sent_documents.is_due(document.hash()) {
            let mut kept = lock(&self.bench.documents);
            if kept.len() == DOCUMENTS_KEPT {
                kept.pop_front();
            }
            kept.push_back((document.head(), document.text().into()));
        }
        Ok(())
    }
}

impl NewsSender for MemoryNews {
    fn bench_status(&mut self, bench_status: &BenchStatus) -> Result<(), WireError> {
        bench_status.rotor_document().map_or(Ok(()), |rotor| self.document(rotor))?;
        self.document(&bench_status.settings)?;
        let mut last = lock(&self.bench.bench_status);
        last.0 += 1;
        last.1 = bench_status.message();
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), WireError> {
        self.document(&event.settings)?;
        let event = event.message();
        let mut log = lock(&self.bench.events);
        keep(&mut log.kept, event);
        log.mailboxes.retain(|mailbox| {
            let Some(mailbox) = mailbox.upgrade() else { return false };
            keep(&mut lock(&mailbox), event);
            true
        });
        Ok(())
    }

    fn snapshot(&mut self, head: &SnapshotHead, words: &[u64]) -> Result<(), WireError> {
        check_snapshot(words)?;
        let sent = (*head, Arc::<[u64]>::from(words));
        *lock(&self.bench.last_snapshot) = Some(sent.clone());
        lock(&self.bench.snapshots).retain(|mailbox| {
            let Some(mailbox) = mailbox.upgrade() else { return false };
            let mut mailbox = lock(&mailbox);
            if mailbox.len() == SNAPSHOTS_BUFFERED {
                mailbox.pop_front();
            }
            mailbox.push_back(sent.clone());
            true
        });
        Ok(())
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        // Here listeners help themselves when they come.
        Ok(())
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryRecorder {
    bench: Arc<Bench>,
    _claim: Arc<()>,
}

impl RecorderSender for MemoryRecorder {
    fn send(&mut self, status: &mut RecorderStatus) -> Result<(), WireError> {
        status.stamp();
        let mut last = lock(&self.bench.recorder_status);
        last.0 += 1;
        *last.1 = *status;
        Ok(())
    }
}

/// See [`Memory`].
#[derive(Debug)]
pub struct MemoryInbox {
    receiver: mpsc::Receiver<Envelope>,
    _claim: Arc<()>,
}

impl Inbox for MemoryInbox {
    fn serve(&mut self, patience: Duration, mut answer: impl FnMut(&Request) -> Answer) -> Result<usize, WireError> {
        let mut served = 0;
        let mut next = self.receiver.recv_timeout(patience).ok();
        while let Some((request, reply)) = next {
            // A commander that has given up does not hear the answer.
            let _ = reply.send(answer(&request));
            served += 1;
            next = self.receiver.try_recv().ok();
        }
        Ok(served)
    }
}
