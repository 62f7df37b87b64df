//! `whirl record`: a running simulation in a file, every step.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use files::Existing;
use tape::recorder::{self, Order, Progress, Summary};
use tape::{Keep, ViewerState, ViewerStatus};
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

/// How long a viewer that is there may take to answer.
const ANSWER: Duration = Duration::from_secs(2);

/// A bench that has sent nothing for so long sends nothing.
const SILENT: Duration = Duration::from_millis(400);

/// Options of `whirl record`.
#[derive(Debug, clap::Args)]
pub(crate) struct RecordArgs {
    /// The file; it must not be there yet, nor parts of it
    #[arg(value_name = "FILE.rrd", group = "written", required_unless_present = "connect")]
    file: Option<PathBuf>,
    /// Show it in a running Rerun viewer as it comes, beside the file or without; never waits for it
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:9876")]
    connect: Option<String>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    bench: BenchArgs,
    /// Keep the last so long only, such as 10min; in several files while it runs, joined at the end
    #[arg(long, value_name = "DURATION", value_parser = amount::seconds, requires = "file")]
    keep: Option<f64>,
    /// Write nothing until the machine trips; then the last so long before it, and as long after it but at most 10 s
    #[arg(long, value_name = "DURATION", value_parser = amount::seconds, conflicts_with = "keep", requires = "file")]
    pretrigger: Option<f64>,
    /// Go on in FILE-2.rrd, FILE-3.rrd ... whenever a file is this large, such as 1GB
    #[arg(long, value_name = "SIZE", value_parser = amount::bytes, conflicts_with_all = ["keep", "pretrigger"], requires = "file")]
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
    let (path, viewer) = (args.file.clone(), args.connect.clone());
    let order = Order { bench, path, viewer, keep, follow: args.follow, limits };
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
    let mut line = ProgressLine::new();
    let mut waited_for = args.as_child;
    let mut viewer = Viewer::default();
    let summary = recorder::record(&carrier, listener, &order, &stop, |progress| {
        // A bench that is held sends no step: its recorder is ready all the same.
        let first = progress.first.map(|seq| format!(" {seq}"));
        let is_ready = args.from_the_start || progress.elapsed > SILENT;
        if let Some(first) = first.or_else(|| is_ready.then(String::new)).filter(|_| waited_for) {
            waited_for = false;
            // A parent that does not listen will close our input too.
            let _ = output::print_text(&format!("{READY}{first}\n"));
        }
        if let (Some(status), Some(address)) = (progress.viewer, &args.connect)
            && let Some(news) = viewer.news(status, progress.elapsed)
        {
            line.clear_to_go_on();
            output::warn(&format!("the viewer at {address} {news}"));
        }
        line.show(progress);
    });
    line.clear();
    output::print_text(&(in_words(&summary?, args.connect.as_deref(), args.file.is_none()) + "\n"))
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

/// How a viewer stands, told when that changes.
#[derive(Default)]
struct Viewer {
    last: Option<ViewerState>,
}

impl Viewer {
    fn news(&mut self, status: ViewerStatus, elapsed: Duration) -> Option<&'static str> {
        // One that is there answers within a moment.
        if self.last == Some(status.state) || status.state == ViewerState::Waiting && elapsed < ANSWER {
            return None;
        }
        let is_first = self.last.replace(status.state).is_none();
        match status.state {
            ViewerState::Waiting => Some("does not answer: it is looked for on and on"),
            ViewerState::Showing if is_first => None,
            ViewerState::Showing => Some("shows what comes"),
            ViewerState::Behind => Some("does not keep up: what is too much for it is left out there"),
            ViewerState::Gone => Some("has gone: nothing more is shown"),
        }
    }
}

fn in_words(summary: &Summary, address: Option<&str>, is_shown_alone: bool) -> String {
    let Summary { files, rows, bytes, lost, elapsed, why, viewer } = summary;
    let (seconds, megabytes) = (elapsed.as_secs_f64(), *bytes as f64 / 1e6);
    let shown = match (viewer, address) {
        (Some(ViewerStatus { state: ViewerState::Waiting, .. }), Some(at)) => format!("no viewer answered at {at}"),
        (Some(ViewerStatus { shown, left_out, .. }), Some(at)) => {
            format!("{shown} messages shown at {at}, {left_out} left out")
        }
        _ => String::new(),
    };
    let beside = if shown.is_empty() { String::new() } else { format!("; {shown}") };
    match files.as_slice() {
        [] if is_shown_alone => format!("{rows} steps in {seconds:.1} s, {lost} lost; {why}{beside}"),
        [] => format!("nothing was written in {seconds:.1} s: {why}{beside}"),
        files => {
            let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            format!(
                "{}: {rows} steps in {seconds:.1} s, {megabytes:.1} MB, {lost} lost; {why}{beside}",
                names.join(", ")
            )
        }
    }
}

/// The line on the terminal that tells how far it is; nowhere else.
struct ProgressLine {
    shown: bool,
}

impl ProgressLine {
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

    /// Empties the line for words that stand on their own.
    fn clear_to_go_on(&self) {
        if self.shown {
            let _ = std::io::stderr().write_all(b"\r\x1b[K");
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
