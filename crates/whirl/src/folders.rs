//! Where a person's own files are: the configuration, data and state folders of the desktop conventions.

use std::path::PathBuf;

use directories::ProjectDirs;

fn project() -> Option<ProjectDirs> {
    ProjectDirs::from("", "", "whirl")
}

/// The folder of gains that are kept by name, if this user has a home.
pub(crate) fn presets() -> Option<PathBuf> {
    project().map(|folders| folders.data_dir().join("presets"))
}

/// The file of commands that were typed in dashboards, if this user has a home.
pub(crate) fn commands() -> Option<PathBuf> {
    project().map(|folders| folders.state_dir().unwrap_or_else(|| folders.data_local_dir()).join("commands"))
}

/// The configuration file, if this user has a home.
pub(crate) fn config_file() -> Option<PathBuf> {
    config().map(|folder| folder.join("config.toml"))
}

/// The folder of `config.toml` and `layouts/`, if this user has a home.
pub(crate) fn config() -> Option<PathBuf> {
    project().map(|folders| folders.config_dir().to_owned())
}
