//! `whirl tune`: gains as good as promised, proven where they say so, the same from the same seed; and honest refusals.

mod corners;
mod endings;
mod forms;
mod loops;
mod proven;

use std::path::Path;

use serde_json::Value;

fn number(document: &Value, field: &str) -> f64 {
    document[field].as_f64().unwrap_or_else(|| panic!("{field} in {document}"))
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}
