//! A machine in motion beside the recorded one, stepped as the simulation steps it.

use rotor::step::{self, StepError};
use rotor::{C64, MAX_MASSES, Rotor, Settings, Stepper};
use wire::State;
use wire::message::Trip;

use crate::what_if::WhatIf;

/// Something that was done to the machine, before the step of that number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Act {
    /// An impulse on a mass.
    Impulse(usize, C64),
    /// Back to rest.
    Restart,
    /// Other settings, and the substeps that make a step under them.
    Settings(Settings, u32),
}

/// The line of time that a run is on: where its clock was set last, and how many Runge-Kutta steps ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) tau: f64,
    pub(super) angle: f64,
    pub(super) steps: u64,
}

/// The moment from which a branch runs on.
#[derive(Clone, Debug)]
pub(super) struct Root {
    pub(super) rotor: Rotor,
    pub(super) dtau: f64,
    /// Steps a second; 0 if it was not paced.
    pub(super) rate_hz: f64,
    /// The step it begins after.
    pub(super) state: State,
    /// The settings that this step was made with.
    pub(super) settings: Settings,
    /// In how many substeps.
    pub(super) substeps: u32,
    pub(super) line: Line,
}

impl Root {
    /// The substeps of a step under `wanted`: as many as were made where `recorded` has just these settings, else as many as
    /// the bench would make.
    ///
    /// # Errors
    /// The bench would refuse these settings.
    pub(super) fn substeps(&self, wanted: &Settings, recorded: (&Settings, u32)) -> Result<u32, StepError> {
        if wanted == recorded.0 {
            return Ok(recorded.1);
        }
        step::substeps(&wanted.closed_loop(&self.rotor), self.dtau, self.rate_hz)
    }

    /// The same for settings that are wished for from the beginning.
    ///
    /// # Errors
    /// The bench would refuse these settings.
    pub(super) fn substeps_from_here(&self, wanted: &Settings) -> Result<u32, StepError> {
        self.substeps(wanted, (&self.settings, self.substeps))
    }
}

/// The machine as it is after a step.
pub(super) struct Machine {
    stepper: Box<dyn Stepper>,
    /// Runge-Kutta steps that make one step.
    pub(super) substeps: u32,
    /// The settings in force.
    pub(super) settings: Settings,
    /// What they mean: poles and damping.
    pub(super) judged: Option<WhatIf>,
    /// The number of the last step.
    pub(super) seq: u64,
    pub(super) trip: Option<Trip>,
    /// The last state in which everything was finite: position and velocity.
    good: ([C64; MAX_MASSES], [C64; MAX_MASSES]),
}

impl Clone for Machine {
    fn clone(&self) -> Self {
        let Self { stepper, substeps, settings, judged, seq, trip, good } = self;
        let (substeps, settings, judged) = (*substeps, settings.clone(), judged.clone());
        Self { stepper: stepper.twin(), substeps, settings, judged, seq: *seq, trip: *trip, good: *good }
    }
}

impl Machine {
    /// The machine as it was at `root`, under other settings, which the bench would take; it keeps its own else.
    pub(super) fn new(root: &Root, wanted: &Settings) -> Self {
        let (wanted, substeps) =
            root.substeps_from_here(wanted).map_or((&root.settings, root.substeps), |substeps| (wanted, substeps));
        let of = |settings: &Settings| settings.closed_loop(&root.rotor);
        let mut stepper = rotor::stepper(&of(&root.settings));
        let points = root.state.points();
        let [displacement, velocity]: [Vec<C64>; 2] = [
            points.iter().map(|point| C64::new(point.y, point.z)).collect(),
            points.iter().map(|point| C64::new(point.vy, point.vz)).collect(),
        ];
        stepper.place(&displacement, &velocity);
        stepper.set_clock(root.line.tau, root.line.angle, root.line.steps, root.dtau / f64::from(root.substeps));
        stepper.load(&of(wanted));
        let held = root.state.flags.has(wire::Flags::TRIPPED);
        let mut machine = Self {
            stepper,
            substeps,
            settings: wanted.clone(),
            judged: WhatIf::of(&root.rotor, wanted.clone()),
            seq: root.state.seq,
            trip: held.then(Trip::default),
            good: ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]),
        };
        machine.good.0[..displacement.len()].copy_from_slice(&displacement);
        machine.good.1[..velocity.len()].copy_from_slice(&velocity);
        machine
    }

    /// Something is done to it.
    pub(super) fn act(&mut self, root: &Root, act: &Act) {
        match act {
            Act::Impulse(mass, velocity) => self.stepper.kick(*mass, *velocity),
            Act::Restart => {
                self.stepper.rest();
                self.trip = None;
            }
            Act::Settings(settings, substeps) => {
                self.substeps = *substeps;
                self.stepper.load(&settings.closed_loop(&root.rotor));
                self.judged = WhatIf::of(&root.rotor, settings.clone());
                self.settings = settings.clone();
            }
        }
    }

    /// One step, as the simulation makes it: past the trip limit, or out of the range of numbers, it is held.
    pub(super) fn step(&mut self, dtau: f64) {
        self.seq += 1;
        if self.trip.is_some() {
            return;
        }
        self.stepper.advance(dtau, self.substeps);
        let (motion, control) = (self.stepper.motion(), self.stepper.control());
        let (n, radius) = (motion.displacement.len(), motion.largest_radius());
        if motion.is_finite() && radius.is_finite() && control.re.is_finite() && control.im.is_finite() {
            self.good.0[..n].copy_from_slice(motion.displacement);
            self.good.1[..n].copy_from_slice(motion.velocity);
            if radius > self.settings.trip {
                self.trip = Some(self.tripped(1, n));
            }
        } else {
            self.stepper.place(&self.good.0[..n], &self.good.1[..n]);
            self.trip = Some(self.tripped(2, n));
        }
    }

    fn tripped(&self, cause: u32, masses: usize) -> Trip {
        let radius = |mass: &usize| self.good.0[*mass].norm();
        let mass = (0..masses).max_by(|a, b| radius(a).total_cmp(&radius(b))).unwrap_or(0);
        Trip { cause, mass: mass as u32 + 1, step: self.seq, radius: radius(&mass), limit: self.settings.trip }
    }

    /// Its numbers in a row: `u_y`, `u_z`, then `y`, `z` of every mass.
    pub(super) fn row(&self) -> impl Iterator<Item = f64> + '_ {
        let control = self.stepper.control();
        let places = self.stepper.motion().displacement.iter().flat_map(|p| [p.re, p.im]);
        [control.re, control.im].into_iter().chain(places)
    }
}
