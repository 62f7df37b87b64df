//! Which files a recording is kept in: one, a new one whenever it grows too large, the last so many minutes, or the
//! seconds around each trip. Knows nothing of how a file is written.

mod keep;
mod place;
mod wait;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use alarms::Limits;
use rotor::Difference;
use wire::{BenchStatus, Happening, Keeping, Moment};

use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::session::Revision;
use crate::sink::{self, Head, Item, Open, Sink};

pub use keep::Keep;
use place::{check, clear, free_bytes, name};
use wait::Wait;

/// Puts what is recorded into files.
pub struct FileRotation {
    open: Open,
    path: PathBuf,
    subject: Subject,
    keep: Keep,
    /// How things stand now; `None` before the first run.
    head: Option<Head>,
    file: Option<CurrentFile>,
    /// Files made so far.
    parts: u32,
    /// Finished, oldest first.
    done: VecDeque<Done>,
    rows: u64,
    bytes: u64,
    last: Moment,
    wait: Wait,
}

/// Whose recording it is.
#[derive(Debug)]
struct Subject {
    bench: String,
    limits: Limits,
}

impl Subject {
    fn head(&self, bench_status: Box<BenchStatus>) -> Head {
        Head::live(bench_status, &self.bench).judged_by(self.limits.clone())
    }
}

struct CurrentFile {
    path: PathBuf,
    sink: Box<dyn Sink>,
    began_ns: Option<u64>,
}

#[derive(Debug)]
struct Done {
    path: PathBuf,
    last_ns: u64,
    bytes: u64,
}

impl FileRotation {
    /// A rotation on `path`, for a bench called `bench` that is held against `limits`. Nothing is written yet.
    ///
    /// # Errors
    /// The path is taken or no place for a file, or this build cannot record.
    pub fn new(path: &Path, bench: &str, keep: Keep, limits: Limits) -> Result<Self, TapeError> {
        sink::available()?;
        Self::with(path, Subject { bench: bench.to_owned(), limits }, keep, Box::new(sink::create))
    }

    /// The same into sinks that `open` makes; without a path they are no files, and everything goes into one.
    ///
    /// # Errors
    /// As [`FileRotation::new`].
    pub(crate) fn into_sinks(
        path: Option<&Path>,
        bench: &str,
        keep: Keep,
        limits: Limits,
        open: Open,
    ) -> Result<Self, TapeError> {
        let subject = Subject { bench: bench.to_owned(), limits };
        match path {
            Some(path) => Self::with(path, subject, keep, open),
            // A name for messages alone; where there is no file no disk can be full.
            None => Ok(Self::unchecked(Path::new("/dev/null"), subject, Keep { min_free: 0, ..Keep::default() }, open)),
        }
    }

    fn with(path: &Path, subject: Subject, keep: Keep, open: Open) -> Result<Self, TapeError> {
        check(path, &keep)?;
        Ok(Self::unchecked(path, subject, keep, open))
    }

    fn unchecked(path: &Path, subject: Subject, keep: Keep, open: Open) -> Self {
        Self {
            open,
            path: path.to_owned(),
            subject,
            keep,
            head: None,
            file: None,
            parts: 0,
            done: VecDeque::new(),
            rows: 0,
            bytes: 0,
            last: Moment::default(),
            wait: Wait::default(),
        }
    }

    /// Steps in the files.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Bytes in the files, those that were let go not counted.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes + self.file.as_ref().map_or(0, |part| part.sink.bytes())
    }

    /// Files made so far.
    #[must_use]
    pub fn parts(&self) -> u32 {
        self.parts
    }

    /// Files that are finished, oldest first.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.done.iter().map(|done| done.path.as_path())
    }

    /// Puts one thing where it belongs.
    ///
    /// # Errors
    /// A file cannot be made or written, or the disk has too little room left.
    pub(crate) fn take(&mut self, item: Item) -> Result<(), TapeError> {
        match self.keep.keeping {
            Keeping::Pretrigger(seconds) => self.take_waiting(item, seconds),
            _ => self.put(item),
        }
    }

    /// Ends the recording, for a reason that the file tells. Returns the files that it has become.
    ///
    /// # Errors
    /// As [`FileRotation::take`].
    pub fn finish(self, why: &str) -> Result<Vec<PathBuf>, TapeError> {
        self.end(What::Ends(why.to_owned()))
    }

    /// The same for a recording that somebody else has going on in the file `next` beside it.
    ///
    /// # Errors
    /// As [`FileRotation::take`].
    pub(crate) fn finish_before(self, next: &Path) -> Result<Vec<PathBuf>, TapeError> {
        self.end(What::Continues(name(next)))
    }

    fn end(mut self, how: What) -> Result<Vec<PathBuf>, TapeError> {
        self.close(how)?;
        let parts: Vec<PathBuf> = self.done.iter().map(|done| done.path.clone()).collect();
        if !matches!(self.keep.keeping, Keeping::Last(_)) || parts.is_empty() {
            return Ok(parts);
        }
        clear(&self.path, self.keep.existing)?;
        sink::join(&parts, &self.path)?;
        for part in &parts {
            // The whole is there: a part that stays behind is a nuisance and no loss.
            let _ = std::fs::remove_file(part);
        }
        Ok(vec![self.path])
    }

    fn put(&mut self, item: Item) -> Result<(), TapeError> {
        match item {
            Item::Run(bench_status, at) => {
                if self.file.is_some() {
                    let next = self.next_path();
                    self.close(What::Continues(name(&next)))?;
                }
                self.last = at;
                self.head = Some(self.subject.head(bench_status));
                self.begin()
            }
            Item::Steps(batch) => {
                let Some((first, last)) = batch.span() else { return Ok(()) };
                self.last = last;
                self.make_room(first)?;
                let Some(part) = &mut self.file else { return Ok(()) };
                part.began_ns.get_or_insert(first.wall_ns);
                part.sink.steps(&batch)?;
                self.rows += batch.len() as u64;
                Ok(())
            }
            Item::Event(event) => {
                let mut told = Event::from(&*event);
                if let Some(head) = self.head.as_ref().filter(|head| event.revision > head.bench_status.revision) {
                    let (before, after) = (head.bench_status.settings.get().clone(), event.settings.get().clone());
                    told.change = Difference::between(&before, &after).to_string();
                }
                let head = self.head.as_mut();
                let revision = head.and_then(|head| head.earlier(&event).or_else(|| head.follow(&event)));
                if let Some(revision) = revision {
                    self.revision(&revision, told.at)?;
                }
                self.file.as_mut().map_or(Ok(()), |part| part.sink.event(&told))
            }
            Item::BenchStatus(bench_status, at) => {
                let revision = self.catch_up(bench_status);
                if let Some(revision) = revision {
                    self.revision(&revision, at)?;
                }
                let (Some(part), Some(head)) = (&mut self.file, &self.head) else { return Ok(()) };
                part.sink.health(&head.bench_status, at)
            }
            Item::Snapshot(snapshot, at) => {
                if let Some(head) = &mut self.head {
                    head.snapshot = Some((snapshot.clone(), at));
                }
                self.file.as_mut().map_or(Ok(()), |part| part.sink.snapshot(snapshot, at))
            }
            Item::Remark(remark) => {
                if let Some(head) = &mut self.head {
                    head.heed(&remark);
                }
                self.file.as_mut().map_or(Ok(()), |part| part.sink.remark(&remark))
            }
        }
    }

    fn revision(&mut self, revision: &Revision, at: Moment) -> Result<(), TapeError> {
        self.file.as_mut().map_or(Ok(()), |part| part.sink.revision(revision, at))
    }

    /// Takes over a bench status. Settings in it whose event has not come, which only a very busy bench can bring about, are
    /// recorded from here.
    fn catch_up(&mut self, bench_status: Box<BenchStatus>) -> Option<Revision> {
        let head = self.head.as_mut()?;
        if bench_status.revision <= head.bench_status.revision {
            // The event was faster: its settings stay.
            let newest = std::mem::replace(&mut head.bench_status, bench_status);
            head.bench_status.revision = newest.revision;
            head.bench_status.applied_at_step = newest.applied_at_step;
            head.bench_status.changed_by = newest.changed_by;
            head.bench_status.settings = newest.settings;
            return None;
        }
        head.bench_status = bench_status;
        Some(head.revision())
    }

    /// Begins the next file, with all that makes it readable alone.
    fn begin(&mut self) -> Result<(), TapeError> {
        let Some(head) = &self.head else { return Ok(()) };
        let path = self.next_path();
        clear(&path, self.keep.existing)?;
        let mut sink = (self.open)(&path, head)?;
        self.parts += 1;
        sink.revision(&head.revision(), self.last)?;
        sink.remark(&Remark { at: self.last, what: What::Begins })?;
        for remark in &head.alarms {
            sink.remark(remark)?;
        }
        if let Some((snapshot, at)) = &head.snapshot {
            sink.snapshot(snapshot.clone(), *at)?;
        }
        self.file = Some(CurrentFile { path, sink, began_ns: None });
        Ok(())
    }

    fn close(&mut self, why: What) -> Result<(), TapeError> {
        let Some(mut part) = self.file.take() else { return Ok(()) };
        part.sink.remark(&Remark { at: self.last, what: why })?;
        let bytes = part.sink.finish()?;
        self.bytes += bytes;
        self.done.push_back(Done { path: part.path, last_ns: self.last.wall_ns, bytes });
        Ok(())
    }

    /// Turns to the next file where that is due, lets go of what is too old, and looks at the disk.
    fn make_room(&mut self, now: Moment) -> Result<(), TapeError> {
        let Some(part) = &self.file else { return Ok(()) };
        let window = if let Keeping::Last(seconds) = self.keep.keeping { Some(seconds) } else { None };
        let age = part.began_ns.map_or(0.0, |began| now.wall_ns.saturating_sub(began) as f64 / 1e9);
        let too_old = window.is_some_and(|window| age >= window / Keep::ROLLING_PARTS);
        let too_large = self.keep.split.is_some_and(|split| part.sink.bytes() >= split);
        if too_old || too_large {
            let next = self.next_path();
            self.close(What::Continues(name(&next)))?;
            self.begin()?;
        }
        if let Some(window) = window {
            let oldest = now.wall_ns.saturating_sub((window * 1e9) as u64);
            while let Some(done) = self.done.pop_front_if(|done| done.last_ns < oldest) {
                self.bytes -= done.bytes;
                std::fs::remove_file(&done.path).map_err(|error| self.stopped(error.to_string()))?;
            }
        }
        let free = free_bytes(&self.path);
        if free.is_some_and(|free| free < self.keep.min_free) {
            self.close(What::Ends("the disk is nearly full".into()))?;
            let megabytes = |bytes: u64| bytes / 1_000_000;
            let (left, limit) = (megabytes(free.unwrap_or_default()), megabytes(self.keep.min_free));
            return Err(self.stopped(format!("the disk has {left} MB left, fewer than the {limit} MB to be kept free")));
        }
        Ok(())
    }

    fn stopped(&self, problem: String) -> TapeError {
        TapeError::Stopped { path: self.path.clone(), problem, bytes: self.bytes() }
    }

    /// The name of the next file: as given, then with `-2`, `-3` before the ending; `-1` too where parts will be joined.
    fn next_path(&self) -> PathBuf {
        let number = self.parts + 1;
        if number == 1 && !matches!(self.keep.keeping, Keeping::Last(_)) {
            return self.path.clone();
        }
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        self.path.with_file_name(format!("{stem}-{number}.rrd"))
    }

    /// Holds what comes until a trip, and writes from the last `seconds` before it to some after it.
    fn take_waiting(&mut self, item: Item, seconds: f64) -> Result<(), TapeError> {
        // Steps come many at once: all of them are taken that hold one of the time after a trip.
        let (first, last) = match &item {
            Item::Steps(batch) => batch.span().unwrap_or((self.last, self.last)),
            _ => (self.last, self.last),
        };
        let (first_ns, now_ns) = (first.wall_ns, last.wall_ns);
        let window_ns = (seconds * 1e9) as u64;
        let trip_ns = match &item {
            Item::Event(event) if matches!(event.happening(), Some(Happening::Tripped(_))) => {
                Some(event.wall_ns.max(now_ns))
            }
            _ => None,
        };
        let new_run = matches!(item, Item::Run(..));
        if self.wait.until_ns.is_some_and(|until| first_ns > until) || new_run {
            self.close(What::Ends(format!("{} s after the trip are over", Keep::after_trip(seconds))))?;
            self.wait = Wait { head: self.head.take(), ..Wait::default() };
        }
        if self.wait.until_ns.is_some() {
            if let Some(trip_ns) = trip_ns {
                self.wait.until_ns = Some(trip_ns + after_ns(seconds));
            }
            return self.put(item);
        }
        if let Item::Steps(batch) = &item {
            self.last = batch.span().map_or(self.last, |(_, last)| last);
        }
        if new_run {
            // Nobody asks any more how the run before it stood.
            self.wait = Wait::default();
        }
        self.wait.items.push_back(item);
        self.wait.let_go(now_ns.saturating_sub(window_ns), &self.subject);
        if let Some(trip_ns) = trip_ns {
            self.wait.until_ns = Some(trip_ns + after_ns(seconds));
            self.head = self.wait.head.take();
            self.begin()?;
            for item in std::mem::take(&mut self.wait.items) {
                self.put(item)?;
            }
        }
        Ok(())
    }
}

fn after_ns(seconds: f64) -> u64 {
    (Keep::after_trip(seconds) * 1e9) as u64
}

#[cfg(test)]
mod tests;
