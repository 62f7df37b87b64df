//! Circular whirl, exactly: `p_k = c_k exp(j w tau)` with every `|c_k|` constant.
//!
//! On such an orbit each support bearing with deadband acts through one constant factor `s(|c_k|)` (3.2)-(3.4), so the
//! equations of motion become algebraic without any approximation:
//!
//! ```text
//! Z(w, R) c + diag(b_k s(|c_k|)) c = Re R^2        b_k = Rb_k / Rm_k
//! ```
//!
//! with `Z` the dynamic stiffness of everything linear. Two questions are answered with it: the *synchronous response*
//! under unbalance, `w = R` ([`synchronous`]), and *self-excited limit cycles* without unbalance, where `w` is unknown
//! and the right-hand side zero ([`cycles`]). Several orbits can exist at one speed: all are sought at every speed
//! asked for, and each is followed through folds and through the edges of the clearances by pseudo-arclength
//! continuation. Motion that is not circular is not found here: integrate it with a [`crate::Stepper`].
//!
//! A loop that is more than gains (lags, filters, a delay) answers a whirl as one complex number per sensor, so it is in `Z`
//! exactly, and stability counts everything that it holds. What cannot be so: samples, whose hold leaves a ripple on every
//! orbit, are refused ([`CircularError::Sampled`]); of an actuator with limits those orbits are given on which it is below
//! them, and others may exist beyond; noise and resolution of the sensors are left out.
//!
//! How complete the search is ([`Circular::complete`] says so speed by speed):
//!
//! * Orbits that press on few bearings with clearance at a time are roots of polynomials, all of which are computed:
//!   [`ENUMERATED_FORCED`] bearings under unbalance, [`ENUMERATED_FREE`] without. Cycles on two are zeros of a function of the
//!   frequency, which is scanned.
//! * Under unbalance a rotor damped well enough has one orbit, whatever presses: a contraction proves it.
//! * All others come from a search: homotopy from the free and from the tight rotor, Newton's method from many starts,
//!   continuation over speed. It is thorough, but no proof: a branch that hangs on nothing else may be missed.

mod around;
mod continuation;
mod cycle;
mod enumerated;
mod homotopy;
mod judge;
mod newton;
mod orbit;
mod problem;
mod response;
mod stability;
mod steady;
mod tracer;
mod whirl_equation;

use linear::DelayError;

use crate::{Feedback, FeedbackError, PoleError, Rotor};

pub use continuation::Curve;
pub use orbit::Orbit;
pub use steady::{centre, orbit_of};
pub use tracer::End;

/// Every synchronous orbit that presses on at most this many bearings with clearance at a time is found.
pub const ENUMERATED_FORCED: usize = 2;
/// Every limit cycle that presses on at most this many is found.
pub const ENUMERATED_FREE: usize = 1;

/// Circular orbits over a range of speeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Circular {
    /// The speeds asked for, as given.
    pub speeds: Vec<f64>,
    /// For each speed every orbit found there: smallest first, by the largest radius of any mass.
    pub orbits: Vec<Vec<Orbit>>,
    /// The same orbits as curves over speed and amplitude, each followed from one end to the other.
    pub curves: Vec<Curve>,
    /// For each speed whether it is proven, but for rounding, that there are no others than those in `orbits`.
    pub complete: Vec<bool>,
    /// For each speed how many orbits of the loop without its limits are not in `orbits`, because they ask for more than the
    /// actuator delivers.
    pub beyond_limits: Vec<usize>,
}

/// Why there are no circular orbits.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CircularError {
    /// Feedback that does not fit.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
    /// Eigenvalues that cannot be had.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// Roots of a loop that cannot be had.
    #[error(transparent)]
    Roots(#[from] DelayError),
    /// A sampled loop.
    #[error(
        "no orbit of a sampled loop is a circle: its hold leaves a ripple. Take the samples out with sample=off, half a period \
         more delay in their place, or simulate with `run`"
    )]
    Sampled,
    /// An orbit that was not judged, because too many others could not be.
    #[error("not tried, for too many orbits before it could not be judged: {0}")]
    NotTried(DelayError),
    /// Asked to stop.
    #[error("stopped")]
    Stopped,
}

/// The synchronous response `p = c exp(j R tau)` under the rotor's unbalance at every one of `speeds`, all branches.
///
/// `deadband` holds one clearance a mass, in `e_t`, missing ones count
/// as zero. `speeds` are spin speeds `R`, finite and at least 0. Where nothing drives the rotor (no unbalance, or
/// `R = 0`) the one orbit listed is the centre. A resonance without damping has no circular solution: the list is empty there.
///
/// # Errors
/// A sampled loop, and feedback that does not fit. An orbit whose stability cannot be had says so itself ([`Orbit::growth`]).
pub fn synchronous(
    rotor: &Rotor,
    feedback: &Feedback,
    deadband: &[f64],
    speeds: &[f64],
) -> Result<Circular, CircularError> {
    let problem = problem::Problem::new(rotor, feedback, deadband, true)?;
    continuation::all(&problem, speeds, false, &|| false)
}

/// The orbits of [`synchronous`] alone: no curves where all orbits are known speed by speed, which spares most of the time. Once `stop` says
/// so it ends with [`CircularError::Stopped`].
///
/// # Errors
/// As for [`synchronous`], or `stop`.
pub fn synchronous_orbits(
    rotor: &Rotor,
    feedback: &Feedback,
    deadband: &[f64],
    speeds: &[f64],
    stop: &dyn Fn() -> bool,
) -> Result<Circular, CircularError> {
    let problem = problem::Problem::new(rotor, feedback, deadband, true)?;
    continuation::all(&problem, speeds, true, stop)
}

/// Self-excited circular limit cycles `p = c exp(j w tau)` of the balanced rotor at every one of `speeds`, all branches.
///
/// The unbalance is left out; the phase, which is free, is chosen so that the largest amplitude is real and positive.
/// Without any deadband the rotor is linear and has none. Equilibria off centre (`w = 0`) are not cycles and not listed.
///
/// # Errors
/// As for [`synchronous`].
pub fn cycles(rotor: &Rotor, feedback: &Feedback, deadband: &[f64], speeds: &[f64]) -> Result<Circular, CircularError> {
    let problem = problem::Problem::new(rotor, feedback, deadband, false)?;
    continuation::all(&problem, speeds, false, &|| false)
}
