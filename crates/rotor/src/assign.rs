//! Eigenvalue assignment (chapter III): the cancelling law for one mass, and full-state feedback for any rotor.
//!
//! One radially symmetric bearing is one complex input, so the gains that place all `2n` poles are unique. They are
//! found by the Schur method (Varga 1981): `A` is brought to triangular form by a unitary transformation, the pole in its
//! last corner is moved to where it is wanted by feedback of that one coordinate alone, then it is swapped to the front
//! and the next takes its place. Every step is a unitary transformation or a division by how strongly the bearing drives
//! that mode, so an uncontrollable mode shows as a division by zero, by name. Ackermann's formula, with powers of `A`, is
//! useless from n = 4 or so. The result is polished with the first-order change of each pole, and checked.

use nalgebra::{DMatrix, DVector, RowDVector, Schur};

use crate::family::whirl_of;
use crate::influence::{Influence, PBH_LIMIT, influence};
use crate::{C64, ClosedLoop, Feedback, Gain, GainKind, PoleError, Rotor, Signal, Whirl, eigenvalues};

/// The report's cancelling law (3.40)-(3.44) with reference speed `reference`: `kc = zeta (R0 - R)`. The poles stay where
/// they are at `R = R0` without control, at every speed. For one mass; `None` for more, where no such law exists.
#[must_use]
pub fn cancelling(rotor: &Rotor, reference: f64) -> Option<Feedback> {
    let [mass] = rotor.masses() else { return None };
    let mut signal = Signal::at_mass(0, 1, [0.0; 4]);
    // `0.0 -` gives 0 and not -0 for a rotor without damping.
    *signal.gain_mut(GainKind::Kc) = Gain::Linear { at_zero: mass.damping * reference, slope: 0.0 - mass.damping };
    Some(Feedback::new(0, vec![signal]))
}

/// Full-state feedback that gives the rotor chosen poles at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// The feedback: a sensor at every mass, constant gains.
    pub feedback: Feedback,
    /// Each wanted pole, in the order asked for, with the pole that the closed loop has nearest to it.
    pub poles: Vec<(C64, C64)>,
}

impl Assignment {
    /// The largest distance of an achieved pole from the wanted one.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.poles.iter().map(|(wanted, achieved)| (wanted - achieved).norm()).fold(0.0, f64::max)
    }
}

/// A pole is missed that comes out further from where it is wanted than this share of the largest one wanted.
const MISSED: f64 = 1e-4;

/// Why poles cannot be assigned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssignError {
    /// A rotor that is no chain.
    #[error("poles are assigned to chains of masses, every one of which is measured: this rotor is of shaft elements")]
    Chain,
    /// The bearing is on a mass that does not exist.
    #[error("bearing at mass {found}, but the rotor has masses 1 to {masses}")]
    Bearing {
        /// The mass asked for, counted from 1.
        found: usize,
        /// How many there are.
        masses: usize,
    },
    /// The number of poles is not the number of modes.
    #[error("a rotor of {masses} masses has {} poles to assign, found {found}", 2 * masses)]
    Count {
        /// How many masses there are.
        masses: usize,
        /// How many poles were given.
        found: usize,
    },
    /// A wanted pole is not finite.
    #[error("pole {0} is not finite")]
    NotFinite(usize),
    /// The bearing does not move a mode.
    #[error(
        "not controllable: a bearing at mass {bearing} does not move the {whirl} mode at {:.6} {:+.6} j of shape ({shape}); \
         try a bearing at another mass", pole.re, pole.im
    )]
    NotControllable {
        /// The mass that carries the bearing, counted from 1.
        bearing: usize,
        /// The pole that stays where it is.
        pole: C64,
        /// The sense of whirl of its mode.
        whirl: Whirl,
        /// Its shape, mass by mass, to three decimals.
        shape: String,
    },
    /// The gains found do not place the poles: rounding decides where such a loop has them.
    #[error(
        "the poles cannot be placed: with the gains found, {:.6} {:+.6} j comes out off by {off:.1e}; ask for poles nearer \
         to those without control, or for a bearing at another mass", wanted.re, wanted.im
    )]
    Missed {
        /// The pole that is missed by most.
        wanted: C64,
        /// By how much.
        off: f64,
    },
    /// The poles cannot be computed.
    #[error(transparent)]
    Poles(#[from] PoleError),
}

/// Gains that give `rotor` the poles `wanted` at `speed`, through a control bearing at mass `bearing` (counted from 0)
/// with displacement and velocity of every mass measured.
///
/// The answer carries the poles it really achieves, computed anew from its gains: with many masses and far-off poles the
/// gains grow and the poles become sensitive, as they would on the machine. What is not within a ten-thousandth of the
/// largest pole of where it is wanted is refused.
///
/// # Errors
/// A wrong number of poles, one that is not finite, no such mass, a mode that the bearing does not move, or poles that
/// are missed.
pub fn assign_poles(rotor: &Rotor, speed: f64, bearing: usize, wanted: &[C64]) -> Result<Assignment, AssignError> {
    if !rotor.is_chain() {
        return Err(AssignError::Chain);
    }
    let n = rotor.len();
    if bearing >= n {
        return Err(AssignError::Bearing { found: bearing + 1, masses: n });
    }
    if wanted.len() != 2 * n {
        return Err(AssignError::Count { masses: n, found: wanted.len() });
    }
    if let Some(at) = wanted.iter().position(|s| !(s.re.is_finite() && s.im.is_finite())) {
        return Err(AssignError::NotFinite(at + 1));
    }
    let off = Feedback::new(bearing, vec![Signal::at_mass(bearing, n, [0.0; 4])]);
    let table = influence(&ClosedLoop::new(rotor, &off, speed, &[]))?;
    if let Some(stuck) = table.iter().find(|mode| mode.pbh[bearing] < PBH_LIMIT) {
        return Err(not_controllable(stuck, bearing));
    }
    let a = ClosedLoop::new(rotor, &off, speed, &[]).state_matrix();
    let mut b = DVector::zeros(2 * n);
    b[n + bearing] = C64::ONE;
    let mut row = schur_method(&a, &b, wanted)?;
    let mut achieved = matched(&a, &b, &row, wanted)?;
    for _ in 0..3 {
        let Some(better) = corrected(&a, &b, &row, wanted, &achieved) else { break };
        let Ok(now) = matched(&a, &b, &better, wanted) else { break };
        if distance(wanted, &now) >= distance(wanted, &achieved) {
            break;
        }
        (row, achieved) = (better, now);
    }
    let feedback = full_state(bearing, n, row.as_slice());
    // Of the very gains that are handed out, closed the way every other command closes them.
    let closed = ClosedLoop::new(rotor, &feedback, speed, &[]).state_matrix();
    let achieved = nearest(&eigenvalues(closed).map_err(PoleError::from)?, wanted);
    let size = wanted.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let off = |(wanted, achieved): (&C64, &C64)| ((wanted - achieved).norm(), *wanted);
    let (off, worst) =
        wanted.iter().zip(&achieved).map(off).fold((0.0, C64::ZERO), |a, b| if b.0 > a.0 { b } else { a });
    if achieved.len() != wanted.len() || off.is_nan() || off > MISSED * size {
        return Err(AssignError::Missed { wanted: worst, off });
    }
    Ok(Assignment { feedback, poles: wanted.iter().copied().zip(achieved).collect() })
}

fn not_controllable(mode: &Influence, bearing: usize) -> AssignError {
    let number = |x: f64| format!("{:.3}", if x.abs() < 5e-4 { 0.0 } else { x });
    let part = |p: &C64| {
        let im = number(p.im);
        if im == "0.000" {
            number(p.re)
        } else {
            format!("{} {}{} j", number(p.re), if p.im < 0.0 { "" } else { "+" }, im)
        }
    };
    let shape: Vec<String> = mode.shape.iter().map(part).collect();
    AssignError::NotControllable {
        bearing: bearing + 1,
        pole: mode.pole,
        whirl: whirl_of(mode.pole),
        shape: shape.join(", "),
    }
}

/// `u = -f x` as individual feedback: `f_k = kd - j kc` on displacement k, `f_{n+k} = cd - j cc` on its velocity.
fn full_state(bearing: usize, n: usize, f: &[C64]) -> Feedback {
    let signal = |k: usize| Signal::at_mass(k, n, [f[k].re, f[n + k].re, 0.0 - f[k].im, 0.0 - f[n + k].im]);
    Feedback::new(bearing, (0..n).map(signal).collect())
}

/// The row `f` for which `A - b f` has the eigenvalues `wanted`.
fn schur_method(a: &DMatrix<C64>, b: &DVector<C64>, wanted: &[C64]) -> Result<RowDVector<C64>, PoleError> {
    let size = a.nrows();
    let schur =
        Schur::try_new(a.clone(), f64::EPSILON, 100 * size).ok_or(linear::EigenvalueError::NoConvergence(size))?;
    let (mut u, mut t) = schur.unpack();
    let mut input = u.adjoint() * b;
    let mut row = RowDVector::<C64>::zeros(size);
    let mut left: Vec<C64> = wanted.to_vec();
    for done in 0..size {
        let last = size - 1;
        // Each pole goes to the nearest place that is still free: small moves, small gains.
        let present = t[(last, last)];
        let nearest =
            (0..left.len()).min_by(|&i, &j| (left[i] - present).norm().total_cmp(&(left[j] - present).norm()));
        let target = left.swap_remove(nearest.unwrap_or(0));
        let gain = (present - target) / input[last];
        row += u.column(last).adjoint() * gain;
        for i in 0..size {
            t[(i, last)] -= input[i] * gain;
        }
        t[(last, last)] = target;
        for upper in (done..last).rev() {
            swap(&mut t, &mut u, &mut input, upper);
        }
    }
    Ok(row)
}

/// Exchanges the diagonal entries `k` and `k + 1` of the triangle by a plane rotation.
fn swap(t: &mut DMatrix<C64>, u: &mut DMatrix<C64>, input: &mut DVector<C64>, k: usize) {
    let size = t.nrows();
    let (first, second, above) = (t[(k, k)], t[(k + 1, k + 1)], t[(k, k + 1)]);
    // The eigenvector of the second within the pair is (above, second - first): it becomes the first basis vector.
    let (x, y) = (above, second - first);
    let norm = (x.norm_sqr() + y.norm_sqr()).sqrt();
    if norm == 0.0 {
        return;
    }
    let (c, s) = (x / norm, y / norm);
    for j in 0..size {
        let (p, q) = (t[(k, j)], t[(k + 1, j)]);
        t[(k, j)] = c.conj() * p + s.conj() * q;
        t[(k + 1, j)] = c * q - s * p;
    }
    for matrix in [&mut *t, u] {
        for i in 0..size {
            let (p, q) = (matrix[(i, k)], matrix[(i, k + 1)]);
            matrix[(i, k)] = p * c + q * s;
            matrix[(i, k + 1)] = q * c.conj() - p * s.conj();
        }
    }
    let (p, q) = (input[k], input[k + 1]);
    (input[k], input[k + 1]) = (c.conj() * p + s.conj() * q, c * q - s * p);
    (t[(k, k)], t[(k + 1, k + 1)], t[(k + 1, k)]) = (second, first, C64::ZERO);
}

/// The eigenvalues of `A - b f`, each beside the wanted one it is nearest to: the closest pair first.
fn matched(a: &DMatrix<C64>, b: &DVector<C64>, f: &RowDVector<C64>, wanted: &[C64]) -> Result<Vec<C64>, PoleError> {
    Ok(nearest(&eigenvalues(a - b * f)?, wanted))
}

/// These poles, each beside the wanted one it is nearest to: the closest pair first.
fn nearest(poles: &[C64], wanted: &[C64]) -> Vec<C64> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(wanted.len() * poles.len());
    for (i, s) in wanted.iter().enumerate() {
        pairs.extend(poles.iter().enumerate().map(|(j, pole)| ((s - pole).norm(), i, j)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut achieved = vec![None; wanted.len()];
    let mut taken = vec![false; poles.len()];
    for (_, i, j) in pairs {
        if achieved[i].is_none() && !taken[j] {
            (achieved[i], taken[j]) = (Some(poles[j]), true);
        }
    }
    achieved.into_iter().flatten().collect()
}

fn distance(wanted: &[C64], achieved: &[C64]) -> f64 {
    wanted.iter().zip(achieved).map(|(w, a)| (w - a).norm()).fold(0.0, f64::max)
}

/// One Newton step: pole k moves by `-(y_k b)(df x_k)`, and `y_k x_j = [k = j]`, so the rows `y_k` combine to the change
/// of `f` that undoes every error at once. `None` if the poles coincide, where there are no such rows.
fn corrected(
    a: &DMatrix<C64>,
    b: &DVector<C64>,
    f: &RowDVector<C64>,
    wanted: &[C64],
    achieved: &[C64],
) -> Option<RowDVector<C64>> {
    let size = a.nrows();
    let at = (0..size).find(|&i| b[i] != C64::ZERO)?;
    // The closed loop's eigenvector for s is (s - A)^-1 b; the rows are the inverse of all of them together.
    let mut vectors = DMatrix::zeros(size, size);
    for (k, &pole) in achieved.iter().enumerate() {
        let mut shifted = -a.clone();
        (0..size).for_each(|i| shifted[(i, i)] += pole);
        let vector = shifted.lu().solve(b)?;
        let norm = vector.norm();
        if !(norm.is_finite() && norm > 0.0) {
            return None;
        }
        vectors.set_column(k, &(vector / C64::from(norm)));
    }
    let rows = vectors.try_inverse()?;
    let mut better = f.clone();
    for k in 0..size {
        let drive = rows[(k, at)];
        if drive == C64::ZERO {
            return None;
        }
        better += rows.row(k) * ((achieved[k] - wanted[k]) / drive);
    }
    better.iter().all(|g| g.re.is_finite() && g.im.is_finite()).then_some(better)
}
