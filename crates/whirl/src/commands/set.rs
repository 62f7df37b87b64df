//! `whirl set`: changes the settings of a running bench, all or nothing, and waits for its answer.

use std::time::Duration;

use serde::Serialize;
use wire::{Answer, Carrier, Change, Commander};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::units::Units;
use crate::{catalog, output};

/// How long the bench may take to answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often a change is tried again when somebody else's change comes between looking and asking.
const TRIES: usize = 5;

/// Options of `whirl set`.
#[derive(Debug, clap::Args)]
pub(crate) struct SetArgs {
    /// What to change: speed, deadband, deadband.2 (mass 2), kd cd kc cc (first signal), kd.2 (second signal), trip,
    /// feedback=NAME or FILE; for an SI rotor speeds are in rpm, lengths in m
    #[arg(required = true, value_name = "KEY=VALUE")]
    assignments: Vec<String>,
    #[command(flatten)]
    bench: BenchArgs,
    /// Why, for the log of events: `whirl tail --events` shows it
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    why: String,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The JSON document.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Document {
    Accepted { accepted: bool, revision: u64, applied_at_step: u64 },
    Refused { accepted: bool, reason: String },
}

/// Makes the change.
///
/// # Errors
/// A wrong key or value, no such bench, or a refusal.
pub(crate) fn run(args: &SetArgs) -> Result<(), Failure> {
    match change(args) {
        Ok(answer) => {
            let Answer { revision, applied_at_step, .. } = answer;
            if args.json {
                return output::print_json(&Document::Accepted { accepted: true, revision, applied_at_step });
            }
            output::print_text(&format!("revision {revision} from step {applied_at_step}\n"))
        }
        // What is wrong with a change is a refusal, whoever notices it: the bench, or we before asking it.
        Err(Failure::Usage(reason) | Failure::Work(reason)) => {
            if args.json {
                output::print_json(&Document::Refused { accepted: false, reason: reason.clone() })?;
            }
            Err(Failure::Work(format!("not changed: {reason}")))
        }
        Err(failure) => Err(failure),
    }
}

fn change(args: &SetArgs) -> Result<Answer, Failure> {
    let bench = args.bench.name()?;
    let carrier = attach::carrier("set")?;
    let mut listener = attach::listen(&carrier, &bench)?;
    let mut commander = carrier.command(&bench)?;
    let who = format!("set:{}", std::process::id());
    let mut outdated = None;
    for _ in 0..TRIES {
        let bulletin = attach::first_bulletin(&mut listener, &bench)?;
        let rotor = bulletin.rotor().map_err(|error| Failure::Work(error.to_string()))?;
        let units = Units::with(bulletin.scales());
        let mut settings = bulletin.settings.unpack();
        for assignment in &args.assignments {
            catalog::assign(&rotor, units, &mut settings, assignment)?;
        }
        settings.check(&rotor)?;
        let request = Change::Settings { base_revision: bulletin.revision, settings }.request(&who, &args.why)?;
        let answer = commander.ask(&request, PATIENCE)?;
        if answer.is_accepted() {
            return Ok(answer);
        }
        if answer.outdated == 0 {
            return Err(Failure::Work(answer.reason.as_str().to_owned()));
        }
        outdated = Some(answer);
    }
    Err(Failure::Work(outdated.map_or_else(String::new, |answer| answer.reason.as_str().to_owned())))
}
