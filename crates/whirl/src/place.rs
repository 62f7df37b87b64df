//! Where a result goes that is a file: refused before any work is done, and there whole or not at all.

use std::io::{self, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::failure::Failure;

/// Refuses a path that is something else than a file already.
///
/// # Errors
/// It is a directory, a device or a pipe.
pub(crate) fn check(path: &Path) -> Result<(), Failure> {
    let what = match path.metadata() {
        Ok(found) if found.is_dir() => "a directory",
        Ok(found) if !found.is_file() => "no regular file",
        _ if path.file_name().is_none() => "no file name",
        _ => return Ok(()),
    };
    Err(Failure::Usage(format!("'{}' is {what}: expected a file to write", path.display())))
}

/// What it means that a file cannot be made there: the command line names a wrong place.
pub(crate) fn unfit(path: &Path, error: &io::Error) -> Failure {
    Failure::Usage(format!("cannot write '{}': {error}", path.display()))
}

/// Writes a file beside its place and moves it there, so that an interruption leaves no half of it.
///
/// # Errors
/// It is no place for a file, or the disk is full.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(path, text.as_bytes())
}

/// The same for what is no text.
///
/// # Errors
/// As for [`write`].
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    check(path)?;
    let mut file = study::table::beside(path).map_err(|error| unfit(path, &error))?;
    let finished = |mut file: NamedTempFile| {
        file.flush()?;
        file.persist(path).map(drop).map_err(|error| error.error)
    };
    file.write_all(bytes)
        .and_then(|()| finished(file))
        .map_err(|error| Failure::Work(format!("cannot write '{}': {error}", path.display())))
}
