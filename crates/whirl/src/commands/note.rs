//! `whirl note`: marks the present step of a running bench, for the log of events and for recordings.

use std::time::Duration;

use serde::Serialize;
use wire::{Change, Commander};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::output;

/// How long the bench may take to answer.
const PATIENCE: Duration = Duration::from_secs(5);

/// Options of `whirl note`.
#[derive(Debug, clap::Args)]
pub(crate) struct NoteArgs {
    /// What the note says, in one line; several words need no quotes
    #[arg(required = true, value_name = "TEXT")]
    words: Vec<String>,
    #[command(flatten)]
    bench: BenchArgs,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document {
    seq: u64,
    tau: f64,
}

/// Makes the note, and says at which step and time it stands.
///
/// # Errors
/// A note that is too long or says nothing, no such bench, or one that does not answer.
pub(crate) fn run(args: &NoteArgs) -> Result<(), Failure> {
    let text = args.words.join(" ");
    let note = Change::Note { text: text.trim().to_owned() };
    let request =
        note.request(&format!("note:{}", std::process::id()), "").map_err(|e| Failure::Usage(e.to_string()))?;
    let bench = args.bench.name()?;
    let carrier = attach::carrier("note")?;
    // One that is just starting is waited for, as everywhere.
    let answer = attach::command(&carrier, &bench)?.ask(&request, PATIENCE)?;
    if !answer.is_accepted() {
        return Err(Failure::Work(format!("not noted: {}", answer.reason.as_str())));
    }
    let document = Document { seq: answer.applied_at_step, tau: answer.tau };
    if args.json {
        return output::print_json(&document);
    }
    output::print_text(&format!("noted at step {}, tau {:.3}\n", document.seq, document.tau))
}
