//! What a motion that was recorded shows of its speed: legs, told from the steps themselves, and the critical speeds passed on them,
//! found as a run-up finds them.

use std::sync::atomic::AtomicBool;

use rotor::{Rotor, Settings};
use spectrum::{OrderSample, OrderTracker};

use super::criticals::{Course, Critical, Passed, Readings};
use super::{LEAST_APART, MOST_READINGS};

/// A rate that differs by more than this part from one step to the next is another leg's.
const OTHER_RATE: f64 = 0.1;
/// A speed that is off by more than this part of where its rate leads has jumped.
const JUMP: f64 = 1e-4;
/// Steps by which the spin turns more than this, in radians, are too far apart to be read turn by turn.
const COARSE: f64 = 0.8;
/// Rows so many times as far apart as those before have a gap between them.
const GAP: f64 = 1.5;

/// A stretch over which the speed rests, or changes at one rate or ever more slowly.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedLeg {
    /// The step with which it begins, and that with which it ends.
    pub steps: [u64; 2],
    /// When, in `tau`.
    pub tau: [f64; 2],
    /// Spin speeds at both ends.
    pub speed: [f64; 2],
    /// Rates of change at both ends, per unit of `tau`.
    pub rate: [f64; 2],
    /// Critical speeds passed, rising; `None` where steps lie too far apart to be read turn by turn.
    pub criticals: Option<Vec<Critical>>,
}

impl RecordedLeg {
    /// Whether the speed stays what it is.
    #[must_use]
    pub fn rests(&self) -> bool {
        self.rate == [0.0; 2]
    }
}

/// Reads a recorded motion step by step.
#[derive(Debug)]
pub struct RecordedCourse {
    rotor: Rotor,
    /// Legs of motions that are over.
    legs: Vec<RecordedLeg>,
    /// Legs of the motion under way.
    present: Vec<Growing>,
    tracker: OrderTracker,
    readings: Readings,
    count: u64,
    coarse: bool,
    /// Number, time, angle, speed and rate of the last step, and how many numbers it was after the one before.
    last: Option<(u64, f64, f64, f64, f64)>,
    apart: u64,
}

impl RecordedCourse {
    /// Nothing read yet of a rotor.
    #[must_use]
    pub fn new(rotor: &Rotor) -> Self {
        let n = rotor.len();
        Self {
            rotor: rotor.clone(),
            legs: Vec::new(),
            present: Vec::new(),
            tracker: OrderTracker::new(n),
            readings: Readings::new(n, LEAST_APART),
            count: 0,
            coarse: false,
            last: None,
            apart: 0,
        }
    }

    /// Takes step number `seq`, with the rate of change of its speed. `settings` are those in force at a step.
    pub fn see<'s>(
        &mut self,
        seq: u64,
        sample: &OrderSample<'_>,
        rate: f64,
        settings: &dyn Fn(u64) -> Option<&'s Settings>,
    ) {
        let OrderSample { tau, angle, speed, .. } = *sample;
        match self.last.replace((seq, tau, angle, speed, rate)) {
            // A restart: another motion, from rest.
            Some((_, before, ..)) if tau < before => {
                self.close(settings);
                self.present.push(Growing::at(seq, tau, speed, rate));
            }
            Some((number, before, turned, was, rated)) => {
                let (gap, step) = (seq - number, tau - before);
                if self.apart > 0 && gap as f64 > GAP * self.apart as f64 {
                    self.tracker = OrderTracker::new(self.rotor.len());
                }
                self.apart = gap;
                self.coarse |= angle - turned > COARSE;
                let led = was + 0.5 * (rated + rate) * step;
                let jumped = (speed - led).abs() > JUMP * (1.0 + speed.abs()) + 0.5 * (rated - rate).abs() * step;
                let leg = self.present.last_mut();
                let most = leg.as_ref().map_or(0.0, |leg| leg.most).max(rate.abs());
                let is_other = (rated == 0.0) != (rate == 0.0) || (rate - rated).abs() > OTHER_RATE * most;
                // Where one leg ends the next begins, unless the speed jumps: a rest with its last step, a change with the next.
                let mut begins = (seq, tau, speed);
                match leg {
                    Some(leg) if !jumped && !is_other => leg.to(seq, tau, speed, rate),
                    Some(leg) if !jumped && leg.leg.rests() => begins = (number, before, was),
                    Some(leg) if !jumped => leg.to(seq, tau, speed, leg.leg.rate[1]),
                    _ => {}
                }
                if jumped || is_other {
                    let (seq, tau, speed) = begins;
                    self.present.push(Growing::at(seq, tau, speed, rate));
                }
            }
            None => self.present.push(Growing::at(seq, tau, speed, rate)),
        }
        let Self { tracker, readings, count, .. } = self;
        tracker.see(sample, |tracker| {
            *count += 1;
            if let Some(turn) = count.is_multiple_of(readings.every).then(|| tracker.turn()).flatten() {
                readings.push(&turn);
            }
        });
        if readings.len() as f64 > MOST_READINGS {
            readings.thin();
        }
    }

    /// Ends the motion under way: its critical speeds are found now.
    fn close<'s>(&mut self, settings: &dyn Fn(u64) -> Option<&'s Settings>) {
        let n = self.rotor.len();
        let readings = std::mem::replace(&mut self.readings, Readings::new(n, LEAST_APART));
        self.tracker = OrderTracker::new(n);
        self.apart = 0;
        let mut present = std::mem::take(&mut self.present);
        // The last step of a profile rests, and is no leg.
        if present.len() > 1 {
            present.pop_if(|leg| leg.leg.steps[0] == leg.leg.steps[1]);
        }
        let passed: Vec<Passed> = present.iter().map(Growing::passed).collect();
        let mut present: Vec<RecordedLeg> = present.into_iter().map(|leg| leg.leg).collect();
        let in_force = |leg: usize| settings(present[leg].steps[0]);
        let found =
            (!self.coarse).then(|| readings.criticals(&self.rotor, &passed, &in_force, &AtomicBool::new(false)));
        self.coarse = false;
        for (k, leg) in present.iter_mut().enumerate() {
            let all = found.as_ref();
            leg.criticals = all.map(|all| all.iter().filter(|critical| critical.leg == k).cloned().collect());
        }
        self.legs.append(&mut present);
    }

    /// All legs, in order; none of a recording at one speed throughout.
    #[must_use]
    pub fn legs<'s>(mut self, settings: &dyn Fn(u64) -> Option<&'s Settings>) -> Vec<RecordedLeg> {
        self.close(settings);
        let mut legs = self.legs;
        // Which of them all, not of its motion.
        for (k, leg) in legs.iter_mut().enumerate() {
            leg.criticals.iter_mut().flatten().for_each(|critical| critical.leg = k);
        }
        let Some(speed) = legs.first().map(|leg| leg.speed[0]) else { return legs };
        if legs.iter().all(|leg| leg.rests() && leg.speed[0] == speed) { Vec::new() } else { legs }
    }
}

/// A leg under way.
#[derive(Clone, Debug)]
struct Growing {
    leg: RecordedLeg,
    /// The greatest rate on it.
    most: f64,
    /// Whether the speed went both ways.
    turned: bool,
}

impl Growing {
    fn at(seq: u64, tau: f64, speed: f64, rate: f64) -> Self {
        let leg = RecordedLeg { steps: [seq; 2], tau: [tau; 2], speed: [speed; 2], rate: [rate; 2], criticals: None };
        Self { leg, most: rate.abs(), turned: false }
    }

    fn to(&mut self, seq: u64, tau: f64, speed: f64, rate: f64) {
        let RecordedLeg { steps, tau: taus, speed: speeds, rate: rates, .. } = &mut self.leg;
        (steps[1], taus[1], speeds[1], rates[1]) = (seq, tau, speed, rate);
        self.most = self.most.max(rate.abs());
        self.turned |= rate * rates[0] < 0.0;
    }

    fn passed(&self) -> Passed {
        let RecordedLeg { tau, speed, .. } = self.leg;
        let course = match (self.leg.rests(), self.turned) {
            (true, _) => Course::Rests,
            (false, false) => Course::Given,
            // Only a torque goes to and fro.
            (false, true) => Course::Driven,
        };
        Passed { until: tau[1], speed, course }
    }
}
