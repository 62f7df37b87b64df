//! What is asked of circular whirl: a rotor and its loop, which of its places are unknowns, and along what branches are followed.

use std::cell::Cell;
use std::rc::Rc;

use nalgebra::DVector;

use super::CircularError;
use super::around::Around;
use super::whirl_equation::Equation;
use crate::{C64, ClosedLoop, ControlBearing, ControlMasses, Feedback, Plant, Rotor};

/// Which masses press on their support bearing: bit `k` for mass `k`.
pub(super) type Contact = u32;

/// What the last unknown is, along which a branch is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Along {
    /// The spin speed.
    Speed,
    /// The logarithm of a factor on the unbalance, at this spin speed.
    Load { speed: f64 },
    /// The rate at which whirl grows, at this spin speed.
    Growth { speed: f64 },
}

/// A rotor whose circular orbits are sought.
pub(super) struct Problem<'a> {
    along: Along,
    /// The equation at the one speed of a branch that is not followed over speed.
    fixed: Option<Equation>,
    rotor: &'a Rotor,
    /// Gains alone; off where the loop is more than that.
    feedback: std::borrow::Cow<'a, Feedback>,
    /// The plant, and a loop that is more than gains.
    around: Option<(Rc<Plant>, &'a Feedback)>,
    /// See [`Around::new`].
    uncounted: Rc<Cell<bool>>,
    /// Of each unknown.
    deadband: Vec<f64>,
    /// The clearances of all places, of which the unknowns are some.
    clearances: Vec<f64>,
    /// The places whose amplitudes are the unknowns: all masses of a chain; of shaft elements those with play alone.
    places: Rc<[usize]>,
    /// Synchronous under unbalance; otherwise self-excited without.
    pub forced: bool,
    /// Unknowns whose bearing has both stiffness and clearance.
    pub gapped: Contact,
    /// How many amplitudes are unknown.
    pub masses: usize,
}

impl<'a> Problem<'a> {
    /// # Errors
    /// Feedback that does not fit, or samples.
    pub(super) fn new(
        rotor: &'a Rotor,
        feedback: &'a Feedback,
        deadband: &[f64],
        forced: bool,
    ) -> Result<Self, CircularError> {
        feedback.check(rotor.len())?;
        if feedback.sample() > 0.0 {
            return Err(CircularError::Sampled);
        }
        let around = (!ClosedLoop::describes(rotor, feedback)).then(|| (Rc::new(Plant::of(rotor)), feedback));
        if let Some((plant, feedback)) = &around {
            // What has no complex form has no circular whirl.
            Around::new(plant, feedback, 0.0, &Rc::default())?;
        }
        let gains = if around.is_some() {
            let first = feedback.first();
            std::borrow::Cow::Owned(Feedback::new(first.station, first.off().signals))
        } else {
            std::borrow::Cow::Borrowed(feedback)
        };
        let clearances: Vec<f64> = (0..rotor.len()).map(|k| deadband.get(k).copied().unwrap_or(0.0)).collect();
        let has_play = |place: &usize| rotor.has_contact(*place) && clearances[*place] > 0.0;
        let mut places: Vec<usize> = (0..rotor.len()).filter(|place| rotor.is_chain() || has_play(place)).collect();
        if places.is_empty() {
            places.push(0);
        }
        let gapped = places.iter().enumerate().filter(|(_, place)| has_play(place)).fold(0, |set, (k, _)| set | 1 << k);
        let (masses, deadband) = (places.len(), places.iter().map(|place| clearances[*place]).collect());
        let places = places.into();
        let along = Along::Speed;
        Ok(Self {
            along,
            fixed: None,
            rotor,
            feedback: gains,
            around,
            uncounted: Rc::default(),
            deadband,
            clearances,
            places,
            forced,
            gapped,
            masses,
        })
    }

    /// A set of unknowns in contact as one of places.
    pub(super) fn places_in(&self, contact: Contact) -> Contact {
        self.contacts(contact).fold(0, |set, k| set | 1 << self.places[k])
    }

    /// The same rotor, to be followed along something else than speed.
    pub(super) fn along(&self, along: Along) -> Self {
        let fixed = match along {
            Along::Speed => None,
            Along::Load { speed } | Along::Growth { speed } => Some(self.at(speed)),
        };
        let (feedback, around) = (self.feedback.clone(), self.around.clone());
        let (deadband, clearances, places) = (self.deadband.clone(), self.clearances.clone(), self.places.clone());
        let uncounted = self.uncounted.clone();
        Self { along, fixed, feedback, around, uncounted, deadband, clearances, places, ..*self }
    }

    /// The frequency that is given: that of the spin under unbalance, unless the spin is unknown itself.
    pub(super) fn frequency(&self, last: f64) -> f64 {
        match self.along {
            Along::Load { speed } | Along::Growth { speed } => speed,
            Along::Speed => last,
        }
    }

    /// The derivative of the residual by the last unknown.
    pub(super) fn by_last(
        &self,
        equation: &Equation,
        c: &DVector<C64>,
        frequency: f64,
        last: f64,
        contact: Contact,
    ) -> DVector<C64> {
        match self.along {
            Along::Load { .. } => -equation.forcing(frequency),
            Along::Growth { .. } => equation.by_growth(c, frequency),
            Along::Speed => {
                // Gains may be any function of speed, so this one derivative is a difference.
                let h = 1e-6 * last.abs().max(1.0);
                let at = |s: f64| self.at(s).residual(c, if self.forced { s } else { frequency }, contact);
                (at(last + h) - at(last - h)) / C64::from(2.0 * h)
            }
        }
    }

    /// The equation at a value of the last unknown: a spin speed, unless the branch is followed along something else.
    pub(super) fn at(&self, speed: f64) -> Equation {
        if let Some(fixed) = &self.fixed {
            return match self.along {
                Along::Load { .. } => fixed.loaded(speed.exp()),
                Along::Growth { .. } | Along::Speed => fixed.growing(speed),
            };
        }
        let gains = match self.rotor.beam() {
            Some(beam) => Equation::of_beam(beam, speed, &self.clearances, &self.places, self.forced),
            None => Equation::of(&ClosedLoop::new(self.rotor, &self.feedback, speed, &self.clearances), self.forced),
        };
        // Feedback that fits at one speed fits at all.
        let around = self
            .around
            .as_ref()
            .and_then(|(plant, feedback)| Around::new(plant, feedback, speed, &self.uncounted).ok());
        gains.with(around)
    }

    /// What turns the control of each bearing into a force.
    pub(super) fn control_masses(&self) -> ControlMasses {
        let feedback = self.around.as_ref().map_or(&*self.feedback, |(_, feedback)| *feedback);
        ControlMasses::of(self.rotor, feedback)
    }

    /// Whether the loop has a limit of force or of its rate beyond which no orbit is sought.
    pub(super) fn is_limited(&self) -> bool {
        let is_limited = |bearing: &ControlBearing| bearing.parts.limit.min(bearing.parts.slew).is_finite();
        self.around.as_ref().is_some_and(|(_, feedback)| feedback.bearings.iter().any(is_limited))
    }

    /// Whether the actuators can deliver the forces of a whirl, one a control bearing, and as fast as that turns.
    pub(super) fn delivers(&self, forces: &[f64], frequency: f64) -> bool {
        self.around.as_ref().is_none_or(|(_, feedback)| {
            feedback.bearings.iter().zip(forces).all(|(ControlBearing { parts, .. }, force)| {
                *force <= parts.limit * (1.0 + 1e-12) && force * frequency.abs() <= parts.slew * (1.0 + 1e-12)
            })
        })
    }

    /// Whether what the loop answers is a ratio of polynomials in the frequency.
    pub(super) fn is_rational(&self) -> bool {
        self.around.as_ref().is_none_or(|(_, feedback)| feedback.delay() == 0.0)
    }

    /// The largest clearance that matters, in `e_t`; 0 without any.
    pub(super) fn largest_clearance(&self) -> f64 {
        self.contacts(self.gapped).map(|k| self.deadband[k]).fold(0.0, f64::max)
    }

    /// Clearance of mass `k`.
    pub(super) fn clearance(&self, k: usize) -> f64 {
        self.deadband[k]
    }

    /// The masses in a set, ascending.
    pub(super) fn contacts(&self, set: Contact) -> impl Iterator<Item = usize> + Clone + use<> {
        (0..self.masses).filter(move |k| set >> k & 1 == 1)
    }

    /// The masses beyond their clearance.
    pub(super) fn touching(&self, c: &DVector<C64>) -> Contact {
        let beyond = self.contacts(self.gapped).filter(|&k| c[k].norm() > self.deadband[k]);
        beyond.fold(0, |set, k| set | 1 << k)
    }

    /// Whether the radii agree with the set of bearings in contact that they were computed for, to a relative `tolerance`.
    pub(super) fn is_consistent(&self, c: &[C64], contact: Contact, tolerance: f64) -> bool {
        self.contacts(self.gapped).all(|k| {
            let (radius, g) = (c[k].norm(), self.deadband[k]);
            if contact >> k & 1 == 1 { radius > g * (1.0 - tolerance) } else { radius <= g * (1.0 + tolerance) }
        })
    }
}
