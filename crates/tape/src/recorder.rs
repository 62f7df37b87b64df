//! The recorder: listens to a bench on one thread and writes on another, with a bounded queue between them.
//!
//! It is a process of its own beside the simulation, which does not notice it: states come through shared memory that the
//! simulation overwrites without waiting. However slow the disk is, the listening thread goes on listening.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use alarms::{LevelChange, Limits};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use wire::{
    BenchName, Carrier, HostState, Keeping, Listener, RecorderSender, RecorderState, RecorderStatus, Text, WireError,
};

use crate::alarm_recorder::AlarmRecorder;
use crate::error::TapeError;
use crate::event::{Remark, What};
use crate::gather::Gatherer;
use crate::rotation::{FileRotation, Keep};
use crate::sink::{self, Item, Open};
use crate::snapshot::Snapshot;
use crate::viewer::{AskViewer, ViewerStatus};

/// Items that wait for the writing thread; what is beyond waits with the listening thread.
const QUEUE: usize = 64;
/// How often the bench is listened to: a hundredth or less of what it keeps for us.
const LISTEN: Duration = Duration::from_millis(5);
/// How often the recorder tells how it stands.
const TELL: Duration = Duration::from_millis(500);
/// Silence after which we look whether the simulation still lives.
const SILENCE: Duration = Duration::from_millis(300);

/// What to record, and where to.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The bench.
    pub bench: BenchName,
    /// The file; without one it is only shown.
    pub path: Option<PathBuf>,
    /// The running viewer that it is shown in too, as `HOST:PORT`.
    pub viewer: Option<String>,
    /// What is kept.
    pub keep: Keep,
    /// Goes on with the next simulation of the same name when one ends.
    pub follow: bool,
    /// What is past these is written down as an alarm.
    pub limits: Limits,
}

impl Order {
    fn rotation(&self) -> Result<(FileRotation, Option<AskViewer>), TapeError> {
        let (path, bench) = (self.path.as_deref(), self.bench.as_str());
        let (open, ask): (Open, _) = match &self.viewer {
            Some(address) => {
                let (open, ask) = sink::shown(address, path.is_some())?;
                (open, Some(ask))
            }
            None => (Box::new(sink::create), None),
        };
        sink::available()?;
        Ok((FileRotation::into_sinks(path, bench, self.keep.clone(), self.limits.clone(), open)?, ask))
    }

    /// Where it goes, in words.
    fn place(&self) -> String {
        match (&self.path, &self.viewer) {
            (Some(path), _) => absolute(path).to_string_lossy().into_owned(),
            (None, viewer) => format!("the viewer at {}", viewer.as_deref().unwrap_or("nowhere")),
        }
    }
}

/// How a recording went.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The files, in order; none if nothing was to be written.
    pub files: Vec<PathBuf>,
    /// Steps written.
    pub rows: u64,
    /// Bytes written.
    pub bytes: u64,
    /// Steps that were sent and are not in the files.
    pub lost: u64,
    /// How long it took.
    pub elapsed: Duration,
    /// Why it ended.
    pub why: &'static str,
    /// How the viewer stood at the end, if there was to be one.
    pub viewer: Option<ViewerStatus>,
}

/// How a recording stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Steps written.
    pub rows: u64,
    /// Bytes written.
    pub bytes: u64,
    /// Steps that were sent and will not be in the files.
    pub lost: u64,
    /// The number of the first step that was heard, once there is one.
    pub first: Option<u64>,
    /// How long it has taken.
    pub elapsed: Duration,
    /// How the viewer stands, if there is to be one.
    pub viewer: Option<ViewerStatus>,
}

/// What the writing thread tells the listening one.
#[derive(Debug, Default)]
struct Tally {
    rows: AtomicU64,
    bytes: AtomicU64,
    parts: AtomicU32,
}

/// Records until `stop`, or until the simulation ends. `progress` is called now and then.
///
/// # Errors
/// The path is no place for a file, the bench is gone or somebody else records it, or writing fails; what was written by
/// then stays readable.
pub fn record<C: Carrier>(
    carrier: &C,
    mut listener: C::Listener,
    order: &Order,
    stop: &AtomicBool,
    mut progress: impl FnMut(Progress),
) -> Result<Summary, TapeError> {
    let (rotation, ask) = order.rotation()?;
    let mut voice = Voice::new(carrier.recorder(&order.bench)?, order);
    let tally = Tally::default();
    let (sender, receiver) = bounded(QUEUE);
    let began = Instant::now();
    let result = std::thread::scope(|scope| {
        let writer = std::thread::Builder::new()
            .name("tape".into())
            .spawn_scoped(scope, || write(rotation, receiver, &tally))
            .map_err(|error| WireError::Internal(format!("no thread for writing: {error}")))?;
        let status = || ask.as_ref().map(AskViewer::status);
        let heard = listen(&mut listener, &sender, order, stop, &tally, &mut voice, |told| {
            progress(Progress { viewer: status(), ..told });
        });
        // The writer ends when there is nobody left to send it anything.
        drop(sender);
        let written = writer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        // If writing has failed, that is why listening ended.
        let files = if order.path.is_some() { written? } else { written.map(|_| Vec::new())? };
        let viewer = ask.as_ref().map(AskViewer::farewell);
        let (lost, why) = heard?;
        let bytes = files.iter().filter_map(|file| file.metadata().ok()).map(|found| found.len()).sum();
        let rows = tally.rows.load(Ordering::Relaxed);
        Ok(Summary { files, rows, bytes, lost, elapsed: began.elapsed(), why, viewer })
    });
    voice.end(&tally, result.as_ref());
    result
}

/// The listening thread. Returns how many steps were lost, and why it ended.
fn listen(
    listener: &mut impl Listener,
    sender: &Sender<Message>,
    order: &Order,
    stop: &AtomicBool,
    tally: &Tally,
    voice: &mut Voice<impl RecorderSender>,
    mut progress: impl FnMut(Progress),
) -> Result<(u64, &'static str), TapeError> {
    let mut gatherer = Gatherer::new();
    let mut alarms = AlarmRecorder::new(order.limits.clone());
    let began = Instant::now();
    let mut heard = began;
    let mut told = None::<Instant>;
    let why = loop {
        let now = Instant::now();
        let states = listener.drain(|state| {
            gatherer.state(&state, now);
            alarms.state(&state);
        })?;
        // Events before the bench status: it must not be news what an event has told already.
        listener.events(|event| {
            gatherer.event(event);
            alarms.event(event);
        })?;
        listener.snapshots(|head, words| gatherer.snapshot(head.run_id, Snapshot::new(head.seq, words)))?;
        if let Some(bench_status) = listener.bench_status()? {
            alarms.bench_status(&bench_status, gatherer.lost());
            gatherer.bench_status(bench_status);
        }
        note(&mut gatherer, alarms.turns(Some(now)));
        gatherer.flush(Some(now));
        if !deliver(&mut gatherer, sender) {
            // The writer has ended, and says itself why.
            return Ok((gatherer.lost(), "writing failed"));
        }
        if told.is_none_or(|told| told.elapsed() >= TELL) {
            told = Some(now);
            voice.tell(tally, &gatherer)?;
            let [rows, bytes] = [&tally.rows, &tally.bytes].map(|count| count.load(Ordering::Relaxed));
            let (lost, first) = (gatherer.lost(), gatherer.first());
            progress(Progress { rows, bytes, lost, first, elapsed: began.elapsed(), viewer: None });
        }
        if stop.load(Ordering::Relaxed) {
            break "asked to stop";
        }
        if states > 0 {
            heard = now;
        } else if heard.elapsed() > SILENCE {
            if !order.follow && listener.host() == HostState::Gone {
                break "the simulation ended";
            }
            heard = now;
        }
        std::thread::sleep(LISTEN);
    };
    note(&mut gatherer, alarms.turns(None));
    gatherer.flush(None);
    while let Some(item) = gatherer.next() {
        if sender.send(Message::Item(item)).is_err() {
            return Ok((gatherer.lost(), "writing failed"));
        }
    }
    let _ = sender.send(Message::End(why));
    Ok((gatherer.lost(), why))
}

/// Has alarms put on tape.
fn note(gatherer: &mut Gatherer, turns: Vec<LevelChange>) {
    turns.into_iter().for_each(|turn| gatherer.remark(Remark { at: turn.at, what: What::Alarm(turn) }));
}

/// One thing for the writing thread.
#[derive(Debug)]
enum Message {
    Item(Item),
    End(&'static str),
}

/// Hands over what has been gathered, as far as there is room. Whether the writer is still there.
fn deliver(gatherer: &mut Gatherer, sender: &Sender<Message>) -> bool {
    while let Some(item) = gatherer.next() {
        match sender.try_send(Message::Item(item)) {
            Ok(()) => {}
            Err(TrySendError::Full(Message::Item(item))) => {
                gatherer.give_back(item);
                return true;
            }
            Err(_) => return false,
        }
    }
    true
}

/// The writing thread. Returns the files. The receiver goes with it, so that the listening thread notices its end.
fn write(mut rotation: FileRotation, receiver: Receiver<Message>, tally: &Tally) -> Result<Vec<PathBuf>, TapeError> {
    for message in receiver {
        match message {
            Message::Item(item) => {
                let taken = rotation.take(item);
                tally.rows.store(rotation.rows(), Ordering::Relaxed);
                tally.bytes.store(rotation.bytes(), Ordering::Relaxed);
                tally.parts.store(rotation.parts(), Ordering::Relaxed);
                taken?;
            }
            Message::End(why) => return rotation.finish(why),
        }
    }
    // The listening thread has failed, and says itself why.
    rotation.finish("the bench could not be listened to any longer")
}

/// Tells the bench's other readers how the recording stands.
struct Voice<S> {
    sender: S,
    status: Box<RecorderStatus>,
}

impl<S: RecorderSender> Voice<S> {
    fn new(sender: S, order: &Order) -> Self {
        let started_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64;
        let mut status = Box::new(RecorderStatus { started_ns, pid: std::process::id(), ..RecorderStatus::default() });
        status.set_state(RecorderState::Recording);
        status.set_keeping(order.keep.keeping);
        status.path = Text::new(&order.place());
        Self { sender, status }
    }

    fn tell(&mut self, tally: &Tally, gatherer: &Gatherer) -> Result<(), WireError> {
        self.status.run_id = gatherer.run_id().unwrap_or_default();
        self.status.lost = gatherer.lost();
        self.send(tally)
    }

    fn send(&mut self, tally: &Tally) -> Result<(), WireError> {
        self.status.rows = tally.rows.load(Ordering::Relaxed);
        self.status.bytes = tally.bytes.load(Ordering::Relaxed);
        self.status.part = tally.parts.load(Ordering::Relaxed);
        self.sender.send(&mut self.status)
    }

    fn end(&mut self, tally: &Tally, result: Result<&Summary, &TapeError>) {
        match result {
            Ok(_) => self.status.set_state(RecorderState::Stopped),
            Err(error) => {
                self.status.set_state(RecorderState::Failed);
                self.status.error = Text::new(&error.to_string());
            }
        }
        // Nobody may be left to hear it.
        let _ = self.send(tally);
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Whether an order can be carried out as far as that can be told without a bench, and without a viewer.
///
/// # Errors
/// The path is taken or no place for a file, or this build cannot record.
pub fn check(order: &Order) -> Result<(), TapeError> {
    sink::available()?;
    let (path, bench) = (order.path.as_deref(), order.bench.as_str());
    let open = Box::new(sink::create);
    FileRotation::into_sinks(path, bench, order.keep.clone(), order.limits.clone(), open).map(drop)
}

/// Why what is kept cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WindowError {
    /// A stretch of no sensible length.
    #[error("{option} = {seconds} s: expected from 1 s to 1e7 s")]
    Length {
        /// The option that asks for it.
        option: &'static str,
        /// How long it would be.
        seconds: f64,
    },
    /// More steps before a trip than memory should hold.
    #[error(
        "pretrigger = {seconds} s: {:.0} steps at {rate_hz} a second are too many to hold in memory, at most {MOST_HELD:.0}",
        seconds * rate_hz
    )]
    Memory {
        /// How long before the trip.
        seconds: f64,
        /// Steps a second.
        rate_hz: f64,
    },
}

/// Whether what is kept can be kept: how much memory, or how short a stretch.
///
/// # Errors
/// A window shorter than a second, or too long to be held in memory at `rate_hz` steps a second.
pub fn check_window(keep: &Keep, rate_hz: f64) -> Result<(), WindowError> {
    let (option, seconds) = match keep.keeping {
        Keeping::All => return Ok(()),
        Keeping::Last(seconds) => ("keep", seconds),
        Keeping::Pretrigger(seconds) => ("pretrigger", seconds),
    };
    if !(1.0..=1e7).contains(&seconds) {
        return Err(WindowError::Length { option, seconds });
    }
    if matches!(keep.keeping, Keeping::Pretrigger(_)) && seconds * rate_hz > MOST_HELD {
        return Err(WindowError::Memory { seconds, rate_hz });
    }
    Ok(())
}

/// Steps held before a trip: 0.7 GB for three masses, 2.4 GB for sixteen.
const MOST_HELD: f64 = 4e6;
