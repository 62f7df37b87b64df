//! Which path a motion is on: the fused one where it can follow, the integrator of plant and loop where not; and how it goes on
//! by another program.

use super::{Grid, Machine};
use crate::program::Program;

impl Machine {
    /// Hands the motion to the path that can go on with it.
    pub(super) fn choose_path(&mut self) {
        // A drive may have left the spin at another speed than that which the fused path knows.
        let speed = self.motion.speed_at(self.tau());
        let knows = self.program.fused.as_ref().is_some_and(|closed_loop| closed_loop.speed() == speed);
        let is_excited = self.is_excited();
        let fusable = knows && !self.motion.is_moving() && !is_excited;
        if fusable == self.is_fused {
            return;
        }
        let tau = self.tau();
        if fusable {
            let angle = self.motion.angle_at(tau);
            let speed = self.motion.speed_at(tau);
            let (Some(fused), Some(closed_loop)) = (&mut self.fused, &self.program.fused) else { return };
            fused.load(closed_loop);
            fused.place(self.program.integrator.displacement(), self.program.integrator.velocity());
            self.grid = Grid { from: tau, steps: 0, dtau: self.grid.dtau };
            self.motion.settle(tau, angle, speed);
            fused.set_clock(tau, angle, 0, self.grid.dtau);
        } else if let Some(fused) = &self.fused {
            let motion = fused.motion();
            self.program.integrator.place(motion.displacement, motion.velocity);
            self.program.integrator.controllers[0].begin_with(fused.control());
        }
        self.is_fused = fusable;
    }

    /// Goes on by another program, which is left in `program`'s place when this returns: that one may be freed elsewhere. What
    /// the loop holds is kept as far as it still means something; position, velocity, time and angle always.
    ///
    /// Both programs are of one plant. Nothing is allocated. An excitation is over: it was meant for another loop.
    pub fn load(&mut self, program: &mut Box<Program>) {
        if self.is_excited() {
            self.program.integrator.controllers.iter_mut().for_each(control::Controller::stop_excitation);
            self.choose_path();
        }
        let (tau, speed) = (self.tau(), self.motion.speed_at(self.tau()));
        let goes_elsewhere = program.legs != self.program.legs;
        let was_fused = self.is_fused;
        if let Some(fused) = self.fused.as_ref().filter(|_| was_fused) {
            let motion = fused.motion();
            self.program.integrator.place(motion.displacement, motion.velocity);
            self.program.integrator.controllers[0].begin_with(fused.control());
            // The angle as the fused path has it.
            if goes_elsewhere {
                self.motion.settle(tau, motion.angle, speed);
            }
        }
        program.integrator.adopt(&self.program.integrator, tau, speed);
        std::mem::swap(&mut self.program, program);
        let dtau = self.program.inner_step();
        if goes_elsewhere {
            self.motion.follow(tau, &self.program.legs);
        }
        let still_fused = was_fused && self.program.fused.is_some() && !self.motion.is_moving();
        if let (true, Some(fused), Some(closed_loop)) = (still_fused, &mut self.fused, &self.program.fused) {
            // As the fused path does itself: a new line of time where speed or step change.
            let is_new_line = closed_loop.speed() != speed || dtau != self.grid.dtau;
            let angle = fused.motion().angle;
            fused.load(closed_loop);
            if is_new_line {
                self.grid = Grid { from: tau, steps: 0, dtau };
                self.motion.settle(tau, angle, closed_loop.speed());
                fused.set_clock(tau, angle, 0, dtau);
            }
        } else {
            self.grid.rebase(dtau);
            self.choose_path();
        }
    }
}
