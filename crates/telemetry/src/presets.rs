//! Gains kept under a name: feedback files in a folder of the person's own, fit for `--feedback FILE` too.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use rotor::file::{read_feedback, write_feedback};
use rotor::{Feedback, Rotor, Settings};
use text::MAX_BYTES;

use crate::damping_verdict::DampingVerdict;
use crate::units::Units;
use crate::what_if::WhatIf;

/// The folder of the presets, if there is one.
#[derive(Clone, Debug, Default)]
pub struct Presets(pub Option<PathBuf>);

impl Presets {
    fn folder(&self) -> Result<&PathBuf, String> {
        self.0.as_ref().ok_or_else(|| "there is no folder to keep gains in: this user has no home".to_owned())
    }

    fn file(&self, name: &str) -> Result<PathBuf, String> {
        let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
        if name.is_empty() || name.len() > 64 || name.starts_with('.') || !name.chars().all(fits) {
            return Err(format!("'{name}': expected a name of letters, digits, '-', '_' and '.'"));
        }
        Ok(self.folder()?.join(format!("{name}.toml")))
    }

    /// Keeps `feedback` as `name`, in place of what was kept under it. Returns where.
    ///
    /// # Errors
    /// In words: not a name, or a file that cannot be written.
    pub fn save(&self, name: &str, feedback: &Feedback) -> Result<PathBuf, String> {
        let file = self.file(name)?;
        let failed = |error: std::io::Error| format!("{}: cannot be written: {error}", file.display());
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
    /// In words: none of that name, or a file that cannot be deleted.
    pub fn delete(&self, name: &str) -> Result<PathBuf, String> {
        let file = self.file(name)?;
        match fs::remove_file(&file) {
            Ok(()) => Ok(file),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(self.not_found(name)),
            Err(error) => Err(format!("{}: cannot be deleted: {error}", file.display())),
        }
    }

    /// What is said where nothing is kept as `name`.
    pub fn not_found(&self, name: &str) -> String {
        format!("no gains are kept as '{name}': there are {}", self.list())
    }

    /// The gains kept as `name`.
    ///
    /// # Errors
    /// In words: none of that name, or a file that is wrong.
    pub fn load(&self, name: &str, masses: usize) -> Result<Feedback, String> {
        let file = self.file(name)?;
        let text = match fs::metadata(&file) {
            Ok(data) if data.len() > MAX_BYTES as u64 => Err(std::io::Error::other("too large")),
            _ => fs::read_to_string(&file),
        };
        let text = text.map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => self.not_found(name),
            _ => format!("{}: {error}", file.display()),
        })?;
        let read = read_feedback(&text, Some(masses)).map_err(|problems| problems.in_file(&file.display().to_string()));
        read.map_err(|told| told.lines().next().unwrap_or_default().to_owned())
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
                let speed = Units::of(rotor.scales().copied(), Some(1.0)).speed_told(settings.speed);
                format!("min damping {:.4}{gap}{word} at {speed}{in_force}", then.min_damping)
            }
        }
    }

    fn list(&self) -> String {
        let names = self.names();
        if names.is_empty() { "none yet".to_owned() } else { names.join(", ") }
    }
}
