//! `whirl assign`: feedback that puts the poles where they are wanted, and what each bearing and sensor can reach.

mod reach;
mod wanted;

use std::path::PathBuf;

use rotor::file::{FeedbackDocument, read_feedback, write_feedback};
use rotor::{AssignError, C64, Feedback, Rotor, Settings};
use serde::Serialize;
use units::Dimension;

use super::linear::ComplexDocument;
use crate::catalog;
use crate::failure::Failure;
use crate::output::{Format, print_json, print_text};
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};
use crate::units::{CommandUnits, UnitsDocument};

use wanted::Poles;

/// Options of `whirl assign`. What it prints is a feedback file, for `--feedback`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("task").required(true).args(["poles", "cancel", "table"]))]
pub(crate) struct AssignArgs {
    /// The rotor: jeffcott, three-mass, rig, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    rotor: String,
    /// Wanted poles, two for each mass, per unit of tau = w0 t for any rotor: "re,im;re,im;..."
    #[arg(long, value_name = "POLES", allow_hyphen_values = true, requires = "speed")]
    poles: Option<Poles>,
    /// The cancelling law kc = zeta (R0 - R), which holds the poles of R0 at every speed (one mass)
    #[arg(long)]
    cancel: bool,
    /// Reference speed R0 of the cancelling law (SI rotors: in rpm) [default: 0]
    #[arg(long, value_name = "R0", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    reference: Option<TypedQuantity>,
    /// List how well a bearing or sensor at each mass reaches each mode
    #[arg(long, requires = "speed")]
    table: bool,
    /// Spin speed R = w / w0 (SI rotors: in rpm) at which the poles are assigned or the table is made
    #[arg(long, value_name = "R", allow_negative_numbers = true, conflicts_with = "cancel", value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    /// The mass that carries the control bearing
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..), conflicts_with_all = ["cancel", "table"])]
    bearing: u16,
    /// Write the feedback to a file instead
    #[arg(long, value_name = "FILE", conflicts_with = "table", group = "written")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// Prints or writes what was asked for.
///
/// # Errors
/// A machine that cannot be made, poles that do not fit it, or a mode that the bearing does not move.
pub(crate) fn run(args: &AssignArgs) -> Result<(), Failure> {
    if args.format.csv && !args.table {
        return Err(Failure::Usage("--csv: feedback is no table. --table has one; --json has the feedback too".into()));
    }
    if args.reference.is_some() && !args.cancel {
        return Err(Failure::Usage("--reference is the speed of the cancelling law: expected --cancel with it".into()));
    }
    let rotor = catalog::rotor(&args.rotor)?;
    if args.cancel {
        return cancel(args, &rotor);
    }
    let units = CommandUnits::of(&rotor);
    let mut settings = Settings::new(&rotor, 0.0, catalog::feedback(&rotor, "off")?);
    if let Some(speed) = args.speed {
        units.set(&rotor, &mut settings, "speed".parse()?, speed.typed)?;
    }
    if args.table && !rotor.is_chain() {
        return Err(AssignError::Chain.into());
    }
    if args.table {
        return reach::run(&rotor, &settings.closed_loop(&rotor), args.format);
    }
    let wanted = args.poles.as_ref().map_or(&[][..], |poles| &poles.0);
    let made = rotor::assign_poles(&rotor, settings.speed, usize::from(args.bearing) - 1, wanted)?;
    let mut comment = format!(
        "{} at {}: wanted and achieved poles, per unit of tau\n",
        rotor.name(),
        units.speed_text(settings.speed)
    );
    for (wanted, achieved) in &made.poles {
        comment += &format!("{:+.6} {:+.6} j   off by {:.1e}\n", wanted.re, wanted.im, (wanted - achieved).norm());
    }
    let document = Document {
        speed: Some(settings.speed),
        achieved: Some(made.poles.iter().map(|&(wanted, achieved)| Achieved::of(wanted, achieved)).collect()),
        largest_error: Some(made.error()),
        ..Document::of(&rotor, &made.feedback)
    };
    deliver(args, &rotor, &made.feedback, &comment, &document)
}

fn cancel(args: &AssignArgs, rotor: &Rotor) -> Result<(), Failure> {
    if let Some(typed) = args.reference.filter(|typed| !typed.number().is_finite()) {
        return Err(Failure::Usage(format!("reference = {typed}: expected a finite number")));
    }
    let units = CommandUnits::of(rotor);
    let reference = args.reference.map_or(Ok(0.0), |typed| units.read("--reference", typed))?;
    let feedback = rotor::cancelling(rotor, reference).ok_or_else(|| {
        let (name, masses) = (rotor.name(), rotor.len());
        Failure::Usage(format!("the cancelling law is for one mass, and {name} has {masses}: use --poles"))
    })?;
    let comment = format!("{}: kc = zeta (R0 - R), the poles of {}\n", rotor.name(), units.speed_text(reference));
    let document = Document { reference: Some(reference), ..Document::of(rotor, &feedback) };
    deliver(args, rotor, &feedback, &comment, &document)
}

/// The JSON document of `--poles` and `--cancel`.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<f64>,
    feedback: FeedbackDocument<'a>,
    /// What the closed loop achieves; absent with `--cancel`, which has no list of poles.
    #[serde(skip_serializing_if = "Option::is_none")]
    achieved: Option<Vec<Achieved>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_error: Option<f64>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct Achieved {
    wanted: ComplexDocument,
    achieved: ComplexDocument,
    error: f64,
}

impl Achieved {
    fn of(wanted: C64, achieved: C64) -> Self {
        Self { wanted: wanted.into(), achieved: achieved.into(), error: (wanted - achieved).norm() }
    }
}

impl<'a> Document<'a> {
    fn of(rotor: &'a Rotor, feedback: &'a Feedback) -> Self {
        Self {
            rotor: rotor.name(),
            speed: None,
            reference: None,
            feedback: FeedbackDocument(feedback),
            achieved: None,
            largest_error: None,
            units: CommandUnits::of(rotor).document(),
        }
    }
}

/// Writes the file with `--out`, then prints: the document with `--json`, else the file's text if it was not written.
fn deliver(
    args: &AssignArgs,
    rotor: &Rotor,
    feedback: &Feedback,
    comment: &str,
    document: &Document<'_>,
) -> Result<(), Failure> {
    let mut text: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    text += &write_feedback(feedback);
    // What is printed is meant to be read again: gains that are out of range for any rotor are no answer.
    read_feedback(&text, Some(rotor.len()))
        .map_err(|faults| Failure::Work(format!("such gains cannot be used: {}", faults.in_file("feedback"))))?;
    if let Some(path) = &args.out {
        args.force.write(path, &text)?;
    }
    match (args.format.json, &args.out) {
        (true, _) => print_json(document),
        (false, Some(_)) => Ok(()),
        (false, None) => print_text(&text),
    }
}

impl From<AssignError> for Failure {
    fn from(error: AssignError) -> Self {
        match error {
            AssignError::Chain
            | AssignError::Bearing { .. }
            | AssignError::Count { .. }
            | AssignError::NotFinite(_) => Self::Usage(error.to_string()),
            AssignError::NotControllable { .. } | AssignError::Missed { .. } | AssignError::Poles(_) => {
                Self::Work(error.to_string())
            }
        }
    }
}
