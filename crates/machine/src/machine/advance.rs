//! One step, on whichever path the motion is, with its guard.

use control::Output;

use super::{Machine, Path};
use crate::motion::Grid;
use crate::program::Program;
use crate::trip::{Trip, TripCause};

impl Machine {
    /// One step. Returns the trip if this step caused one; then the machine stands still, or coasts down
    /// ([`rotor::Settings::coast_down`]). One that coasts down trips once more, and stands still, if its orbit comes to ten times the limit
    /// all the same: what is linear in the rotor tells nothing any more then.
    pub fn step(&mut self) -> Option<Trip> {
        if self.is_held() {
            return None;
        }
        match self.path {
            Path::Steady => self.step_fused(),
            Path::Changing => self.step_changing(),
            Path::Integrated => self.step_integrated(),
        }
    }

    /// From here on a step is `dtau` long: no longer than the program's own, for which its loop has room.
    pub fn pace(&mut self, dtau: f64) {
        if dtau == self.program.dtau {
            return;
        }
        self.program.dtau = dtau;
        if self.path == Path::Steady {
            // As the fused path does itself.
            let (tau, angle) = (self.tau(), self.sample().angle);
            let speed = self.motion.speed_at(tau);
            self.grid = Grid { from: tau, steps: 0, dtau: self.program.inner_step() };
            self.motion.settle(tau, angle, speed);
        } else {
            self.grid.rebase(self.program.inner_step());
        }
    }

    /// How long a step is.
    #[must_use]
    pub fn dtau(&self) -> f64 {
        self.program.dtau
    }

    /// One step of `dtau`, without guard and trip: for runs that judge the motion themselves. No longer than the program's
    /// own step, for which its loop has room.
    pub fn step_by(&mut self, dtau: f64) {
        self.pace(dtau);
        match self.path {
            Path::Steady => self.turn_fused(),
            Path::Changing => self.change_fused(),
            Path::Integrated => {
                self.integrate();
                return self.choose_path();
            }
        }
        self.put_out();
        if self.path == Path::Changing && !self.motion.is_moving() {
            self.choose_path();
        }
    }

    /// What the ideal loop puts out, on the fused path.
    #[inline]
    fn put_out(&mut self) {
        if let Some(fused) = &self.fused {
            let control = fused.control();
            self.outputs[0] = Output { commanded: control, delivered: control, saturated: false };
        }
    }

    fn step_fused(&mut self) -> Option<Trip> {
        self.turn_fused();
        self.guard_fused()
    }

    fn step_changing(&mut self) -> Option<Trip> {
        self.change_fused();
        let ended = self.guard_fused();
        if !self.motion.is_moving() {
            self.choose_path();
        }
        ended
    }

    /// The substeps of a step at a steady speed.
    #[inline]
    fn turn_fused(&mut self) {
        let Some(fused) = &mut self.fused else { return };
        for _ in 0..self.program.substeps {
            fused.step(self.grid.dtau);
        }
        self.grid.steps += u64::from(self.program.substeps);
    }

    #[inline]
    fn guard_fused(&mut self) -> Option<Trip> {
        let fused = self.fused.as_mut()?;
        let (motion, control) = (fused.motion(), fused.control());
        let radius = motion.largest_radius();
        if motion.is_finite() && radius.is_finite() && control.is_finite() {
            self.good[0].copy_from_slice(motion.displacement);
            self.good[1].copy_from_slice(motion.velocity);
            self.outputs[0] = Output { commanded: control, delivered: control, saturated: false };
            self.judge(radius)
        } else {
            fused.place(&self.good[0], &self.good[1]);
            self.put_out();
            self.stop(TripCause::NotFinite, self.program.trip_limit)
        }
    }

    fn step_integrated(&mut self) -> Option<Trip> {
        self.integrate();
        let integrator = &mut self.program.integrator;
        let radius = integrator.largest_radius();
        let ended = if integrator.is_finite() && radius.is_finite() {
            self.good[0].copy_from_slice(integrator.displacement());
            self.good[1].copy_from_slice(integrator.velocity());
            self.judge(radius)
        } else {
            integrator.place(&self.good[0], &self.good[1]);
            self.stop(TripCause::NotFinite, self.program.trip_limit)
        };
        self.choose_path();
        ended
    }

    /// The substeps of a step, plant and loop together.
    fn integrate(&mut self) {
        let Program { integrator, substeps, .. } = &mut *self.program;
        integrator.begin_step();
        for _ in 0..*substeps {
            let from = self.grid.tau();
            self.grid.steps += 1;
            integrator.advance(from, self.grid.tau(), &mut self.motion);
        }
        // What is not finite is never told.
        for (own, output) in self.outputs.iter_mut().zip(integrator.outputs()) {
            if output.delivered.is_finite() {
                *own = output;
            }
        }
    }
}
