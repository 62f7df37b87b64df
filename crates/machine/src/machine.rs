//! The machine: a plant in motion, the loop around it, its speed, its guard and its trip.
//!
//! Whoever steps a rotor steps this: the live process, a recording's what-if, an offline run. So none of them can differ.

#[cfg(test)]
mod coasting;
mod external;
mod path;
#[cfg(test)]
mod ramps;
mod save;

pub use external::Sensed;

use control::{Excitation, MAX_BEARINGS, Output};
use rotor::profile::Leg;
use rotor::{C64, Stepper};

use crate::motion::{Grid, Motion};
use crate::program::Program;
use crate::trip::{Trip, TripCause};
use path::Path;

/// A machine that coasts down after a trip is held after all where its orbit comes to so many times the limit.
const LOST: f64 = 10.0;

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

    /// Puts every coordinate somewhere; time, angle and what the loop holds go on.
    pub fn place(&mut self, displacement: &[C64], velocity: &[C64]) {
        match &mut self.fused {
            Some(fused) if self.path != Path::Integrated => fused.place(displacement, velocity),
            _ => self.program.integrator.place(displacement, velocity),
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

    #[inline]
    fn judge(&mut self, radius: f64) -> Option<Trip> {
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

    fn stop(&mut self, cause: TripCause, limit: f64) -> Option<Trip> {
        let radius = |i: &usize| self.good[0][*i].norm();
        let station = (0..self.good[0].len()).max_by(|a, b| radius(a).total_cmp(&radius(b))).unwrap_or(0);
        self.trip = Some(Trip { cause, station, radius: radius(&station), limit });
        self.trip
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
