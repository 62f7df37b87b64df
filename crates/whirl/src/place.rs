//! Where results go that are files: refused before any work is done, there whole or not at all, and in place of nothing
//! without `--force`.

use std::path::Path;

use files::{Existing, FileError};

use crate::failure::Failure;

/// `--force`, for every command that writes a file. What it writes is in the group `written`.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct Force {
    /// Replace a file that is there already
    #[arg(long, requires = "written")]
    force: bool,
}

impl Force {
    /// What becomes of a file that is there already.
    #[must_use]
    pub(crate) fn existing(self) -> Existing {
        if self.force { Existing::Replace } else { Existing::Keep }
    }

    /// Refuses a path where nothing can be written, before there is anything to write.
    ///
    /// # Errors
    /// A file is there already, or something that is none.
    pub(crate) fn check(self, path: &Path) -> Result<(), Failure> {
        Ok(files::check(path, self.existing())?)
    }

    /// Writes a file, whole or not at all.
    ///
    /// # Errors
    /// As [`Force::check`], or the disk is full.
    pub(crate) fn write(self, path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        Ok(files::write(path, content.as_ref(), self.existing())?)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        if error.is_usage() { Self::Usage(error.to_string()) } else { Self::Work(error.to_string()) }
    }
}
