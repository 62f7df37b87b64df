//! Why and where a machine has stopped by itself.

/// Why a machine has stopped by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum TripCause {
    /// An orbit grew past the limit.
    Orbit = 1,
    /// The motion left the range of numbers: the last that was finite is kept.
    NotFinite = 2,
}

/// A machine that has stopped by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trip {
    /// Why.
    pub cause: TripCause,
    /// The station that was farthest out, counted from 0.
    pub station: usize,
    /// How far, in `e_t`.
    pub radius: f64,
    /// The limit then in force, in `e_t`.
    pub limit: f64,
}
