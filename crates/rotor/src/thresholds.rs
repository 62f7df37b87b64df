//! Threshold speeds: every speed at which a mode gains or loses stability.
//!
//! A mode is on its threshold when `A(R)` has an eigenvalue `j w`, and then the Lyapunov operator
//! `X -> A(R) X + X A(R)*` on Hermitian matrices is singular. Where `A` is linear in speed so is that operator: all speeds
//! at which it is singular are eigenvalues of one real pencil of order `(2n)^2`, found at once and wherever they hide.
//! They divide the range into parts on which no mode can change sign, and the walk along the branches
//! (`crossing.rs`) stops between any two of them: it says which mode crosses which way, and refines the speed. For long
//! rotors that pencil is too large (1024 for n = 16), and the walk stands alone with its own step control.

use nalgebra::{DMatrix, Schur};

use crate::crossing::{Quantity, crossings};
use crate::family::{Piece, pieces, whirl_of};
use crate::follow::TraceError;
use crate::{C64, Feedback, Rotor, Stability, Whirl};

/// Rotors with at most this many masses get the certificate: 64 unknowns, a few milliseconds.
const CERTIFIED: usize = 4;

/// A speed at which a mode changes stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Spin speed `R`, to better than 1e-9.
    pub speed: f64,
    /// Whirl frequency `|Im lambda|` there.
    pub frequency: f64,
    /// The mode's sense of whirl.
    pub whirl: Whirl,
    /// What the mode is above this speed: stable or unstable.
    pub becomes: Stability,
}

/// Every change of stability over `from..=to`, rising in speed; two modes that cross at one speed are two thresholds.
///
/// A threshold is a speed at which the real part of a mode leaves zero, as speed rises, for a side other than the one that
/// it came from. A mode that has rested on zero (within rounding, see [`crate::Stability`]) over a range of speeds came from
/// neither, so that the end of such a range is a threshold whichever way the mode goes; so is rest, `R = 0`, for a mode
/// that is on zero there and leaves it. A mode that touches zero, comes to it and stays, or is on it at every speed, has no
/// threshold there. The range asked for has no say in this; both its ends belong to it.
///
/// # Errors
/// Speeds that are not finite or do not rise, an eigenvalue iteration that does not converge, or modes that cannot be told
/// apart.
pub fn thresholds(rotor: &Rotor, feedback: &Feedback, from: f64, to: f64) -> Result<Vec<Threshold>, TraceError> {
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(TraceError::Speeds);
    }
    let beyond = |from, to| pieces(rotor, feedback, from, to).pop();
    let pieces = pieces(rotor, feedback, from, to);
    let cuts: Vec<f64> =
        if rotor.len() <= CERTIFIED { pieces.iter().flat_map(between_crossings).collect() } else { vec![] };
    let mut found: Vec<Threshold> = crossings(&pieces, &cuts, &beyond, Quantity::Growth)?
        .into_iter()
        .map(|c| Threshold {
            speed: c.speed,
            frequency: c.pole.im.abs(),
            whirl: whirl_of(c.pole),
            becomes: if c.rising { Stability::Unstable } else { Stability::Stable },
        })
        .collect();
    found.sort_by(|a, b| a.speed.total_cmp(&b.speed).then_with(|| a.frequency.total_cmp(&b.frequency)));
    Ok(found)
}

/// Speeds that separate, on this piece, all those at which the Lyapunov operator is singular. None if it always is, as for
/// an undamped mode, or if its eigenvalues do not converge: the walk then does without.
fn between_crossings(piece: &Piece) -> Vec<f64> {
    let Some(mut speeds) = singular_speeds(piece) else { return Vec::new() };
    speeds.retain(|speed| piece.from <= *speed && *speed <= piece.to);
    speeds.sort_by(f64::total_cmp);
    speeds.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
}

/// Real eigenvalues `R` of the pencil `L(A0) + (R - from) L(A1)`, with `L` the Lyapunov operator.
fn singular_speeds(piece: &Piece) -> Option<Vec<f64>> {
    let (base, slope) = piece.state_rows();
    let width = piece.to - piece.from;
    // Shift and invert: with t = R - shift, L(shift) x = -t L(A1) x. A shift inside the range keeps what matters large; an
    // irrational one is not itself singular by symmetry.
    let shift = 0.381_966_011_25 * width;
    let at_shift: Vec<C64> = base.iter().zip(&slope).map(|(a, b)| a + b * shift).collect();
    let size = (base.len() as f64).sqrt() as usize;
    let factors = lyapunov(&at_shift, size).lu();
    let pivots = factors.u().diagonal().map(f64::abs);
    if pivots.min() < 1e-12 * pivots.max() {
        return None;
    }
    let inverse_times = factors.solve(&lyapunov(&slope, size))?;
    if !inverse_times.iter().all(|x| x.is_finite()) {
        return None;
    }
    // Real, so nalgebra's: 167 us for the 36 rows of three masses, where ours for complex matrices takes 234.
    let bound = 100 * inverse_times.nrows();
    let eigenvalues = Schur::try_new(inverse_times, f64::EPSILON, bound)?.complex_eigenvalues();
    // The double root of a mode that only just crosses may have split into a pair off the axis by the root of the rounding.
    let speeds = eigenvalues
        .iter()
        .filter(|m| m.norm() > 1e-14)
        .map(|m| -m.inv())
        .filter(|t| t.im.abs() <= 1e-3 * (1.0 + t.re.abs()))
        .map(|t| piece.from + shift + t.re)
        .collect();
    Some(speeds)
}

/// The matrix of `X -> A X + X A*` on Hermitian `X`, in the basis of diagonal units, and of sums and differences of each
/// pair of units off the diagonal.
fn lyapunov(rows: &[C64], size: usize) -> DMatrix<f64> {
    let order = size * size;
    let mut matrix = DMatrix::zeros(order, order);
    // Where the real and imaginary part of entry (i, k), i <= k, stand.
    let place = |i: usize, k: usize| {
        let pair = i * size - i * (i + 1) / 2 + k - i - 1;
        (size + 2 * pair, size + 2 * pair + 1)
    };
    let mut basis = vec![C64::ZERO; order];
    for column in 0..order {
        basis.fill(C64::ZERO);
        if column < size {
            basis[column * size + column] = C64::ONE;
        } else {
            'search: for i in 0..size {
                for k in i + 1..size {
                    let (re, im) = place(i, k);
                    if column == re || column == im {
                        let unit = if column == re { C64::ONE } else { crate::J };
                        (basis[i * size + k], basis[k * size + i]) = (unit, unit.conj());
                        break 'search;
                    }
                }
            }
        }
        let product = |i: usize, k: usize| -> C64 { (0..size).map(|m| rows[i * size + m] * basis[m * size + k]).sum() };
        for i in 0..size {
            matrix[(i, column)] = 2.0 * product(i, i).re;
            for k in i + 1..size {
                let entry = product(i, k) + product(k, i).conj();
                let (re, im) = place(i, k);
                matrix[(re, column)] = entry.re;
                matrix[(im, column)] = entry.im;
            }
        }
    }
    matrix
}
