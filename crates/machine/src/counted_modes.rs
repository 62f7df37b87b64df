//! Which modes the smallest damping of a machine is told of.
//!
//! The fastest modes of a rotor of shaft elements are those of its elements, not of its shaft: their frequency says how finely it is cut, or
//! to how many coordinates it was reduced, and hardly any gain moves them. Damped by what little the shaft has, they would be the least
//! damped of every such machine and hide the modes that matter. So the smallest damping is that of the modes up to some frequency; those
//! above are only asked to decay, and count where they do not. Of a chain of masses every mode counts.

use rotor::{C64, Rotor, Settings, damping_ratio};

use crate::poles::{MachinePoles, PolesError};

/// By default modes count up to so many times the top speed, at least.
const TOP_SPEEDS: f64 = 4.0;
/// And so many forward modes count, at least.
const WHIRL_PAIRS: usize = 4;
/// What is damped better does not whirl to speak of: it is a state of the loop.
const WHIRLS: f64 = 0.5;

/// The modes that count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CountedModes {
    below: Option<f64>,
}

impl CountedModes {
    /// All of them.
    pub const ALL: Self = Self { below: None };

    /// Those with `|lambda|` up to `below`, in radians per `tau`.
    #[must_use]
    pub fn up_to(below: f64) -> Self {
        Self { below: Some(below) }
    }

    /// Those that count where nobody says: all of a chain; of shaft elements those up to four times the top speed, and so far that four
    /// forward modes count at it.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub fn usual(rotor: &Rotor, settings: &Settings, top_speed: f64) -> Result<Self, PolesError> {
        if rotor.is_chain() {
            return Ok(Self::ALL);
        }
        let modes = MachinePoles::at(rotor, settings, top_speed)?.modes;
        Ok(Self::usual_among(modes.into_iter().map(|mode| mode.pole), top_speed))
    }

    /// The same of shaft elements with these poles at the top speed.
    #[must_use]
    pub fn usual_among(poles: impl IntoIterator<Item = C64>, top_speed: f64) -> Self {
        let is_forward = |pole: &C64| pole.im > 0.0 && damping_ratio(*pole).abs() < WHIRLS;
        let mut whirls: Vec<f64> = poles.into_iter().filter(is_forward).map(|pole| pole.norm()).collect();
        whirls.sort_by(f64::total_cmp);
        // Between the last that counts and the next.
        let between = match whirls.get(WHIRL_PAIRS - 1..) {
            Some([last, next, ..]) => (last * next).sqrt(),
            Some([last]) => 2.0 * last,
            _ => 0.0,
        };
        Self { below: Some((TOP_SPEEDS * top_speed.abs()).max(between)).filter(|below| *below > 0.0) }
    }

    /// Those that count of a rotor at a speed at which it has these poles: what a minimum damping is told of where a machine runs.
    #[must_use]
    pub fn at(rotor: &Rotor, speed: f64, poles: impl IntoIterator<Item = C64>) -> Self {
        if rotor.is_chain() { Self::ALL } else { Self::usual_among(poles, speed) }
    }

    /// Up to where modes count, `|lambda|` in radians per `tau`; `None` where all do.
    #[must_use]
    pub fn below(&self) -> Option<f64> {
        self.below
    }

    /// Whether the damping of a mode counts.
    #[must_use]
    pub fn counts(&self, pole: C64) -> bool {
        self.below.is_none_or(|below| pole.norm() <= below)
    }

    /// Of some poles those that count, and those of the others that do not decay: the smallest damping ratio of all these is that of
    /// the machine.
    pub fn among<'a>(&'a self, poles: impl IntoIterator<Item = C64> + 'a) -> impl Iterator<Item = C64> + 'a {
        poles.into_iter().filter(|pole| self.counts(*pole) || pole.re >= 0.0)
    }

    /// The smallest damping ratio of some poles, of those that count; not a number where none does.
    #[must_use]
    pub fn min_damping(&self, poles: impl IntoIterator<Item = C64>) -> f64 {
        self.among(poles).map(damping_ratio).reduce(f64::min).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn pole(damping: f64, size: f64) -> C64 {
        C64::from_polar(size, std::f64::consts::FRAC_PI_2 + f64::asin(damping))
    }

    #[test]
    fn fast_modes_that_decay_do_not_count_and_those_that_grow_do() {
        let poles = [pole(0.05, 1.0), pole(0.001, 9.0), pole(0.3, 2.0)];
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} and {expected}");
        near(CountedModes::ALL.min_damping(poles), 0.001);
        near(CountedModes::up_to(5.0).min_damping(poles), 0.05);
        near(CountedModes::up_to(5.0).min_damping(poles.into_iter().chain([pole(-0.01, 20.0)])), -0.01);
        assert_eq!(CountedModes::up_to(5.0).min_damping(poles.into_iter().chain([C64::new(0.0, 7.0)])), 0.0);
        assert!(CountedModes::up_to(0.5).min_damping(poles).is_nan());
    }

    #[test]
    fn by_default_four_forward_modes_count_and_all_up_to_four_times_the_speed() {
        let forward = [1.0, 2.0, 4.0, 9.0, 16.0, 100.0].map(|size| pole(0.1, size));
        // What the loop has of its own, and backward whirl, is not counted off.
        let others = [pole(0.9, 3.0), pole(0.1, 3.5).conj()];
        let all = || forward.into_iter().chain(others);
        assert!((CountedModes::usual_among(all(), 1.0).below().expect("somewhere") - 12.0).abs() < 1e-12);
        assert_eq!(CountedModes::usual_among(all(), -6.0).below(), Some(24.0));
        assert_eq!(CountedModes::usual_among(forward[..4].to_vec(), 1.0).below(), Some(2.0 * forward[3].norm()));
        assert_eq!(CountedModes::usual_among([], 0.0), CountedModes::ALL);
    }

    #[test]
    fn every_mode_of_a_chain_counts() {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "individual").expect("built in"));
        assert_eq!(CountedModes::usual(&rotor, &settings, 6.0), Ok(CountedModes::ALL));
    }
}
