//! The maximum of a smooth signal between its samples.
//!
//! The largest sample misses the peak by up to `(w dtau)^2 / 8` of it, far more than the integration error. The quartic
//! through five samples around the largest misses it by a part of the order `(w dtau)^6`.

/// Follows several signals that are sampled together at even steps.
#[derive(Clone, Debug)]
pub struct Peaks {
    /// The last four samples of each signal, newest last, signal by signal.
    history: Vec<[f64; 4]>,
    /// How many samples there are since the last break, up to 4.
    depth: u8,
}

impl Peaks {
    /// Follows `signals` signals.
    #[must_use]
    pub fn new(signals: usize) -> Self {
        Self { history: vec![[0.0; 4]; signals], depth: 0 }
    }

    /// Forgets the past: the signals jump here, or the step changes.
    pub fn break_off(&mut self) {
        self.depth = 0;
    }

    /// Takes the next sample of every signal and raises `maxima` to any peak that this completes.
    #[inline]
    pub fn push(&mut self, samples: &[f64], maxima: &mut [f64]) {
        let full = self.depth == 4;
        for ((past, &new), max) in self.history.iter_mut().zip(samples).zip(maxima) {
            *max = max.max(new);
            let [a, b, c, d] = *past;
            if full && is_peak([b, c, d], *max) {
                *max = max.max(summit([a, b, c, d, new]));
            }
            *past = [b, c, d, new];
        }
        if !full {
            self.depth += 1;
        }
    }
}

/// Whether the middle of three samples is a peak that may be as large as `largest`, which is the largest sample so far at least.
///
/// A peak a little below the largest sample may still be the largest between samples.
#[inline]
pub(crate) fn is_peak([b, c, d]: [f64; 3], largest: f64) -> bool {
    c >= b && c > d && c > 0.98 * largest
}

/// The maximum near the middle of the quartic through five even samples, the middle one the largest of the inner three.
pub(crate) fn summit([a, b, c, d, e]: [f64; 5]) -> f64 {
    let c1 = (a - 8.0 * b + 8.0 * d - e) / 12.0;
    let c2 = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 24.0;
    let c3 = (-a + 2.0 * b - 2.0 * d + e) / 12.0;
    let c4 = (a - 4.0 * b + 6.0 * c - 4.0 * d + e) / 24.0;
    // Where the samples agree to rounding there is no peak to be found between them; and at a jump, which a quartic
    // does not follow, the largest sample is all that is known.
    let smooth = c3.abs() <= 0.3 * -c2 && c4.abs() <= 0.15 * -c2;
    if c2 >= -1e-13 * c.abs() || !smooth {
        return c;
    }
    let mut x = -0.5 * c1 / c2;
    for _ in 0..3 {
        let slope = c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * 4.0 * c4));
        let curvature = 2.0 * c2 + x * (6.0 * c3 + x * 12.0 * c4);
        if curvature >= 0.0 {
            return c;
        }
        x -= slope / curvature;
    }
    let height = c + x * (c1 + x * (c2 + x * (c3 + x * c4)));
    if x.abs() <= 1.0 && height >= c { height } else { c }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_reaches_its_amplitude_whatever_the_phase() {
        for start in 0..50 {
            let (mut peaks, mut max) = (Peaks::new(1), [0.0]);
            for i in 0..200 {
                let x = 0.06 * f64::from(i) + 0.0013 * f64::from(start);
                peaks.push(&[(3.0 * x.sin()).powi(2)], &mut max);
            }
            assert!((max[0] - 9.0).abs() < 1e-7, "{}", max[0]);
        }
    }

    #[test]
    fn a_jump_is_no_peak() {
        let (mut peaks, mut max) = (Peaks::new(1), [0.0]);
        for value in [0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 1.0, 0.0, 0.0] {
            peaks.push(&[value], &mut max);
        }
        assert_eq!(max[0], 5.0);
    }
}
