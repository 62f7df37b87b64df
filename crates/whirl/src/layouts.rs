//! The layouts that a dashboard can show: the built-in ones, and a person's own, which come after them or in their place.

use std::fs;
use std::path::PathBuf;

use dashboard::Layout;

use crate::catalog::{self, FileError};
use crate::failure::Failure;
use crate::folders;

/// A layout and where it comes from.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// What is to be shown.
    pub(crate) layout: Layout,
    /// Its file, if it is not built in.
    pub(crate) file: Option<PathBuf>,
    /// The text of its file.
    pub(crate) text: String,
}

/// The folder of a person's own layouts.
pub(crate) fn folder() -> Option<PathBuf> {
    folders::config().map(|folder| folder.join("layouts"))
}

/// Every layout, the built-in ones first: the digits of the dashboard count them.
///
/// # Errors
/// A file of the person's own that is wrong, or a folder that cannot be read.
pub(crate) fn all() -> Result<Vec<Source>, Failure> {
    let built_in = dashboard::built_in_layouts().into_iter().zip(dashboard::LAYOUTS);
    let mut all: Vec<Source> =
        built_in.map(|(layout, (_, text))| Source { layout, file: None, text: text.to_owned() }).collect();
    for file in own_files()? {
        let own = read(&file)?;
        match all.iter_mut().find(|other| other.layout.name() == own.layout.name()) {
            Some(other) => *other = own,
            None => all.push(own),
        }
    }
    Ok(all)
}

/// The layout in a file; its name is the file's stem.
///
/// # Errors
/// It cannot be read, or is wrong.
pub(crate) fn read(file: &std::path::Path) -> Result<Source, Failure> {
    let path = file.to_string_lossy();
    let text = catalog::text(&path)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let layout = Layout::read(&name, &text).map_err(|faults| FileError::wrong(&path, &text, faults))?;
    Ok(Source { layout, file: Some(file.to_owned()), text })
}

/// All layouts, and which of them `wanted` means: a name, or a file, which then is one more.
///
/// # Errors
/// No such layout, or a file that is wrong.
pub(crate) fn choose(wanted: Option<&str>) -> Result<(Vec<Layout>, usize), Failure> {
    let mut all = all()?;
    let at = match wanted {
        None => 0,
        Some(name) => match all.iter().position(|source| source.layout.name() == name) {
            Some(at) => at,
            None if name.ends_with(".toml") || name.contains(std::path::is_separator) => {
                all.push(read(name.as_ref())?);
                all.len() - 1
            }
            None => return Err(unknown(name, &all)),
        },
    };
    Ok((all.into_iter().map(|source| source.layout).collect(), at))
}

/// There is no layout called `name`.
pub(crate) fn unknown(name: &str, all: &[Source]) -> Failure {
    let names: Vec<&str> = all.iter().map(|source| source.layout.name()).collect();
    let meant = text::meant(name, &names);
    Failure::Usage(format!("no layout '{name}': {meant}expected one of {}, or a .toml file", names.join(", ")))
}

/// The files of the person's own layouts, by name.
fn own_files() -> Result<Vec<PathBuf>, Failure> {
    let Some(folder) = folder() else { return Ok(Vec::new()) };
    let failed = |error: std::io::Error| Failure::Usage(format!("{}: {error}: expected a folder", folder.display()));
    let entries = match fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(failed(error)),
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
