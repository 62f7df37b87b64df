//! `whirl rotor import`: a rotor that another program has saved, as a file of ours.

use std::path::Path;

use crate::catalog::{self, FileError};
use crate::failure::Failure;
use crate::output::{self, print_text};

/// Options of `whirl rotor import`.
#[derive(Debug, clap::Args)]
pub(super) struct ImportArgs {
    /// The file that ROSS has saved: TOML or JSON
    #[arg(value_name = "FILE")]
    file: String,
    /// Go on with the mean where the two directions differ; the rotor's name says so, and comments in the file with which numbers
    #[arg(long)]
    average: bool,
    /// What the rotor is called [default: as its file]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
}

pub(super) fn run(args: &ImportArgs) -> Result<(), Failure> {
    let text = catalog::text(&args.file)?;
    let wrong = |faults| FileError::wrong(&args.file, &text, faults);
    let (drawing, notes) = beam::import_ross(&text, args.average).map_err(wrong)?;
    let stem = Path::new(&args.file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut sketch = drawing.into_sketch();
    sketch.name = args.name.clone().unwrap_or(stem);
    let averaged: Vec<&beam::Note> = notes.iter().filter(|note| note.averaged).collect();
    if !averaged.is_empty() {
        sketch.name = averaged_name(sketch.name, &averaged);
    }
    let drawing = beam::Drawing::new(sketch).map_err(|error| Failure::Usage(error.to_string()))?;
    for note in &notes {
        output::warn(&format!("{}: {note}", args.file));
    }
    let mut text = String::new();
    if !averaged.is_empty() {
        text += &format!(
            "# Not the machine of {:?}, which is not the same in every direction: the mean of both was taken.\n",
            args.file
        );
        averaged.iter().for_each(|note| text += &format!("# {note}\n"));
    }
    print_text(&(text + &beam::write(&drawing)))
}

/// What is said behind a rotor's name: of bearings alone, and of other parts.
const SUFFIXES: [&str; 2] = [" (averaged bearings)", " (averaged)"];

/// Whether a rotor's name says that its numbers are means.
pub(super) fn is_averaged(name: &str) -> bool {
    SUFFIXES.iter().any(|suffix| name.ends_with(suffix))
}

/// A rotor's name with the word that its numbers are means, at the cost of the end of a long one: headings show no more of a rotor than
/// its name.
fn averaged_name(mut name: String, averaged: &[&beam::Note]) -> String {
    let are_bearings = averaged.iter().all(|note| !note.element.starts_with("PointMass"));
    let suffix = SUFFIXES[usize::from(!are_bearings)];
    if name.len() <= beam::MAX_NAME {
        name.truncate(name.floor_char_boundary(beam::MAX_NAME - suffix.len()));
    }
    name + suffix
}
