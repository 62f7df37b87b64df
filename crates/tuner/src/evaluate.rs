//! The worth of every mode at every condition for given gains, and its slope in each gain.

use rotor::{C64, ControlRow, MAX_MASSES, Quadratic};

use crate::force::Synchronous;
use crate::minimax::EXCESS;
use crate::{Measure, Problem};

/// A condition with its equations of motion at hand.
#[derive(Clone, Debug)]
pub(crate) struct Operating {
    /// Where it is in the family.
    pub(crate) point: Vec<f64>,
    speed: f64,
    /// Control off.
    open: Quadratic,
    /// Where a force limit is to be kept.
    synchronous: Option<Synchronous>,
}

impl Operating {
    /// The condition at `point` of the problem's family.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Self {
        let speed = point[0];
        let open = problem.family.open(point);
        let synchronous = problem.force_limit.map(|_| {
            Synchronous::new(&open, &problem.family.unbalance(point), problem.structure.bearing(), speed)
        });
        Self { point: point.to_vec(), speed, open, synchronous }
    }

    fn closed(&self, row: &ControlRow) -> Quadratic {
        let mut closed = self.open.clone();
        closed.control(row);
        closed
    }
}

/// One mode at one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    /// Which condition.
    pub(crate) condition: usize,
    /// Its pole.
    pub(crate) pole: C64,
    /// What it is worth.
    pub(crate) value: f64,
}

/// Gains under judgement at a list of conditions.
#[derive(Debug)]
pub(crate) struct Evaluator<'p> {
    pub(crate) problem: &'p Problem,
    pub(crate) conditions: Vec<Operating>,
    /// Every mode of every condition for the gains last judged.
    pub(crate) readings: Vec<Reading>,
    /// One a condition; stale where it was not judged.
    closed: Vec<Quadratic>,
    /// How many eigenvalue problems were solved.
    pub(crate) evaluations: u64,
    sensitivities: Vec<C64>,
}

impl<'p> Evaluator<'p> {
    /// Nothing judged yet.
    pub(crate) fn new(problem: &'p Problem, points: &[Vec<f64>]) -> Self {
        let conditions = points.iter().map(|point| Operating::at(problem, point)).collect();
        Self {
            problem,
            conditions,
            readings: Vec::new(),
            closed: Vec::new(),
            evaluations: 0,
            sensitivities: vec![C64::ZERO; problem.structure.variables()],
        }
    }

    /// Takes a condition more.
    pub(crate) fn push(&mut self, point: &[f64]) {
        self.conditions.push(Operating::at(self.problem, point));
    }

    /// Judges `gains` at every condition and gives the worth of the worst mode; `-inf` if it cannot be had.
    pub(crate) fn judge(&mut self, gains: &[f64]) -> f64 {
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
        let operating = &self.conditions[condition];
        let closed = operating.closed(&self.problem.structure.row(gains, operating.speed));
        self.evaluations += 1;
        let Ok(poles) = closed.poles() else { return f64::NEG_INFINITY };
        let mut worst = f64::INFINITY;
        for pole in poles {
            let value = self.problem.measure.of(pole);
            worst = worst.min(value);
            self.readings.push(Reading { condition, pole, value });
        }
        while self.closed.len() <= condition {
            self.closed.push(self.conditions[self.closed.len()].open.clone());
        }
        self.closed[condition] = closed;
        worst
    }

    /// The slope of one reading of the gains last judged in each variable, into `out`.
    pub(crate) fn slope(&mut self, reading: Reading, out: &mut [f64]) {
        let [by_re, by_im] = self.problem.measure.slope(reading.pole);
        for (out, moved) in out.iter_mut().zip(self.pole_slope(reading)) {
            *out = by_re * moved.re + by_im * moved.im;
        }
    }

    /// What the pole of a reading of the gains last judged moves by with each variable.
    pub(crate) fn pole_slope(&mut self, reading: Reading) -> &[C64] {
        let Reading { condition, pole, .. } = reading;
        let (operating, closed) = (&self.conditions[condition], &self.closed[condition]);
        let n = closed.masses();
        let (mut right, mut left, mut moved) = ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]);
        closed.vectors(pole, &mut right[..n], &mut left[..n]);
        closed.row_times_damping(&left[..n], &mut moved[..n]);
        // q (2 lambda I - D) p: what the equation of motion gives way by as the pole moves.
        let stiffness: C64 = (0..n).map(|i| (left[i] * (pole * 2.0) - moved[i]) * right[i]).sum();
        self.problem.structure.sensitivities(operating.speed, &right[..n], pole, &mut self.sensitivities);
        // At a defective pole the slope is infinite: large and finite keeps a search going.
        let floor = 1e-12 * pole.norm().max(1e-12);
        let stiffness = if stiffness.norm() < floor { C64::from(floor) } else { stiffness };
        let per_force = -left[self.problem.structure.bearing()] / stiffness;
        self.sensitivities.iter_mut().for_each(|s| *s *= per_force);
        &self.sensitivities
    }

    /// The control force at condition `condition` over the limit, with its slope if there is room for it; 0 without a limit.
    pub(crate) fn relative_force(&self, condition: usize, gains: &[f64], slope: &mut [f64]) -> f64 {
        let (Some(limit), Some(synchronous)) = (self.problem.force_limit, &self.conditions[condition].synchronous) else {
            slope.fill(0.0);
            return 0.0;
        };
        let structure = &self.problem.structure;
        let row = structure.row(gains, self.conditions[condition].speed);
        let force = synchronous.force(structure, &row, slope);
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

    /// What counts when gains are compared: the worth of the worst mode, less the price of constraints that are violated.
    pub(crate) fn merit(&mut self, gains: &[f64]) -> f64 {
        let worst = self.judge(gains);
        let lacking = self.readings.iter().filter_map(|r| self.problem.measure.in_hand(r.pole)).map(|(value, _)| -value);
        let excess = self.largest_relative_force(gains) - 1.0;
        worst - EXCESS * lacking.fold(excess.max(0.0), f64::max)
    }
}

/// The worth of the worst mode at one condition, and its pole.
pub(crate) fn worst_at(problem: &Problem, gains: &[f64], point: &[f64]) -> (f64, C64) {
    let mut closed = problem.family.open(point);
    closed.control(&problem.structure.row(gains, point[0]));
    let Ok(poles) = closed.poles() else { return (f64::NEG_INFINITY, C64::ZERO) };
    worst_of(problem.measure, &poles)
}

fn worst_of(measure: Measure, poles: &[C64]) -> (f64, C64) {
    let each = poles.iter().map(|&pole| (measure.of(pole), pole));
    each.fold((f64::INFINITY, C64::ZERO), |worst, this| if this.0 < worst.0 { this } else { worst })
}
