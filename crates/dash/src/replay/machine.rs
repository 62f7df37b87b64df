//! A machine in motion beside the recorded one, stepped as the simulation steps it.

use machine::{Output, Pace, Program, ProgramError};
use rotor::{C64, Rotor, Settings};
use wire::message::Trip;
use wire::{State, Step};

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

pub(super) use machine::Line;

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
    pub(super) fn substeps(&self, wanted: &Settings, recorded: (&Settings, u32)) -> Result<u32, ProgramError> {
        if wanted == recorded.0 {
            return Ok(recorded.1);
        }
        let pace = Pace { dtau: self.dtau, rate_hz: self.rate_hz };
        Ok(Program::compile(&self.rotor, wanted, wanted.speed, pace)?.substeps())
    }

    /// The same for settings that are wished for from the beginning.
    ///
    /// # Errors
    /// The bench would refuse these settings.
    pub(super) fn substeps_from_here(&self, wanted: &Settings) -> Result<u32, ProgramError> {
        self.substeps(wanted, (&self.settings, self.substeps))
    }
}

/// The machine as it is after a step.
#[derive(Clone)]
pub(super) struct Machine {
    machine: machine::Machine,
    /// Runge-Kutta steps that make one step.
    pub(super) substeps: u32,
    /// The settings in force.
    pub(super) settings: Settings,
    /// What they mean: poles and damping.
    pub(super) judged: Option<WhatIf>,
    /// The number of the last step.
    pub(super) seq: u64,
    pub(super) trip: Option<Trip>,
}

impl Machine {
    /// The machine as it was at `root`, under other settings, which the bench would take; it keeps its own else. Nothing if
    /// even those cannot be stepped.
    pub(super) fn new(root: &Root, wanted: &Settings) -> Result<Self, ProgramError> {
        let (wanted, substeps) =
            root.substeps_from_here(wanted).map_or((&root.settings, root.substeps), |substeps| (wanted, substeps));
        let program = |settings: &Settings, substeps| Program::in_substeps(&root.rotor, settings, root.dtau, substeps);
        let [displacement, velocity]: [Vec<C64>; 2] = [
            root.state.points().map(|point| C64::new(point.y, point.z)).collect(),
            root.state.points().map(|point| C64::new(point.vy, point.vz)).collect(),
        ];
        let force = |[y, z]: [f64; 2]| C64::new(y, z);
        let output = Output {
            commanded: force(root.state.force_commanded()),
            delivered: force(root.state.force_delivered()),
            saturated: root.state.flags().has(wire::Flags::SATURATED),
        };
        let before = program(&root.settings, root.substeps)?;
        let at = [&displacement[..], &velocity[..]];
        let mut machine = machine::Machine::resumed(before, root.line, root.state.speed(), at, output);
        machine.load(&mut Box::new(program(wanted, substeps)?));
        let held = root.state.flags().has(wire::Flags::TRIPPED);
        if held {
            machine.hold();
        }
        Ok(Self {
            machine,
            substeps,
            settings: wanted.clone(),
            judged: WhatIf::of(&root.rotor, wanted.clone()),
            seq: root.state.seq(),
            trip: held.then(Trip::default),
        })
    }

    /// Something is done to it.
    pub(super) fn act(&mut self, root: &Root, act: &Act) {
        match act {
            Act::Impulse(mass, velocity) => self.machine.kick(*mass, *velocity),
            Act::Restart => {
                self.machine.restart();
                self.trip = None;
            }
            Act::Settings(settings, substeps) => {
                // A recorded change was possible; what is not is not made.
                let Ok(program) = Program::in_substeps(&root.rotor, settings, root.dtau, *substeps) else { return };
                self.machine.load(&mut Box::new(program));
                self.substeps = *substeps;
                self.judged = WhatIf::of(&root.rotor, settings.clone());
                self.settings = settings.clone();
            }
        }
    }

    /// One step, as the simulation makes it: past the trip limit, or out of the range of numbers, it is held.
    pub(super) fn step(&mut self) {
        self.seq += 1;
        if let Some(trip) = self.machine.step() {
            self.trip = Some(Trip::new(self.seq, trip.cause as u32, trip.station, [trip.radius, trip.limit]));
        }
    }

    /// Its numbers in a row: `u_y`, `u_z`, then `y`, `z` of every mass.
    pub(super) fn row(&self) -> impl Iterator<Item = f64> + '_ {
        let sample = self.machine.sample();
        let control = sample.output.delivered;
        let places = sample.displacement.iter().flat_map(|p| [p.re, p.im]);
        [control.re, control.im].into_iter().chain(places)
    }
}
