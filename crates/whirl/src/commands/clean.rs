//! `whirl clean`: removes what crashed processes left behind.

use serde::Serialize;

use crate::failure::Failure;
use crate::{attach, output};

/// Options of `whirl clean`.
#[derive(Debug, clap::Args)]
pub(crate) struct CleanArgs {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document {
    dead_processes: usize,
    live_benches: Vec<String>,
}

/// Cleans up, and says what was found.
///
/// # Errors
/// The root cannot be used.
pub(crate) fn run(args: &CleanArgs) -> Result<(), Failure> {
    let carrier = attach::carrier("clean")?;
    let dead_processes = wire::clean(&carrier)?;
    let live_benches = attach::running_under(&carrier)?;
    if args.json {
        return output::print_json(&Document { dead_processes, live_benches });
    }
    let live = if live_benches.is_empty() {
        "no bench is running".into()
    } else {
        format!("running and untouched: {}", live_benches.join(", "))
    };
    output::print_text(&format!("cleared away {dead_processes} dead processes; {live}\n"))
}
