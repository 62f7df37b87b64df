//! The worth of every mode at every condition for given gains, and its slope in each gain.

use std::cell::RefCell;

use rotor::C64;

use crate::limits::Sought;
use crate::measure::Aspect;
use crate::operating::{Closed, Operating};
use crate::stop::Stop;
use crate::{Measure, Problem};

/// Price of a violated constraint, in worth per unit: above any multiplier that one has in practice.
pub(crate) const EXCESS: f64 = 10.0;

/// One mode at one condition, or what is judged of the condition as a whole, with its least damped mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    /// Which condition.
    pub(crate) condition: usize,
    /// Its pole.
    pub(crate) pole: C64,
    /// What of it is judged.
    pub(crate) aspect: Aspect,
    /// What it is worth.
    pub(crate) value: f64,
}

/// Gains under judgement at a list of conditions.
#[derive(Debug)]
pub(crate) struct Evaluator<'p> {
    pub(crate) problem: &'p Problem,
    pub(crate) conditions: Vec<Operating>,
    /// Every mode of every condition for the gains last evaluated.
    pub(crate) readings: Vec<Reading>,
    /// One a condition; stale where it was not evaluated.
    closed: Vec<Option<Closed>>,
    /// Likewise, the poles: near those of the next gains, which is where loops with delay are looked for first.
    before: Vec<Vec<C64>>,
    /// The largest magnitude of each variable.
    pub(crate) reach: Vec<f64>,
    /// How many eigenvalue problems were solved.
    pub(crate) evaluations: u64,
    /// One a condition: where its margins may fall short, for the gains that they were sought for last.
    pub(crate) sought: RefCell<Vec<Option<Sought>>>,
    sensitivities: Vec<C64>,
    /// The gains last evaluated.
    at: Vec<f64>,
    /// Gains that these are to stay near, and the price of the square of the distance.
    pub(crate) tether: Option<(Vec<f64>, f64)>,
    /// Once it is set nothing is evaluated any more: whatever climbs comes to its end at once.
    stop: Stop<'p>,
}

impl<'p> Evaluator<'p> {
    /// Nothing evaluated yet.
    pub(crate) fn new(problem: &'p Problem, points: &[Vec<f64>]) -> Self {
        let conditions = points.iter().map(|point| Operating::at(problem, point)).collect();
        Self {
            problem,
            conditions,
            readings: Vec::new(),
            closed: Vec::new(),
            before: Vec::new(),
            reach: problem.reach(),
            evaluations: 0,
            sought: RefCell::default(),
            sensitivities: vec![C64::ZERO; problem.structure.variables()],
            at: Vec::new(),
            tether: None,
            stop: Stop::NEVER,
        }
    }

    /// The same until `stop` is set: then everything is worth `-inf`.
    pub(crate) fn until(self, stop: Stop<'p>) -> Self {
        Self { stop, ..self }
    }

    /// Takes a condition more.
    pub(crate) fn push(&mut self, point: &[f64]) {
        self.conditions.push(Operating::at(self.problem, point));
    }

    /// Judges `gains` at every condition and gives the worth of the worst mode; `-inf` if it cannot be had.
    pub(crate) fn evaluate(&mut self, gains: &[f64]) -> f64 {
        self.readings.clear();
        let mut worst = f64::INFINITY;
        for condition in 0..self.conditions.len() {
            let value = self.judge_at(condition, gains);
            if value == f64::NEG_INFINITY {
                self.readings.clear();
                return value;
            }
            worst = worst.min(value);
        }
        worst
    }

    /// The same for some conditions alone: there are no readings of the others then.
    pub(crate) fn judge_some(&mut self, conditions: &[usize], gains: &[f64]) -> bool {
        self.readings.clear();
        conditions.iter().all(|&condition| self.judge_at(condition, gains) > f64::NEG_INFINITY)
    }

    fn judge_at(&mut self, condition: usize, gains: &[f64]) -> f64 {
        if self.stop.is_set() {
            return f64::NEG_INFINITY;
        }
        let operating = &self.conditions[condition];
        self.evaluations += 1;
        let near = self.before.get(condition).map_or(&[][..], |before| before);
        let Some((closed, poles)) = operating.close(self.problem, gains, near) else { return f64::NEG_INFINITY };
        let first = self.readings.len();
        match self.problem.measure {
            Measure::Cost(cost) if poles.iter().all(|pole| pole.re < 0.0) => {
                let Some(value) = cost.worth(self.problem, gains, &operating.point, &mut []) else {
                    return f64::NEG_INFINITY;
                };
                let least = poles.iter().max_by(|a, b| a.re.total_cmp(&b.re)).copied().unwrap_or_default();
                self.readings.push(Reading { condition, pole: least, aspect: Aspect::Cost, value });
            }
            measure => {
                for &pole in &poles {
                    for aspect in measure.aspects() {
                        let value = self.problem.worth_of(aspect, pole);
                        self.readings.push(Reading { condition, pole, aspect, value });
                    }
                }
            }
        }
        let worst = self.readings[first..].iter().map(|reading| reading.value).fold(f64::INFINITY, f64::min);
        if self.at != gains {
            self.at = gains.to_vec();
        }
        self.closed.resize(self.conditions.len(), None);
        if operating.delay > 0.0 {
            self.before.resize(self.conditions.len(), Vec::new());
            self.before[condition] = poles;
        }
        self.closed[condition] = Some(closed);
        worst
    }

    /// The slope of one reading of the gains last evaluated in each variable, into `out`.
    pub(crate) fn slope(&mut self, reading: Reading, out: &mut [f64]) {
        if let (Measure::Cost(cost), Aspect::Cost) = (self.problem.measure, reading.aspect) {
            let point = &self.conditions[reading.condition].point;
            if cost.worth(self.problem, &self.at, point, out).is_none() {
                out.fill(0.0);
            }
            return;
        }
        let [by_re, by_im] = self.problem.worth_slope(reading.aspect, reading.pole);
        for (out, moved) in out.iter_mut().zip(self.pole_slope(reading)) {
            *out = by_re * moved.re + by_im * moved.im;
        }
    }

    /// What the pole of a reading of the gains last evaluated moves by with each variable.
    pub(crate) fn pole_slope(&mut self, reading: Reading) -> &[C64] {
        let Reading { condition, pole, .. } = reading;
        let closed = self.closed.get(condition).and_then(Option::as_ref);
        self.conditions[condition].pole_slope(self.problem, closed, pole, &mut self.sensitivities);
        &self.sensitivities
    }

    /// What counts when gains are compared: the worth of the worst mode, less the price of constraints that are violated.
    pub(crate) fn merit(&mut self, gains: &[f64]) -> f64 {
        let worst = self.evaluate(gains);
        let lacking =
            self.readings.iter().filter_map(|r| self.problem.measure.in_hand(r.pole)).map(|(value, _)| -value);
        let excess = self.largest_relative_force(gains) - 1.0;
        let short = excess.max(self.shortfall(gains)).max(0.0);
        worst - EXCESS * lacking.fold(short, f64::max) - self.pull(gains)
    }

    /// Puts variables within their bounds.
    pub(crate) fn clamp(&self, gains: &mut [f64]) {
        gains.iter_mut().zip(&self.reach).for_each(|(gain, reach)| *gain = gain.clamp(-reach, *reach));
    }

    /// The price of the distance from where the tether holds.
    pub(crate) fn pull(&self, gains: &[f64]) -> f64 {
        let Some((at, price)) = &self.tether else { return 0.0 };
        price * gains.iter().zip(at).map(|(x, a)| (x - a) * (x - a)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests;
