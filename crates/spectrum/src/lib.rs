//! Power spectral density of an orbit, two-sided: the field's *full spectrum* (Figs. 3.11 and 4.23).
//!
//! Welch's method on the complex signal `p = y + j z`: segments of a power of two, half overlapping, under a Hann window
//! and without detrending, so that an offset of the orbit shows at zero. Positive frequencies whirl forward, negative
//! ones backward. The density is per radian per unit of `tau`: its integral over frequency is the mean of `|p|^2`.
//!
//! ```
//! use rotor::C64;
//!
//! // Half an e_t of forward whirl at the spin speed, R = 2, a sample every 0.1.
//! let orbit: Vec<C64> = (0..4096).map(|i| C64::from_polar(0.5, 2.0 * 0.1 * f64::from(i))).collect();
//! let spectrum = spectrum::welch(&orbit, 0.1, spectrum::segment_length(orbit.len()))?;
//! let line = &spectrum.peaks(2.0)[0];
//! assert!(line.name == "1X" && (line.radius - 0.5).abs() < 1e-2);
//! # Ok::<(), spectrum::SpectrumError>(())
//! ```
//!
//! Beside it, what of a motion turns with the spin, turn by turn ([`OrderTracker`]).
//!
//! Offline work and the live dashboard both read it. It knows neither: samples in, density and named lines out.

mod orders;

use std::f64::consts::TAU;
use std::sync::Arc;

use rotor::C64;
use rustfft::{Fft, FftPlanner};

pub use orders::{OrderSample, OrderTracker, PER_TURN, Revolution};

/// Segments are no longer than this.
const LONGEST_SEGMENT: usize = 1 << 14;
/// Fewer samples than this are no basis for a spectrum.
const FEWEST_SAMPLES: usize = 64;
/// Peaks this far below the highest are not named.
const FAINTEST: f64 = 1e-8;
const MOST_PEAKS: usize = 8;

/// A two-sided power spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Frequencies in radians per unit of `tau`, ascending from negative to positive.
    pub frequency: Vec<f64>,
    /// Density at each, in `e_t^2` per radian per unit of `tau`.
    pub density: Vec<f64>,
    /// How many segments were averaged.
    pub segments: usize,
    /// Samples a segment.
    pub segment: usize,
}

/// One spectral line.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Peak {
    /// Frequency in radians per unit of `tau`, refined between bins; positive forward.
    pub frequency: f64,
    /// The same in multiples of the spin speed; `null` if that is zero.
    pub order: Option<f64>,
    /// The order in words: `1X`, `0.5X`, `-2X` where it is that within the resolution, else with three digits; empty without spin.
    pub name: String,
    /// Density there, in `e_t^2` per radian per unit of `tau`.
    pub density: f64,
    /// Radius of the circular whirl that a single line of this height stands for, in `e_t`.
    pub radius: f64,
}

/// Why there is no spectrum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// Not enough of the motion to look at.
    #[error("{0} samples are too few for a spectrum: at least {FEWEST_SAMPLES}, so let it run longer")]
    TooFew(usize),
    /// A sample is not finite.
    #[error("sample {0} is not finite")]
    NotFinite(usize),
}

/// How many samples a segment has when there are `samples`: the power of two that leaves at least four, at most 16384.
#[must_use]
pub fn segment_length(samples: usize) -> usize {
    let quarter = (samples / 4).max(FEWEST_SAMPLES / 4);
    (1 << quarter.ilog2()).min(LONGEST_SEGMENT)
}

/// Welch's estimate from even samples `apart` apart, in segments of `segment` samples (as from [`segment_length`]).
///
/// # Errors
/// Too few samples, or one that is not finite.
pub fn welch(samples: &[C64], apart: f64, segment: usize) -> Result<Spectrum, SpectrumError> {
    if samples.len() < FEWEST_SAMPLES {
        return Err(SpectrumError::TooFew(samples.len()));
    }
    Welch::new(segment).spectrum(samples, apart)
}

/// Welch's estimate over and over, for segments of one length: the window and the plan of the transform are kept.
#[derive(Clone)]
pub struct Welch {
    window: Vec<f64>,
    power: f64,
    fft: Arc<dyn Fft<f64>>,
    scratch: Vec<C64>,
    block: Vec<C64>,
}

impl std::fmt::Debug for Welch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Welch").field("segment", &self.window.len()).finish_non_exhaustive()
    }
}

impl Welch {
    /// For segments of `segment` samples; a power of two is fastest.
    #[must_use]
    pub fn new(segment: usize) -> Self {
        // The periodic Hann window.
        let window: Vec<f64> = (0..segment).map(|i| 0.5 - 0.5 * (TAU * i as f64 / segment as f64).cos()).collect();
        let fft = FftPlanner::new().plan_fft_forward(segment);
        let scratch = vec![C64::ZERO; fft.get_inplace_scratch_len()];
        Self { power: window.iter().map(|w| w * w).sum(), window, fft, scratch, block: Vec::with_capacity(segment) }
    }

    /// The spectrum of even samples `apart` apart: the mean of as many half overlapping segments as there are.
    ///
    /// # Errors
    /// Fewer samples than a segment has, or one that is not finite.
    pub fn spectrum(&mut self, samples: &[C64], apart: f64) -> Result<Spectrum, SpectrumError> {
        let segment = self.window.len();
        if segment < 2 || samples.len() < segment {
            return Err(SpectrumError::TooFew(samples.len()));
        }
        if let Some(bad) = samples.iter().position(|p| !(p.re.is_finite() && p.im.is_finite())) {
            return Err(SpectrumError::NotFinite(bad + 1));
        }
        let mut sum = vec![0.0; segment];
        let mut segments = 0;
        for start in (0..=samples.len() - segment).step_by(segment / 2) {
            self.block.clear();
            self.block.extend(samples[start..start + segment].iter().zip(&self.window).map(|(p, w)| p * w));
            self.fft.process_with_scratch(&mut self.block, &mut self.scratch);
            for (sum, value) in sum.iter_mut().zip(&self.block) {
                *sum += value.norm_sqr();
            }
            segments += 1;
        }
        let density_scale = apart / (self.power * TAU * f64::from(segments));
        let bin = TAU / (segment as f64 * apart);
        // Bins from segment / 2 on are the negative frequencies.
        let order = (segment.div_ceil(2)..segment).chain(0..segment.div_ceil(2));
        let frequency =
            order.clone().map(|i| bin * if i < segment.div_ceil(2) { i as f64 } else { i as f64 - segment as f64 });
        Ok(Spectrum {
            frequency: frequency.collect(),
            density: order.map(|i| sum[i] * density_scale).collect(),
            segments: segments as usize,
            segment,
        })
    }
}

impl Spectrum {
    /// Distance between two frequencies.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.frequency[1] - self.frequency[0]
    }

    /// The highest local maxima, highest first, named in multiples of the spin speed.
    #[must_use]
    pub fn peaks(&self, speed: f64) -> Vec<Peak> {
        let d = &self.density;
        let floor = FAINTEST * d.iter().copied().fold(0.0, f64::max);
        let mut found: Vec<usize> =
            (1..d.len() - 1).filter(|&i| d[i] > d[i - 1] && d[i] >= d[i + 1] && d[i] > floor).collect();
        found.sort_by(|&i, &k| d[k].total_cmp(&d[i]));
        found.truncate(MOST_PEAKS);
        found.into_iter().map(|i| self.peak(i, speed)).collect()
    }

    /// The line that the highest bin at most `within` from `frequency`, or the nearest bin, would be part of; `None` if
    /// that lies outside the spectrum.
    #[must_use]
    pub fn at(&self, frequency: f64, within: f64, speed: f64) -> Option<Peak> {
        let last = self.frequency.len().checked_sub(2)?;
        let bin = |frequency: f64| ((frequency - self.frequency[0]) / self.resolution()).round();
        let inside = |at: f64| (at >= 1.0 && at <= last as f64).then_some(at as usize);
        let nearest = inside(bin(frequency))?;
        let clamped = |at: f64| at.clamp(1.0, last as f64) as usize;
        let (from, to) = (clamped(bin(frequency - within)).min(nearest), clamped(bin(frequency + within)).max(nearest));
        let highest = (from..=to).max_by(|a, b| self.density[*a].total_cmp(&self.density[*b]))?;
        Some(self.peak(highest, speed))
    }

    fn peak(&self, i: usize, speed: f64) -> Peak {
        let bin = self.resolution();
        // For one line under a Hann window the amplitudes of neighbouring bins, in the ratio (1 + x) / (2 - x), tell how far beyond
        // the higher one it lies.
        let (low, middle, high) = (self.density[i - 1].sqrt(), self.density[i].sqrt(), self.density[i + 1].sqrt());
        let (side, sign) = if high >= low { (high / middle, 1.0) } else { (low / middle, -1.0) };
        let x = ((2.0 * side - 1.0) / (1.0 + side)).clamp(0.0, 0.5);
        let frequency = self.frequency[i] + sign * x * bin;
        // |W(x)| / |W(0)| = sinc(x) / (1 - x^2), and the equivalent noise bandwidth of the window is 1.5 bins.
        let px = std::f64::consts::PI * x;
        let droop = if x == 0.0 { 1.0 } else { px.sin() / px / (1.0 - x * x) };
        let radius = (self.density[i] * 1.5 * bin).sqrt() / droop;
        let order = (speed != 0.0).then(|| frequency / speed);
        Peak {
            frequency,
            order,
            name: order.map_or_else(String::new, |order| name(order, bin / speed.abs())),
            density: self.density[i],
            radius,
        }
    }
}

/// `1X` and its halves and multiples where they are that within half a bin.
fn name(order: f64, bin: f64) -> String {
    let half = (2.0 * order).round() / 2.0;
    if (order - half).abs() <= 0.5 * bin { format!("{}X", half + 0.0) } else { format!("{order:.3}X") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(count: usize, apart: f64, lines: &[(f64, f64)]) -> Vec<C64> {
        (0..count).map(|i| lines.iter().map(|(r, w)| C64::from_polar(*r, w * apart * i as f64)).sum()).collect()
    }

    #[test]
    fn integrates_to_the_mean_square() {
        let samples = lines(40_000, 0.05, &[(2.0, 3.0), (0.5, -1.5)]);
        let spectrum = welch(&samples, 0.05, segment_length(samples.len())).expect("enough");
        let integral = spectrum.density.iter().sum::<f64>() * spectrum.resolution();
        assert!((integral - 4.25).abs() < 1e-3, "{integral}");
        assert!(spectrum.frequency.is_sorted());
    }

    #[test]
    fn names_lines_by_order_and_sense_and_measures_them() {
        let samples = lines(60_000, 0.05, &[(2.0, 3.0), (0.5, -1.5), (0.1, 1.234_567)]);
        let spectrum = welch(&samples, 0.05, segment_length(samples.len())).expect("enough");
        let peaks = spectrum.peaks(3.0);
        let names: Vec<&str> = peaks.iter().map(|p| p.name.as_str()).take(3).collect();
        assert_eq!(names, ["1X", "-0.5X", "0.412X"]);
        for (peak, (radius, frequency)) in peaks.iter().zip([(2.0, 3.0), (0.5, -1.5), (0.1, 1.234_567)]) {
            assert!((peak.frequency - frequency).abs() < 0.02 * spectrum.resolution(), "{peak:?}");
            assert!((peak.radius - radius).abs() < 1e-3 * radius, "{peak:?}");
        }
    }

    #[test]
    fn a_line_is_found_near_a_frequency_and_nothing_outside() {
        let samples = lines(60_000, 0.05, &[(2.0, 3.0), (0.5, -1.5)]);
        let spectrum = welch(&samples, 0.05, segment_length(samples.len())).expect("enough");
        for (near, radius, frequency) in [(3.02, 2.0, 3.0), (-1.47, 0.5, -1.5)] {
            let found = spectrum.at(near, 0.1, 3.0).expect("inside");
            assert!((found.radius - radius).abs() < 1e-3 && (found.frequency - frequency).abs() < 1e-3, "{found:?}");
        }
        assert!(spectrum.at(1.0, 0.0, 3.0).expect("inside").radius < 1e-3, "there is no line");
        assert_eq!(spectrum.at(100.0, 0.1, 3.0), None);
        assert_eq!(spectrum.at(f64::NAN, 0.1, 3.0), None);
    }

    #[test]
    fn refuses_too_little_and_what_is_not_finite() {
        assert_eq!(welch(&[C64::ZERO; 63], 0.1, 16), Err(SpectrumError::TooFew(63)));
        let mut samples = vec![C64::ZERO; 64];
        samples[3].im = f64::NAN;
        assert_eq!(welch(&samples, 0.1, 16), Err(SpectrumError::NotFinite(4)));
        assert!(welch(&[C64::ZERO; 64], 0.1, segment_length(64)).expect("silence").peaks(1.0).is_empty());
    }
}
