//! The machine: a plant in motion, the loop around it, its speed, its guard and its trip.
//!
//! Whoever steps a rotor steps this: the live process, a recording's what-if, an offline run. So none of them can differ.

mod advance;
#[cfg(test)]
mod coasting;
mod external;
mod path;
#[cfg(test)]
mod ramps;
mod sample;
mod save;
mod trip;

pub use external::Sensed;
pub use sample::Sample;

use control::{Excitation, MAX_BEARINGS, Output};
use rotor::{C64, Stepper};

use crate::motion::{Grid, Motion};
use crate::program::Program;
use crate::trip::{Trip, TripCause};
use path::Path;

/// Where a clock was set last, and how many steps of integration ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockOrigin {
    /// Time then.
    pub tau: f64,
    /// Spin angle then, in radians.
    pub angle: f64,
    /// Steps since.
    pub steps: u64,
}

/// A machine.
pub struct Machine {
    program: Box<Program>,
    fused: Option<Box<dyn Stepper>>,
    /// Which path has the motion.
    path: Path,
    /// Whether the fused path may take a changing speed: not in a machine that goes on from a snapshot of a time when it could not.
    fuses_ramps: bool,
    grid: Grid,
    motion: Motion,
    /// Position and velocity when all was finite last.
    good: [Vec<C64>; 2],
    /// One a control bearing; the rest are unused.
    outputs: [Output; MAX_BEARINGS],
    trip: Option<Trip>,
}

impl Clone for Machine {
    fn clone(&self) -> Self {
        Self {
            program: self.program.clone(),
            fused: self.fused.as_ref().map(|fused| fused.twin()),
            path: self.path,
            fuses_ramps: self.fuses_ramps,
            grid: self.grid,
            motion: self.motion.clone(),
            good: self.good.clone(),
            outputs: self.outputs,
            trip: self.trip,
        }
    }
}

impl std::fmt::Debug for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Machine").field("program", &self.program).field("tau", &self.tau()).finish_non_exhaustive()
    }
}

impl Machine {
    /// A machine at rest at `tau` = 0, spinning at the speed at which its program ends; or begins, if that follows a profile.
    #[must_use]
    pub fn new(program: Program) -> Self {
        match program.begins {
            Some(speed) => Self::spinning(program, speed),
            None => {
                let speed = program.speed();
                Self::spinning(program, speed).settled()
            }
        }
    }

    /// A machine at rest at `tau` = 0, spinning at `speed`, that follows its program from there.
    #[must_use]
    pub fn spinning(program: Program, speed: f64) -> Self {
        let n = program.integrator.displacement().len();
        let mut machine = Self {
            fused: program.fused.as_ref().map(|fused| rotor::stepper(&fused.steady)),
            path: Path::Integrated,
            fuses_ramps: true,
            grid: Grid { from: 0.0, steps: 0, dtau: program.inner_step() },
            motion: Motion::steady(speed),
            good: [vec![C64::ZERO; n], vec![C64::ZERO; n]],
            outputs: [Output::default(); MAX_BEARINGS],
            trip: None,
            program: Box::new(program),
        };
        machine.motion.follow(0.0, &machine.program.legs);
        machine.choose_path();
        machine
    }

    /// A machine in the middle of a motion, spinning at `speed`: `line` says where its clock was set last and how many steps of integration ago,
    /// and the rest is its sample now. A fused one goes on to the last bit. Of a loop with states of its own these are not known here:
    /// it begins as if what is read now had been read for ever; [`Machine::restore`] knows them.
    #[must_use]
    pub fn resumed(
        program: Program,
        line: ClockOrigin,
        speed: f64,
        [displacement, velocity]: [&[C64]; 2],
        outputs: &[Output],
    ) -> Self {
        let mut machine = Self::spinning(program, speed);
        let dtau = machine.program.inner_step();
        machine.grid = Grid { from: line.tau, steps: line.steps, dtau };
        machine.motion.settle(line.tau, line.angle, speed);
        if speed != machine.program.speed() {
            // On its way there: the line begins here.
            let Self { motion, program, .. } = &mut machine;
            motion.follow(line.tau, &program.legs);
        }
        machine.place(displacement, velocity);
        machine.good[0].copy_from_slice(displacement);
        machine.good[1].copy_from_slice(velocity);
        machine.outputs.iter_mut().zip(outputs).for_each(|(own, output)| *own = *output);
        match (machine.path, &mut machine.fused) {
            (Path::Steady, Some(fused)) => fused.set_clock(line.tau, line.angle, line.steps, dtau),
            (Path::Changing, _) => {}
            _ => {
                let tau = machine.grid.tau();
                machine.program.integrator.start(outputs, tau, speed);
            }
        }
        machine
    }

    fn settled(mut self) -> Self {
        let speed = self.motion.speed_at(self.tau());
        self.motion.settle(self.grid.tau(), 0.0, speed);
        self
    }

    /// Time.
    #[must_use]
    pub fn tau(&self) -> f64 {
        self.grid.tau()
    }

    /// Why it has stopped or coasts down, if it does.
    #[must_use]
    pub fn trip(&self) -> Option<Trip> {
        self.trip
    }

    /// Puts every coordinate somewhere; time, angle and what the loop holds go on.
    pub fn place(&mut self, displacement: &[C64], velocity: &[C64]) {
        match &mut self.fused {
            Some(fused) if self.path != Path::Integrated => fused.place(displacement, velocity),
            _ => self.program.integrator.place(displacement, velocity),
        }
    }

    /// A sudden change of velocity of a coordinate (of a chain: a mass), counted from 0; nothing if there is none such.
    pub fn kick(&mut self, coordinate: usize, change: C64) {
        match &mut self.fused {
            Some(fused) if self.path != Path::Integrated => fused.kick(coordinate, change),
            _ => {
                if let Some(v) = self.program.integrator.velocity_mut().get_mut(coordinate) {
                    *v += change;
                }
            }
        }
    }

    /// Adds an excitation to the command of a control bearing, counted from 0, from now on until it ends by itself; `None` ends the one
    /// that there is. What was there before is left in its place, to be freed elsewhere. Nothing is allocated.
    pub fn excite(&mut self, bearing: usize, excitation: &mut Option<Box<Excitation>>) {
        if let Some(excitation) = excitation {
            excitation.begin(self.tau());
        }
        if let Some(controller) = self.program.integrator.controllers.get_mut(bearing) {
            controller.excite(excitation);
        }
        self.choose_path();
    }

    /// Whether an excitation acts.
    #[must_use]
    pub fn is_excited(&self) -> bool {
        self.program.integrator.is_excited(self.tau())
    }

    /// Back to rest at `tau` = 0, at the speed that it has, or at which its profile begins; a trip is over.
    pub fn restart(&mut self) {
        let speed = self.program.begins.unwrap_or_else(|| self.motion.speed_at(self.tau()));
        self.program.integrator.rest();
        if let Some(fused) = &mut self.fused {
            fused.rest();
        }
        self.grid = Grid { from: 0.0, steps: 0, dtau: self.grid.dtau };
        self.motion.settle(0.0, 0.0, speed);
        self.motion.follow(0.0, &self.program.legs);
        self.good.iter_mut().for_each(|good| good.fill(C64::ZERO));
        (self.outputs, self.trip) = ([Output::default(); MAX_BEARINGS], None);
        self.choose_path();
    }
}
