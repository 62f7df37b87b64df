//! Where a recording is to be.

use std::path::Path;

use crate::error::TapeError;

/// Whether `path` can become a recording.
pub(super) fn check(path: &Path) -> Result<(), TapeError> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("rrd")) {
        return Err(TapeError::place(path, "expected a file name that ends in .rrd"));
    }
    if path.symlink_metadata().is_ok() {
        return Err(TapeError::place(path, "is already there: choose another name, or remove it first"));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match folder.metadata() {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(TapeError::place(folder, "is no folder")),
        Err(error) => Err(TapeError::place(folder, format!("no folder to record into: {error}"))),
    }
}

pub(super) fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Bytes free on the disk of a file that is to be.
pub(super) fn free_bytes(path: &Path) -> Option<u64> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail * disk.f_frsize)
}
