//! `whirl replay`: plays a recording in the dashboard.

use std::ops::{ControlFlow, Range};
use std::path::PathBuf;

use alarms::{LevelChange, Limits};
use tape::{Gap, Recording, What};
use telemetry::processes::OpaqueError;
use telemetry::replay::{RecordedEvent, RecordedKind, RecordingSource};
use wire::{BenchStatus, Moment, State};

use crate::commands::dash::{ScreenArgs, ended};
use crate::failure::Failure;

/// Options of `whirl replay`.
#[derive(Debug, clap::Args)]
pub(crate) struct ReplayArgs {
    /// The recording: any part of a split one stands for all; of several files, those alone
    #[arg(value_name = "FILE.rrd", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    screen: ScreenArgs,
}

/// Plays the recording until told to quit.
///
/// # Errors
/// A build without recordings, a file that is none, or no terminal.
pub(crate) fn run(args: &ReplayArgs) -> Result<(), Failure> {
    tape::available()?;
    let options = args.screen.options_with(Some("replay"))?;
    // Before the reader's own hook, which keeps panics over damaged columns from this one.
    dashboard::restore_on_panic();
    let recording = Recording::open_row(&args.files)?;
    ended(dashboard::replay(Box::new(Tape::new(recording)), &options)?)
}

/// A recording as the player takes it.
struct Tape {
    recording: Recording,
    events: Vec<RecordedEvent>,
}

impl Tape {
    fn new(recording: Recording) -> Self {
        let of_bench = recording.events().iter().map(|event| RecordedEvent {
            at: event.at,
            what: RecordedKind::Happening(event.happening.clone()),
            who: event.who.clone(),
            why: event.why.clone(),
        });
        // What the recorder had to say stands among what happened.
        let of_recorder = recording.remarks().iter().map(|remark| RecordedEvent {
            at: remark.at,
            what: match &remark.what {
                What::Alarm(turn) => RecordedKind::Alarm(turn.clone()),
                _ => RecordedKind::Remark(remark.text()),
            },
            who: "recorder".to_owned(),
            why: String::new(),
        });
        let mut events: Vec<RecordedEvent> = of_bench.chain(of_recorder).collect();
        events.sort_by_key(|event| event.at.seq);
        Self { recording, events }
    }
}

impl RecordingSource for Tape {
    fn name(&self) -> String {
        let path = self.recording.path();
        let name =
            path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
        match self.recording.paths().len() {
            1 => name,
            parts => format!("{name} ({parts} parts)"),
        }
    }

    fn span(&self) -> Option<[Moment; 2]> {
        self.recording.span().map(|span| [span.first, span.last])
    }

    fn visit(&mut self, range: Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OpaqueError> {
        let visited = self.recording.visit(range, 1, |state| {
            each(state);
            ControlFlow::Continue(())
        });
        visited.map_err(OpaqueError::new)
    }

    fn bench_status_at(&mut self, seq: u64) -> Box<BenchStatus> {
        self.recording.bench_status_at(seq)
    }

    fn changes(&self) -> Vec<u64> {
        self.recording.revisions().iter().map(|revision| revision.from).collect()
    }

    fn events(&self) -> Vec<RecordedEvent> {
        self.events.clone()
    }

    fn turns(&self) -> Vec<LevelChange> {
        self.recording.turns()
    }

    fn limits(&self) -> Option<Limits> {
        self.recording.session().limits.clone()
    }

    fn missing(&self) -> Vec<Range<u64>> {
        self.recording.gaps().iter().map(|Gap { from, count }| *from..from + count).collect()
    }

    fn notices(&self) -> Vec<String> {
        self.recording.notices()
    }

    fn snapshot_before(&mut self, seq: u64) -> Result<Option<(u64, Vec<u64>)>, OpaqueError> {
        let snapshot = self.recording.snapshot_before(seq).map_err(OpaqueError::new)?;
        Ok(snapshot.map(|snapshot| (snapshot.next, snapshot.words)))
    }

    fn paces(&self) -> Vec<(u64, f64)> {
        self.recording.paces()
    }

    fn at_tau(&mut self, tau: f64) -> Result<u64, OpaqueError> {
        self.recording.seq_at_tau(tau).map_err(OpaqueError::new)
    }
}
