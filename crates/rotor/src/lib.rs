//! The machine: a chain of lumped masses on flexible shafts, held by seals, support bearings with
//! deadband and one magnetic control bearing.
//!
//! Everything here is pure: no I/O, no clock, no threads. The working form is complex: the whirl of
//! mass `i` is one number `p = y + j z`, in units of `e_t`, over dimensionless time `tau = w0 t`, so
//! that the circular symmetry of the machine is built in and forward (`Im > 0`) and backward whirl
//! are told apart. The real state vectors and matrices of the NASA report live in [`report_form`],
//! for checking and for those who expect them.
//!
//! * [`Rotor`], [`Mass`]: the parameters. [`builtin`]: the report's two rotors and their feedback.
//! * [`Feedback`], [`Signal`], [`Gain`]: the control law.
//! * [`Settings`]: all that can be changed on a running machine, with one table of its keys.
//! * [`ClosedLoop`]: rotor and feedback at one operating point, as coefficients.
//! * [`Stepper`]: time integration with the deadband. [`Spectrum`]: poles without it.
//! * [`circular`]: exact circular orbits with the deadband, forced and self-excited, with their stability.

pub mod builtin;
pub mod circular;
mod closed_loop;
mod feedback;
mod modes;
mod params;
pub mod report_form;
mod settings;
mod stepper;

pub use closed_loop::ClosedLoop;
pub use feedback::{ControlRow, Feedback, FeedbackError, Gain, GainKind, Signal};
pub use modes::{Mode, PoleError, Spectrum, Whirl, damping_ratio, eigenvalues};
pub use params::{Mass, Rotor, RotorError};
pub use settings::{Key, PARAMETERS, Parameter, Scope, Settings, SettingsError};
pub use stepper::{Motion, Stepper, stepper};

/// A complex number in double precision: `y + j z` in the plane of whirl.
pub type C64 = num_complex::Complex<f64>;

/// The imaginary unit.
pub const J: C64 = C64::new(0.0, 1.0);

/// The most masses a rotor can have. Fixed, because state crosses process borders in fixed-size messages.
pub const MAX_MASSES: usize = 16;
