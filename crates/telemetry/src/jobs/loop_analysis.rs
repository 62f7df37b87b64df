//! The loop of a machine at one speed, opened at its control bearing's command: its gain over frequency, and its margins where it is
//! stable. Every support bearing counts at its full stiffness, as for poles.

use std::sync::Arc;

pub use machine::{ISO_14839_3, sensitivity_zone};
use machine::{MachineLoop, MachineMargins, MarginsError};
use rotor::{C64, Feedback, Rotor, Settings};

use crate::history::Era;

/// Points from one of the adaptive curve to the next, on the cubic that its values and slopes are good for.
const PARTS: usize = 6;
/// Gains below this are not shown.
const FAINT: f64 = 1e-3;

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopRequest {
    /// The rotor.
    pub rotor: Arc<Rotor>,
    /// The gains and the parts of the loop.
    pub feedback: Feedback,
    /// The spin speed, in units of `w0`.
    pub speed: f64,
}

impl LoopRequest {
    /// What to ask about settings in force, at the speed that the machine runs at; nothing as long as the rotor is not known.
    pub fn of(era: &Era) -> Option<Self> {
        Some(Self { rotor: era.rotor.clone()?, feedback: era.settings.feedback.clone(), speed: era.speed })
    }

    /// What to ask about other settings of the same rotor.
    #[must_use]
    pub fn with(&self, settings: &Settings) -> Self {
        Self { rotor: self.rotor.clone(), feedback: settings.feedback.clone(), speed: settings.speed }
    }
}

/// The loop's gain at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopPoint {
    /// In radians per `tau`; negative for backward whirl.
    pub frequency: f64,
    /// `L`.
    pub gain: C64,
}

impl LoopPoint {
    /// The size of the sensitivity, `1 / |1 + L|`.
    #[must_use]
    pub fn sensitivity(&self) -> f64 {
        (self.gain + 1.0).norm().recip()
    }
}

/// The loop at one speed.
#[derive(Clone, Debug)]
pub struct LoopAnalysis {
    opened: Option<MachineLoop>,
    /// Its gain over frequencies of both signs, rising, as far as there is any to speak of; so close that straight lines between the
    /// points are as good as the curve.
    pub curve: Vec<LoopPoint>,
    /// Its margins, or why there are none.
    pub margins: Result<MachineMargins, MarginsError>,
}

impl LoopAnalysis {
    /// Computes the answer: some tenths of a millisecond for three masses.
    pub fn of(request: &LoopRequest) -> Self {
        let LoopRequest { rotor, feedback, speed } = request;
        let settings = Settings::new(rotor, *speed, feedback.clone());
        let margins = machine::margins(rotor, &settings, *speed);
        let opened = MachineLoop::at(rotor, &settings, *speed).ok();
        let points = |gain: &[[C64; 3]]| gain.windows(2).flat_map(|pair| between(pair[0], pair[1])).collect();
        let curve = match (&margins, &opened) {
            (Ok(found), _) => {
                points(&found.margins.curve.iter().map(|p| [p.frequency.into(), p.value, p.slope]).collect::<Vec<_>>())
            }
            // One that is not stable goes round -1, which can be seen.
            (Err(_), Some(opened)) => {
                let end = opened.gain.beyond(FAINT);
                let curve = opened.gain.curve(-end, end, &[0.0]);
                points(&curve.iter().map(|p| [p.frequency.into(), p.value, p.slope]).collect::<Vec<_>>())
            }
            (Err(_), None) => Vec::new(),
        };
        Self { opened, curve, margins }
    }

    /// The gain at a frequency, exactly; nothing where the loop cannot be had.
    #[must_use]
    pub fn at(&self, frequency: f64) -> Option<LoopPoint> {
        Some(LoopPoint { frequency, gain: self.opened.as_ref()?.gain.at(frequency).value })
    }

    /// The peak of the sensitivity: its size, and its frequency unless it is only approached; nothing without margins.
    #[must_use]
    pub fn peak(&self) -> Option<(f64, Option<f64>)> {
        let peak = self.margins.as_ref().ok()?.margins.sensitivity();
        Some((peak.amplitude, peak.frequency))
    }

    /// How much longer a delay it bears, in `tau`; nothing without margins, or where no delay is too long.
    #[must_use]
    pub fn delay(&self) -> Option<f64> {
        Some(self.margins.as_ref().ok()?.margins.delay?.delay)
    }
}

/// Points from `a` on to before `b`, each a frequency, a gain and its slope, on Hermite's cubic.
fn between([w0, l0, s0]: [C64; 3], [w1, l1, s1]: [C64; 3]) -> impl Iterator<Item = LoopPoint> {
    let width = (w1 - w0).re;
    (0..PARTS).map(move |part| {
        let t = part as f64 / PARTS as f64;
        let (u, tt, uu) = (1.0 - t, t * t, (1.0 - t) * (1.0 - t));
        let gain = l0 * (uu * (1.0 + 2.0 * t)) + l1 * (tt * (3.0 - 2.0 * t)) + (s0 * (uu * t) - s1 * (tt * u)) * width;
        LoopPoint { frequency: w0.re + t * width, gain }
    })
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn analysis(feedback: &str, speed: f64) -> LoopAnalysis {
        let rotor = builtin::rotor("three-mass").unwrap();
        let feedback = builtin::feedback(&rotor, feedback).unwrap();
        LoopAnalysis::of(&LoopRequest { rotor: Arc::new(rotor), feedback, speed })
    }

    #[test]
    fn val_margins_of_the_report_s_gains() {
        // As python-control has them for the realified loop.
        let composite = analysis("composite", 6.0);
        let (peak, at) = composite.peak().unwrap();
        assert!((peak - 10.3495).abs() < 1e-4 && (at.unwrap() - 2.27041).abs() < 1e-5, "{peak} {at:?}");
        assert!((composite.delay().unwrap() - 0.112_792).abs() < 1e-6);
        assert_eq!(sensitivity_zone(peak, ISO_14839_3), "D");
        let individual = analysis("individual", 6.0);
        assert!((individual.peak().unwrap().0 - 1.191_72).abs() < 1e-5);
    }

    #[test]
    fn the_curve_is_the_gain_and_has_the_peak() {
        let found = analysis("composite", 6.0);
        assert!(found.curve.is_sorted_by(|a, b| a.frequency < b.frequency));
        for point in found.curve.iter().step_by(7) {
            let exact = found.at(point.frequency).unwrap();
            let near = exact.gain.norm().min((exact.gain + 1.0).norm());
            assert!((point.gain - exact.gain).norm() <= 0.03 * near + 1e-6, "{point:?} {exact:?}");
        }
        let highest = found.curve.iter().map(LoopPoint::sensitivity).fold(0.0, f64::max);
        assert!((highest / found.peak().unwrap().0 - 1.0).abs() < 0.02, "{highest}");
    }

    #[test]
    fn what_is_not_stable_has_a_curve_and_no_margins() {
        let off = analysis("off", 6.0);
        assert!(matches!(off.margins, Err(MarginsError::Unstable { .. })) && off.peak().is_none());
        assert!(off.curve.iter().all(|point| point.gain == C64::ZERO), "nothing is fed back");
        let late = {
            let rotor = builtin::rotor("three-mass").unwrap();
            let mut feedback = builtin::feedback(&rotor, "composite").unwrap();
            feedback.bearings[0].parts.delay = 0.2;
            LoopAnalysis::of(&LoopRequest { rotor: Arc::new(rotor), feedback, speed: 6.0 })
        };
        assert!(late.margins.is_err() && late.curve.len() > 100, "{}", late.curve.len());
    }
}
