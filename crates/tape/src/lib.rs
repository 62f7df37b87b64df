//! Recordings: the sink and the reader of `.rrd` files, side by side, so that what one writes the other reads.
//!
//! Only this crate knows rerun, and only with the cargo feature `rerun`, which takes minutes to build. Everything that can
//! do without is outside it: gathering steps from a bench, the queue to the writing thread ([`recorder`]),
//! which files it is kept in ([`FileRotation`]), what a file says about itself ([`schema`]), and what is
//! made of a recording ([`Info`]). Nothing of rerun shows in the public interface: a [`Recording`] speaks in
//! `wire` and `rotor` types, and without the feature opening one says how to get it.
//!
//! ```
//! use std::path::Path;
//! use tape::{Info, Recording, TapeError};
//!
//! match Recording::open(Path::new("../../recordings/run-up.rrd")) {
//!     Ok(mut recording) => assert_eq!(Info::of(&mut recording)?.trips.len(), 1),
//!     Err(TapeError::NoRerun) => {} // a build without the cargo feature
//!     Err(error) => return Err(error),
//! }
//! # Ok::<(), TapeError>(())
//! ```
//!
//! Not its job: showing recordings (that is the dashboard's), and simulating.

#![cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "much of it serves the encoder and the reader"))]

mod alarm_recorder;
mod batch;
mod contents;
mod damage;
mod document;
mod error;
mod event;
mod file_series;
mod gather;
mod info;
mod offline;
#[cfg(any(feature = "rerun", test))]
mod order;
mod past;
pub mod recorder;
mod recording;
mod rotation;
#[cfg(feature = "rerun")]
mod rrd;
pub mod schema;
mod session;
mod sink;
mod snapshot;
// Files are the business of the feature; that they are gone through rightly is tested without it.
#[cfg(any(feature = "rerun", test))]
mod stream;
mod viewer;

pub use batch::Batch;
pub use damage::{Damage, DamageKind, LostSteps};
pub use error::TapeError;
pub use event::{Event, Remark, What};
pub use info::{AlarmInfo, DampingInfo, Info, MomentInfo, PeakInfo, TripInfo};
pub use offline::OfflineTape;
pub use past::write_past;
pub use recording::Recording;
pub use rotation::{FileRotation, Keep};
pub use session::{Gap, Revision, Session, Source, Span};
pub use sink::{Head, Sink, available, create, join};
pub use snapshot::Snapshot;
pub use viewer::{ViewerState, ViewerStatus};
