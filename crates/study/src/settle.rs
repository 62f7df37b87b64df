//! When transients have died: windows of the motion that no longer differ.
//!
//! The run is cut into windows of whole turns (at least 8 units of `tau`, at most 200), and of each window are kept the largest |u|, and
//! the largest and mean radius of every mass. It has settled
//!
//! * *steadily* when what is still to come of the change from window to window, extrapolated as a geometric series, is
//!   below `1e-9` of the values: the slower the decay, the smaller must the change be. The ratio of the series is that of the
//!   largest change in the last four windows to the largest in the four before, so that the nodes of a beating
//!   transient are not taken for its end;
//! * *beating* when it does not come to rest (several frequencies at once, such as a limit cycle under unbalance) but the
//!   last half of the run and the quarter before it agree to `1e-3` in every maximum and mean, each at least 24 windows long.

use rotor::MAX_MASSES;

const STEADY: f64 = 1e-9;
/// Changes this small are rounding.
const ROUNDING: f64 = 1e-13;
const BEATING: f64 = 1e-3;
const FEWEST_IN_BLOCK: usize = 24;
/// Windows kept: a run that beats on for longer goes on in windows twice as long.
const MOST_WINDOWS: usize = 1 << 12;
/// Windows over which the largest change is taken.
const SPAN: usize = 4;

/// What is kept of a stretch of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Where it begins.
    pub from: f64,
    /// Largest `|u|^2`, `u_y^2`, `u_z^2`, then `|p|^2` of every mass.
    pub maxima: [f64; 3 + MAX_MASSES],
    /// Sum of `|p|` over the samples, per mass.
    pub radius_sum: [f64; MAX_MASSES],
    /// How many samples.
    pub samples: u64,
}

impl Stretch {
    pub(crate) fn new(from: f64) -> Self {
        Self { from, maxima: [0.0; 3 + MAX_MASSES], radius_sum: [0.0; MAX_MASSES], samples: 0 }
    }

    /// Both together.
    pub(crate) fn joined(mut self, later: &Self) -> Self {
        for (a, b) in self.maxima.iter_mut().zip(&later.maxima) {
            *a = a.max(*b);
        }
        for (a, b) in self.radius_sum.iter_mut().zip(&later.radius_sum) {
            *a += b;
        }
        self.samples += later.samples;
        self
    }

    /// Mean radius of mass `k`.
    pub(crate) fn mean_radius(&self, k: usize) -> f64 {
        if self.samples == 0 { 0.0 } else { self.radius_sum[k] / self.samples as f64 }
    }

    /// What is compared: the force, then the largest and mean radii; and the scale of each.
    fn signature(&self, masses: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let force = self.maxima[0].sqrt();
        let widest = self.maxima[3..3 + masses].iter().fold(0.0_f64, |a, b| a.max(*b)).sqrt();
        let radii = (0..masses).flat_map(move |k| [self.maxima[3 + k].sqrt(), self.mean_radius(k)]);
        std::iter::once((force, force)).chain(radii.map(move |r| (r, widest)))
    }

    /// The largest relative difference in any of them.
    fn difference(&self, other: &Self, masses: usize) -> f64 {
        self.signature(masses)
            .zip(other.signature(masses))
            .map(|((a, scale_a), (b, scale_b))| {
                let scale = scale_a.max(scale_b);
                if scale > 0.0 { (a - b).abs() / scale } else { 0.0 }
            })
            .fold(0.0, f64::max)
    }
}

/// How a run came to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Settled {
    /// The caller said from where the maxima are taken.
    Given,
    /// Maxima and means no longer change.
    Steady,
    /// Several frequencies at once: they change from window to window, but not in the long run.
    Beating,
    /// Not within the duration.
    No,
}

/// Looks at windows as they come.
#[derive(Clone, Debug)]
pub(crate) struct Detector {
    masses: usize,
    windows: Vec<Stretch>,
    changes: Vec<f64>,
    /// How many of the windows that come are one of those kept, and those that do not make up one yet.
    each: usize,
    begun: Vec<Stretch>,
    verdict: Option<(Settled, usize)>,
}

impl Detector {
    pub(crate) fn new(masses: usize) -> Self {
        Self { masses, windows: Vec::new(), changes: Vec::new(), each: 1, begun: Vec::new(), verdict: None }
    }

    /// Takes the next window; whether the motion has settled by now.
    pub(crate) fn push(&mut self, window: Stretch) -> bool {
        if let (Some(_), Some(last)) = (self.verdict, self.windows.last_mut()) {
            *last = last.joined(&window);
            return true;
        }
        self.begun.push(window);
        if self.begun.len() < self.each {
            return false;
        }
        let Some(window) = all(&self.begun) else { return false };
        self.begun.clear();
        self.windows.push(window);
        let count = self.windows.len();
        if count < 2 {
            return false;
        }
        self.changes.push(window.difference(&self.windows[count - 2], self.masses));
        if self.change_to_come() <= STEADY {
            self.verdict = Some((Settled::Steady, count - 1));
        } else if count >= 4 * FEWEST_IN_BLOCK && count.is_multiple_of(8) {
            let join =
                |from: usize, to: usize| self.windows[from + 1..to].iter().fold(self.windows[from], |a, b| a.joined(b));
            let (before, after) = (join(count / 4, count / 2), join(count / 2, count));
            if before.difference(&after, self.masses) <= BEATING {
                self.verdict = Some((Settled::Beating, count / 2));
            }
        }
        if self.verdict.is_none() && count == MOST_WINDOWS {
            self.windows = self.windows.chunks(2).filter_map(all).collect();
            self.changes = self.windows.windows(2).map(|w| w[1].difference(&w[0], self.masses)).collect();
            self.each *= 2;
        }
        self.verdict.is_some()
    }

    /// What is still to come of the changes if they go on to shrink as they do; infinite if they do not shrink.
    fn change_to_come(&self) -> f64 {
        let count = self.changes.len();
        let largest = |from: usize, to: usize| self.changes[from..to].iter().copied().fold(0.0, f64::max);
        if count >= SPAN && largest(count - SPAN, count) <= ROUNDING {
            return 0.0;
        }
        if count < 2 * SPAN {
            return f64::INFINITY;
        }
        let (before, now) = (largest(count - 2 * SPAN, count - SPAN), largest(count - SPAN, count));
        let ratio = (now / before).powf(1.0 / SPAN as f64);
        if ratio < 1.0 { now / (1.0 - ratio) } else { f64::INFINITY }
    }

    /// How it settled, and everything from there on; or, if it did not, the last half.
    pub(crate) fn result(&self) -> (Settled, Option<Stretch>) {
        let (settled, from) = self.verdict.unwrap_or((Settled::No, self.windows.len() / 2));
        let rest = all(self.windows.get(from..).unwrap_or_default());
        let begun = all(&self.begun);
        let both = rest.zip(begun).map(|(rest, begun)| rest.joined(&begun));
        (settled, both.or(rest).or(begun))
    }
}

/// All of them together.
fn all(stretches: &[Stretch]) -> Option<Stretch> {
    stretches.iter().copied().reduce(|a, b| a.joined(&b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window whose one radius is `size`.
    fn window(from: f64, size: f64) -> Stretch {
        let mut window = Stretch::new(from);
        (window.maxima[0], window.maxima[3]) = (size * size, size * size);
        (window.radius_sum[0], window.samples) = (size, 1);
        window
    }

    #[test]
    fn a_run_that_never_settles_keeps_its_last_half_in_bounded_room() {
        let mut detector = Detector::new(1);
        let count = 5 * MOST_WINDOWS / 2;
        // A slow ramp: no half is like the one before.
        for i in 0..count {
            assert!(!detector.push(window(i as f64, 1.0 + i as f64)));
        }
        assert!(detector.windows.len() < MOST_WINDOWS && detector.each == 4);
        let (settled, Some(rest)) = detector.result() else { panic!("windows were seen") };
        assert_eq!(settled, Settled::No);
        assert!((rest.from - count as f64 / 2.0).abs() <= 4.0 && rest.maxima[0].sqrt() == count as f64);
        assert_eq!(rest.samples as f64, count as f64 - rest.from);
    }

    #[test]
    fn what_comes_after_the_verdict_counts() {
        let mut detector = Detector::new(1);
        let settled = (0..20).map(|i| detector.push(window(f64::from(i), 1.0))).position(|settled| settled);
        assert!(settled.is_some());
        assert!(detector.push(window(20.0, 2.0)));
        let (settled, Some(rest)) = detector.result() else { panic!("windows were seen") };
        assert_eq!((settled, rest.maxima[0]), (Settled::Steady, 4.0));
    }
}
