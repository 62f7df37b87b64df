//! The end phase: sequential convex steps over all modes and conditions near the minimum.
//!
//! Near the best gains several modes at several conditions are equally bad, and no smooth model sees that corner. So each
//! step maximises the smallest of their linear models together, with the curvature of their Lagrangian:
//!
//! ```text
//! max_{d, t}  t - 1/2 d' H d   such that  f_k + g_k d >= t  for all k that can become the worst within the step,
//!                                         |x + d| <= bound,  |d| <= radius,  every constraint to first order
//! ```
//!
//! (sequential quadratic programming for minimax problems, Han 1981, in a trust region). It converges quadratically both to
//! corners, where as many values meet as there are directions, and to points with fewer, where curvature decides. What the
//! rows of such a step are is the business of [`crate::rows`].

use nalgebra::{DMatrix, SymmetricEigen};

use crate::evaluate::{EXCESS, Evaluator};
use crate::least_norm::least_norm;
use crate::quadratic_program::Program;
use crate::rows::{Kind, Row, Rows};
use crate::stop::Stop;

/// Steps of a polish, at most.
const STEPS: usize = 100;
/// Where corners of filters are searched the way is long, in small steps along a curved valley: as many more as it takes, ...
const MANY_STEPS: usize = 1000;
/// ... while so many of them ...
const STRETCH: usize = 25;
/// ... bring so much, relative to the worst value.
const WORTH_A_STRETCH: f64 = 5e-4;
/// A step that promises less than this, relative to the worst value, is not worth taking.
const NEGLIGIBLE: f64 = 1e-8;

/// Improves `gains`, in place; they never get worse. Ends when the trust radius falls below `last_radius` or a step promises
/// nothing worth having. Poles of one condition nearer each other than `merge`, relative to their size, are treated as a
/// pair about to merge, see [`crate::rows`].
pub(crate) fn polish(
    evaluator: &mut Evaluator,
    gains: &mut Vec<f64>,
    [first_radius, last_radius]: [f64; 2],
    merge: f64,
    stop: &Stop,
) {
    let reach = evaluator.reach.clone();
    let mut radius = first_radius;
    let mut held: Vec<(Row, f64)> = Vec::new();
    let mut best = (evaluator.merit(gains), gains.clone());
    if best.0 == f64::NEG_INFINITY {
        return;
    }
    let negligible = NEGLIGIBLE * best.0.abs().max(1e-3);
    let most = if evaluator.problem.structure.corners().is_empty() { STEPS } else { MANY_STEPS };
    let mut before_stretch = best.0;
    for taken in 0..most {
        if stop.is_set() || radius < last_radius {
            break;
        }
        if taken >= STEPS && taken % STRETCH == 0 {
            if best.0 - before_stretch < WORTH_A_STRETCH * best.0.abs() {
                break;
            }
            before_stretch = best.0;
        }
        let rows = Rows::near(evaluator, gains, radius, merge);
        let hessian = curvature(evaluator, gains, &held);
        let pull = evaluator.tether.clone();
        let Some(step) = Step::of(&rows, gains, &reach, radius, &hessian, pull.as_ref()) else {
            radius *= 0.25;
            evaluator.evaluate(gains);
            continue;
        };
        if step.rise < negligible {
            break;
        }
        let length = step.by.iter().fold(0.0, |a: f64, d| a.max(d.abs()));
        let before = rows.merit() - evaluator.pull(gains);
        let mut there = Trial::of(evaluator, &rows, gains, &step.by);
        if there.aim - before < 0.7 * step.rise
            && let Some(corrected) =
                Step::of(&rows.bent(&there.rows, &step.by), gains, &reach, radius, &hessian, pull.as_ref())
        {
            // Where the rows curve, the first step misses the corner that it aims at: aim again, with the miss known.
            let other = Trial::of(evaluator, &rows, gains, &corrected.by);
            if other.aim > there.aim {
                there = other;
            } else {
                evaluator.evaluate(&there.gains);
            }
        }
        held = step.held;
        let gained = there.aim - before;
        if gained > 0.05 * step.rise {
            *gains = there.gains;
            if gained > 0.7 * step.rise && length > 0.9 * radius {
                radius *= 2.5;
            }
            if there.merit > best.0 {
                best = (there.merit, gains.clone());
            }
        } else {
            radius = 0.3 * length.min(radius);
            evaluator.evaluate(gains);
        }
    }
    *gains = best.1;
}

/// Gains after a step, and what they are like.
struct Trial {
    gains: Vec<f64>,
    /// The rows of the step, read there.
    rows: Rows,
    /// What the step aims at: the merit in terms of those rows.
    aim: f64,
    /// What they really are worth.
    merit: f64,
}

impl Trial {
    fn of(evaluator: &mut Evaluator, rows: &Rows, gains: &[f64], by: &[f64]) -> Self {
        let mut gains: Vec<f64> = gains.iter().zip(by).map(|(x, d)| x + d).collect();
        evaluator.clamp(&mut gains);
        let merit = evaluator.merit(&gains);
        let rows = rows.again(evaluator, &gains);
        let aim = rows.merit() - evaluator.pull(&gains);
        Self { gains, rows, aim, merit }
    }
}

/// One step and what it promises.
struct Step {
    by: Vec<f64>,
    rise: f64,
    /// The rows that hold it, each with its multiplier.
    held: Vec<(Row, f64)>,
}

impl Step {
    fn of(
        rows: &Rows,
        gains: &[f64],
        reach: &[f64],
        radius: f64,
        hessian: &[f64],
        tether: Option<&(Vec<f64>, f64)>,
    ) -> Option<Self> {
        let n = gains.len();
        // Variables: the step, in units of the radius; the rise; and how much any constraint may stay violated. In units of
        // a typical rise, so that a program is of ordinary size whatever the scale of the step.
        let size = n + 2;
        let steepness = |row: &Row| row.slope.iter().map(|s| s.abs()).sum::<f64>();
        let unit =
            rows.rows.iter().filter(|row| row.kind == Kind::Worth).map(steepness).fold(1e-300, f64::max) * radius;
        let mut program = Program::new(size);
        for i in 0..n {
            for j in 0..n {
                program.hessian[i * size + j] = hessian[i * n + j] * radius * radius / unit;
            }
        }
        program.hessian[(n + 1) * size + n + 1] = 1e-8;
        program.linear[n] = -1.0;
        program.linear[n + 1] = EXCESS;
        if let Some((at, price)) = tether {
            for i in 0..n {
                program.hessian[i * size + i] += 2.0 * price * radius * radius / unit;
                program.linear[i] = 2.0 * price * (gains[i] - at[i]) * radius / unit;
            }
        }
        let mut places = Vec::with_capacity(rows.rows.len());
        for row in &rows.rows {
            let mut add = |limit: f64, sign: f64, extra: usize, by: f64| {
                program.at_most(limit, |line| {
                    line.iter_mut().zip(&row.slope).for_each(|(l, s)| *l = sign * s * radius / unit);
                    line[extra] = by;
                });
            };
            places.push(match row.kind {
                Kind::Worth => {
                    add((row.value - rows.worst) / unit, -1.0, n, 1.0);
                    1
                }
                Kind::AtLeastZero => {
                    add(row.value / unit, -1.0, n + 1, -1.0);
                    1
                }
                Kind::Zero => {
                    add(row.value / unit, -1.0, n + 1, -1.0);
                    add(-row.value / unit, 1.0, n + 1, -1.0);
                    2
                }
            });
        }
        for (i, (gain, most)) in gains.iter().zip(reach).enumerate() {
            program.at_most(((most - gain) / radius).min(1.0), |line| line[i] = 1.0);
            program.at_most(((most + gain) / radius).min(1.0), |line| line[i] = -1.0);
        }
        program.at_most(0.0, |line| line[n + 1] = -1.0);
        let solution = program.solve()?;
        let by: Vec<f64> = solution.point[..n].iter().map(|d| d * radius).collect();
        let pulled = |by: &[f64]| {
            let Some((at, price)) = tether else { return 0.0 };
            price * gains.iter().zip(at).zip(by).map(|((x, a), d)| (x + d - a).powi(2)).sum::<f64>()
        };
        let rise = rows.merit_after(&by) - pulled(&by) - (rows.merit() - pulled(&vec![0.0; n]));
        let mut multipliers = solution.multipliers.iter();
        let mut held = Vec::new();
        for (row, places) in rows.rows.iter().zip(places) {
            let each: Vec<f64> = multipliers.by_ref().take(places).copied().collect();
            let multiplier = each[0] - each.get(1).copied().unwrap_or(0.0);
            if multiplier.abs() > 1e-6 {
                held.push((row.clone(), multiplier));
            }
        }
        Some(Self { by, rise, held })
    }
}

/// The Hessian of `- sum_k m_k f_k` by differences of its slope, made positive definite where it has to be.
fn curvature(evaluator: &mut Evaluator, gains: &[f64], held: &[(Row, f64)]) -> Vec<f64> {
    let n = gains.len();
    let mut hessian = vec![0.0; n * n];
    if held.is_empty() {
        return hessian;
    }
    let mut conditions: Vec<usize> = held.iter().map(|(row, _)| row.condition()).collect();
    conditions.sort_unstable();
    conditions.dedup();
    let here = lagrangian(evaluator, gains, held, &conditions);
    for i in 0..n {
        let h = 1e-6 * (1.0 + gains[i].abs());
        let mut there = gains.to_vec();
        there[i] += h;
        let after = lagrangian(evaluator, &there, held, &conditions);
        for j in 0..n {
            let second = -(after[j] - here[j]) / h;
            hessian[i * n + j] += 0.5 * second;
            hessian[j * n + i] += 0.5 * second;
        }
    }
    make_convex(&hessian, n)
}

/// The slope of the Lagrangian at `gains`.
fn lagrangian(evaluator: &mut Evaluator, gains: &[f64], held: &[(Row, f64)], conditions: &[usize]) -> Vec<f64> {
    let mut sum = vec![0.0; gains.len()];
    if !evaluator.judge_some(conditions, gains) {
        return sum;
    }
    for (row, multiplier) in held {
        let there = row.again(evaluator, gains);
        there.slope.iter().zip(&mut sum).for_each(|(d, s)| *s += multiplier * d);
    }
    sum
}

/// The nearest positive semidefinite matrix. Where the Lagrangian curves the other way the linear model stands alone, and
/// the trust radius holds the step.
fn make_convex(hessian: &[f64], n: usize) -> Vec<f64> {
    if hessian.iter().any(|h| !h.is_finite()) {
        return vec![0.0; n * n];
    }
    let Some(eigen) = SymmetricEigen::try_new(DMatrix::from_row_slice(n, n, hessian), f64::EPSILON, 1000) else {
        return vec![0.0; n * n];
    };
    let mut made = vec![0.0; n * n];
    for (value, vector) in
        eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()).filter(|(value, _)| **value > 0.0)
    {
        for i in 0..n {
            for j in 0..n {
                made[i * n + j] += value * vector[i] * vector[j];
            }
        }
    }
    made
}

/// How far gains are from a local optimum.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Stationarity {
    /// The norm of the smallest convex combination of the slopes of all values near the worst, less what bounds and other
    /// constraints hold: the rate, to first order, at which the worst value can still be raised. 0 at a local optimum.
    pub norm: f64,
    /// How near the worst a value counts.
    pub within: f64,
    /// How many values that is; a pair of merging poles counts as one.
    pub active: usize,
    /// How many pairs of poles are about to merge.
    pub merging: usize,
    /// How many gains and corners are held by their bound.
    pub at_bound: usize,
}

/// The certificate of local optimality for `gains` over the conditions of `evaluator`.
pub(crate) fn stationarity(evaluator: &mut Evaluator, gains: &[f64], within: f64, merge: f64) -> Stationarity {
    let n = gains.len();
    evaluator.evaluate(gains);
    let held: Vec<bool> = gains.iter().zip(&evaluator.reach).map(|(x, most)| x.abs() >= most * (1.0 - 1e-9)).collect();
    let rows = Rows::within(evaluator, gains, within, merge);
    // Columns: slopes of values, whose weights sum to 1; and normals of constraints, of any weight.
    let mut hull: Vec<Vec<f64>> = Vec::new();
    let mut cone: Vec<Vec<f64>> = Vec::new();
    for row in &rows.rows {
        let negative = || row.slope.iter().map(|s| -s).collect();
        match row.kind {
            Kind::Worth => hull.push(row.slope.clone()),
            // What does not bind yet does not hold anything.
            Kind::AtLeastZero if row.value > row.slack => {}
            Kind::AtLeastZero => cone.push(row.slope.clone()),
            Kind::Zero => cone.extend([row.slope.clone(), negative()]),
        }
    }
    for (i, gain) in gains.iter().enumerate().filter(|(i, _)| held[*i]) {
        let mut normal = vec![0.0; n];
        normal[i] = -gain.signum();
        cone.push(normal);
    }
    let norm = least_norm(&hull, &cone);
    Stationarity {
        norm,
        within,
        active: rows.rows.iter().filter(|row| row.kind == Kind::Worth).count(),
        merging: rows.rows.iter().filter(|row| row.kind == Kind::Zero).count(),
        at_bound: held.iter().filter(|held| **held).count(),
    }
}
