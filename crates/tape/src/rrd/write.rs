//! The sink: what is recorded, as an `.rrd` file.

use std::path::{Path, PathBuf};

use alarms::Level;
use rerun::archetypes::{RecordingInfo, Scalars, SeriesLines, TextLog};
use rerun::components::TextLogLevel;
use rerun::external::re_log_encoding::EncodeError;
use rerun::external::re_log_types::{ApplicationId, SetStoreInfo, StoreId, StoreInfo, StoreSource};
use rerun::log::{Chunk, ChunkError, LogMsg, RowId};
use rerun::{AsComponents, EntityPath, StoreKind, TimePoint};
use rotor::Rotor;
use wire::message::Health;
use wire::{BenchStatus, Happening, Moment, StepLayout};

use super::{chunks, scene, view};
use crate::batch::Batch;
use crate::document::event::EventDocument;
use crate::document::{self, RevisionDocument, SessionDocument};
use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::schema;
use crate::session::Revision;
use crate::sink::{Head, Sink};
use crate::snapshot::Snapshot;

use super::encode::Encoder;
use super::ledger::Ledger;
use super::viewer::Viewer;

/// Numbers of [`Health`] that are recorded, by the names of their series.
pub(super) const HEALTH: [&str; 9] = [
    "steps",
    "late",
    "missed",
    "lateness p50 (us)",
    "lateness p99 (us)",
    "lateness max (us)",
    "cost p50 (us)",
    "cost p99 (us)",
    "subscribers",
];

/// An `.rrd` file being written. Each message is one write, so that a kill cuts nothing but the last.
pub(crate) struct Writer {
    path: PathBuf,
    store: StoreId,
    /// None once a write has failed: what is on disk then stays as it is.
    encoder: Option<Encoder>,
    /// Whether there is a file at all; else it is only shown.
    is_file: bool,
    /// Where it is shown too.
    viewer: Option<Viewer>,
    rotor: Rotor,
    health: Vec<(Moment, Health)>,
    snapshots: Vec<(Moment, Snapshot)>,
    scene: scene::Scene,
}

impl Writer {
    /// Begins a file, which must not be there yet.
    ///
    /// # Errors
    /// It is there, or cannot be made, or not even its head can be written.
    pub(crate) fn create(path: &Path, head: &Head) -> Result<Self, TapeError> {
        Self::open(path, head, true, None)
    }

    /// The same, shown in a viewer too; or there alone, if there is no file to be.
    ///
    /// # Errors
    /// As [`Writer::create`].
    pub(crate) fn open(path: &Path, head: &Head, is_file: bool, viewer: Option<Viewer>) -> Result<Self, TapeError> {
        let rotor = head
            .bench_status
            .rotor()
            .map_err(|error| TapeError::place(path, format!("no rotor to record: {error}")))?;
        let run = format!("{:016x}", head.session.run_id);
        // Parts of one run share the id: a viewer that is given several puts them together.
        let store = StoreId::new(StoreKind::Recording, ApplicationId::from(schema::APPLICATION), run);
        let mut writer = Self {
            path: path.to_owned(),
            store,
            encoder: None,
            is_file,
            viewer,
            scene: scene::Scene::new(&rotor),
            rotor,
            health: Vec::new(),
            snapshots: Vec::new(),
        };
        if is_file {
            let ledger = Ledger::create(path).map_err(|error| TapeError::unfit(path, &error))?;
            writer.encoder = Some(Encoder::begin(ledger).map_err(|error| writer.stopped(plain(&error)))?);
        }
        let begun = writer.begin(head);
        if begun.is_err() && is_file {
            // A file of which not even the head is whole is worth nothing to anybody.
            let _ = std::fs::remove_file(path);
        }
        begun.map(|()| writer)
    }

    fn begin(&mut self, head: &Head) -> Result<(), TapeError> {
        let info = StoreInfo::new(self.store.clone(), StoreSource::Other(format!("whirl {}", head.session.whirl)));
        self.append(&LogMsg::SetStoreInfo(SetStoreInfo { row_id: *RowId::new(), info }))?;
        let name = format!("{} {}", self.rotor.name(), head.session.bench);
        let started = i64::try_from(head.session.started_ns).unwrap_or_default();
        let info = RecordingInfo::new().with_name(name.trim()).with_start_time(started);
        let properties = Chunk::builder(EntityPath::properties());
        self.put(properties.with_archetype_auto_row(TimePoint::STATIC, &info).build())?;
        let document = SessionDocument::new(&head.session, &self.rotor, head.bench_status.scales());
        let about = document::text(&document);
        self.about(&about)?;
        let names = SeriesLines::new().with_names(HEALTH);
        self.put(Chunk::builder(schema::HEALTH).with_archetype_auto_row(TimePoint::STATIC, &names).build())?;
        for chunk in self.scene.still() {
            self.put(chunk)?;
        }
        let steps = StepLayout::new(self.rotor.len()).with_bearings(head.session.bearings);
        for message in view::blueprint(&self.rotor, steps, head.session.source) {
            self.append(&message)?;
        }
        // Without it nothing on file can be read: damage in one place shall not cost all others.
        self.about(&about)
    }

    /// Puts the document about the whole file into it.
    fn about(&mut self, document: &str) -> Result<(), TapeError> {
        let row = [chunks::document(document)];
        self.put(Chunk::builder(schema::SESSION).with_row(RowId::new(), TimePoint::STATIC, row).build())
    }

    /// Puts a chunk into the file.
    fn put(&mut self, chunk: Result<Chunk, ChunkError>) -> Result<(), TapeError> {
        let message = chunk.and_then(|chunk| chunk.to_arrow_msg()).map_err(|error| self.stopped(error.to_string()))?;
        self.append(&LogMsg::ArrowMsg(self.store.clone(), message))
    }

    fn append(&mut self, message: &LogMsg) -> Result<(), TapeError> {
        if let Some(viewer) = &self.viewer {
            viewer.show(message);
        }
        if !self.is_file {
            return Ok(());
        }
        let Some(encoder) = &mut self.encoder else { return Err(self.stopped("writing has failed before".into())) };
        encoder.append(message).map_err(|error| {
            self.encoder = None;
            self.stopped(plain(&error))
        })
    }

    fn stopped(&self, problem: String) -> TapeError {
        let bytes = self.path.metadata().map_or(0, |found| found.len());
        TapeError::Stopped { path: self.path.clone(), problem, bytes }
    }

    /// Puts what has been gathered into the file, a chunk for many rows.
    fn flush(&mut self) -> Result<(), TapeError> {
        if !self.snapshots.is_empty() {
            let rows = std::mem::take(&mut self.snapshots);
            self.put(chunks::snapshots(&rows))?;
        }
        if self.health.is_empty() {
            return Ok(());
        }
        let rows = std::mem::take(&mut self.health);
        let values = rows.iter().flat_map(|(_, h)| health_row(h)).collect();
        let list = chunks::doubles(values, HEALTH.len());
        let times = chunks::timelines(rows.iter().map(|(at, _)| *at));
        self.put(Chunk::from_columns(schema::HEALTH, times, [(Scalars::descriptor_scalars(), list)]))
    }
}

/// An encoder's error without its own preface where the system has said it.
pub(super) fn plain(error: &EncodeError) -> String {
    match error {
        EncodeError::Write(error) => error.to_string(),
        other => other.to_string(),
    }
}

/// A row of words for people and of the document that they tell of.
fn documented(entity: &str, at: TimePoint, words: &dyn AsComponents, document: &str) -> Result<Chunk, ChunkError> {
    let words = words.as_serialized_batches().into_iter().map(|batch| (batch.descriptor, batch.array));
    Chunk::builder(entity).with_row(RowId::new(), at, words.chain([chunks::document(document)])).build()
}

fn health_row(h: &Health) -> [f64; HEALTH.len()] {
    [
        h.steps as f64,
        h.late as f64,
        h.missed as f64,
        h.lateness_p50_us,
        h.lateness_p99_us,
        h.lateness_max_us,
        h.cost_p50_us,
        h.cost_p99_us,
        f64::from(h.subscribers),
    ]
}

/// Health from its row.
pub(super) fn health_of(row: &[f64]) -> Health {
    let at = |i: usize| row.get(i).copied().unwrap_or_default();
    Health {
        steps: at(0) as u64,
        late: at(1) as u64,
        missed: at(2) as u64,
        lateness_p50_us: at(3),
        lateness_p99_us: at(4),
        lateness_max_us: at(5),
        cost_p50_us: at(6),
        cost_p99_us: at(7),
        subscribers: at(8) as u32,
        reserved: 0,
    }
}

impl Sink for Writer {
    fn steps(&mut self, batch: &Batch) -> Result<(), TapeError> {
        if batch.is_empty() {
            return Ok(());
        }
        self.put(chunks::steps(batch))?;
        for chunk in self.scene.curves(batch) {
            self.put(chunk)?;
        }
        self.flush()
    }

    fn revision(&mut self, revision: &Revision, at: Moment) -> Result<(), TapeError> {
        let time = chunks::timepoint(at);
        let document = document::text(&RevisionDocument::from(revision));
        let words = scene::settings_text(revision);
        // The words and the document in one message: neither is there without the other.
        self.put(documented(schema::SETTINGS, time.clone(), &words, &document))?;
        for chunk in self.scene.settings(revision, &time) {
            self.put(chunk)?;
        }
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), TapeError> {
        let level = match event.happening {
            Happening::Tripped(_) => TextLogLevel::CRITICAL,
            Happening::Refused { .. } | Happening::Late { .. } => TextLogLevel::WARN,
            _ => TextLogLevel::INFO,
        };
        let document = document::text(&EventDocument::from(event));
        self.log(event.at, event.text(), level, &document)
    }

    fn remark(&mut self, remark: &Remark) -> Result<(), TapeError> {
        let level = match &remark.what {
            What::Lost(_) => TextLogLevel::ERROR,
            What::Alarm(turn) => match turn.level {
                Level::Alarm => TextLogLevel::ERROR,
                Level::Warning => TextLogLevel::WARN,
                Level::Fine => TextLogLevel::INFO,
            },
            _ => TextLogLevel::DEBUG,
        };
        let document = document::text(&EventDocument::from(remark));
        self.log(remark.at, remark.text(), level, &document)
    }

    fn health(&mut self, bench_status: &BenchStatus, at: Moment) -> Result<(), TapeError> {
        self.health.push((at, bench_status.health));
        Ok(())
    }

    fn snapshot(&mut self, snapshot: Snapshot, at: Moment) -> Result<(), TapeError> {
        self.snapshots.push((at, snapshot));
        Ok(())
    }

    fn bytes(&self) -> u64 {
        self.encoder.as_ref().map_or(0, Encoder::len)
    }

    fn finish(mut self: Box<Self>) -> Result<u64, TapeError> {
        self.flush()?;
        if !self.is_file {
            return Ok(0);
        }
        let Some(encoder) = self.encoder.take() else {
            return Err(self.stopped("writing has failed before".into()));
        };
        // An end that does not fit is taken back whole: without it readers go through the messages.
        let ledger = encoder.finish().map_err(|error| self.stopped(plain(&error)))?;
        ledger.sync().map_err(|error| self.stopped(error.to_string()))?;
        Ok(ledger.len())
    }
}

impl Writer {
    fn log(&mut self, at: Moment, text: String, level: &str, document: &str) -> Result<(), TapeError> {
        let words = TextLog::new(text).with_level(level);
        self.put(documented(schema::EVENTS, chunks::timepoint(at), &words, document))
    }
}
