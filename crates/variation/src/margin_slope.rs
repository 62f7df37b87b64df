//! What a margin does when a parameter changes a little.
//!
//! The gain `L(j w)` of the loop is differentiated by the parameter at the very frequency at which the margin is. How that frequency moves
//! follows for a crossing from what holds there, and does not matter for a peak. A delay margin is that of a root on the axis, which has to
//! stay on it.
//!
//! ```text
//! gain    k L = -1       dk / k = -Re(L_p / L + L_w / L dw),  Im(L_p / L + L_w / L dw) = 0
//! phase   |L| = 1        da = Im(L_p / L + L_w / L dw),       Re(L_p / L + L_w / L dw) = 0
//! delay   Re s = 0       dT = -Re(s_p) / Re(s_T)
//! ```

use machine::{BearingMargins, MachineLoop, MachineMargins, WORST};
use rotor::{C64, LinearForm};

use crate::form_slope::{Change, delayed, of_delay};
use crate::model::Model;
use crate::parameter::Parameter;
use crate::sensitivity::NoSlope;
use crate::stencil::{Weighted, about};
use crate::variation_error::VariationError;

/// A margin of a loop that is opened at one bearing.
#[derive(Clone, Copy, Debug)]
struct MarginPlace {
    kind: Kind,
    bearing: usize,
    frequency: f64,
    /// The margin.
    value: f64,
    /// `L` there, and its slope over frequency.
    gain: [C64; 2],
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Gain,
    Phase,
    Sensitivity,
    /// With the gain at the frequency turned.
    Axis(C64),
    Complementary,
    Force,
}

/// A margin and its frequency.
type Told = (f64, Option<f64>);

/// The places at which the margins of a machine are.
pub(crate) struct Critical {
    places: [Option<MarginPlace>; WORST.len()],
    /// The machine with as much delay more as it bears, the root that is on the axis then, and how that moves with more delay.
    delay: Option<(f64, LinearForm, C64, f64)>,
}

impl Critical {
    pub(crate) fn of(model: &Model, form: &LinearForm, found: &MachineMargins) -> Result<Self, VariationError> {
        let loops = MachineLoop::each(&model.rotor, &model.settings, model.settings.speed)?;
        let place = |kind: Kind, of: &dyn Fn(&BearingMargins) -> Option<Told>, value: Option<f64>| {
            let value = value?;
            // Of several bearings that which has it.
            let bearing = found.bearings.iter().position(|bearing| of(bearing).is_some_and(|own| own.0 == value))?;
            let near = of(&found.bearings[bearing])?.1?;
            // What a peak does is read at its top: a little beside it the mixed slope counts. That of the force is found by its values
            // alone, to half the digits.
            let frequency = match kind {
                Kind::Force => top(near, |w| loops[bearing].force_per_noise(w)),
                _ => near,
            };
            let gain = loops[bearing].gain.at(frequency);
            let kind = match kind {
                Kind::Axis(_) => Kind::Axis(loops[bearing].gain.at(-frequency).value),
                kind => kind,
            };
            Some(MarginPlace { kind, bearing, frequency, value, gain: [gain.value, gain.slope] })
        };
        let all = &found.margins;
        let places = [
            None,
            place(
                Kind::Gain,
                &|of| of.margins.gain_up.map(|g| (g.factor, Some(g.frequency))),
                all.gain_up.map(|g| g.factor),
            ),
            place(
                Kind::Gain,
                &|of| of.margins.gain_down.map(|g| (g.factor, Some(g.frequency))),
                all.gain_down.map(|g| g.factor),
            ),
            place(
                Kind::Phase,
                &|of| of.margins.phase.map(|p| (p.angle, Some(p.frequency))),
                all.phase.map(|p| p.angle),
            ),
            place(
                Kind::Sensitivity,
                &|of| Some((of.margins.sensitivity().amplitude, of.margins.sensitivity().frequency)),
                Some(all.sensitivity().amplitude),
            ),
            place(
                Kind::Axis(C64::ZERO),
                &|of| Some((of.margins.axis.amplitude, of.margins.axis.frequency)),
                Some(all.axis.amplitude),
            ),
            place(
                Kind::Complementary,
                &|of| Some((of.margins.complementary.amplitude, of.margins.complementary.frequency)),
                Some(all.complementary.amplitude),
            ),
            place(Kind::Force, &|of| Some((of.force.amplitude, of.force.frequency)), Some(found.force.amplitude)),
        ];
        let delay = all.delay.and_then(|margin| {
            let late = delayed(form.clone(), margin.delay);
            let s = C64::new(0.0, margin.frequency);
            let root = if form.sample > 0.0 { (s * form.sample).exp() } else { s };
            let by_delay = of_delay(&late).ok()?.of_pole(&late, root).ok()?;
            Some((margin.delay, late, root, by_delay.re))
        });
        Ok(Self { places, delay })
    }

    /// The slope of each margin by a parameter.
    pub(crate) fn slopes(
        &self,
        model: &Model,
        parameter: &Parameter,
        change: Result<Change, NoSlope>,
    ) -> [Option<f64>; WORST.len()] {
        let loops: Result<Weighted<Vec<MachineLoop>>, NoSlope> =
            about(model.value(parameter), parameter.step(), |value| {
                let other = model.with(&[(parameter, value)])?;
                let speed = other.settings.speed;
                Ok(MachineLoop::each(&other.rotor, &other.settings, speed).map_err(VariationError::from)?)
            });
        let mut slopes = [None; WORST.len()];
        if let Ok(loops) = loops {
            for (slope, place) in slopes.iter_mut().zip(&self.places) {
                *slope = place.as_ref().map(|place| place.slope(&loops)).filter(|slope| slope.is_finite());
            }
        }
        slopes[0] = change.ok().and_then(|change| self.of_delay(change));
        slopes
    }

    fn of_delay(&self, change: Change) -> Option<f64> {
        let (margin, late, root, by_delay) = self.delay.as_ref()?;
        let moves = change.late_by(*margin).of_pole(late, *root).ok()?;
        Some(-moves.re / by_delay).filter(|slope| slope.is_finite())
    }
}

/// The top of a peak that is known to be near: Newton's method on differences, which leaves a top that it would lead away from.
fn top(near: f64, of: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-5 * (1e-3 + near.abs());
    let mut at = near;
    for _ in 0..4 {
        let [before, here, after] = [at - h, at, at + h].map(&of);
        let step = -0.5 * h * (after - before) / (after - 2.0 * here + before);
        if !(step.abs() < 100.0 * h && after - here < here - before) {
            return near;
        }
        at += step;
    }
    at
}

impl MarginPlace {
    fn slope(&self, loops: &Weighted<Vec<MachineLoop>>) -> f64 {
        // `L` is smooth where `S` has a peak, and so it is differentiated, not `S`.
        let by_parameter =
            |w: f64| -> C64 { loops.iter().map(|(weight, each)| each[self.bearing].gain.at(w).value * *weight).sum() };
        let (w, [gain, by_frequency]) = (self.frequency, self.gain);
        let [p, f] = [by_parameter(w) / gain, by_frequency / gain];
        let sensitivity = (gain + 1.0).inv();
        match self.kind {
            Kind::Gain => -self.value * (p.re - f.re * p.im / f.im),
            // The angle is that from -1, either way.
            Kind::Phase => (p.im - f.im * p.re / f.re) * (-gain).arg().signum(),
            Kind::Sensitivity => -sensitivity.norm() * (by_parameter(w) * sensitivity).re,
            Kind::Complementary => self.value * (p * sensitivity).re,
            Kind::Axis(behind) => {
                let [ahead, behind] = [sensitivity, (behind + 1.0).inv()];
                let value = ahead + behind.conj();
                let slope = ahead * ahead * by_parameter(w) + (behind * behind * by_parameter(-w)).conj();
                -0.5 * (value.conj() * slope).re / value.norm()
            }
            Kind::Force => {
                let noise = |(weight, each): &(f64, Vec<MachineLoop>)| weight * each[self.bearing].noise_to_force(w);
                let by_noise: f64 = loops.iter().map(noise).sum();
                by_noise * sensitivity.norm() - self.value * (by_parameter(w) * sensitivity).re
            }
        }
    }
}
