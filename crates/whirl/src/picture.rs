//! Charts that commands write into files: refused before any work is done, drawn in the form that the name asks for.

use std::path::Path;

use plot::{Chart, png, stacked, svg};

use crate::failure::Failure;
use crate::place::Force;

/// Whether `path` ends as a picture does.
#[must_use]
pub(crate) fn is_picture(path: &Path) -> bool {
    matches!(path.extension().and_then(|end| end.to_str()), Some("svg" | "png"))
}

/// Refuses a picture of unknown kind, or one that is there.
///
/// # Errors
/// The same, in words.
pub(crate) fn check(path: &Path, force: Force) -> Result<(), Failure> {
    if is_picture(path) {
        return force.check(path);
    }
    Err(Failure::Usage(format!("'{}': expected a picture that ends in .svg or .png", path.display())))
}

/// Columns and rows of a chart where nobody says how large the terminal is.
const UNKNOWN: (usize, usize) = (100, 24);
/// Rows of one chart are no more than this: a screen has room for words too.
const MOST_ROWS: usize = 28;

/// Charts as text, one below the other, as wide as the terminal.
#[must_use]
pub(crate) fn in_terminal(charts: &[Chart]) -> String {
    // Where there is no terminal, what the environment says of one.
    let said = std::env::var("COLUMNS").ok().and_then(|typed| typed.parse().ok());
    let (columns, rows) = terminal_size::terminal_size()
        .map_or((said.unwrap_or(UNKNOWN.0), UNKNOWN.1), |(width, height)| {
            (usize::from(width.0), usize::from(height.0).saturating_sub(4))
        });
    let each = (rows / charts.len().max(1)).clamp(12, MOST_ROWS);
    let drawn = charts.iter().filter_map(|chart| chart.text(columns, each));
    let text: String = drawn.collect();
    if text.is_empty() { "(the terminal is too small for a chart)\n".to_owned() } else { text }
}

/// Draws charts, one above the other, into a file that ends in `.svg` or `.png`.
///
/// # Errors
/// The file cannot be written, or the picture not drawn.
pub(crate) fn draw(path: &Path, force: Force, charts: &[Chart]) -> Result<(), Failure> {
    let picture = svg(&stacked(charts), "chart", charts.first().map_or("", |chart| &chart.title));
    if path.extension().is_some_and(|end| end == "png") {
        let bytes =
            png(&picture).map_err(|error| Failure::Work(format!("cannot draw '{}': {error}", path.display())))?;
        return force.write(path, bytes);
    }
    force.write(path, picture)
}
