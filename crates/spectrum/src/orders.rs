//! Order tracking: what of a motion turns with the spin, turn by turn.
//!
//! The motion is read at equal angles of the spin, [`PER_TURN`] a turn, between two steps by the cubic that has their displacements and
//! velocities. The mean of `q exp(-j theta)` over the last turn is the first order: every other whole order has no share in
//! it. Over [`LONG`] turns, under a Hann window, what whirls more slowly than the spin is told apart.

use std::f64::consts::TAU;
use std::sync::Arc;

use rotor::C64;

/// Readings a turn.
pub const PER_TURN: usize = 32;
/// Turns of the long window.
const LONG: usize = 8;
/// Orders up to so many times `1 / LONG` are subsynchronous: the window spreads the first order over the three next to it.
const SLOW: usize = LONG - 2;

/// A motion at one moment.
#[derive(Clone, Copy, Debug)]
pub struct OrderSample<'a> {
    /// Time, in `tau`.
    pub tau: f64,
    /// Spin angle in radians, unwrapped.
    pub angle: f64,
    /// Spin speed `R`.
    pub speed: f64,
    /// Displacement of every station, in `e_t`.
    pub displacement: &'a [C64],
    /// Their velocities.
    pub velocity: &'a [C64],
    /// The size of the control force, in `w0^2 e_t`.
    pub force: f64,
}

/// What was read over one turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// Time, the middle of the turn.
    pub tau: f64,
    /// Spin speed `R`, its mean over the turn.
    pub speed: f64,
    /// First order of every station: amplitude in `e_t`, and phase against the angle of the spin.
    pub first_order: Vec<C64>,
    /// Largest radius of every station, in `e_t`.
    pub radius: Vec<f64>,
    /// Root mean square of what is not first order, in `e_t`.
    pub rest: Vec<f64>,
    /// Largest control force, in `w0^2 e_t`.
    pub force: f64,
}

#[derive(Clone, Debug)]
struct Last {
    tau: f64,
    angle: f64,
    speed: f64,
    displacement: Vec<C64>,
    velocity: Vec<C64>,
    force: f64,
}

/// Follows a motion step by step.
#[derive(Clone, Debug)]
pub struct OrderTracker {
    stations: usize,
    last: Option<Last>,
    /// Number of the next reading: it is due at the angle `next TAU / PER_TURN`.
    next: i64,
    /// How many readings there are.
    count: usize,
    /// The last readings of the long window: time, speed, force, and displacements, by number.
    heads: Vec<[f64; 3]>,
    displacements: Vec<C64>,
    /// `exp(-j theta)` of the readings of a turn.
    back: [C64; PER_TURN],
    /// See [`slow_lines`].
    slow: Arc<[[C64; SLOW]]>,
}

impl OrderTracker {
    /// Nothing seen yet of a rotor with so many stations.
    #[must_use]
    pub fn new(stations: usize) -> Self {
        let readings = LONG * PER_TURN;
        Self {
            stations,
            last: None,
            next: 0,
            count: 0,
            heads: vec![[0.0; 3]; readings],
            displacements: vec![C64::ZERO; readings * stations],
            back: std::array::from_fn(|k| C64::cis(-(k as f64) * TAU / PER_TURN as f64)),
            slow: slow_lines().into(),
        }
    }

    /// Takes the sample after a step; `each` is called after every reading. The speed may rest, but not be negative.
    pub fn see(&mut self, sample: &OrderSample<'_>, mut each: impl FnMut(&Self)) {
        let OrderSample { tau, angle, speed, displacement, velocity, force } = *sample;
        let Some(last) = &mut self.last else {
            self.next = (angle / (TAU / PER_TURN as f64)).ceil() as i64;
            let (displacement, velocity) = (displacement.to_vec(), velocity.to_vec());
            self.last = Some(Last { tau, angle, speed, displacement, velocity, force });
            return;
        };
        let mut last =
            std::mem::replace(last, Last { tau, angle, speed, displacement: Vec::new(), velocity: Vec::new(), force });
        let step = tau - last.tau;
        loop {
            let due = self.next as f64 * TAU / PER_TURN as f64;
            if due > angle || step <= 0.0 {
                break;
            }
            // The angle between the two is all but a parabola: one correction of the chord is exact to its fourth order.
            let turned = due - last.angle;
            let mut share = turned / (angle - last.angle);
            let rate = (speed - last.speed) * 0.5;
            let at = |s: f64| step * s * (last.speed + rate * s);
            let slope = step * (last.speed + 2.0 * rate * share);
            if slope > 0.0 {
                share = (share + (turned - at(share)) / slope).clamp(0.0, 1.0);
            }
            let place = (self.next.rem_euclid((LONG * PER_TURN) as i64)) as usize;
            self.heads[place] =
                [last.tau + share * step, last.speed + share * (speed - last.speed), force.max(last.force)];
            let [h00, h10, h01, h11] = hermite(share);
            for (k, reading) in self.displacements[place * self.stations..][..self.stations].iter_mut().enumerate() {
                *reading = last.displacement[k] * h00
                    + last.velocity[k] * (h10 * step)
                    + displacement[k] * h01
                    + velocity[k] * (h11 * step);
            }
            self.next += 1;
            self.count += 1;
            each(self);
        }
        last.displacement.copy_from_slice(displacement);
        last.velocity.copy_from_slice(velocity);
        let Last { displacement, velocity, .. } = last;
        self.last = Some(Last { tau, angle, speed, displacement, velocity, force });
    }

    /// Numbers of the last `turns` turns of readings, their place and their angle's place in a turn.
    fn window(&self, turns: usize) -> Option<impl Iterator<Item = (usize, usize)> + use<>> {
        let (wide, next) = (turns * PER_TURN, self.next);
        (self.count >= wide).then(|| {
            (next - wide as i64..next).map(|number| {
                let of = |cycle: usize| number.rem_euclid(cycle as i64) as usize;
                (of(LONG * PER_TURN), of(PER_TURN))
            })
        })
    }

    /// The last whole turn; nothing before there is one.
    #[must_use]
    pub fn turn(&self) -> Option<Revolution> {
        let share = 1.0 / PER_TURN as f64;
        let n = self.stations;
        let mut turn = Revolution {
            tau: 0.0,
            speed: 0.0,
            first_order: vec![C64::ZERO; n],
            radius: vec![0.0; n],
            rest: vec![0.0; n],
            force: 0.0,
        };
        for (place, angle) in self.window(1)? {
            let [tau, speed, force] = self.heads[place];
            turn.tau += tau * share;
            turn.speed += speed * share;
            turn.force = turn.force.max(force);
            for (k, q) in self.displacements[place * n..][..n].iter().enumerate() {
                turn.first_order[k] += q * self.back[angle] * share;
                let size = q.norm_sqr();
                turn.radius[k] = turn.radius[k].max(size);
                turn.rest[k] += size * share;
            }
        }
        turn.radius.iter_mut().for_each(|radius| *radius = radius.sqrt());
        for (rest, first) in turn.rest.iter_mut().zip(&turn.first_order) {
            *rest = (*rest - first.norm_sqr()).max(0.0).sqrt();
        }
        Some(turn)
    }

    /// Root mean square of every station's whirl slower than the spin, forward or backward, over the last [`LONG`] turns: orders up
    /// to three quarters. Nothing before there are so many turns.
    #[must_use]
    pub fn subsynchronous(&self) -> Option<Vec<f64>> {
        let wide = LONG * PER_TURN;
        // Both parts of the motion, which is complex, on every line: forward and backward whirl are their sum and difference.
        let mut lines = vec![[[C64::ZERO; 2]; SLOW]; self.stations];
        for ((place, _), turned) in self.window(LONG)?.zip(self.slow.iter()) {
            let readings = &self.displacements[place * self.stations..];
            for (line, q) in lines.iter_mut().zip(readings) {
                for (parts, turned) in line.iter_mut().zip(turned) {
                    parts[0] += turned * q.re;
                    parts[1] += turned * q.im;
                }
            }
        }
        // A line under this window has 1.5 times its power over its three bins. With q = a + j b, the sum of q t and that of
        // q conj(t) have together twice the power of those of a t and of b t.
        let power = |line: &[[C64; 2]; SLOW]| line.iter().flatten().map(C64::norm_sqr).sum::<f64>() * 2.0 / 1.5;
        Some(lines.iter().map(|line| power(line).sqrt() / wide as f64).collect())
    }
}

/// Of every reading of the long window its weight on every line, under a Hann window.
fn slow_lines() -> Vec<[C64; SLOW]> {
    let wide = LONG * PER_TURN;
    let reading = |i: usize| {
        let angle = TAU * i as f64 / wide as f64;
        let hann = 1.0 - angle.cos();
        std::array::from_fn(|order| C64::cis(-angle * (order + 1) as f64) * hann)
    };
    (0..wide).map(reading).collect()
}

/// The cubic with values and slopes at 0 and 1: weights of value and slope at 0, and of value and slope at 1.
fn hermite(s: f64) -> [f64; 4] {
    let (s2, s3) = (s * s, s * s * s);
    [2.0 * s3 - 3.0 * s2 + 1.0, s3 - 2.0 * s2 + s, -2.0 * s3 + 3.0 * s2, s3 - s2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a made-up motion `q(tau)` at a speed that rises from 1 at `rate`.
    fn tracked(rate: f64, until: f64, q: impl Fn(f64, f64) -> [C64; 2]) -> OrderTracker {
        let mut tracker = OrderTracker::new(1);
        let step = 0.03;
        for k in 0..=(until / step) as usize {
            let tau = k as f64 * step;
            let (speed, angle) = (1.0 + rate * tau, tau + 0.5 * rate * tau * tau);
            let [p, v] = q(tau, angle);
            let sample = OrderSample { tau, angle, speed, displacement: &[p], velocity: &[v], force: 2.0 };
            tracker.see(&sample, |_| {});
        }
        tracker
    }

    #[test]
    fn val_a_circle_of_the_spin_is_all_first_order() {
        for rate in [0.0, 0.01] {
            let amplitude = C64::from_polar(0.7, -1.2);
            let tracker = tracked(rate, 120.0, |tau, angle| {
                let q = amplitude * C64::cis(angle);
                [q, q * C64::new(0.0, 1.0 + rate * tau)]
            });
            let turn = tracker.turn().unwrap();
            assert!((turn.first_order[0] - amplitude).norm() < 1e-6, "{turn:?}");
            assert!(turn.rest[0] < 1e-3 && (turn.radius[0] - 0.7).abs() < 1e-6 && turn.force == 2.0, "{turn:?}");
            assert!(tracker.subsynchronous().unwrap()[0] < 1e-4, "{:?}", tracker.subsynchronous());
            let reached = 1.0 + rate * 120.0;
            assert!((turn.speed - reached).abs() < 0.5 * rate * TAU + 1e-9, "{turn:?}");
        }
    }

    #[test]
    fn val_half_order_whirl_and_harmonics_are_told_apart() {
        // 1 forward, 0.3 of 2X backward, 0.2 of 0.5X forward: by their sizes.
        let tracker = tracked(0.0, 120.0, |_, angle| {
            let parts = [(1.0, 1.0), (0.3, -2.0), (0.2, 0.5)];
            let q = parts.iter().map(|(size, order)| C64::cis(order * angle) * *size).sum();
            let v = parts.iter().map(|(size, order)| C64::cis(order * angle) * C64::new(0.0, size * order)).sum();
            [q, v]
        });
        let turn = tracker.turn().unwrap();
        let slow = tracker.subsynchronous().unwrap()[0];
        assert!((slow - 0.2).abs() < 1e-3, "{slow}");
        // Half a turn of the slow whirl has a share in the first order: 0.2 * 2 / pi of it at most.
        assert!((turn.first_order[0].norm() - 1.0).abs() < 0.13, "{turn:?}");
        assert!(turn.rest[0] > 0.28 && turn.rest[0] < 0.37, "{turn:?}");
    }
}
