//! `whirl export`: a recording as a table.

use std::ops::ControlFlow;
use std::path::PathBuf;

use files::FileError;
use study::table::{ColumnKind, Form, FormError, Table};
use tape::{Damage, Recording};
use units::Dimension;
use wire::Step;

use crate::failure::Failure;
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};
use crate::units::CommandUnits;
use crate::{interrupt, output};

/// Options of `whirl export`.
#[derive(Debug, clap::Args)]
pub(crate) struct ExportArgs {
    /// The recording: any part of a split one stands for all; of several files, those alone
    #[arg(value_name = "FILE.rrd", required = true)]
    files: Vec<PathBuf>,
    /// Write FILE.csv beside it
    #[arg(long, group = "written", required_unless_present_any = ["parquet", "out"])]
    csv: bool,
    /// Write FILE.parquet beside it
    #[arg(long, group = "written", conflicts_with = "csv")]
    parquet: bool,
    /// Write this file instead: .csv or .parquet
    #[arg(long, value_name = "FILE", group = "written", conflicts_with_all = ["csv", "parquet"])]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Steps from this tau on (of an SI rotor also 2s or 50ms); after a restart tau begins at 0 again, and each stretch has its share
    #[arg(long, value_name = "TAU", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time))]
    from: Option<TypedQuantity>,
    /// Steps up to this tau
    #[arg(long, value_name = "TAU", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time))]
    to: Option<TypedQuantity>,
    /// Steps whose number is a multiple of N
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Print one JSON document about what was written, and where the recording is damaged
    #[arg(long)]
    json: bool,
}

/// What was written, and what there was nothing to write of.
#[derive(Debug, serde::Serialize)]
struct Written<'a> {
    /// The table.
    out: String,
    /// Its rows.
    rows: u64,
    /// Whether all that is on file has checksums; without them a changed number is not noticed.
    checksums: bool,
    /// Where the recording is not what was written.
    damage: &'a [Damage],
    /// The same and what else a reader should know, in words.
    notices: Vec<String>,
}

/// The columns after those of doubles.
const WHOLES: [(&str, ColumnKind); 4] = [
    ("step", ColumnKind::Long),
    ("wall_ns", ColumnKind::Long),
    ("revision", ColumnKind::Long),
    ("flags", ColumnKind::Int),
];

/// Writes the table, whole or not at all.
///
/// # Errors
/// No recording, no such form in this build, or a place that cannot be written.
pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let usage = |error: FormError| Failure::Usage(error.to_string());
    let Some(file) = args.files.first() else { return Err(Failure::Usage("expected a recording".to_owned())) };
    let (target, form) = match &args.out {
        Some(path) => (path.clone(), Form::of(path).map_err(usage)?),
        None if args.parquet => (file.with_extension("parquet"), Form::Parquet.available().map_err(usage)?),
        None => (file.with_extension("csv"), Form::Csv),
    };
    args.force.check(&target)?;
    let mut recording = Recording::open_row(&args.files)?;
    let units = CommandUnits::with(recording.scales());
    let end = |option: &str, typed: Option<TypedQuantity>, without: f64| {
        typed.map_or(Ok(without), |typed| units.read_dimensionless(option, typed))
    };
    let (from, to) = (end("--from", args.from, f64::NEG_INFINITY)?, end("--to", args.to, f64::INFINITY)?);
    if from.is_nan() || to.is_nan() || from > to {
        return Err(Failure::Usage(format!(
            "from = {from}, to = {to}: expected two times, the first not after the second"
        )));
    }
    let notices = recording.notices();
    for notice in &notices {
        output::warn(&format!("{}: {notice}", file.display()));
    }
    interrupt::end_at_once()?;
    let layout = recording.layout();
    let names: Vec<String> = tape::schema::columns(layout).into_iter().map(|column| column.name).collect();
    let mut table = Table::create(&target, form, &names, &WHOLES, args.force.existing())?;
    let (mut rows, mut failed) = (0_u64, None);
    recording.visit(0..u64::MAX, args.every, |state| {
        if !(from..=to).contains(&state.tau()) {
            return ControlFlow::Continue(());
        }
        rows += 1;
        let wholes = [state.seq(), state.wall_ns(), state.revision(), state.flags().0.into()];
        match table.row(&state.numbers().collect::<Vec<f64>>(), &wholes) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    if let Some(error) = failed {
        return Err(FileError::Failed { path: target, error }.into());
    }
    if rows == 0 {
        return Err(Failure::Usage(nothing(&recording, args)));
    }
    table.finish()?;
    if args.json {
        let (out, checksums) = (target.display().to_string(), recording.has_checksums());
        return output::print_json(&Written { out, rows, checksums, damage: recording.damage(), notices });
    }
    output::print_text(&format!("{}: {rows} steps\n", target.display()))
}

/// Why no step is among those asked for.
fn nothing(recording: &Recording, args: &ExportArgs) -> String {
    let file = recording.path().display();
    let Some(span) = recording.span() else { return format!("'{file}': there are no steps in it") };
    let told = |typed: TypedQuantity| if typed.typed.is_alone() { format!("tau {typed}") } else { typed.to_string() };
    let asked = match (args.from, args.to) {
        (None, None) => return format!("'{file}': no step in it has a number that is a multiple of {}", args.every),
        (Some(from), None) => format!("from {} on", told(from)),
        (None, Some(to)) => format!("up to {}", told(to)),
        (Some(from), Some(to)) => format!("from {} to {to}", told(from)),
    };
    let every = if args.every > 1 { format!(", one in {}", args.every) } else { String::new() };
    let (first, last) = (span.first.tau, span.last.tau);
    format!("'{file}': no step {asked}{every}: it goes from tau {first} to {last}; nothing was written")
}
