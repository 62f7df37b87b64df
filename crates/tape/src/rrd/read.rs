//! The reader: goes through the messages of a file once, keeps what is small, and notes where the steps are. Needs no
//! footer, so that a file cut off anywhere is read like a whole one; what is damaged is passed over and told.

use std::fs::File;
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use rerun::archetypes::Scalars;
use rerun::external::arrow::array::{Array, Float64Array};
use rerun::log::Chunk;

use super::fence::{self, About, Unreadable};
use super::{chunks, write};
use crate::batch::Batch;
use crate::contents::{Contents, Decoder as StretchDecoder, Stretch};
use crate::damage::{Damage, DamageKind};
use crate::document::event::{EventDocument, EventOrRemark};
use crate::document::{self, RevisionDocument, SessionDocument};
use crate::error::TapeError;
use crate::order;
use crate::schema;
use crate::session::{Gap, Revision};
use crate::snapshot::{Snapshot, SnapshotPlace};
use crate::stream::{self, Kind, Met, Seal, Walk};

/// The entities that are read; the others are drawings, made of these.
const READ: [&str; 6] =
    [schema::SESSION, schema::STEPS, schema::SETTINGS, schema::EVENTS, schema::HEALTH, schema::SNAPSHOTS];

/// Opens a recording: what is small in it, and what decodes the rest.
///
/// # Errors
/// No such file, no recording of ours, or one of a later schema.
pub(crate) fn open(path: &Path) -> Result<(Contents, Steps), TapeError> {
    let (file, bytes) = file(path)?;
    let mut scan = Scan::new(path, Walk::new(&file, bytes, fence::is_message));
    scan.run(|_| false)?;
    let contents = scan.contents(bytes)?;
    let masses = contents.rotor.len();
    Ok((contents, Steps { path: path.to_owned(), file: Some(file), masses }))
}

/// The run that a recording of ours is of, from its head alone.
pub(crate) fn run_of(path: &Path) -> Option<u64> {
    let (file, bytes) = file(path).ok()?;
    let mut scan = Scan::new(path, Walk::new(&file, bytes, fence::is_message));
    scan.run(|scan| scan.session.is_some()).ok()?;
    let (session, ..) = scan.session?.read().ok()?;
    Some(session.run_id)
}

/// A file and its length.
pub(super) fn file(path: &Path) -> Result<(File, u64), TapeError> {
    let file = File::open(path).map_err(|error| TapeError::not_ours(path, error.to_string()))?;
    match file.metadata() {
        Ok(found) if found.is_file() => Ok((file, found.len())),
        _ => Err(TapeError::not_ours(path, "is no file: expected an .rrd recording")),
    }
}

/// Whether rows are of one of the entities that are read.
fn is_read(about: &About) -> bool {
    !about.is_layout && READ.contains(&plain(&about.entity))
}

/// Paths begin with a slash, or not.
fn plain(entity: &str) -> &str {
    entity.trim_start_matches('/')
}

/// Decodes stretches of steps from an open file.
pub(crate) struct Steps {
    path: PathBuf,
    /// `None` if it is opened whenever it is read.
    file: Option<File>,
    masses: usize,
}

impl Steps {
    /// What is made of the chunk in a message that was there when the file was gone through.
    fn read<T>(
        &self,
        offset: u64,
        bytes: u64,
        made: impl FnOnce(&Chunk) -> Result<T, Unreadable>,
    ) -> Result<T, TapeError> {
        let mut message = vec![0; usize::try_from(bytes).unwrap_or_default()];
        let failed = |error| TapeError::read(&self.path, error);
        let opened = if self.file.is_none() { Some(File::open(&self.path).map_err(failed)?) } else { None };
        if let Some(file) = self.file.as_ref().or(opened.as_ref()) {
            file.read_exact_at(&mut message, offset).map_err(failed)?;
        }
        // The file may have changed since. What is asked for is never the first message of a stream.
        let chunk = match stream::check(&message, &[]) {
            Seal::Broken => Err(Unreadable::Checksum),
            _ => fence::chunk(&message, is_read),
        };
        let nothing = || content("nothing of ours there");
        let made = chunk.and_then(|chunk| chunk.ok_or_else(nothing)).and_then(|(_, chunk)| made(&chunk));
        made.map_err(|problem| TapeError::read(&self.path, problem))
    }
}

impl StretchDecoder for Steps {
    fn decode(&mut self, stretch: &Stretch) -> Result<Batch, TapeError> {
        self.read(stretch.offset, stretch.bytes, |chunk| chunks::read_steps(chunk, self.masses))
    }

    fn snapshot(&mut self, place: &SnapshotPlace) -> Result<Snapshot, TapeError> {
        let of_step = |snapshots: Vec<Snapshot>| snapshots.into_iter().find(|snapshot| snapshot.next == place.next);
        self.read(place.offset, place.bytes, |chunk| {
            of_step(chunks::read_snapshots(chunk)?).ok_or_else(|| content("no snapshot there"))
        })
    }

    fn close(&mut self) {
        self.file = None;
    }
}

/// One pass through a file.
struct Scan<'a> {
    path: &'a Path,
    walk: Walk<'a>,
    session: Option<SessionDocument>,
    masses: usize,
    /// The name of the recording in the stream; everything else is of another one.
    recording: String,
    /// The streams that the file consists of.
    streams: usize,
    /// What of another recording is being passed over.
    other: Option<Range<u64>>,
    found: Found,
}

#[derive(Default)]
struct Found {
    stretches: Vec<Stretch>,
    snapshots: Vec<SnapshotPlace>,
    revisions: Vec<Revision>,
    told: Vec<EventOrRemark>,
    health: Vec<(wire::Moment, wire::message::Health)>,
    damage: Vec<Damage>,
}

impl<'a> Scan<'a> {
    fn new(path: &'a Path, walk: Walk<'a>) -> Self {
        let (recording, found) = (String::new(), Found::default());
        Self { path, walk, session: None, masses: 0, recording, streams: 0, other: None, found }
    }

    fn run(&mut self, is_enough: impl Fn(&Self) -> bool) -> Result<(), TapeError> {
        while !is_enough(self) {
            match self.walk.next().map_err(|error| TapeError::read(self.path, error))? {
                None => break,
                Some(Met::Stream { .. }) => self.streams += 1,
                Some(Met::Message { kind: Kind::Chunk, at, bytes, sealed }) => {
                    if let Err(error) = self.message(at, &bytes, sealed)? {
                        tracing::debug!("{}: byte {at}: {error}", self.path.display());
                        self.found.damage.push(Damage::at(at, bytes.len() as u64, DamageKind::Unreadable));
                    }
                }
                Some(Met::Message { .. }) => {}
            }
        }
        self.leave_other();
        Ok(())
    }

    /// Notes a message of another recording.
    fn pass_over_other(&mut self, at: u64, bytes: u64) {
        let from = self.other.take().map_or(at, |other| other.start);
        self.other = Some(from..at + bytes);
    }

    /// Says what has been passed over of another recording, as one place.
    fn leave_other(&mut self) {
        if let Some(other) = self.other.take() {
            self.found.damage.push(Damage::at(other.start, other.end - other.start, DamageKind::Other));
        }
    }

    /// Takes what is in a message; inside, what is wrong with the message alone.
    fn message(&mut self, at: u64, message: &[u8], sealed: bool) -> Result<Result<(), Unreadable>, TapeError> {
        // Nobody but its columns vouches for a message without checksum, drawing or not.
        let (about, chunk) = match fence::chunk(message, |about| !sealed || is_read(about)) {
            Ok(Some(read)) if is_read(&read.0) => read,
            Ok(_) => return Ok(Ok(())),
            Err(error) => return Ok(Err(error)),
        };
        if self.session.is_some() && about.recording != self.recording {
            self.pass_over_other(at, message.len() as u64);
            return Ok(Ok(()));
        }
        self.leave_other();
        Ok(match plain(&about.entity) {
            schema::SESSION => return self.begin(&about.recording, &chunk),
            // Without a head there is no telling what they are of.
            _ if self.session.is_none() => Err(content("rows before the head")),
            schema::STEPS => chunks::read_steps(&chunk, self.masses).map(|batch| self.stretch(at, message, &batch)),
            schema::SETTINGS => settings(&chunk).map(|read| self.found.revisions.extend(read)),
            schema::EVENTS => {
                documents(&chunk).map(|read| self.found.told.extend(read.into_iter().map(EventDocument::read)))
            }
            schema::SNAPSHOTS => chunks::read_snapshots(&chunk).map(|read| self.snapshots(at, message, &read)),
            schema::HEALTH => {
                self.health(&chunk);
                Ok(())
            }
            _ => Ok(()),
        })
    }

    fn begin(&mut self, recording: &str, chunk: &Chunk) -> Result<Result<(), Unreadable>, TapeError> {
        #[derive(serde::Deserialize)]
        struct Version {
            schema: u32,
        }
        for text in chunks::documents(chunk) {
            let parsed = document::parse::<Version>(&text);
            let Ok(Version { schema }) = parsed else { return Ok(Err(content("a head that is none"))) };
            if schema > schema::VERSION {
                let newest = schema::VERSION;
                return Err(self.not_ours(&format!(
                    "recorded by a later whirl (schema {schema}; this one reads up to {newest}): read it with that one"
                )));
            }
            let Ok(document) = document::parse::<SessionDocument>(&text) else {
                return Ok(Err(content("a head that is none")));
            };
            // It is there more than once, and in every part of a recording that was put together.
            if self.session.is_none() {
                self.masses = document.masses();
                self.session = Some(document);
                recording.clone_into(&mut self.recording);
            }
        }
        Ok(Ok(()))
    }

    fn not_ours(&self, problem: &str) -> TapeError {
        TapeError::not_ours(self.path, problem)
    }

    fn stretch(&mut self, offset: u64, message: &[u8], batch: &Batch) {
        let Some((first, last)) = batch.span() else { return };
        let pairs = batch.seq.windows(2).filter(|pair| pair[1] > pair[0] + 1);
        let gaps = pairs.map(|pair| Gap { from: pair[0] + 1, count: pair[1] - pair[0] - 1 }).collect();
        let (bytes, rows) = (message.len() as u64, batch.len() as u64);
        self.found.stretches.push(Stretch { part: 0, offset, bytes, rows, first, last, gaps });
    }

    fn snapshots(&mut self, offset: u64, message: &[u8], snapshots: &[Snapshot]) {
        let bytes = message.len() as u64;
        let place =
            |snapshot: &Snapshot| SnapshotPlace { part: 0, offset, bytes, next: snapshot.next, dtau: snapshot.dtau };
        self.found.snapshots.extend(snapshots.iter().map(place));
    }

    fn health(&mut self, chunk: &Chunk) {
        let component = Scalars::descriptor_scalars().component;
        let Some(list) = chunk.components().get_array(component) else { return };
        let moments = chunks::moments(chunk);
        for (row, at) in list.iter().zip(moments) {
            let values = row.as_ref().and_then(|row| row.as_any().downcast_ref::<Float64Array>());
            if let Some(values) = values {
                self.found.health.push((at, write::health_of(values.values())));
            }
        }
    }

    fn contents(self, bytes: u64) -> Result<Contents, TapeError> {
        let Self { path, walk, session, streams, found, .. } = self;
        let Found { stretches, snapshots, revisions, told, health, mut damage } = found;
        damage.extend(walk.damage);
        let Some(session) = session else {
            return Err(TapeError::not_ours(path, no_head(streams, bytes, &damage)));
        };
        let (session, rotor, scales) =
            session.read().map_err(|error| TapeError::not_ours(path, format!("its head is damaged: {error}")))?;
        let stretches = order::in_order(stretches, &mut damage);
        let (mut events, mut remarks) = (Vec::new(), Vec::new());
        for told in told {
            match told {
                EventOrRemark::Event(event) => events.push(event),
                EventOrRemark::Remark(remark) => remarks.push(remark),
            }
        }
        damage.sort_by_key(|damage| damage.byte);
        order::lost_steps(&mut damage, &stretches);
        let mut notices = Vec::new();
        if streams > 1 {
            notices.push(format!("{streams} files, one put behind the other"));
        }
        let checksums = walk.sealed;
        Ok(Contents {
            session,
            rotor,
            scales,
            stretches,
            snapshots,
            revisions,
            events,
            remarks,
            health,
            notices,
            damage,
            checksums,
            bytes,
        })
    }
}

fn content(what: &str) -> Unreadable {
    Unreadable::Content(what.to_owned())
}

/// All settings of a chunk.
fn settings(chunk: &Chunk) -> Result<Vec<Revision>, Unreadable> {
    let read = |document: RevisionDocument| document.read().map_err(|error| content(&error.to_string()));
    documents(chunk)?.into_iter().map(read).collect()
}

/// All documents of a chunk.
fn documents<D: serde::de::DeserializeOwned>(chunk: &Chunk) -> Result<Vec<D>, Unreadable> {
    let texts = chunks::documents(chunk);
    texts.iter().map(|text| document::parse(text).map_err(|error| content(&error.to_string()))).collect()
}

/// Why a file without the document about the whole of it is not read.
fn no_head(streams: usize, bytes: u64, damage: &[Damage]) -> String {
    let expected = "expected an .rrd recording of whirl";
    if streams == 0 {
        let shortest = stream::HEADER + 12;
        return if bytes < shortest { format!("{bytes} bytes are too short: {expected}") } else { expected.to_owned() };
    }
    match Damage::notices(damage, false) {
        none if none.is_empty() => "nothing of whirl's is in it: was not made by whirl".to_owned(),
        notices => format!("its head is lost, without which nothing of it can be read: {}", notices.join("; ")),
    }
}
