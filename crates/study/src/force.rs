//! The largest steady control force over spin speed and clearance (Figs. 3.7 and 4.16), by simulation, on all cores.

use std::sync::atomic::AtomicBool;

use machine::ProgramError;
use rayon::prelude::*;
use rotor::{Feedback, Rotor};

use crate::disturbance::DisturbanceGrowth;
use crate::run::{Outcome, Plan, RunError, Settle, Settled, run};

/// A point that has not settled by then, in `tau`, is given up and says so.
pub const LONGEST: f64 = 2_000.0;

/// One point of the sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcePoint {
    /// Largest `|u|` once transients have died, in `w0^2 e_t`; what was reached if they have not, or if it diverged.
    pub max_force: f64,
    /// How the motion came to rest.
    pub settled: Settled,
    /// Whether the motion would stay, if it is steady.
    pub stability: Option<DisturbanceGrowth>,
    /// Whether the rotor at rest in its centre would stay, support bearings with clearance out of action.
    pub centre: DisturbanceGrowth,
    /// When it left all bounds, if it did: there is no steady force then.
    pub diverged_at: Option<f64>,
}

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
pub enum ForceError {
    /// The machine cannot be stepped, or the modes that set the step could not be found.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// The sweep: `[clearances][speed]`, each run from rest; of each set of clearances one of every support bearing, in `e_t`.
///
/// The steady motion is the one reached from rest: where several are stable, others exist. `done` is called after
/// every point, from any thread.
///
/// # Errors
/// Eigenvalues that do not converge, or `stop`.
pub fn sweep(
    rotor: &Rotor,
    feedback: &Feedback,
    speeds: &[f64],
    clearances: &[Vec<f64>],
    stop: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Vec<ForcePoint>>, ForceError> {
    let places: Vec<(&[f64], f64)> =
        clearances.iter().flat_map(|of_all| speeds.iter().map(move |&speed| (of_all.as_slice(), speed))).collect();
    // One point a task: their lengths differ by a hundred.
    let points = places
        .par_iter()
        .with_max_len(1)
        .map(|&(clearances, speed)| {
            let point = steady(rotor, feedback, speed, clearances, stop);
            done();
            point
        })
        .collect::<Result<Vec<ForcePoint>, ForceError>>()?;
    Ok(if speeds.is_empty() {
        vec![Vec::new(); clearances.len()]
    } else {
        points.chunks(speeds.len()).map(<[ForcePoint]>::to_vec).collect()
    })
}

/// The steady force at one speed and with one clearance of every support bearing.
///
/// # Errors
/// As for [`sweep`].
pub fn steady(
    rotor: &Rotor,
    feedback: &Feedback,
    speed: f64,
    clearances: &[f64],
    stop: &AtomicBool,
) -> Result<ForcePoint, ForceError> {
    let outcome = until_settled(rotor, feedback, speed, clearances, LONGEST, stop)?;
    let Outcome { max_force, settled, stability, centre, diverged_at, .. } = outcome;
    Ok(ForcePoint { max_force, settled, stability, centre, diverged_at })
}

/// The whole outcome of a run from rest at one speed and with one clearance of every support bearing, until transients have died or `longest` in `tau`.
///
/// # Errors
/// As for [`sweep`].
pub fn until_settled(
    rotor: &Rotor,
    feedback: &Feedback,
    speed: f64,
    clearances: &[f64],
    longest: f64,
    stop: &AtomicBool,
) -> Result<Outcome, ForceError> {
    let plan = Plan::steady(rotor, feedback, speed, clearances, longest, Settle::DetectAndStop)?;
    Ok(run(&plan, &mut [], stop)?)
}
