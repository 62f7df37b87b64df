//! What if: the machine run on from a recorded step with other settings, beside what happened.
//!
//! Everything else that was done to the machine is done to this one too: impulses, restarts and changes of other settings
//! come at the steps at which they came. With nothing changed it reproduces what happened to the last bit, as far as the
//! recording tells on which line of time the run was ([`super::machine::ClockOrigin`]).
//!
//! It may run on for as long as the recording does. What it remembers is bounded: where it was lately, step by step
//! ([`Rows`]), and how it was now and then, so that what is forgotten can be run anew when somebody goes back to it. A long
//! way is gone in stages, so that nobody waits for it with a dead screen.

use std::ops::Range;

use machine::ProgramError;
use rotor::Settings;
use wire::Step;
use wire::message::Trip;

use super::machine::{BranchPoint, Machine, RecordedChange};
use super::rows::Rows;
use crate::edits::{self, Edit};
use crate::replay::ReplayError;
use crate::units::ScreenUnits;
use crate::what_if::WhatIf;

/// Runge-Kutta steps that are made at once: a tenth of a second or so.
const AT_ONCE: u64 = 200_000;
/// Steps from one memory of how the machine was to the next.
const STRIDE: u64 = 1 << 16;

/// What a person has changed.
#[derive(Clone, Debug, PartialEq)]
struct BranchState {
    settings: Settings,
    acts: Vec<(u64, RecordedChange)>,
}

/// A machine beside the recorded one.
pub(crate) struct Branch {
    root: BranchPoint,
    state: BranchState,
    done: Vec<BranchState>,
    undone: Vec<BranchState>,
    machine: Machine,
    rows: Rows,
    /// How it was at the root and every [`STRIDE`] steps from there, as far as it has come; never empty.
    memories: Vec<Machine>,
}

impl Branch {
    /// A machine that goes on from `root` as it was.
    ///
    /// # Errors
    /// Settings that this version cannot step.
    pub(crate) fn new(root: BranchPoint) -> Result<Self, ProgramError> {
        let state = BranchState { settings: root.settings.clone(), acts: Vec::new() };
        let machine = Machine::new(&root, &state.settings)?;
        let rows = Self::rows_from(&machine, &root);
        let memories = vec![machine.clone()];
        Ok(Self { root, state, done: Vec::new(), undone: Vec::new(), machine, rows, memories })
    }

    /// The same edits from another moment on; or why the bench would not have taken them then.
    pub(crate) fn moved_to(&self, root: BranchPoint) -> Result<Self, ProgramError> {
        let mut moved = Self::new(root)?;
        edits::carry_over(&self.root.settings, &self.state.settings, &mut moved.state.settings);
        moved.root.substeps_from_here(&moved.state.settings)?;
        Ok(moved)
    }

    /// No more than where a machine is now.
    fn rows_from(machine: &Machine, root: &BranchPoint) -> Rows {
        let bearings = root.state.bearings();
        let mut rows = Rows::new(2 * (bearings + root.rotor.len()), machine.seq);
        rows.push(machine.row(bearings));
        rows
    }

    /// Its time where it begins.
    pub(crate) fn tau(&self) -> f64 {
        self.root.state.tau()
    }

    /// The step it begins after.
    pub(crate) fn from(&self) -> u64 {
        self.root.state.seq()
    }

    /// The settings in force in it.
    pub(crate) fn settings(&self) -> &Settings {
        &self.machine.settings
    }

    /// What they mean: poles and the smallest damping ratio.
    pub(crate) fn judged(&self) -> Option<&WhatIf> {
        self.machine.judged.as_ref()
    }

    /// What has tripped it, if it has.
    pub(crate) fn trip(&self) -> Option<Trip> {
        self.machine.trip
    }

    /// Takes an edit at step `at`, not before the root. Returns what was done, in words, or why not.
    pub(crate) fn edit(&mut self, edit: &Edit, at: u64) -> Result<String, ReplayError> {
        let mut state = self.state.clone();
        let units = ScreenUnits::of_machine(&self.root.rotor, &state.settings.feedback);
        let words = match edit {
            Edit::Undo => {
                let last = self.done.pop().ok_or(ReplayError::NothingToUndo)?;
                self.undone.push(std::mem::replace(&mut self.state, last));
                return Ok("undone".into());
            }
            Edit::Redo => {
                let next = self.undone.pop().ok_or(ReplayError::NothingToRedo)?;
                self.done.push(std::mem::replace(&mut self.state, next));
                return Ok("done again".into());
            }
            Edit::Impulse(mass, velocity) => {
                state.acts.push((at + 1, RecordedChange::Impulse(*mass, *velocity)));
                edit.describe(&units)
            }
            Edit::Restart => {
                state.acts.push((at + 1, RecordedChange::Restart));
                "restarts from rest".to_owned()
            }
            Edit::Note(_) => return Err(ReplayError::NoNotes),
            edit => {
                edit.apply(&mut state.settings).map_err(|error| ReplayError::settings(error, &units))?;
                edit.describe_in(&state.settings, &units)
            }
        };
        state.settings.check(&self.root.rotor).map_err(|error| ReplayError::settings(error, &units))?;
        self.root.substeps_from_here(&state.settings)?;
        self.done.push(std::mem::replace(&mut self.state, state));
        self.undone.clear();
        Ok(words)
    }

    /// Begins all over again at its root: the edits hold from the beginning.
    pub(crate) fn begin(&mut self) {
        // They were looked at when they were made.
        if let Ok(machine) = Machine::new(&self.root, &self.state.settings) {
            self.machine = machine;
        }
        self.rows = Self::rows_from(&self.machine, &self.root);
        self.memories = vec![self.machine.clone()];
    }

    /// Runs on towards the end of `wanted`, by so many steps at most that nobody notices, and remembers where it has been
    /// within `wanted`; `acts` is what was done to the recorded machine, ascending in step.
    pub(crate) fn advance(&mut self, wanted: Range<u64>, acts: &[(u64, RecordedChange)]) {
        self.turn_to(&wanted);
        let mut recorded = acts.partition_point(|(at, _)| *at <= self.machine.seq);
        let mut made = 0;
        while made < AT_ONCE {
            let seq = self.machine.seq + 1;
            if seq >= wanted.end {
                return;
            }
            let mut still = false;
            while let Some((_, act)) = acts.get(recorded).filter(|(at, _)| *at == seq) {
                recorded += 1;
                still |= self.root.is_still(act);
                let act = match act {
                    RecordedChange::Settings(there, substeps) => {
                        let carried = self.state.carried_to(&self.root, there);
                        // What the bench would have refused is not done here either.
                        let Ok(substeps) = self.root.substeps(&carried, (there, *substeps)) else { continue };
                        RecordedChange::Settings(carried, substeps)
                    }
                    other => other.clone(),
                };
                self.machine.act(&self.root, &act);
            }
            for (_, act) in self.state.acts.iter().filter(|(at, _)| *at == seq) {
                self.machine.act(&self.root, act);
            }
            self.machine.step(still);
            made += u64::from(self.machine.substeps);
            self.rows.push(self.machine.row(self.root.state.bearings()));
            let is_new = self.memories.last().is_none_or(|last| last.seq + STRIDE <= seq);
            if is_new && (seq - self.from()).is_multiple_of(STRIDE) {
                self.memories.push(self.machine.clone());
            }
        }
    }

    /// Goes back to a memory where steps that are wanted have been forgotten, or on to one that is nearer than we are.
    fn turn_to(&mut self, wanted: &Range<u64>) {
        let from = wanted.start.max(wanted.end.saturating_sub(self.rows.room() / 2)).max(self.from());
        let near = self.memories.partition_point(|memory| memory.seq <= from).max(1) - 1;
        let forgotten = self.rows.range().start > from;
        if forgotten || self.memories[near].seq > self.machine.seq {
            self.machine = self.memories[near].clone();
            self.rows = Self::rows_from(&self.machine, &self.root);
        }
    }

    /// How many steps it is away from step `seq`.
    pub(crate) fn lag(&self, seq: u64) -> u64 {
        seq.saturating_sub(self.machine.seq)
    }

    /// Displacement `[y, z]` of a mass at step `seq`, if it is known there.
    pub(crate) fn displacement(&self, seq: u64, mass: usize) -> Option<[f64; 2]> {
        let at = 2 * (self.root.state.bearings() + mass);
        self.rows.get(seq).map(|row| [row[at], row[at + 1]])
    }

    /// Control `[y, z]` of a control bearing, counted from 0, at step `seq`.
    pub(crate) fn force(&self, seq: u64, bearing: usize) -> Option<[f64; 2]> {
        let at = (bearing < self.root.state.bearings()).then_some(2 * bearing)?;
        self.rows.get(seq).map(|row| [row[at], row[at + 1]])
    }
}

impl BranchState {
    /// Recorded settings with what was edited in place of what was.
    fn carried_to(&self, root: &BranchPoint, recorded: &Settings) -> Settings {
        let mut settings = recorded.clone();
        edits::carry_over(&root.settings, &self.settings, &mut settings);
        settings
    }
}
