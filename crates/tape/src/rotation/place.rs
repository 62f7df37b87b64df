//! Where a recording is to be.

use std::path::Path;

use files::Existing;
use wire::Keeping;

use super::Keep;
use crate::error::TapeError;
use crate::file_series;

/// Whether `path` can become a recording, and its parts those of it.
pub(super) fn check(path: &Path, keep: &Keep) -> Result<(), TapeError> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("rrd")) {
        return Err(TapeError::place(path, "expected a file name that ends in .rrd"));
    }
    if path.is_dir() {
        return Err(TapeError::place(path, "is a directory: expected a file to write"));
    }
    if keep.existing == Existing::Keep {
        let has_parts = keep.split.is_some() || keep.keeping != Keeping::All;
        let in_the_way = if has_parts { file_series::parts_of(path) } else { Vec::new() };
        if path.symlink_metadata().is_ok() {
            return Err(TapeError::taken(path));
        }
        if let Some(part) = in_the_way.first() {
            return Err(TapeError::taken(part));
        }
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

/// Lets go of a file that is to be replaced.
pub(super) fn clear(path: &Path, existing: Existing) -> Result<(), TapeError> {
    if existing == Existing::Replace && path.symlink_metadata().is_ok_and(|found| !found.is_dir()) {
        std::fs::remove_file(path).map_err(|error| TapeError::unfit(path, &error))?;
    }
    Ok(())
}

/// Bytes free on the disk of a file that is to be.
pub(super) fn free_bytes(path: &Path) -> Option<u64> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail * disk.f_frsize)
}
