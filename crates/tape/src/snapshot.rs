//! All of a machine at a moment, so that whoever goes on from a recording begins as the machine was, with what its loop holds: commands
//! under way, filters, a generator of noise, a speed on its way.

use machine::Machine;

/// A machine just before a step, written down.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The number of that step. What was done to the machine before it has been done.
    pub next: u64,
    /// How long it is, and those after it until a snapshot says otherwise, in `tau`; not finite in words of another version.
    pub dtau: f64,
    /// As [`machine::Machine::save`] writes them. They fit a machine under the settings that the step is made with.
    pub words: Vec<u64>,
}

/// Words before those of the machine.
const HEAD: usize = 2;

impl Snapshot {
    /// What a machine has written down before step `next`.
    #[must_use]
    pub fn new(next: u64, words: &[u64]) -> Self {
        Self { next, dtau: Machine::saved_dtau(words).unwrap_or(f64::NAN), words: words.to_vec() }
    }

    /// As a row of words on file.
    pub(crate) fn row(&self) -> impl Iterator<Item = u64> + '_ {
        [self.next, self.dtau.to_bits()].into_iter().chain(self.words.iter().copied())
    }

    /// How many words that is.
    pub(crate) fn width(&self) -> usize {
        HEAD + self.words.len()
    }

    /// `None` if a row is too short to be one.
    pub(crate) fn of_row(row: &[u64]) -> Option<Self> {
        let ([next, dtau], words) = row.split_first_chunk::<HEAD>()?;
        Some(Self { next: *next, dtau: f64::from_bits(*dtau), words: words.to_vec() })
    }
}

/// Where on file one is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SnapshotPlace {
    /// In which of the files.
    pub(crate) part: usize,
    /// Of the message that it is in.
    pub(crate) offset: u64,
    pub(crate) bytes: u64,
    pub(crate) next: u64,
    pub(crate) dtau: f64,
}
