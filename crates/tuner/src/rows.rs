//! What a step of [`crate::minimax`] sees: values that may become the worst, and constraints, each with its slope.
//!
//! **Merging poles.** The best gains often make two poles of one condition coincide. There the damping of each has an
//! infinite slope, as a square root has, and no linear model of it holds. But two functions of the pair are smooth: the
//! mean `m = (a + b) / 2` and `q = ((a - b) / 2 m)^2`. Both poles are as well damped as their mean, exactly, if they lie on
//! one ray through the origin, that is where `Im q = 0` and `Re q >= 0`. So a pair near each other becomes three rows: the
//! worth of the mean, `Im q = 0`, and `Re q >= a little`, which keeps the poles far enough apart to be computed to many
//! digits. (For decay rates the ray is the vertical through the mean, and `q = -((a - b) / 2)^2`.)

use rotor::C64;

use crate::evaluate::{EXCESS, Evaluator, Reading};
use crate::measure::Aspect;
use crate::opened::Place;
use crate::quadratic_program::dot;

/// No more values than this enter one step: the worst ones.
const MOST: usize = 240;
/// Half the distance of merging poles relative to their size: an error of `eps / distance` in each leaves eleven digits.
const APART: f64 = 3e-5;
/// `q` moves with gains a hundredth as fast as poles do: in these units its constraints weigh like the others.
const UNIT: f64 = 0.01;

/// Part of a limit of force or margin that is kept in hand, for speeds between those that are looked at.
pub(crate) const MARGIN: f64 = 1e-4;

/// What a row asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The smallest of these is to be as large as can be.
    Worth,
    /// This is to be 0.
    Zero,
    /// This is not to be negative.
    AtLeastZero,
}

/// Where a row comes from, so that it can be read anew at other gains.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Mode(Reading),
    Mean(Reading, Reading),
    /// `Im q`.
    Skew(Reading, Reading),
    /// `Re q` less what it is to be.
    Spread(Reading, Reading),
    /// What a slow pole has in hand, see [`crate::Measure`].
    Slow(Reading),
    /// The control force at a condition: 1 less the force over its limit.
    Force(usize),
    /// What a margin at a condition has in hand.
    Margin(usize, Place),
}

/// One of them at some gains.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) kind: Kind,
    source: Source,
    pub(crate) value: f64,
    pub(crate) slope: Vec<f64>,
    /// A constraint this near to binding counts as binding.
    pub(crate) slack: f64,
}

impl Row {
    /// The condition that it is about.
    pub(crate) fn condition(&self) -> usize {
        match self.source {
            Source::Mode(reading) | Source::Slow(reading) => reading.condition,
            Source::Mean(a, _) | Source::Skew(a, _) | Source::Spread(a, _) => a.condition,
            Source::Force(condition) | Source::Margin(condition, _) => condition,
        }
    }

    /// The row of `source` at the gains last evaluated, which are `gains`.
    fn of(source: Source, evaluator: &mut Evaluator, gains: &[f64]) -> Self {
        let mut slope = vec![0.0; gains.len()];
        let problem = evaluator.problem;
        let measure = problem.measure;
        let (kind, value, slack) = match source {
            Source::Mode(reading) => {
                evaluator.slope(reading, &mut slope);
                (Kind::Worth, reading.value, 0.0)
            }
            Source::Mean(a, b) | Source::Skew(a, b) | Source::Spread(a, b) => {
                let pair = Pair::of(a, b, evaluator);
                match source {
                    Source::Mean(..) => {
                        let [by_re, by_im] = problem.worth_slope(a.aspect, pair.mean);
                        slope.iter_mut().zip(&pair.d_mean).for_each(|(s, d)| *s = by_re * d.re + by_im * d.im);
                        (Kind::Worth, problem.worth_of(a.aspect, pair.mean), 0.0)
                    }
                    Source::Skew(..) => {
                        slope.iter_mut().zip(&pair.d_spread).for_each(|(s, d)| *s = d.im / UNIT);
                        (Kind::Zero, pair.spread.im / UNIT, 0.0)
                    }
                    _ => {
                        slope.iter_mut().zip(&pair.d_spread).for_each(|(s, d)| *s = d.re / UNIT);
                        let least = APART * APART;
                        (Kind::AtLeastZero, (pair.spread.re - least) / UNIT, 10.0 * least / UNIT)
                    }
                }
            }
            Source::Slow(reading) => {
                // A pole that is slow no more has all in hand.
                let (value, [by_re, by_im]) = measure.in_hand(reading.pole).unwrap_or((1.0, [0.0; 2]));
                slope.iter_mut().zip(evaluator.pole_slope(reading)).for_each(|(s, d)| *s = by_re * d.re + by_im * d.im);
                (Kind::AtLeastZero, value, 1e-6)
            }
            Source::Force(condition) => {
                let force = evaluator.relative_force(condition, gains, &mut slope);
                slope.iter_mut().for_each(|s| *s = -*s);
                (Kind::AtLeastZero, 1.0 - MARGIN - force, MARGIN)
            }
            Source::Margin(condition, place) => {
                evaluator.place_slope(condition, &place, gains, &mut slope);
                (Kind::AtLeastZero, place.in_hand - MARGIN, MARGIN)
            }
        };
        Self { kind, source, value, slope, slack }
    }

    /// The same row at other gains, which were just evaluated.
    pub(crate) fn again(&self, evaluator: &mut Evaluator, gains: &[f64]) -> Self {
        let nearest = |evaluator: &Evaluator, to: Reading, but: Option<C64>| {
            let is_same = |r: &&Reading| (r.condition, r.aspect) == (to.condition, to.aspect) && Some(r.pole) != but;
            let same = evaluator.readings.iter().filter(is_same);
            let distance = |r: &&Reading| (r.pole - to.pole).norm_sqr();
            same.min_by(|a, b| distance(a).total_cmp(&distance(b))).copied().unwrap_or(to)
        };
        // Of a condition that was unstable, and of one that is, another thing is judged: a cost in place of decay rates, or the other way round.
        // What counts there now is the worst of it.
        let worst = |evaluator: &Evaluator, of: Reading| {
            let there = evaluator.readings.iter().filter(|r| r.condition == of.condition);
            there.min_by(|a, b| a.value.total_cmp(&b.value)).copied()
        };
        let is_judged = |evaluator: &Evaluator, of: Reading| {
            evaluator.readings.iter().any(|r| (r.condition, r.aspect) == (of.condition, of.aspect))
        };
        if let Source::Mode(of) | Source::Mean(of, _) | Source::Skew(of, _) | Source::Spread(of, _) = self.source
            && !is_judged(evaluator, of)
            && let Some(worst) = worst(evaluator, of)
        {
            return match self.source {
                Source::Mode(_) | Source::Mean(..) => Self::of(Source::Mode(worst), evaluator, gains),
                // No pair any more.
                _ => Self { value: 0.0, slope: vec![0.0; gains.len()], ..self.clone() },
            };
        }
        let both = |evaluator: &Evaluator, a: Reading, b: Reading| {
            let first = nearest(evaluator, a, None);
            (first, nearest(evaluator, b, Some(first.pole)))
        };
        let source = match self.source {
            Source::Mode(reading) => Source::Mode(nearest(evaluator, reading, None)),
            Source::Slow(reading) => Source::Slow(nearest(evaluator, reading, None)),
            Source::Mean(a, b) => {
                let (a, b) = both(evaluator, a, b);
                Source::Mean(a, b)
            }
            Source::Skew(a, b) => {
                let (a, b) = both(evaluator, a, b);
                Source::Skew(a, b)
            }
            Source::Spread(a, b) => {
                let (a, b) = both(evaluator, a, b);
                Source::Spread(a, b)
            }
            force @ Source::Force(_) => force,
            Source::Margin(condition, place) => {
                let places = evaluator.places(condition, gains);
                let same = places.into_iter().filter(|other| (other.ask, other.bearing) == (place.ask, place.bearing));
                let distance = |other: &Place| (other.frequency - place.frequency).abs();
                match same.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                    Some(place) => Source::Margin(condition, place),
                    // Gone: nothing falls short there any more.
                    None => return Self { value: 1.0, slope: vec![0.0; gains.len()], ..self.clone() },
                }
            }
        };
        Self::of(source, evaluator, gains)
    }
}

/// Two poles near each other, in the terms in which they are smooth.
struct Pair {
    mean: C64,
    d_mean: Vec<C64>,
    /// `q`, see the module.
    spread: C64,
    d_spread: Vec<C64>,
}

impl Pair {
    fn of(a: Reading, b: Reading, evaluator: &mut Evaluator) -> Self {
        let (d_a, d_b) = (evaluator.pole_slope(a).to_vec(), evaluator.pole_slope(b).to_vec());
        let (mean, half) = ((a.pole + b.pole) * 0.5, (a.pole - b.pole) * 0.5);
        let d_mean: Vec<C64> = d_a.iter().zip(&d_b).map(|(a, b)| (a + b) * 0.5).collect();
        let d_square = d_a.iter().zip(&d_b).map(|(a, b)| half * (a - b));
        let (spread, d_spread) = match a.aspect {
            Aspect::Ratio => {
                let spread = (half / mean) * (half / mean);
                let each = d_square.zip(&d_mean).map(|(d, m)| d / (mean * mean) - spread * 2.0 * m / mean);
                (spread, each.collect())
            }
            _ => (-half * half, d_square.map(|d| -d).collect()),
        };
        Self { mean, d_mean, spread, d_spread }
    }
}

/// All rows of one step.
#[derive(Debug)]
pub(crate) struct Rows {
    pub(crate) rows: Vec<Row>,
    /// The smallest worth among them.
    pub(crate) worst: f64,
}

impl Rows {
    /// What can matter within `radius` of the gains last evaluated.
    pub(crate) fn near(evaluator: &mut Evaluator, gains: &[f64], radius: f64, merge: f64) -> Self {
        // Every value may fall, and the worst rise, as fast as the steepest seen so far.
        Self::collect(evaluator, gains, merge, &|steepest| 2.0 * radius * steepest, radius)
    }

    /// What is within `within` of the worst value.
    pub(crate) fn within(evaluator: &mut Evaluator, gains: &[f64], within: f64, merge: f64) -> Self {
        Self::collect(evaluator, gains, merge, &|_| within, 0.0)
    }

    fn collect(evaluator: &mut Evaluator, gains: &[f64], merge: f64, window: &dyn Fn(f64) -> f64, radius: f64) -> Self {
        let mut order = evaluator.readings.clone();
        order.sort_by(|a, b| a.value.total_cmp(&b.value));
        let lowest = order.first().map_or(f64::NEG_INFINITY, |r| r.value);
        let mut rows: Vec<Row> = Vec::new();
        let (mut steepest, mut merged) = (0.0_f64, vec![false; order.len()]);
        for i in 0..order.len() {
            if merged[i] {
                continue;
            }
            let reading = order[i];
            if (rows.len() > 3 || radius == 0.0) && reading.value - lowest > window(steepest) || rows.len() >= MOST {
                break;
            }
            let partner =
                (i + 1..order.len()).filter(|&j| !merged[j] && is_pair(reading, order[j], merge)).min_by(|&j, &k| {
                    let distance = |j: usize| (order[j].pole - reading.pole).norm_sqr();
                    distance(j).total_cmp(&distance(k))
                });
            if let Some(j) = partner {
                merged[j] = true;
                let both = (reading, order[j]);
                for source in
                    [Source::Mean(both.0, both.1), Source::Skew(both.0, both.1), Source::Spread(both.0, both.1)]
                {
                    rows.push(Row::of(source, evaluator, gains));
                }
                let mean = &rows[rows.len() - 3];
                steepest = steepest.max(mean.slope.iter().map(|s| s.abs()).sum());
            } else {
                let row = Row::of(Source::Mode(reading), evaluator, gains);
                steepest = steepest.max(row.slope.iter().map(|s| s.abs()).sum());
                rows.push(row);
            }
        }
        for reading in evaluator.readings.clone() {
            if reading.aspect == Aspect::Ratio && evaluator.problem.measure.in_hand(reading.pole).is_some() {
                rows.push(Row::of(Source::Slow(reading), evaluator, gains));
            }
        }
        if evaluator.problem.force_limit.is_some() {
            for condition in 0..evaluator.conditions.len() {
                let row = Row::of(Source::Force(condition), evaluator, gains);
                if row.value < 0.01 + radius * row.slope.iter().map(|s| s.abs()).sum::<f64>() {
                    rows.push(row);
                }
            }
        }
        for condition in 0..evaluator.conditions.len() {
            for place in evaluator.places(condition, gains) {
                let row = Row::of(Source::Margin(condition, place), evaluator, gains);
                if row.value < 0.01 + radius * row.slope.iter().map(|s| s.abs()).sum::<f64>() {
                    rows.push(row);
                }
            }
        }
        Self::new(rows)
    }

    fn new(rows: Vec<Row>) -> Self {
        let worths = rows.iter().filter(|row| row.kind == Kind::Worth).map(|row| row.value);
        let worst = worths.fold(f64::INFINITY, f64::min);
        Self { rows, worst }
    }

    /// The same rows at other gains, just evaluated; the worst takes in every mode there is.
    pub(crate) fn again(&self, evaluator: &mut Evaluator, gains: &[f64]) -> Self {
        if evaluator.readings.is_empty() {
            return Self { rows: self.rows.clone(), worst: f64::NEG_INFINITY };
        }
        let mut made = Self::new(self.rows.iter().map(|row| row.again(evaluator, gains)).collect());
        let counted = |reading: &Reading| {
            made.rows.iter().any(|row| match row.source {
                Source::Mode(r) => r == *reading,
                Source::Mean(a, b) => a == *reading || b == *reading,
                _ => false,
            })
        };
        let rest = evaluator.readings.iter().filter(|r| r.value < made.worst && !counted(r)).map(|r| r.value);
        made.worst = rest.fold(made.worst, f64::min);
        made
    }

    /// These rows, shifted so that their linear model is right after `step`, where they are `after`.
    pub(crate) fn bent(&self, after: &Self, step: &[f64]) -> Self {
        let bend = |(row, there): (&Row, &Row)| Row { value: there.value - dot(&row.slope, step), ..row.clone() };
        Self { rows: self.rows.iter().zip(&after.rows).map(bend).collect(), worst: self.worst }
    }

    /// What counts: the worst value, less the price of violated constraints.
    pub(crate) fn merit(&self) -> f64 {
        self.worst - EXCESS * self.rows.iter().map(|row| violation(row, row.value)).fold(0.0, f64::max)
    }

    /// The same after a step, to first order.
    pub(crate) fn merit_after(&self, step: &[f64]) -> f64 {
        let after = |row: &Row| row.value + dot(&row.slope, step);
        let worths = self.rows.iter().filter(|row| row.kind == Kind::Worth).map(after);
        let worst = worths.fold(f64::INFINITY, f64::min);
        worst - EXCESS * self.rows.iter().map(|row| violation(row, after(row))).fold(0.0, f64::max)
    }
}

fn violation(row: &Row, value: f64) -> f64 {
    match row.kind {
        Kind::Worth => 0.0,
        Kind::Zero => value.abs(),
        Kind::AtLeastZero => (-value).max(0.0),
    }
}

/// Two poles of one condition, off the real axis, on one side of it, nearer each other than `merge` of their size.
fn is_pair(a: Reading, b: Reading, merge: f64) -> bool {
    let (half, mean) = ((a.pole - b.pole).norm() * 0.5, (a.pole + b.pole) * 0.5);
    let can_merge = a.aspect == b.aspect && matches!(a.aspect, Aspect::Ratio | Aspect::Decay);
    can_merge
        && a.condition == b.condition
        && 2.0 * half < merge * mean.norm()
        && half < 0.5 * mean.im.abs()
        && half > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::minimax::polish;
    use crate::stop::Stop;
    use crate::{Cost, Family, Measure, Problem, Schedule, Structure};

    /// What is judged of an unstable condition are decay rates, of a stable one its cost: a step from one to the other was refused, for
    /// its row kept the decay rate that it had before.
    #[test]
    fn regress_a_climb_leads_from_unstable_gains_to_a_finite_cost() {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        for (make, speeds) in [
            (Structure::composite as fn(usize, usize, &[usize]) -> rotor::Feedback, [4.0, 4.0]),
            (Structure::individual, [2.0, 6.0]),
        ] {
            let structure = Structure::new(&rotor, &make(3, 0, &[0, 1]), Schedule::Fixed).unwrap();
            let family = Family::new(&rotor, speeds[0], speeds[1]).unwrap();
            let problem = Problem { measure: Measure::Cost(Cost::default()), ..Problem::new(family, structure, 20.0) };
            let points = problem.family.grid(&crate::conditions::counts(&problem.family, 5));
            let mut evaluator = Evaluator::new(&problem, &points);
            let mut gains = vec![0.0; problem.structure.variables()];
            assert!(evaluator.evaluate(&gains) < 0.0, "off it is unstable");
            polish(&mut evaluator, &mut gains, [0.2, 1e-6], 0.02, &Stop::NEVER);
            let worst = evaluator.evaluate(&gains);
            assert!(worst > 0.0 && evaluator.readings.iter().all(|r| r.aspect == Aspect::Cost), "{worst} {gains:?}");
        }
    }
}
