//! A gain search as a question: which rotor over which conditions, which structure, what counts, and what is allowed.

use machine::CountedModes;
use rotor::{C64, Characteristic, LinearForm};

use crate::measure::Aspect;
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
    /// The smallest delay margin at every condition, in `tau`; above 0. Of several bearings it is of one delay in all their commands.
    pub min_delay: Option<f64>,
    /// Modes with `|lambda|` above this, in radians per `tau`, are to decay, but their damping does not count; above 0. See
    /// [`Problem::default_below`].
    pub below: Option<f64>,
}

/// Modes past [`Problem::below`] are worth so much more the further up they are, ...
const PAST: i32 = 32;
/// ... up to so many times: a mode turns unstable at worth 0 everywhere, and nothing jumps in between.
const MOST_WORTH: f64 = 1e3;

/// Why a question makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A frequency that leaves no modes, or is given for a chain.
    #[error("modes count up to {0}: expected a finite number above 0, for a rotor of shaft elements")]
    Below(f64),
    /// A bound that leaves no gains.
    #[error("bound = {0}: expected a finite number above 0")]
    Bound(f64),
    /// A corner that cannot move.
    #[error("{name} = {from}..{to}: expected a range above 0, its end above its beginning")]
    Corner {
        /// What it is called.
        name: String,
        /// Where its range begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A corner that is to follow the speed.
    #[error("{0}: corners of filters are the same at every speed: they cannot follow it")]
    Followed(String),
    /// A cost of a loop that is more than gains.
    #[error(
        "the cost of unbalance and noise is of gains alone at one bearing of a chain, without filters, lags, samples or delay"
    )]
    CostOfLoop,
    /// Margins beside a cost.
    #[error("margins are not limited where the cost of unbalance and noise is made small: leave one of the two out")]
    CostAndMargins,
    /// A part of the cost that makes no sense.
    #[error("cost: {0} = {1}: expected a finite number {2}")]
    Cost(&'static str, f64, &'static str),
    /// A limit that leaves no force.
    #[error("force limit = {0}: expected a finite number above 0")]
    Force(f64),
    /// A region that no stable machine need be in.
    #[error("pole region: expected a damping ratio or a decay rate: a frequency alone says nothing of stability")]
    NoRegion,
    /// An edge of a region that is none.
    #[error("pole region: {0} = {1}: expected {2}")]
    Region(&'static str, f64, &'static str),
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
    /// The plain question: damping ratio, all modes alike up to [`Self::default_below`], gains up to `bound`.
    #[must_use]
    pub fn new(family: Family, structure: Structure, bound: f64) -> Self {
        let below = Self::default_below(&family, &structure);
        Self {
            below,
            family,
            structure,
            measure: Measure::default(),
            bound,
            force_limit: None,
            max_sensitivity: None,
            min_delay: None,
        }
    }

    /// The largest magnitude of each variable: of gains the bound, of corners what their range leaves.
    pub(crate) fn reach(&self) -> Vec<f64> {
        self.structure.reach(self.bound)
    }

    /// The delay at a point of the family.
    pub(crate) fn delay(&self, point: &[f64]) -> f64 {
        self.family.delay(point).unwrap_or(self.structure.delay())
    }

    /// Whether margins are asked for.
    pub(crate) fn asks_margins(&self) -> bool {
        self.max_sensitivity.is_some() || self.min_delay.is_some()
    }

    /// Up to where modes count by default: all of them for a chain; for a rotor of shaft elements, whose highest modes no gain moves,
    /// up to four times the top speed and so far that four forward modes of the template's loop count.
    #[must_use]
    pub fn default_below(family: &Family, structure: &Structure) -> Option<f64> {
        if structure.is_chain() {
            return None;
        }
        let top = family.speeds().1;
        let point: Vec<f64> = (0..family.axes().len()).map(|axis| family.ends(axis)[1]).collect();
        let poles = || {
            let form =
                LinearForm::of(&family.plant(&point), &structure.feedback(&structure.own()), &family.operating(&point));
            Characteristic::of(&form.ok()?).ok()?.roots().ok()
        };
        CountedModes::usual_among(poles().unwrap_or_default().iter().map(|root| root.pole), top).below()
    }

    /// How many points a scan of about `total` has: with shaft elements each takes a hundred times as long, and less happens from one
    /// speed to the next.
    pub(crate) fn points(&self, total: usize) -> usize {
        if self.structure.is_chain() { total } else { (total / 5).max(2) }
    }

    /// What a pole that decays is worth, in times of its measure, and how that grows with its size.
    fn weight(&self, pole: C64) -> [f64; 2] {
        let Some(below) = self.below.filter(|below| pole.norm() > *below) else { return [1.0, 0.0] };
        let part = pole.norm() / below;
        let weight = part.powi(PAST);
        if weight < MOST_WORTH { [weight, f64::from(PAST) * weight / pole.norm()] } else { [MOST_WORTH, 0.0] }
    }

    /// The worth of a pole: positive if it decays.
    pub(crate) fn worth(&self, pole: C64) -> f64 {
        self.measure.aspects().map(|aspect| self.worth_of(aspect, pole)).fold(f64::INFINITY, f64::min)
    }

    /// The worth of one aspect of a pole.
    pub(crate) fn worth_of(&self, aspect: Aspect, pole: C64) -> f64 {
        let value = self.measure.part(aspect, pole);
        if value > 0.0 { value * self.weight(pole)[0] } else { value }
    }

    /// What that changes by when the pole moves by `(dre, dim)`: the two derivatives.
    pub(crate) fn worth_slope(&self, aspect: Aspect, pole: C64) -> [f64; 2] {
        let (value, slope) = (self.measure.part(aspect, pole), self.measure.slope(aspect, pole));
        let [weight, grows] = self.weight(pole);
        if value <= 0.0 || grows == 0.0 && weight == 1.0 {
            return slope;
        }
        let size = pole.norm();
        [slope[0] * weight + value * grows * pole.re / size, slope[1] * weight + value * grows * pole.im / size]
    }

    /// The worst of `poles`: what it is worth, and which it is; infinite if there are none.
    pub(crate) fn worst(&self, poles: &[C64]) -> (f64, C64) {
        let each = poles.iter().map(|&pole| (self.worth(pole), pole));
        each.fold((f64::INFINITY, C64::ZERO), |worst, this| if this.0 < worst.0 { this } else { worst })
    }

    /// Whether the loop is gains alone at every condition, at one bearing of a chain, without a delay too.
    #[must_use]
    pub fn is_ideal(&self) -> bool {
        self.structure.is_plain() && !self.family.has_delay() && self.structure.delay() == 0.0
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
        if let Some(corner) = self.structure.corners().iter().find(|corner| !corner.is_sound()) {
            let (name, from, to) = (corner.name.clone(), corner.from, corner.to);
            return Err(ProblemError::Corner { name, from, to });
        }
        if let Some(below) = self.below.filter(|&below| !positive(below) || self.family.rotor().is_chain()) {
            return Err(ProblemError::Below(below));
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
        self.check_measure()?;
        let (found, masses) = (self.structure.masses(), self.family.rotor().len());
        if found == masses { Ok(()) } else { Err(ProblemError::Structure { found, masses }) }
    }

    fn check_measure(&self) -> Result<(), ProblemError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        match self.measure {
            Measure::Decay => Ok(()),
            Measure::Ratio { forward, backward } => match [forward, backward].into_iter().find(|&w| !positive(w)) {
                Some(weight) => Err(ProblemError::Weight(weight)),
                None => Ok(()),
            },
            Measure::Region(region) => {
                if region.damping.is_none() && region.decay.is_none() {
                    return Err(ProblemError::NoRegion);
                }
                if let Some(damping) = region.damping.filter(|d| !(positive(*d) && *d < 1.0)) {
                    return Err(ProblemError::Region("damping", damping, "a damping ratio above 0 and below 1"));
                }
                for (name, value) in [("decay", region.decay), ("frequency", region.frequency)] {
                    if let Some(value) = value.filter(|&value| !positive(value)) {
                        return Err(ProblemError::Region(name, value, "a finite number above 0"));
                    }
                }
                Ok(())
            }
            Measure::Cost(cost) => {
                if !self.is_ideal() {
                    return Err(ProblemError::CostOfLoop);
                }
                if self.asks_margins() {
                    return Err(ProblemError::CostAndMargins);
                }
                if !(cost.force.is_finite() && cost.force >= 0.0) {
                    return Err(ProblemError::Cost("force", cost.force, "of at least 0"));
                }
                match [("noise", cost.noise), ("corner", cost.corner)].into_iter().find(|(_, value)| !positive(*value))
                {
                    Some((name, value)) => Err(ProblemError::Cost(name, value, "above 0")),
                    None => Ok(()),
                }
            }
        }
    }
}
