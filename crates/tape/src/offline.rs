//! A run of the simulation without a bench, as a recording: the same columns, with a wall clock that is made up.

use std::io;
use std::path::{Path, PathBuf};

use files::Existing;
use machine::{Machine, StateWords};
use rotor::{C64, Rotor, Settings};
use wire::message::{Flags, Trip};
use wire::{BenchStatus, Channel, Happening, Moment, Point, SettingsDocument, State, StepLayout, Text};

use crate::batch::Batch;
use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::gather::Gatherer;
use crate::schema;
use crate::session::{Session, Source};
use crate::sink::{self, Head, Sink};
use crate::snapshot::Snapshot;

/// Steps from one snapshot of the machine to the next at least: what a bench makes in a second.
const SNAPSHOT_STEPS: u64 = 1000;
/// And for each of its words: a loop with a long memory shall not be most of the file.
const STEPS_A_WORD: u64 = 3;

/// A run being recorded. It is written under another name beside its place, and takes its name when it is whole.
pub struct OfflineTape {
    target: PathBuf,
    existing: Existing,
    part: Unfinished,
    sink: Option<Box<dyn Sink>>,
    batch: Batch,
    settings: Settings,
    events: u64,
    every: u64,
    /// Samples seen: the step numbers of the file.
    seen: u64,
    /// Waits until it is known that nothing is done to the machine before the step that it names.
    snapshot: Option<Snapshot>,
    /// The sample with which all of the machine is written down again.
    next_snapshot: u64,
    last: Moment,
}

/// The file that goes if it does not become whole.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        // It is gone already if it has become the target.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// How the steps of a machine under these settings are laid out.
fn layout(settings: &Settings) -> StepLayout {
    StepLayout::new(settings.deadband.len()).with_bearings(settings.feedback.bearings.len())
}

/// One unit of `tau` on the made-up clock, which begins at 1970 so that the same run is the same file.
fn wall_ns(tau: f64) -> u64 {
    (tau * 1e9) as u64
}

impl OfflineTape {
    /// Begins to record `rotor` under `settings`, stepped by `dtau` in so many `substeps`, into `target`: one sample in every `every`.
    ///
    /// # Errors
    /// The target is no place for a file, or is there and is to be kept, or this build has no encoder.
    pub fn create(
        target: &Path,
        existing: Existing,
        rotor: &Rotor,
        settings: &Settings,
        (dtau, substeps): (f64, u32),
        every: u64,
    ) -> Result<Self, TapeError> {
        files::check(target, existing)?;
        let mut bench_status = Box::<BenchStatus>::default();
        bench_status.version = Text::new(env!("CARGO_PKG_VERSION"));
        bench_status.set_rotor(rotor);
        bench_status.settings = SettingsDocument::of(settings);
        (bench_status.dtau, bench_status.substeps) = (dtau, substeps);
        (bench_status.revision, bench_status.changed_by) = (1, Text::new("run"));
        let session = Session {
            schema: schema::VERSION,
            whirl: env!("CARGO_PKG_VERSION").to_owned(),
            simulation: env!("CARGO_PKG_VERSION").to_owned(),
            run_id: 0,
            bench: String::new(),
            source: Source::Offline,
            started_ns: 0,
            rate_hz: 0.0,
            dtau,
            bearings: settings.feedback.bearings.len(),
            limits: None,
        };
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let part = target.with_file_name(format!(".{name}-{}.part", std::process::id()));
        let head = Head { session, bench_status, alarms: Vec::new(), snapshot: None };
        let mut sink = sink::create(&part, &head)?;
        let part = Unfinished(part);
        sink.revision(&head.revision(), Moment::default())?;
        sink.remark(&Remark { at: Moment::default(), what: What::Begins })?;
        Ok(Self {
            target: target.to_owned(),
            existing,
            part,
            sink: Some(sink),
            batch: Batch::new(layout(settings)),
            settings: settings.clone(),
            events: 0,
            every: every.max(1),
            seen: 0,
            snapshot: None,
            next_snapshot: u64::MAX,
            last: Moment::default(),
        })
    }

    /// Takes one sample.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sample(&mut self, machine: &Machine) -> io::Result<()> {
        self.put_snapshot().map_err(io::Error::other)?;
        let (seq, sample) = (self.seen, machine.sample());
        self.seen += 1;
        self.last = Moment { seq, tau: sample.tau, wall_ns: wall_ns(sample.tau) };
        if seq >= self.next_snapshot {
            self.snapshot = Some(self.snapshot_of(machine));
        }
        if !seq.is_multiple_of(self.every) {
            return Ok(());
        }
        let pair = |z: C64| [z.re, z.im];
        let mut state = State::new(layout(&self.settings));
        let mut row = state.row_mut();
        row.set_word(Channel::Seq, seq);
        row.set_word(Channel::WallNs, wall_ns(sample.tau));
        row.set_word(Channel::Revision, 1);
        let is_saturated = sample.outputs.iter().any(|output| output.saturated);
        let saturated = if is_saturated { Flags::SATURATED } else { Flags::default() };
        row.set_flags(Flags(Flags::contact(sample.contact).0 | saturated.0));
        row.set(Channel::Tau, 0, sample.tau);
        row.set(Channel::Angle, 0, sample.angle);
        row.set(Channel::Speed, 0, sample.speed);
        row.set(Channel::SpeedRate, 0, sample.acceleration);
        for (bearing, output) in sample.outputs.iter().enumerate() {
            row.set_force(bearing, [output.commanded, output.delivered].map(pair));
        }
        for (mass, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
            row.set_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
            row.set_pair([Channel::ReadingY, Channel::ReadingZ], mass, pair(machine.reading(mass)));
        }
        self.batch.push(&state);
        if self.batch.len() >= Gatherer::BATCH_ROWS { self.flush().map_err(io::Error::other) } else { Ok(()) }
    }

    /// An impulse comes, which the next sample shows.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn impulse(&mut self, at: f64, mass: usize, velocity: C64) -> io::Result<()> {
        // It was before the impulse.
        self.snapshot = None;
        let next = Moment { seq: self.seen, tau: at, wall_ns: wall_ns(at) };
        self.happened(next, Happening::Impulse { mass, velocity })
    }

    /// The machine has tripped with the last sample.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn tripped(&mut self, trip: machine::Trip) -> io::Result<()> {
        let machine::Trip { cause, station, radius, limit } = trip;
        let trip = Trip::new(self.last.seq, cause as u32, station, [radius, limit]);
        self.happened(self.last, Happening::Tripped(trip))
    }

    /// Something that is to be known of what follows, in words.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn note(&mut self, text: &str) -> io::Result<()> {
        let next = Moment { seq: self.seen, ..self.last };
        self.happened(next, Happening::Note(text.to_owned()))
    }

    fn happened(&mut self, at: Moment, happening: Happening) -> io::Result<()> {
        self.events += 1;
        let (number, who) = (self.events, "run".to_owned());
        let event = Event { at, number, revision: 1, happening, who, why: String::new(), change: String::new() };
        self.sink.as_mut().map_or(Ok(()), |sink| sink.event(&event)).map_err(io::Error::other)
    }

    /// From here on steps are as long as those of the machine.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn stretch(&mut self, machine: &Machine) -> io::Result<()> {
        self.snapshot = Some(self.snapshot_of(machine));
        self.put_snapshot().map_err(io::Error::other)
    }

    /// All of the machine, as it is before the next step.
    fn snapshot_of(&mut self, machine: &Machine) -> Snapshot {
        let mut words = StateWords::default();
        machine.save(&mut words);
        self.next_snapshot = self.seen + SNAPSHOT_STEPS.max(words.as_slice().len() as u64 * STEPS_A_WORD);
        Snapshot::new(self.seen, words.as_slice())
    }

    /// Puts on tape what is waiting.
    fn put_snapshot(&mut self) -> Result<(), TapeError> {
        match (self.snapshot.take(), &mut self.sink) {
            (Some(snapshot), Some(sink)) => {
                let at = Moment { seq: snapshot.next, ..self.last };
                sink.snapshot(snapshot, at)
            }
            _ => Ok(()),
        }
    }

    fn flush(&mut self) -> Result<(), TapeError> {
        let batch = std::mem::replace(&mut self.batch, Batch::new(layout(&self.settings)));
        self.sink.as_mut().map_or(Ok(()), |sink| sink.steps(&batch))
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// The rest cannot be written, or the name not be taken.
    pub fn finish(mut self, why: &str) -> Result<(), TapeError> {
        self.flush()?;
        let Some(mut sink) = self.sink.take() else { return Ok(()) };
        sink.remark(&Remark { at: self.last, what: What::Ends(why.to_owned()) })?;
        sink.finish()?;
        // A link is made only where nothing is; the file's other name goes with `self`.
        let named = match self.existing {
            Existing::Keep => std::fs::hard_link(&self.part.0, &self.target),
            Existing::Replace => std::fs::rename(&self.part.0, &self.target),
        };
        named.map_err(|error| TapeError::unfit(&self.target, &error))
    }
}
