//! A run as a table: one row a sample.

use std::io;
use std::path::Path;

use files::{Existing, FileError};
use machine::Machine;

use crate::run::Observer;
use crate::table::{ColumnKind, Form, Table};

/// Names of the columns: `tau`, `y1 z1 vy1 vz1` and so on for every mass, `uy uz`, and `contact` (bit `k` for mass `k + 1`).
#[must_use]
pub fn columns(masses: usize) -> Vec<String> {
    let mut names = doubles(masses);
    names.push(CONTACT.0.to_owned());
    names
}

const CONTACT: (&str, ColumnKind) = ("contact", ColumnKind::Int);

fn doubles(masses: usize) -> Vec<String> {
    let per_mass = (1..=masses).flat_map(|k| ["y", "z", "vy", "vz"].map(|name| format!("{name}{k}")));
    std::iter::once("tau".to_owned()).chain(per_mass).chain(["uy", "uz"].map(str::to_owned)).collect()
}

/// Writes one sample in every `stride`.
pub struct Writer {
    stride: u64,
    seen: u64,
    row: Vec<f64>,
    table: Table,
}

impl Writer {
    /// Begins a file, which takes the name `target` in [`Writer::finish`].
    ///
    /// # Errors
    /// As [`Table::create`].
    pub fn create(
        target: &Path,
        form: Form,
        masses: usize,
        stride: u64,
        existing: Existing,
    ) -> Result<Self, FileError> {
        let table = Table::create(target, form, &doubles(masses), &[CONTACT], existing)?;
        Ok(Self { stride: stride.max(1), seen: 0, row: Vec::new(), table })
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// As [`Table::finish`].
    pub fn finish(self) -> Result<(), FileError> {
        self.table.finish()
    }
}

impl Observer for Writer {
    fn sample(&mut self, machine: &Machine) -> io::Result<()> {
        let wanted = self.seen.is_multiple_of(self.stride);
        self.seen += 1;
        if !wanted {
            return Ok(());
        }
        let sample = machine.sample();
        let control = sample.outputs[0].delivered;
        self.row.clear();
        self.row.push(sample.tau);
        for (p, v) in sample.displacement.iter().zip(sample.velocity) {
            self.row.extend([p.re, p.im, v.re, v.im]);
        }
        self.row.extend([control.re, control.im]);
        self.table.row(&self.row, &[sample.contact.into()])
    }
}
