//! What turns control into a force, bearing by bearing.
//!
//! Control is what a bearing does to the place that carries it: of a chain the acceleration of that mass, in `w0^2 e_t`; of shaft elements a
//! force, in `K_t e_t`. So the same number of it is another force at a bearing on another mass. What is one number of several bearings (the
//! largest force, a limit that is asked of all) is counted as if the first bearing had to give it, in `m_b w0^2 e_t` with `m_b` the mass
//! that carries the first.

use crate::{Feedback, Key, MAX_BEARINGS, Rotor, Scope};

/// The mass ratio `Rm` of what carries each control bearing of a machine; 1 of shaft elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlMasses {
    ratios: [f64; MAX_BEARINGS],
    /// How many signals drive each.
    signals: [usize; MAX_BEARINGS],
}

impl Default for ControlMasses {
    /// Where control is a force already, or where no machine is known.
    fn default() -> Self {
        Self::ONES
    }
}

impl ControlMasses {
    /// All 1.
    pub const ONES: Self = Self { ratios: [1.0; MAX_BEARINGS], signals: [0; MAX_BEARINGS] };

    /// Those of a machine.
    #[must_use]
    pub fn of(rotor: &Rotor, feedback: &Feedback) -> Self {
        let mut masses = Self::default();
        for (place, bearing) in feedback.bearings.iter().enumerate().take(MAX_BEARINGS) {
            masses.ratios[place] = rotor.control_mass(bearing.station);
            masses.signals[place] = bearing.signals.len();
        }
        masses
    }

    /// `Rm` of a control bearing, counted from 0; 1 where there is none.
    #[must_use]
    pub fn ratio(&self, bearing: usize) -> f64 {
        self.ratios.get(bearing).copied().unwrap_or(1.0)
    }

    /// `Rm` by which a setting is a force or a gain, if it is one: that of its control bearing, or of the first where it is of all.
    #[must_use]
    pub fn of_key(&self, key: Key) -> f64 {
        let place = key.index.unwrap_or(0);
        self.ratio(match key.parameter.scope {
            Scope::Bearing => place,
            Scope::Signal => self.bearing_of_signal(place),
            Scope::Machine | Scope::Mass => 0,
        })
    }

    /// The control bearing that a signal drives, both counted from 0; the first where there is no such signal.
    fn bearing_of_signal(&self, signal: usize) -> usize {
        let mut before = 0;
        let is_past = |count: &usize| {
            before += count;
            signal < before
        };
        self.signals.iter().position(is_past).unwrap_or(0)
    }

    /// The control of a bearing as that of the first one which is as large a force: `u Rm / Rm_first`.
    #[must_use]
    pub fn as_of_first(&self, bearing: usize, control: f64) -> f64 {
        control * (self.ratio(bearing) / self.ratio(0))
    }

    /// The largest force of the bearings, of the control of each from the first on, as that of the first. What is not a number is not
    /// lost among others.
    #[must_use]
    pub fn largest(&self, controls: impl IntoIterator<Item = f64>) -> f64 {
        let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
        controls.into_iter().enumerate().map(|(bearing, control)| self.as_of_first(bearing, control)).fold(0.0, larger)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ControlBearing, PhysicalMass, Settings, Signal, builtin};

    /// 30 kg and 10 kg with a bearing each, the second one first.
    fn unequal() -> (Rotor, Feedback) {
        let mass = |mass| PhysicalMass { mass, bearing_stiffness: 1e6, unbalance: 1e-5, ..PhysicalMass::default() };
        let rotor = Rotor::from_si("two", vec![mass(30.0), mass(10.0)], vec![1e6], None).expect("valid");
        let bearings = vec![ControlBearing::new(1, vec![]), ControlBearing::new(0, vec![])];
        (rotor, Feedback { bearings })
    }

    #[test]
    fn val_the_same_acceleration_is_three_times_the_force_on_three_times_the_mass() {
        let (rotor, feedback) = unequal();
        let masses = ControlMasses::of(&rotor, &feedback);
        assert_eq!([0, 1, 2].map(|bearing| masses.ratio(bearing)), [0.25, 0.75, 1.0]);
        assert_eq!(masses.as_of_first(1, 2.0), 6.0);
        assert_eq!(masses.largest([5.0, 2.0]), 6.0);
        assert!(masses.largest([f64::NAN, 2.0]).is_nan() && masses.largest([2.0, f64::NAN]).is_nan());
    }

    #[test]
    fn a_setting_is_a_force_by_the_mass_of_its_own_bearing() {
        let (rotor, feedback) = unequal();
        let masses = ControlMasses::of(&rotor, &feedback);
        let settings = Settings::new(&rotor, 0.0, feedback);
        let of = |key: &str| masses.of_key(settings.key(key).expect("a key"));
        assert_eq!(["limit.1", "2.limit", "slew.2", "limit", "speed"].map(of), [0.25, 0.75, 0.75, 0.25, 0.25]);
        let mut feedback = settings.feedback;
        feedback.bearings[0].signals = vec![Signal::at_mass(0, 2, [0.0; 4]), Signal::at_mass(1, 2, [0.0; 4])];
        feedback.bearings[1].signals = vec![Signal::at_mass(0, 2, [0.0; 4])];
        let masses = ControlMasses::of(&rotor, &feedback);
        let of = |key: &str| masses.of_key(key.parse().expect("a key"));
        assert_eq!(["kd", "kd.2", "cc.3", "kd.4"].map(of), [0.25, 0.25, 0.75, 0.25], "a gain likewise");
    }

    #[test]
    fn control_of_shaft_elements_is_a_force_already() {
        let rotor = builtin::rotor("rig").expect("built in");
        let feedback = builtin::feedback(&rotor, "own").expect("built in");
        let masses = ControlMasses::of(&rotor, &feedback);
        assert_eq!([0, 1].map(|bearing| masses.ratio(bearing)), [1.0; 2]);
    }
}
