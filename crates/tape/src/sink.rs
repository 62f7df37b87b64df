//! What is put on tape, and the interface of what takes it. The one for files needs the cargo feature `rerun`.

use std::path::{Path, PathBuf};

use alarms::{Level, Limits};
use machine::MachinePoles;
use wire::{BenchStatus, Happening, Moment};

use crate::batch::Batch;
use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::schema;
use crate::session::{Revision, Session, Source};
use crate::snapshot::Snapshot;
use crate::viewer::AskViewer;

/// One thing to be put on tape, in the order in which it came.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    /// A run begins, or the recording does, with this as the slow picture.
    Run(Box<BenchStatus>, Moment),
    /// Consecutive steps.
    Steps(Batch),
    /// Something happened on the bench.
    Event(Box<wire::Event>),
    /// The slow picture, as often as it comes.
    BenchStatus(Box<BenchStatus>, Moment),
    /// The recorder has something to say.
    Remark(Remark),
    /// All of the machine, as it is before the step of that moment.
    Snapshot(Snapshot, Moment),
}

/// What every file begins with, so that each can be read alone.
#[derive(Clone, Debug)]
pub struct Head {
    /// Whose session it is.
    pub session: Session,
    /// The slow picture as it stands at the beginning; its settings are those in force.
    pub bench_status: Box<BenchStatus>,
    /// The alarms in force: of each the turn with which it rose, and the last one.
    pub alarms: Vec<Remark>,
    /// All of the machine, before a step that the file may begin after.
    pub snapshot: Option<(Snapshot, Moment)>,
}

/// Takes what is recorded. Each call that returns has its bytes where a kill of this process does not reach them.
pub trait Sink: Send {
    /// Puts steps on tape.
    ///
    /// # Errors
    /// They cannot be written; what was written before stays whole.
    fn steps(&mut self, batch: &Batch) -> Result<(), TapeError>;

    /// Puts settings on tape that came into force.
    ///
    /// # Errors
    /// As [`Sink::steps`].
    fn revision(&mut self, revision: &Revision, at: Moment) -> Result<(), TapeError>;

    /// Puts on tape what happened.
    ///
    /// # Errors
    /// As [`Sink::steps`].
    fn event(&mut self, event: &Event) -> Result<(), TapeError>;

    /// Puts on tape what the recorder has to say.
    ///
    /// # Errors
    /// As [`Sink::steps`].
    fn remark(&mut self, remark: &Remark) -> Result<(), TapeError>;

    /// Puts on tape how well simulation and recorder keep up. May wait for the next steps.
    ///
    /// # Errors
    /// As [`Sink::steps`].
    fn health(&mut self, bench_status: &BenchStatus, at: Moment) -> Result<(), TapeError>;

    /// Puts all of the machine on tape, as it is before the step of that moment. May wait for the next steps.
    ///
    /// # Errors
    /// As [`Sink::steps`].
    fn snapshot(&mut self, snapshot: Snapshot, at: Moment) -> Result<(), TapeError>;

    /// Bytes written so far.
    fn bytes(&self) -> u64;

    /// Completes the file, and says how large it is.
    ///
    /// # Errors
    /// The rest cannot be written; what was written before stays readable.
    fn finish(self: Box<Self>) -> Result<u64, TapeError>;
}

/// Begins a file at `path`, which must not be there yet.
///
/// # Errors
/// The file is there already or cannot be made, or this build has no encoder.
pub fn create(path: &Path, head: &Head) -> Result<Box<dyn Sink>, TapeError> {
    #[cfg(feature = "rerun")]
    return Ok(Box::new(crate::rrd::Writer::create(path, head)?));
    #[cfg(not(feature = "rerun"))]
    {
        let _ = (path, head);
        Err(TapeError::NoRerun)
    }
}

/// Makes the sink at a path.
pub(crate) type Open = Box<dyn FnMut(&Path, &Head) -> Result<Box<dyn Sink>, TapeError> + Send>;

/// What makes sinks that are shown in the viewer at an address too, as files or without, and how that viewer stands.
///
/// # Errors
/// No such address, or this build has no encoder.
pub(crate) fn shown(address: &str, as_files: bool) -> Result<(Open, AskViewer), TapeError> {
    #[cfg(feature = "rerun")]
    {
        let (viewer, ask) = crate::rrd::Viewer::at(address)?;
        let open = move |path: &Path, head: &Head| -> Result<Box<dyn Sink>, TapeError> {
            Ok(Box::new(crate::rrd::Writer::open(path, head, as_files, Some(viewer.clone()))?))
        };
        Ok((Box::new(open), ask))
    }
    #[cfg(not(feature = "rerun"))]
    {
        let _ = (address, as_files);
        Err(TapeError::NoRerun)
    }
}

/// Whether this build can record and read recordings at all.
///
/// # Errors
/// It cannot: how to get one that can.
pub fn available() -> Result<(), TapeError> {
    if cfg!(feature = "rerun") { Ok(()) } else { Err(TapeError::NoRerun) }
}

/// Puts the parts of one recording together in a new file at `target`. Returns its size.
///
/// # Errors
/// A part cannot be read, the target is there already or cannot be written, or this build has no encoder.
pub fn join(parts: &[PathBuf], target: &Path) -> Result<u64, TapeError> {
    #[cfg(feature = "rerun")]
    return crate::rrd::join(parts, target);
    #[cfg(not(feature = "rerun"))]
    {
        let _ = (parts, target);
        Err(TapeError::NoRerun)
    }
}

impl Head {
    /// The head of a recording that begins with this picture of a bench called `bench`.
    #[must_use]
    pub fn live(bench_status: Box<BenchStatus>, bench: &str) -> Self {
        let session = Session {
            schema: schema::VERSION,
            whirl: env!("CARGO_PKG_VERSION").to_owned(),
            simulation: bench_status.version.as_str().to_owned(),
            run_id: bench_status.run_id,
            bench: bench.to_owned(),
            source: Source::Live,
            started_ns: bench_status.started_ns,
            rate_hz: bench_status.rate_hz,
            dtau: bench_status.dtau,
            bearings: bench_status.settings.get().feedback.bearings.len(),
            limits: None,
        };
        Self { session, bench_status, alarms: Vec::new(), snapshot: None }
    }

    /// The same of a bench that is held against limits.
    #[must_use]
    pub fn judged_by(mut self, limits: Limits) -> Self {
        self.session.limits = Some(limits);
        self
    }

    /// Takes note of an alarm that is in force from here on, or no longer.
    pub(crate) fn heed(&mut self, remark: &Remark) {
        let What::Alarm(turn) = &remark.what else { return };
        let is_same = |other: &Remark| matches!(&other.what, What::Alarm(other) if other.watch == turn.watch);
        if turn.level == Level::Fine {
            self.alarms.retain(|other| !is_same(other));
            return;
        }
        let rose = self.alarms.iter().position(is_same);
        let last = self.alarms.iter().rposition(is_same);
        if let Some(last) = last.filter(|last| Some(*last) != rose) {
            self.alarms.remove(last);
        }
        self.alarms.push(remark.clone());
    }

    /// What came into force with an event that happened before the recording began: those that came late are told of it.
    pub(crate) fn earlier(&self, event: &wire::Event) -> Option<Revision> {
        let bench_status = &self.bench_status;
        let changed = matches!(event.happening(), Some(Happening::Started | Happening::Settings));
        if !changed || event.run_id != bench_status.run_id || event.revision >= bench_status.revision {
            return None;
        }
        let (who, why) = (event.who.as_str(), event.why.as_str());
        let (settings, substeps) = (event.settings.get().clone(), event.substeps);
        let rotor = bench_status.rotor().ok();
        Some(revision_of(rotor.as_ref(), event.revision, event.seq, (who, why), settings, substeps))
    }

    /// What came into force with an event, if anything did; it is in force from here on.
    pub(crate) fn follow(&mut self, event: &wire::Event) -> Option<Revision> {
        let bench_status = &mut self.bench_status;
        if event.run_id != bench_status.run_id || event.revision <= bench_status.revision {
            return None;
        }
        bench_status.settings = event.settings.clone();
        bench_status.substeps = event.substeps;
        bench_status.revision = event.revision;
        bench_status.applied_at_step = event.seq;
        bench_status.changed_by = event.who;
        let (who, why) = (event.who.as_str(), event.why.as_str());
        let (settings, substeps) = (event.settings.get().clone(), event.substeps);
        let rotor = bench_status.rotor().ok();
        Some(revision_of(rotor.as_ref(), event.revision, event.seq, (who, why), settings, substeps))
    }

    /// The settings in force at the beginning.
    #[must_use]
    pub fn revision(&self) -> Revision {
        let bench_status = &self.bench_status;
        let (who, settings) = (bench_status.changed_by.as_str(), bench_status.settings.get().clone());
        let (from, substeps) = (bench_status.applied_at_step, bench_status.substeps);
        revision_of(bench_status.rotor().ok().as_ref(), bench_status.revision, from, (who, ""), settings, substeps)
    }
}

/// Settings with their poles.
pub(crate) fn revision_of(
    rotor: Option<&rotor::Rotor>,
    revision: u64,
    from: u64,
    (who, why): (&str, &str),
    settings: rotor::Settings,
    substeps: u32,
) -> Revision {
    // Computed here as the simulation does it: an event carries settings, and no poles.
    let checked = rotor.filter(|rotor| settings.check(rotor).is_ok());
    let linear = checked.and_then(|rotor| Some((rotor, MachinePoles::of(rotor, &settings).ok()?)));
    let min_damping = linear.as_ref().map_or(0.0, |(rotor, found)| found.counted_damping(rotor, settings.speed));
    let poles = linear.map(|(_, s)| s.modes.iter().map(|mode| mode.pole).collect()).unwrap_or_default();
    let (who, why, substeps) = (who.to_owned(), why.to_owned(), substeps.max(1));
    Revision { from, revision, who, why, settings, substeps, poles, min_damping }
}
