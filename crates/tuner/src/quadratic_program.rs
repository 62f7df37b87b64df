//! Small convex quadratic programs: `min 1/2 z' Q z + c' z` subject to `A z <= b`.
//!
//! The subproblem of [`crate::minimax`]: a handful of variables, up to a few hundred inequalities. A primal-dual interior
//! point method (Mehrotra 1992; Nocedal & Wright, *Numerical Optimization*, ch. 16.6), dense and allocating little,
//! because thousands are solved in a search.

/// A program in `size` variables.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    size: usize,
    /// `Q`, row by row, symmetric and positive semidefinite.
    pub(crate) hessian: Vec<f64>,
    /// `c`.
    pub(crate) linear: Vec<f64>,
    rows: Vec<f64>,
    limits: Vec<f64>,
}

/// Where a program has its minimum.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    /// `z`.
    pub(crate) point: Vec<f64>,
    /// A multiplier for every inequality, at least 0, in their order.
    pub(crate) multipliers: Vec<f64>,
}

const ITERATIONS: usize = 60;
/// Residuals and gap, relative to the data, at which it is done.
const DONE: [f64; 2] = [1e-11, 1e-13];
/// What is still good for a search, which tries the step it gets: rounding may end it there.
const GOOD: [f64; 2] = [1e-7, 1e-8];
/// Once it is good, so many steps that bring nothing more are enough; before that the gap may grow for a while, as where the way leads along
/// a limit that does not bind in the end.
const PATIENCE: usize = 6;

impl Program {
    /// A program without inequalities, `Q` and `c` zero.
    pub(crate) fn new(size: usize) -> Self {
        Self { size, hessian: vec![0.0; size * size], linear: vec![0.0; size], rows: Vec::new(), limits: Vec::new() }
    }

    /// Adds `row z <= limit`; `fill` writes the row, which comes as zeros.
    pub(crate) fn at_most(&mut self, limit: f64, fill: impl FnOnce(&mut [f64])) {
        let at = self.rows.len();
        self.rows.resize(at + self.size, 0.0);
        fill(&mut self.rows[at..]);
        self.limits.push(limit);
    }

    /// Solves it to about ten digits. `None` if it does not come to that: no feasible point, or no least one.
    pub(crate) fn solve(&self) -> Option<Solution> {
        let (n, m) = (self.size, self.limits.len());
        let mut z = vec![0.0; n];
        // Slacks and multipliers of 1 at least, whatever the start violates.
        let mut slack: Vec<f64> = self.limits.iter().map(|limit| limit.max(1.0)).collect();
        let mut dual = vec![1.0; m];
        let scale = 1.0 + self.linear.iter().chain(&self.limits).fold(0.0, |a: f64, b| a.max(b.abs()));
        let mut matrix = vec![0.0; n * n];
        let (mut right, mut direction) = (vec![0.0; n], vec![0.0; n]);
        let (mut residual, mut violation) = (vec![0.0; n], vec![0.0; m]);
        let (mut d_slack, mut d_dual, mut target) = (vec![0.0; m], vec![0.0; m], vec![0.0; m]);
        // The best so far: with the gap all but closed, what rounding has left of the matrix can spoil what was there.
        let mut best = ([f64::INFINITY; 2], z.clone(), dual.clone(), 0);
        let is_good = |reached: [f64; 2]| reached[0] < GOOD[0] && reached[1] < GOOD[1];
        for iteration in 0..=ITERATIONS {
            self.residuals(&z, &slack, &dual, &mut residual, &mut violation);
            let gap = dot(&slack, &dual) / m.max(1) as f64;
            let worst = residual.iter().chain(&violation).fold(0.0, |a: f64, b| a.max(b.abs()));
            let reached = [worst / scale, gap / scale];
            let short = |of: [f64; 2]| (of[0] / DONE[0]).max(of[1] / DONE[1]);
            if short(reached) < short(best.0) {
                best = (reached, z.clone(), dual.clone(), iteration);
            }
            let brings_no_more = is_good(best.0) && iteration - best.3 > PATIENCE;
            let is_done = short(reached) < 1.0 || iteration == ITERATIONS || brings_no_more;
            if is_done || !reached.iter().all(|part| part.is_finite()) {
                break;
            }
            // (Q + A' diag(dual / slack) A) dz = ...
            matrix.copy_from_slice(&self.hessian);
            for (row, (dual, slack)) in self.rows.chunks_exact(n).zip(dual.iter().zip(&slack)) {
                let weight = dual / slack;
                for i in 0..n {
                    let by = weight * row[i];
                    if by != 0.0 {
                        for j in 0..=i {
                            matrix[i * n + j] += by * row[j];
                        }
                    }
                }
            }
            if !cholesky(&mut matrix, n) {
                break;
            }
            let mut newton = |target: &[f64], d_slack: &mut [f64], d_dual: &mut [f64], direction: &mut [f64]| {
                for (r, residual) in right.iter_mut().zip(&residual) {
                    *r = -residual;
                }
                for (k, row) in self.rows.chunks_exact(n).enumerate() {
                    let by = (dual[k] * violation[k] - target[k]) / slack[k];
                    row.iter().zip(&mut right).for_each(|(a, r)| *r -= by * a);
                }
                direction.copy_from_slice(&right);
                substitute(&matrix, direction, n);
                for (k, row) in self.rows.chunks_exact(n).enumerate() {
                    d_slack[k] = -violation[k] - dot(row, direction);
                    d_dual[k] = -(target[k] + dual[k] * d_slack[k]) / slack[k];
                }
            };
            // Predictor: straight at the solution.
            (0..m).for_each(|k| target[k] = slack[k] * dual[k]);
            newton(&target, &mut d_slack, &mut d_dual, &mut direction);
            let (a, b) = (reach(&slack, &d_slack, 1.0), reach(&dual, &d_dual, 1.0));
            let after: f64 =
                (0..m).map(|k| (slack[k] + a * d_slack[k]) * (dual[k] + b * d_dual[k])).sum::<f64>() / m.max(1) as f64;
            let centring = (after / gap).powi(3);
            // Corrector: with the curvature that the predictor showed.
            (0..m).for_each(|k| target[k] = slack[k] * dual[k] + d_slack[k] * d_dual[k] - centring * gap);
            newton(&target, &mut d_slack, &mut d_dual, &mut direction);
            let step = reach(&slack, &d_slack, 0.995).min(reach(&dual, &d_dual, 0.995));
            let add = |to: &mut [f64], by: &[f64]| to.iter_mut().zip(by).for_each(|(a, b)| *a += step * b);
            add(&mut z, &direction);
            add(&mut slack, &d_slack);
            add(&mut dual, &d_dual);
        }
        let (reached, point, multipliers, _) = best;
        is_good(reached).then_some(Solution { point, multipliers })
    }

    /// `Q z + c + A' dual` and `A z + slack - b`.
    fn residuals(&self, z: &[f64], slack: &[f64], dual: &[f64], residual: &mut [f64], violation: &mut [f64]) {
        let n = self.size;
        for (i, r) in residual.iter_mut().enumerate() {
            *r = self.linear[i] + dot(&self.hessian[i * n..(i + 1) * n], z);
        }
        for (k, row) in self.rows.chunks_exact(n).enumerate() {
            violation[k] = dot(row, z) + slack[k] - self.limits[k];
            row.iter().zip(&mut *residual).for_each(|(a, r)| *r += dual[k] * a);
        }
    }
}

/// The largest step, at most 1, that leaves `part` of the way to zero.
fn reach(from: &[f64], by: &[f64], part: f64) -> f64 {
    from.iter().zip(by).filter(|(_, by)| **by < 0.0).fold(1.0, |step: f64, (from, by)| step.min(-part * from / by))
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `L` of a symmetric positive definite matrix, in place of its lower triangle. Pivots lost in rounding are raised a little.
pub(crate) fn cholesky(matrix: &mut [f64], n: usize) -> bool {
    let largest = (0..n).map(|i| matrix[i * n + i]).fold(0.0, f64::max);
    for j in 0..n {
        let mut pivot = matrix[j * n + j] - dot(&matrix[j * n..j * n + j], &matrix[j * n..j * n + j]);
        if !pivot.is_finite() {
            return false;
        }
        if pivot <= 1e-15 * largest {
            pivot = (1e-15 * largest).max(f64::MIN_POSITIVE);
        }
        let pivot = pivot.sqrt();
        matrix[j * n + j] = pivot;
        for i in j + 1..n {
            let (upper, lower) = matrix.split_at_mut(i * n);
            lower[j] = (lower[j] - dot(&lower[..j], &upper[j * n..j * n + j])) / pivot;
        }
    }
    true
}

/// Solves with a factor of [`cholesky`], in place.
pub(crate) fn substitute(factor: &[f64], x: &mut [f64], n: usize) {
    for i in 0..n {
        x[i] = (x[i] - dot(&factor[i * n..i * n + i], &x[..i])) / factor[i * n + i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k * n + i] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::SupportedConeT::NonnegativeConeT;
    use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus};
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    fn objective(program: &Program, z: &[f64]) -> f64 {
        let bent: Vec<f64> = program.hessian.chunks_exact(program.size).map(|row| dot(row, z)).collect();
        0.5 * dot(&bent, z) + dot(&program.linear, z)
    }

    /// The least value by Clarabel, an interior point solver of its own.
    fn clarabels(program: &Program) -> f64 {
        let matrix =
            |rows: &[f64]| CscMatrix::from(&rows.chunks_exact(program.size).map(<[f64]>::to_vec).collect::<Vec<_>>());
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-12)
            .tol_gap_rel(1e-12)
            .tol_feas(1e-12)
            .build()
            .expect("settings in range");
        let cones = [NonnegativeConeT(program.limits.len())];
        let (quadratic, rows) = (matrix(&program.hessian).to_triu(), matrix(&program.rows));
        let mut solver = DefaultSolver::new(&quadratic, &program.linear, &rows, &program.limits, &cones, settings)
            .expect("sizes that fit");
        solver.solve();
        let status = solver.solution.status;
        assert!(matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved), "{status:?}");
        solver.solution.obj_val
    }

    /// Programs in a box, with a point that keeps every limit: curvature of any rank, down to none; rows that are zero, that
    /// come twice, and that all but pass through the point: what has no inside is not asked of the search.
    fn programs() -> impl Strategy<Value = Program> {
        (1usize..=6).prop_flat_map(|n| {
            let factor = (0..=n).prop_flat_map(move |rank| vec(vec(-1.0..1.0, n), rank));
            let row = prop_oneof![8 => vec(-1.0..1.0, n), 1 => Just(vec![0.0; n])];
            let rows = vec((row, prop_oneof![1 => Just(1e-8), 2 => 1e-6..1.0, 1 => 1e-8..1e-6], 1usize..=2), 0..=20);
            (factor, vec(-1.0..1.0, n), vec(-0.9..0.9, n), rows).prop_map(move |(factor, linear, inside, rows)| {
                let mut program = Program::new(n);
                for row in &factor {
                    for i in 0..n {
                        (0..n).for_each(|j| program.hessian[i * n + j] += row[i] * row[j]);
                    }
                }
                program.linear = linear;
                for i in 0..n {
                    program.at_most(1.0, |line| line[i] = 1.0);
                    program.at_most(1.0, |line| line[i] = -1.0);
                }
                for (row, slack, times) in &rows {
                    for _ in 0..*times {
                        program.at_most(dot(row, &inside) + slack, |line| line.copy_from_slice(row));
                    }
                }
                program
            })
        })
    }

    proptest! {
        #[test]
        fn val_the_least_value_is_clarabels(program in programs()) {
            let ours = program.solve().expect("feasible and bounded");
            for (row, limit) in program.rows.chunks_exact(program.size).zip(&program.limits) {
                prop_assert!(dot(row, &ours.point) <= limit + 1e-8);
            }
            let (least, theirs) = (objective(&program, &ours.point), clarabels(&program));
            // Rows with hardly any slack and a Hessian of low rank leave the last digits open; a direction of descent needs fewer.
            prop_assert!((least - theirs).abs() <= 1e-6 * (1.0 + theirs.abs()), "{least} is not {theirs}");
        }
    }
}
