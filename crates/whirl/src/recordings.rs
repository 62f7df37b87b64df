//! The recordings that are made of a bench from its dashboard: each by a process of its own.

use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

use telemetry::past::Past;
use telemetry::processes::{OpaqueError, RecorderNews, RecorderProcess};
use wire::BenchName;

use crate::child_process::ChildProcess;
use crate::commands::{config, record};
use crate::failure::Failure;
use crate::output;
use crate::place::Force;

/// The folder that sessions go to if it is there; else they go where we are.
const FOLDER: &str = "recordings";

/// What of the past goes before a recording, into a file of its own.
enum PastFile {
    /// Nothing.
    None,
    /// Some of it, into this file, once the recording in the other has begun.
    Wanted { file: PathBuf, recorded: PathBuf, before: Option<u64> },
    /// It is being written.
    Writing(JoinHandle<Result<String, Failure>>),
}

/// Records one bench, again and again if it must be.
pub(crate) struct Recordings {
    bench: BenchName,
    recorder: Option<ChildProcess>,
    /// The file of a recorder that has not said yet that it records.
    starting: Option<PathBuf>,
    past: PastFile,
    /// How recordings ended that the dashboard has not been told of, or not in words that last beyond its screen.
    said: Vec<Result<String, Failure>>,
}

impl Recordings {
    /// None yet, of this bench.
    pub(crate) fn of(bench: BenchName) -> Self {
        Self { bench, recorder: None, starting: None, past: PastFile::None, said: Vec::new() }
    }

    /// Begins one of a bench that waits to be told to begin in the file `path`, and waits until it listens.
    ///
    /// # Errors
    /// A build without recordings, a place that is taken or missing, or a bench that is recorded already.
    pub(crate) fn begin(&mut self, path: &Path, force: Force) -> Result<(), Failure> {
        tape::available()?;
        let mut recorder = record::launch(path, force, &self.bench, true)?;
        recorder.wait()?;
        self.recorder = Some(recorder);
        Ok(())
    }

    /// Ends the one that is at work, and says how all of them went.
    ///
    /// # Errors
    /// One of them failed.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        if let Some(mut recorder) = self.recorder.take() {
            recorder.end()?;
            self.said.push(outcome(&mut recorder));
        }
        match std::mem::replace(&mut self.past, PastFile::None) {
            PastFile::None => {}
            PastFile::Wanted { file, .. } => self.said.push(Err(Failure::Work(format!(
                "{}: what is kept was not written, as no step of the recording had come yet",
                file.display()
            )))),
            PastFile::Writing(writer) => self.said.push(written(writer)),
        }
        let mut failed = None;
        for said in self.said {
            match said {
                Ok(words) => output::print_text(&words)?,
                Err(failure) => failed = failed.or(Some(failure)),
            }
        }
        failed.map_or(Ok(()), Err)
    }
}

/// How a recorder that has ended did.
fn outcome(recorder: &mut ChildProcess) -> Result<String, Failure> {
    if recorder.did_well() { Ok(recorder.last_words()) } else { Err(recorder.failure()) }
}

impl RecorderProcess for Recordings {
    fn start(&mut self, past: bool) -> Result<String, OpaqueError> {
        let file = new_name(&self.bench);
        // A recording and what goes before it are parts of one, as those of `--split` are: given any, readers take all.
        let path = if past { second_part(&file) } else { file.clone() };
        let launched = tape::available()
            .map_err(Failure::from)
            .and_then(|()| record::launch(&path, Force::default(), &self.bench, false));
        self.recorder = Some(launched.map_err(OpaqueError::new)?);
        if past {
            self.past = PastFile::Wanted { file: file.clone(), recorded: path.clone(), before: None };
        }
        self.starting = Some(path);
        Ok(file.display().to_string())
    }

    fn wants_past_before(&self) -> Option<u64> {
        if let PastFile::Wanted { before, .. } = self.past { before } else { None }
    }

    fn put_past(&mut self, past: Past) {
        let PastFile::Wanted { file, recorded, .. } = std::mem::replace(&mut self.past, PastFile::None) else { return };
        let bench = self.bench.as_str().to_owned();
        let write = move || {
            let Past { bench_status, events, steps } = past;
            let limits = config::read()?.limits;
            let rows = tape::write_past((&file, &recorded), &bench, limits, bench_status, &events, steps.states())?;
            Ok(format!("{}: {rows} steps from before, up to where {} begins\n", file.display(), recorded.display()))
        };
        match std::thread::Builder::new().name("past".into()).spawn(write) {
            Ok(writer) => self.past = PastFile::Writing(writer),
            Err(error) => self.said.push(Err(Failure::Work(format!("no thread to write what is kept: {error}")))),
        }
    }

    fn is_starting(&self) -> bool {
        self.starting.is_some()
    }

    fn stop(&mut self) {
        if let Some(recorder) = &mut self.recorder {
            recorder.dismiss();
        }
    }

    fn is_running(&self) -> bool {
        self.recorder.is_some()
    }

    fn news(&mut self) -> Option<RecorderNews> {
        if matches!(&self.past, PastFile::Writing(writer) if writer.is_finished())
            && let PastFile::Writing(writer) = std::mem::replace(&mut self.past, PastFile::None)
        {
            let said = written(writer);
            let told = said.as_ref().map(|words| words.trim().to_owned()).map_err(ToString::to_string);
            self.said.push(said);
            return Some(RecorderNews::Past(told));
        }
        if self.starting.is_some() {
            let ready = self.recorder.as_mut().map_or(Ok(true), ChildProcess::is_ready);
            if let Ok(false) = ready {
                return None;
            }
            let path = self.starting.take().unwrap_or_default();
            if let PastFile::Wanted { before, .. } = &mut self.past {
                *before = self.recorder.as_ref().and_then(|recorder| recorder.greeted_with().parse().ok());
            }
            return Some(match ready {
                Ok(_) => RecorderNews::Records(path.display().to_string()),
                Err(failure) => {
                    self.recorder = None;
                    let told = failure.to_string();
                    self.said.push(Err(failure));
                    RecorderNews::Ended(Err(told))
                }
            });
        }
        let mut recorder = self.recorder.take_if(|recorder| recorder.has_ended())?;
        let said = outcome(&mut recorder);
        let told = said.as_ref().map(|words| words.trim().to_owned()).map_err(ToString::to_string);
        self.said.push(said);
        Some(RecorderNews::Ended(told))
    }
}

/// How writing the past went.
fn written(writer: JoinHandle<Result<String, Failure>>) -> Result<String, Failure> {
    writer.join().unwrap_or_else(|_| Err(Failure::Work("the thread that wrote what is kept has panicked".into())))
}

/// `a.rrd` as `a-2.rrd`.
fn second_part(file: &Path) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}-2.rrd"))
}

/// A name that nothing has yet: the bench's and the present time, UTC.
fn new_name(bench: &BenchName) -> PathBuf {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let folder = if Path::new(FOLDER).is_dir() { FOLDER } else { "." };
    Path::new(folder).join(format!("{bench}-{}.rrd", dashboard::stamp(seconds)))
}
