//! What comes out of a run.

use rotor::C64;

use crate::disturbance::DisturbanceGrowth;
use crate::settle::{Settled, Stretch};

/// Where the rotor is when a run ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Final {
    /// Dimensionless time.
    pub tau: f64,
    /// Spin speed `R`.
    pub speed: f64,
    /// Displacement of every mass, in `e_t`.
    pub displacement: Vec<C64>,
    /// Velocity of every mass, in `e_t` per unit of `tau`.
    pub velocity: Vec<C64>,
}

/// What came out. Every number in it is finite, but for the final state of a run that overflowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Steps taken.
    pub steps: u64,
    /// At how many of them the actuator was at its limit of force or of rate.
    pub saturated_steps: u64,
    /// When the orbit left all bounds; the run ends there.
    pub diverged_at: Option<f64>,
    /// The longest and the shortest of the steps taken: they are even between impulses. Zero without any.
    pub step: (f64, f64),
    /// Whether transients had died.
    pub settled: Settled,
    /// Whether the motion at the end would stay, if it is steady: settled, or on a circular orbit.
    pub stability: Option<DisturbanceGrowth>,
    /// Whether the rotor at rest in its centre would stay, support bearings with clearance out of action; `None` where amplifiers differ along
    /// the axes.
    pub centre: Option<DisturbanceGrowth>,
    /// From where on maxima and means are taken. If nothing settled, from the middle of the run.
    pub maxima_from: f64,
    /// Largest `|u|`, in `w0^2 e_t`; of several control bearings as that of the first ([`rotor::ControlMasses`]).
    pub max_force: f64,
    /// The larger of the largest `|u_y|` and `|u_z|`.
    pub max_force_component: f64,
    /// Largest radius of every mass, in `e_t`.
    pub max_displacement: Vec<f64>,
    /// Mean radius of every mass, in `e_t`.
    pub mean_radius: Vec<f64>,
    /// The last state.
    pub last: Final,
}

/// How large a motion gets: what a map has of a run, without asking whether it would stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Whether transients had died.
    pub settled: Settled,
    /// When the orbit left all bounds.
    pub diverged_at: Option<f64>,
    /// Largest `|u|`, in `w0^2 e_t`.
    pub max_force: f64,
    /// Largest radius of any mass, in `e_t`.
    pub max_displacement: f64,
}

impl Extent {
    pub(crate) fn of(settled: Settled, diverged_at: Option<f64>, kept: &Stretch, masses: usize) -> Self {
        Self {
            settled,
            diverged_at,
            max_force: kept.maxima[0].sqrt(),
            max_displacement: kept.maxima[3..3 + masses].iter().copied().fold(0.0, f64::max).sqrt(),
        }
    }
}
