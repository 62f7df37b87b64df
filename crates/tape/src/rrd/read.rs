//! The reader: goes through the messages of a file once, keeps what is small, and notes where the steps are. Needs no
//! footer, so that a file cut off anywhere is read like a whole one; what is damaged is passed over and told.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use rerun::archetypes::Scalars;
use rerun::external::arrow::array::{Array, Float64Array};
use rerun::log::Chunk;

use super::fence::{self, Unreadable};
use super::{chunks, write};
use crate::batch::Batch;
use crate::contents::{Contents, Decoder as StretchDecoder, Stretch};
use crate::damage::{Damage, DamageKind, LostSteps};
use crate::document::event::{EventDocument, Told};
use crate::document::{self, RevisionDocument, SessionDocument};
use crate::error::TapeError;
use crate::schema;
use crate::session::Gap;
use crate::stream::{self, Kind, Met, Seal, Walk};

/// The entities that are read; the others are drawings, made of these.
const READ: [&str; 5] = [schema::SESSION, schema::STEPS, schema::SETTINGS, schema::EVENTS, schema::HEALTH];

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

/// Whether an entity is one of those that are read. Paths begin with a slash, or not.
fn is_read(entity: &str) -> bool {
    READ.contains(&entity.trim_start_matches('/'))
}

/// Decodes stretches of steps from an open file.
pub(crate) struct Steps {
    path: PathBuf,
    /// `None` if it is opened whenever it is read.
    file: Option<File>,
    masses: usize,
}

impl StretchDecoder for Steps {
    fn decode(&mut self, stretch: &Stretch) -> Result<Batch, TapeError> {
        let mut message = vec![0; usize::try_from(stretch.bytes).unwrap_or_default()];
        let failed = |error| TapeError::read(&self.path, error);
        let opened = if self.file.is_none() { Some(File::open(&self.path).map_err(failed)?) } else { None };
        if let Some(file) = self.file.as_ref().or(opened.as_ref()) {
            file.read_exact_at(&mut message, stretch.offset).map_err(failed)?;
        }
        // The file may have changed since it was gone through. Steps are never the first message of a stream.
        let chunk = match stream::check(&message, &[]) {
            Seal::Broken => Err(Unreadable::Checksum),
            _ => fence::chunk(&message, is_read),
        };
        let no_steps = || Unreadable::Content("no steps there".to_owned());
        let batch = chunk.and_then(|chunk| chunks::read_steps(&chunk.ok_or_else(no_steps)?, self.masses));
        batch.map_err(|problem| TapeError::read(&self.path, problem))
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
    /// The streams that the file consists of.
    streams: usize,
    /// Where the stream begins that we are in, if it is of another recording than the first.
    other: Option<u64>,
    found: Found,
}

#[derive(Default)]
struct Found {
    stretches: Vec<Stretch>,
    revisions: Vec<RevisionDocument>,
    told: Vec<Told>,
    health: Vec<(wire::Moment, wire::message::Health)>,
    damage: Vec<Damage>,
}

impl<'a> Scan<'a> {
    fn new(path: &'a Path, walk: Walk<'a>) -> Self {
        Self { path, walk, session: None, masses: 0, streams: 0, other: None, found: Found::default() }
    }

    fn run(&mut self, is_enough: impl Fn(&Self) -> bool) -> Result<(), TapeError> {
        while !is_enough(self) {
            let met = self.walk.next().map_err(|error| TapeError::read(self.path, error))?;
            match met {
                None => break,
                Some(Met::Stream { at }) => {
                    self.leave_other(at);
                    self.streams += 1;
                }
                Some(Met::Message { kind: Kind::Chunk, at, bytes }) if self.other.is_none() => {
                    if let Err(error) = self.message(at, &bytes)? {
                        tracing::debug!("{}: byte {at}: {error}", self.path.display());
                        self.found.damage.push(Damage::at(at, bytes.len() as u64, DamageKind::Unreadable));
                    }
                }
                Some(Met::Message { .. }) => {}
            }
        }
        self.leave_other(self.walk.at());
        Ok(())
    }

    /// Says what has not been read of a stream that ends here.
    fn leave_other(&mut self, at: u64) {
        if let Some(from) = self.other.take() {
            self.found.damage.push(Damage::at(from, at - from, DamageKind::Other));
        }
    }

    /// Takes what is in a message; inside, what is wrong with the message alone.
    fn message(&mut self, at: u64, message: &[u8]) -> Result<Result<(), Unreadable>, TapeError> {
        let chunk = match fence::chunk(message, is_read) {
            Ok(Some(chunk)) => chunk,
            Ok(None) => return Ok(Ok(())),
            Err(error) => return Ok(Err(error)),
        };
        let entity = chunk.entity_path().to_string();
        let taken = match entity.trim_start_matches('/') {
            schema::SESSION => return self.begin(&chunk),
            schema::STEPS => chunks::read_steps(&chunk, self.masses).map(|batch| self.stretch(at, message, &batch)),
            schema::SETTINGS => documents(&chunk).map(|read| self.found.revisions.extend(read)),
            schema::EVENTS => {
                documents(&chunk).map(|read| self.found.told.extend(read.into_iter().map(EventDocument::read)))
            }
            schema::HEALTH => {
                self.health(&chunk);
                Ok(())
            }
            _ => Ok(()),
        };
        Ok(taken)
    }

    fn begin(&mut self, chunk: &Chunk) -> Result<Result<(), Unreadable>, TapeError> {
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
            match &self.session {
                None => {
                    self.masses = document.masses();
                    self.session = Some(document);
                }
                // Every part of a recording that was put together carries it.
                Some(first) if first.run() == document.run() => {}
                Some(_) => self.other = Some(self.walk.stream_at()),
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
        let Found { stretches, revisions, told, health, mut damage } = found;
        damage.extend(walk.damage);
        let Some(session) = session else {
            return Err(TapeError::not_ours(path, no_head(streams, bytes, &damage)));
        };
        let (session, rotor, scales) =
            session.read().map_err(|error| TapeError::not_ours(path, format!("its head is damaged: {error}")))?;
        let stretches = in_order(stretches, &mut damage);
        let written = revisions.len();
        let revisions: Vec<_> = revisions.into_iter().filter_map(|revision| revision.read().ok()).collect();
        let (mut events, mut remarks) = (Vec::new(), Vec::new());
        for told in told {
            match told {
                Told::Event(event) => events.push(event),
                Told::Remark(remark) => remarks.push(remark),
            }
        }
        damage.sort_by_key(|damage| damage.byte);
        lost_steps(&mut damage, &stretches);
        let mut notices = Vec::new();
        if streams > 1 {
            notices.push(format!("{streams} files, one put behind the other"));
        }
        if revisions.len() < written {
            notices.push(format!("{} settings make no sense and were passed over", written - revisions.len()));
        }
        let checksums = walk.sealed;
        Ok(Contents {
            session,
            rotor,
            scales,
            stretches,
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

/// Stretches in the order of their steps, those that hold what others hold already left out.
fn in_order(mut stretches: Vec<Stretch>, damage: &mut Vec<Damage>) -> Vec<Stretch> {
    // What is the same stays in the order of the file: the first is taken.
    stretches.sort_by_key(|stretch| stretch.first.seq);
    let mut kept: Vec<Stretch> = Vec::with_capacity(stretches.len());
    let mut repeated: Vec<(u64, u64)> = Vec::new();
    for stretch in stretches {
        if kept.last().is_some_and(|last| stretch.first.seq <= last.last.seq) {
            repeated.push((stretch.offset, stretch.offset + stretch.bytes));
        } else {
            kept.push(stretch);
        }
    }
    repeated.sort_unstable();
    // One place from the first to the last of them.
    if let (Some((from, _)), Some((_, to))) = (repeated.first(), repeated.last()) {
        damage.push(Damage::at(*from, to - from, DamageKind::Repeated));
    }
    kept
}

/// Says of damage which steps are missing where it is.
fn lost_steps(damage: &mut [Damage], stretches: &[Stretch]) {
    let mut in_file: Vec<&Stretch> = stretches.iter().collect();
    in_file.sort_by_key(|stretch| stretch.offset);
    let mut told = None;
    for damage in damage {
        let after = in_file.partition_point(|stretch| stretch.offset < damage.byte);
        let (Some(before), Some(next)) = (after.checked_sub(1).map(|at| in_file[at]), in_file.get(after)) else {
            continue;
        };
        // Of several places between the same steps the first tells of them.
        if next.first.seq > before.last.seq + 1 && told.replace(after) != Some(after) {
            let from = before.last.seq + 1;
            damage.steps = Some(LostSteps { from, count: next.first.seq - from });
        }
    }
}
