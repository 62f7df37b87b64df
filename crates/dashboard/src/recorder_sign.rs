//! How a recorder stands, for the line at the top.

use std::time::{SystemTime, UNIX_EPOCH};

use ratatui::style::Style;
use wire::{Keeping, RecorderState, RecorderStatus};

use crate::theme;

/// Silence of a living recorder that is worth a word: it shall speak at least once a second.
const SILENT: u64 = 3_000_000_000;

/// The sign of a recording, and behind it time, size and losses while it runs.
pub(crate) fn of(status: &RecorderStatus) -> Option<(String, String, Style)> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64;
    let told = match status.state() {
        RecorderState::Recording if now.saturating_sub(status.wall_ns) > SILENT => {
            let hangs = format!("● REC hangs for {} s", now.saturating_sub(status.wall_ns) / 1_000_000_000);
            return Some((hangs, String::new(), theme::badge(theme::BAD)));
        }
        RecorderState::Recording => {
            let seconds = status.wall_ns.saturating_sub(status.started_ns) / 1_000_000_000;
            let held = if matches!(status.keeping(), Keeping::Pretrigger(_)) { " armed" } else { "" };
            let (minutes, rest, size) = (seconds / 60, seconds % 60, status.bytes as f64 / 1e6);
            let told = format!("{held} {minutes:02}:{rest:02} {size:.1} MB lost {}", status.lost);
            return Some(("● REC".to_owned(), told, theme::loud(theme::CURSOR)));
        }
        RecorderState::Failed => format!("REC FAILED: {}", status.error.as_str()),
        RecorderState::Died => "REC DIED: what it wrote is there".to_owned(),
        RecorderState::Stopped => return None,
    };
    Some((told, String::new(), theme::loud(theme::BAD)))
}
