//! What stops a machine: an orbit past its limit, a value that is not finite, or somebody who says so.

use rotor::profile::Leg;

use super::Machine;
use crate::program::Program;
use crate::trip::{Trip, TripCause};

/// A machine that coasts down after a trip is held after all where its orbit comes to so many times the limit.
pub(super) const LOST: f64 = 10.0;

impl Machine {
    /// Stops it as a trip did of which only that is known.
    pub fn hold(&mut self) {
        self.stop(TripCause::Orbit, self.program.trip_limit);
    }

    /// Lets its speed coast down from now on, at first at `rate`, as a trip of its orbit does under settings that say so: it has tripped, is
    /// not held, and comes to rest whatever its settings say of the speed, until it is restarted. What the loop does goes on.
    pub fn coast_down(&mut self, rate: f64) {
        self.stop(TripCause::CoastDown, self.program.trip_limit);
        let (tau, angle) = (self.tau(), self.sample().angle);
        let speed = self.motion.speed_at(tau);
        self.motion.settle(tau, angle, speed);
        if rate > 0.0 {
            self.motion.follow(tau, &[Leg::Decay { speed: 0.0, rate }]);
        }
        self.choose_path();
    }

    /// Whether it stands still after a trip. One that coasts down does not.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.trip.is_some_and(|trip| trip.cause != TripCause::CoastDown)
    }

    #[inline]
    pub(super) fn judge(&mut self, radius: f64) -> Option<Trip> {
        if radius <= self.program.trip_limit { None } else { self.pass_limit(radius) }
    }

    /// The orbit is past the limit.
    #[cold]
    fn pass_limit(&mut self, radius: f64) -> Option<Trip> {
        let Program { trip_limit: limit, coast_down, .. } = *self.program;
        match self.trip {
            None if coast_down > 0.0 => self.coast_down(coast_down),
            None => return self.stop(TripCause::Orbit, limit),
            Some(_) if radius > LOST * limit => return self.stop(TripCause::Orbit, LOST * limit),
            Some(_) => return None,
        }
        self.trip
    }

    pub(super) fn stop(&mut self, cause: TripCause, limit: f64) -> Option<Trip> {
        let radius = |i: &usize| self.good[0][*i].norm();
        let station = (0..self.good[0].len()).max_by(|a, b| radius(a).total_cmp(&radius(b))).unwrap_or(0);
        self.trip = Some(Trip { cause, station, radius: radius(&station), limit });
        self.trip
    }
}
