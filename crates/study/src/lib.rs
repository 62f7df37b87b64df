//! Offline work on rotors: what takes a while, uses all cores, or leaves a file behind.
//!
//! * [`run`]: one simulation as fast as it goes, with maxima, means and automatic settling.
//! * [`disturbance`]: whether the motion found would stay.
//! * [`force`]: the largest steady control force over speeds and clearances, on all cores.
//! * [`spectrum`]: two-sided power spectral density of an orbit, with its peaks.
//! * [`table`]: a CSV or Parquet file that is there whole or not at all. [`trajectory`]: a run as one.
//! * [`report`]: every figure and every printed number of the NASA report again, drawn by [`plot`].
//!
//! The motion itself is [`rotor`]'s; nothing here knows a command line.

pub mod csv;
pub mod disturbance;
pub mod force;
mod peak;
pub mod report;
pub mod run;
pub mod runup;
mod settle;
pub mod spectrum;
pub mod table;
pub mod trajectory;
