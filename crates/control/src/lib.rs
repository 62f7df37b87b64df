//! The loop between the displacement of a rotor and the force of its magnetic bearing:
//!
//! ```text
//! sensors (lag, noise, resolution) -> sampling and hold -> law (gains, filters) -> delay -> actuator (lag, rate, limit)
//! ```
//!
//! Parts that are absent are not there: the ideal loop is the law alone. Everything is pure: no I/O, no clock, no threads;
//! and a [`Controller`] at work allocates nothing.
//!
//! * [`Feedback`], [`Signal`], [`Gain`]: the law. [`Filter`]: what shapes a signal. [`Parts`]: the numbers of the rest.
//! * [`Controller`]: all of it in motion, to be integrated with the plant it holds; its states are saved and restored.
//! * [`LinearLoop`]: the same as matrices, for poles and margins.
//!
//! What it holds is not its business: it sees displacements and velocities at sensors, and answers with a force.

mod block;
mod controller;
mod delay_line;
mod filter;
mod law;
mod linear;
mod parts;
mod words;

pub use block::MAX_ORDER;
pub use controller::{Controller, LoopError, Output, Stage};
pub use filter::{FILTERS, Filter, FilterError};
pub use law::{ControlRow, Feedback, FeedbackError, Gain, GainKind, Signal};
pub use linear::{Law, LinearLoop};
pub use parts::{PARTS, Part, PartError, Parts, Quantity};
pub use words::Words;

/// A complex number in double precision: `y + j z` in the plane of whirl.
pub type C64 = num_complex::Complex<f64>;

/// The imaginary unit.
pub const J: C64 = C64::new(0.0, 1.0);

/// The most stations that a law can sense, and signals that it can have.
pub const MAX_SENSORS: usize = 16;
