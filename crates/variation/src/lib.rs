//! Machines whose numbers are not quite what is thought.
//!
//! * [`Parameter`]: every number that a machine is made of, by the name under which it is typed; [`Model`]: the machine as it is said to
//!   be, and with other numbers.
//! * [`sensitivities()`]: what the smallest damping and every margin do when one of them changes a little, from the derivatives of
//!   poles and of the loop's gain.
//! * [`worst()`]: how bad it can get when several lie anywhere in a range, proven where that can be.
//! * [`samples()`]: what becomes of the damping when they are drawn at random.
//!
//! ```
//! use rotor::{Settings, builtin};
//! use variation::{Model, Parameter, sensitivities};
//!
//! let rotor = builtin::rotor("three-mass").ok_or("built in")?;
//! let settings = Settings::new(&rotor, 6.0, builtin::feedback(&rotor, "individual").ok_or("built in")?);
//! let model = Model::new(rotor, settings);
//! let found = sensitivities(&model, &[model.parameter("damping.3")?])?;
//! // More damping in the seal brings more cross-coupled stiffness with it: at the end without a bearing that is the worse of the two.
//! assert!(found.each[0].min_damping.clone()?.up < 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Everything is about the linear machine, every support bearing at its full stiffness. Not its business: files, and who asks.

mod drawn;
mod form_slope;
mod margin_slope;
mod model;
mod parameter;
mod samples;
mod sensitivity;
mod stencil;
mod variation_error;
mod worst;

pub use model::Model;
pub use parameter::{Parameter, Quantity};
pub use samples::{Distribution, Samples, SamplesError, Share, draw, quantile, samples, values};
pub use sensitivity::{DampingSlope, NoSlope, Sensitivities, Sensitivity, damping_sensitivities, sensitivities};
pub use variation_error::VariationError;
pub use worst::{Range, Worst, worst};
