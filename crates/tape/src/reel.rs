//! Which files a recording is kept in: one, a new one whenever it grows too large, the last so many minutes, or the
//! seconds around each trip. Knows nothing of how a file is written.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use alarms::Limits;
use rotor::Difference;
use wire::{Bulletin, Happening, Keeping, Moment};

use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::recording::Revision;
use crate::sink::{self, Head, Item, Sink};

/// What is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Keep {
    /// Everything, the last so many seconds, or so many before a trip.
    pub keeping: Keeping,
    /// A new file whenever one has so many bytes.
    pub split: Option<u64>,
    /// Recording ends in good order when the disk has fewer bytes free than this.
    pub min_free: u64,
}

impl Keep {
    /// The free space that a recording leaves on its disk unless told otherwise, in bytes.
    pub const MIN_FREE: u64 = 200_000_000;
    /// A rolling recording is this many files, so that it is longer than asked for by at most one of them.
    const ROLLING_PARTS: f64 = 8.0;
    /// A trip is followed for as long as before it was looked back, but no longer than this, in seconds.
    const AFTER_TRIP: f64 = 10.0;
}

impl Default for Keep {
    fn default() -> Self {
        Self { keeping: Keeping::All, split: None, min_free: Self::MIN_FREE }
    }
}

/// Makes the file at a path.
type Open = Box<dyn FnMut(&Path, &Head) -> Result<Box<dyn Sink>, TapeError> + Send>;

/// Puts what is recorded into files.
pub struct Reel {
    open: Open,
    path: PathBuf,
    subject: Subject,
    keep: Keep,
    /// How things stand now; `None` before the first run.
    head: Option<Head>,
    file: Option<Part>,
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
    fn head(&self, bulletin: Box<Bulletin>) -> Head {
        Head::live(bulletin, &self.bench).judged_by(self.limits.clone())
    }
}

struct Part {
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

/// What waits for a trip.
#[derive(Default)]
struct Wait {
    /// As things stood when the oldest item came.
    head: Option<Head>,
    items: VecDeque<Item>,
    /// A trip has come: its file is written until then.
    until_ns: Option<u64>,
}

impl Reel {
    /// A reel on `path`, for a bench called `bench` that is held against `limits`. Nothing is written yet.
    ///
    /// # Errors
    /// The path is taken or no place for a file, or this build cannot record.
    pub fn new(path: &Path, bench: &str, keep: Keep, limits: Limits) -> Result<Self, TapeError> {
        sink::available()?;
        Self::with(path, Subject { bench: bench.to_owned(), limits }, keep, Box::new(sink::create))
    }

    fn with(path: &Path, subject: Subject, keep: Keep, open: Open) -> Result<Self, TapeError> {
        check(path)?;
        Ok(Self {
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
        })
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
    /// As [`Reel::take`].
    pub fn finish(mut self, why: &str) -> Result<Vec<PathBuf>, TapeError> {
        self.close(What::Ends(why.to_owned()))?;
        let parts: Vec<PathBuf> = self.done.iter().map(|done| done.path.clone()).collect();
        if !matches!(self.keep.keeping, Keeping::Last(_)) || parts.is_empty() {
            return Ok(parts);
        }
        sink::join(&parts, &self.path)?;
        for part in &parts {
            // The whole is there: a part that stays behind is a nuisance and no loss.
            let _ = std::fs::remove_file(part);
        }
        Ok(vec![self.path])
    }

    fn put(&mut self, item: Item) -> Result<(), TapeError> {
        match item {
            Item::Run(bulletin, at) => {
                if self.file.is_some() {
                    let next = self.next_path();
                    self.close(What::Continues(name(&next)))?;
                }
                self.last = at;
                self.head = Some(self.subject.head(bulletin));
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
                if let Some(head) = self.head.as_ref().filter(|head| event.revision > head.bulletin.revision) {
                    let (before, after) = (head.bulletin.settings.unpack(), event.settings.unpack());
                    told.change = Difference::between(&before, &after).to_string();
                }
                let head = self.head.as_mut();
                let revision = head.and_then(|head| head.earlier(&event).or_else(|| head.follow(&event)));
                if let Some(revision) = revision {
                    self.revision(&revision, told.at)?;
                }
                self.file.as_mut().map_or(Ok(()), |part| part.sink.event(&told))
            }
            Item::Bulletin(bulletin, at) => {
                let revision = self.catch_up(bulletin);
                if let Some(revision) = revision {
                    self.revision(&revision, at)?;
                }
                let (Some(part), Some(head)) = (&mut self.file, &self.head) else { return Ok(()) };
                part.sink.health(&head.bulletin, at)
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

    /// Takes over a bulletin. Settings in it whose event has not come, which only a very busy bench can bring about, are
    /// recorded from here.
    fn catch_up(&mut self, bulletin: Box<Bulletin>) -> Option<Revision> {
        let head = self.head.as_mut()?;
        if bulletin.revision <= head.bulletin.revision {
            // The event was faster: its settings stay.
            let newest = std::mem::replace(&mut head.bulletin, bulletin);
            head.bulletin.settings = newest.settings;
            head.bulletin.revision = newest.revision;
            head.bulletin.applied_at_step = newest.applied_at_step;
            head.bulletin.changed_by = newest.changed_by;
            return None;
        }
        head.bulletin = bulletin;
        Some(head.revision())
    }

    /// Begins the next file, with all that makes it readable alone.
    fn begin(&mut self) -> Result<(), TapeError> {
        let Some(head) = &self.head else { return Ok(()) };
        let path = self.next_path();
        let mut sink = (self.open)(&path, head)?;
        self.parts += 1;
        sink.revision(&head.revision(), self.last)?;
        sink.remark(&Remark { at: self.last, what: What::Begins })?;
        for remark in &head.standing {
            sink.remark(remark)?;
        }
        self.file = Some(Part { path, sink, began_ns: None });
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
        let now_ns = match &item {
            Item::Steps(batch) => batch.span().map_or(self.last, |(_, last)| last).wall_ns,
            _ => self.last.wall_ns,
        };
        let window_ns = (seconds * 1e9) as u64;
        let trips = matches!(&item, Item::Event(event) if matches!(event.happening(), Some(Happening::Tripped(_))));
        let new_run = matches!(item, Item::Run(..));
        if self.wait.until_ns.is_some_and(|until| now_ns > until) || new_run {
            self.close(What::Ends("the time after the trip is over".into()))?;
            self.wait = Wait { head: self.head.take(), ..Wait::default() };
        }
        if self.wait.until_ns.is_some() {
            if trips {
                self.wait.until_ns = Some(now_ns + after_ns(seconds));
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
        if trips {
            self.wait.until_ns = Some(now_ns + after_ns(seconds));
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
    (seconds.min(Keep::AFTER_TRIP) * 1e9) as u64
}

impl Wait {
    /// Lets go of everything before the first steps that reach past `oldest_ns`; settings among it go into the head.
    fn let_go(&mut self, oldest_ns: u64, subject: &Subject) {
        loop {
            let is_new = |item: &Item| match item {
                Item::Steps(batch) => batch.span().is_some_and(|(_, last)| last.wall_ns >= oldest_ns),
                _ => false,
            };
            let Some(first_steps) = self.items.iter().position(|item| matches!(item, Item::Steps(_))) else { break };
            let keeps_steps = is_new(&self.items[first_steps]);
            // The head is not a thing among others: it is taken up at once.
            let upto = if keeps_steps {
                self.items.iter().rposition(|item| matches!(item, Item::Run(..))).map_or(0, |at| at + 1)
            } else {
                first_steps + 1
            };
            if upto == 0 {
                break;
            }
            for item in self.items.drain(..upto) {
                match item {
                    Item::Run(bulletin, _) => self.head = Some(subject.head(bulletin)),
                    Item::Event(event) => {
                        if let Some(head) = &mut self.head {
                            head.follow(&event);
                        }
                    }
                    Item::Remark(remark) => {
                        if let Some(head) = &mut self.head {
                            head.heed(&remark);
                        }
                    }
                    _ => {}
                }
            }
        }
    }
}

/// Whether `path` can become a recording.
fn check(path: &Path) -> Result<(), TapeError> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("rrd")) {
        return Err(TapeError::place(path, "expected a file name that ends in .rrd"));
    }
    if path.symlink_metadata().is_ok() {
        return Err(TapeError::place(path, "is already there: choose another name, or remove it first"));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match folder.metadata() {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(TapeError::place(folder, "is no folder")),
        Err(error) => Err(TapeError::place(folder, format!("no folder to record into: {error}"))),
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Bytes free on the disk of a file that is to be.
fn free_bytes(path: &Path) -> Option<u64> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail * disk.f_frsize)
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use alarms::{Level, Turn, Watch};
    use wire::message::Trip;
    use wire::{SettingsMessage, State};

    use super::*;
    use crate::batch::Batch;

    /// What was written, file by file.
    type Log = Arc<Mutex<Vec<String>>>;

    /// A sink that notes what it is given; each step counts for a hundred bytes.
    struct Noting {
        name: String,
        log: Log,
        bytes: u64,
    }

    impl Noting {
        fn note(&mut self, what: &str) -> Result<(), TapeError> {
            self.log.lock().unwrap().push(format!("{} {what}", self.name));
            Ok(())
        }
    }

    impl Sink for Noting {
        fn steps(&mut self, batch: &Batch) -> Result<(), TapeError> {
            self.bytes += 100 * batch.len() as u64;
            self.note(&format!("{}..={}", batch.seq[0], batch.seq[batch.len() - 1]))
        }

        fn revision(&mut self, revision: &Revision, _: Moment) -> Result<(), TapeError> {
            self.note(&format!("revision {}", revision.revision))
        }

        fn event(&mut self, event: &Event) -> Result<(), TapeError> {
            self.note(event.happening.name())
        }

        fn remark(&mut self, remark: &Remark) -> Result<(), TapeError> {
            self.note(&remark.text())
        }

        fn health(&mut self, _: &Bulletin, _: Moment) -> Result<(), TapeError> {
            Ok(())
        }

        fn bytes(&self) -> u64 {
            self.bytes
        }

        fn finish(self: Box<Self>) -> Result<u64, TapeError> {
            Ok(self.bytes)
        }
    }

    struct Bench {
        reel: Reel,
        log: Log,
        folder: tempfile::TempDir,
    }

    impl Bench {
        fn new(keep: Keep) -> Self {
            let folder = tempfile::tempdir().unwrap();
            let log = Log::default();
            let shared = log.clone();
            let open: Open = Box::new(move |path, _| {
                std::fs::write(path, "").unwrap();
                Ok(Box::new(Noting { name: name(path), log: shared.clone(), bytes: 0 }))
            });
            let subject = Subject { bench: "rig".into(), limits: Limits::default() };
            let reel = Reel::with(&folder.path().join("s.rrd"), subject, keep, open).unwrap();
            Self { reel, log, folder }
        }

        fn run(&mut self) {
            self.reel.take(Item::Run(bulletin(), Moment::default())).unwrap();
        }

        /// One second of steps at 10 a second.
        fn second(&mut self, second: u64) {
            let mut batch = Batch::new(3);
            for seq in 10 * second..10 * (second + 1) {
                let wall_ns = 1_000_000_000_000 + seq * 100_000_000;
                batch.push(&State { run_id: 1, seq, wall_ns, count: 3, ..State::default() });
            }
            self.reel.take(Item::Steps(batch)).unwrap();
        }

        fn event(&mut self, happening: &Happening, revision: u64) {
            let mut event = happening.event();
            (event.run_id, event.revision, event.settings) = (1, revision, bulletin().settings);
            self.reel.take(Item::Event(event)).unwrap();
        }

        fn log(&self) -> Vec<String> {
            std::mem::take(&mut self.log.lock().unwrap())
        }

        fn files(&self) -> Vec<String> {
            let mut files: Vec<_> =
                std::fs::read_dir(self.folder.path()).unwrap().flatten().map(|e| name(&e.path())).collect();
            files.sort();
            files
        }
    }

    fn bulletin() -> Box<Bulletin> {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let off = rotor::builtin::feedback(&rotor, "off").unwrap();
        let settings = rotor::Settings::new(&rotor, 1.0, off);
        let settings = SettingsMessage::pack(&settings).unwrap();
        let mut bulletin = Box::new(Bulletin { run_id: 1, revision: 1, settings, ..Bulletin::default() });
        bulletin.set_rotor(&rotor);
        bulletin
    }

    fn keep(keeping: Keeping) -> Keep {
        Keep { keeping, split: None, min_free: 0 }
    }

    #[test]
    fn every_part_of_a_split_recording_can_be_read_alone() {
        let mut bench = Bench::new(Keep { split: Some(1500), ..keep(Keeping::All) });
        bench.run();
        bench.second(0);
        bench.event(&Happening::Settings, 2);
        bench.second(1);
        bench.second(2);
        let said = bench.log();
        assert_eq!(
            said,
            [
                "s.rrd revision 1",
                "s.rrd recording begins",
                "s.rrd 0..=9",
                "s.rrd revision 2",
                "s.rrd settings",
                "s.rrd 10..=19",
                "s.rrd recording goes on in s-2.rrd",
                "s-2.rrd revision 2",
                "s-2.rrd recording begins",
                "s-2.rrd 20..=29",
            ]
        );
        let files = bench.reel.finish("enough").unwrap();
        assert_eq!(files.iter().map(|f| name(f)).collect::<Vec<_>>(), ["s.rrd", "s-2.rrd"]);
    }

    fn alarm(seq: u64, level: Level) -> Item {
        let before = if level == Level::Fine { Level::Alarm } else { Level::Fine };
        let at = Moment { seq, ..Moment::default() };
        let (watch, cause) = (Watch::Damping, String::new());
        let turn = Turn { at, watch, before, level, value: seq as f64, limit: 0.0, worst: 0.0, cause };
        Item::Remark(Remark { at, what: What::Alarm(turn) })
    }

    #[test]
    fn an_alarm_in_force_stands_at_the_head_of_every_part_until_it_ends() {
        let mut bench = Bench::new(Keep { split: Some(1000), ..keep(Keeping::All) });
        bench.run();
        bench.second(0);
        bench.reel.take(alarm(5, Level::Alarm)).unwrap();
        bench.second(1);
        bench.second(2);
        bench.reel.take(alarm(25, Level::Fine)).unwrap();
        bench.second(3);
        let said = bench.log();
        let told: Vec<&str> = said.iter().filter(|line| line.contains("damping")).map(String::as_str).collect();
        let rose = "alarm: damping 5, limit 0";
        let [again, further] = [2, 3].map(|part| format!("s-{part}.rrd {rose}"));
        let fell = "s-3.rrd damping within its limits again: 25, at worst 0";
        assert_eq!(told, [&format!("s.rrd {rose}"), &again, &further, fell], "{said:?}");
    }

    #[test]
    fn an_alarm_before_the_time_that_a_trip_looks_back_is_told_all_the_same() {
        let mut bench = Bench::new(keep(Keeping::Pretrigger(3.0)));
        bench.run();
        bench.second(0);
        bench.reel.take(alarm(5, Level::Warning)).unwrap();
        (1..20).for_each(|second| bench.second(second));
        bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 1);
        let said = bench.log();
        assert_eq!(said[2], "s.rrd warning: damping 5, limit 0", "{said:?}");
    }

    #[test]
    fn a_rolling_recording_lets_go_of_what_is_too_old() {
        let mut bench = Bench::new(keep(Keeping::Last(16.0)));
        bench.run();
        (0..40).for_each(|second| bench.second(second));
        // Parts of two seconds; those that end more than sixteen ago are gone.
        let files = bench.files();
        assert!((9..=10).contains(&files.len()), "{files:?}");
        assert!(!files.contains(&"s-1.rrd".to_owned()) && files.contains(&"s-20.rrd".to_owned()), "{files:?}");
        assert!(bench.reel.bytes() <= 100 * 10 * 19, "{}", bench.reel.bytes());
    }

    #[test]
    fn a_trip_writes_what_came_before_it_under_the_settings_of_then() {
        let mut bench = Bench::new(keep(Keeping::Pretrigger(3.0)));
        bench.run();
        (0..10).for_each(|second| bench.second(second));
        bench.event(&Happening::Settings, 2);
        (10..20).for_each(|second| bench.second(second));
        bench.event(&Happening::Settings, 3);
        bench.second(20);
        assert!(bench.log().is_empty() && bench.files().is_empty());
        bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 3);
        let said = bench.log();
        assert_eq!(
            said,
            [
                "s.rrd revision 2",
                "s.rrd recording begins",
                "s.rrd 170..=179",
                "s.rrd 180..=189",
                "s.rrd 190..=199",
                "s.rrd revision 3",
                "s.rrd settings",
                "s.rrd 200..=209",
                "s.rrd tripped",
            ]
        );
        (21..30).for_each(|second| bench.second(second));
        let said = bench.log();
        assert_eq!(said.last().unwrap(), "s.rrd recording ends: the time after the trip is over");
        assert_eq!(said.len(), 4, "three seconds after it, and the end: {said:?}");
        // The next trip has a file of its own.
        bench.event(&Happening::Restarted, 3);
        bench.event(&Happening::Tripped(Trip { cause: 1, mass: 1, ..Trip::default() }), 3);
        assert_eq!(bench.log()[0], "s-2.rrd revision 3");
        assert_eq!(bench.files(), ["s-2.rrd", "s.rrd"]);
    }

    #[test]
    fn another_run_is_another_file() {
        let mut bench = Bench::new(keep(Keeping::All));
        bench.run();
        bench.second(0);
        bench.run();
        bench.second(0);
        assert_eq!(bench.reel.finish("enough").unwrap().len(), 2);
    }

    #[test]
    fn what_is_no_place_for_a_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let there = folder.path().join("there.rrd");
        std::fs::write(&there, "").unwrap();
        for (path, why) in [
            (there, "is already there"),
            (folder.path().join("no/s.rrd"), "no folder to record into"),
            (folder.path().join("s.csv"), "ends in .rrd"),
            (folder.path().join("there.rrd/s.rrd"), "is no folder"),
        ] {
            let told = check(&path).unwrap_err().to_string();
            assert!(told.contains(why), "{told}");
        }
    }
}
