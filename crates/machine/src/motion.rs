//! Speed in motion: where the spin is and how it goes on.
//!
//! Time lies on a grid, so that a day's run ends on the same steps as a minute's. The angle is a parabola over time, which is
//! put together anew where a leg of the speed's program begins: speed is continuous there, unless it is to jump, and the
//! angle always.

use std::collections::VecDeque;

use control::Words;
use rotor::{C64, Spin};

/// The most legs that a program has.
pub const MAX_LEGS: usize = 64;

/// A part of a speed's program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leg {
    /// To a speed, at so much per unit of `tau`; at once if that is infinite.
    To {
        /// The speed `R` it ends at.
        speed: f64,
        /// Greatest rate of change, more than 0.
        rate: f64,
    },
    /// Stays at the speed it has for so long.
    Dwell {
        /// How long, in `tau`.
        duration: f64,
    },
}

/// Time on a grid: so many steps of `dtau` since `from`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Grid {
    pub(crate) from: f64,
    pub(crate) steps: u64,
    pub(crate) dtau: f64,
}

impl Grid {
    pub(crate) fn tau(&self) -> f64 {
        self.from + self.steps as f64 * self.dtau
    }

    /// Goes on in steps of another size.
    pub(crate) fn rebase(&mut self, dtau: f64) {
        if dtau != self.dtau {
            *self = Self { from: self.tau(), steps: 0, dtau };
        }
    }
}

/// The spin over the present leg.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    from: f64,
    angle: f64,
    speed: f64,
    acceleration: f64,
    /// When the leg ends; infinite for the last.
    until: f64,
    /// The speed at which it ends, exactly.
    to: f64,
    legs: VecDeque<Leg>,
}

impl Motion {
    /// Spinning steadily from `tau` = 0 on.
    pub(crate) fn steady(speed: f64) -> Self {
        Self {
            from: 0.0,
            angle: 0.0,
            speed,
            acceleration: 0.0,
            until: f64::INFINITY,
            to: speed,
            legs: VecDeque::with_capacity(MAX_LEGS),
        }
    }

    /// Whether the speed changes, or will by itself.
    pub(crate) fn is_moving(&self) -> bool {
        self.until.is_finite()
    }

    /// When the present leg ends; infinite if it does not.
    pub(crate) fn until(&self) -> f64 {
        self.until
    }

    pub(crate) fn speed_at(&self, tau: f64) -> f64 {
        if self.acceleration == 0.0 { self.speed } else { self.speed + self.acceleration * (tau - self.from) }
    }

    /// The angle at which the present leg began.
    pub(crate) fn angle_from(&self) -> f64 {
        self.angle
    }

    pub(crate) fn acceleration(&self) -> f64 {
        self.acceleration
    }

    pub(crate) fn angle_at(&self, tau: f64) -> f64 {
        let t = tau - self.from;
        let steady = self.angle + self.speed * t;
        if self.acceleration == 0.0 { steady } else { steady + 0.5 * self.acceleration * t * t }
    }

    pub(crate) fn spin_at(&self, tau: f64) -> Spin {
        let (speed, acceleration) = (self.speed_at(tau), self.acceleration);
        Spin { speed, acceleration, direction: C64::cis(self.angle_at(tau)) }
    }

    /// Puts the spin at `angle`, to turn steadily from `tau` on with the speed that it has; what was to come is dropped.
    pub(crate) fn settle(&mut self, tau: f64, angle: f64, speed: f64) {
        self.legs.clear();
        (self.from, self.angle, self.speed, self.acceleration) = (tau, angle, speed, 0.0);
        (self.until, self.to) = (f64::INFINITY, speed);
    }

    /// Follows other legs from `tau` on; those beyond [`MAX_LEGS`] are dropped.
    pub(crate) fn follow(&mut self, tau: f64, legs: &[Leg]) {
        self.legs.clear();
        self.legs.extend(legs.iter().take(MAX_LEGS));
        let (angle, speed) = (self.angle_at(tau), self.speed_at(tau));
        self.begin(tau, angle, speed);
    }

    /// Ends legs that are over at `tau`.
    pub(crate) fn pass(&mut self, tau: f64) {
        while self.until <= tau {
            let (end, angle) = (self.until, self.angle_at(self.until));
            self.begin(end, angle, self.to);
        }
    }

    /// Begins the next leg; without one, the spin stays as it is.
    fn begin(&mut self, tau: f64, angle: f64, mut speed: f64) {
        (self.from, self.angle) = (tau, angle);
        while let Some(leg) = self.legs.pop_front() {
            match leg {
                Leg::To { speed: to, rate } => {
                    let duration = (to - speed).abs() / rate;
                    if duration > 0.0 {
                        let acceleration = (to - speed) / duration;
                        (self.speed, self.acceleration, self.until, self.to) =
                            (speed, acceleration, tau + duration, to);
                        return;
                    }
                    speed = to;
                }
                Leg::Dwell { duration } if duration > 0.0 => {
                    (self.speed, self.acceleration, self.until, self.to) = (speed, 0.0, tau + duration, speed);
                    return;
                }
                Leg::Dwell { .. } => {}
            }
        }
        (self.speed, self.acceleration, self.until, self.to) = (speed, 0.0, f64::INFINITY, speed);
    }

    pub(crate) fn save(&self, words: &mut Words) {
        let Self { from, angle, speed, acceleration, until, to, legs } = self;
        [*from, *angle, *speed, *acceleration, *until, *to].into_iter().for_each(|x| words.put_f64(x));
        words.put(legs.len() as u64);
        for leg in legs {
            match *leg {
                Leg::To { speed, rate } => {
                    words.put(0);
                    words.put_f64(speed);
                    words.put_f64(rate);
                }
                Leg::Dwell { duration } => {
                    words.put(1);
                    words.put_f64(duration);
                }
            }
        }
    }

    pub(crate) fn restore(&mut self, words: &mut Words) -> Option<()> {
        let places =
            [&mut self.from, &mut self.angle, &mut self.speed, &mut self.acceleration, &mut self.until, &mut self.to];
        for place in places {
            *place = words.take_f64()?;
        }
        self.legs.clear();
        for _ in 0..words.take().filter(|count| *count <= MAX_LEGS as u64)? {
            let leg = match words.take()? {
                0 => Leg::To { speed: words.take_f64()?, rate: words.take_f64()? },
                1 => Leg::Dwell { duration: words.take_f64()? },
                _ => return None,
            };
            self.legs.push_back(leg);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_the_angle_of_a_ramp_is_its_integral() {
        let mut motion = Motion::steady(1.0);
        motion.follow(
            2.0,
            &[Leg::To { speed: 3.0, rate: 0.5 }, Leg::Dwell { duration: 1.0 }, Leg::To { speed: 0.0, rate: 3.0 }],
        );
        // By the trapezoidal rule, which is exact here but for the two bends.
        let (mut angle, step) = (motion.angle_at(2.0), 1e-4);
        for k in 0..80_000 {
            let (a, b) = (2.0 + f64::from(k) * step, 2.0 + f64::from(k + 1) * step);
            motion.pass(a);
            let before = motion.speed_at(a);
            motion.pass(b);
            angle += 0.5 * (before + motion.speed_at(b)) * step;
        }
        assert!((motion.angle_at(10.0) - angle).abs() < 1e-3, "{} {angle}", motion.angle_at(10.0));
        assert_eq!((motion.speed_at(10.0), motion.is_moving()), (0.0, false));
        // 2 + 4 s at 2 on average + 1 s at 3 + 1 s at 1.5 on average.
        assert!((motion.angle_at(10.0) - (2.0 + 8.0 + 3.0 + 1.5)).abs() < 1e-12);
    }

    #[test]
    fn a_jump_keeps_the_angle_and_is_over_at_once() {
        let mut motion = Motion::steady(2.0);
        motion.follow(5.0, &[Leg::To { speed: 6.0, rate: f64::INFINITY }]);
        assert_eq!((motion.angle_at(5.0), motion.speed_at(5.0), motion.is_moving()), (10.0, 6.0, false));
    }
}
