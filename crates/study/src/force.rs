//! The largest steady control force over spin speed and clearance (Figs. 3.7 and 4.16), by simulation, on all cores.

use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use machine::{ClockOrigin, Machine, ProgramError};
use rotor::{Feedback, Rotor};

use crate::disturbance::{self, DisturbanceGrowth};
use crate::many::{Ended, many};
use crate::run::{self, Extent, Outcome, Plan, RunError, Settle, Settled, run};

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
    pub centre: Option<DisturbanceGrowth>,
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
    let points: Vec<OnceLock<ForcePoint>> = places.iter().map(|_| OnceLock::new()).collect();
    let plan = |k: usize| -> Result<Option<Plan>, ForceError> {
        let (clearances, speed) = places[k];
        let plan = Plan::steady(rotor, feedback, speed, clearances, LONGEST, Settle::DetectAndStop)?;
        if plan.program.steady_loop().is_none() {
            // One by one, with all that is asked of its end.
            let _ = points[k].set(point(&run(&plan, &mut [], stop)?));
            done();
            return Ok(None);
        }
        Ok(Some(plan))
    };
    let take = |k: usize, plan: &Plan, ended: Ended| -> Result<(), ForceError> {
        let _ = points[k].set(ended_point(plan, &ended, stop)?);
        done();
        Ok(())
    };
    many(places.len(), &plan, &take, stop)?;
    let points: Vec<ForcePoint> = points.into_iter().filter_map(OnceLock::into_inner).collect();
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
    Ok(point(&outcome))
}

fn point(outcome: &Outcome) -> ForcePoint {
    let Outcome { max_force, settled, stability, centre, diverged_at, .. } = *outcome;
    ForcePoint { max_force, settled, stability, centre, diverged_at }
}

/// What [`run`] says of a run that was in a batch.
fn ended_point(plan: &Plan, ended: &Ended, stop: &AtomicBool) -> Result<ForcePoint, RunError> {
    let Extent { settled, diverged_at, max_force, .. } = ended.extent;
    let centre = disturbance::of_centre(&plan.program, plan.program.speed())?;
    let mut stability = None;
    if let (Some(last), None) = (&ended.last, diverged_at) {
        let line = ClockOrigin { tau: 0.0, angle: 0.0, steps: last.steps };
        let program = plan.program.clone().paced(last.dtau);
        let motion = [&last.displacement[..], &last.velocity[..]];
        let mut machine = Machine::resumed(program, line, plan.program.speed(), motion, &[]);
        stability = run::stability(&plan.program, &mut machine, settled, last.dtau, stop)?;
    }
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
