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
}

/// Why a question makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A bound that leaves no gains.
    #[error("bound = {0}: expected a finite number above 0")]
    Bound(f64),
    /// A limit that leaves no force.
    #[error("force limit = {0}: expected a finite number above 0")]
    Force(f64),
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
        Self { family, structure, measure: Measure::default(), bound, force_limit: None }
    }

    /// The delay at a point of the family.
    pub(crate) fn delay(&self, point: &[f64]) -> f64 {
        self.family.delay(point).unwrap_or(self.structure.delay())
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
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.bound) {
            return Err(ProblemError::Bound(self.bound));
        }
        if let Some(limit) = self.force_limit.filter(|&limit| !positive(limit)) {
            return Err(ProblemError::Force(limit));
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
