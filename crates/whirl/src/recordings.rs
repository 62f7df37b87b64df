//! The recordings that are made of a bench from its dashboard: each by a process of its own.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use telemetry::processes::{ExternalError, RecorderNews, RecorderProcess};
use wire::BenchName;

use crate::child_process::ChildProcess;
use crate::commands::record;
use crate::failure::Failure;
use crate::output;
use crate::place::Force;

/// The folder that sessions go to if it is there; else they go where we are.
const FOLDER: &str = "recordings";

/// Records one bench, again and again if it must be.
pub(crate) struct Recordings {
    bench: BenchName,
    recorder: Option<ChildProcess>,
    /// The file of a recorder that has not said yet that it records.
    starting: Option<PathBuf>,
    /// How recordings ended that the dashboard has not been told of, or not in words that last beyond its screen.
    said: Vec<Result<String, Failure>>,
}

impl Recordings {
    /// None yet, of this bench.
    pub(crate) fn of(bench: BenchName) -> Self {
        Self { bench, recorder: None, starting: None, said: Vec::new() }
    }

    /// Begins one in the file `path`, and waits until it records.
    ///
    /// # Errors
    /// A build without recordings, a place that is taken or missing, or a bench that is recorded already.
    pub(crate) fn begin(&mut self, path: &Path, force: Force) -> Result<(), Failure> {
        tape::available()?;
        let mut recorder = record::launch(path, force, &self.bench)?;
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
    fn start(&mut self) -> Result<String, ExternalError> {
        let path = new_name(&self.bench);
        let launched = tape::available()
            .map_err(Failure::from)
            .and_then(|()| record::launch(&path, Force::default(), &self.bench));
        self.recorder = Some(launched.map_err(ExternalError::new)?);
        let told = path.display().to_string();
        self.starting = Some(path);
        Ok(told)
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
        if self.starting.is_some() {
            let ready = self.recorder.as_mut().map_or(Ok(true), ChildProcess::is_ready);
            if let Ok(false) = ready {
                return None;
            }
            let path = self.starting.take().unwrap_or_default();
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

/// A name that nothing has yet: the bench's and the present time, UTC.
fn new_name(bench: &BenchName) -> PathBuf {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let folder = if Path::new(FOLDER).is_dir() { FOLDER } else { "." };
    Path::new(folder).join(format!("{bench}-{}.rrd", dashboard::stamp(seconds)))
}
