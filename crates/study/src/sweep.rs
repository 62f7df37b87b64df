//! Maps, samples and starts of a search cut into shards: each a pure function of the question and of its number, on whatever machine.
//!
//! A question is a list of rows, each of which depends on its index alone; a shard is a stretch of them. So what is gathered is the same,
//! row for row, however it was cut and whoever did it. A shard's file takes its name when it is whole: one that died is run again, and
//! nothing is counted twice.

mod task;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use files::{Existing, FileError};
use tuner::ProblemError;
use variation::SamplesError;

use crate::map::MapError;
use crate::table::{ColumnKind, Form, Table};

pub use task::{OBJECTIVE, Simulated, Task};

/// More shards than this are refused.
pub const MOST_SHARDS: u64 = 100_000;

/// Why there is no shard.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A row of a map, or a sample that is simulated.
    #[error(transparent)]
    Map(MapError),
    /// A sample.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// A start of a search.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Its file.
    #[error(transparent)]
    File(#[from] FileError),
    /// Its file cannot be written, or not read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// The rows of a shard, counted from 0: as even as can be.
#[must_use]
pub fn rows_of(shard: u64, shards: u64, rows: u64) -> Range<u64> {
    let at = |k: u64| (u128::from(rows) * u128::from(k) / u128::from(shards)) as u64;
    at(shard)..at(shard + 1)
}

impl From<MapError> for SweepError {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Interrupted => Self::Interrupted,
            error => Self::Map(error),
        }
    }
}

impl Task {
    /// Computes rows and writes them into `target`, which is there whole or not at all.
    ///
    /// # Errors
    /// A row that cannot be had, a file that cannot be written, or `stop`.
    pub fn write(&self, rows: Range<u64>, target: &Path, form: Form, stop: &AtomicBool) -> Result<(), SweepError> {
        /// Rows that are kept before they are written.
        const AT_ONCE: u64 = 1 << 14;
        let mut table = Table::create(target, form, &self.columns(), &[("index", ColumnKind::Long)], Existing::Keep)?;
        let mut from = rows.start;
        while from < rows.end {
            let to = rows.end.min(from + AT_ONCE);
            for (row, index) in self.some(from..to, stop)?.iter().zip(from..) {
                table.row(row, &[index])?;
            }
            from = to;
        }
        Ok(table.finish()?)
    }
}

/// The name of a shard's file: it says of how many it is, and of which question.
#[must_use]
pub fn file_name(shard: u64, shards: u64, question: &str, form: Form) -> String {
    format!("shard-{shard:05}-of-{shards:05}-{question}.{}", form.name())
}

/// The files of shards in a folder: those of this question by number, and the names of all others.
///
/// # Errors
/// A folder that cannot be read.
pub fn found(
    folder: &Path,
    shards: u64,
    question: &str,
    form: Form,
) -> std::io::Result<(Vec<Option<PathBuf>>, Vec<String>)> {
    let names: Vec<String> = (0..shards).map(|shard| file_name(shard, shards, question, form)).collect();
    let mut others = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        // Sorted by number, and so by name.
        if name.starts_with("shard-") && names.binary_search(&name).is_err() {
            others.push(name);
        }
    }
    others.sort();
    let path = |name: &String| Some(folder.join(name)).filter(|path| path.is_file());
    Ok((names.iter().map(path).collect(), others))
}

/// A column of a shard's file, by its name.
///
/// # Errors
/// A file that cannot be read, or that has no such column of numbers.
pub fn column(path: &Path, form: Form, name: &str) -> std::io::Result<Vec<f64>> {
    crate::table::read_column(path, form, name)
}

/// How many rows a shard's file has.
///
/// # Errors
/// A file that cannot be read.
pub fn count_rows(path: &Path, form: Form) -> std::io::Result<u64> {
    match form {
        Form::Csv => {
            let text = std::fs::read(path)?;
            Ok((text.iter().filter(|byte| **byte == b'\n').count() as u64).saturating_sub(1))
        }
        Form::Parquet => crate::table::count_parquet_rows(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_every_row_once() {
        for (rows, shards) in [(10, 3), (7, 7), (3, 5), (1_000_003, 64)] {
            let parts: Vec<Range<u64>> = (0..shards).map(|k| rows_of(k, shards, rows)).collect();
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, rows));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
            let sizes: Vec<u64> = parts.iter().map(|part| part.end - part.start).collect();
            assert!(sizes.iter().max().expect("some") - sizes.iter().min().expect("some") <= 1);
        }
    }
}
