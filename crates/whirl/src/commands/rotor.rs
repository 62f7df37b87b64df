//! `whirl rotor`: the built-in rotors, any rotor as a file, and what is wrong with files.

mod import;
mod reduce;

use import::ImportArgs;
use reduce::ReduceArgs;
use rotor::file::{FeedbackDocument, Kind, kind_of, write_feedback_for, write_rotor};
use rotor::{Feedback, Mass, Physical, Rotor, builtin};
use serde::Serialize;
use text::Fault;
use text::number::counted;

use crate::catalog::{self, FileError};
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, print_json, print_text, rounded};
use crate::units::{CommandUnits, UnitsDocument};

/// Options of `whirl rotor`.
#[derive(Debug, clap::Args)]
pub(crate) struct RotorArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List the built-in rotors
    List(#[command(flatten)] Format),
    /// Print a rotor, or feedback for it, as the TOML of its file
    Show(ShowArgs),
    /// Say what is wrong with rotor and feedback files
    Check(CheckArgs),
    /// Print a rotor that another program has saved (ROSS: TOML or JSON) as the TOML of its file
    Import(ImportArgs),
    /// Say what a rotor of shaft elements loses by the coordinates that it is stepped in
    Reduce(ReduceArgs),
}

#[derive(Debug, clap::Args)]
struct ShowArgs {
    /// The rotor: jeffcott, three-mass, rig, or a TOML file
    #[arg(value_name = "ROTOR")]
    rotor: String,
    /// Print this feedback for the rotor instead
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "dimensionless")]
    feedback: Option<String>,
    /// Print an SI rotor in dimensionless form
    #[arg(long)]
    dimensionless: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Args)]
struct CheckArgs {
    /// Rotor or feedback files
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Take every file for feedback, whatever is in it
    #[arg(long)]
    feedback: bool,
    /// Check feedback files against this rotor
    #[arg(long = "for", value_name = "ROTOR")]
    rotor: Option<String>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// Carries out `whirl rotor list`, `show`, `check`, `import` or `reduce`.
///
/// # Errors
/// A rotor or a file that is wrong, or output that cannot be written.
pub(crate) fn run(args: &RotorArgs) -> Result<(), Failure> {
    match &args.action {
        Action::List(format) => list(*format),
        Action::Show(args) => show(args),
        Action::Check(args) => check(args),
        Action::Import(args) => import::run(args),
        Action::Reduce(args) => reduce::run(args),
    }
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    masses: usize,
    feedback: &'static [&'static str],
    about: &'static str,
}

fn list(format: Format) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Document {
        rotors: Vec<Listed>,
    }
    let listed = |name: &'static str| {
        let rotor = builtin::rotor(name)?;
        let feedback = builtin::feedback_names(&rotor);
        Some(Listed { name, masses: rotor.len(), feedback, about: builtin::about(name) })
    };
    let rotors: Vec<_> = builtin::ROTORS.into_iter().filter_map(listed).collect();
    let mut table = Table::new(&["name", "masses", "feedback", "what it is"]);
    for Listed { name, masses, feedback, about } in &rotors {
        table.row([Cell::from(name), Cell::from(masses), Cell::from(&feedback.join(", ")), Cell::from(about)]);
    }
    format.print(
        &Document { rotors },
        "",
        &table,
        "Any other rotor: a TOML file. `whirl rotor show NAME` prints one to start from.",
    )
}

/// A rotor for scripts: its dimensionless values, and for an SI rotor the numbers it was made of.
#[derive(Serialize)]
struct RotorDocument<'a> {
    name: &'a str,
    masses: &'a [Mass],
    shafts: &'a [f64],
    feedback: &'static [&'static str],
    #[serde(flatten)]
    units: UnitsDocument,
    #[serde(skip_serializing_if = "Option::is_none")]
    physical: Option<&'a Physical>,
}

fn show(args: &ShowArgs) -> Result<(), Failure> {
    let mut rotor = catalog::rotor(&args.rotor)?;
    if args.dimensionless {
        rotor = rotor.dimensionless();
    }
    if let Some(name) = &args.feedback {
        let feedback = catalog::feedback(&rotor, name)?;
        return match args.json {
            true => print_json(&FeedbackDocument(&feedback)),
            false => print_text(&write_feedback_for(&feedback, &rotor)),
        };
    }
    if !args.json {
        return print_text(&write_rotor(&rotor));
    }
    print_json(&RotorDocument {
        name: rotor.name(),
        masses: rotor.masses(),
        shafts: rotor.shafts(),
        feedback: builtin::feedback_names(&rotor),
        units: CommandUnits::of(&rotor).document(),
        physical: rotor.physical(),
    })
}

/// What was found in one file.
#[derive(Serialize)]
struct Checked<'a> {
    file: &'a str,
    ok: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<Kind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    masses: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signals: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unreadable: Option<String>,
    problems: Vec<Fault>,
}

enum Content {
    Rotor(Rotor),
    Feedback(Feedback),
}

fn check(args: &CheckArgs) -> Result<(), Failure> {
    let rotor = args.rotor.as_deref().map(catalog::rotor).transpose()?;
    let read = |file: &str| -> (Option<Kind>, Result<Content, FileError>) {
        let text = match catalog::text(file) {
            Ok(text) => text,
            Err(error) => return (None, Err(error)),
        };
        let kind = if args.feedback { Kind::Feedback } else { kind_of(&text) };
        let content = match kind {
            Kind::Rotor => catalog::rotor_of(file, &text).map(Content::Rotor),
            Kind::Feedback => catalog::feedback_of(file, &text, rotor.as_ref()).map(Content::Feedback),
        };
        (Some(kind), content)
    };
    let (mut fine, mut wrong, mut documents) = (String::new(), Vec::new(), Vec::new());
    for file in &args.files {
        let (kind, content) = read(file);
        let mut document = Checked {
            file,
            ok: content.is_ok(),
            kind,
            name: None,
            masses: None,
            signals: None,
            unreadable: None,
            problems: Vec::new(),
        };
        match content {
            Ok(content) => {
                fine += &format!("{file}: ok, {}\n", describe(&content));
                match content {
                    Content::Rotor(rotor) => {
                        document.name = Some(rotor.name().to_owned());
                        document.masses = Some(rotor.len());
                    }
                    Content::Feedback(feedback) => document.signals = Some(feedback.signal_count()),
                }
            }
            Err(error) => {
                wrong.push(error.told());
                match error {
                    FileError::Unreadable { found, .. } => document.unreadable = Some(found),
                    FileError::Wrong { faults, .. } => document.problems = faults.list().to_vec(),
                }
            }
        }
        documents.push(document);
    }
    let is_for_nothing = documents.iter().all(|document| document.kind == Some(Kind::Rotor));
    if args.json {
        #[derive(Serialize)]
        struct Document<'a> {
            files: Vec<Checked<'a>>,
        }
        print_json(&Document { files: documents })?;
    } else {
        print_text(&fine)?;
    }
    if let (Some(rotor), true) = (&args.rotor, is_for_nothing) {
        wrong.push(format!("--for {rotor}: there is no feedback among these files to hold against it"));
    }
    if wrong.is_empty() { Ok(()) } else { Err(Failure::Usage(wrong.join("\n"))) }
}

/// What a sound file holds, in a few words.
fn describe(content: &Content) -> String {
    match content {
        Content::Rotor(rotor) => {
            let masses = counted(rotor.len(), "mass", "masses");
            let units = rotor.scales().map_or_else(
                || "dimensionless".to_owned(),
                |scales| format!("SI, w0 = {} rad/s = {} rpm", rounded(scales.w0), rounded(scales.rpm(1.0))),
            );
            // A grade is an unbalance for a speed only.
            let is_open = |of: &beam::Unbalance| matches!(of.amount, beam::Amount::Grade { speed: None, .. });
            let is_graded = rotor.beam().is_some_and(|beam| beam.drawing().unbalances.iter().any(is_open));
            let grade = if is_graded { ", the speed that a grade without one is for" } else { "" };
            let averaged = if import::is_averaged(rotor.name()) { ", averaged from unequal directions" } else { "" };
            format!("{masses}, {units}{grade}{averaged}")
        }
        Content::Feedback(feedback) => {
            let signals = counted(feedback.signal_count(), "signal", "signals");
            let masses: Vec<String> =
                feedback.bearings.iter().map(|bearing| (bearing.station + 1).to_string()).collect();
            let at = if masses.len() == 1 { "bearing at mass" } else { "bearings at masses" };
            format!("feedback, {signals}, {at} {}", masses.join(", "))
        }
    }
}
