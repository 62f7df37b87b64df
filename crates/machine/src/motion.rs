//! Speed in motion: where the spin is and how it goes on.
//!
//! Time lies on a grid, so that a day's run ends on the same steps as a minute's. The angle is a parabola over time, or the integral of
//! an exponential where the speed decays, and is put together anew where a leg of the speed's program begins: speed is
//! continuous there, unless it is to jump, and the angle always.

mod turning;

use std::collections::VecDeque;

use control::StateWords;
use rotor::profile::{Leg, REST_OF_DECAY};
use rotor::{C64, SpeedStage, Spin};
use turning::Turning;

/// Times closer than this part of a step are one.
pub(crate) const SAME_TIME: f64 = 1e-9;

/// The most legs that a program has.
pub const MAX_LEGS: usize = rotor::profile::MAX_LEGS;

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

/// What turns the spin where its speed is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    torque: f64,
    inertia: f64,
    drag: f64,
}

impl Drive {
    /// `R'` at a speed, while the unbalance takes so much torque.
    pub(crate) fn acceleration(&self, speed: f64, taken: f64) -> f64 {
        (self.torque - self.drag * speed - taken) / self.inertia
    }
}

/// Set in the number of legs that is written down where a drive stands behind them.
const DRIVEN: u64 = 1 << 32;

/// The spin over a leg, by its equation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpinLaw {
    from: f64,
    angle: f64,
    speed: f64,
    acceleration: f64,
    /// Rate of an exponential decay towards `asymptote`, which begins with `acceleration`; 0 for a steady rate of change.
    decay: f64,
    asymptote: f64,
}

impl SpinLaw {
    fn speed_at(&self, tau: f64) -> f64 {
        if self.acceleration == 0.0 {
            self.speed
        } else if self.decay == 0.0 {
            self.speed + self.acceleration * (tau - self.from)
        } else {
            self.asymptote + (self.speed - self.asymptote) * (-self.decay * (tau - self.from)).exp()
        }
    }

    fn acceleration_at(&self, tau: f64) -> f64 {
        if self.decay == 0.0 { self.acceleration } else { self.acceleration * (-self.decay * (tau - self.from)).exp() }
    }

    fn angle_at(&self, tau: f64) -> f64 {
        let t = tau - self.from;
        if self.decay != 0.0 {
            // The integral of the speed; `exp_m1` keeps the digits of a decay that has hardly begun.
            let faded = -(-self.decay * t).exp_m1() / self.decay;
            return self.angle + self.asymptote * t + (self.speed - self.asymptote) * faded;
        }
        let steady = self.angle + self.speed * t;
        if self.acceleration == 0.0 { steady } else { steady + 0.5 * self.acceleration * t * t }
    }

    fn spin_at(&self, tau: f64) -> Spin {
        let (speed, acceleration) = (self.speed_at(tau), self.acceleration_at(tau));
        Spin { speed, acceleration, direction: C64::cis(self.angle_at(tau)) }
    }
}

/// The spin over the present leg.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    law: SpinLaw,
    /// When the leg ends; infinite for the last.
    until: f64,
    /// The speed at which it ends, exactly.
    to: f64,
    legs: VecDeque<Leg>,
    /// What turns it, if the speed is a state of the machine: then `from`, `angle`, `speed` and `acceleration` are those of the last stretch.
    drive: Option<Drive>,
    /// The spin over the steps about the one that [`Motion::stages_over`] was asked for last.
    turning: Box<Turning>,
}

impl Motion {
    /// Spinning steadily from `tau` = 0 on.
    pub(crate) fn steady(speed: f64) -> Self {
        Self {
            law: SpinLaw { from: 0.0, angle: 0.0, speed, acceleration: 0.0, decay: 0.0, asymptote: speed },
            until: f64::INFINITY,
            to: speed,
            legs: VecDeque::with_capacity(MAX_LEGS),
            drive: None,
            turning: Box::new(Turning::none()),
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
        self.law.speed_at(tau)
    }

    /// The angle at which the present leg began.
    pub(crate) fn angle_from(&self) -> f64 {
        self.law.angle
    }

    /// The rate of change of the speed.
    pub(crate) fn acceleration_at(&self, tau: f64) -> f64 {
        self.law.acceleration_at(tau)
    }

    pub(crate) fn angle_at(&self, tau: f64) -> f64 {
        self.law.angle_at(tau)
    }

    pub(crate) fn spin_at(&self, tau: f64) -> Spin {
        self.law.spin_at(tau)
    }

    /// The spin at the beginning, in the middle and at the end of the next step of a grid; nothing if the present leg is over by its end.
    ///
    /// It is that of [`Motion::spin_at`] but for rounding, at a fraction of its cost, and hangs on leg and grid alone: a motion that is
    /// taken up in the middle of a leg goes on to the last bit.
    #[inline]
    pub(crate) fn stages_over(&mut self, grid: Grid) -> Option<&[SpeedStage; 3]> {
        let Self { law, turning, until, .. } = self;
        if turning.place(grid).is_none() {
            // What ends within rounding of a step ends with it.
            turning.make(law, grid, *until - SAME_TIME * grid.dtau);
        }
        Some(turning.at(turning.place(grid)?))
    }

    /// Whether a drive of given torque turns it, or will.
    pub(crate) fn is_driven(&self) -> bool {
        self.drive.is_some() || self.legs.iter().any(|leg| matches!(leg, Leg::Drive { .. }))
    }

    /// What turns the spin, if its speed is not given.
    pub(crate) fn drive(&self) -> Option<Drive> {
        self.drive
    }

    /// Where a drive has brought the spin.
    pub(crate) fn driven_to(&mut self, tau: f64, angle: f64, speed: f64, acceleration: f64) {
        self.law = SpinLaw { from: tau, angle, speed, acceleration, ..self.law };
        self.turning.clear();
        if speed <= 0.0 && acceleration < 0.0 {
            // A brake brings it to rest, and does not turn it back.
            let until = self.until;
            self.go(0.0, 0.0, until, 0.0);
        }
        self.to = self.law.speed;
    }

    /// Puts the spin at `angle`, to turn steadily from `tau` on with the speed that it has; what was to come is dropped.
    pub(crate) fn settle(&mut self, tau: f64, angle: f64, speed: f64) {
        self.legs.clear();
        (self.law.from, self.law.angle) = (tau, angle);
        self.go(speed, 0.0, f64::INFINITY, speed);
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
        (self.law.from, self.law.angle) = (tau, angle);
        while let Some(leg) = self.legs.pop_front() {
            match leg {
                Leg::To { speed: to, rate } => {
                    let duration = (to - speed).abs() / rate;
                    if duration > 0.0 {
                        return self.go(speed, (to - speed) / duration, tau + duration, to);
                    }
                    speed = to;
                }
                Leg::Decay { speed: to, rate } => {
                    let way = to - speed;
                    if way != 0.0 {
                        // An exponential never arrives: its last part is taken at a steady rate, that which it has then.
                        let decay = rate / way.abs();
                        let last = Leg::To { speed: to, rate: rate * REST_OF_DECAY };
                        self.legs.push_front(last);
                        let until = tau - REST_OF_DECAY.ln() / decay;
                        self.go(speed, decay * way, until, to - way * REST_OF_DECAY);
                        (self.law.decay, self.law.asymptote) = (decay, to);
                        return;
                    }
                }
                Leg::Drive { torque, inertia, drag, duration } => {
                    self.go(speed, 0.0, tau + duration, speed);
                    self.drive = Some(Drive { torque, inertia, drag });
                    return;
                }
                Leg::Dwell { duration } if duration > 0.0 => return self.go(speed, 0.0, tau + duration, speed),
                Leg::Dwell { .. } => {}
            }
        }
        self.go(speed, 0.0, f64::INFINITY, speed);
    }

    /// From `speed` on at a steady rate, until a time and up to a speed.
    fn go(&mut self, speed: f64, acceleration: f64, until: f64, to: f64) {
        (self.until, self.to, self.drive) = (until, to, None);
        self.law = SpinLaw { speed, acceleration, decay: 0.0, asymptote: speed, ..self.law };
        self.turning.clear();
    }

    pub(crate) fn save(&self, words: &mut StateWords) {
        let Self { law, until, to, legs, drive, turning: _ } = self;
        let SpinLaw { from, angle, speed, acceleration, decay, asymptote } = law;
        [*from, *angle, *speed, *acceleration, *decay, *asymptote, *until, *to]
            .into_iter()
            .for_each(|x| words.put_f64(x));
        words.put(legs.len() as u64 | if drive.is_some() { DRIVEN } else { 0 });
        for leg in legs {
            let (kind, numbers): (u64, &[f64]) = match leg {
                Leg::To { speed, rate } => (0, &[*speed, *rate]),
                Leg::Dwell { duration } => (1, &[*duration, 0.0]),
                Leg::Decay { speed, rate } => (2, &[*speed, *rate]),
                Leg::Drive { torque, inertia, drag, duration } => (3, &[*torque, *inertia, *drag, *duration]),
            };
            words.put(kind);
            numbers.iter().for_each(|number| words.put_f64(*number));
        }
        if let Some(Drive { torque, inertia, drag }) = drive {
            [*torque, *inertia, *drag].into_iter().for_each(|number| words.put_f64(number));
        }
    }

    pub(crate) fn restore(&mut self, words: &mut StateWords) -> Option<()> {
        let Self { law: SpinLaw { from, angle, speed, acceleration, decay, asymptote }, until, to, .. } = self;
        let places = [from, angle, speed, acceleration, decay, asymptote, until, to];
        for place in places {
            *place = words.take_f64()?;
        }
        self.turning.clear();
        self.legs.clear();
        let count = words.take()?;
        for _ in 0..Some(count & !DRIVEN).filter(|count| *count <= MAX_LEGS as u64)? {
            let (kind, first, second) = (words.take()?, words.take_f64()?, words.take_f64()?);
            self.legs.push_back(match kind {
                0 => Leg::To { speed: first, rate: second },
                1 => Leg::Dwell { duration: first },
                2 => Leg::Decay { speed: first, rate: second },
                3 => {
                    Leg::Drive { torque: first, inertia: second, drag: words.take_f64()?, duration: words.take_f64()? }
                }
                _ => return None,
            });
        }
        self.drive = match count & DRIVEN {
            0 => None,
            _ => Some(Drive { torque: words.take_f64()?, inertia: words.take_f64()?, drag: words.take_f64()? }),
        };
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
    fn val_a_decay_is_an_exponential_that_arrives() {
        let mut motion = Motion::steady(4.0);
        motion.follow(1.0, &[Leg::Decay { speed: 0.0, rate: 0.2 }]);
        // R = 4 exp(-t / 20) down to a hundredth, which takes 20 ln 100; then at its last rate to 0, another 20.
        let t = 7.0_f64;
        assert!((motion.speed_at(1.0 + t) - 4.0 * (-t / 20.0).exp()).abs() < 1e-14);
        assert!((motion.acceleration_at(1.0 + t) + 0.2 * (-t / 20.0).exp()).abs() < 1e-15);
        let turned = 4.0 * 20.0 * (1.0 - (-t / 20.0).exp());
        assert!((motion.angle_at(1.0 + t) - (4.0 + turned)).abs() < 1e-12, "angle 4 at tau = 1");
        let end = 1.0 + 20.0 * 100.0_f64.ln();
        assert!((motion.until() - end).abs() < 1e-11);
        let (before, angle) = (motion.acceleration_at(end), motion.angle_at(end));
        motion.pass(end + 1e-9);
        assert!((motion.speed_at(end) - 0.04).abs() < 1e-9 && (motion.acceleration_at(end) - before).abs() < 1e-12);
        assert!((motion.angle_at(end) - angle).abs() < 1e-9);
        motion.pass(end + 21.0);
        assert_eq!((motion.speed_at(end + 21.0), motion.is_moving()), (0.0, false));
        // And back up, saved half way.
        motion.follow(200.0, &[Leg::Decay { speed: 3.0, rate: 0.1 }, Leg::Dwell { duration: 2.0 }]);
        let mut words = StateWords::default();
        motion.save(&mut words);
        let mut other = Motion::steady(1.0);
        let mut words = StateWords::from_saved(words.as_slice().to_vec());
        other.restore(&mut words).unwrap();
        assert_eq!(other, motion);
    }

    #[test]
    fn a_jump_keeps_the_angle_and_is_over_at_once() {
        let mut motion = Motion::steady(2.0);
        motion.follow(5.0, &[Leg::To { speed: 6.0, rate: f64::INFINITY }]);
        assert_eq!((motion.angle_at(5.0), motion.speed_at(5.0), motion.is_moving()), (10.0, 6.0, false));
    }
}
