//! The text of a file that a person has named, and how what is wrong with it is told.

use std::fs::File;
use std::io::{IsTerminal, Read};

use text::{Faults, MAX_BYTES};

use crate::failure::Failure;

/// Why there is nothing to be had from a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum FileError {
    /// Its bytes cannot be read.
    #[error("{file}: {found}: expected a TOML file that can be read")]
    Unreadable {
        /// The file as typed.
        file: String,
        /// What is there instead.
        found: String,
    },
    /// What it says is wrong.
    #[error("{}", faults.in_file(file))]
    Wrong {
        /// The file as typed.
        file: String,
        /// What it says.
        text: String,
        /// What is wrong with it.
        faults: Faults,
    },
}

impl FileError {
    /// What is wrong with a file that says `text`.
    pub(crate) fn wrong(file: &str, text: &str, faults: Faults) -> Self {
        Self::Wrong { file: file.to_owned(), text: text.to_owned(), faults }
    }

    /// It as stderr has it: a line a fault for scripts, and on a terminal the file's own line under each.
    pub(crate) fn told(&self) -> String {
        match self {
            Self::Wrong { file, text, faults } if std::io::stderr().is_terminal() => faults.drawn(file, text),
            _ => self.to_string(),
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::Usage(error.told())
    }
}

/// The text of a file, which may be a pipe, up to the largest size that is read.
///
/// # Errors
/// It is not there, not a file, not readable, too large or not UTF-8.
pub(crate) fn text(path: &str) -> Result<String, FileError> {
    let unreadable = |found: String| FileError::Unreadable { file: path.to_owned(), found };
    let failed = |error: std::io::Error| {
        unreadable(match error.kind() {
            std::io::ErrorKind::NotFound => "no such file".into(),
            std::io::ErrorKind::PermissionDenied => "no permission to read it".into(),
            std::io::ErrorKind::IsADirectory => "a directory".into(),
            _ => error.to_string(),
        })
    };
    let opened = File::open(path).map_err(failed)?;
    if opened.metadata().is_ok_and(|data| data.is_dir()) {
        return Err(unreadable("a directory".into()));
    }
    let mut bytes = Vec::new();
    // One byte more than allowed, so that too much is seen without reading all of it.
    opened.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    let text = text::utf8(&bytes, "a TOML file").map_err(|faults| FileError::wrong(path, "", faults))?;
    Ok(text.to_owned())
}
