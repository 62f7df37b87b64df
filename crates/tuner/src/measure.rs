//! What a mode is worth: its damping ratio or its decay rate, forward and backward whirl weighted.

use rotor::{C64, damping_ratio};

/// Poles nearer the origin than this are slow.
const SLOW: f64 = 0.05;
/// A pole at the origin would have to decay by this, per unit of `tau`: within a thousand.
const CREEP: f64 = 1e-3;

/// How a pole is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Damping ratio `-Re / |lambda|` (4.28), divided by the weight of its whirl: with weight 2 on backward whirl, a
    /// backward mode counts as well damped as a forward one of half its damping ratio.
    Ratio {
        /// Weight of forward whirl, `Im >= 0`; above 0.
        forward: f64,
        /// Weight of backward whirl; above 0.
        backward: f64,
    },
    /// Decay rate `-Re lambda`, per unit of `tau`.
    Decay,
}

impl Default for Measure {
    fn default() -> Self {
        Self::Ratio { forward: 1.0, backward: 1.0 }
    }
}

impl Measure {
    /// The worth of a pole: positive if it decays.
    #[must_use]
    pub fn of(self, pole: C64) -> f64 {
        match self {
            Self::Ratio { forward, backward } => damping_ratio(pole) / if pole.im >= 0.0 { forward } else { backward },
            Self::Decay => 0.0 - pole.re,
        }
    }

    /// What it changes by when the pole moves by `(dre, dim)`: the two derivatives.
    pub(crate) fn slope(self, pole: C64) -> [f64; 2] {
        match self {
            Self::Ratio { forward, backward } => {
                let size = pole.norm();
                if size == 0.0 {
                    return [0.0; 2];
                }
                let by = pole.im / (size * size * size) / if pole.im >= 0.0 { forward } else { backward };
                [-pole.im * by, pole.re * by]
            }
            Self::Decay => [-1.0, 0.0],
        }
    }

    /// What a slow pole has in hand before it creeps: `-Re lambda - CREEP (1 - |lambda|^2 / SLOW^2)` for `|lambda| < SLOW`,
    /// with its two derivatives. `None` for other poles, and for decay rates.
    ///
    /// On its way through the origin the damping ratio of a real pole jumps from 1 to -1, and no slope announces it. So slow
    /// poles are kept off it.
    pub(crate) fn in_hand(self, pole: C64) -> Option<(f64, [f64; 2])> {
        let part = pole.norm_sqr() / (SLOW * SLOW);
        let by = 2.0 * CREEP / (SLOW * SLOW);
        (self != Self::Decay && part < 1.0)
            .then(|| (-pole.re - CREEP * (1.0 - part), [-1.0 + by * pole.re, by * pole.im]))
    }

    /// The region of poles worth at least `level`, as half planes: `Re(turn * (pole + shift)) <= 0` for each. `None` if it
    /// is not an intersection of half planes, as for damping ratios below 0.
    pub(crate) fn half_planes(self, level: f64) -> Option<Vec<(C64, f64)>> {
        match self {
            Self::Decay => Some(vec![(C64::ONE, level)]),
            Self::Ratio { forward, backward } => {
                let angles = [-level * forward, level * backward].map(f64::asin);
                // A sector around the negative real axis: one edge bounds forward whirl, the other backward.
                (level >= 0.0 && angles.iter().all(|a| a.is_finite()))
                    .then(|| angles.map(|angle| (C64::cis(angle), 0.0)).to_vec())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_pole() -> impl Strategy<Value = C64> {
        (-2.0..2.0, -3.0..3.0).prop_map(|(re, im)| C64::new(re, im)).prop_filter("away from 0", |z| z.im.abs() > 1e-3)
    }

    fn any_measure() -> impl Strategy<Value = Measure> {
        prop_oneof![
            Just(Measure::Decay),
            (0.2..3.0, 0.2..3.0).prop_map(|(forward, backward)| Measure::Ratio { forward, backward })
        ]
    }

    proptest! {
        #[test]
        fn half_planes_are_the_region_of_poles_worth_a_level(pole in any_pole(), measure in any_measure(), level in 0.0..0.3) {
            let inside = measure.half_planes(level).unwrap().iter().all(|(turn, shift)| (turn * (pole + shift)).re <= 0.0);
            prop_assume!((measure.of(pole) - level).abs() > 1e-12);
            prop_assert_eq!(inside, measure.of(pole) >= level);
        }

        #[test]
        fn slopes_are_those_of_the_worth(pole in any_pole(), measure in any_measure()) {
            let h = 1e-6 * pole.norm();
            let [by_re, by_im] = measure.slope(pole);
            let difference = |step: C64| (measure.of(pole + step) - measure.of(pole - step)) / (2.0 * h);
            let scale = 1.0 / pole.norm().min(1.0);
            prop_assert!((difference(C64::new(h, 0.0)) - by_re).abs() < 1e-5 * scale.powi(2));
            prop_assert!((difference(C64::new(0.0, h)) - by_im).abs() < 1e-5 * scale.powi(2));
        }
    }
}
