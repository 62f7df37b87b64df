//! What a mode is worth: its damping ratio or its decay rate, forward and backward whirl weighted; or both of them and its size, as a region
//! that all poles are to be in.

use rotor::{C64, damping_ratio};

use crate::Cost;

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
    /// How deep in a region it is.
    Region(Region),
    /// Not the poles, as long as they decay, but what unbalance and noise of the sensors make of the motion: `1 / J^2`. Where a pole does not
    /// decay, its decay rate.
    Cost(Cost),
}

/// A region of poles: a sector around the negative real axis, left of a vertical, within a circle. A pole is worth `t` if it is
/// within the region that damping and decay of `t` times as much and frequencies up to `frequency / t` make: 1 on its edge, more inside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// The damping ratio of its edge; above 0, below 1.
    pub damping: Option<f64>,
    /// The decay rate of its edge, per unit of `tau`; above 0.
    pub decay: Option<f64>,
    /// The largest `|lambda|`, in radians per `tau`; above 0.
    pub frequency: Option<f64>,
}

/// One number that is asked of a condition, smooth where poles are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// A damping ratio.
    Ratio,
    /// A decay rate.
    Decay,
    /// The size of a pole.
    Size,
    /// What is not of a pole: [`Measure::Cost`].
    Cost,
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
        self.aspects().map(|aspect| self.part(aspect, pole)).fold(f64::INFINITY, f64::min)
    }

    /// What of every pole is judged.
    pub(crate) fn aspects(self) -> impl Iterator<Item = Aspect> {
        let is_judged = move |aspect: &Aspect| match self {
            Self::Ratio { .. } => *aspect == Aspect::Ratio,
            Self::Decay | Self::Cost(_) => *aspect == Aspect::Decay,
            Self::Region(region) => match aspect {
                Aspect::Ratio => region.damping.is_some(),
                Aspect::Decay => region.decay.is_some(),
                Aspect::Size => region.frequency.is_some(),
                Aspect::Cost => false,
            },
        };
        [Aspect::Ratio, Aspect::Decay, Aspect::Size].into_iter().filter(is_judged)
    }

    /// By what an aspect of a pole counts divided.
    fn scale(self, aspect: Aspect, pole: C64) -> f64 {
        match (self, aspect) {
            (Self::Ratio { forward, backward }, _) => {
                if pole.im >= 0.0 {
                    forward
                } else {
                    backward
                }
            }
            (Self::Region(region), Aspect::Ratio) => region.damping.unwrap_or(1.0),
            (Self::Region(region), Aspect::Decay) => region.decay.unwrap_or(1.0),
            (Self::Region(region), Aspect::Size) => region.frequency.unwrap_or(1.0).recip(),
            _ => 1.0,
        }
    }

    /// One aspect of a pole.
    pub(crate) fn part(self, aspect: Aspect, pole: C64) -> f64 {
        let value = match aspect {
            Aspect::Ratio => damping_ratio(pole),
            Aspect::Decay | Aspect::Cost => 0.0 - pole.re,
            Aspect::Size => pole.norm().max(f64::MIN_POSITIVE.sqrt()).recip(),
        };
        value / self.scale(aspect, pole)
    }

    /// What it changes by when the pole moves by `(dre, dim)`: the two derivatives.
    pub(crate) fn slope(self, aspect: Aspect, pole: C64) -> [f64; 2] {
        let (size, scale) = (pole.norm(), self.scale(aspect, pole));
        match aspect {
            Aspect::Decay | Aspect::Cost => [-scale.recip(), 0.0],
            _ if size == 0.0 => [0.0; 2],
            Aspect::Ratio => {
                let by = pole.im / (size * size * size) / scale;
                [-pole.im * by, pole.re * by]
            }
            Aspect::Size => [pole.re, pole.im].map(|part| -part / (size * size * size) / scale),
        }
    }

    /// What a slow pole has in hand before it creeps: `-Re lambda - CREEP (1 - |lambda|^2 / SLOW^2)` for `|lambda| < SLOW`,
    /// with its two derivatives. `None` for other poles, and where no damping ratio is judged.
    ///
    /// On its way through the origin the damping ratio of a real pole jumps from 1 to -1, and no slope announces it. So slow
    /// poles are kept off it.
    pub(crate) fn in_hand(self, pole: C64) -> Option<(f64, [f64; 2])> {
        let part = pole.norm_sqr() / (SLOW * SLOW);
        let by = 2.0 * CREEP / (SLOW * SLOW);
        (part < 1.0 && self.aspects().any(|aspect| aspect == Aspect::Ratio))
            .then(|| (-pole.re - CREEP * (1.0 - part), [-1.0 + by * pole.re, by * pole.im]))
    }

    /// The region of poles worth at least `level`, as half planes: `Re(turn * (pole + shift)) <= 0` for each. `None` if it
    /// is not an intersection of half planes, as for damping ratios below 0, and within a circle.
    pub(crate) fn half_planes(self, level: f64) -> Option<Vec<(C64, f64)>> {
        let sector = |angles: [f64; 2]| {
            // A sector around the negative real axis: one edge bounds forward whirl, the other backward.
            let angles = angles.map(f64::asin);
            (level >= 0.0 && angles.iter().all(|a| a.is_finite()))
                .then(|| angles.map(|angle| (C64::cis(angle), 0.0)).to_vec())
        };
        match self {
            Self::Decay => Some(vec![(C64::ONE, level)]),
            Self::Ratio { forward, backward } => sector([-level * forward, level * backward]),
            Self::Region(Region { damping, decay, frequency: None }) => {
                let mut planes = damping.map_or(Some(Vec::new()), |edge| sector([-level * edge, level * edge]))?;
                planes.extend(decay.map(|edge| (C64::ONE, level * edge)));
                Some(planes)
            }
            Self::Region(_) | Self::Cost(_) => None,
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
        let region = (0.05..0.9, 0.01..1.0, proptest::option::of(0.5..4.0)).prop_map(|(damping, decay, frequency)| {
            Measure::Region(Region { damping: Some(damping), decay: Some(decay), frequency })
        });
        prop_oneof![
            region,
            Just(Measure::Decay),
            (0.2..3.0, 0.2..3.0).prop_map(|(forward, backward)| Measure::Ratio { forward, backward })
        ]
    }

    proptest! {
        #[test]
        fn half_planes_are_the_region_of_poles_worth_a_level(pole in any_pole(), measure in any_measure(), level in 0.0..0.3) {
            let Some(planes) = measure.half_planes(level) else { return Ok(()) };
            let inside = planes.iter().all(|(turn, shift)| (turn * (pole + shift)).re <= 0.0);
            prop_assume!((measure.of(pole) - level).abs() > 1e-12);
            prop_assert_eq!(inside, measure.of(pole) >= level);
        }

        #[test]
        fn slopes_are_those_of_the_worth(pole in any_pole(), measure in any_measure()) {
            let h = 1e-6 * pole.norm();
            for aspect in measure.aspects() {
                let [by_re, by_im] = measure.slope(aspect, pole);
                let there = |step: C64| measure.part(aspect, pole + step);
                let difference = |step: C64| (there(step) - there(-step)) / (2.0 * h);
                let scale = measure.scale(aspect, pole).recip().max(1.0) / pole.norm().min(1.0).powi(3);
                prop_assert!((difference(C64::new(h, 0.0)) - by_re).abs() < 1e-5 * scale);
                prop_assert!((difference(C64::new(0.0, h)) - by_im).abs() < 1e-5 * scale);
            }
        }

        #[test]
        fn a_pole_worth_a_level_is_in_the_region_made_so_much_tighter(pole in any_pole(), level in 0.1..3.0_f64) {
            let region = Region { damping: Some(0.2), decay: Some(0.1), frequency: Some(2.0) };
            let worth: f64 = Measure::Region(region).of(pole);
            prop_assume!((worth - level).abs() > 1e-12);
            let inside = damping_ratio(pole) >= 0.2 * level && -pole.re >= 0.1 * level && pole.norm() <= 2.0 / level;
            prop_assert_eq!(inside, worth >= level);
        }
    }
}
