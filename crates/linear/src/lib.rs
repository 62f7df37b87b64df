//! Linear analysis of any loop with one pure delay: plain complex matrices in, proven roots out.
//!
//! A [`DelaySystem`] is `x' = A x + B C x(t - T)`. Its roots solve
//!
//! ```text
//! det(s I - A - B C exp(-s T)) = 0
//! ```
//!
//! and there are infinitely many, but only so many right of any vertical line. [`DelaySystem::roots_right_of`] finds those,
//! all of them, or refuses:
//!
//! * what they are *near* comes from the eigenvalues of a matrix, the delay approximated ([`guess`]);
//! * what they *are* comes from Newton's method on the equation itself ([`roots`]);
//! * that there are *no more* is counted by the argument principle, with steps that cannot lose a turn ([`count`]).
//!
//! ```
//! use linear::{C64, DelaySystem};
//! use nalgebra::DMatrix;
//!
//! // x' = -x(t - T) is stable up to T = pi / 2.
//! let of = |number: f64| DMatrix::from_element(1, 1, C64::from(number));
//! let system = DelaySystem::new(of(0.0), of(-1.0), of(1.0), 1.0)?;
//! assert_eq!(system.count_right_of(0.0)?, 0);
//! let margin = system.delay_margin()?.ok_or("some delay makes it unstable")?;
//! assert!((margin.delay - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`eigenvalues`] are those of any complex matrix. A [`LoopGain`] is the gain of one loop over frequency, sampled or not;
//! [`LoopGain::margins`] are its margins and peaks, found on a curve. Of several loops closed together each has one, and [`SeveralLoops`] is what
//! they share. [`DelaySystem::certified_peak`] is the peak of the sensitivity, of several loops too, with a value that no frequency exceeds.
//! [`peak`] is where a function of one number is largest or least.
//!
//! No part of it knows what the matrices describe. No files, no terminal, no threads.

mod balance;
mod certified_peak;
mod count;
mod covered;
mod covered_fractions;
mod curve;
mod eigenvalues;
mod guess;
mod inverse;
mod loci;
mod loop_gain;
mod margin;
mod margins;
mod motions;
mod partial_fractions;
pub mod peak;
mod roots;
mod sensitivity;
mod several;
mod system;

pub use certified_peak::{CertifiedPeak, PeakProof};
pub use covered::{AffineTerm, CoveredPeak};
pub use eigenvalues::{EigenvalueError, eigenvalues, eigenvalues_in_place};
pub use loci::{UnitLocus, borne, loci, unit_loci};
pub use loop_gain::{FrequencyGain, GainMatrix, LoopGain};
pub use margin::DelayMargin;
pub use margins::{AmplitudePeak, GainMargin, Margins, PhaseMargin, STRONGEST, STRONGEST_LATE};
pub use peak::least;
pub use roots::Roots;
pub use sensitivity::{Sensitivity, SharpRoot};
pub use several::SeveralLoops;
pub use system::{DelayError, DelaySystem};

/// A complex number in double precision.
pub type C64 = num_complex::Complex<f64>;
