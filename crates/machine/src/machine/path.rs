//! Which path a motion is on: the fused one where it can follow, the integrator of plant and loop where not; and how it goes on
//! by another program.

use super::{Grid, Machine};
use crate::motion::SAME_TIME;
use crate::program::{Fused, Program};

/// Which way a motion is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// Plant and loop together: every machine can.
    Integrated = 0,
    /// A chain under an ideal loop, at the speed for which it is loaded.
    Steady = 1,
    /// The same while the speed changes, or rests at another one; but not turned by a given torque.
    Changing = 2,
}

impl Machine {
    fn wanted_path(&self) -> Path {
        let (Some(fused), Some(_)) = (&self.program.fused, &self.fused) else { return Path::Integrated };
        // A drive may have left the spin at another speed than that which the fused path is loaded for.
        let is_steady = !self.motion.is_moving() && fused.steady.speed() == self.motion.speed_at(self.tau());
        match is_steady {
            _ if self.is_excited() => Path::Integrated,
            true => Path::Steady,
            false if self.fuses_ramps && !self.motion.is_driven() => Path::Changing,
            false => Path::Integrated,
        }
    }

    /// Hands the motion to the path that can go on with it.
    pub(super) fn choose_path(&mut self) {
        let path = self.wanted_path();
        if path == self.path {
            return;
        }
        let from = std::mem::replace(&mut self.path, path);
        let tau = self.tau();
        let Some(fused) = &mut self.fused else { return };
        if path == Path::Integrated {
            let motion = fused.motion();
            self.program.integrator.place(motion.displacement, motion.velocity);
            self.program.integrator.controllers[0].begin_with(fused.control());
            return;
        }
        let Some(Fused { steady, .. }) = &self.program.fused else { return };
        fused.load(steady);
        if from == Path::Integrated {
            fused.place(self.program.integrator.displacement(), self.program.integrator.velocity());
        }
        if path == Path::Steady {
            let (angle, speed) = (self.motion.angle_at(tau), self.motion.speed_at(tau));
            self.grid = Grid { from: tau, steps: 0, dtau: self.grid.dtau };
            self.motion.settle(tau, angle, speed);
            fused.set_clock(tau, angle, 0, self.grid.dtau);
        }
    }

    /// The substeps of a step through a changing speed.
    #[inline]
    pub(super) fn change_fused(&mut self) {
        for _ in 0..self.program.substeps {
            let Self { fused: Some(fused), program, motion, grid, .. } = self else { return };
            let Some(Fused { over_speed, .. }) = &program.fused else { return };
            if let Some(stages) = motion.stages_over(*grid) {
                fused.step_through(grid.dtau, stages, over_speed);
                grid.steps += 1;
            } else {
                self.end_leg();
            }
        }
    }

    /// The same where a leg of the speed ends: in parts, as the integrator has it.
    #[cold]
    fn end_leg(&mut self) {
        let Self { fused: Some(fused), program, motion, grid, .. } = self else { return };
        let Some(Fused { over_speed, .. }) = &program.fused else { return };
        let tolerance = SAME_TIME * grid.dtau;
        let mut now = grid.tau();
        grid.steps += 1;
        let to = grid.tau();
        while now < to {
            motion.pass(now);
            let next = motion.until();
            let until = if next + tolerance >= to { to } else { next.max(now + tolerance) };
            let stages = [now, now + 0.5 * (until - now), until].map(|tau| motion.spin_at(tau).into());
            fused.step_through(until - now, &stages, over_speed);
            now = until;
        }
        motion.pass(to + tolerance);
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
        // A machine that coasts down does so until it is restarted.
        let coasts = self.trip.is_some() && !self.is_held();
        let goes_elsewhere = program.legs != self.program.legs && !coasts;
        let was = self.path;
        let is_settled = was == Path::Steady && (goes_elsewhere || coasts);
        if let Some(fused) = self.fused.as_ref().filter(|_| was != Path::Integrated) {
            let motion = fused.motion();
            self.program.integrator.place(motion.displacement, motion.velocity);
            self.program.integrator.controllers[0].begin_with(fused.control());
            // The angle as the fused path has it.
            if is_settled {
                self.motion.settle(tau, motion.angle, speed);
            }
        }
        program.integrator.adopt(&self.program.integrator, tau, speed);
        std::mem::swap(&mut self.program, program);
        let dtau = self.program.inner_step();
        if goes_elsewhere {
            self.motion.follow(tau, &self.program.legs);
        }
        let steady = self.program.fused.as_ref().map(|fused| &fused.steady).filter(|_| was != Path::Integrated);
        let is_there = !coasts || self.program.speed() == speed;
        let stays_steady = was == Path::Steady && !self.motion.is_moving() && is_there;
        if let (true, Some(fused), Some(closed_loop)) = (stays_steady, &mut self.fused, steady) {
            // As the fused path does itself: a new line of time where speed or step change, and where the spin has been settled above.
            let is_new_line = is_settled || closed_loop.speed() != speed || dtau != self.grid.dtau;
            let angle = fused.motion().angle;
            fused.load(closed_loop);
            if is_new_line {
                self.grid = Grid { from: tau, steps: 0, dtau };
                self.motion.settle(tau, angle, closed_loop.speed());
                fused.set_clock(tau, angle, 0, dtau);
            }
        } else {
            if let (Some(fused), Some(closed_loop)) = (&mut self.fused, steady) {
                fused.load(closed_loop);
            }
            self.grid.rebase(dtau);
            self.choose_path();
        }
    }
}
