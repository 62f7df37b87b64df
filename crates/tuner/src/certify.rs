//! How bad it can get over the whole of a continuous family, proven: a branch and bound with Lyapunov's inequality.
//!
//! Poles worth at least `level` fill an intersection of half planes ([`Measure::half_planes`]), and all poles of `A` lie in
//! a half plane if some norm shrinks along it: if `W A V`, in any basis `V` with inverse `W`, has a negative definite
//! Hermitian part (Lyapunov with `P = W* W`). That inequality is linear in `A`, and `A` is linear in each coordinate of a
//! family by itself, so it holds *throughout* a box of conditions as soon as it holds at its corners. The basis is that of
//! the modes in the middle of the box; where it does not do, the box is cut in two.
//!
//! A loop that is more than gains has no such proof: what is told of it is the worst of all conditions looked at.
//!
//! So nothing can hide between points of a grid: the only assumptions are rounding, and that gains are linear in speed
//! within a box, for which boxes are cut at the knots of a table.

use rayon::prelude::*;
use rotor::{C64, MAX_MASSES, Quadratic};

use crate::Problem;
use crate::stop::Stop;
use crate::worst::{Worst, worst_at};

/// The worst over a family, bounded from both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Where the worst was found, in the coordinates of the family's axes.
    pub point: Vec<f64>,
    /// What the worst mode is worth there; exactly 0 for one that is marginal, see [`rotor::Stability`].
    pub value: f64,
    /// The pole of that mode.
    pub pole: C64,
    /// No condition of the family is worse than `value` by more than this.
    pub tolerance: f64,
    /// With a delay: every pole right of this was found there, and counted.
    pub count_right_of: Option<f64>,
    /// Whether that is proven over the whole family; otherwise it is the worst of all conditions looked at.
    pub proven: bool,
    /// How many boxes of conditions were looked at.
    pub boxes: u64,
    /// At how many conditions, spread over the family, the worst was looked for.
    pub checked: u64,
}

impl Certificate {
    /// Whether every mode decays at every condition, by more than rounding; `None` if a mode is marginal, neither one nor
    /// the other.
    #[must_use]
    pub fn stable(&self) -> Option<bool> {
        (!self.marginal()).then_some(self.value > 0.0)
    }

    /// Whether the worst mode is as near the axis as rounding: then nobody can say whether it decays.
    #[must_use]
    pub fn marginal(&self) -> bool {
        self.value == 0.0
    }

    /// Whether the poles could be had at every condition looked at; with a long delay there may be too many to count.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.value > f64::NEG_INFINITY
    }
}

/// Boxes looked at before a proof is given up.
pub(crate) const BUDGET: u64 = 400_000;

/// A box of more coordinates than this has too many corners to prove anything by: what is told is the worst found.
const MOST_AXES: usize = 12;

#[derive(Clone, Debug)]
struct Cell {
    from: Vec<f64>,
    to: Vec<f64>,
}

/// What came of looking at one box.
enum Seen {
    Proven,
    Cut(Cell, Cell),
}

/// What was seen of one box, and what its middle is worth.
struct Look {
    seen: Seen,
    value: f64,
    pole: C64,
    middle: Vec<f64>,
}

/// Bounds the worst over `problem`'s family for `gains`. Starts from the worst already known, at `point`.
pub(crate) fn certify(
    problem: &Problem,
    gains: &[f64],
    point: &[f64],
    tolerance: f64,
    budget: u64,
    stop: &Stop,
) -> Certificate {
    let Worst { value, pole, right_of } = worst_at(problem, gains, point);
    let mut found = Certificate {
        point: point.to_vec(),
        value,
        pole,
        tolerance,
        count_right_of: right_of,
        proven: false,
        boxes: 0,
        checked: 0,
    };
    if !problem.is_ideal() || !value.is_finite() || problem.family.varying().count() > MOST_AXES {
        return found;
    }
    let mut cells = start(problem);
    while !cells.is_empty() {
        if found.boxes + cells.len() as u64 > budget || stop.is_set() {
            return found;
        }
        found.boxes += cells.len() as u64;
        // Never so far that a rotor that holds could not be told from one that does not.
        let slack = if found.value > 0.0 { tolerance.min(0.5 * found.value) } else { tolerance };
        let Some(planes) = problem.measure.half_planes(found.value - slack) else { return found };
        // A box has up to thousands of corners: the flag is looked at for every one of them.
        let seen: Option<Vec<Look>> = cells.par_iter().map(|cell| look(problem, gains, cell, &planes, stop)).collect();
        let Some(seen) = seen else { return found };
        cells.clear();
        for Look { seen, value, pole, middle } in seen {
            if value < found.value {
                (found.value, found.pole, found.point) = (value, pole, middle);
            }
            if let Seen::Cut(a, b) = seen {
                cells.extend([a, b]);
            }
        }
    }
    found.proven = true;
    found
}

/// The whole family, cut at the corners of the schedule.
fn start(problem: &Problem) -> Vec<Cell> {
    let axes = problem.family.axes().len();
    let (from, to): (Vec<f64>, Vec<f64>) = (0..axes).map(|axis| problem.family.ends(axis).into()).unzip();
    let corners =
        problem.structure.schedule().corners().iter().copied().filter(|c| (from[0]..to[0]).contains(c) && *c > from[0]);
    let mut at = from[0];
    let mut cells = Vec::new();
    for corner in corners.chain([to[0]]) {
        let mut cell = Cell { from: from.clone(), to: to.clone() };
        (cell.from[0], cell.to[0]) = (at, corner);
        at = corner;
        cells.push(cell);
    }
    cells
}

/// Looks at one box: what its middle is worth, and whether all of it lies within `planes`.
/// `None` once stopped.
fn look(problem: &Problem, gains: &[f64], cell: &Cell, planes: &[(C64, f64)], stop: &Stop) -> Option<Look> {
    if stop.is_set() {
        return None;
    }
    let middle: Vec<f64> = cell.from.iter().zip(&cell.to).map(|(a, b)| 0.5 * (a + b)).collect();
    let closed = |point: &[f64]| {
        let mut closed = problem.family.open(point);
        closed.control(&problem.structure.row(gains, point[0]));
        closed
    };
    let axes: Vec<usize> = (0..middle.len()).filter(|&i| cell.from[i] < cell.to[i]).collect();
    let widest =
        || axes.iter().copied().max_by(|&a, &b| (cell.to[a] - cell.from[a]).total_cmp(&(cell.to[b] - cell.from[b])));
    let cut = |axis: Option<usize>| {
        let Some(axis) = axis.or_else(widest) else { return Seen::Proven };
        let (mut low, mut high) = (cell.clone(), cell.clone());
        low.to[axis] = middle[axis];
        high.from[axis] = middle[axis];
        Seen::Cut(low, high)
    };
    let told = |seen, value, pole| Look { seen, value, pole, middle: middle.clone() };
    let centre = closed(&middle);
    let Ok(poles) = centre.poles() else { return Some(told(cut(None), f64::NEG_INFINITY, C64::ZERO)) };
    let mut settled = poles.clone();
    centre.settle(&mut settled);
    let (value, pole) = problem.worst(&settled);
    let Some(basis) = Basis::of(&centre, &poles) else { return Some(told(cut(None), value, pole)) };
    // Every corner; the first bit is the first axis that varies.
    let corner = |bits: usize| {
        let mut point = cell.from.clone();
        for (bit, &axis) in axes.iter().enumerate() {
            if bits >> bit & 1 == 1 {
                point[axis] = cell.to[axis];
            }
        }
        basis.of_matrix(&closed(&point))
    };
    let corners: Vec<Vec<C64>> =
        (0..1 << axes.len()).map(|bits| (!stop.is_set()).then(|| corner(bits))).collect::<Option<_>>()?;
    let size = poles.len();
    let inside = corners.iter().all(|m| planes.iter().all(|plane| is_inside(m, size, *plane)));
    if inside {
        return Some(told(Seen::Proven, value, pole));
    }
    // The axis along which the matrix changes most.
    let change =
        |bit: usize| -> f64 { corners[0].iter().zip(&corners[1 << bit]).map(|(a, b)| (a - b).norm_sqr()).sum() };
    let axis = (0..axes.len()).max_by(|&a, &b| change(a).total_cmp(&change(b))).map(|bit| axes[bit]);
    Some(told(cut(axis), value, pole))
}

/// The modes of a system as coordinates.
struct Basis {
    size: usize,
    poles: Vec<C64>,
    /// Shapes `p`, one a mode, scaled.
    right: Vec<C64>,
    /// Rows `q`, one a mode, scaled inversely.
    left: Vec<C64>,
    /// `q (lambda I - D)`: the other half of a left eigenvector.
    first: Vec<C64>,
}

impl Basis {
    /// `None` where modes coincide, so that there is no such basis.
    fn of(closed: &Quadratic, poles: &[C64]) -> Option<Self> {
        let n = closed.masses();
        let size = 2 * n;
        let mut made = Self {
            size,
            poles: poles.to_vec(),
            right: vec![C64::ZERO; size * n],
            left: vec![C64::ZERO; size * n],
            first: vec![C64::ZERO; size * n],
        };
        let mut moved = [C64::ZERO; MAX_MASSES];
        for (k, &pole) in poles.iter().enumerate() {
            let own = k * n..(k + 1) * n;
            let (right, left) = (&mut made.right[own.clone()], &mut made.left[own.clone()]);
            closed.vectors(pole, right, left);
            closed.row_times_damping(left, &mut moved[..n]);
            let product: C64 = (0..n).map(|i| (left[i] * (pole * 2.0) - moved[i]) * right[i]).sum();
            if product.norm() < 1e-13 {
                return None;
            }
            let first = &mut made.first[own];
            for i in 0..n {
                first[i] = left[i] * pole - moved[i];
            }
            // Left and right of equal length, their product 1: a change of the matrix then shows as evenly as can be.
            let squares = |v: &[C64]| v.iter().map(C64::norm_sqr).sum::<f64>();
            let longer = ((squares(left) + squares(first)) / (squares(right) * (1.0 + pole.norm_sqr()))).sqrt().sqrt();
            let scale = longer / product.norm().sqrt();
            let turn = product / product.norm();
            right.iter_mut().for_each(|z| *z *= scale);
            let by = (turn * product.norm() * scale).inv();
            left.iter_mut().chain(first).for_each(|z| *z *= by);
        }
        Some(made)
    }

    /// `W A V` for the state matrix of another system.
    fn of_matrix(&self, closed: &Quadratic) -> Vec<C64> {
        let n = closed.masses();
        let mut made = vec![C64::ZERO; self.size * self.size];
        let mut pushed = [C64::ZERO; MAX_MASSES];
        for (j, (right, &pole)) in self.right.chunks_exact(n).zip(&self.poles).enumerate() {
            for (i, pushed) in pushed[..n].iter_mut().enumerate() {
                let line = i * n..(i + 1) * n;
                let (k, d) = (&closed.stiffness()[line.clone()], &closed.damping()[line]);
                *pushed = k.iter().zip(d).zip(right).map(|((k, d), p)| (k + d * pole) * p).sum();
            }
            for (i, (left, first)) in self.left.chunks_exact(n).zip(self.first.chunks_exact(n)).enumerate() {
                let moves: C64 = first.iter().zip(right).map(|(f, p)| f * p).sum();
                let pushes: C64 = left.iter().zip(&pushed).map(|(q, a)| q * a).sum();
                made[i * self.size + j] = moves * pole + pushes;
            }
        }
        made
    }
}

/// Whether `turn (M + shift)` has a negative definite Hermitian part, by Cholesky's factorisation of its negative.
fn is_inside(matrix: &[C64], size: usize, (turn, shift): (C64, f64)) -> bool {
    let mut work = [C64::ZERO; 4 * MAX_MASSES * MAX_MASSES];
    for i in 0..size {
        for j in 0..=i {
            let shift = if i == j { C64::from(shift) } else { C64::ZERO };
            let (a, b) = (turn * (matrix[i * size + j] + shift), turn * (matrix[j * size + i] + shift));
            work[i * size + j] = -(a + b.conj());
        }
    }
    for j in 0..size {
        let known: f64 = (0..j).map(|k| work[j * size + k].norm_sqr()).sum();
        let pivot = work[j * size + j].re - known;
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let root = pivot.sqrt();
        work[j * size + j] = C64::from(root);
        for i in j + 1..size {
            let known: C64 = (0..j).map(|k| work[i * size + k] * work[j * size + k].conj()).sum();
            work[i * size + j] = (work[i * size + j] - known) / root;
        }
    }
    true
}
