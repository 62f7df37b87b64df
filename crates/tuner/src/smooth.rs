//! The smoothing continuation: the smallest of many values, made smooth and sharpened step by step.
//!
//! `S_beta(x) = -(1 / beta) log sum_k exp(-beta f_k(x))` lies below the smallest `f_k` by at most `log(K) / beta` and has a
//! slope, the mean of theirs weighted by `exp(-beta f_k)`. With a small `beta` every mode is heard and the kinks, where the
//! least damped mode changes, are rounded off; from stage to stage the worst is heard more. Each stage is a quasi-Newton
//! climb (BFGS, weak Wolfe conditions by bisection as in Lewis & Overton 2013) inside the bounds, by projection: a gain at
//! its bound that would leave it stays out of the step.

use crate::evaluate::Evaluator;
use crate::quadratic_program::dot;
use crate::stop::Stop;

/// `beta` of each stage.
const STAGES: [f64; 8] = [5.0, 15.0, 50.0, 150.0, 500.0, 1500.0, 6000.0, 20_000.0];
const STEPS_PER_STAGE: usize = 40;
/// Length of the first step of a stage, before anything is known of the curvature.
const FIRST_STEP: f64 = 0.1;
/// Weight of the square by which a limit of force or margin is missed, relative to the limit, beside the damping.
const LIMIT_WEIGHT: f64 = 10.0;

/// How many of the first stages a climb leaves out that is to end near where it begins.
pub(crate) const ROUGH: usize = 4;

/// Climbs from `gains`, which ends inside the bounds, at the best gains seen; without so many of the first stages.
pub(crate) fn climb(evaluator: &mut Evaluator, gains: &mut Vec<f64>, skipped: usize, stop: &Stop) {
    evaluator.clamp(gains);
    let mut best = (evaluator.merit(gains), gains.clone());
    for (stage, beta) in STAGES.into_iter().skip(skipped).enumerate() {
        let mut climber = Climber { evaluator, beta };
        climber.stage(gains, if stage == 0 { 2 * STEPS_PER_STAGE } else { STEPS_PER_STAGE }, stop);
        let merit = evaluator.merit(gains);
        if merit > best.0 {
            best = (merit, gains.clone());
        }
        if stop.is_set() {
            break;
        }
    }
    *gains = best.1;
}

struct Climber<'a, 'p> {
    evaluator: &'a mut Evaluator<'p>,
    beta: f64,
}

/// A value to be lowered, and its slope.
#[derive(Clone)]
struct Point {
    at: Vec<f64>,
    value: f64,
    slope: Vec<f64>,
}

impl Climber<'_, '_> {
    /// `-S_beta` and its slope at `at`.
    fn point(&mut self, at: Vec<f64>) -> Point {
        let mut slope = vec![0.0; at.len()];
        let worst = self.evaluator.evaluate(&at);
        if worst == f64::NEG_INFINITY {
            return Point { at, value: f64::INFINITY, slope };
        }
        let beta = self.beta;
        let mut sum = 0.0;
        let mut one = vec![0.0; at.len()];
        // What weighs less than rounding is not differentiated, only counted.
        let readings = std::mem::take(&mut self.evaluator.readings);
        for reading in &readings {
            let weight = (-beta * (reading.value - worst)).exp();
            sum += weight;
            if weight > 1e-9 {
                self.evaluator.slope(*reading, &mut one);
                one.iter().zip(&mut slope).for_each(|(d, s)| *s -= weight * d);
            }
        }
        self.evaluator.readings = readings;
        slope.iter_mut().for_each(|s| *s /= sum);
        let mut value = sum.ln() / beta - worst;
        value += self.evaluator.force_penalty(&at, LIMIT_WEIGHT, &mut slope);
        value += self.evaluator.shortfall_penalty(&at, LIMIT_WEIGHT, &mut slope);
        Point { at, value, slope }
    }

    fn stage(&mut self, gains: &mut Vec<f64>, steps: usize, stop: &Stop) {
        let n = gains.len();
        let mut here = self.point(gains.clone());
        let mut inverse: Option<Vec<f64>> = None;
        for _ in 0..steps {
            let free: Vec<bool> = (0..n).map(|i| self.is_free(&here, i)).collect();
            let slope: Vec<f64> = here.slope.iter().zip(&free).map(|(s, free)| if *free { *s } else { 0.0 }).collect();
            let length = dot(&slope, &slope).sqrt();
            if length < 1e-10 || !here.value.is_finite() || stop.is_set() {
                break;
            }
            let downhill = || slope.iter().map(|s| -s / length * FIRST_STEP).collect::<Vec<f64>>();
            let mut direction = match &inverse {
                None => downhill(),
                Some(h) => (0..n).map(|i| if free[i] { -dot(&h[i * n..(i + 1) * n], &slope) } else { 0.0 }).collect(),
            };
            if dot(&direction, &slope) > -1e-12 * length * dot(&direction, &direction).sqrt() {
                // What was learned of the curvature points uphill here: begin anew.
                direction = downhill();
                inverse = None;
            }
            let Some(next) = self.line_search(&here, &direction) else {
                if inverse.is_none() {
                    break;
                }
                inverse = None;
                continue;
            };
            let gained = here.value - next.value;
            update(&mut inverse, &here, &next);
            here = next;
            // The next stage asks something else anyway.
            if gained < 1e-5 / self.beta {
                break;
            }
        }
        *gains = here.at;
    }

    /// Whether variable `i` may move: not at a bound that it would leave.
    fn is_free(&self, here: &Point, i: usize) -> bool {
        let edge = self.evaluator.reach[i] * (1.0 - 1e-14);
        !((here.at[i] >= edge && here.slope[i] < 0.0) || (here.at[i] <= -edge && here.slope[i] > 0.0))
    }

    /// A point along `direction`, projected on the bounds, that is lower by enough (Armijo) and less steep (weak Wolfe).
    fn line_search(&mut self, here: &Point, direction: &[f64]) -> Option<Point> {
        let (mut low, mut high, mut step) = (0.0, f64::INFINITY, 1.0);
        let mut best: Option<Point> = None;
        for _ in 0..25 {
            let mut at: Vec<f64> = here.at.iter().zip(direction).map(|(x, d)| x + step * d).collect();
            self.evaluator.clamp(&mut at);
            let moved: Vec<f64> = at.iter().zip(&here.at).map(|(a, b)| a - b).collect();
            let expected = dot(&here.slope, &moved);
            if expected >= 0.0 {
                break;
            }
            let there = self.point(at);
            if there.value > here.value + 1e-4 * expected || !there.value.is_finite() {
                high = step;
            } else {
                let steep = dot(&there.slope, &moved) < 0.9 * expected;
                let better = best.as_ref().is_none_or(|best| there.value < best.value);
                if better {
                    best = Some(there);
                }
                if !steep {
                    break;
                }
                low = step;
            }
            if best.is_some() && high < f64::INFINITY && high - low < 0.1 * high {
                break;
            }
            step = if high < f64::INFINITY { 0.5 * (low + high) } else { 2.0 * low };
            if step < 1e-12 {
                break;
            }
        }
        best
    }
}

/// The BFGS update of an inverse Hessian, scaled to the first step's curvature.
fn update(inverse: &mut Option<Vec<f64>>, from: &Point, to: &Point) {
    let n = from.at.len();
    let s: Vec<f64> = to.at.iter().zip(&from.at).map(|(a, b)| a - b).collect();
    let y: Vec<f64> = to.slope.iter().zip(&from.slope).map(|(a, b)| a - b).collect();
    let curvature = dot(&s, &y);
    if curvature <= 1e-12 * (dot(&s, &s) * dot(&y, &y)).sqrt() {
        return;
    }
    let h = inverse.get_or_insert_with(|| {
        let scale = curvature / dot(&y, &y);
        (0..n * n).map(|k| if k % (n + 1) == 0 { scale } else { 0.0 }).collect()
    });
    let hy: Vec<f64> = (0..n).map(|i| dot(&h[i * n..(i + 1) * n], &y)).collect();
    let factor = (1.0 + dot(&y, &hy) / curvature) / curvature;
    for i in 0..n {
        for j in 0..n {
            h[i * n + j] += factor * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / curvature;
        }
    }
}
