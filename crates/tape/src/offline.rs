//! A run of the simulation without a bench, as a recording: the same columns, with a wall clock that is made up.

use std::io;
use std::path::{Path, PathBuf};

use files::Existing;
use rotor::{C64, Motion, Rotor, Settings};
use wire::message::Flags;
use wire::{Bulletin, Channel, Happening, Layout, Moment, Point, SettingsDocument, State, Text};

use crate::batch::Batch;
use crate::error::TapeError;
use crate::event::{Event, Remark, What};
use crate::gather::Gatherer;
use crate::schema;
use crate::session::{Session, Source};
use crate::sink::{self, Head, Sink};

/// A run being recorded. It is written under another name beside its place, and takes its name when it is whole.
pub struct OfflineTape {
    target: PathBuf,
    existing: Existing,
    part: Unfinished,
    sink: Option<Box<dyn Sink>>,
    batch: Batch,
    settings: Settings,
    /// Still to come, the next one last: when, on which mass, and the change of its velocity.
    impulses: Vec<(f64, usize, C64)>,
    events: u64,
    every: u64,
    /// Samples seen: the step numbers of the file.
    seen: u64,
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

/// One unit of `tau` on the made-up clock, which begins at 1970 so that the same run is the same file.
fn wall_ns(tau: f64) -> u64 {
    (tau * 1e9) as u64
}

impl OfflineTape {
    /// Begins to record `rotor` under `settings` into `target`, one sample in every `every`. `impulses` are those that the
    /// run will have: when, on which mass (counted from 0), and the change of its velocity.
    ///
    /// # Errors
    /// The target is no place for a file, or is there and is to be kept, or this build has no encoder.
    pub fn create(
        target: &Path,
        existing: Existing,
        rotor: &Rotor,
        settings: &Settings,
        dtau: f64,
        every: u64,
        mut impulses: Vec<(f64, usize, C64)>,
    ) -> Result<Self, TapeError> {
        files::check(target, existing)?;
        impulses.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut bulletin = Box::<Bulletin>::default();
        bulletin.version = Text::new(env!("CARGO_PKG_VERSION"));
        bulletin.set_rotor(rotor);
        bulletin.settings = SettingsDocument::of(settings);
        (bulletin.dtau, bulletin.revision, bulletin.changed_by) = (dtau, 1, Text::new("run"));
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
            limits: None,
        };
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let part = target.with_file_name(format!(".{name}-{}.part", std::process::id()));
        let head = Head { session, bulletin, standing: Vec::new() };
        let mut sink = sink::create(&part, &head)?;
        let part = Unfinished(part);
        sink.revision(&head.revision(), Moment::default())?;
        sink.remark(&Remark { at: Moment::default(), what: What::Begins })?;
        Ok(Self {
            target: target.to_owned(),
            existing,
            part,
            sink: Some(sink),
            batch: Batch::new(rotor.len()),
            settings: settings.clone(),
            impulses,
            events: 0,
            every: every.max(1),
            seen: 0,
            last: Moment::default(),
        })
    }

    /// Takes one sample: the motion, the control on it, and which masses press on their bearings.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sample(&mut self, motion: &Motion<'_>, control: C64, contact: u32) -> io::Result<()> {
        let seq = self.seen;
        self.seen += 1;
        self.last = Moment { seq, tau: motion.tau, wall_ns: wall_ns(motion.tau) };
        self.impulses_until(motion.tau).map_err(io::Error::other)?;
        if !seq.is_multiple_of(self.every) {
            return Ok(());
        }
        let force = [control.re, control.im];
        let mut state = State::new(Layout::new(motion.displacement.len()));
        let mut row = state.row_mut();
        row.set_word(Channel::Seq, seq);
        row.set_word(Channel::WallNs, wall_ns(motion.tau));
        row.set_word(Channel::Revision, 1);
        row.set_flags(Flags::contact(contact));
        row.set(Channel::Tau, 0, motion.tau);
        row.set(Channel::Angle, 0, motion.angle);
        row.set(Channel::Speed, 0, self.settings.speed);
        row.set_pair([Channel::CommandY, Channel::CommandZ], 0, force);
        row.set_pair([Channel::ForceY, Channel::ForceZ], 0, force);
        for (mass, (p, v)) in motion.displacement.iter().zip(motion.velocity).enumerate() {
            state = state.with_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
        }
        self.batch.push(&state);
        if self.batch.len() >= Gatherer::BATCH_ROWS { self.flush().map_err(io::Error::other) } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), TapeError> {
        let batch = std::mem::replace(&mut self.batch, Batch::new(self.settings.deadband.len()));
        self.sink.as_mut().map_or(Ok(()), |sink| sink.steps(&batch))
    }

    /// Tells of the impulses up to `tau`: they show from the next sample on, or from the first.
    fn impulses_until(&mut self, tau: f64) -> Result<(), TapeError> {
        while let Some((at, mass, velocity)) = self.impulses.pop_if(|(at, ..)| *at <= tau) {
            self.events += 1;
            let event = Event {
                at: Moment { seq: if at > 0.0 { self.last.seq + 1 } else { 0 }, tau: at, wall_ns: wall_ns(at) },
                number: self.events,
                revision: 1,
                happening: Happening::Impulse { mass, velocity },
                who: "run".to_owned(),
                why: String::new(),
                change: String::new(),
            };
            self.sink.as_mut().map_or(Ok(()), |sink| sink.event(&event))?;
        }
        Ok(())
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
