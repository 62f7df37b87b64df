//! Offline work on rotors: what takes a while, uses all cores, or leaves a file behind.
//!
//! * [`run`]: one simulation as fast as it goes, with maxima, means and automatic settling.
//! * [`disturbance`]: whether the motion found would stay.
//! * [`measured`]: the sensitivity of a loop out of its command while tones are added to it.
//! * [`force`]: the largest steady control force over speeds and clearances, on all cores.
//! * [`map`]: a quantity over a plane of two parameters, its boundary of stability traced by [`contour`].
//! * [`scatter`]: how large the motion gets of machines drawn at random.
//! * [`sweep`]: maps and samples cut into shards, each a pure function of the question and its number.
//! * [`spectrum`]: two-sided power spectral density of an orbit, with its peaks.
//! * [`assess`]: what standards ask of a machine, line by line.
//! * [`table`]: a CSV or Parquet file that is there whole or not at all. [`trajectory`]: a run as one.
//! * [`report`]: every figure and every printed number of the NASA report again, drawn by [`plot`].
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use study::run::{Plan, Settle, run};
//!
//! let rotor = rotor::builtin::rotor("three-mass").ok_or("built in")?;
//! let gains = rotor::builtin::feedback(&rotor, "composite").ok_or("built in")?;
//! // At R = 3 with a clearance of 1 e_t at mass 1, for 500 tau, the first 400 of which are not looked at.
//! let plan = Plan::steady(&rotor, &gains, 3.0, &[1.0], 500.0, Settle::From(400.0))?;
//! let outcome = run(&plan, &mut [], &AtomicBool::new(false))?;
//! assert!(outcome.diverged_at.is_none() && outcome.max_force > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The motion itself is [`rotor`]'s; nothing here knows a command line.

pub mod assess;
pub mod contour;
pub mod csv;
pub mod disturbance;
pub mod force;
mod many;
pub mod map;
pub mod measured;
mod page;
pub mod report;
pub mod run;
pub mod runup;
pub mod scatter;
mod settle;
pub mod spectrum;
pub mod sweep;
pub mod table;
pub mod trajectory;
