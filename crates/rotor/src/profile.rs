//! A program of spin speed: legs of change and of rest, one after the other.
//!
//! The drive is taken to hold it, whatever torque that needs: the rotor's motion does not act back on the speed. But for a leg of a
//! [`Leg::Drive`], whose torque is given: there the speed is a state of the machine, and a rotor can get stuck below a critical speed,
//! because its whirl takes the torque that should have made it faster (Sommerfeld's effect).

use text::number::significant;
use units::{Dimension, Units};

use crate::Scales;

/// The most legs that a profile has.
pub const MAX_LEGS: usize = 64;

/// The share of its way at which an exponential leg, which would never arrive, goes on at the rate that it has then.
pub const REST_OF_DECAY: f64 = 0.01;

/// A part of a speed's program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leg {
    /// To a speed, at so much per unit of `tau`; at once if that is infinite.
    To {
        /// The speed `R` it ends at.
        speed: f64,
        /// Rate of change, more than 0.
        rate: f64,
    },
    /// To a speed, ever more slowly: at a rate in proportion to what is left, as a rotor coasts down whose drag is in proportion to its
    /// speed. The last [`REST_OF_DECAY`] of the way is taken at the rate that is left then.
    Decay {
        /// The speed `R` it ends at.
        speed: f64,
        /// Rate of change at the beginning, more than 0.
        rate: f64,
    },
    /// Stays at the speed it has for so long.
    Dwell {
        /// How long, in `tau`.
        duration: f64,
    },
    /// Turned by a given torque, `J R' = T - c R - sum_i m_i e_i Im(exp(-j theta) a_i)`, where `a_i` is the acceleration of mass `i` without
    /// its unbalance. Seals are taken to push sideways alone: they take no torque.
    Drive {
        /// `T` in `K_t e_t^2`; below 0 it brakes, to rest at most.
        torque: f64,
        /// Polar inertia `J` of rotor and drive about the centres of mass, in `M_t e_t^2`; more than 0.
        inertia: f64,
        /// Drag `c`, torque per speed, in `M_t w0 e_t^2`; 0 or more.
        drag: f64,
        /// How long, in `tau`.
        duration: f64,
    },
}

impl Leg {
    /// How long it takes from the speed `from`, and the speed at which it ends; of a drive that at which it would end, at rest at
    /// least, if the rotor did not whirl.
    #[must_use]
    pub fn runs(&self, from: f64) -> (f64, f64) {
        match *self {
            Self::To { speed, rate } => ((speed - from).abs() / rate, speed),
            // ln(1/rest) time constants, and one for the rest.
            Self::Decay { speed, rate } => ((speed - from).abs() / rate * (1.0 - REST_OF_DECAY.ln()), speed),
            Self::Dwell { duration } => (duration, from),
            Self::Drive { torque, inertia, drag, duration } => {
                // R = T / c + (R0 - T / c) exp(-c t / J), without the difference of two large numbers where c is small.
                let fades = drag / inertia * duration;
                let share = if fades == 0.0 { 1.0 } else { -(-fades).exp_m1() / fades };
                (duration, (from + (torque - drag * from) / inertia * duration * share).max(0.0))
            }
        }
    }
}

/// A whole program of speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The speed `R` that it begins at.
    pub from: f64,
    /// Its legs: 1 to [`MAX_LEGS`].
    pub legs: Vec<Leg>,
    /// Where each leg stands in the file it was read from; 0 where there is none.
    pub lines: Vec<usize>,
}

impl Profile {
    /// From one speed to another at a rate.
    #[must_use]
    pub fn ramp(from: f64, to: f64, rate: f64) -> Self {
        Self { from, legs: vec![Leg::To { speed: to, rate }], lines: vec![0] }
    }

    /// When each leg begins, in `tau`, and the speed then; and last, when all are over.
    #[must_use]
    pub fn course(&self) -> Vec<(f64, f64)> {
        let mut course = vec![(0.0, self.from)];
        for leg in &self.legs {
            let (tau, speed) = *course.last().unwrap_or(&(0.0, self.from));
            let (takes, ends) = leg.runs(speed);
            course.push((tau + takes, ends));
        }
        course
    }

    /// Which leg it is on at a time, counted from 0; none once all are over.
    #[must_use]
    pub fn leg_at(&self, tau: f64) -> Option<usize> {
        self.course()[1..].iter().position(|(ends, _)| tau < *ends)
    }

    /// Whether a drive of given torque turns it for a while: then the speeds of its course are those of a rotor that does not whirl.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.legs.iter().any(|leg| matches!(leg, Leg::Drive { .. }))
    }

    /// How long it takes, in `tau`.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.course().last().map_or(0.0, |(tau, _)| *tau)
    }

    /// In words, in rpm, rpm/s and seconds where the rotor has scales: `the speed follows a profile: from 0 to 6 at 0.01, for 300, to 0
    /// from 0.02 on`.
    #[must_use]
    pub fn told(&self, scales: Option<Scales>) -> String {
        let units = Units::of(scales, 1.0);
        // What conversion leaves behind nine digits is not part of what was typed.
        let told = |dimension, value| significant(units.shown(dimension, value), 9);
        let [speed, rate, time] =
            [Dimension::Speed, Dimension::SpeedRate, Dimension::Time].map(|d| move |value| told(d, value));
        let legs = self.legs.iter().map(|leg| match *leg {
            Leg::To { speed: to, rate: at } => format!("to {} at {}", speed(to), rate(at)),
            Leg::Decay { speed: to, rate: from } => format!("to {} from {} on", speed(to), rate(from)),
            Leg::Dwell { duration } => format!("for {}", time(duration)),
            Leg::Drive { torque, duration, .. } => {
                let (torque, unit) = match scales {
                    None => (torque, ""),
                    Some(scales) => (torque * scales.k_t * scales.e_t * scales.e_t, " N m"),
                };
                format!("by a torque of {}{unit} for {}", significant(torque, 9), time(duration))
            }
        });
        let legs = legs.collect::<Vec<_>>().join(", ");
        format!("the speed follows a profile: from {} {legs}", speed(self.from))
    }

    /// The speed that it ends at.
    #[must_use]
    pub fn ends_at(&self) -> f64 {
        self.course().last().map_or(self.from, |(_, speed)| *speed)
    }

    /// The greatest rate of change of it; infinite if it only dwells.
    #[must_use]
    pub fn greatest_rate(&self) -> f64 {
        let rates = self.legs.iter().filter_map(|leg| match leg {
            Leg::To { rate, .. } | Leg::Decay { rate, .. } => Some(*rate),
            Leg::Drive { torque, inertia, .. } => Some(torque.abs() / inertia),
            Leg::Dwell { .. } => None,
        });
        rates.reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    /// The lowest and the highest speed of it.
    #[must_use]
    pub fn speeds(&self) -> [f64; 2] {
        let speeds = self.course().into_iter().map(|(_, speed)| speed);
        speeds.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], speed| [speed.min(low), speed.max(high)])
    }

    /// Leg `leg`, counted from 0, in words for a message: `leg 2 (line 7)`.
    #[must_use]
    pub fn leg_words(&self, leg: usize) -> String {
        match self.lines.get(leg) {
            None | Some(0) => format!("leg {}", leg + 1),
            Some(line) => format!("leg {} (line {line})", leg + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_is_the_sum_of_the_legs() {
        let legs = vec![
            Leg::To { speed: 6.0, rate: 0.01 },
            Leg::Dwell { duration: 300.0 },
            Leg::Decay { speed: 0.0, rate: 0.02 },
        ];
        let profile = Profile { from: 0.0, legs, lines: vec![1, 4, 6] };
        let course = profile.course();
        assert_eq!(course[..3], [(0.0, 0.0), (600.0, 6.0), (900.0, 6.0)]);
        // A time constant is 6 / 0.02 = 300.
        assert!((profile.duration() - (900.0 + 300.0 * (100.0_f64.ln() + 1.0))).abs() < 1e-9);
        assert_eq!(profile.told(None), "the speed follows a profile: from 0 to 6 at 0.01, for 300, to 0 from 0.02 on");
        assert_eq!((profile.speeds(), profile.leg_words(2)), ([0.0, 6.0], "leg 3 (line 6)".into()));
        assert_eq!(
            [0.0, 599.0, 600.0, 900.0, 1e4].map(|tau| profile.leg_at(tau)),
            [Some(0), Some(0), Some(1), Some(2), None]
        );
    }
}
