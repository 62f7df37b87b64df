//! The reader: goes through the messages of a file once, keeps what is small, and notes where the steps are. Needs no
//! footer, so that a file cut off anywhere is read like a whole one.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use rerun::archetypes::Scalars;
use rerun::external::arrow::array::{Array, Float64Array};
use rerun::external::re_log_encoding::{Decodable, Decoder, MessageHeader, MessageKind, StreamFooter, StreamHeader};
use rerun::log::{Chunk, LogMsg};

use super::{chunks, write};
use crate::batch::Batch;
use crate::contents::{Contents, Decoder as StretchDecoder, Stretch};
use crate::document::event::{EventDocument, Told};
use crate::document::{self, RevisionDocument, SessionDocument};
use crate::error::TapeError;
use crate::schema;
use crate::session::Gap;

/// A message that claims to be larger than this is not one.
const MOST_BYTES: u64 = 1 << 31;

/// Opens a recording: what is small in it, and what decodes the rest.
///
/// # Errors
/// No such file, no recording of ours, or one of a later schema.
pub(crate) fn open(path: &Path) -> Result<(Contents, Steps), TapeError> {
    let file = File::open(path).map_err(|error| TapeError::not_ours(path, error.to_string()))?;
    if !file.metadata().is_ok_and(|found| found.is_file()) {
        return Err(TapeError::not_ours(path, "is no file: expected an .rrd recording"));
    }
    let bytes = file.metadata().map_or(0, |found| found.len());
    let reader = BufReader::with_capacity(1 << 20, file.try_clone().map_err(|error| TapeError::read(path, error))?);
    let mut scan = Scan::new(path, reader, bytes);
    scan.run()?;
    let header = scan.header.clone();
    let contents = scan.contents()?;
    let masses = contents.rotor.len();
    Ok((contents, Steps { path: path.to_owned(), file: Some(file), header, masses }))
}

/// The run that a recording of ours is of, from its head alone.
pub(crate) fn run_of(path: &Path) -> Option<u64> {
    let file = File::open(path).ok()?;
    let bytes = file.metadata().ok().filter(std::fs::Metadata::is_file)?.len();
    let mut scan = Scan::new(path, BufReader::new(file), bytes);
    scan.head_only = true;
    scan.run().ok()?;
    let (session, ..) = scan.session?.read().ok()?;
    Some(session.run_id)
}

/// Decodes one message, given with its header.
fn decode(stream_header: &[u8], message: Vec<u8>) -> Result<Option<LogMsg>, String> {
    let mut decoder = Decoder::<LogMsg>::new();
    decoder.push_byte_chunk(stream_header.to_vec());
    decoder.push_byte_chunk(message);
    decoder.try_read().map_err(|error| error.to_string())
}

/// The chunk in a message of a recording; `None` for layouts and the like.
fn chunk_of(stream_header: &[u8], message: Vec<u8>) -> Result<Option<Chunk>, String> {
    match decode(stream_header, message)? {
        Some(LogMsg::ArrowMsg(store, message)) if !store.is_blueprint() => {
            Chunk::from_arrow_msg(&message).map(Some).map_err(|error| error.to_string())
        }
        _ => Ok(None),
    }
}

/// Decodes stretches of steps from an open file.
pub(crate) struct Steps {
    path: PathBuf,
    /// `None` if it is opened whenever it is read.
    file: Option<File>,
    header: Vec<u8>,
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
        let chunk = chunk_of(&self.header, message).and_then(|chunk| chunk.ok_or_else(|| "no steps there".to_owned()));
        let batch = chunk.and_then(|chunk| chunks::read_steps(&chunk, self.masses));
        batch.map_err(|problem| TapeError::read(&self.path, problem))
    }

    fn close(&mut self) {
        self.file = None;
    }
}

/// One pass through a file.
struct Scan<'a> {
    path: &'a Path,
    reader: BufReader<File>,
    bytes: u64,
    at: u64,
    header: Vec<u8>,
    session: Option<SessionDocument>,
    masses: usize,
    found: Found,
    damaged: u64,
    /// Nothing is read beyond the document about the whole file.
    head_only: bool,
}

#[derive(Default)]
struct Found {
    stretches: Vec<Stretch>,
    revisions: Vec<RevisionDocument>,
    told: Vec<Told>,
    health: Vec<(wire::Moment, wire::message::Health)>,
    notices: Vec<String>,
}

impl<'a> Scan<'a> {
    fn new(path: &'a Path, reader: BufReader<File>, bytes: u64) -> Self {
        Self {
            path,
            reader,
            bytes,
            at: 0,
            header: Vec::new(),
            session: None,
            masses: 0,
            found: Found::default(),
            damaged: 0,
            head_only: false,
        }
    }

    fn left(&self) -> u64 {
        self.bytes.saturating_sub(self.at)
    }

    fn take(&mut self, bytes: u64) -> Result<Vec<u8>, TapeError> {
        let mut taken = vec![0; usize::try_from(bytes).unwrap_or_default()];
        self.reader.read_exact(&mut taken).map_err(|error| TapeError::read(self.path, error))?;
        self.at += bytes;
        Ok(taken)
    }

    fn run(&mut self) -> Result<(), TapeError> {
        self.stream_header()?;
        while self.left() > 0 && !(self.head_only && self.session.is_some()) {
            if self.left() < MessageHeader::ENCODED_SIZE_BYTES as u64 {
                self.cut_off(self.at);
                break;
            }
            let start = self.at;
            let header = self.take(MessageHeader::ENCODED_SIZE_BYTES as u64)?;
            let Ok(MessageHeader { kind, len }) = MessageHeader::from_rrd_bytes(&header) else {
                let notice =
                    format!("damaged at byte {start}: the {} bytes from there on are not read", self.bytes - start);
                self.found.notices.push(notice);
                break;
            };
            if len > self.left() || len > MOST_BYTES {
                self.cut_off(start);
                break;
            }
            match kind {
                MessageKind::End => {
                    if !self.skip_end(len)? {
                        break;
                    }
                }
                MessageKind::ArrowMsg => {
                    let mut message = header;
                    message.extend(self.take(len)?);
                    self.message(start, message)?;
                }
                MessageKind::SetStoreInfo | MessageKind::BlueprintActivationCommand => self.skip(len)?,
            }
        }
        if self.damaged > 0 {
            self.found.notices.push(format!("{} messages are damaged and were passed over", self.damaged));
        }
        Ok(())
    }

    fn stream_header(&mut self) -> Result<(), TapeError> {
        let expected = "expected an .rrd recording of whirl";
        if self.left() < StreamHeader::ENCODED_SIZE_BYTES as u64 {
            return Err(TapeError::not_ours(self.path, format!("{} bytes are too short: {expected}", self.bytes)));
        }
        let header = self.take(StreamHeader::ENCODED_SIZE_BYTES as u64)?;
        StreamHeader::from_rrd_bytes(&header)
            .and_then(StreamHeader::to_version_and_options)
            .map_err(|error| TapeError::not_ours(self.path, format!("{error}: {expected}")))?;
        self.header = header;
        Ok(())
    }

    fn skip(&mut self, bytes: u64) -> Result<(), TapeError> {
        self.at += bytes;
        self.reader.seek(SeekFrom::Start(self.at)).map(drop).map_err(|error| TapeError::read(self.path, error))
    }

    fn cut_off(&mut self, from: u64) {
        let rest = self.bytes - from;
        self.found.notices.push(format!("cut off: the last {rest} bytes are part of a message that is not whole"));
    }

    /// Passes over an end. Whether another stream follows it, as when files are put one after the other.
    fn skip_end(&mut self, len: u64) -> Result<bool, TapeError> {
        self.skip(len)?;
        let footer = if len > 0 { StreamFooter::ENCODED_SIZE_BYTES as u64 } else { 0 };
        if self.left() < footer {
            self.cut_off(self.at);
            return Ok(false);
        }
        self.skip(footer)?;
        if self.left() == 0 {
            return Ok(false);
        }
        self.stream_header()?;
        Ok(true)
    }

    fn message(&mut self, start: u64, message: Vec<u8>) -> Result<(), TapeError> {
        let bytes = message.len() as u64;
        let chunk = match chunk_of(&self.header, message) {
            Ok(Some(chunk)) => chunk,
            Ok(None) => return Ok(()),
            Err(_) => {
                self.damaged += 1;
                return Ok(());
            }
        };
        let entity = chunk.entity_path().to_string();
        match entity.trim_start_matches('/') {
            schema::SESSION => self.begin(&chunk)?,
            schema::STEPS => match chunks::read_steps(&chunk, self.masses) {
                Ok(batch) => self.stretch(start, bytes, &batch),
                Err(_) => self.damaged += 1,
            },
            schema::SETTINGS => {
                for text in chunks::documents(&chunk) {
                    match document::parse(&text) {
                        Ok(revision) => self.found.revisions.push(revision),
                        Err(_) => self.damaged += 1,
                    }
                }
            }
            schema::EVENTS => {
                for text in chunks::documents(&chunk) {
                    match document::parse::<EventDocument>(&text) {
                        Ok(event) => self.found.told.push(event.read()),
                        Err(_) => self.damaged += 1,
                    }
                }
            }
            schema::HEALTH => self.health(&chunk),
            _ => {}
        }
        Ok(())
    }

    fn begin(&mut self, chunk: &Chunk) -> Result<(), TapeError> {
        #[derive(serde::Deserialize)]
        struct Version {
            schema: u32,
        }
        for text in chunks::documents(chunk) {
            let Version { schema } = document::parse(&text).map_err(|error| self.not_ours(&error.to_string()))?;
            if schema > schema::VERSION {
                let newest = schema::VERSION;
                return Err(self.not_ours(&format!(
                    "recorded by a later whirl (schema {schema}; this one reads up to {newest}): read it with that one"
                )));
            }
            let document: SessionDocument =
                document::parse(&text).map_err(|error| self.not_ours(&error.to_string()))?;
            self.masses = document.masses();
            // Every part of a recording that was put together carries it.
            self.session.get_or_insert(document);
        }
        Ok(())
    }

    fn not_ours(&self, problem: &str) -> TapeError {
        TapeError::not_ours(self.path, problem)
    }

    fn stretch(&mut self, offset: u64, bytes: u64, batch: &Batch) {
        let Some((first, last)) = batch.span() else { return };
        let pairs = batch.seq.windows(2).filter(|pair| pair[1] > pair[0] + 1);
        let gaps = pairs.map(|pair| Gap { from: pair[0] + 1, count: pair[1] - pair[0] - 1 }).collect();
        self.found.stretches.push(Stretch { part: 0, offset, bytes, rows: batch.len() as u64, first, last, gaps });
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

    fn contents(self) -> Result<Contents, TapeError> {
        let path = self.path;
        let Some(session) = self.session else {
            let notices = self.found.notices.join("; ");
            let why = if notices.is_empty() { "was not made by whirl".to_owned() } else { notices };
            return Err(TapeError::not_ours(path, format!("nothing of whirl's is in it ({why})")));
        };
        let (session, rotor, scales) =
            session.read().map_err(|error| TapeError::not_ours(path, format!("its head is damaged: {error}")))?;
        let Found { mut stretches, revisions, told, health, mut notices } = self.found;
        stretches.sort_by_key(|s| s.first.seq);
        let count = revisions.len();
        let revisions: Vec<_> = revisions.into_iter().filter_map(|r| r.read().ok()).collect();
        if revisions.len() < count {
            notices.push(format!("{} settings are damaged and were passed over", count - revisions.len()));
        }
        let (mut events, mut remarks) = (Vec::new(), Vec::new());
        for told in told {
            match told {
                Told::Event(event) => events.push(event),
                Told::Remark(remark) => remarks.push(remark),
            }
        }
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
            bytes: self.bytes,
        })
    }
}
