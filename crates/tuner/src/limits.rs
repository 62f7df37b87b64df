//! Limits that gains are to keep beside the worth of their modes: of the control force, and of the loop's margins; by how much they are
//! missed, and what that costs.

use rotor::C64;

use crate::Problem;
use crate::evaluate::Evaluator;
use crate::force::Synchronous;
use crate::opened::{self, LoopMargins, Place};

/// Where margins may fall short at a condition, for these gains.
#[derive(Clone, Debug)]
pub(crate) struct Sought {
    gains: Vec<f64>,
    places: Vec<Place>,
}

impl Evaluator<'_> {
    /// The control force at condition `condition` over the limit, with its slope if there is room for it; 0 without a limit.
    pub(crate) fn relative_force(&self, condition: usize, gains: &[f64], slope: &mut [f64]) -> f64 {
        let (Some(limit), Some(synchronous)) = (self.problem.force_limit, &self.conditions[condition].synchronous)
        else {
            slope.fill(0.0);
            return 0.0;
        };
        let force = synchronous.force(self.problem, gains, slope);
        slope.iter_mut().for_each(|s| *s /= limit);
        force / limit
    }

    /// The largest control force over the limit; 0 without a limit.
    pub(crate) fn largest_relative_force(&self, gains: &[f64]) -> f64 {
        if self.problem.force_limit.is_none() {
            return 0.0;
        }
        (0..self.conditions.len()).map(|k| self.relative_force(k, gains, &mut [])).fold(0.0, f64::max)
    }

    /// `weight` times the squares by which the force exceeds its limit; its slope is added to `slope`.
    pub(crate) fn force_penalty(&self, gains: &[f64], weight: f64, slope: &mut [f64]) -> f64 {
        if self.problem.force_limit.is_none() {
            return 0.0;
        }
        let mut one = vec![0.0; slope.len()];
        let mut penalty = 0.0;
        for condition in 0..self.conditions.len() {
            let excess = self.relative_force(condition, gains, &mut one) - 1.0;
            if excess > 0.0 {
                penalty += weight * excess * excess;
                slope.iter_mut().zip(&one).for_each(|(s, d)| *s += 2.0 * weight * excess * d);
            }
        }
        penalty
    }

    /// Where the loop at a condition may fall short of the margins that are asked for, at the gains last judged; nothing where
    /// nothing is asked, nor where it is not stable and has none.
    pub(crate) fn places(&self, condition: usize, gains: &[f64]) -> Vec<Place> {
        let opened = match &self.conditions[condition].opened {
            Some(opened) if self.is_stable(condition) => opened,
            _ => return Vec::new(),
        };
        // Merit, penalty and rows ask for the same gains one after the other.
        let mut sought = self.sought.borrow_mut();
        sought.resize(self.conditions.len(), None);
        let known = &mut sought[condition];
        if let Some(known) = known.as_ref().filter(|known| known.gains == gains) {
            return known.places.clone();
        }
        let poles = self.readings.iter().filter(|r| r.condition == condition);
        let near: Vec<C64> = poles.map(|r| r.pole).collect();
        let places = opened.places(self.problem, gains, &near);
        *known = Some(Sought { gains: gains.to_vec(), places: places.clone() });
        places
    }

    /// What a place has in hand changes by, per variable.
    pub(crate) fn place_slope(&self, condition: usize, place: &Place, gains: &[f64], slope: &mut [f64]) {
        match &self.conditions[condition].opened {
            Some(opened) => opened.slope(self.problem, gains, place, slope),
            None => slope.fill(0.0),
        }
    }

    pub(crate) fn is_stable(&self, condition: usize) -> bool {
        self.readings.iter().filter(|r| r.condition == condition).all(|r| r.pole.re < 0.0)
    }

    /// The most by which any margin falls short, in parts of what is asked for; 1, which is all of it, where the loop is not stable.
    pub(crate) fn shortfall(&self, gains: &[f64]) -> f64 {
        let of = |condition: usize| {
            if self.conditions[condition].opened.is_some() && !self.is_stable(condition) {
                return 1.0;
            }
            self.places(condition, gains).iter().map(|place| -place.in_hand).fold(0.0, f64::max)
        };
        (0..self.conditions.len()).map(of).fold(0.0, f64::max)
    }

    /// `weight` times the squares by which margins fall short; its slope is added to `slope`.
    pub(crate) fn shortfall_penalty(&self, gains: &[f64], weight: f64, slope: &mut [f64]) -> f64 {
        let mut one = vec![0.0; slope.len()];
        let mut penalty = 0.0;
        for condition in 0..self.conditions.len() {
            if self.conditions[condition].opened.is_some() && !self.is_stable(condition) {
                penalty += weight;
            }
            for place in self.places(condition, gains).into_iter().filter(|place| place.in_hand < 0.0) {
                penalty += weight * place.in_hand * place.in_hand;
                self.place_slope(condition, &place, gains, &mut one);
                slope.iter_mut().zip(&one).for_each(|(s, d)| *s += 2.0 * weight * place.in_hand * d);
            }
        }
        penalty
    }
}

/// The steady control force at one condition, in `w0^2 e_t` on the mass of the first control bearing.
pub(crate) fn force_at(problem: &Problem, gains: &[f64], point: &[f64]) -> f64 {
    Synchronous::new(problem, point).force(problem, gains, &mut [])
}

/// What the loop at one condition has in hand of the margins asked for, where that is least: -1, which is nothing, where it is not
/// stable.
pub(crate) fn in_hand_at(problem: &Problem, gains: &[f64], point: &[f64]) -> f64 {
    let mut evaluator = Evaluator::new(problem, &[point.to_vec()]);
    if evaluator.evaluate(gains) == f64::NEG_INFINITY || !evaluator.is_stable(0) {
        return -1.0;
    }
    evaluator.places(0, gains).iter().map(|place| place.in_hand).fold(f64::INFINITY, f64::min)
}

/// The margins at one condition; nothing if its poles cannot be had.
pub(crate) fn margins_at(problem: &Problem, gains: &[f64], point: &[f64]) -> Option<LoopMargins> {
    let mut evaluator = Evaluator::new(problem, &[point.to_vec()]);
    evaluator.evaluate(gains);
    let poles: Vec<C64> = evaluator.readings.iter().map(|reading| reading.pole).collect();
    opened::margins_at(problem, gains, point, &poles)
}
