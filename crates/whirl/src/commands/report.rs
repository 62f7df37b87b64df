//! `whirl report`: the NASA report again, every figure and every printed number beside ours.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use study::report::{self, Comparison, Onlooker, ReportError, Verdict, write};

use crate::failure::Failure;
use crate::interrupt;
use crate::output::{Cell, Format, Table};
use crate::place::Force;

/// Options of `whirl report`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("where").required(true).multiple(true).args(["out", "page"]))]
#[command(group = clap::ArgGroup::new("written").multiple(true).args(["out", "page"]))]
pub(crate) struct ReportArgs {
    /// Write page, figures and data into this folder; files of other names in it are left alone
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the page alone, as Markdown without pictures
    #[arg(long, value_name = "FILE.md")]
    page: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    out: Option<&'a Path>,
    page: Option<&'a Path>,
    /// How many files were written.
    files: usize,
    figures: Vec<FigureDocument>,
    numbers: Vec<NumberDocument>,
}

#[derive(Debug, Serialize)]
struct FigureDocument {
    number: &'static str,
    title: &'static str,
    /// Name of its files without folder and ending.
    stem: String,
}

/// One row of the comparison; `ours` is a number where the report prints one, else what was found.
#[derive(Debug, Serialize)]
struct NumberDocument {
    chapter: u8,
    quantity: &'static str,
    place: &'static str,
    report: &'static str,
    ours: Option<f64>,
    found: String,
    difference: Option<f64>,
    relative: Option<f64>,
    agreement: Verdict,
    note: &'static str,
}

/// Makes it, writes it, and prints the comparison.
///
/// # Errors
/// A folder that cannot be made, a file that cannot be written, an interrupt.
pub(crate) fn run(args: &ReportArgs) -> Result<(), Failure> {
    let stop = interrupt::flag()?;
    check(args)?;
    let drawn = if args.out.is_some() { report::steps_of_files() } else { 0 };
    let bar = bar(report::steps() + drawn);
    let done = || bar.inc(1);
    let onlooker = Onlooker { stop: &stop, done: &done };

    let made = report::make(&onlooker)?;
    let mut files = 0;
    if let Some(out) = &args.out {
        files += write::folder(&made, out, args.force.existing(), &onlooker)?;
    }
    if let Some(page) = &args.page {
        write::page(&made, page, args.force.existing())?;
        files += 1;
    }
    bar.finish_and_clear();

    let mut table = Table::new(&["quantity", "where", "report", "ours", "difference", "agreement"]);
    for c in &made.comparisons {
        let words = [c.our_words(), c.difference_words().0];
        let [ours, difference] = words.each_ref().map(Cell::from);
        let agreement = Cell::from(&c.verdict().words());
        table.row([
            Cell::from(&c.quantity),
            Cell::from(&c.place),
            Cell::from(&c.printed_words()),
            ours,
            difference,
            agreement,
        ]);
    }
    let document = Document {
        out: args.out.as_deref(),
        page: args.page.as_deref(),
        files,
        figures: made
            .figures
            .iter()
            .map(|f| FigureDocument { number: f.number, title: f.title, stem: f.stem() })
            .collect(),
        numbers: made.comparisons.iter().map(number).collect(),
    };
    let written = match (&args.out, &args.page) {
        (Some(out), _) => format!("{files} files; start with {}", out.join("index.html").display()),
        (None, Some(page)) => format!("written to {}", page.display()),
        (None, None) => String::new(),
    };
    args.format.print(&document, "The NASA report's numbers beside ours", &table, &written)
}

/// What can be told to be wrong before anything is computed.
fn check(args: &ReportArgs) -> Result<(), Failure> {
    if let Some(out) = &args.out {
        std::fs::create_dir_all(out).map_err(|error| {
            Failure::Usage(format!("--out '{}': this folder cannot be made: {error}", out.display()))
        })?;
        write::check_folder(out, args.force.existing())?;
    }
    if let Some(page) = &args.page {
        if page.is_dir() {
            return Err(Failure::Usage(format!("--page '{}' is a directory: expected a file name", page.display())));
        }
        let folder = page.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Failure::Usage(format!("--page: there is no folder '{}'", folder.display())));
        }
        args.force.check(page)?;
    }
    Ok(())
}

/// A bar on stderr, if that is a terminal.
fn bar(steps: usize) -> ProgressBar {
    let target =
        if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(steps as u64), target);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos} of {len}, {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

fn number(c: &Comparison) -> NumberDocument {
    let ours = c.ours.number().map(|(value, _)| value).filter(|v| v.is_finite());
    let (difference, relative) = c.difference().unzip();
    NumberDocument {
        chapter: c.chapter,
        quantity: c.quantity,
        place: c.place,
        report: c.printed_words(),
        ours,
        found: c.our_words(),
        difference,
        relative,
        agreement: c.verdict(),
        note: c.note,
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Interrupted => Self::Interrupted,
            ReportError::File(error) => error.into(),
            other => Self::Work(other.to_string()),
        }
    }
}
