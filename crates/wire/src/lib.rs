//! What crosses a process border: the messages, their schema version, and the ports that carry them.
//!
//! A new reader of telemetry needs this crate and nothing else. Messages are `#[repr(C)]`, fixed in size and documented
//! field by field in [`message`]; the ports are traits ([`Carrier`] and its family) with two implementations under one
//! contract suite: [`SharedMemory`], which is iceoryx2, and [`Memory`], which is a map of queues for tests.
//!
//! ```
//! use wire::{BenchName, Carrier, Host, StepLayout, Listener, Memory, Point, StateSender, Step};
//!
//! let bench: BenchName = "demo".parse()?;
//! // Between processes: `SharedMemory::new(&Root::from_environment()?, "reader")?`.
//! let carrier = Memory::default();
//! let rotor = rotor::builtin::rotor("three-mass").ok_or("built in")?;
//! let mut states = carrier.host(&bench)?.states(StepLayout::new(rotor.len()))?;
//!
//! let mut listener = carrier.listen(&bench)?;
//! states.send(1, |_, row| row.set_point(0, Point { y: 0.5, ..Point::default() }))?;
//! let mut widest = 0.0;
//! listener.drain(|step| widest = step.largest_radius())?;
//! assert_eq!(widest, 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A bench called `NAME` is ten iceoryx2 services ([`Topic`]):
//!
//! | service | pattern | what |
//! |---|---|---|
//! | `whirl/NAME/state` | publish-subscribe of slices of 64-bit words | every step, in order, a row of [`CHANNELS`] each; those that fall due together in one message, up to [`MAX_BURST`]; oldest dropped if a reader sleeps |
//! | `whirl/NAME/document` | publish-subscribe of slices of bytes, with a [`DocumentHead`] | rotor and settings as text, before the first message that names them by hash; those that can still be named reach late readers |
//! | `whirl/NAME/status` | publish-subscribe of [`message::BenchStatusMessage`] | the whole slow picture: rotor, settings, poles, health; on change and ten times a second |
//! | `whirl/NAME/event` | publish-subscribe of [`EventMessage`] | what happens, numbered, with the settings in force after it; the last [`EVENTS_KEPT`] reach late readers |
//! | `whirl/NAME/snapshot` | publish-subscribe of slices of 64-bit words, with a [`SnapshotHead`] | all that decides how the machine goes on, at every change and once a second |
//! | `whirl/NAME/recorder` | publish-subscribe of [`RecorderStatus`] | from the recorder, if there is one: file, size, losses; at least once a second |
//! | `whirl/NAME/command` | request-response of slices of bytes (the new settings' document, or nothing) with a [`message::RequestMessage`], and [`Answer`] | changes, answered with the step that took them |
//! | `whirl/NAME/wake` | event | tells the simulation that a request waits |
//! | `whirl/NAME/reading` | publish-subscribe of [`Readings`] | what the sensors read, for a controller outside |
//! | `whirl/NAME/control` | publish-subscribe of [`ControlCommand`] | its commands |

mod bench_name;
mod bench_status;
mod benches;
mod channels;
mod control;
mod delivery;
mod document;
mod error;
mod event;
mod faults;
pub mod header;
mod iceoryx;
mod layout;
mod memory;
pub mod message;
mod moment;
mod name_lock;
mod ports;
pub mod protocol;
pub mod python;
mod recorder;
mod request;
mod root;
mod shared_commands;
mod shared_control;
mod shared_glance;
mod shared_memory;
mod shared_news;
mod short_path;
mod snapshot;
mod step;
mod text;
mod topic;
mod wire_struct;

pub use bench_name::BenchName;
pub use bench_status::BenchStatus;
pub use benches::{AttachedProcess, BenchEntry, clean};
pub use channels::{CHANNELS, Channel, ChannelRow, PAIRS, Pair, Scope, Substitute, WHOLES, channels_of};
pub use control::{ControlCommand, Readings};
pub use document::{
    Content, DOCUMENTS_KEPT, Document, DocumentError, DocumentHead, MAX_DOCUMENT, RotorDocument, SettingsDocument,
    hash_of,
};
pub use error::WireError;
pub use event::{EVENTS_KEPT, Event, EventMessage, Happening};
pub use iceoryx::MAX_READERS;
pub use layout::{Column, MAX_WIDTH, StepLayout};
pub use memory::Memory;
pub use message::{Answer, Flags, SCHEMA};
pub use moment::Moment;
pub use ports::{
    Carrier, Commander, ControlHost, Controlling, Glance, Host, HostState, Inbox, Listener, MAX_BURST, NewsSender,
    RecorderSender, StateSender,
};
pub use recorder::{Keeping, RecorderState, RecorderStatus};
pub use request::{Change, Request, RequestError};
pub use root::Root;
pub use shared_control::{SharedControlHost, SharedController};
pub use shared_glance::SharedGlance;
pub use shared_memory::{SharedListener, SharedMemory};
pub use shared_news::{SharedNews, SharedRecorder};
pub use snapshot::{MAX_SNAPSHOT, SnapshotHead};
pub use step::{Point, RowMut, State, Step, StepRow, bearing_of, force_channels};
pub use text::Text;
pub use topic::Topic;
pub use wire_struct::{Field, Message, MessageTable};
