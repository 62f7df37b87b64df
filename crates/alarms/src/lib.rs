//! Alarms: what of a running machine is past its limits, since when, and by how much.
//!
//! The dashboard and the recorder judge by the same rules, whoever of them runs: a [`Sampler`] takes a [`Reading`] of what
//! the bench sends, [`Alarms`] hold it against [`Limits`], and every crossing comes out as a [`LevelChange`]. Pure: no clock, no
//! files, no screen.
//!
//! ```
//! use alarms::{Alarms, Level, Limits, Reading, Watch};
//! use wire::Moment;
//!
//! let mut limits = Limits::default();
//! limits.set(Watch::Orbit, Some([5.0, 15.0]))?;
//! let mut alarms = Alarms::new(limits);
//! let turns = alarms.read(&Reading::new(Moment::default()).with(Watch::Orbit, 16.0));
//! assert_eq!((turns[0].watch, turns[0].level), (Watch::Orbit, Level::Alarm));
//! # Ok::<(), alarms::LimitsError>(())
//! ```
//!
//! Not its job: showing alarms, ringing bells, or writing them down.

mod limits;
mod machine;
mod reading;
mod sampler;
mod turn;
mod usual;
mod watch;

pub use limits::{AskedLimit, LOW_DAMPING, Limit, Limits, LimitsError};
pub use machine::{Alarms, Entry, Standing};
pub use reading::{Reading, Sample};
pub use sampler::Sampler;
pub use turn::LevelChange;
pub use watch::{Level, Watch};
