//! Gains kept under a name: feedback files in a folder of the person's own, fit for `--feedback FILE` too.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use rotor::file::{read_feedback, write_feedback};
use rotor::{Feedback, Rotor, Settings};
use text::MAX_BYTES;

use crate::damping_verdict::DampingVerdict;
use crate::units::ScreenUnits;
use crate::what_if::WhatIf;

/// Why gains are not kept, taken or deleted.
#[derive(Debug, thiserror::Error)]
pub enum PresetError {
    /// Nowhere to keep them.
    #[error("there is no folder to keep gains in: this user has no home")]
    NoFolder,
    /// What cannot be the name of a file everywhere.
    #[error("'{0}': expected a name of letters, digits, '-', '_' and '.'")]
    Name(String),
    /// None of that name.
    #[error("no gains are kept as '{name}': there are {there}")]
    NotFound {
        /// The name.
        name: String,
        /// Those that there are, in words.
        there: String,
    },
    /// A file that cannot be read, written or deleted.
    #[error("{file}: {what}{source}", file = file.display())]
    File {
        /// Which.
        file: PathBuf,
        /// What could not be done to it, in words with a colon behind them; empty of reading.
        what: &'static str,
        /// Why.
        source: std::io::Error,
    },
    /// A file that is wrong: the first of its faults.
    #[error("{0}")]
    Faulty(String),
}

/// The folder of the presets, if there is one.
#[derive(Clone, Debug, Default)]
pub struct Presets(pub Option<PathBuf>);

impl Presets {
    fn folder(&self) -> Result<&PathBuf, PresetError> {
        self.0.as_ref().ok_or(PresetError::NoFolder)
    }

    fn file(&self, name: &str) -> Result<PathBuf, PresetError> {
        let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
        if name.is_empty() || name.len() > 64 || name.starts_with('.') || !name.chars().all(fits) {
            return Err(PresetError::Name(name.to_owned()));
        }
        Ok(self.folder()?.join(format!("{name}.toml")))
    }

    /// Keeps `feedback` as `name`, in place of what was kept under it. Returns where.
    ///
    /// # Errors
    /// Not a name, or a file that cannot be written.
    pub fn save(&self, name: &str, feedback: &Feedback) -> Result<PathBuf, PresetError> {
        let file = self.file(name)?;
        let failed = |source| PresetError::File { file: file.clone(), what: "cannot be written: ", source };
        fs::create_dir_all(self.folder()?).map_err(failed)?;
        // Beside its place first: an interruption leaves no half of it.
        let draft = file.with_extension(format!("toml.{}", std::process::id()));
        let written = fs::File::create(&draft)
            .and_then(|mut open| open.write_all(write_feedback(feedback).as_bytes()).and_then(|()| open.sync_all()))
            .and_then(|()| fs::rename(&draft, &file));
        if let Err(error) = written {
            let _ = fs::remove_file(&draft);
            return Err(failed(error));
        }
        Ok(file)
    }

    /// Whether something is kept as `name`.
    pub fn has(&self, name: &str) -> bool {
        self.file(name).is_ok_and(|file| file.exists())
    }

    /// Deletes the gains kept as `name`. Returns where they were.
    ///
    /// # Errors
    /// None of that name, or a file that cannot be deleted.
    pub fn delete(&self, name: &str) -> Result<PathBuf, PresetError> {
        let file = self.file(name)?;
        match fs::remove_file(&file) {
            Ok(()) => Ok(file),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(self.not_found(name)),
            Err(source) => Err(PresetError::File { file, what: "cannot be deleted: ", source }),
        }
    }

    /// What is said where nothing is kept as `name`.
    pub fn not_found(&self, name: &str) -> PresetError {
        PresetError::NotFound { name: name.to_owned(), there: self.list() }
    }

    /// The gains kept as `name`.
    ///
    /// # Errors
    /// None of that name, or a file that is wrong.
    pub fn load(&self, name: &str, masses: usize) -> Result<Feedback, PresetError> {
        let file = self.file(name)?;
        let text = match fs::metadata(&file) {
            Ok(data) if data.len() > MAX_BYTES as u64 => Err(std::io::Error::other("too large")),
            _ => fs::read_to_string(&file),
        };
        let text = text.map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => self.not_found(name),
            _ => PresetError::File { file: file.clone(), what: "", source: error },
        })?;
        let read = read_feedback(&text, Some(masses)).map_err(|problems| problems.in_file(&file.display().to_string()));
        read.map_err(|told| PresetError::Faulty(told.lines().next().unwrap_or_default().to_owned()))
    }

    /// The names that are taken, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = self.0.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        let name = |entry: std::io::Result<fs::DirEntry>| {
            let path = entry.ok()?.path();
            let is_preset = path.extension().is_some_and(|extension| extension == "toml");
            is_preset.then(|| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()))?
        };
        let mut names: Vec<String> = entries.into_iter().flatten().filter_map(name).collect();
        names.sort();
        names
    }

    /// What the gains kept as `name` would do under `settings`, in words.
    pub fn describe(&self, name: &str, rotor: &Rotor, settings: &Settings) -> String {
        let Ok(feedback) = self.load(name, rotor.len()) else { return "does not fit".into() };
        let in_force = if feedback == settings.feedback { ", in force" } else { "" };
        match WhatIf::of(rotor, Settings { feedback, ..settings.clone() }) {
            None => "does not fit".into(),
            Some(then) => {
                let word = if then.is_unstable() { DampingVerdict::of(then.min_damping).word() } else { "" };
                let gap = if word.is_empty() { "" } else { " " };
                let speed = ScreenUnits::of_machine(rotor, &settings.feedback).speed_told(settings.speed);
                format!("min damping {:.4}{gap}{word} at {speed}{in_force}", then.min_damping)
            }
        }
    }

    fn list(&self) -> String {
        let names = self.names();
        if names.is_empty() { "none yet".to_owned() } else { names.join(", ") }
    }
}
