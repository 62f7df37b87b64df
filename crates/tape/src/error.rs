//! What can go wrong with a recording, in words for the person at the terminal.

use std::io;
use std::path::{Path, PathBuf};

/// Why a recording cannot be made, gone on with, or read.
#[derive(Debug, thiserror::Error)]
pub enum TapeError {
    /// This build has no encoder.
    #[error(
        "this whirl was built without recordings: build it with `cargo build --release --features rerun`, or \
         install it with `cargo install --path crates/whirl --features rerun` (some minutes, once)"
    )]
    NoRerun,
    /// The place for the file is wrong: nothing has been done.
    #[error("'{}': {problem}", path.display())]
    Place {
        /// The path as given.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The file is not a recording, or not one that this version reads.
    #[error("'{}': {problem}", path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        problem: String,
    },
    /// Writing failed on the way. What was on disk by then stays readable.
    #[error("cannot go on writing '{}': {problem}; {}", path.display(), left(*bytes))]
    Stopped {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: String,
        /// Whole bytes on disk.
        bytes: u64,
    },
    /// Reading failed on the way.
    #[error("cannot read '{}': {problem}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// The file is there already, or no file can be there.
    #[error(transparent)]
    File(#[from] files::FileError),
    /// No address of a viewer.
    #[error("viewer '{address}': {problem}: expected HOST:PORT, such as 127.0.0.1:9876")]
    Viewer {
        /// As given.
        address: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The bench failed.
    #[error(transparent)]
    Wire(#[from] wire::WireError),
}

impl TapeError {
    /// Whether the command line or a file is wrong, rather than the work failed: exit code 2 instead of 1.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::NoRerun | Self::Place { .. } | Self::NotOurs { .. } | Self::Viewer { .. } => true,
            Self::File(error) => error.is_usage(),
            Self::Stopped { .. } | Self::Read { .. } | Self::Wire(_) => false,
        }
    }

    pub(crate) fn place(path: &Path, problem: impl Into<String>) -> Self {
        Self::Place { path: path.to_owned(), problem: problem.into() }
    }

    pub(crate) fn not_ours(path: &Path, problem: impl Into<String>) -> Self {
        Self::NotOurs { path: path.to_owned(), problem: problem.into() }
    }

    #[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
    pub(crate) fn read(path: &Path, problem: impl ToString) -> Self {
        Self::Read { path: path.to_owned(), problem: problem.to_string() }
    }

    /// Something else has the name.
    pub(crate) fn taken(path: &Path) -> Self {
        files::FileError::Exists(path.to_owned()).into()
    }

    /// A place where a file cannot be made.
    pub(crate) fn unfit(path: &Path, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::AlreadyExists => Self::taken(path),
            _ => Self::place(path, format!("cannot be made: {error}")),
        }
    }
}

/// What a recording that could not go on leaves.
fn left(bytes: u64) -> String {
    match bytes {
        0 => "nothing of it is left".to_owned(),
        bytes => format!("what is there stays readable ({bytes} bytes)"),
    }
}
