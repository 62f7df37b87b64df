//! How far one loop is from instability: margins of delay, gain and phase, and peaks of its sensitivities, over frequencies
//! of both signs.
//!
//! Everything is found on the curve of the loop's gain ([`crate::curve`]) and made exact by Newton's method between two
//! neighbouring points: crossings of the unit circle and of the negative real axis, and maxima, which are zeros of slopes.

use crate::curve::growth;
use crate::loci::borne;
use crate::{C64, DelayMargin, FrequencyGain, LoopGain};

/// The largest factor on the loop's gain that is looked at: a loop that would have to be stronger has no gain margin.
pub const STRONGEST: f64 = 1e4;
/// The same with a delay, where there is no end of crossings.
pub const STRONGEST_LATE: f64 = 1e2;

/// A factor on the loop's gain that puts a root on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainMargin {
    /// The factor.
    pub factor: f64,
    /// The frequency of the root.
    pub frequency: f64,
}

/// An angle by which the loop's gain turns before a root is on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseMargin {
    /// The angle, in radians, either way.
    pub angle: f64,
    /// The frequency of the root.
    pub frequency: f64,
}

/// The largest amplitude over a range of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmplitudePeak {
    /// The amplitude.
    pub amplitude: f64,
    /// Where it is; `None` where it is only approached, as the frequency grows without bound.
    pub frequency: Option<f64>,
}

/// All margins of one loop that is stable.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// What delay more it takes; `None` if no delay does. Of a sampled loop, the phase at the crossing as time: what a delay
    /// does to it depends on the hold.
    pub delay: Option<DelayMargin>,
    /// The nearest factor above 1; `None` where there is none up to [`STRONGEST`], of a loop with a delay up to [`STRONGEST_LATE`].
    pub gain_up: Option<GainMargin>,
    /// The nearest factor below 1.
    pub gain_down: Option<GainMargin>,
    /// The smallest angle; `None` where the loop's gain is 1 nowhere.
    pub phase: Option<PhaseMargin>,
    /// `|S|` over positive frequencies.
    pub forward: AmplitudePeak,
    /// `|S|` over negative frequencies.
    pub backward: AmplitudePeak,
    /// One real axis, `|S(j w) + conj S(-j w)| / 2`, over positive frequencies.
    pub axis: AmplitudePeak,
    /// `|L / (1 + L)|` over both.
    pub complementary: AmplitudePeak,
    /// The curve of the gain that all of it was found on, frequencies rising.
    pub curve: Vec<FrequencyGain>,
}

impl Margins {
    /// `|S|` over frequencies of both signs.
    #[must_use]
    pub fn sensitivity(&self) -> AmplitudePeak {
        if self.backward.amplitude > self.forward.amplitude { self.backward } else { self.forward }
    }
}

impl LoopGain {
    /// All margins. The loop must be stable: margins of one that is not mean nothing.
    #[must_use]
    pub fn margins(&self) -> Margins {
        let strongest = if self.delay() > 0.0 { STRONGEST_LATE } else { STRONGEST };
        let end = self.beyond(strongest.recip());
        let curve = self.curve(-end, end, &[0.0]);
        let mut margins = Margins {
            delay: None,
            gain_up: None,
            gain_down: None,
            phase: None,
            forward: self.peak(curve.iter().filter(|p| p.frequency >= 0.0), &sensitivity, 1.0),
            backward: self.peak(curve.iter().filter(|p| p.frequency <= 0.0), &sensitivity, 1.0),
            axis: self.axis_peak(&curve),
            complementary: self.peak(curve.iter(), &complementary, 0.0),
            curve: Vec::new(),
        };
        for FrequencyGain { frequency, value, .. } in
            self.zeros(&curve, &|p| [p.value.norm_sqr().ln(), growth(p.value, p.slope)])
        {
            let angle = (-value).arg().abs();
            if margins.phase.is_none_or(|known| angle < known.angle) {
                margins.phase = Some(PhaseMargin { angle, frequency });
            }
            let delay = borne(value, frequency);
            if delay.is_finite() && margins.delay.is_none_or(|known| delay < known.delay) {
                margins.delay = Some(DelayMargin { delay, frequency });
            }
        }
        for FrequencyGain { frequency, value, .. } in self.zeros(&curve, &|p| [p.value.im, p.slope.im]) {
            // Between two points on either side of 0 the gain may jump through a pole.
            if value.re.is_finite() && value.re < 0.0 && value.im.abs() <= 1e-6 * value.re.abs() {
                let factor = -1.0 / value.re;
                let place = if factor > 1.0 { &mut margins.gain_up } else { &mut margins.gain_down };
                let is_nearer = |known: GainMargin| (factor - 1.0).abs() < (known.factor - 1.0).abs();
                if factor != 1.0 && factor < strongest && place.is_none_or(is_nearer) {
                    *place = Some(GainMargin { factor, frequency });
                }
            }
        }
        margins.curve = curve;
        margins
    }

    /// The largest amplitude on a curve, of `[ln amplitude^2, its slope]`, that far out comes to `far`.
    fn peak<'a>(
        &self,
        curve: impl Iterator<Item = &'a FrequencyGain>,
        of: &dyn Fn(&FrequencyGain) -> [f64; 2],
        far: f64,
    ) -> AmplitudePeak {
        let points: Vec<&FrequencyGain> = curve.collect();
        let mut best: (f64, Option<f64>) = (f64::NEG_INFINITY, None);
        for p in &points {
            let value = of(p)[0];
            if value > best.0 {
                best = (value, Some(p.frequency));
            }
        }
        for pair in points.windows(2) {
            let [a, b] = [of(pair[0]), of(pair[1])];
            if may_peak(pair[1].frequency - pair[0].frequency, [a, b], best.0) {
                let top = self.zero(pair[0].frequency, pair[1].frequency, &|p| [-of(p)[1], f64::NAN]);
                let value = of(&top)[0];
                if value > best.0 {
                    best = (value, Some(top.frequency));
                }
            }
        }
        self.told(best, far)
    }

    /// A peak of `ln amplitude^2`, or what is approached far out.
    fn told(&self, (value, frequency): (f64, Option<f64>), far: f64) -> AmplitudePeak {
        let amplitude = (0.5 * value).exp();
        if self.period() == 0.0 && amplitude <= far {
            return AmplitudePeak { amplitude: far, frequency: None };
        }
        AmplitudePeak { amplitude, frequency }
    }

    /// The peak of one real axis.
    fn axis_peak(&self, curve: &[FrequencyGain]) -> AmplitudePeak {
        let mut at: Vec<f64> = curve.iter().map(|p| p.frequency.abs()).collect();
        at.sort_by(f64::total_cmp);
        at.dedup();
        let of = |w: f64| {
            let [ahead, behind] = [w, -w].map(|w| {
                let gain = self.at(w);
                let s = gain.sensitivity();
                [s, -gain.slope * s * s]
            });
            let value = (ahead[0] + behind[0].conj()) * 0.5;
            let slope = (ahead[1] - behind[1].conj()) * 0.5;
            [value.norm_sqr().ln(), growth(value, slope)]
        };
        let values: Vec<[f64; 2]> = at.iter().map(|w| of(*w)).collect();
        let mut best = (f64::NEG_INFINITY, None);
        for (w, [value, _]) in at.iter().zip(&values) {
            if *value > best.0 {
                best = (*value, Some(*w));
            }
        }
        for (ends, pair) in at.windows(2).zip(values.windows(2)) {
            let [a, b] = [pair[0], pair[1]];
            if may_peak(ends[1] - ends[0], [a, b], best.0) {
                let [mut low, mut high] = [ends[0], ends[1]];
                while high - low > 1e-13 * (1.0 + high) {
                    let middle = 0.5 * (low + high);
                    if of(middle)[1] > 0.0 { low = middle } else { high = middle }
                }
                let value = of(low)[0];
                if value > best.0 {
                    best = (value, Some(low));
                }
            }
        }
        self.told(best, 1.0)
    }
}

/// Whether a logarithm with these values and slopes at two places may be larger than `best` between them.
///
/// About a close pass of -1, at `d` by a straight line, it is `-ln (d^2 + x^2)`: below its tangents as long as `x < d`, and then its
/// slope times the distance of the two places is less than 1. Else it is a needle between its flanks, as high as the pass is close.
fn may_peak(width: f64, [a, b]: [[f64; 2]; 2], best: f64) -> bool {
    let is_between = a[1] > 0.0 && b[1] < 0.0;
    let tangents = (a[0] + a[1] * width).min(b[0] - b[1] * width);
    is_between && (tangents > best || a[1].max(-b[1]) * width > 1.0)
}

/// `ln |S|^2` and its slope.
fn sensitivity(p: &FrequencyGain) -> [f64; 2] {
    let x: C64 = p.value + 1.0;
    [-x.norm_sqr().ln(), -growth(x, p.slope)]
}

/// `ln |T|^2` and its slope.
fn complementary(p: &FrequencyGain) -> [f64; 2] {
    let [value, slope] = sensitivity(p);
    [value + p.value.norm_sqr().ln(), slope + growth(p.value, p.slope)]
}
