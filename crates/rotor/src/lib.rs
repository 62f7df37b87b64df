//! The machine: a rotor, held by seals, support bearings with deadband and magnetic control bearings. It is a chain of lumped masses on
//! flexible shafts, or shaft elements and discs as crate [`beam`] has them.
//!
//! Everything here is pure: no I/O, no clock, no threads. The working form is complex: the whirl of
//! mass `i` is one number `p = y + j z`, in units of `e_t`, over dimensionless time `tau = w0 t`, so
//! that the circular symmetry of the machine is built in and forward (`Im > 0`) and backward whirl
//! are told apart. The real state vectors and matrices of the NASA report live in [`report_form`],
//! for checking and for those who expect them.
//!
//! ```
//! use rotor::{Settings, Modes, builtin, thresholds};
//!
//! // A rotor of your own: `rotor::file::read_rotor`.
//! let rotor = builtin::rotor("three-mass").ok_or("built in")?;
//! let off = builtin::feedback(&rotor, "off").ok_or("built in")?;
//! // The report prints 1.776 for the speed at which it turns unstable without control.
//! assert!((thresholds(&rotor, &off, 0.0, 6.0)?[0].speed - 1.776).abs() < 1e-3);
//!
//! let composite = builtin::feedback(&rotor, "composite").ok_or("built in")?;
//! let held = Modes::of(&Settings::new(&rotor, 2.5, composite).closed_loop(&rotor))?;
//! assert!(held.is_stable() && held.modes.len() == 2 * rotor.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`Rotor`], [`Mass`]: the parameters. [`builtin`]: the report's two rotors and their feedback.
//! * [`Scales`]: what an SI rotor keeps of its units. [`mod@file`]: rotors and feedback as TOML text.
//! * [`Plant`]: the rotor without control, independent of speed: a chain, or dense matrices.
//! * [`Feedback`], [`Signal`], [`Gain`]: the control law, from crate `control`.
//! * [`Settings`]: all that can be changed on a running machine, with one table of its keys. [`ControlMasses`]: by which control is a force.
//! * [`LinearForm`]: plant and any loop as matrices, the delay kept apart. [`Characteristic`]: its roots.
//! * [`ClosedLoop`]: rotor and feedback at one operating point, as coefficients.
//! * [`Stepper`]: time integration with the deadband; [`step`]: which steps follow it. [`Modes`]: poles without it.
//!   [`Stability`]: what they say. [`batch`]: many trajectories at once, the same to the last bit. [`Peaks`]: maxima between samples.
//! * [`assign_poles`], [`cancelling`]: feedback for chosen poles. [`influence()`]: which bearing and sensor reach which mode.
//! * [`trace()`], [`thresholds()`], [`critical_speeds`]: poles followed over speed.
//! * [`typed`]: ranges, `KEY=VALUE` and rows of settings as a person types them.
//! * [`circular`]: exact circular orbits with the deadband, forced and self-excited, with their stability.

mod assign;
pub mod batch;
mod beam_rotor;
pub mod builtin;
mod characteristic;
pub mod circular;
mod closed_loop;
mod control_masses;
mod crossing;
mod difference;
mod family;
pub mod file;
mod follow;
mod influence;
mod linear_form;
mod loop_over_speed;
mod marginal;
mod mass;
mod modes;
mod parameters;
mod peak;
mod plant;
pub mod profile;
mod quadratic;
pub mod report_form;
mod rotor;
mod rotor_error;
mod settings;
mod settings_error;
mod shaft_line;
mod si;
pub mod step;
mod stepper;
mod thresholds;
mod trace;
pub mod typed;

pub use assign::{AssignError, Assignment, assign_poles, cancelling};
pub use beam_rotor::BeamRotor;
pub use characteristic::{Characteristic, CharacteristicRoot};
pub use closed_loop::ClosedLoop;
pub use control::{
    ControlBearing, ControlRow, Feedback, FeedbackError, Filter, FilterError, Gain, GainKind, Parts, Signal,
};
pub use control_masses::ControlMasses;
pub use difference::{ChangedValue, Difference};
pub use follow::TraceError;
pub use influence::{Influence, PBH_LIMIT, influence};
pub use linear::eigenvalues;
pub use linear_form::{LinearForm, SampledStep};
pub use loop_over_speed::{LoopOverSpeed, SpeedStage};
pub use marginal::{Stability, stability};
pub use mass::{FIELDS, Field, Mass};
pub use modes::{Mode, Modes, PoleError, Whirl, damping_ratio, poles, scale_to_largest};
pub use parameters::{Key, PARAMETERS, Parameter, Scope};
pub use peak::Peaks;
pub use plant::{Contact, Direction, MAX_ORDER, Matrices, OperatingPoint, Plant, PlantError, Spin, Station, Tabulated};
pub use quadratic::Quadratic;
pub use rotor::Rotor;
pub use rotor_error::{BeamError, RotorError};
pub use settings::Settings;
pub use settings_error::SettingsError;
pub use shaft_line::ShaftLine;
pub use si::{Physical, PhysicalMass};
pub use stepper::{Motion, Stepper, stepper};
pub use thresholds::{Threshold, thresholds};
pub use trace::{Branch, CriticalSpeed, Trace, critical_speeds, trace};

pub use units::Scales;

/// A complex number in double precision: `y + j z` in the plane of whirl.
pub type C64 = control::C64;

/// The imaginary unit.
pub const J: C64 = control::J;

/// The most masses a rotor can have. Fixed, because state crosses process borders in fixed-size messages.
pub const MAX_MASSES: usize = control::MAX_SENSORS;

pub use control::MAX_BEARINGS;

/// The longest name a rotor can have, in bytes of UTF-8, for the same reason.
pub const MAX_NAME: usize = 64;
