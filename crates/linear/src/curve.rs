//! A loop's gain as a curve over frequency: as many points as it takes for the curve between them to be known.
//!
//! Between two points the curve is the cubic through their values and slopes. Where the gain in the middle is off it by more
//! than a hundredth of its distance from 0 and from -1, whichever is nearer, the stretch is halved. So resonances and close
//! passes of -1 get the points that they need, whatever their width, and everything that is sought on the curve lies
//! between two neighbours that show it.

use std::f64::consts::PI;

use crate::{C64, FrequencyGain, LoopGain};

/// How far off the cubic the curve may be, relative to its distance from 0 and -1.
const OFF: f64 = 0.01;
/// Distances smaller than this are not resolved.
const LEAST: f64 = 1e-7;
/// Angles about each resonance at which a curve begins, in parts of a quarter turn.
const ABOUT: [f64; 4] = [0.3, 0.6, 0.85, 0.97];
/// The most halvings of a stretch.
const DEPTH: usize = 40;
/// How much farther than tangents say something may turn between two points.
const REACH: f64 = 2.0;
/// The most points of a curve.
const MOST: usize = 400_000;

impl LoopGain {
    /// The curve over `from..=to`, rising; with a point at each of `also` that lies within.
    #[must_use]
    pub fn curve(&self, from: f64, to: f64, also: &[f64]) -> Vec<FrequencyGain> {
        let mut starts: Vec<f64> = vec![from, to];
        starts.extend(also);
        for [centre, width] in self.resonances() {
            starts.push(centre);
            for part in ABOUT {
                let apart = width * (0.5 * PI * part).tan();
                starts.extend([centre - apart, centre + apart]);
            }
        }
        // Far out the curve is a power of the frequency.
        let mut far = 1.0_f64.max(1e-6 * to.abs().max(from.abs()));
        while far < to.abs().max(from.abs()) {
            starts.extend([far, -far]);
            far *= 4.0;
        }
        // Next to an integrator's pole at 0 the gain is rounding of infinities; nothing happens there that is not seen beside it.
        let quiet = self.quiet();
        starts.extend([quiet, -quiet]);
        starts.retain(|w| (from..=to).contains(w) && w.abs() >= quiet);
        starts.sort_by(f64::total_cmp);
        starts.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * (1.0 + a.abs()));
        let mut points = Vec::with_capacity(4 * starts.len());
        let Some(&first) = starts.first() else { return points };
        let mut here = self.at(first);
        points.push(here);
        for &next in &starts[1..] {
            let there = self.at(next);
            if next > quiet || here.frequency < -quiet {
                self.fill(here, there, DEPTH, &mut points);
            }
            points.push(there);
            here = there;
        }
        points
    }

    /// Points between two.
    fn fill(&self, a: FrequencyGain, b: FrequencyGain, depth: usize, points: &mut Vec<FrequencyGain>) {
        let width = b.frequency - a.frequency;
        let middle = self.at(0.5 * (a.frequency + b.frequency));
        let cubic = (a.value + b.value) * 0.5 + (a.slope - b.slope) * (width / 8.0);
        let near = middle.value.norm().min((middle.value + 1.0).norm());
        let is_known = (middle.value - cubic).norm() <= OFF * near + LEAST;
        if depth > 0 && !is_known && points.len() < MOST {
            self.fill(a, middle, depth - 1, points);
            points.push(middle);
            self.fill(middle, b, depth - 1, points);
        } else {
            points.push(middle);
        }
    }

    /// Where `value`, of `(value, slope)`, changes sign between two points: by Newton's method within the bracket; by false position
    /// (Illinois) where the slope is not a number.
    pub(crate) fn zero(&self, a: f64, b: f64, of: &dyn Fn(&FrequencyGain) -> [f64; 2]) -> FrequencyGain {
        let [mut low, mut high] = [a, b].map(|w| (w, of(&self.at(w))[0]));
        let rises = high.1 > 0.0;
        let mut w = 0.5 * (a + b);
        let (mut width, mut last_high) = (b - a, None);
        for k in 0..120 {
            let here = self.at(w);
            let [value, slope] = of(&here);
            if value == 0.0 {
                return here;
            }
            let is_high = (value > 0.0) == rises;
            let (end, other) = if is_high { (&mut high, &mut low) } else { (&mut low, &mut high) };
            // An end that stays counts half, lest it stay for ever.
            if last_high.replace(is_high) == Some(is_high) {
                other.1 *= 0.5;
            }
            *end = (w, value);
            let straight = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let guess = if slope.is_nan() { straight } else { w - value / slope };
            // Now and then it is halved, whatever the guesses say.
            let is_slow = k % 4 == 3 && high.0 - low.0 > 0.5 * width;
            if k % 4 == 3 {
                width = high.0 - low.0;
            }
            let next = if guess > low.0 && guess < high.0 && !is_slow { guess } else { 0.5 * (low.0 + high.0) };
            let last = 1e-15 * (1.0 + w.abs());
            if (next - w).abs() <= last || high.0 - low.0 <= last {
                return self.at(next);
            }
            w = next;
        }
        self.at(w)
    }
}

impl LoopGain {
    /// Every place on a curve at which `of`, of `[value, slope]`, is 0: where it changes sign between two neighbours, and where it heads for 0
    /// from both and goes past it between them.
    pub(crate) fn zeros(&self, curve: &[FrequencyGain], of: &dyn Fn(&FrequencyGain) -> [f64; 2]) -> Vec<FrequencyGain> {
        let mut found = Vec::new();
        for pair in curve.windows(2) {
            let [a, b] = [of(&pair[0]), of(&pair[1])];
            let ends = [0, 1].map(|k| pair[k].frequency);
            if !(a[0].is_finite() && b[0].is_finite()) {
                continue;
            }
            if (a[0] > 0.0) != (b[0] > 0.0) {
                found.push(self.zero(ends[0], ends[1], of));
                continue;
            }
            let away = if a[0] > 0.0 { 1.0 } else { -1.0 };
            // Seen from the side that both are on, a bowl does not go below where its tangents meet.
            let ([a, falls], [b, rises]) = (a.map(|x| away * x), b.map(|x| away * x));
            let width = ends[1] - ends[0];
            let meets = (b - a - rises * width) / (falls - rises);
            if !(falls < 0.0 && rises > 0.0 && a + falls * meets * REACH < 0.0) {
                continue;
            }
            let turn = self.zero(ends[0], ends[1], &|p| [of(p)[1], f64::NAN]);
            if (of(&turn)[0] > 0.0) != (away > 0.0) {
                found.push(self.zero(ends[0], turn.frequency, of));
                found.push(self.zero(turn.frequency, ends[1], of));
            }
        }
        found
    }
}

/// `ln |x|^2` changes at this rate when `x` does at `slope`.
pub(crate) fn growth(x: C64, slope: C64) -> f64 {
    2.0 * (slope / x).re
}
