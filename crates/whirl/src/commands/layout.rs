//! `whirl layout`: the layouts of the dashboard, any of them as a file, and what is wrong with files.

use std::path::Path;

use serde::Serialize;

use crate::failure::Failure;
use crate::layouts;
use crate::output::{Cell, Format, Table, print_text};

/// Options of `whirl layout`.
#[derive(Debug, clap::Args)]
pub(crate) struct LayoutArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List the layouts: built in, and yours
    List(#[command(flatten)] Format),
    /// List the panels that a layout can have
    Panels(#[command(flatten)] Format),
    /// Print a layout as the TOML of its file
    Show {
        /// Its name
        #[arg(value_name = "NAME")]
        name: String,
    },
    /// Say what is wrong with layout files
    Check {
        /// Layout files
        #[arg(value_name = "FILE", required = true)]
        files: Vec<String>,
    },
}

/// Carries out `whirl layout list`, `panels`, `show` or `check`.
///
/// # Errors
/// A layout that is not there or wrong, or output that cannot be written.
pub(crate) fn run(args: &LayoutArgs) -> Result<(), Failure> {
    match &args.action {
        Action::List(format) => list(*format),
        Action::Panels(format) => panels(*format),
        Action::Show { name } => show(name),
        Action::Check { files } => check(files),
    }
}

/// A size as people write it.
fn written((width, height): (u16, u16)) -> String {
    format!("{width} x {height}")
}

fn list(format: Format) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Listed {
        name: String,
        about: String,
        from: String,
        smallest: Vec<(u16, u16)>,
    }
    #[derive(Serialize)]
    struct Document {
        layouts: Vec<Listed>,
    }
    let listed = |source: layouts::Source| Listed {
        name: source.layout.name().to_owned(),
        about: source.layout.about().to_owned(),
        from: source.file.map_or_else(|| "built in".to_owned(), |file| file.display().to_string()),
        smallest: source.layout.sizes(),
    };
    let layouts: Vec<Listed> = layouts::all()?.into_iter().map(listed).collect();
    let mut table = Table::new(&["key", "name", "from", "screens from", "what it is for"]);
    for (at, Listed { name, about, from, smallest }) in layouts.iter().enumerate() {
        let key = if at < 9 { (at + 1).to_string() } else { String::new() };
        let sizes: Vec<String> = smallest.iter().copied().map(written).collect();
        table.row([&key, name, from, &sizes.join(", "), about].map(Cell::from));
    }
    let folder = layouts::folder().map_or_else(String::new, |folder| format!("Yours: {}/NAME.toml.", folder.display()));
    format.print(
        &Document { layouts },
        "",
        &table,
        &format!("{folder} `whirl layout show NAME` prints one to start from."),
    )
}

fn panels(format: Format) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Listed {
        name: &'static str,
        smallest: (u16, u16),
        meaning: &'static str,
    }
    #[derive(Serialize)]
    struct Document {
        panels: Vec<Listed>,
    }
    let panels: Vec<Listed> =
        dashboard::panels().map(|(name, meaning, smallest)| Listed { name, smallest, meaning }).collect();
    let mut table = Table::new(&["name", "smallest", "what it shows"]);
    for Listed { name, smallest, meaning } in &panels {
        table.row([Cell::from(name), Cell::from(&written(*smallest)), Cell::from(meaning)]);
    }
    format.print(&Document { panels }, "", &table, "")
}

fn show(name: &str) -> Result<(), Failure> {
    let all = layouts::all()?;
    let found = all.iter().find(|source| source.layout.name() == name);
    print_text(&found.ok_or_else(|| layouts::unknown(name, &all))?.text)
}

fn check(files: &[String]) -> Result<(), Failure> {
    let mut wrong = Vec::new();
    let mut fine = String::new();
    for file in files {
        match layouts::read(Path::new(file)) {
            Ok(source) => {
                let sizes: Vec<String> = source.layout.sizes().into_iter().map(written).collect();
                fine += &format!("{file}: ok, screens from {}\n", sizes.join(", "));
            }
            Err(failure) => wrong.push(failure.to_string()),
        }
    }
    print_text(&fine)?;
    if wrong.is_empty() { Ok(()) } else { Err(Failure::Usage(wrong.join("\n"))) }
}
