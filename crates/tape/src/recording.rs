//! A recording that was opened for reading.
//!
//! The coordinate of everything is the step number: it only rises within a file. What is small (settings, events, how
//! things stood) is read whole when the file is opened; steps are found by an index and decoded when they are asked for, so
//! that a long recording costs no more memory than a short one.

mod as_told;

use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};

use rotor::{Rotor, Scales};
use wire::message::Trip;
use wire::{Channel, State, StepLayout};

use crate::batch::Batch;
use crate::contents::{Contents, Decoder, Stretch};
use crate::damage::Damage;
use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::file_series::FileSeries;
use crate::session::{Gap, Revision, Session, Span};
use crate::snapshot::Snapshot;

/// Decoded stretches that are kept at hand: playing on, and stepping back and forth, decode nothing twice.
const KEPT: usize = 6;

/// A recording, open for reading.
pub struct Recording {
    /// The files, in order; there is one at least.
    paths: Vec<PathBuf>,
    contents: Contents,
    gaps: Vec<Gap>,
    trips: Vec<(u64, Trip)>,
    decoder: Box<dyn Decoder>,
    /// The stretches at hand by their index, the one used last at the end.
    at_hand: Vec<(usize, Batch)>,
}

impl Recording {
    /// Opens a file of this or an earlier version, whole or cut off anywhere, by itself.
    ///
    /// # Errors
    /// No such file, or not one of ours; a later version of the schema; or a build that cannot read recordings.
    pub fn open(path: &Path) -> Result<Self, TapeError> {
        FileSeries::of_all(&[path.to_owned()]).map(Self::new)
    }

    /// Opens the whole recording that was split into several files: given any one of them, or all that shall be taken.
    ///
    /// # Errors
    /// As [`Recording::open`]; or files of different runs, or with steps in common.
    pub fn open_row(paths: &[PathBuf]) -> Result<Self, TapeError> {
        let row = if let [path] = paths { FileSeries::of(path)? } else { FileSeries::of_all(paths)? };
        Ok(Self::new(row))
    }

    fn new(FileSeries { paths, mut contents, decoder }: FileSeries) -> Self {
        contents.revisions.sort_by_key(|r| r.revision);
        // The same settings stand in the head of every part, and events that came twice likewise.
        contents.revisions.dedup_by_key(|r| r.revision);
        contents.events.sort_by_key(|e| e.number);
        contents.events.dedup_by_key(|e| e.number);
        contents.remarks.sort_by_key(|r| r.at.seq);
        once(&mut contents.remarks);
        contents.health.sort_by_key(|(at, _)| at.seq);
        contents.snapshots.sort_by_key(|place| place.next);
        contents.snapshots.dedup_by_key(|place| place.next);
        let gaps = gaps(&contents.stretches);
        let trips = as_told::trips(&contents.events);
        Self { paths, contents, gaps, trips, decoder, at_hand: Vec::new() }
    }

    /// The file, of several the first.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.paths.first().map_or(Path::new(""), PathBuf::as_path)
    }

    /// All its files, in order.
    #[must_use]
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Their size in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.contents.bytes
    }

    /// How its steps are laid out.
    #[must_use]
    pub fn layout(&self) -> StepLayout {
        StepLayout::new(self.rotor().len()).with_bearings(self.session().bearings)
    }

    /// About the whole file.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.contents.session
    }

    /// The rotor, dimensionless.
    #[must_use]
    pub fn rotor(&self) -> &Rotor {
        &self.contents.rotor
    }

    /// The scales of an SI rotor.
    #[must_use]
    pub fn scales(&self) -> Option<Scales> {
        self.contents.scales
    }

    /// The first step on file and the last; `None` if there is none.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        let (first, last) = (self.contents.stretches.first()?, self.contents.stretches.last()?);
        Some(Span { first: first.first, last: last.last })
    }

    /// How many steps are on file.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.contents.stretches.iter().map(|s| s.rows).sum()
    }

    /// Every step on file with a number in `range`, in order, bit for bit as it was sent, added to `into`. Only the
    /// stretches that hold them are read.
    ///
    /// # Errors
    /// The file has changed or cannot be read.
    pub fn steps(&mut self, range: Range<u64>, into: &mut Vec<State>) -> Result<(), TapeError> {
        self.visit(range, 1, |state| {
            into.push(*state);
            ControlFlow::Continue(())
        })
    }

    /// Visits every step on file with a number in `range` that is a multiple of `every`, in order, until told to stop.
    ///
    /// # Errors
    /// As [`Recording::steps`].
    pub fn visit(
        &mut self,
        range: Range<u64>,
        every: u64,
        mut each: impl FnMut(&State) -> ControlFlow<()>,
    ) -> Result<(), TapeError> {
        let run_id = self.contents.session.run_id;
        let first = self.contents.stretches.partition_point(|s| s.last.seq < range.start);
        for index in first..self.contents.stretches.len() {
            if self.contents.stretches[index].first.seq >= range.end {
                break;
            }
            let batch = self.stretch(index)?;
            let from = batch.seq.partition_point(|seq| *seq < range.start);
            let to = batch.seq.partition_point(|seq| *seq < range.end);
            for row in from..to {
                if batch.seq[row].is_multiple_of(every.max(1)) && each(&batch.state(row, run_id)).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The last step on file that was due at or before `wall_ns`; the first if there is none before.
    ///
    /// # Errors
    /// As [`Recording::steps`], or there are no steps.
    pub fn seq_at_wall(&mut self, wall_ns: u64) -> Result<u64, TapeError> {
        let index = self.contents.stretches.partition_point(|s| s.first.wall_ns <= wall_ns).max(1) - 1;
        let batch = self.stretch(index)?;
        let row = batch.wall_ns.partition_point(|at| *at <= wall_ns).max(1) - 1;
        Ok(batch.seq[row])
    }

    /// The last step on file at or before `tau`, in the last stretch of time between two restarts that reaches it; the
    /// first step if none does.
    ///
    /// # Errors
    /// As [`Recording::steps`], or there are no steps.
    pub fn seq_at_tau(&mut self, tau: f64) -> Result<u64, TapeError> {
        for index in (0..self.contents.stretches.len()).rev() {
            // A restart may lie within a stretch: both its ends are then no bound, and its rows have to tell.
            let Stretch { first, last, .. } = &self.contents.stretches[index];
            if first.tau <= last.tau && first.tau > tau {
                continue;
            }
            let batch = self.stretch(index)?;
            let times = batch.column(Channel::Tau, 0);
            let found = (0..batch.len()).rev().find(|row| {
                let next_is_later = times.get(row + 1).is_none_or(|next| *next > tau || *next < times[*row]);
                times[*row] <= tau && next_is_later
            });
            if let Some(row) = found {
                return Ok(batch.seq[row]);
            }
        }
        self.span().map(|span| span.first.seq).ok_or_else(|| TapeError::read(self.path(), "there are no steps in it"))
    }

    /// The settings in force at step `seq`; before the first on file, the first.
    #[must_use]
    pub fn settings_at(&self, seq: u64) -> Option<&Revision> {
        let after = self.contents.revisions.partition_point(|r| r.from <= seq);
        self.contents.revisions.get(after.max(1) - 1)
    }

    /// How many snapshots of the machine are on file.
    #[must_use]
    pub fn snapshots(&self) -> usize {
        self.contents.snapshots.len()
    }

    /// The last snapshot from which step `seq` is reached; `None` if there is none.
    ///
    /// # Errors
    /// As [`Recording::steps`].
    pub fn snapshot_before(&mut self, seq: u64) -> Result<Option<Snapshot>, TapeError> {
        let after = self.contents.snapshots.partition_point(|place| place.next <= seq);
        let place = after.checked_sub(1).map(|at| self.contents.snapshots[at]);
        place.map(|place| self.decoder.snapshot(&place)).transpose()
    }

    /// From which step on steps are how long, in `tau`, as far as snapshots tell.
    #[must_use]
    pub fn paces(&self) -> Vec<(u64, f64)> {
        let mut paces: Vec<(u64, f64)> = Vec::new();
        for place in &self.contents.snapshots {
            if place.dtau.is_finite() && paces.last().is_none_or(|(_, dtau)| *dtau != place.dtau) {
                paces.push((place.next, place.dtau));
            }
        }
        paces
    }

    /// Every settings on file, in order.
    #[must_use]
    pub fn revisions(&self) -> &[Revision] {
        &self.contents.revisions
    }

    /// What happened on the bench, in order. A recording that began later holds some that happened before.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.contents.events
    }

    /// What the recorder has said.
    #[must_use]
    pub fn remarks(&self) -> &[Remark] {
        &self.contents.remarks
    }

    /// Steps that are missing between the first and the last.
    #[must_use]
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// Where the files are not what was written; in the order of the files and of their bytes.
    #[must_use]
    pub fn damage(&self) -> &[Damage] {
        &self.contents.damage
    }

    /// Whether all that is on file has checksums; without them a changed number reads as another number.
    #[must_use]
    pub fn has_checksums(&self) -> bool {
        self.contents.checksums
    }

    /// What a reader should be told: damaged, steps missing, begun late.
    #[must_use]
    pub fn notices(&self) -> Vec<String> {
        let mut notices = Damage::notices(self.damage(), self.paths.len() > 1);
        notices.extend(self.contents.notices.iter().cloned());
        if let Some(span) = self.span().filter(|span| span.first.seq > 0) {
            notices.push(format!("begins at step {}: the recorder came later than the simulation", span.first.seq));
        }
        let missing: u64 = self.gaps.iter().map(|gap| gap.count).sum();
        if missing > 0 {
            let (stretches, first) = (self.gaps.len(), self.gaps[0].from);
            notices.push(format!("{missing} steps are missing in {stretches} places, the first at step {first}"));
        }
        if !self.contents.remarks.iter().any(|r| matches!(r.what, What::Ends(_) | What::Continues(_))) {
            notices.push("no end mark: the recorder was killed, or is still at work".to_owned());
        }
        notices
    }

    /// A stretch, decoded.
    fn stretch(&mut self, index: usize) -> Result<&Batch, TapeError> {
        let at = match self.at_hand.iter().position(|(held, _)| *held == index) {
            Some(at) => at,
            None => {
                let stretch = self.contents.stretches.get(index);
                let stretch = stretch.ok_or_else(|| TapeError::read(self.path(), "there are no steps in it"))?;
                let batch = self.decoder.decode(stretch)?;
                if self.at_hand.len() == KEPT {
                    self.at_hand.remove(0);
                }
                self.at_hand.push((index, batch));
                self.at_hand.len() - 1
            }
        };
        // Used last, dropped last.
        let held = self.at_hand.remove(at);
        self.at_hand.push(held);
        Ok(&self.at_hand[self.at_hand.len() - 1].1)
    }
}

/// Alarms in force stand at the head of every part again: each is kept once.
fn once(remarks: &mut Vec<Remark>) {
    let mut kept: Vec<Remark> = Vec::with_capacity(remarks.len());
    for remark in remarks.drain(..) {
        let same_step = kept.iter().rev().take_while(|other| other.at.seq == remark.at.seq);
        let is_alarm = matches!(remark.what, What::Alarm(_));
        if !(is_alarm && same_step.into_iter().any(|other| other.what == remark.what)) {
            kept.push(remark);
        }
    }
    *remarks = kept;
}

/// What is missing between and within stretches.
fn gaps(stretches: &[Stretch]) -> Vec<Gap> {
    let mut gaps = Vec::new();
    let mut expected = stretches.first().map(|s| s.first.seq);
    for stretch in stretches {
        let next = expected.unwrap_or_default();
        if stretch.first.seq > next {
            gaps.push(Gap { from: next, count: stretch.first.seq - next });
        }
        gaps.extend(&stretch.gaps);
        expected = Some(stretch.last.seq + 1);
    }
    gaps
}
