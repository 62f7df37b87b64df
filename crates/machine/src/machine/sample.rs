//! Where a machine is: its motion, what its loop reads and puts out.

use control::Output;
use rotor::C64;

use super::{Machine, Path};
use crate::program::Program;

/// Where a machine is. Borrowed from it.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Time, in `tau`.
    pub tau: f64,
    /// Spin angle in radians, unwrapped.
    pub angle: f64,
    /// Spin speed `R`.
    pub speed: f64,
    /// Its rate of change.
    pub acceleration: f64,
    /// Displacement of every coordinate (of a chain: every mass), in `e_t`.
    pub displacement: &'a [C64],
    /// Their velocities.
    pub velocity: &'a [C64],
    /// What the loop of each control bearing asks for and delivers.
    pub outputs: &'a [Output],
    /// Bit `i` is set while contact `i` is closed.
    pub contact: u32,
}

impl Machine {
    /// Where it is now.
    #[must_use]
    pub fn sample(&self) -> Sample<'_> {
        let tau = self.tau();
        let rates = (self.motion.speed_at(tau), self.motion.acceleration_at(tau));
        let (speed, acceleration) = rates;
        let outputs = &self.outputs[..self.program.bearings()];
        match &self.fused {
            Some(fused) if self.path != Path::Integrated => {
                let motion = fused.motion();
                let (displacement, velocity) = (motion.displacement, motion.velocity);
                let angle = if self.path == Path::Steady { motion.angle } else { self.motion.angle_at(tau) };
                Sample { tau, angle, speed, acceleration, displacement, velocity, outputs, contact: fused.contact() }
            }
            _ => {
                let Program { integrator, .. } = &*self.program;
                let (displacement, velocity) = (integrator.displacement(), integrator.velocity());
                let (angle, contact) = (self.motion.angle_at(tau), integrator.contact());
                Sample { tau, angle, speed, acceleration, displacement, velocity, outputs, contact }
            }
        }
    }

    /// Where it is, as the integrator of the fused path tells it.
    #[must_use]
    pub fn motion(&self) -> rotor::Motion<'_> {
        let Sample { tau, angle, displacement, velocity, .. } = self.sample();
        rotor::Motion { tau, angle, displacement, velocity }
    }

    /// What the loop of each control bearing puts out.
    #[must_use]
    pub fn outputs(&self) -> &[Output] {
        &self.outputs[..self.program.bearings()]
    }

    /// The largest control that is delivered, in `w0^2 e_t`: of several control bearings as that of the first
    /// ([`rotor::ControlMasses`]).
    #[must_use]
    pub fn largest_force(&self) -> f64 {
        // `norm` guards against overflow, which no force comes near, at the cost of a twentieth of a run-up.
        self.program.control_masses().largest(self.outputs().iter().map(|output| output.delivered.norm_sqr().sqrt()))
    }

    /// Bit `i` is set while contact `i` is closed.
    #[must_use]
    pub fn contact(&self) -> u32 {
        self.sample().contact
    }

    /// What the sensors of a control bearing, counted from 0, read last; nothing where there is no such bearing.
    #[must_use]
    pub fn readings(&self, bearing: usize) -> &[C64] {
        self.program.integrator.controllers.get(bearing).map_or(&[], |controller| controller.readings())
    }

    /// What the loop reads of the displacement at a station, counted from 0, after lag, noise, quantum and hold; where it does not
    /// look, and where the loop is ideal, that is the displacement itself.
    #[must_use]
    pub fn reading(&self, station: usize) -> C64 {
        let mut controllers = self.program.integrator.controllers.iter().filter(|_| self.path == Path::Integrated);
        let read = controllers.find_map(|controller| controller.reading_at(station));
        read.or_else(|| self.sample().displacement.get(station).copied()).unwrap_or_default()
    }
}
