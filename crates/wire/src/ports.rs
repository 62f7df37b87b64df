//! The ports, as traits: what a simulation and its readers can do with each other, whoever carries the bytes.
//!
//! Ports are made on the thread that uses them and stay there; a [`Host`] can be shared between threads to make them.

use std::time::Duration;

use crate::document::MAX_DOCUMENT;
use crate::{
    Answer, BenchName, BenchStatus, ControlCommand, Event, MAX_SNAPSHOT, Readings, RecorderStatus, Request, RowMut,
    SnapshotHead, StepLayout, StepRow, WireError,
};

/// A way to carry messages between a simulation and its readers.
pub trait Carrier: Clone + Send + Sync + 'static {
    /// The simulation's side.
    type Host: Host;
    /// A reader's side, for telemetry.
    type Listener: Listener;
    /// The side of who only looks how things stand.
    type Glance: Glance;
    /// A reader's side, for requests.
    type Commander: Commander;
    /// A recorder's side, for its status.
    type Recorder: RecorderSender;
    /// The side of a controller outside.
    type Controller: Controlling;

    /// Takes the name `bench` for a simulation in this process.
    ///
    /// # Errors
    /// The name is taken, or the ports cannot be made.
    fn host(&self, bench: &BenchName) -> Result<Self::Host, WireError>;

    /// Attaches to `bench` for its telemetry.
    ///
    /// # Errors
    /// No such bench, another version, or no room: there are [`crate::MAX_READERS`] already.
    fn listen(&self, bench: &BenchName) -> Result<Self::Listener, WireError>;

    /// Attaches to `bench` to see how it stands. There is room for this where there is none for another reader.
    ///
    /// # Errors
    /// No such bench, another version, or no room: others look at this moment.
    fn glance(&self, bench: &BenchName) -> Result<Self::Glance, WireError>;

    /// Attaches to `bench` to ask it for changes. There is room for this where there is none for another reader.
    ///
    /// # Errors
    /// No such bench, another version, or no room.
    fn command(&self, bench: &BenchName) -> Result<Self::Commander, WireError>;

    /// Claims `bench` for the one recorder that it can have.
    ///
    /// # Errors
    /// Somebody records it already, no such bench, another version, or no room.
    fn recorder(&self, bench: &BenchName) -> Result<Self::Recorder, WireError>;

    /// Claims `bench` for the one controller outside that it can have.
    ///
    /// # Errors
    /// Somebody controls it from outside already, no such bench, another version, or no room.
    fn controller(&self, bench: &BenchName) -> Result<Self::Controller, WireError>;
}

/// A name held for a simulation. Dropping it, and the ports made from it, gives the name back.
pub trait Host: Send + Sync {
    /// See [`StateSender`].
    type States: StateSender;
    /// See [`NewsSender`].
    type News: NewsSender;
    /// See [`Inbox`].
    type Inbox: Inbox;
    /// See [`ControlHost`].
    type Control: ControlHost;

    /// The port for states of this layout; there is one.
    ///
    /// # Errors
    /// Another simulation holds it, or it cannot be made.
    fn states(&self, layout: StepLayout) -> Result<Self::States, WireError>;

    /// The port for bench statuses, events and the documents that they name; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn news(&self) -> Result<Self::News, WireError>;

    /// The port for requests; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn inbox(&self) -> Result<Self::Inbox, WireError>;

    /// The port for a controller outside; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn control(&self) -> Result<Self::Control, WireError>;

    /// How many listeners there are.
    fn listeners(&self) -> usize;
}

/// The most states that are sent together.
pub const MAX_BURST: usize = 32;

/// Sends states. Never waits for a reader: one that sleeps loses the oldest.
pub trait StateSender {
    /// Lets `fill` write the next `count` states, told by their place from 0 on, where readers will find them, and
    /// sends them together: 1 to [`MAX_BURST`].
    ///
    /// Steps that fall due together travel together, so that a reader costs the simulation a delivery a wake-up and
    /// not a delivery a step.
    ///
    /// # Errors
    /// There is no memory for them, there are none or too many, or the carrier fails.
    fn send(&mut self, count: usize, fill: impl FnMut(usize, &mut RowMut<'_>)) -> Result<(), WireError>;
}

/// Sends bench statuses and events, and before them the documents that they name, unless readers have those already.
pub trait NewsSender {
    /// Sends a bench status. The last one also reaches readers that come later.
    ///
    /// # Errors
    /// There is no memory for it, a document is too large, or the carrier fails.
    fn bench_status(&mut self, bench_status: &BenchStatus) -> Result<(), WireError>;

    /// Sends an event. The last [`crate::EVENTS_KEPT`] also reach readers that come later.
    ///
    /// # Errors
    /// As for a bench status.
    fn event(&mut self, event: &Event) -> Result<(), WireError>;

    /// Sends a snapshot: the words of `machine::Machine::save`, at most [`crate::MAX_SNAPSHOT`]. The last one also reaches
    /// readers that come later.
    ///
    /// # Errors
    /// There is no memory for it, it is too large, or the carrier fails.
    fn snapshot(&mut self, head: &SnapshotHead, words: &[u64]) -> Result<(), WireError>;

    /// Tells readers that have come since the last call what they have missed; to be called a few times a second, before
    /// the bench status.
    ///
    /// # Errors
    /// The carrier fails.
    fn welcome(&mut self) -> Result<(), WireError>;
}

/// The bench's side of a controller outside. Nothing here waits, or allocates while nobody comes or goes.
pub trait ControlHost {
    /// Sends readings. The last ones also reach a controller that comes later.
    ///
    /// # Errors
    /// There is no memory for them, or the carrier fails.
    fn send(&mut self, readings: &Readings) -> Result<(), WireError>;

    /// Visits the commands that have arrived, oldest first. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn commands(&mut self, visit: impl FnMut(&ControlCommand)) -> Result<usize, WireError>;

    /// Gives a controller that has come since the last readings those.
    ///
    /// # Errors
    /// The carrier fails.
    fn welcome(&mut self) -> Result<(), WireError>;
}

/// The side of a controller outside. Dropping it gives its place free for the next one.
pub trait Controlling {
    /// The oldest readings that wait, if any do.
    ///
    /// # Errors
    /// The carrier fails.
    fn readings(&mut self) -> Result<Option<Readings>, WireError>;

    /// Sends a command.
    ///
    /// # Errors
    /// There is no memory for it, or the carrier fails.
    fn command(&mut self, command: &ControlCommand) -> Result<(), WireError>;

    /// Whether the simulation is there. Takes up to a millisecond: not for every turn of a loop.
    fn host(&self) -> HostState;
}

/// Sends the status of a recorder. Dropping it gives the bench free for the next one.
pub trait RecorderSender {
    /// Sends `status`, which is stamped with the present time; to be called at least once a second, and at the end with
    /// a state that says how it ended.
    ///
    /// # Errors
    /// There is no memory for it, or the carrier fails.
    fn send(&mut self, status: &mut RecorderStatus) -> Result<(), WireError>;
}

/// Refuses a document that is too large.
pub(crate) fn check_document(text: &str) -> Result<(), WireError> {
    if text.len() <= MAX_DOCUMENT {
        return Ok(());
    }
    Err(WireError::DoesNotFit(format!("a document of {} bytes: expected at most {MAX_DOCUMENT}", text.len())))
}

/// Refuses a snapshot that is too large.
pub(crate) fn check_snapshot(words: &[u64]) -> Result<(), WireError> {
    if words.len() <= MAX_SNAPSHOT {
        return Ok(());
    }
    Err(WireError::DoesNotFit(format!("a snapshot of {} words: expected at most {MAX_SNAPSHOT}", words.len())))
}

/// Refuses what no burst can be.
pub(crate) fn check_burst(count: usize) -> Result<(), WireError> {
    if (1..=MAX_BURST).contains(&count) {
        return Ok(());
    }
    Err(WireError::DoesNotFit(format!("{count} states at once: expected 1 to {MAX_BURST}")))
}

/// Receives requests and answers each.
pub trait Inbox {
    /// Waits up to `patience` for requests and answers every one that is there. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn serve(&mut self, patience: Duration, answer: impl FnMut(&Request) -> Answer) -> Result<usize, WireError>;
}

/// Whether the simulation behind a [`Listener`] is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostState {
    /// Its process lives.
    Alive,
    /// It has ended or died; a new one may take the name and is then heard by the same listener.
    Gone,
}

/// Sees how a bench stands, and how its recorder does, without its motion. Stays usable when the simulation dies and
/// hears the next one of the same name.
pub trait Glance {
    /// The latest bench status that has arrived since the last call.
    ///
    /// # Errors
    /// The carrier fails.
    fn bench_status(&mut self) -> Result<Option<Box<BenchStatus>>, WireError>;

    /// The latest that has been heard of a recorder; `None` if nothing has. One that has gone without a word is
    /// [`crate::RecorderState::Died`]. Takes up to a millisecond: not for every turn of a loop.
    ///
    /// # Errors
    /// The carrier fails.
    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError>;
}

/// Receives telemetry: all that a [`Glance`] sees, and the motion and what happens.
pub trait Listener: Glance {
    /// Visits every state that has arrived, oldest first, without copying. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn drain(&mut self, visit: impl FnMut(StepRow<'_>)) -> Result<usize, WireError>;

    /// Visits every event that has arrived, oldest first; the first call after attaching, or soon after it, has those
    /// that happened before. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn events(&mut self, visit: impl FnMut(&Event)) -> Result<usize, WireError>;

    /// Visits every snapshot that has arrived, oldest first: its head, and the words to give to `machine::Machine::restore`.
    /// A reader that sleeps loses the oldest. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn snapshots(&mut self, visit: impl FnMut(&SnapshotHead, &[u64])) -> Result<usize, WireError>;

    /// Whether the simulation is there. Takes up to a millisecond: not for every turn of a loop.
    fn host(&self) -> HostState;
}

/// Asks for changes.
pub trait Commander {
    /// Asks, and waits up to `patience` for the answer.
    ///
    /// # Errors
    /// No answer in time, a request that does not fit, or a carrier that fails.
    fn ask(&mut self, request: &Request, patience: Duration) -> Result<Answer, WireError>;
}
