//! `whirl sweep`: a map, samples or the starts of a search cut into shards that schedulers run.
//!
//! The document is the command line of a `whirl map`, a `whirl margin .. --samples` or a `whirl tune`: `run = "map three-mass .."` in a TOML file. Its
//! plan names the question by a checksum over that line, the machine that it and its files make, and the version of this program, so that
//! shards of another one are told apart.

mod jobs;

use std::path::{Path, PathBuf};

use clap::Parser;
use rotor::file::write_rotor;
use serde::Serialize;
use study::sweep::{self, MOST_SHARDS, OBJECTIVE, SweepError, Task};
use study::table::Form;
use wire::SettingsDocument;

use crate::catalog::{self, FileError};
use crate::cli::{Cli, Command};
use crate::commands::{map, margin, tune};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{Format, print_json, print_text, rounded};
use crate::place::Force;

/// Options of `whirl sweep`.
#[derive(Debug, clap::Args)]
pub(crate) struct SweepArgs {
    #[command(subcommand)]
    command: SweepCommand,
}

#[derive(Debug, clap::Subcommand)]
enum SweepCommand {
    /// Cut a map, samples or the starts of a search into shards, and write the job files that run them
    Plan(PlanArgs),
    /// Run one shard; one that is there already is left as it is
    Run(RunArgs),
    /// Check that every shard is there, whole and of this plan, and say what they hold
    Gather(GatherArgs),
}

#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("written").args(["file"]))]
struct PlanArgs {
    /// The document: a TOML file with run = "map ..", run = "margin .. --samples N" or run = "tune .. --starts N"
    #[arg(value_name = "FILE")]
    file: String,
    /// Into how many shards
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MOST_SHARDS))]
    shards: u64,
    /// The folder for plan and shards
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Write array.sh, a job array for Slurm: sbatch array.sh
    #[arg(long)]
    slurm: bool,
    /// Write job.yaml, an indexed job for Kubernetes
    #[arg(long)]
    kubernetes: bool,
    #[command(flatten)]
    force: Force,
}

#[derive(Debug, clap::Args)]
struct RunArgs {
    /// The plan: plan.toml in the folder of the shards
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// Which shard, counted from 0
    #[arg(long, value_name = "K")]
    shard: u64,
}

#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("written").args(["out"]))]
struct GatherArgs {
    /// The folder with the plan and its shards
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Of a search: finish it from the best start, as `whirl tune` with all of them would, print its answer and write the feedback
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// A plan as it stands in its file.
struct Plan {
    line: String,
    shards: u64,
    question: String,
    form: Form,
}

/// Plans, runs or gathers.
///
/// # Errors
/// A document that makes no sense, shards of another one, or files that cannot be written.
pub(crate) fn run(args: &SweepArgs) -> Result<(), Failure> {
    match &args.command {
        SweepCommand::Plan(args) => plan(args),
        SweepCommand::Run(args) => shard(args),
        SweepCommand::Gather(args) => gather(args),
    }
}

fn plan(args: &PlanArgs) -> Result<(), Failure> {
    let path = args.out.join("plan.toml");
    // A folder that is to be made has nothing in the way.
    if args.out.is_dir() {
        args.force.check(&path)?;
    }
    for (wanted, name) in [(args.slurm, jobs::SLURM), (args.kubernetes, jobs::KUBERNETES)] {
        if wanted {
            args.force.check(Path::new(name))?;
        }
    }
    let text = catalog::text(&args.file)?;
    let [line] = keys(&args.file, &text, ["run"])?;
    let (task, question) = question(&line)?;
    let rows = task.rows();
    if rows < args.shards {
        return Err(Failure::Usage(format!("--shards {}: expected at most {rows}, a row each", args.shards)));
    }
    // What this program can write stays what the shards are.
    let form = if Form::Parquet.available().is_ok() { Form::Parquet } else { Form::Csv };
    let made = Plan { line, shards: args.shards, question, form };
    std::fs::create_dir_all(&args.out)
        .map_err(|error| Failure::Usage(format!("'{}': {error}: expected a folder to write to", args.out.display())))?;
    args.force.write(&path, made.to_text())?;
    let mut told = format!("{rows} rows in {} shards: {}\n", args.shards, path.display());
    for (wanted, name, text) in [
        (args.slurm, jobs::SLURM, jobs::slurm(&path, args.shards)),
        (args.kubernetes, jobs::KUBERNETES, jobs::kubernetes(&path, args.shards)),
    ] {
        if wanted {
            args.force.write(Path::new(name), text)?;
            told += &format!("{name}\n");
        }
    }
    print_text(&told)
}

fn shard(args: &RunArgs) -> Result<(), Failure> {
    let plan = Plan::read(&args.plan)?;
    if args.shard >= plan.shards {
        return Err(Failure::Usage(format!("--shard {}: expected 0 to {}", args.shard, plan.shards - 1)));
    }
    let task = plan.task(&args.plan)?;
    let folder = args.plan.parent().unwrap_or(Path::new(""));
    let target = folder.join(sweep::file_name(args.shard, plan.shards, &plan.question, plan.form));
    if target.is_file() {
        // A file has its name when it is whole: a job that is put back in its queue has nothing to do.
        return print_text(&format!("{} is there already\n", target.display()));
    }
    let stop = interrupt::flag()?;
    let rows = sweep::rows_of(args.shard, plan.shards, task.rows());
    let count = rows.end - rows.start;
    task.write(rows, &target, plan.form, &stop)?;
    print_text(&format!("{}: {count} rows\n", target.display()))
}

/// What `gather` says for scripts.
#[derive(Debug, Serialize)]
struct Document {
    shards: u64,
    rows: u64,
    columns: Vec<String>,
    files: Vec<String>,
    /// Of a search: the start that ended best, counted from 0 as the column `index` does, and its objective.
    #[serde(skip_serializing_if = "Option::is_none")]
    best: Option<Best>,
}

#[derive(Debug, Serialize)]
struct Best {
    index: usize,
    objective: f64,
}

fn gather(args: &GatherArgs) -> Result<(), Failure> {
    let path = args.folder.join("plan.toml");
    let plan = Plan::read(&path)?;
    let task = plan.task(&path)?;
    let (files, others) = sweep::found(&args.folder, plan.shards, &plan.question, plan.form)?;
    if !others.is_empty() {
        return Err(Failure::Work(format!(
            "'{}' has shards of another plan or version: {}. Expected those of {} alone",
            args.folder.display(),
            others.join(", "),
            plan.question
        )));
    }
    let missing: Vec<String> =
        files.iter().enumerate().filter(|(_, file)| file.is_none()).map(|(shard, _)| shard.to_string()).collect();
    if !missing.is_empty() {
        let (count, all) = (missing.len(), plan.shards);
        return Err(Failure::Work(format!(
            "{count} of {all} shards are missing: {}. Run them again",
            missing.join(", ")
        )));
    }
    let files: Vec<PathBuf> = files.into_iter().flatten().collect();
    for (shard, file) in files.iter().enumerate() {
        let rows = sweep::rows_of(shard as u64, plan.shards, task.rows());
        let (found, expected) = (sweep::count_rows(file, plan.form)?, rows.end - rows.start);
        if found != expected {
            let file = file.display();
            return Err(Failure::Work(format!(
                "'{file}' has {found} rows: expected {expected}. Remove it and run it again"
            )));
        }
    }
    let values = match task {
        Task::Starts { .. } => objectives(&files, plan.form)?,
        _ => Vec::new(),
    };
    let best = tuner::best_start(&values).map(|index| Best { index, objective: values[index] });
    if let Some(out) = &args.out {
        let Command::Tune(asked) = command(&plan.line)? else {
            return Err(Failure::Usage(
                "--out: a map or samples have nothing to finish: their shards are the result".into(),
            ));
        };
        return tune::finish(*asked, &values, out, (args.force, Format { json: args.json, csv: false }));
    }
    let told = best.as_ref().map_or(String::new(), |Best { index, objective }| {
        let objective = rounded(*objective);
        format!(
            "best start {index}, objective {objective}: --out FILE finishes it, proves it and writes the feedback\n"
        )
    });
    let document = Document {
        best,
        shards: plan.shards,
        rows: task.rows(),
        columns: task.columns().into_iter().chain(["index".to_owned()]).collect(),
        files: files.iter().map(|file| file.display().to_string()).collect(),
    };
    if args.json {
        return print_json(&document);
    }
    print_text(&format!(
        "{} shards, {} rows, whole\ncolumns {}\nread them together as {}/shard-*.{}\n{told}",
        document.shards,
        document.rows,
        document.columns.join(", "),
        args.folder.display(),
        plan.form.name()
    ))
}

/// What every start of a search has ended with, in their order.
fn objectives(files: &[PathBuf], form: Form) -> Result<Vec<f64>, Failure> {
    let mut values = Vec::new();
    for file in files {
        values.extend(sweep::column(file, form, OBJECTIVE)?);
    }
    Ok(values)
}

/// The texts under these keys, and no others, of a file.
///
/// # Errors
/// All that is wrong with it.
fn keys<const N: usize>(file: &str, text: &str, names: [&str; N]) -> Result<[String; N], Failure> {
    let read = || -> Result<[String; N], text::Faults> {
        let (mut reader, table) = text::Reader::parse(text)?;
        reader.only(&table, &names);
        let values = names.map(|name| {
            let found = reader.string(&table, name, "text in quotes").map(str::to_owned);
            if found.is_none() && !table.contains_key(name) {
                reader.fault(0..0, format!("no {name}"), format!("{name} = \"..\""));
            }
            found.unwrap_or_default()
        });
        reader.finish(values)
    };
    read().map_err(|faults| FileError::wrong(file, text, faults).into())
}

fn wrong(line: &str, why: &str) -> Failure {
    Failure::Usage(format!("run = \"{line}\": {why}"))
}

/// What a command line asks for.
fn command(line: &str) -> Result<Command, Failure> {
    let cli = Cli::try_parse_from(std::iter::once("whirl").chain(line.split_whitespace()))
        .map_err(|error| wrong(line, error.to_string().trim_end()))?;
    Ok(cli.command())
}

/// The task that a command line is, and what names it.
fn question(line: &str) -> Result<(Task, String), Failure> {
    let task = match command(line)? {
        Command::Map(args) => map::task(&args)?,
        Command::Margin(args) => margin::task(&args)?,
        Command::Tune(args) => tune::task(&args)?,
        _ => return Err(wrong(line, "expected a map, a margin with --samples, or a tune")),
    };
    // The machine as it was made of whatever files the line reads.
    let (rotor, settings) = (write_rotor(task.rotor()), SettingsDocument::of(&task.settings()));
    let named = format!("{}\n{line}\n{rotor}\n{}", env!("CARGO_PKG_VERSION"), settings.text());
    Ok((task, format!("{:016x}", wire::hash_of(named.as_bytes()))))
}

impl Plan {
    fn to_text(&self) -> String {
        format!(
            "# Made by `whirl sweep plan`; shards are run by `whirl sweep run` of the same version.\nrun = {}\nshards = \"{}\"\nquestion = \"{}\"\nform = \"{}\"\n",
            text::string(&self.line),
            self.shards,
            self.question,
            self.form.name()
        )
    }

    fn read(path: &Path) -> Result<Self, Failure> {
        let file = path.display().to_string();
        let text = catalog::text(&file)?;
        let [line, shards, question, form] = keys(&file, &text, ["run", "shards", "question", "form"])?;
        let wrong =
            |expected: &str| Failure::Usage(format!("{file}: expected {expected}, as `whirl sweep plan` writes it"));
        let count = shards.parse().ok().filter(|count| (1..=MOST_SHARDS).contains(count));
        let form = match form.as_str() {
            "csv" => Form::Csv,
            "parquet" => Form::Parquet.available().map_err(|error| Failure::Usage(error.to_string()))?,
            _ => return Err(wrong("form = \"csv\" or \"parquet\"")),
        };
        Ok(Self { line, shards: count.ok_or_else(|| wrong("a number of shards"))?, question, form })
    }

    /// The task, which must be the one that was planned.
    fn task(&self, path: &Path) -> Result<Task, Failure> {
        let (task, question) = question(&self.line)?;
        if question == self.question {
            return Ok(task);
        }
        Err(Failure::Usage(format!(
            "{}: it is the plan {}, but this version of whirl and the files it reads make it {question}: plan it anew",
            path.display(),
            self.question
        )))
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Map(error) => error.into(),
            SweepError::Samples(error) => Self::Work(error.to_string()),
            SweepError::Problem(error) => error.into(),
            SweepError::File(error) => error.into(),
            SweepError::Io(error) => error.into(),
            SweepError::Interrupted => Self::Interrupted,
        }
    }
}
