//! One simulation from rest, offline, as fast as it goes.

mod books;
mod outcome;
mod plan;

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{Machine, PolesError, Program};
use rotor::PoleError;

use crate::disturbance::{self, DisturbanceGrowth};
use books::Books;

pub use crate::settle::Settled;
pub(crate) use books::{kept, orbit_limit, window_of};
pub use outcome::{Extent, Final, Outcome};
pub use plan::{Impulse, Plan, Settle};

/// More steps than this are refused: a quarter of an hour of computing.
pub const MOST_STEPS: f64 = 1e10;

/// Looks at every sample of a run: at the start, after every step, and before and after every impulse.
pub trait Observer {
    /// One sample: the machine as it is.
    ///
    /// # Errors
    /// Whatever keeps it from going on; the run ends there.
    fn sample(&mut self, machine: &Machine) -> std::io::Result<()>;

    /// An impulse comes, of which the next sample is the first to show. After the last of several at once there is one sample.
    ///
    /// # Errors
    /// As [`Observer::sample`].
    fn impulse(&mut self, _: &Impulse) -> std::io::Result<()> {
        Ok(())
    }

    /// A stretch of even steps begins, of [`Machine::dtau`] each.
    ///
    /// # Errors
    /// As [`Observer::sample`].
    fn stretch(&mut self, _: &Machine) -> std::io::Result<()> {
        Ok(())
    }
}

/// Why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// It would take too long.
    #[error("{0:.1e} steps are too many: at most {MOST_STEPS:.0e}")]
    TooLong(f64),
    /// An observer failed.
    #[error(transparent)]
    Observer(#[from] std::io::Error),
    /// The eigenvalues that tell stability could not be found.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// The poles of a loop with states of its own could not be found.
    #[error(transparent)]
    LoopPoles(#[from] PolesError),
}

/// Simulates `plan` from its start, showing every sample to `observers`. `stop` is looked at now and then.
///
/// # Errors
/// A plan of too many steps, an observer that fails, eigenvalues that do not converge, or `stop`.
pub fn run(plan: &Plan, observers: &mut [&mut dyn Observer], stop: &AtomicBool) -> Result<Outcome, RunError> {
    let (mut rotor, books) = simulate(plan, observers, stop)?;
    let centre = disturbance::of_centre(&plan.program, rotor.sample().speed)?;
    let mut outcome = books.outcome(&rotor, centre);
    if outcome.diverged_at.is_none() {
        outcome.stability = stability(&plan.program, &mut rotor, outcome.settled, outcome.step.0, stop)?;
    }
    Ok(outcome)
}

/// Whether the motion that a run has ended in would stay, if it is steady.
pub(crate) fn stability(
    program: &Program,
    rotor: &mut Machine,
    settled: Settled,
    dtau: f64,
    stop: &AtomicBool,
) -> Result<Option<DisturbanceGrowth>, RunError> {
    if !rotor.motion().is_finite() {
        return Ok(None);
    }
    let on_circle = disturbance::of_orbit(program, rotor)?;
    if on_circle.is_some() || !matches!(settled, Settled::Steady | Settled::Beating) {
        return Ok(on_circle);
    }
    Ok(Some(disturbance::of_beat(rotor, dtau, stop).ok_or(RunError::Interrupted)?))
}

/// Simulates `plan` from its start, and says how large its motion is.
///
/// # Errors
/// A plan of too many steps, or `stop`.
pub fn extent(plan: &Plan, stop: &AtomicBool) -> Result<Extent, RunError> {
    let (_, books) = simulate(plan, &mut [], stop)?;
    let (diverged_at, masses) = (books.diverged_at, books.masses);
    let (settled, kept) = books.kept();
    Ok(Extent::of(settled, diverged_at, &kept, masses))
}

/// When `plan`, without impulses, has settled, in `tau`; its end if it has not by then, and `None` if it leaves all bounds.
///
/// # Errors
/// As for [`extent`].
pub(crate) fn settled_at(plan: &Plan, stop: &AtomicBool) -> Result<Option<f64>, RunError> {
    let (machine, books) = simulate(plan, &mut [], stop)?;
    Ok(books.diverged_at.is_none().then(|| machine.motion().tau))
}

fn simulate(plan: &Plan, observers: &mut [&mut dyn Observer], stop: &AtomicBool) -> Result<(Machine, Books), RunError> {
    let steps = plan.duration / plan.dtau;
    if steps.is_nan() || steps > MOST_STEPS {
        return Err(RunError::TooLong(steps));
    }
    let mut rotor = Machine::new(plan.program.clone());
    if let Some([displacement, velocity]) = &plan.start {
        rotor.place(displacement, velocity);
    }
    let mut books = Books::new(plan);
    let mut impulses: Vec<Impulse> = plan.impulses.iter().copied().filter(|i| i.at <= plan.duration).collect();
    impulses.sort_by(|a, b| a.at.total_cmp(&b.at));
    let mut impulses = impulses.into_iter().peekable();

    while let Some(impulse) = impulses.next_if(|i| i.at <= 0.0) {
        observers.iter_mut().try_for_each(|observer| observer.impulse(&impulse))?;
        rotor.kick(impulse.mass, impulse.change);
    }
    let mut going = books.see(&rotor, observers)?;
    let mut now = 0.0;
    while going && now < plan.duration {
        let until = impulses.peek().map_or(plan.duration, |i| i.at);
        let (count, dtau) = plan.even_steps(until - now);
        books.step = if books.steps == 0 { (dtau, dtau) } else { (books.step.0.max(dtau), books.step.1.min(dtau)) };
        books.peaks.break_off();
        rotor.pace(dtau);
        observers.iter_mut().try_for_each(|observer| observer.stretch(&rotor))?;
        for i in 0..count as u64 {
            if i % 4096 == 0 && stop.load(Ordering::Relaxed) {
                return Err(RunError::Interrupted);
            }
            rotor.step_by(dtau);
            books.steps += 1;
            going = books.see(&rotor, observers)?;
            if !going {
                break;
            }
        }
        now = until;
        let mut kicked = false;
        while let Some(impulse) = impulses.next_if(|i| going && i.at <= now) {
            observers.iter_mut().try_for_each(|observer| observer.impulse(&impulse))?;
            rotor.kick(impulse.mass, impulse.change);
            kicked = true;
        }
        if kicked {
            books.peaks.break_off();
            going = books.see(&rotor, observers)?;
        }
    }
    Ok((rotor, books))
}
