//! The loci of loops that are closed together, which are the eigenvalues of their gain over frequency: where they have size 1, and what
//! delay of all commands at once turns them onto -1 there. Of one loop its gain is its locus.
//!
//! Sorted by size, the k-th largest locus is not one and the same curve for long, but its size is continuous. So nothing has to be
//! matched from one frequency to the next: a size on either side of 1 at two neighbours is a crossing, and an extreme size among three
//! that reaches to the other side of 1 is two.

use std::convert::Infallible;
use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::{C64, eigenvalues_in_place, least};

/// An extreme size is found to this part of the stretch that it is on: it is flat to the last place after half the digits.
const NEAR: f64 = 3e-8;
/// Loci whose sizes differ by less pass each other.
const CORNER: f64 = 1e-5;

/// A frequency at which a locus has size 1, or nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitLocus {
    /// The frequency.
    pub frequency: f64,
    /// The locus there.
    pub gain: C64,
    /// Whether its size is 1; else it is at a largest size below.
    pub crosses: bool,
}

/// The delay that turns a gain at a frequency onto the negative real axis: `exp(-j w T)` turns `-L` onto 1, with `T w` its angle up to
/// whole turns, `T` not negative.
#[must_use]
pub fn borne(gain: C64, frequency: f64) -> f64 {
    let angle = (-gain).arg();
    let turn = if angle * frequency < 0.0 { angle + TAU.copysign(frequency) } else { angle };
    if frequency == 0.0 { f64::INFINITY } else { turn / frequency }
}

/// The eigenvalues of a gain, the largest first; not numbers where they cannot be had.
#[must_use]
pub fn loci(gain: &DMatrix<C64>) -> Vec<C64> {
    let m = gain.nrows();
    if m == 1 {
        return vec![gain[0]];
    }
    let (mut rows, mut values): (Vec<C64>, _) = (gain.transpose().as_slice().to_vec(), vec![C64::ZERO; m]);
    match eigenvalues_in_place(&mut rows, &mut values) {
        Ok(()) => {
            values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
            values
        }
        Err(_) => vec![C64::from(f64::NAN); m],
    }
}

/// Every frequency at which a locus has size 1 along `curve`, frequencies rising, and every one at which it has a largest size between
/// `nearly` and 1. `of` has the loci at a frequency, the largest first.
///
/// The curve must have points enough for every extreme size to have one beside it that is more extreme than its neighbours.
pub fn unit_loci(curve: &[(f64, Vec<C64>)], of: &dyn Fn(f64) -> Vec<C64>, nearly: f64) -> Vec<UnitLocus> {
    let mut found = Vec::new();
    for rank in 0..curve.first().map_or(0, |(_, loci)| loci.len()) {
        let size = |w: f64| of(w)[rank].norm();
        let cross = |found: &mut Vec<UnitLocus>, a: f64, b: f64| {
            let frequency = size_one(a, b, &size);
            found.push(UnitLocus { frequency, gain: of(frequency)[rank], crosses: true });
        };
        let known: Vec<(f64, f64)> =
            curve.iter().map(|(w, loci)| (*w, loci[rank].norm())).filter(|(_, size)| size.is_finite()).collect();
        for pair in known.windows(2) {
            if (pair[0].1 > 1.0) != (pair[1].1 > 1.0) {
                cross(&mut found, pair[0].0, pair[1].0);
            }
        }
        for three in known.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|k| three[k].1);
            let is_top = b >= a && b > c && b <= 1.0;
            let is_bottom = b <= a && b < c && b > 1.0;
            // A top rises above its highest point by less than that stands out, if the curve has points enough; a bottom may be a zero.
            let reach = 4.0 * (b - a).max(b - c);
            if !(is_top && b + reach > nearly || is_bottom) {
                continue;
            }
            let (from, to) = (three[0].0, three[2].0);
            let sign = if is_top { -1.0 } else { 1.0 };
            let Ok((mut at, value)) = least([from, to], NEAR * (to - from), |w| Ok::<_, Infallible>(sign * size(w)));
            // A needle may be passed over: what was known is as good then.
            let mut extreme = sign * value;
            if sign * extreme > sign * b {
                (at, extreme) = (three[1].0, b);
            }
            if (extreme > 1.0) != (b > 1.0) {
                cross(&mut found, from, at);
                cross(&mut found, at, to);
            } else if is_top && extreme > nearly {
                let all = of(at);
                // Where two loci pass each other in size, the smaller of the two has a corner and neither a maximum.
                let is_corner = all.iter().filter(|l| (l.norm() - all[rank].norm()).abs() < CORNER).count() > 1;
                if !is_corner {
                    found.push(UnitLocus { frequency: at, gain: all[rank], crosses: false });
                }
            }
        }
    }
    found
}

/// Where a size is 1 between two frequencies on either side of it: false position, an end that stays counting half (Illinois), and halving
/// now and then.
fn size_one(low: f64, high: f64, size: &dyn Fn(f64) -> f64) -> f64 {
    let of = |w: f64| size(w).ln();
    let [mut low, mut high] = [low, high].map(|w| (w, of(w)));
    let rises = high.1 > 0.0;
    let mut last_high = None;
    for k in 0..200 {
        let straight = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let is_inside = straight > low.0 && straight < high.0 && k % 4 != 3;
        let w = if is_inside { straight } else { 0.5 * (low.0 + high.0) };
        let value = of(w);
        if value == 0.0 || w <= low.0 || w >= high.0 || high.0 - low.0 <= 1e-15 * (1.0 + w.abs()) {
            return w;
        }
        let is_high = (value > 0.0) == rises;
        let (end, other) = if is_high { (&mut high, &mut low) } else { (&mut low, &mut high) };
        if last_high.replace(is_high) == Some(is_high) {
            other.1 *= 0.5;
        }
        *end = (w, value);
        if value.abs() < 1e-15 {
            return w;
        }
    }
    0.5 * (low.0 + high.0)
}
