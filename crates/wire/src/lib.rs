//! What crosses a process border: the messages, their schema version, and the ports that carry them.
//!
//! A new reader of telemetry needs this crate and nothing else. Messages are `#[repr(C)]`, fixed in size and documented
//! field by field in [`message`]; the ports are traits ([`Carrier`] and its family) with two implementations under one
//! contract suite: [`SharedMemory`], which is iceoryx2, and [`Memory`], which is a map of queues for tests.
//!
//! A bench called `NAME` is six iceoryx2 services:
//!
//! | service | pattern | what |
//! |---|---|---|
//! | `whirl/NAME/state` | publish-subscribe of slices of 64-bit words | every step, in order, a row of [`CHANNELS`] each; those that fall due together in one message, up to [`MAX_BURST`]; oldest dropped if a reader sleeps |
//! | `whirl/NAME/bulletin` | publish-subscribe of [`Bulletin`] | the whole slow picture: rotor, settings, poles, health; on change and ten times a second |
//! | `whirl/NAME/event` | publish-subscribe of [`Event`] | what happens, numbered, with the settings in force after it; the last [`EVENTS_KEPT`] reach late readers |
//! | `whirl/NAME/recorder` | publish-subscribe of [`RecorderStatus`] | from the recorder, if there is one: file, size, losses; at least once a second |
//! | `whirl/NAME/command` | request-response of [`Request`] and [`Answer`] | changes, answered with the step that took them |
//! | `whirl/NAME/wake` | event | tells the simulation that a request waits |

mod bench_name;
mod census;
mod channels;
mod error;
mod event;
mod faults;
mod filter_message;
mod iceoryx;
mod memory;
pub mod message;
mod moment;
mod name_lock;
mod ports;
mod recorder;
mod root;
mod settings_message;
mod shared_commands;
mod shared_glance;
mod shared_memory;
mod shared_news;
mod short_path;
mod step;
mod text;

pub use bench_name::BenchName;
pub use census::{BenchEntry, Party, clean};
pub use channels::{CHANNELS, Channel, ChannelRow, Dimension, OnceWas, PAIRS, Pair, Scope, WHOLES, channels_of};
pub use error::WireError;
pub use event::{EVENTS_KEPT, Event, Happening};
pub use iceoryx::MAX_READERS;
pub use memory::Memory;
pub use message::{Answer, Bulletin, Flags, Request, SCHEMA};
pub use moment::Moment;
pub use ports::{
    BulletinSender, Carrier, Change, Commander, EventSender, Glance, Host, HostState, Inbox, Listener, MAX_BURST,
    RecorderSender, StateSender,
};
pub use recorder::{Keeping, RecorderState, RecorderStatus};
pub use root::Root;
pub use settings_message::{MAX_KNOTS, SettingsMessage};
pub use shared_glance::SharedGlance;
pub use shared_memory::{SharedListener, SharedMemory};
pub use shared_news::SharedRecorder;
pub use step::{Column, Layout, MAX_WIDTH, Point, Row, RowMut, State, Step};
pub use text::Text;
