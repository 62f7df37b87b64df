//! Where the trajectory of a run goes: a table, or a recording.

use std::io;
use std::path::Path;

use study::run::{Impulse, Observer, Plan};
use study::table::{Form, FormError};
use study::trajectory::Writer;
use tape::OfflineTape;

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::place::Force;

/// A file that a run is written to.
pub(super) enum Out {
    /// CSV or Parquet.
    Table(Box<Writer>),
    /// `.rrd`.
    Tape(Box<Recorder>),
}

/// A recording that watches a run.
pub(super) struct Recorder(OfflineTape);

impl Observer for Recorder {
    fn sample(&mut self, machine: &machine::Machine) -> io::Result<()> {
        self.0.sample(machine)
    }

    fn impulse(&mut self, impulse: &Impulse) -> io::Result<()> {
        self.0.impulse(impulse.at, impulse.mass, impulse.change)
    }

    fn stretch(&mut self, machine: &machine::Machine) -> io::Result<()> {
        self.0.stretch(machine)
    }
}

impl Out {
    /// Opens what the ending of `path` asks for.
    ///
    /// # Errors
    /// An ending that is not known or not built in, or a place that cannot be written.
    pub(super) fn open(path: &Path, force: Force, machine: &Machine, plan: &Plan, every: u64) -> Result<Self, Failure> {
        let Machine { rotor, settings, .. } = machine;
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("rrd")) {
            tape::available()?;
            force.check(path)?;
            let tape = OfflineTape::create(path, force.existing(), rotor, settings, (plan.longest_step(), 1), every)?;
            return Ok(Self::Tape(Box::new(Recorder(tape))));
        }
        let form = Form::of(path).map_err(|error| match error {
            FormError::Unknown(path) => Failure::Usage(format!(
                "'{}': expected a file name that ends in .csv, .parquet or .rrd",
                path.display()
            )),
            error @ FormError::NoParquet => Failure::Usage(error.to_string()),
        })?;
        Ok(Self::Table(Box::new(Writer::create(path, form, rotor.len(), every, force.existing())?)))
    }

    /// What watches the run.
    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        match self {
            Self::Table(writer) => writer.as_mut(),
            Self::Tape(tape) => tape.as_mut(),
        }
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// The rest cannot be written.
    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Table(writer) => Ok(writer.finish()?),
            Self::Tape(tape) => Ok(tape.0.finish("the run is over")?),
        }
    }
}
