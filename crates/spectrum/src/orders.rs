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
/// Lines of the long window that they are made of, backward and forward: with the one beyond each end.
const LINES: usize = 2 * (SLOW + 1) + 1;
/// Readings of an eighth of a turn, by which a turn moves on.
const READINGS: usize = PER_TURN / 8;
/// Eighths kept: a turn, and the one under way.
const PARTS: usize = 9;
/// The angle between two readings.
const APART: f64 = TAU / PER_TURN as f64;

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

/// The sample before.
#[derive(Clone, Debug)]
struct Last {
    tau: f64,
    angle: f64,
    speed: f64,
    displacement: Vec<C64>,
    velocity: Vec<C64>,
    force: f64,
}

/// What of an eighth of a turn goes into the turn.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    /// Sums over its readings.
    tau: f64,
    speed: f64,
    /// The largest.
    force: f64,
}

/// The same of a station.
#[derive(Clone, Copy, Debug, Default)]
struct StationPart {
    /// Sum of `q exp(-j theta)`.
    first: C64,
    /// The largest of `|q|^2`, and the sum.
    largest: f64,
    sum: f64,
}

/// Follows a motion step by step.
#[derive(Clone, Debug)]
pub struct OrderTracker {
    stations: usize,
    last: Option<Last>,
    /// Number of the next reading: it is due at the angle `next TAU / PER_TURN`.
    next: i64,
    /// That angle.
    due: f64,
    /// How many readings there are.
    count: usize,
    /// The last eighths of a turn, by number, and what every station did in them.
    parts: [Part; PARTS],
    station_parts: Vec<StationPart>,
    /// Displacements of the turn under way, by number.
    displacements: Vec<C64>,
    /// Of the last turns of the long window, by number, what they add to its lines, for every station.
    turns: Vec<[C64; LINES]>,
    /// `exp(-j theta)` of the readings of a turn.
    back: [C64; PER_TURN],
    /// Of every reading of a turn its weight on every line of the long window.
    lines: Arc<[[C64; LINES]]>,
}

impl OrderTracker {
    /// Nothing seen yet of a rotor with so many stations.
    #[must_use]
    pub fn new(stations: usize) -> Self {
        let wide = (LONG * PER_TURN) as f64;
        let order = |k: usize| k as f64 - (LINES / 2) as f64;
        let weights = |i: usize| std::array::from_fn(|k| C64::cis(-TAU * i as f64 * order(k) / wide));
        Self {
            stations,
            last: None,
            next: 0,
            due: 0.0,
            count: 0,
            parts: [Part::default(); PARTS],
            station_parts: vec![StationPart::default(); PARTS * stations],
            displacements: vec![C64::ZERO; PER_TURN * stations],
            turns: vec![[C64::ZERO; LINES]; LONG * stations],
            back: std::array::from_fn(|k| C64::cis(-(k as f64) * TAU / PER_TURN as f64)),
            lines: (0..PER_TURN).map(weights).collect(),
        }
    }

    /// Takes the sample after a step; `each` is called after every reading. The speed may rest, but not be negative.
    pub fn see(&mut self, sample: &OrderSample<'_>, mut each: impl FnMut(&Self)) {
        let OrderSample { tau, angle, speed, displacement, velocity, force } = *sample;
        let Some(mut last) = self.last.take() else {
            self.next = (angle / APART).ceil() as i64;
            self.due = self.next as f64 * APART;
            let (displacement, velocity) = (displacement.to_vec(), velocity.to_vec());
            self.last = Some(Last { tau, angle, speed, displacement, velocity, force });
            return;
        };
        let step = tau - last.tau;
        while self.due <= angle && step > 0.0 {
            // The angle between the two is all but a parabola: one correction of the chord is exact to its fourth order.
            let turned = self.due - last.angle;
            let mut share = turned / (angle - last.angle);
            let rate = (speed - last.speed) * 0.5;
            let at = |s: f64| step * s * (last.speed + rate * s);
            let slope = step * (last.speed + 2.0 * rate * share);
            if slope > 0.0 {
                share = (share + (turned - at(share)) / slope).clamp(0.0, 1.0);
            }
            let [h00, h10, h01, h11] = hermite(share);
            let read = |k: usize| {
                last.displacement[k] * h00
                    + last.velocity[k] * (h10 * step)
                    + displacement[k] * h01
                    + velocity[k] * (h11 * step)
            };
            let head = [last.tau + share * step, last.speed + share * (speed - last.speed), force.max(last.force)];
            self.note(head, read);
            each(self);
        }
        (last.tau, last.angle, last.speed, last.force) = (tau, angle, speed, force);
        last.displacement.copy_from_slice(displacement);
        last.velocity.copy_from_slice(velocity);
        self.last = Some(last);
    }

    /// Takes a reading: time, speed, force, and the displacement of every station.
    fn note(&mut self, [tau, speed, force]: [f64; 3], read: impl Fn(usize) -> C64) {
        let n = self.stations;
        let (within, place) = (self.count % PER_TURN, self.count / READINGS % PARTS);
        let back = self.back[self.next.rem_euclid(PER_TURN as i64) as usize];
        if self.count.is_multiple_of(READINGS) {
            self.parts[place] = Part::default();
            self.station_parts[place * n..][..n].fill(StationPart::default());
        }
        let part = &mut self.parts[place];
        (part.tau, part.speed, part.force) = (part.tau + tau, part.speed + speed, part.force.max(force));
        let displacements = &mut self.displacements[within * n..][..n];
        for (k, (reading, part)) in displacements.iter_mut().zip(&mut self.station_parts[place * n..]).enumerate() {
            *reading = read(k);
            let size = reading.norm_sqr();
            part.first += *reading * back;
            (part.largest, part.sum) = (part.largest.max(size), part.sum + size);
        }
        self.next += 1;
        self.due = self.next as f64 * APART;
        self.count += 1;
        if self.count.is_multiple_of(PER_TURN) {
            self.end_turn();
        }
    }

    /// Takes the turn that is over into the long window.
    fn end_turn(&mut self) {
        let n = self.stations;
        let turn = (self.count / PER_TURN - 1) % LONG;
        for (k, sums) in self.turns[turn * n..][..n].iter_mut().enumerate() {
            *sums = [C64::ZERO; LINES];
            for (weights, q) in self.lines.iter().zip(self.displacements[k..].iter().step_by(n)) {
                sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * q);
            }
        }
    }

    /// The last whole turn, which ended with an eighth of one; nothing before there is one.
    #[must_use]
    pub fn turn(&self) -> Option<Revolution> {
        let n = self.stations;
        let (share, ended) = (1.0 / PER_TURN as f64, self.count / READINGS);
        let mut turn = Revolution {
            tau: 0.0,
            speed: 0.0,
            first_order: vec![C64::ZERO; n],
            radius: vec![0.0; n],
            rest: vec![0.0; n],
            force: 0.0,
        };
        for part in ended.checked_sub(PARTS - 1)?..ended {
            let place = part % PARTS;
            let Part { tau, speed, force } = self.parts[place];
            turn.tau += tau * share;
            turn.speed += speed * share;
            turn.force = turn.force.max(force);
            for (k, part) in self.station_parts[place * n..][..n].iter().enumerate() {
                turn.first_order[k] += part.first * share;
                turn.radius[k] = turn.radius[k].max(part.largest);
                turn.rest[k] += part.sum * share;
            }
        }
        turn.radius.iter_mut().for_each(|radius| *radius = radius.sqrt());
        for (rest, first) in turn.rest.iter_mut().zip(&turn.first_order) {
            *rest = (*rest - first.norm_sqr()).max(0.0).sqrt();
        }
        Some(turn)
    }

    /// Root mean square of every station's whirl slower than the spin, forward or backward, over the last [`LONG`] whole turns: orders
    /// up to three quarters. Nothing before there are so many turns.
    #[must_use]
    pub fn subsynchronous(&self) -> Option<Vec<f64>> {
        let oldest = (self.count / PER_TURN).checked_sub(LONG)?;
        let wide = (LONG * PER_TURN) as f64;
        let of_station = |station: usize| {
            let mut sums = [C64::ZERO; LINES];
            for turn in 0..LONG {
                let parts = &self.turns[(oldest + turn) % LONG * self.stations + station];
                for (k, (sum, part)) in sums.iter_mut().zip(parts).enumerate() {
                    // Forward and backward orders, in eighths of a turn.
                    let eighths = (turn as i64 * (k as i64 - (LINES / 2) as i64)).rem_euclid(LONG as i64);
                    *sum += part * self.back[eighths as usize * PER_TURN / LONG];
                }
            }
            // A Hann window takes from every line half of those beside it. A line under it has 1.5 times its power over its three bins.
            let windowed = |k: usize| sums[k] - (sums[k - 1] + sums[k + 1]) * 0.5;
            let slow = (1..LINES - 1).filter(|k| *k != LINES / 2);
            (slow.map(|k| windowed(k).norm_sqr()).sum::<f64>() / 1.5).sqrt() / wide
        };
        Some((0..self.stations).map(of_station).collect())
    }
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
