//! A machine in motion beside the recorded one, stepped as the simulation steps it.

use machine::{Excitation, Multisine, Output, Pace, Program, ProgramError, StateWords};
use rotor::{C64, Rotor, Settings};
use wire::message::Trip;
use wire::{State, Step};

use crate::what_if::WhatIf;

/// Steps of integration to a place from the last snapshot before it, at most: a tenth of a second or so.
const MOST_STEPS: u64 = 200_000;

/// Something that was done to the machine, before the step of that number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RecordedChange {
    /// An impulse on a mass.
    Impulse(usize, C64),
    /// Back to rest.
    Restart,
    /// Other settings, and the substeps that make a step under them.
    Settings(Settings, u32),
    /// Steps of another length.
    Pace(f64),
    /// Tones added to the loop's command, or no longer.
    Excitation(Option<Multisine>),
}

pub(super) use machine::ClockOrigin;

/// The moment from which a branch runs on.
#[derive(Clone, Debug)]
pub(super) struct BranchPoint {
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
    pub(super) line: ClockOrigin,
    /// The machine after this step with all that it held, where a snapshot of it led there.
    pub(super) restored: Option<machine::Machine>,
}

impl BranchPoint {
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
        Ok(Program::compile(&self.rotor, wanted, [wanted.speed; 2], pace)?.substeps())
    }

    fn program(&self, settings: &Settings, substeps: u32) -> Result<Program, ProgramError> {
        Program::in_substeps(&self.rotor, settings, self.dtau, substeps)
    }

    /// The machine as far as a step tells of it: what its loop holds is not known.
    fn resumed(&self) -> Result<machine::Machine, ProgramError> {
        let [displacement, velocity]: [Vec<C64>; 2] = [
            self.state.points().map(|point| C64::new(point.y, point.z)).collect(),
            self.state.points().map(|point| C64::new(point.vy, point.vz)).collect(),
        ];
        let saturated = self.state.flags().has(wire::Flags::SATURATED);
        let output = |bearing| {
            let [commanded, delivered] = self.state.force(bearing).map(complex);
            Output { commanded, delivered, saturated }
        };
        let outputs: Vec<Output> = (0..self.state.bearings()).map(output).collect();
        let program = self.program(&self.settings, self.substeps)?;
        let at = [&displacement[..], &velocity[..]];
        Ok(machine::Machine::resumed(program, self.line, self.state.speed(), at, &outputs))
    }

    /// The machine with all that it held, run on from a snapshot of it before step `next`, when it was under `settings` in so many
    /// `substeps`, through what was done to it. `None` where that does not lead to the very step that was recorded.
    pub(super) fn recalled(
        &self,
        (next, words): (u64, Vec<u64>),
        (settings, substeps): (&Settings, u32),
        acts: &[(u64, RecordedChange)],
    ) -> Option<machine::Machine> {
        let seq = self.state.seq();
        if seq.checked_sub(next)? > MOST_STEPS / u64::from(substeps.max(1)) {
            return None;
        }
        let mut machine = machine::Machine::new(self.program(settings, substeps).ok()?);
        machine.restore(&mut StateWords::from_saved(words)).then_some(())?;
        let mut to_do = acts[acts.partition_point(|(at, _)| *at <= next)..].iter().peekable();
        for step in next..=seq {
            let mut still = false;
            while let Some((_, act)) = to_do.next_if(|(at, _)| *at == step) {
                still |= self.is_still(act);
                match act {
                    RecordedChange::Impulse(mass, velocity) => machine.kick(*mass, *velocity),
                    RecordedChange::Restart => machine.restart(),
                    RecordedChange::Settings(settings, substeps) => {
                        load(&mut machine, self.program(settings, *substeps).ok()?);
                    }
                    RecordedChange::Pace(dtau) => machine.pace(*dtau),
                    RecordedChange::Excitation(multisine) => excite(&mut machine, multisine.as_ref()),
                }
            }
            if !still {
                machine.step();
            }
        }
        self.is_recorded(&machine).then_some(machine)
    }

    /// Whether a machine is, to the last bit, where the recorded one was.
    fn is_recorded(&self, machine: &machine::Machine) -> bool {
        let (sample, state) = (machine.sample(), &self.state);
        let mut motion = sample.displacement.iter().zip(sample.velocity).zip(state.points());
        (sample.tau, sample.angle) == (state.tau(), state.angle())
            && sample.outputs.len() == state.bearings()
            && (sample.outputs.iter().enumerate()).all(|(k, output)| output.delivered == complex(state.force(k)[1]))
            && motion.all(|((p, v), point)| *p == C64::new(point.y, point.z) && *v == C64::new(point.vy, point.vz))
    }

    /// Whether what was done is a step of its own in the recording, over which no time passes: an impulse in a run without a bench.
    pub(super) fn is_still(&self, act: &RecordedChange) -> bool {
        self.rate_hz == 0.0 && matches!(act, RecordedChange::Impulse(..))
    }

    /// The same for settings that are edited from the beginning.
    ///
    /// # Errors
    /// The bench would refuse these settings.
    pub(super) fn substeps_from_here(&self, wanted: &Settings) -> Result<u32, ProgramError> {
        self.substeps(wanted, (&self.settings, self.substeps))
    }
}

fn complex([y, z]: [f64; 2]) -> C64 {
    C64::new(y, z)
}

/// Other settings, in steps as long as they were.
fn load(machine: &mut machine::Machine, program: Program) {
    let dtau = machine.dtau();
    machine.load(&mut Box::new(program));
    machine.pace(dtau);
}

/// Tones that the bench took are in order.
fn excite(machine: &mut machine::Machine, multisine: Option<&Multisine>) {
    machine.excite(0, &mut multisine.and_then(|multisine| Excitation::of(multisine).ok()).map(Box::new));
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
    pub(super) fn new(root: &BranchPoint, wanted: &Settings) -> Result<Self, ProgramError> {
        let (wanted, substeps) =
            root.substeps_from_here(wanted).map_or((&root.settings, root.substeps), |substeps| (wanted, substeps));
        let mut machine = match &root.restored {
            Some(restored) => restored.clone(),
            None => root.resumed()?,
        };
        let flags = root.state.flags();
        let tripped = flags.has(wire::Flags::TRIPPED);
        if tripped && machine.trip().is_none() {
            match flags.stands_still() {
                true => machine.hold(),
                false => machine.coast_down(-root.state.speed_rate()),
            }
        }
        // Nothing was loaded where nothing was changed.
        if root.restored.is_none() || (wanted, substeps) != (&root.settings, root.substeps) {
            load(&mut machine, root.program(wanted, substeps)?);
        }
        Ok(Self {
            machine,
            substeps,
            settings: wanted.clone(),
            judged: WhatIf::of(&root.rotor, wanted.clone()),
            seq: root.state.seq(),
            trip: tripped.then(Trip::default),
        })
    }

    /// Something is done to it.
    pub(super) fn act(&mut self, root: &BranchPoint, act: &RecordedChange) {
        match act {
            RecordedChange::Impulse(mass, velocity) => self.machine.kick(*mass, *velocity),
            RecordedChange::Restart => {
                self.machine.restart();
                self.trip = None;
            }
            RecordedChange::Pace(dtau) => self.machine.pace(*dtau),
            RecordedChange::Excitation(multisine) => excite(&mut self.machine, multisine.as_ref()),
            RecordedChange::Settings(settings, substeps) => {
                // A recorded change was possible; what is not is not made.
                let Ok(program) = root.program(settings, *substeps) else { return };
                load(&mut self.machine, program);
                self.substeps = *substeps;
                self.judged = WhatIf::of(&root.rotor, settings.clone());
                self.settings = settings.clone();
            }
        }
    }

    /// One step, as the simulation makes it: past the trip limit, or out of the range of numbers, it is held or
    /// coasts down. If it is to stand still
    /// there is one more in the recording, and no time passes.
    pub(super) fn step(&mut self, still: bool) {
        self.seq += 1;
        if still {
            return;
        }
        if let Some(trip) = self.machine.step() {
            self.trip = Some(Trip::new(self.seq, trip.cause as u32, trip.station, [trip.radius, trip.limit]));
        }
    }

    /// Its numbers in a row: `u_y`, `u_z` of so many control bearings, nothing of those that it has not, then `y`, `z` of every mass.
    pub(super) fn row(&self, bearings: usize) -> impl Iterator<Item = f64> + '_ {
        let sample = self.machine.sample();
        let controls = (0..bearings).map(move |k| sample.outputs.get(k).map_or(C64::ZERO, |output| output.delivered));
        controls.chain(sample.displacement.iter().copied()).flat_map(|z| [z.re, z.im])
    }
}
