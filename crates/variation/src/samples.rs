//! Machines whose parameters are drawn at random, and what becomes of the smallest damping.
//!
//! Draw `k` of sample `i` is a pure function of the seed, `i` and `k`: Philox4x64-10 (Salmon et al., "Parallel random numbers: as easy as
//! 1, 2, 3", 2011) with the key `[seed, 0]` and the counter `[k / 4, i, 0, 0]`, of which NumPy's `Philox` is one. So every sample is the
//! same whoever draws it, in whatever order and on however many threads.

use rayon::prelude::*;

use crate::model::Model;
use crate::parameter::Parameter;
use crate::variation_error::VariationError;
use crate::worst::Range;

/// Half the range in standard deviations, of a normal distribution.
const SIGMAS: f64 = 3.0;
/// The normal quantile of a two-sided interval of 95 %.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// How values are spread over a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Distribution {
    /// All of the range alike.
    #[default]
    Uniform,
    /// About its middle, with a standard deviation of a sixth of it; what falls outside is drawn again.
    Normal,
}

/// Why there are no samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SamplesError {
    /// None were asked for.
    #[error("0 samples: expected at least 1")]
    None,
    /// A sample that cannot be had.
    #[error("sample {index}: {error}")]
    Sample {
        /// Which, counted from 0.
        index: u64,
        /// Why.
        error: VariationError,
    },
}

/// A share with what it is known to lie in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The share of the samples, 0 to 1.
    pub share: f64,
    /// Wilson's interval of 95 % for the share of all there could be.
    pub interval: [f64; 2],
}

impl Share {
    /// So many of so many, the latter at least 1.
    #[must_use]
    pub fn of(count: u64, all: u64) -> Self {
        let (n, share, z) = (all as f64, count as f64 / all as f64, NORMAL_95);
        let middle = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z / (1.0 + z * z / n) * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
        // None and all are ends of it, but for rounding.
        let low = if count == 0 { 0.0 } else { (middle - half).max(0.0) };
        let high = if count == all { 1.0 } else { (middle + half).min(1.0) };
        Self { share, interval: [low, high] }
    }
}

/// What samples have come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The smallest damping of each, in the order in which they were drawn.
    pub min_damping: Vec<f64>,
    /// Those that are stable: whose smallest damping is above 0.
    pub stable: Share,
    sorted: Vec<f64>,
}

impl Samples {
    /// Of the smallest damping of every sample; at least one.
    #[must_use]
    pub fn of(min_damping: Vec<f64>) -> Self {
        let stable = min_damping.iter().filter(|damping| **damping > 0.0).count();
        let mut sorted = min_damping.clone();
        sorted.sort_by(f64::total_cmp);
        Self { stable: Share::of(stable as u64, min_damping.len() as u64), min_damping, sorted }
    }

    /// The damping below which the part `part` (0 to 1) of the samples is: see [`quantile`].
    #[must_use]
    pub fn quantile(&self, part: f64) -> f64 {
        quantile(&self.sorted, part)
    }
}

/// What the part `part` (0 to 1) of some values is below: linear between neighbours, NumPy's default. The values are sorted, at least one,
/// and may end in infinite ones.
#[must_use]
pub fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let (at, rest) = (place.floor() as usize, place.fract());
    let (low, next) = (sorted[at], sorted[(at + 1).min(sorted.len() - 1)]);
    // Nothing of an infinite distance is no number.
    if rest == 0.0 || low == next { low } else { low + (next - low) * rest }
}

/// The smallest damping of `count` machines whose parameters are drawn from `ranges`, from sample `first` on. `done` hears how many more
/// are done, from any thread; where it answers that no more are wanted, what is left is not looked at.
///
/// # Errors
/// No samples, or one that cannot be had.
pub fn samples(
    model: &Model,
    ranges: &[Range],
    distribution: Distribution,
    seed: u64,
    [first, count]: [u64; 2],
    done: &(dyn Fn(u64) + Sync),
) -> Result<Vec<f64>, SamplesError> {
    /// Samples of one task.
    const TASK: u64 = 1024;
    if count == 0 {
        return Err(SamplesError::None);
    }
    let tasks: Vec<u64> = (0..count.div_ceil(TASK)).collect();
    let each: Result<Vec<Vec<f64>>, SamplesError> = tasks
        .into_par_iter()
        .map(|task| {
            let from = first + task * TASK;
            let to = (first + count).min(from + TASK);
            let mut changes: Vec<(&Parameter, f64)> = ranges.iter().map(|range| (&range.parameter, 0.0)).collect();
            let of = |index: u64| {
                let values = values(ranges, distribution, seed, index);
                changes.iter_mut().zip(values).for_each(|(change, value)| change.1 = value);
                let damping = model.with(&changes).and_then(|machine| machine.min_damping());
                damping.map_err(|error| SamplesError::Sample { index, error })
            };
            let made = (from..to).map(of).collect();
            done(to - from);
            made
        })
        .collect();
    Ok(each?.concat())
}

/// The values of the parameters of sample `index`, in the order of the ranges.
#[must_use]
pub fn values(ranges: &[Range], distribution: Distribution, seed: u64, index: u64) -> Vec<f64> {
    match distribution {
        Distribution::Uniform => {
            draw(seed, index, ranges.len()).iter().zip(ranges).map(|(part, range)| range.at(*part)).collect()
        }
        Distribution::Normal => {
            let mut made = Vec::with_capacity(ranges.len());
            let mut drawn = Vec::new();
            let mut next = 0;
            for range in ranges {
                loop {
                    // Two numbers of a uniform distribution make one of a normal one (Box and Muller).
                    if next + 2 > drawn.len() {
                        drawn = draw(seed, index, 2 * drawn.len().max(ranges.len()).max(2));
                    }
                    let (u, v) = (drawn[next], drawn[next + 1]);
                    next += 2;
                    let normal = (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos();
                    if normal.abs() <= SIGMAS {
                        made.push(range.at(0.5 + 0.5 * normal / SIGMAS));
                        break;
                    }
                }
            }
            made
        }
    }
}

/// The first `count` draws of sample `index`, each from 0 up to but not including 1, in steps of 2^-53.
#[must_use]
pub fn draw(seed: u64, index: u64, count: usize) -> Vec<f64> {
    let blocks = (0..count.div_ceil(4)).map(|block| philox([block as u64, index, 0, 0], [seed, 0]));
    let unit = |word: u64| (word >> 11) as f64 * (-53.0_f64).exp2();
    blocks.flatten().take(count).map(unit).collect()
}

/// Four words of Philox4x64 with ten rounds.
fn philox(mut counter: [u64; 4], mut key: [u64; 2]) -> [u64; 4] {
    const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
    const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];
    let product = |a: u64, b: u64| {
        let whole = u128::from(a) * u128::from(b);
        [(whole >> 64) as u64, whole as u64]
    };
    for round in 0..10 {
        if round > 0 {
            key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
        }
        let [high0, low0] = product(MULTIPLIERS[0], counter[0]);
        let [high1, low1] = product(MULTIPLIERS[1], counter[2]);
        counter = [high1 ^ counter[1] ^ key[0], low1, high0 ^ counter[3] ^ key[1], low0];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_draws_are_those_of_the_known_answer_tests_of_random123() {
        // Salmon et al., Random123, kat_vectors: philox4x64 10.
        assert_eq!(
            philox([0; 4], [0; 2]),
            [0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b]
        );
        assert_eq!(
            philox([u64::MAX; 4], [u64::MAX; 2]),
            [0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0]
        );
    }

    #[test]
    fn val_intervals_are_those_of_wilson() {
        // statsmodels.stats.proportion.proportion_confint(count, n, method="wilson").
        let close = |found: [f64; 2], expected: [f64; 2]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
        };
        close(Share::of(10, 10).interval, [0.722_467_200, 1.0]);
        close(Share::of(0, 10).interval, [0.0, 0.277_532_800]);
    }

    #[test]
    fn quantiles_lie_between_neighbours() {
        let samples = Samples::of(vec![3.0, 1.0, 2.0, -1.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|part| samples.quantile(part)), [-1.0, 1.5, 3.0]);
        assert_eq!(samples.stable.share, 0.75);
        assert_eq!(Samples::of(vec![0.5]).quantile(0.3), 0.5);
        // Of sizes the largest may be out of bounds.
        let sizes = [1.0, 2.0, f64::INFINITY, f64::INFINITY, f64::INFINITY];
        assert_eq!([0.0, 0.25, 0.3, 0.5, 0.6, 1.0].map(|part| quantile(&sizes, part))[..2], [1.0, 2.0]);
        assert!([0.3, 0.5, 0.6, 1.0].iter().all(|part| quantile(&sizes, *part) == f64::INFINITY));
    }
}
