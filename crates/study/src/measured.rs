//! The sensitivity of a loop as it is measured on a running machine: its command while tones are added to it, taken apart by least
//! squares period by period, and put together again with a coherence that says how far the periods agree.
//!
//! ```text
//! commanded(tau) = sum of c_k e_k(tau) + 1X, backward 1X and a constant,   S(j w_k) = c_k
//! ```
//!
//! with the tones `e_k`; where the loop is sampled, as they were at the last sample, since there the command is held.

use machine::Tone;
use nalgebra::{DMatrix, DVector};
use rotor::C64;

/// Frequencies closer to each other than this share of `2 pi` over the record are one to least squares.
const SAME: f64 = 0.25;

/// What is known of the tones that are looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Tones {
    /// The tones as they were added.
    pub tones: Vec<Tone>,
    /// The time at which they began, each with its phase.
    pub from: f64,
    /// The spin speed, at which unbalance turns.
    pub speed: f64,
    /// Sampling period of the loop; 0 if it is not sampled.
    pub sample: f64,
}

/// The sensitivity at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPoint {
    /// In radians per `tau`; negative for backward whirl.
    pub frequency: f64,
    /// `S`: the mean over the periods.
    pub value: C64,
    /// `|mean of S|^2 / mean of |S|^2` over the periods: 1 where they agree, one over their number where they are chance.
    pub coherence: f64,
}

impl Tones {
    /// When the command was made that stands at `tau`.
    fn made(&self, tau: f64) -> f64 {
        if self.sample == 0.0 {
            return tau;
        }
        // A sample at the very end of a step acts from the next one on.
        ((tau / self.sample * (1.0 - 1e-12) - 1e-9).ceil() - 1.0) * self.sample
    }

    /// `S` at every tone over a record of times and commands, in which each tone should turn a whole number of times; `None` if the
    /// record is too short to tell them apart.
    #[must_use]
    pub fn identify(&self, record: &[(f64, C64)]) -> Option<Vec<C64>> {
        let (first, last) = (record.first()?.0, record.last()?.0);
        let apart = SAME * std::f64::consts::TAU / (last - first);
        let mut beside: Vec<f64> = vec![0.0];
        for frequency in [self.speed, -self.speed] {
            if beside.iter().all(|known| (known - frequency).abs() > apart) {
                beside.push(frequency);
            }
        }
        let size = self.tones.len() + beside.len();
        if record.len() < size {
            return None;
        }
        let (mut normal, mut right) = (DMatrix::<C64>::zeros(size, size), DVector::<C64>::zeros(size));
        let mut row = DVector::<C64>::zeros(size);
        for (tau, command) in record {
            let since = self.made(*tau) - self.from;
            let of_tones = self.tones.iter().map(|tone| tone.amplitude * C64::cis(tone.frequency * since));
            let of_others = beside.iter().map(|frequency| C64::cis(frequency * since));
            row.iter_mut().zip(of_tones.chain(of_others)).for_each(|(place, value)| *place = value.conj());
            normal.gerc(C64::new(1.0, 0.0), &row, &row, C64::new(1.0, 0.0));
            right.axpy(*command, &row, C64::new(1.0, 0.0));
        }
        // Columns of like size: tones are as small as the machine bears.
        let scales: Vec<f64> = (0..size).map(|k| normal[(k, k)].re.sqrt()).collect();
        let scaled = DMatrix::from_fn(size, size, |i, k| normal[(i, k)] / (scales[i] * scales[k]));
        let solved = scaled.cholesky()?.solve(&DVector::from_fn(size, |i, _| right[i] / scales[i]));
        let found: Vec<C64> = (0..self.tones.len()).map(|k| solved[k] / scales[k]).collect();
        found.iter().all(|z| z.is_finite()).then_some(found)
    }

    /// Several periods put together.
    #[must_use]
    pub fn averaged(&self, periods: &[Vec<C64>]) -> Vec<MeasuredPoint> {
        let count = periods.len().max(1) as f64;
        let mut points: Vec<MeasuredPoint> = (self.tones.iter().enumerate())
            .map(|(k, tone)| {
                let values = || periods.iter().filter_map(|period| period.get(k));
                let mean = values().sum::<C64>() / count;
                let power = values().map(|z| z.norm_sqr()).sum::<f64>() / count;
                let coherence = if power > 0.0 { (mean.norm_sqr() / power).min(1.0) } else { 0.0 };
                MeasuredPoint { frequency: tone.frequency, value: mean, coherence }
            })
            .collect();
        points.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        points
    }
}

#[cfg(test)]
mod tests {
    use machine::Multisine;

    use super::*;

    fn tones(sample: f64) -> Tones {
        let multisine = Multisine {
            seed: 3,
            period: 40.0,
            lines: [1, 50],
            tones: 20,
            away_from: 2.5,
            amplitude: 0.01,
            duration: 100.0,
        };
        Tones { tones: multisine.tones().unwrap(), from: 3.0, speed: 2.5, sample }
    }

    #[test]
    fn val_what_was_put_together_is_taken_apart_exactly() {
        for sample in [0.0, 0.03] {
            let tones = tones(sample);
            let gain = |w: f64| C64::new(1.0 + 0.3 * w, -0.2 * w * w) / (1.0 + w * w);
            let command = |tau: f64| {
                let since = tones.made(tau) - 3.0;
                let sum: C64 = (tones.tones.iter())
                    .map(|tone| gain(tone.frequency) * tone.amplitude * C64::cis(tone.frequency * since))
                    .sum();
                sum + C64::new(5.0, 2.0) * C64::cis(2.5 * since) + C64::new(0.0, 0.7) * C64::cis(-2.5 * since) - 0.4
            };
            let record: Vec<(f64, C64)> =
                (1..=4000).map(|k| 10.0 + f64::from(k) * 0.01).map(|tau| (tau, command(tau))).collect();
            let found = tones.identify(&record).unwrap();
            for (tone, found) in tones.tones.iter().zip(&found) {
                assert!((found - gain(tone.frequency)).norm() < 1e-9, "{} {found}", tone.frequency);
            }
            let points = tones.averaged(&[found.clone(), found]);
            assert!(points.is_sorted_by(|a, b| a.frequency < b.frequency));
            assert!(points.iter().all(|point| point.coherence > 1.0 - 1e-12));
            assert_eq!(tones.identify(&record[..30]), None);
        }
    }

    #[test]
    fn periods_that_do_not_agree_have_little_coherence() {
        let tones = tones(0.0);
        let turned = |angle: f64| vec![C64::cis(angle); tones.tones.len()];
        let points = tones.averaged(&[
            turned(0.0),
            turned(std::f64::consts::PI),
            turned(1.0),
            turned(1.0 + std::f64::consts::PI),
        ]);
        assert!(points.iter().all(|point| point.coherence < 1e-12));
        let points = tones.averaged(&[turned(0.0), turned(std::f64::consts::FRAC_PI_2)]);
        assert!(points.iter().all(|point| (point.coherence - 0.5).abs() < 1e-12));
    }
}
