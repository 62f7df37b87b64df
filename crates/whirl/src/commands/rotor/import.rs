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
    /// Go on with the mean where the two directions differ
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
    let drawing = beam::Drawing::new(sketch).map_err(|error| Failure::Usage(error.to_string()))?;
    for note in &notes {
        output::warn(&format!("{}: {note}", args.file));
    }
    print_text(&beam::write(&drawing))
}
