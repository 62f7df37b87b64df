//! Peaks of an amplitude over speed, as rotating machines are evaluated by: where they are, how high, and how sharp.

/// Peaks that do not stand out by so much of their height on both sides are ripple.
const STANDS_OUT: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Peaks lower than this part of the largest are not named.
const FAINTEST: f64 = 0.02;

/// A peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResonancePeak {
    /// Spin speed `R` at which it is highest.
    pub speed: f64,
    /// Its height.
    pub height: f64,
    /// Where it is among the speeds.
    pub at: usize,
    /// How many speeds lie between its half-power points, or those and the ends.
    pub width: usize,
    /// Speeds on both sides at which it has 0.707 of its height; those that the range has.
    pub half_power: [Option<f64>; 2],
}

impl ResonancePeak {
    /// Amplification factor `N_c / (N_2 - N_1)`, with `N_1` and `N_2` the half-power points (API 684); nothing if the range
    /// has not both.
    #[must_use]
    pub fn amplification(&self) -> Option<f64> {
        let [Some(low), Some(high)] = self.half_power else { return None };
        (high > low).then(|| self.speed / (high - low))
    }
}

/// Every peak of `height` over `speed`, which rises, that stands out: 0.293 of its height above the lowest on each side before something
/// higher, or the end.
#[must_use]
pub fn peaks(speed: &[f64], height: &[f64]) -> Vec<ResonancePeak> {
    let largest = height.iter().copied().fold(0.0, f64::max);
    let n = speed.len().min(height.len());
    let mut found = Vec::new();
    for i in 1..n.saturating_sub(1) {
        let here = height[i];
        if !(here > height[i - 1] && here >= height[i + 1] && here >= FAINTEST * largest) {
            continue;
        }
        // Walk down both sides until something is higher.
        let side = |indices: &mut dyn Iterator<Item = usize>| {
            let (mut lowest, mut half, mut nearer, mut count) = (here, None, i, 0);
            for k in indices {
                if height[k] > here {
                    break;
                }
                lowest = lowest.min(height[k]);
                count += usize::from(half.is_none());
                let level = here * std::f64::consts::FRAC_1_SQRT_2;
                if half.is_none() && height[k] <= level {
                    let share = (height[nearer] - level) / (height[nearer] - height[k]);
                    half = Some(speed[nearer] + share * (speed[k] - speed[nearer]));
                }
                nearer = k;
            }
            (lowest, half, count)
        };
        let (left, low, before) = side(&mut (0..i).rev());
        let (right, high, after) = side(&mut (i + 1..n));
        if here - left.max(right) < STANDS_OUT * here {
            continue;
        }
        let (speed, height) = summit([i - 1, i, i + 1].map(|k| (speed[k], height[k])));
        found.push(ResonancePeak { speed, height, at: i, width: before + after, half_power: [low, high] });
    }
    found
}

/// The highest point of the parabola through three points, the middle one of which is the highest.
fn summit([a, b, c]: [(f64, f64); 3]) -> (f64, f64) {
    let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
    let bend = (right - left) / (c.0 - a.0);
    if bend.is_nan() || bend >= 0.0 {
        return b;
    }
    // Slope at the middle of the first stretch is `left`, and changes by 2 `bend` per unit.
    let at = (0.5 * (a.0 + b.0) - 0.5 * left / bend).clamp(a.0, c.0);
    (at, b.1 + (at - b.0) * (left + bend * (at - a.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_the_amplification_of_a_resonance_is_that_of_its_damping() {
        // |1 / (1 - r^2 + 2 j zeta r)| peaks at sqrt(1 - 2 zeta^2) with 1 / (2 zeta sqrt(1 - zeta^2)); its factor is about
        // 1 / (2 zeta).
        let zeta = 0.02;
        let speed: Vec<f64> = (0..4000).map(|k| 0.5 + f64::from(k) * 2.5e-4).collect();
        let amplitude = |r: &f64| 1.0 / ((1.0 - r * r).powi(2) + (2.0 * zeta * r).powi(2)).sqrt();
        let height: Vec<f64> = speed.iter().map(amplitude).collect();
        let found = peaks(&speed, &height);
        let [peak] = found[..] else { panic!("{found:?}") };
        assert!((peak.speed - (1.0 - 2.0 * zeta * zeta).sqrt()).abs() < 1e-7, "{peak:?}");
        assert!((peak.height - 1.0 / (2.0 * zeta * (1.0 - zeta * zeta).sqrt())).abs() < 1e-5, "{peak:?}");
        // Half-power points from r^2 = 1 - 2 zeta^2 -+ 2 zeta sqrt(1 - zeta^2).
        let half = |sign: f64| (1.0 - 2.0 * zeta * zeta + sign * 2.0 * zeta * (1.0 - zeta * zeta).sqrt()).sqrt();
        let exact = peak.speed / (half(1.0) - half(-1.0));
        assert!((peak.amplification().unwrap() / exact - 1.0).abs() < 1e-4, "{:?} {exact}", peak.amplification());
    }

    #[test]
    fn ripple_and_slopes_are_no_peaks_and_a_cut_peak_has_no_factor() {
        let speed: Vec<f64> = (0..100).map(f64::from).collect();
        let rising: Vec<f64> = speed.iter().map(|s| 1.0 + s + (0.9 * s).sin()).collect();
        assert!(peaks(&speed, &rising).is_empty());
        // Falls to 0.8 on the right only: no half-power point there.
        let cut = [0.1, 0.5, 1.0, 0.9, 0.8];
        assert!(peaks(&speed[..5], &cut).is_empty());
        let two = [0.1, 1.0, 0.2, 3.0, 0.1];
        let found = peaks(&speed[..5], &two);
        assert_eq!(found.len(), 2);
        assert!(found[0].half_power[0].is_some() && found[1].amplification().is_some());
    }
}
