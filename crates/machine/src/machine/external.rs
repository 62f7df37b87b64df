//! A controller outside: what it is given before a step, and what it sends back. The machine itself waits for nobody.

use rotor::C64;

use super::{Machine, Path};
use crate::trip::{Trip, TripCause};

/// What a controller outside is given of a station.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// Displacement, as the sensors of the first control bearing read it.
    pub displacement: C64,
    /// Velocity, likewise.
    pub velocity: C64,
}

impl Machine {
    /// Samples that a controller outside may miss before the laws here take over; `None` where the loop has none outside.
    #[must_use]
    pub fn external(&self) -> Option<u64> {
        self.program.feedback().external()
    }

    /// Samples missed by it that trip the machine; `None` for never.
    #[must_use]
    pub fn external_trip(&self) -> Option<u64> {
        self.program.feedback().external_trip()
    }

    /// The delay of the loop, in `tau`: after it, the command of a sample should be there.
    #[must_use]
    pub fn external_delay(&self) -> f64 {
        self.program.feedback().delay()
    }

    /// How many samples before the last one that was read is the newest whose command should act within the next step; `None` while none
    /// should.
    #[must_use]
    pub fn external_due(&self) -> Option<u64> {
        let until = self.tau() + self.dtau();
        self.program.integrator.controllers.first()?.due_before(until)
    }

    /// Reads the sample that is due before the next step, if one is and has not been read yet. Returns whether one was read now. Only a loop
    /// with `external` is read ahead, and none while the machine is held after a trip.
    pub fn sense(&mut self) -> bool {
        if self.is_held() || self.path != Path::Integrated {
            return false;
        }
        let tau = self.tau();
        self.program.integrator.sense(tau, self.motion.speed_at(tau))
    }

    /// What was read then of every station.
    pub fn sensed(&self) -> impl Iterator<Item = Sensed> + '_ {
        let read = self.program.integrator.controllers.first().map_or([&[][..]; 2], |first| first.sensed());
        read[0].iter().zip(read[1]).map(|(p, v)| Sensed { displacement: *p, velocity: *v })
    }

    /// From here on commands come from outside, or from the laws here again; where the loop has no `external` always from here.
    pub fn set_external(&mut self, external: bool) {
        self.program.integrator.controllers.iter_mut().for_each(|controller| controller.set_external(external));
    }

    /// Sends the commands of the controller outside, one a control bearing, for the sample that was read `back` samples before the last
    /// one. Returns whether they came in time: see [`control::Controller::command_from_outside`].
    pub fn command_from_outside(&mut self, commands: impl IntoIterator<Item = C64>, back: u64) -> bool {
        let tau = self.tau();
        let mut in_time = true;
        for (controller, command) in self.program.integrator.controllers.iter_mut().zip(commands) {
            in_time &= controller.command_from_outside(command, back, tau);
        }
        in_time
    }

    /// Stops it for want of commands.
    pub fn trip_for_want_of_commands(&mut self) -> Option<Trip> {
        self.stop(TripCause::NoCommand, self.program.trip_limit)
    }
}
