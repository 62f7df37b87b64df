//! A gain search as a question: which rotor over which conditions, which structure, what counts, and what is allowed.

use crate::{Family, Measure, Structure};

/// What is searched for: the gains of `structure` that make the worst mode of the worst condition in `family` as good as
/// can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The operating conditions.
    pub family: Family,
    /// What may be searched.
    pub structure: Structure,
    /// What a mode is worth.
    pub measure: Measure,
    /// The largest magnitude of any gain at any speed; above 0.
    pub bound: f64,
    /// The largest steady control force `|u|` under unbalance, linear rotor, at every condition, in `w0^2 e_t`.
    pub force_limit: Option<f64>,
    /// The largest peak of the sensitivity `|S|` over frequencies of both signs, at every condition; above 1.
    pub max_sensitivity: Option<f64>,
    /// The smallest delay margin at every condition, in `tau`; above 0.
    pub min_delay: Option<f64>,
}

/// Why a question makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A rotor that is no chain.
    #[error("the gain search is for chains of masses: this rotor is of shaft elements")]
    Chain,
    /// A bound that leaves no gains.
    #[error("bound = {0}: expected a finite number above 0")]
    Bound(f64),
    /// A limit that leaves no force.
    #[error("force limit = {0}: expected a finite number above 0")]
    Force(f64),
    /// A peak that no loop keeps below.
    #[error("largest sensitivity = {0}: expected a number above 1, which it is where the loop has no gain")]
    Sensitivity(f64),
    /// A margin that is none.
    #[error("smallest delay margin = {0}: expected a finite number above 0")]
    Delay(f64),
    /// Margins of a sampled loop.
    #[error(
        "margins of a sampled loop are not searched for: take the samples out, with half a period more delay in their place"
    )]
    Sampled,
    /// A weight that is not one.
    #[error("mode weight {0}: expected a finite number above 0")]
    Weight(f64),
    /// A structure for another rotor.
    #[error("the feedback is for a rotor of {found} masses, but this one has {masses}")]
    Structure {
        /// Masses of the structure.
        found: usize,
        /// Masses of the rotor.
        masses: usize,
    },
}

impl Problem {
    /// The plain question: damping ratio, all modes alike, gains up to `bound`.
    #[must_use]
    pub fn new(family: Family, structure: Structure, bound: f64) -> Self {
        Self {
            family,
            structure,
            measure: Measure::default(),
            bound,
            force_limit: None,
            max_sensitivity: None,
            min_delay: None,
        }
    }

    /// The delay at a point of the family.
    pub(crate) fn delay(&self, point: &[f64]) -> f64 {
        self.family.delay(point).unwrap_or(self.structure.delay())
    }

    /// Whether margins are asked for.
    pub(crate) fn asks_margins(&self) -> bool {
        self.max_sensitivity.is_some() || self.min_delay.is_some()
    }

    /// Whether the loop is gains alone at every condition, without a delay too.
    #[must_use]
    pub fn is_ideal(&self) -> bool {
        !self.structure.has_loop() && !self.family.has_delay() && self.structure.delay() == 0.0
    }

    /// Checks that there is something to search.
    ///
    /// # Errors
    /// The first part that makes no sense.
    pub fn check(&self) -> Result<(), ProblemError> {
        if !self.family.rotor().is_chain() {
            return Err(ProblemError::Chain);
        }
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.bound) {
            return Err(ProblemError::Bound(self.bound));
        }
        if let Some(limit) = self.force_limit.filter(|&limit| !positive(limit)) {
            return Err(ProblemError::Force(limit));
        }
        if let Some(limit) = self.max_sensitivity.filter(|limit| limit.is_nan() || *limit <= 1.0) {
            return Err(ProblemError::Sensitivity(limit));
        }
        if let Some(least) = self.min_delay.filter(|&least| !positive(least)) {
            return Err(ProblemError::Delay(least));
        }
        if (self.max_sensitivity.is_some() || self.min_delay.is_some()) && self.structure.is_sampled() {
            return Err(ProblemError::Sampled);
        }
        if let Measure::Ratio { forward, backward } = self.measure
            && let Some(weight) = [forward, backward].into_iter().find(|&w| !positive(w))
        {
            return Err(ProblemError::Weight(weight));
        }
        let (found, masses) = (self.structure.masses(), self.family.rotor().len());
        if found == masses { Ok(()) } else { Err(ProblemError::Structure { found, masses }) }
    }
}
