//! The documents of the repository, for the tests that keep them true.

use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the repository.
///
/// # Panics
/// If this package stands outside of it.
#[must_use]
pub fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests stand in the repository").to_owned()
}

/// The text of a document, by its path from there.
///
/// # Panics
/// If it is not there.
#[must_use]
pub fn paper(path: &str) -> String {
    fs::read_to_string(top().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}
