//! Files that a person has asked for: written whole or not at all, and in place of nothing unless that was asked for too.
//!
//! One rule for every command: a file that is there already is refused before any work is done, and replaced with
//! `--force`. A [`Draft`] is written beside its place and takes its name when it is whole, so that whoever interrupts it
//! finds what was there before, and two that write the same name do not replace each other. What must be on disk while it
//! is written, as a recording, is made with [`make`].
//!
//! ```
//! use files::{Draft, Existing, FileError, check};
//! use std::io::Write;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("gains.toml");
//! let mut draft = Draft::begin(&path, Existing::Keep)?;
//! draft.write_all(b"bearing = 1\n")?;
//! assert!(!path.exists());
//! draft.finish()?;
//! assert!(matches!(check(&path, Existing::Keep), Err(FileError::Exists(_))));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Not its job: what is in a file, and files that a program keeps for itself.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What becomes of a file that is there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and nothing is written.
    #[default]
    Keep,
    /// The new one takes its place.
    Replace,
}

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Something else has the name.
    #[error("'{}' is already there: choose another name, or replace it with --force", .0.display())]
    Exists(PathBuf),
    /// The name is none of a file.
    #[error("'{}' is {what}: expected a file to write", path.display())]
    NoFile {
        /// The name.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// No file can be made there.
    #[error("cannot write '{}': {error}", path.display())]
    Unfit {
        /// Where.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// Writing failed on the way. Nothing of it is left.
    #[error("cannot write '{}': {error}", path.display())]
    Failed {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl FileError {
    /// Whether the name is wrong, rather than that the work failed.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        !matches!(self, Self::Failed { .. })
    }

    /// As an error of writing.
    fn failed(path: &Path, error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::AlreadyExists => Self::Exists(path.to_owned()),
            _ => Self::Failed { path: path.to_owned(), error },
        }
    }

    fn unfit(path: &Path, error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::AlreadyExists => Self::Exists(path.to_owned()),
            _ => Self::Unfit { path: path.to_owned(), error },
        }
    }
}

/// Whether a file can be written at `path`, as far as that can be told before there is anything to write.
///
/// # Errors
/// A file is there and is to be kept, or something that is no file, or there is no folder for it.
pub fn check(path: &Path, existing: Existing) -> Result<(), FileError> {
    let no_file = |what| Err(FileError::NoFile { path: path.to_owned(), what });
    match path.metadata() {
        Ok(found) if found.is_dir() => return no_file("a directory"),
        Ok(found) if !found.is_file() => return no_file("no regular file"),
        _ if path.file_name().is_none() => return no_file("no file name"),
        _ => {}
    }
    // A link that leads nowhere is something too.
    if existing == Existing::Keep && path.symlink_metadata().is_ok() {
        return Err(FileError::Exists(path.to_owned()));
    }
    match folder(path).metadata() {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(FileError::unfit(path, io::ErrorKind::NotADirectory.into())),
        Err(error) => Err(FileError::unfit(path, error)),
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file in the making, beside its place. Dropped, nothing of it is left.
#[derive(Debug)]
pub struct Draft {
    target: PathBuf,
    existing: Existing,
    part: NamedTempFile,
}

impl Draft {
    /// Begins one that is to become `target`. It has the rights of any new file, not those of a secret.
    ///
    /// # Errors
    /// As [`check`]; or the folder cannot be written.
    pub fn begin(target: &Path, existing: Existing) -> Result<Self, FileError> {
        check(target, existing)?;
        let part = tempfile::Builder::new()
            .prefix(".whirl-")
            .suffix(".part")
            .make_in(folder(target), |path| File::options().read(true).write(true).create_new(true).open(path))
            .map_err(|error| FileError::unfit(target, error))?;
        Ok(Self { target: target.to_owned(), existing, part })
    }

    /// Gives it its name, once it is on disk.
    ///
    /// # Errors
    /// It cannot be written, or something has got the name meanwhile.
    pub fn finish(self) -> Result<(), FileError> {
        let Self { target, existing, part } = self;
        part.as_file().sync_all().map_err(|error| FileError::failed(&target, error))?;
        let named = match existing {
            Existing::Keep => part.persist_noclobber(&target),
            Existing::Replace => part.persist(&target),
        };
        named.map(drop).map_err(|failed| FileError::failed(&target, failed.error))
    }

    /// The file that it is to become.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.part.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.part.flush()
    }
}

/// Writes a file that is all there already.
///
/// # Errors
/// As [`Draft`].
pub fn write(path: &Path, content: &[u8], existing: Existing) -> Result<(), FileError> {
    let mut draft = Draft::begin(path, existing)?;
    draft.write_all(content).map_err(|error| FileError::failed(path, error))?;
    draft.finish()
}

/// Makes a file that has its name from the beginning.
///
/// # Errors
/// It is there and is to be kept, or it cannot be made.
pub fn make(path: &Path, existing: Existing) -> io::Result<File> {
    if existing == Existing::Replace && path.symlink_metadata().is_ok_and(|found| !found.is_dir()) {
        std::fs::remove_file(path)?;
    }
    OpenOptions::new().write(true).create_new(true).open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(path: &Path) -> String {
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn what_is_there_is_kept_unless_it_is_to_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, b"old", Existing::Keep).unwrap();
        let refused = write(&path, b"new", Existing::Keep).unwrap_err();
        assert!(refused.is_usage() && refused.to_string().contains("is already there"), "{refused}");
        assert!(matches!(check(&path, Existing::Keep), Err(FileError::Exists(_))));
        assert!(make(&path, Existing::Keep).is_err() && read(&path) == "old");
        check(&path, Existing::Replace).unwrap();
        write(&path, b"new", Existing::Replace).unwrap();
        assert_eq!(read(&path), "new");
        make(&path, Existing::Replace).unwrap();
        assert_eq!((read(&path).as_str(), std::fs::read_dir(folder.path()).unwrap().count()), ("", 1));
        // A link that leads nowhere has its name all the same.
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        assert!(matches!(write(&link, b"", Existing::Keep), Err(FileError::Exists(_))));
    }

    #[test]
    fn a_name_that_somebody_took_meanwhile_is_not_taken_from_him() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut draft = Draft::begin(&path, Existing::Keep).unwrap();
        draft.write_all(b"ours").unwrap();
        assert!(!path.exists(), "not before it is whole");
        std::fs::write(&path, "theirs").unwrap();
        assert!(matches!(draft.finish(), Err(FileError::Exists(_))));
        assert_eq!((read(&path).as_str(), std::fs::read_dir(folder.path()).unwrap().count()), ("theirs", 1));
    }

    #[test]
    fn what_is_no_place_for_a_file_is_said_first() {
        let folder = tempfile::tempdir().unwrap();
        let told = |path: &Path| check(path, Existing::Replace).unwrap_err().to_string();
        assert!(told(folder.path()).ends_with("is a directory: expected a file to write"));
        assert!(told(Path::new("/")).contains("expected a file to write"));
        assert!(told(Path::new("/dev/null")).contains("is no regular file"));
        assert!(told(&folder.path().join("none/a")).contains("No such file or directory"));
        let file = folder.path().join("file");
        write(&file, b"", Existing::Keep).unwrap();
        assert!(told(&file.join("a")).starts_with("cannot write"));
    }
}
