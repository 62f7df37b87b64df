//! The loop between the displacement of a rotor and the force of its magnetic bearing:
//!
//! ```text
//! sensors (lag, noise, resolution) -> sampling and hold -> law (gains, filters) -> delay -> actuator (lag, rate, limit)
//! ```
//!
//! Parts that are absent are not there: the ideal loop is the law alone. Everything is pure: no I/O, no clock, no threads;
//! and a [`Controller`] at work allocates nothing.
//!
//! ```
//! use control::{ControlBearing, Controller, Gain, GainKind, Signal};
//!
//! // The bearing at mass 1, one signal of masses 1 and 2, gains kd cd kc cc; kd falls with speed.
//! let mut bearing = ControlBearing::new(0, vec![Signal::composite(&[1.0, 1.0, 0.0], [0.0, 0.5, -0.5, 0.6])]);
//! *bearing.signals[0].gain_mut(GainKind::Kd) = Gain::Linear { at_zero: -0.1, slope: -0.2 };
//! assert_eq!(bearing.at(2.0).displacement[0], control::C64::new(-0.5, 0.5), "kd - j kc");
//!
//! // The same through a loop that takes time, for a rotor of three masses at R = 2 in steps of 0.01.
//! bearing.parts.delay = 0.05;
//! let controller = Controller::new(&bearing, 3, 2.0, 0.01)?;
//! assert!(controller.remembers());
//! # Ok::<(), control::LoopError>(())
//! ```
//!
//! * [`Feedback`]: every control bearing of a machine. [`ControlBearing`], [`Signal`], [`Gain`]: the law of one. [`Filter`]: what shapes a signal; [`Corners`]: its frequencies, to be varied. [`Parts`]: the numbers of the rest.
//! * [`Controller`]: all of it in motion, to be integrated with the plant it holds; its states are saved and restored.
//! * [`Excitation`]: tones added to its command for a while, so that it can be measured; made of a [`Multisine`].
//! * [`LinearLoop`]: the same as matrices, for poles and margins.
//!
//! What it holds is not its business: it sees displacements and velocities at sensors, and answers with a force.

mod block;
mod controller;
mod corners;
mod delay_line;
mod excitation;
mod feedback;
mod filter;
mod gain;
mod law;
mod law_over_speed;
mod linear;
mod parts;
mod state_space;
mod state_words;

pub use block::MAX_ORDER;
pub use controller::{Controller, LoopError, Output, Stage};
pub use corners::Corners;
pub use excitation::{Excitation, ExcitationError, Multisine, Tone};
pub use feedback::Feedback;
pub use filter::{FILTERS, Filter, FilterError, STATE_SPACE, TRANSFER_FUNCTIONS};
pub use gain::{Gain, GainKind};
pub use law::{ControlBearing, ControlRow, FeedbackError, Signal};
pub use law_over_speed::{LawOverSpeed, LawPiece};
pub use linear::{Law, LinearLoop};
pub use parts::{FAULTS, PARTS, Part, PartError, Parts};
pub use state_words::StateWords;

/// A complex number in double precision: `y + j z` in the plane of whirl.
pub type C64 = num_complex::Complex<f64>;

/// The imaginary unit.
pub const J: C64 = C64::new(0.0, 1.0);

/// The most stations that a law can sense, and signals that it can have.
pub const MAX_SENSORS: usize = 16;

/// The most control bearings that a machine can have.
pub const MAX_BEARINGS: usize = 8;
