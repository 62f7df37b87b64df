//! Command lines that were typed before, in this session and in earlier ones: a bounded file, a line each, the newest last.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

/// Lines kept.
const KEPT: usize = 500;

/// The lines, and which of them is looked at.
#[derive(Debug, Default)]
pub struct CommandHistory {
    file: Option<PathBuf>,
    lines: Vec<String>,
    /// The line that is shown, and what had been typed before one was.
    shown: Option<(usize, String)>,
}

impl CommandHistory {
    /// What was typed in earlier sessions, if a file keeps it.
    pub fn read(file: Option<PathBuf>) -> Self {
        let text = file.as_ref().and_then(|file| fs::read(file).ok()).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let all: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
        let lines: Vec<String> = all[all.len().saturating_sub(KEPT)..].iter().map(|line| (*line).to_owned()).collect();
        // Every session appends; one in a while shortens.
        if all.len() > 2 * KEPT
            && let Some(file) = &file
            && let Err(error) = fs::write(file, lines.join("\n") + "\n")
        {
            tracing::warn!(%error, file = %file.display(), "commands cannot be kept");
        }
        Self { file, lines, shown: None }
    }

    /// A line was typed and is done. What cannot be kept is forgotten with the session.
    pub fn push(&mut self, line: &str) {
        self.shown = None;
        let line = line.trim();
        if line.is_empty() || self.lines.last().is_some_and(|last| last == line) {
            return;
        }
        if self.lines.len() == KEPT {
            self.lines.remove(0);
        }
        self.lines.push(line.to_owned());
        let Some(file) = &self.file else { return };
        let write = || -> std::io::Result<()> {
            if let Some(folder) = file.parent() {
                fs::create_dir_all(folder)?;
            }
            // One write a line: dashboards share the file.
            OpenOptions::new().create(true).append(true).open(file)?.write_all(format!("{line}\n").as_bytes())
        };
        if let Err(error) = write() {
            tracing::warn!(%error, file = %file.display(), "the command cannot be kept");
        }
    }

    /// The typing is given up.
    pub fn stop_browsing(&mut self) {
        self.shown = None;
    }

    /// The line before (-1) or after (1) the one that is shown, of those that begin like what was `typed`; after the
    /// newest comes what was typed. Nothing if there is no other.
    pub fn browse(&mut self, by: isize, typed: &str) -> Option<String> {
        let (at, draft) = self.shown.clone().unwrap_or_else(|| (self.lines.len(), typed.to_owned()));
        let fits = |at: &usize| self.lines[*at].starts_with(&draft) && self.lines[*at] != typed;
        if by < 0 {
            let found = (0..at).rev().find(fits)?;
            self.shown = Some((found, draft));
            return Some(self.lines[found].clone());
        }
        self.shown.as_ref()?;
        match (at + 1..self.lines.len()).find(fits) {
            Some(found) => {
                self.shown = Some((found, draft));
                Some(self.lines[found].clone())
            }
            None => {
                self.shown = None;
                Some(draft)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earlier_lines_that_begin_alike_are_walked_and_the_draft_comes_back() {
        let mut command_history = CommandHistory::default();
        ["speed 3", "note a", "speed 4", "speed 4", " "].iter().for_each(|line| command_history.push(line));
        let mut walk = |by, typed: &str| command_history.browse(by, typed);
        assert_eq!(walk(1, "sp"), None);
        assert_eq!(walk(-1, "sp").as_deref(), Some("speed 4"));
        assert_eq!(walk(-1, "speed 4").as_deref(), Some("speed 3"));
        assert_eq!(walk(-1, "speed 3"), None);
        assert_eq!(walk(1, "speed 3").as_deref(), Some("speed 4"));
        assert_eq!(walk(1, "speed 4").as_deref(), Some("sp"));
        assert_eq!(walk(-1, "").as_deref(), Some("speed 4"));
        command_history.stop_browsing();
        assert_eq!(command_history.browse(-1, "note").as_deref(), Some("note a"));
    }

    #[test]
    fn lines_outlive_the_session_and_are_bounded() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("state/commands");
        let mut command_history = CommandHistory::read(Some(file.clone()));
        for number in 0..3 * KEPT {
            command_history.push(&format!("seek {number}"));
        }
        assert_eq!(command_history.lines.len(), KEPT);
        let mut next = CommandHistory::read(Some(file.clone()));
        assert_eq!(next.browse(-1, "").as_deref(), Some(&*format!("seek {}", 3 * KEPT - 1)));
        assert_eq!(fs::read_to_string(file).unwrap().lines().count(), KEPT, "the file was shortened");
        // Where nothing can be kept, commands work all the same.
        let mut nowhere = CommandHistory::read(Some(folder.path().join("state/commands/none")));
        nowhere.push("undo");
        assert_eq!(nowhere.browse(-1, "").as_deref(), Some("undo"));
    }
}
