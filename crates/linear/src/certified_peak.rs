//! The peak of the sensitivity over all frequencies from both sides: a value that is reached, and one that none exceeds.
//!
//! With `H(s) = C (s I - A)^-1 B` around the loop, `S = (I - H)^-1 = I + C (s I - A - B C)^-1 B`. A level `g > 1` is a singular
//! value of `S(j w)` exactly where `j w` is an eigenvalue of
//!
//! ```text
//! [ F          g B B* / r ]      F = A + B C + B C / r,   r = g^2 - 1
//! [ -g C* C/r     -F*     ]
//! ```
//!
//! (Boyd, Balakrishnan and Kabamba 1989). So where there is no eigenvalue on the axis, no frequency reaches the level; and where
//! there are, the peak lies between two of them, which is how it is found (Bruinsma and Steinbuch 1990). A delay has no such
//! matrix: there the axis is covered with stretches, each with a bound of its own ([`crate::covered`]). So it is where rounding leaves the
//! Hamiltonian unsure, as that of a stiff shaft ([`crate::covered_fractions`]).

use std::convert::Infallible;

use nalgebra::DMatrix;

use crate::balance::balance_matrix;
use crate::system::Balanced;
use crate::{C64, DelayError, DelaySystem, eigenvalues, least};

/// Where a peak is looked for about each pole, in parts of how fast that fades.
const ABOUT: [f64; 9] = [-3.0, -1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0, 3.0];
/// A peak has to be seen from a level so much below it.
const SEEN_BELOW: f64 = 1e-3;
/// How far above what was found the level begins at which nothing is to be on the axis, relative to it.
const GAP: f64 = 1e-8;
/// What it is raised to at most, where rounding leaves eigenvalues on the axis.
const MOST_GAP: f64 = 1e-2;
/// A level this near to 1, which is what `S` is far out, is none.
const LEAST: f64 = 1e-6;
/// Eigenvalues this near the axis, relative to the size of the matrix, may be on it.
const ON_THE_AXIS: f64 = 1e-12;
/// How far the top may be from where the levels end, in parts of the distance to the nearest pole.
const NEAR_THE_TOP: f64 = 1e-2;
/// Levels tried at most: each but the last two doubles the digits.
const LEVELS: usize = 60;
/// Stretches of the axis looked at, at most, where there is a delay.
const STRETCHES: u64 = 400_000;
/// The same times the cube of the states, some second of computing.
const MOST_WORK: u64 = 100_000_000;

/// How far above what was found a bound over stretches is without a delay, where each costs little.
const COVERED_WITHIN: f64 = 1e-6;

/// Why nothing exceeds a peak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeakProof {
    /// The Hamiltonian matrix of the level has no eigenvalue on the imaginary axis.
    Hamiltonian,
    /// The axis is covered with stretches on each of which a bound of the second order is below it: with a delay, or where rounding leaves
    /// that matrix unsure.
    Covered,
}

/// The peak of `|S|` over all frequencies; of several loops, of the largest singular value of `S`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertifiedPeak {
    /// The largest that was found, at least 1.
    pub amplitude: f64,
    /// Where; `None` where it is only approached, as the frequency grows without bound.
    pub frequency: Option<f64>,
    /// No frequency has more than this.
    pub below: f64,
    /// Why.
    pub proof: PeakProof,
}

impl DelaySystem {
    /// The peak of the sensitivity of this loop, opened between `C` and `B`, over the imaginary axis. It says nothing of stability,
    /// without which the peak means nothing.
    ///
    /// `below` is within about 1e-8 of `amplitude` by a Hamiltonian matrix, within 1e-6 where rounding leaves that
    /// unsure, and within `tolerance` where there is a delay, all relative.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had; or a root so near the axis that there is no bound.
    pub fn certified_peak(&self, tolerance: f64) -> Result<CertifiedPeak, DelayError> {
        if self.delay() > 0.0 {
            let found = self.covered_peak(&[], 1.0, tolerance, self.stretches(), &|| false)?;
            let Some((amplitude, at, below)) = found else { return Err(DelayError::NoBound) };
            return Ok(CertifiedPeak { amplitude, frequency: at.map(|at| at[0]), below, proof: PeakProof::Covered });
        }
        let (best, levels) = match level_sets(&self.balanced)? {
            Levels::Proven(peak) => ((peak.amplitude, peak.frequency), Some(peak)),
            Levels::Unsure(best) => (best, None),
        };
        // Rounding can also move eigenvalues off the axis that belong there: two proofs are to agree where both are to be had.
        let covered = self.balanced.peak_by_fractions(best, COVERED_WITHIN);
        match (levels, covered) {
            (Some(peak), None) => Ok(peak),
            (Some(peak), Some((amplitude, ..))) if amplitude <= peak.below => Ok(peak),
            (_, Some((amplitude, frequency, below))) => {
                Ok(CertifiedPeak { amplitude, frequency, below, proof: PeakProof::Covered })
            }
            (None, None) => Err(DelayError::NoBound),
        }
    }

    /// How many stretches are looked at. Each takes the cube of the states: a bound of a large loop is not waited for.
    fn stretches(&self) -> u64 {
        let states = self.balanced.size().max(1) as u64;
        STRETCHES.min(MOST_WORK / states.pow(3))
    }
}

/// What levels tell.
enum Levels {
    /// A peak that none exceeds.
    Proven(CertifiedPeak),
    /// The largest value that was found, and where: rounding leaves open whether another is larger.
    Unsure((f64, Option<f64>)),
}

fn level_sets(system: &Balanced) -> Result<Levels, DelayError> {
    let closed = &system.a + &system.b * &system.c;
    let mut best = (1.0, None);
    let see = |best: &mut (f64, Option<f64>), w: f64| {
        let here = system.sensitivity_at(w).unwrap_or(f64::INFINITY);
        if here > best.0 {
            *best = (here, Some(w));
        }
    };
    let poles = eigenvalues(closed.clone())?;
    let about = poles.iter().flat_map(|s| ABOUT.map(|part| s.im + part * s.re));
    about.chain([0.0]).for_each(|w| see(&mut best, w));
    let mut gap = GAP;
    for _ in 0..LEVELS {
        if !best.0.is_finite() {
            return Err(DelayError::NoBound);
        }
        let level = (best.0 * (1.0 + 2.0 * gap)).max(1.0 + LEAST);
        let mut on_axis = on_the_axis(system, &closed, level)?;
        if on_axis.is_empty() {
            if !is_seen(system, &closed, best, &poles)? {
                return Ok(Levels::Unsure(best));
            }
            let (amplitude, frequency) = system.climbed(best, &poles);
            let below = level.max(amplitude);
            let peak = CertifiedPeak { amplitude, frequency, below, proof: PeakProof::Hamiltonian };
            return Ok(Levels::Proven(peak));
        }
        on_axis.sort_by(f64::total_cmp);
        let between: Vec<f64> = on_axis.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let known = best.0;
        on_axis.iter().chain(&between).for_each(|w| see(&mut best, *w));
        // No more was found there: what is on the axis is the peak below the level, but for rounding.
        if best.0 <= known * (1.0 + gap) {
            gap *= 10.0;
            if gap > MOST_GAP {
                break;
            }
        }
    }
    Ok(Levels::Unsure(best))
}

/// Whether a level just below the peak that is known crosses the axis next to it: what does not see that peak, because rounding has moved its
/// eigenvalues too far, proves nothing about others.
fn is_seen(
    system: &Balanced,
    closed: &DMatrix<C64>,
    (peak, at): (f64, Option<f64>),
    poles: &[C64],
) -> Result<bool, DelayError> {
    let level = peak * (1.0 - SEEN_BELOW);
    let (Some(w), true) = (at, level > 1.0 + LEAST) else { return Ok(true) };
    let width = poles.iter().map(|s| (s - C64::new(0.0, w)).norm()).fold(f64::INFINITY, f64::min);
    Ok(on_the_axis(system, closed, level)?.iter().any(|crossing| (crossing - w).abs() <= width))
}

/// Frequencies at which a level may be a singular value of `S`.
fn on_the_axis(system: &Balanced, closed: &DMatrix<C64>, level: f64) -> Result<Vec<f64>, DelayError> {
    let n = system.size();
    let r = level * level - 1.0;
    let over = |x: f64| C64::from(x / r);
    let inner = closed + &system.b * &system.c * over(1.0);
    let mut hamiltonian = DMatrix::zeros(2 * n, 2 * n);
    hamiltonian.view_mut((0, 0), (n, n)).copy_from(&inner);
    hamiltonian.view_mut((0, n), (n, n)).copy_from(&(&system.b * system.b.adjoint() * over(level)));
    hamiltonian.view_mut((n, 0), (n, n)).copy_from(&(system.c.adjoint() * &system.c * over(-level)));
    hamiltonian.view_mut((n, n), (n, n)).copy_from(&-inner.adjoint());
    balance_matrix(&mut hamiltonian);
    let size = hamiltonian.norm();
    let found = eigenvalues(hamiltonian)?;
    Ok(found.iter().filter(|s| s.re.abs() <= ON_THE_AXIS * size).map(|s| s.im).collect())
}

impl Balanced {
    /// The largest singular value of `S(j w)`; `None` at a root.
    pub(crate) fn sensitivity_at(&self, w: f64) -> Option<f64> {
        let s = C64::new(0.0, w);
        let moved = self.at(s).lu().solve(&self.b)?;
        let mut sensitivity = &self.c * moved * (-s * self.delay).exp();
        (0..sensitivity.nrows()).for_each(|k| sensitivity[(k, k)] += C64::ONE);
        Some(largest_singular(&sensitivity)).filter(|size| size.is_finite())
    }
}

impl Balanced {
    /// The very top near a place that is within a part in a hundred million of it, so that its frequency is known too.
    fn climbed(&self, best: (f64, Option<f64>), poles: &[C64]) -> (f64, Option<f64>) {
        let Some(w) = best.1 else { return best };
        let nearest = poles.iter().map(|s| (s - C64::new(0.0, w)).norm()).fold(f64::INFINITY, f64::min);
        let reach = NEAR_THE_TOP * nearest.min(1.0 + w.abs());
        let look = |w: f64| Ok::<_, Infallible>(-self.sensitivity_at(w).unwrap_or(0.0));
        let Ok((at, value)) = least([w - reach, w + reach], 1e-6 * reach, look);
        if -value > best.0 { (-value, Some(at)) } else { best }
    }
}

/// The largest singular value of a small matrix.
pub(crate) fn largest_singular(matrix: &DMatrix<C64>) -> f64 {
    if matrix.len() == 1 { matrix[0].norm() } else { matrix.singular_values().max() }
}
