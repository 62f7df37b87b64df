//! What the dimensionless quantities of a rotor are in SI units: its scales, and the one table of units.
//!
//! Everything is computed dimensionless. A rotor given in SI units keeps its [`Scales`]; what people type and read for it is in
//! seconds, metres, newtons, rpm and hertz, as [`Dimension`] has it. A rotor without scales is told in its own units, under the
//! names of the same table.
//!
//! ```
//! use units::{Dimension, Scales, Units};
//!
//! // 40 kg, w0 = 300 rad/s and an unbalance of 20 um; the bearing carries a quarter of the mass.
//! let units = Units::of(Some(Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 }), 0.25);
//! assert_eq!(units.unit(Dimension::Length).to_string(), "m");
//! assert_eq!(units.shown(Dimension::Length, 2.0), 40e-6);
//! assert_eq!(units.typed(Dimension::Time, 2.0), 600.0);
//! assert_eq!(Units::DIMENSIONLESS.unit(Dimension::Length).name, "e_t");
//! ```

mod dimension;
mod scales;
mod typed;

pub use dimension::{Dimension, Unit, Units};
pub use scales::Scales;
pub use typed::{Typed, TypedError, parts};
