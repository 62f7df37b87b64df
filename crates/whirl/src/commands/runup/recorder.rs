//! A run-up as a recording, every step of it.

use std::io;
use std::path::Path;

use machine::{Machine, Program};
use study::runup::{RunUp, RunUpPlan};
use tape::OfflineTape;

use crate::failure::Failure;
use crate::place::Force;

/// A recording that watches a run-up.
pub(super) struct Recorder {
    tape: OfflineTape,
    begun: bool,
    /// What went wrong first: the run-up goes on, and is told of at its end.
    failed: Option<io::Error>,
}

impl Recorder {
    /// Begins to record what `plan` steps, which is `program`.
    ///
    /// # Errors
    /// A place that cannot be written.
    #[expect(clippy::needless_pass_by_value, reason = "made for this alone")]
    pub(super) fn create(path: &Path, force: Force, plan: &RunUpPlan, program: Program) -> Result<Self, Failure> {
        let settings = plan.settings_under_way();
        let step = (program.step(), program.substeps());
        let mut tape = OfflineTape::create(path, force.existing(), &plan.rotor, &settings, step, 1)?;
        let told = plan.profile.told(plan.rotor.scales().copied());
        let failed = tape.note(&told).err();
        Ok(Self { tape, begun: false, failed })
    }

    /// Takes a sample.
    pub(super) fn see(&mut self, machine: &Machine) {
        if self.failed.is_some() {
            return;
        }
        let begins = !std::mem::replace(&mut self.begun, true);
        let taken = self.tape.sample(machine);
        // All of the machine, before its first step.
        self.failed = taken.and_then(|()| if begins { self.tape.stretch(machine) } else { Ok(()) }).err();
    }

    /// Completes the file, with the trip if there was one, and gives it its name.
    ///
    /// # Errors
    /// It could not be written.
    pub(super) fn finish(mut self, found: &RunUp) -> Result<(), Failure> {
        let tripped = found.tripped.map(|(trip, _, _)| self.tape.tripped(trip)).transpose();
        if let Some(error) = self.failed.or(tripped.err()) {
            return Err(Failure::Work(format!("cannot write the recording: {error}")));
        }
        Ok(self.tape.finish("the run-up is over")?)
    }
}
