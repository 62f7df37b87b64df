//! What has been read of a file when it was opened, and what reads the rest when it is asked for.

use rotor::{Rotor, Scales};
use wire::Moment;
use wire::message::Health;

use crate::batch::Batch;
use crate::damage::Damage;
use crate::error::TapeError;
use crate::event::{Event, Remark};
use crate::session::{Gap, Revision, Session};
use crate::snapshot::{Snapshot, SnapshotPlace};

/// Where to find a stretch of steps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// In which of the files.
    pub(crate) part: usize,
    pub(crate) offset: u64,
    pub(crate) bytes: u64,
    pub(crate) rows: u64,
    pub(crate) first: Moment,
    pub(crate) last: Moment,
    /// Steps missing within it.
    pub(crate) gaps: Vec<Gap>,
}

/// What has been read of a file when it was opened.
#[derive(Debug)]
pub(crate) struct Contents {
    pub(crate) session: Session,
    pub(crate) rotor: Rotor,
    pub(crate) scales: Option<Scales>,
    /// Ascending in steps.
    pub(crate) stretches: Vec<Stretch>,
    /// Ascending in the step that is made next.
    pub(crate) snapshots: Vec<SnapshotPlace>,
    pub(crate) revisions: Vec<Revision>,
    pub(crate) events: Vec<Event>,
    pub(crate) remarks: Vec<Remark>,
    /// Ascending in steps.
    pub(crate) health: Vec<(Moment, Health)>,
    pub(crate) notices: Vec<String>,
    /// In the order of the files and of their bytes.
    pub(crate) damage: Vec<Damage>,
    /// Whether every message read had a checksum.
    pub(crate) checksums: bool,
    pub(crate) bytes: u64,
}

impl Contents {
    /// Takes what a further part of the same recording holds.
    pub(crate) fn append(&mut self, part: Self) {
        self.stretches.extend(part.stretches);
        self.snapshots.extend(part.snapshots);
        self.revisions.extend(part.revisions);
        // Who begins to listen is told of the last events: a part by another recorder than the one before has some of its too.
        let last = self.events.iter().map(|event| event.number).max().unwrap_or(0);
        self.events.extend(part.events.into_iter().filter(|event| event.number > last));
        self.remarks.extend(part.remarks);
        self.health.extend(part.health);
        self.notices.extend(part.notices);
        self.damage.extend(part.damage);
        self.checksums &= part.checksums;
        self.bytes += part.bytes;
    }
}

/// Decodes stretches and snapshots of an open file.
pub(crate) trait Decoder: Send {
    fn decode(&mut self, stretch: &Stretch) -> Result<Batch, TapeError>;

    fn snapshot(&mut self, place: &SnapshotPlace) -> Result<Snapshot, TapeError>;

    /// Keeps the file open no longer than it is read: there are many.
    fn close(&mut self) {}
}
