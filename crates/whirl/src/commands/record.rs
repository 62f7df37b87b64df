//! `whirl record`: a running simulation in a file, every step.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use files::Existing;
use tape::Keep;
use tape::recorder::{self, Order, Progress, Summary};
use text::amount;
use wire::{BenchName, Keeping};

use crate::attach::{self, BenchArgs};
use crate::child_process::ChildProcess;
use crate::commands::config;
use crate::commands::sim::{READY, heed_stdin};
use crate::failure::Failure;
use crate::place::Force;
use crate::{interrupt, output};

/// How long a recorder may take to write what it has heard before it is killed.
const FAREWELL: Duration = Duration::from_secs(30);

/// A bench that has sent nothing for so long sends nothing.
const SILENT: Duration = Duration::from_millis(400);

/// Options of `whirl record`.
#[derive(Debug, clap::Args)]
pub(crate) struct RecordArgs {
    /// The file; it must not be there yet, nor parts of it
    #[arg(value_name = "FILE.rrd", group = "written")]
    file: PathBuf,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    bench: BenchArgs,
    /// Keep the last so long only, such as 10min; in several files while it runs, joined at the end
    #[arg(long, value_name = "DURATION", value_parser = amount::seconds)]
    keep: Option<f64>,
    /// Write nothing until the machine trips; then the last so long before it, and as long after it but at most 10 s
    #[arg(long, value_name = "DURATION", value_parser = amount::seconds, conflicts_with = "keep")]
    pretrigger: Option<f64>,
    /// Go on in FILE-2.rrd, FILE-3.rrd ... whenever a file is this large, such as 1GB
    #[arg(long, value_name = "SIZE", value_parser = amount::bytes, conflicts_with_all = ["keep", "pretrigger"])]
    split: Option<u64>,
    /// End in good order when the disk has less room left than this
    #[arg(long, value_name = "SIZE", value_parser = amount::bytes, default_value = "200MB")]
    min_free: u64,
    /// Go on with the next simulation of the same name when one ends
    #[arg(long)]
    follow: bool,
    /// Serve a parent process: say `ready` once it records, with the number of the first step, and end when standard input closes
    #[arg(long, hide = true)]
    as_child: bool,
    /// Serve a parent process whose simulation has not begun yet: say `ready` before any step
    #[arg(long, hide = true, requires = "as_child", conflicts_with_all = ["keep", "pretrigger"])]
    from_the_start: bool,
}

/// Records until a signal comes or the simulation ends, and says in one line how it went.
///
/// # Errors
/// A build without recordings, a file that is there already, no such bench, or a disk that is full.
pub(crate) fn run(args: &RecordArgs) -> Result<(), Failure> {
    tape::available()?;
    let bench = args.bench.name()?;
    let keeping = match (args.keep, args.pretrigger) {
        (Some(seconds), _) => Keeping::Last(seconds),
        (_, Some(seconds)) => Keeping::Pretrigger(seconds),
        _ => Keeping::All,
    };
    let keep = Keep { keeping, split: args.split, min_free: args.min_free, existing: args.force.existing() };
    // The same limits as the dashboard's.
    let limits = config::read()?.limits;
    let order = Order { bench, path: args.file.clone(), keep, follow: args.follow, limits };
    // What is wrong with the command line is said before anything is waited for.
    recorder::check(&order)?;
    let stop = interrupt::flag()?;
    if args.as_child {
        heed_stdin(stop.clone(), Arc::default());
    }
    let carrier = attach::carrier("record")?;
    let mut listener = attach::listen(&carrier, &order.bench)?;
    if !args.from_the_start {
        let rate_hz = attach::first_bench_status(&mut listener, &order.bench)?.rate_hz;
        recorder::check_window(&order.keep, rate_hz).map_err(|error| Failure::Usage(error.to_string()))?;
    }
    let mut line = Line::new();
    let mut waited_for = args.as_child;
    let summary = recorder::record(&carrier, listener, &order, &stop, |progress| {
        // A bench that is held sends no step: its recorder is ready all the same.
        let first = progress.first.map(|seq| format!(" {seq}"));
        let is_ready = args.from_the_start || progress.elapsed > SILENT;
        if let Some(first) = first.or_else(|| is_ready.then(String::new)).filter(|_| waited_for) {
            waited_for = false;
            // A parent that does not listen will close our input too.
            let _ = output::print_text(&format!("{READY}{first}\n"));
        }
        line.show(progress);
    });
    line.clear();
    output::print_text(&(in_words(&summary?) + "\n"))
}

/// Starts a recorder of a bench as a process of its own, which ends in good order when it is dropped; `from_the_start` of one that makes no
/// step before it is told to. Does not wait for it.
///
/// # Errors
/// It cannot be started.
pub(crate) fn launch(
    path: &Path,
    force: Force,
    bench: &BenchName,
    from_the_start: bool,
) -> Result<ChildProcess, Failure> {
    let path =
        path.to_str().ok_or_else(|| Failure::Usage(format!("'{}': expected a name in UTF-8", path.display())))?;
    let bench = format!("--bench={bench}");
    let mut arguments = vec!["record", &bench, "--follow", "--as-child"];
    if from_the_start {
        arguments.push("--from-the-start");
    }
    if force.existing() == Existing::Replace {
        arguments.push("--force");
    }
    arguments.extend(["--", path]);
    ChildProcess::launch("recorder", FAREWELL, arguments.into_iter().map(str::to_owned).collect())
}

fn in_words(summary: &Summary) -> String {
    let Summary { files, rows, bytes, lost, elapsed, why } = summary;
    let (seconds, megabytes) = (elapsed.as_secs_f64(), *bytes as f64 / 1e6);
    match files.as_slice() {
        [] => format!("nothing was written in {seconds:.1} s: {why}"),
        files => {
            let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            format!("{}: {rows} steps in {seconds:.1} s, {megabytes:.1} MB, {lost} lost; {why}", names.join(", "))
        }
    }
}

/// The line on the terminal that tells how far it is; nowhere else.
struct Line {
    shown: bool,
}

impl Line {
    fn new() -> Self {
        Self { shown: std::io::stderr().is_terminal() }
    }

    fn show(&mut self, Progress { rows, bytes, lost, elapsed, .. }: Progress) {
        if self.shown {
            let (seconds, megabytes) = (elapsed.as_secs(), bytes as f64 / 1e6);
            let (minutes, seconds) = (seconds / 60, seconds % 60);
            let line = format!("\r\x1b[K● {minutes:02}:{seconds:02}  {rows} steps  {megabytes:.1} MB  {lost} lost");
            let _ = std::io::stderr().write_all(line.as_bytes());
        }
    }

    fn clear(&mut self) {
        if std::mem::take(&mut self.shown) {
            let _ = std::io::stderr().write_all(b"\r\x1b[K");
        }
    }
}

impl From<tape::TapeError> for Failure {
    fn from(error: tape::TapeError) -> Self {
        match error {
            tape::TapeError::Wire(error) => error.into(),
            error if error.is_usage() => Self::Usage(error.to_string()),
            error => Self::Work(error.to_string()),
        }
    }
}
