//! Why and where a machine has tripped: stopped by itself, or begun to coast down.

/// Why a machine has tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum TripCause {
    /// An orbit grew past the limit.
    Orbit = 1,
    /// The motion left the range of numbers: the last that was finite is kept.
    NotFinite = 2,
    /// No command came from the controller outside for too many samples.
    NoCommand = 3,
    /// An orbit grew past the limit, and the machine is not held: its drive is off, the speed coasts down, and the motion goes on.
    CoastDown = 4,
}

impl TripCause {
    /// The cause of this number; none that is not known.
    pub(crate) fn of(number: u64) -> Option<Self> {
        [Self::Orbit, Self::NotFinite, Self::NoCommand, Self::CoastDown]
            .into_iter()
            .find(|cause| *cause as u64 == number)
    }
}

/// A machine that has tripped.
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
