//! The ports, as traits: what a simulation and its readers can do with each other, whoever carries the bytes.
//!
//! Ports are made on the thread that uses them and stay there; a [`Host`] can be shared between threads to make them.

use std::time::Duration;

use rotor::{C64, Settings};

use crate::message::Request;
use crate::{
    Answer, BenchName, Bulletin, Event, Layout, RecorderStatus, Row, RowMut, SettingsMessage, Text, WireError,
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
}

/// A name held for a simulation. Dropping it, and the ports made from it, gives the name back.
pub trait Host: Send + Sync {
    /// See [`StateSender`].
    type States: StateSender;
    /// See [`BulletinSender`].
    type Bulletins: BulletinSender;
    /// See [`EventSender`].
    type Events: EventSender;
    /// See [`Inbox`].
    type Inbox: Inbox;

    /// The port for states of this layout; there is one.
    ///
    /// # Errors
    /// Another simulation holds it, or it cannot be made.
    fn states(&self, layout: Layout) -> Result<Self::States, WireError>;

    /// The port for bulletins; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn bulletins(&self) -> Result<Self::Bulletins, WireError>;

    /// The port for events; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn events(&self) -> Result<Self::Events, WireError>;

    /// The port for requests; there is one.
    ///
    /// # Errors
    /// It cannot be made.
    fn inbox(&self) -> Result<Self::Inbox, WireError>;

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

/// Sends bulletins. The last one also reaches readers that come later.
pub trait BulletinSender {
    /// Sends `bulletin`.
    ///
    /// # Errors
    /// There is no memory for it, or the carrier fails.
    fn send(&mut self, bulletin: &Bulletin) -> Result<(), WireError>;
}

/// Sends events. The last [`crate::EVENTS_KEPT`] also reach readers that come later.
pub trait EventSender {
    /// Sends `event`.
    ///
    /// # Errors
    /// There is no memory for it, or the carrier fails.
    fn send(&mut self, event: &Event) -> Result<(), WireError>;

    /// Tells readers that have come since the last call what they have missed; to be called a few times a second.
    ///
    /// # Errors
    /// The carrier fails.
    fn welcome(&mut self) -> Result<(), WireError>;
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
    /// The latest bulletin that has arrived since the last call.
    ///
    /// # Errors
    /// The carrier fails.
    fn bulletin(&mut self) -> Result<Option<Box<Bulletin>>, WireError>;

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
    fn drain(&mut self, visit: impl FnMut(Row<'_>)) -> Result<usize, WireError>;

    /// Visits every event that has arrived, oldest first; the first call after attaching, or soon after it, has those
    /// that happened before. Returns how many there were.
    ///
    /// # Errors
    /// The carrier fails.
    fn events(&mut self, visit: impl FnMut(&Event)) -> Result<usize, WireError>;

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

/// A change as people think of it; [`Change::request`] packs it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// New settings, whole, based on the revision that was looked at.
    Settings {
        /// The revision that was looked at.
        base_revision: u64,
        /// What shall be in force.
        settings: Settings,
    },
    /// A change of velocity of one mass.
    Impulse {
        /// The mass, counted from 0.
        mass: usize,
        /// The change, in `e_t` per unit of `tau`.
        velocity: C64,
    },
    /// Back to rest at `tau = 0`; a trip is reset.
    Restart,
    /// A marker with a note: it changes nothing, and stands in the log of events.
    Note {
        /// What it says: one line, at most [`Change::MAX_NOTE`] bytes.
        text: String,
    },
}

/// The kinds of [`Request::kind`] by name, from 1.
const KINDS: [&str; 4] = ["settings", "impulse", "restart", "note"];

impl Change {
    /// The longest note, in bytes.
    pub const MAX_NOTE: usize = 240;

    /// The message that asks for this, in the name of `who`, for the reason `why`, which may be empty.
    ///
    /// # Errors
    /// Settings, or a note, that do not fit in a message.
    pub fn request(&self, who: &str, why: &str) -> Result<Box<Request>, WireError> {
        let mut request = Box::new(Request { who: Text::new(who), why: Text::new(why), ..Request::default() });
        match self {
            Self::Settings { base_revision, settings } => {
                request.kind = 1;
                request.base_revision = *base_revision;
                request.settings = SettingsMessage::pack(settings)?;
            }
            Self::Impulse { mass, velocity } => {
                request.kind = 2;
                request.mass = *mass as u32;
                request.impulse = [velocity.re, velocity.im];
            }
            Self::Restart => request.kind = 3,
            Self::Note { text } => {
                if text.len() > Self::MAX_NOTE {
                    let told = format!("a note of {} bytes: expected at most {}", text.len(), Self::MAX_NOTE);
                    return Err(WireError::DoesNotFit(told));
                }
                request.kind = 4;
                request.text = Text::new(text);
            }
        }
        Ok(request)
    }

    /// What a message asks for; `None` for a kind that this version does not know.
    #[must_use]
    pub fn of(request: &Request) -> Option<Self> {
        match request.kind {
            1 => Some(Self::Settings { base_revision: request.base_revision, settings: request.settings.unpack() }),
            2 => Some(Self::Impulse {
                mass: request.mass as usize,
                velocity: C64::new(request.impulse[0], request.impulse[1]),
            }),
            3 => Some(Self::Restart),
            4 => Some(Self::Note { text: request.text.as_str().to_owned() }),
            _ => None,
        }
    }

    /// What a request of this kind asks for, in a word.
    #[must_use]
    pub fn kind_name(kind: u32) -> &'static str {
        (kind as usize).checked_sub(1).and_then(|at| KINDS.get(at)).copied().unwrap_or("unknown request")
    }

    /// The kind that has this name; 0 if none has.
    pub(crate) fn kind_of_name(name: &str) -> u32 {
        KINDS.iter().position(|kind| *kind == name).map_or(0, |at| at as u32 + 1)
    }
}
