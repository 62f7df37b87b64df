//! Plant, loop and motion as one [`Machine`]: stepped, guarded against what is not finite, tripped, saved and restored.
//!
//! A [`Program`] is settings compiled for it, away from the thread that steps, and swapped in between two steps. A chain under
//! an ideal loop takes the fused path of crate `rotor`, through a changing speed too unless that is driven by a given torque;
//! everything else is integrated together with the loop's own states.
//!
//! ```
//! use machine::{Machine, MachinePoles, Pace, Program};
//! use rotor::{C64, Settings, builtin};
//!
//! let rotor = builtin::rotor("three-mass").ok_or("built in")?;
//! let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").ok_or("built in")?);
//! let slowest = MachinePoles::of(&rotor, &settings)?.modes[0].pole;
//!
//! // Struck at mass 1, it comes to rest as its poles say.
//! let program = Program::compile(&rotor, &settings, [settings.speed; 2], Pace { dtau: 0.01, rate_hz: 0.0 })?;
//! let mut machine = Machine::new(program);
//! machine.kick(0, C64::new(0.0, -2.5));
//! while machine.tau() < 20.0 {
//!     assert!(machine.step().is_none(), "it does not trip");
//! }
//! assert!(slowest.re < 0.0 && machine.motion().displacement[0].norm() < 2.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Not its business: real time, messages, and what settings may be.

mod counted_modes;
mod excited;
mod forced;
mod frequency;
mod integrate;
mod machine;
mod margins;
mod margins_over;
mod motion;
mod over_speed;
mod poles;
mod program;
mod stability_loss;
mod trip;
mod trip_at_once;
mod zones;

pub use control::{Excitation, ExcitationError, Multisine, Output, StateWords, Tone};
pub use counted_modes::CountedModes;
pub use forced::forced_response;
pub use frequency::{
    FrequencyPoint, TransferFunction, UnbalancePeak, UnbalancePoint, UnbalanceResponse, unbalance_response,
};
pub use linear::STRONGEST_LATE;
pub use machine::{ClockOrigin, Machine, Sample, Sensed};
pub use margins::{BearingMargins, LoopMargins, MachineLoop, MachineMargins, MarginsError, loop_margins, margins};
pub use margins_over::{WORST, in_hand, margins_at, worst_among, worst_margins};
pub use motion::MAX_LEGS;
pub use over_speed::{BranchOverSpeed, Campbell, campbell, thresholds, trace};
pub use poles::{MachinePoles, PolesError, counted_damping, damping_among, min_damping};
pub use program::{Pace, ProfileError, Program, ProgramError, default_step, default_step_over, fastest};
pub use rotor::profile::Leg;
pub use rotor::{LinearForm, SampledStep};
pub use stability_loss::StabilityLoss;
pub use trip::{Trip, TripCause};
pub use trip_at_once::TripAtOnce;
pub use zones::{ISO_14839_3, sensitivity_zone};
