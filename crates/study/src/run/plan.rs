//! What to simulate, and in which steps.

use machine::{Program, ProgramError, default_step};
use rotor::{C64, Feedback, Rotor, Settings};

/// A sudden change of velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Which mass, counted from 0.
    pub mass: usize,
    /// The change, in `e_t` per unit of `tau`.
    pub change: C64,
    /// When, in `tau` from the start.
    pub at: f64,
}

/// From where on maxima and means are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settle {
    /// From this `tau` on.
    From(f64),
    /// From where transients have died, see [`Settled`](super::Settled); the run goes on to its end all the same.
    Detect,
    /// The same, and the run ends there: of a run with impulses, once it has settled after the last of them.
    DetectAndStop,
}

/// What to simulate.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The machine and what it does, compiled for steps of `dtau`.
    pub program: Program,
    /// Displacement and velocity of every place where it begins; `None` is rest.
    pub start: Option<[Vec<C64>; 2]>,
    /// Impulses, in any order; those after the end are never felt.
    pub impulses: Vec<Impulse>,
    /// The longest step, no longer than the program's. Steps are even between impulses, so a little shorter where they would not fit.
    pub dtau: f64,
    /// Length of the run in `tau`.
    pub duration: f64,
    /// From where on maxima are taken.
    pub settle: Settle,
}

impl Plan {
    /// `rotor` under `feedback` at a steady speed, with one clearance a mass (missing ones count as none), for `duration`
    /// without impulses, in steps that are accurate.
    ///
    /// # Errors
    /// Feedback that does not fit, or modes that cannot be found.
    pub fn steady(
        rotor: &Rotor,
        feedback: &Feedback,
        speed: f64,
        clearances: &[f64],
        duration: f64,
        settle: Settle,
    ) -> Result<Self, ProgramError> {
        let mut settings = Settings::new(rotor, speed, feedback.clone());
        let given = clearances.iter().copied().chain(std::iter::repeat(0.0));
        settings.deadband.iter_mut().zip(given).for_each(|(place, clearance)| *place = clearance);
        let dtau = default_step(rotor, &settings)?;
        let program = Program::in_substeps(rotor, &settings, dtau, 1)?;
        Ok(Self { program, start: None, impulses: Vec::new(), dtau, duration, settle })
    }

    /// How many even steps of at most [`Plan::dtau`] make up a stretch of time, and how long each is.
    pub(crate) fn even_steps(&self, stretch: f64) -> (f64, f64) {
        let count = (stretch / self.dtau - 1e-9).ceil().max(1.0);
        (count, stretch / count)
    }

    /// The longest step that is taken: [`Plan::dtau`], or a little less where that does not fit.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        let mut ends: Vec<f64> =
            self.impulses.iter().map(|i| i.at).filter(|at| (0.0..self.duration).contains(at)).collect();
        ends.push(self.duration);
        ends.sort_by(f64::total_cmp);
        let mut from = 0.0;
        let mut longest = 0.0_f64;
        for end in ends {
            if end > from {
                longest = longest.max(self.even_steps(end - from).1);
            }
            from = end;
        }
        longest
    }
}
