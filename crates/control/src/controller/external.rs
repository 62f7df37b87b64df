//! A law that is computed outside: it is given the sample that is due, before the stretch that begins with it, and its commands are sent
//! on their way as those of the law here would be. Everything around the law stays: sensors, sampling, delay, actuator.

use super::{Controller, Stage};
use crate::C64;

impl Controller {
    /// Whether a law outside may be asked.
    #[must_use]
    pub fn may_be_external(&self) -> bool {
        self.parts.external > 0.0
    }

    /// From here on commands come from outside, or from the law here again.
    pub fn set_external(&mut self, external: bool) {
        self.is_external = external && self.may_be_external();
    }

    /// Reads the sample that is due at `stage`, if one is and has not been read: [`Controller::act`] then goes by these readings. Returns
    /// whether one was read now.
    pub fn sense(&mut self, stage: &Stage<'_>, x: &[C64]) -> bool {
        let is_due =
            self.may_be_external() && self.next_sample as f64 * self.parts.sample <= stage.tau + self.tolerance;
        if !is_due || self.is_sensed {
            return false;
        }
        self.take_sample(stage, x);
        self.is_sensed = true;
        true
    }

    /// What its sensors read last: displacement and velocity of each.
    #[must_use]
    pub fn sensed(&self) -> [&[C64]; 2] {
        [&self.reading[0], &self.reading[1]]
    }

    /// Sends the command of the law outside for the sample that was taken `back` samples before the last one that was read, when it is `tau`.
    /// One that comes after it should have begun to act acts at once. Returns whether it came in time.
    pub fn command_from_outside(&mut self, command: C64, back: u64, tau: f64) -> bool {
        let at = self.last_read().saturating_sub(back) as f64 * self.parts.sample;
        let due = at + self.parts.delay;
        let is_in_time = tau <= due + self.tolerance;
        if self.is_external {
            self.is_exciting = self.is_excited(tau);
            let command = self.excited(command, at);
            self.send(command, if is_in_time { due } else { tau });
        }
        is_in_time
    }

    /// How many samples before the last one that was read is the newest whose command should act before `until`; `None` while none should.
    #[must_use]
    pub fn due_before(&self, until: f64) -> Option<u64> {
        let newest = ((until - self.parts.delay - self.tolerance) / self.parts.sample).ceil() - 1.0;
        (newest >= 0.0).then(|| self.last_read().saturating_sub(newest as u64))
    }

    /// Which sample was read last, counted from 0 at `tau` = 0: it has its turn yet, unless it was acted upon.
    fn last_read(&self) -> u64 {
        if self.is_sensed { self.next_sample } else { self.next_sample.saturating_sub(1) }
    }
}
