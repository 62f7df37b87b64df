//! What somebody has kept in memory of a run, as a recording that goes on in another file.

use std::path::Path;
use std::time::Instant;

use alarms::Limits;
use wire::{BenchStatus, Event, Step};

use crate::alarm_recorder::AlarmRecorder;
use crate::error::TapeError;
use crate::event::{Remark, What};
use crate::gather::Gatherer;
use crate::rotation::{FileRotation, Keep};

/// Seconds from one look at the alarms to the next.
const LOOK: f64 = 0.1;

/// Writes `steps` of one run, ascending in number, and the `events` that happened meanwhile into the file `path`, which must not be there yet.
/// `bench_status` has the settings in force at the first of them. The recording goes on in `next`, in the same folder. Returns how many
/// steps there were. Snapshots of the machine are not kept in memory: a what-if on these steps is made of the step that it begins at.
///
/// # Errors
/// The file is there already or cannot be written, or this build cannot record.
pub fn write_past<S: Step>(
    (path, next): (&Path, &Path),
    bench: &str,
    limits: Limits,
    bench_status: Box<BenchStatus>,
    events: &[Event],
    steps: impl Iterator<Item = S>,
) -> Result<u64, TapeError> {
    let mut rotation = FileRotation::new(path, bench, Keep::default(), limits.clone())?;
    let filled = fill(&mut rotation, limits, bench_status, events, steps);
    let rows = rotation.rows();
    // What was written before something failed stays readable.
    let ended = rotation.finish_before(next);
    filled.and(ended).map(|_| rows)
}

fn fill<S: Step>(
    rotation: &mut FileRotation,
    limits: Limits,
    bench_status: Box<BenchStatus>,
    events: &[Event],
    steps: impl Iterator<Item = S>,
) -> Result<(), TapeError> {
    let (mut gatherer, mut alarms) = (Gatherer::new(), AlarmRecorder::new(limits));
    let now = Instant::now();
    let steps_a_look = (LOOK * bench_status.rate_hz).max(1.0) as u64;
    alarms.bench_status(&bench_status, 0);
    gatherer.bench_status(bench_status);
    let mut events = events.iter().peekable();
    let mut look = |gatherer: &mut Gatherer, alarms: &mut AlarmRecorder| {
        let turns = alarms.turns(None);
        turns.into_iter().for_each(|turn| gatherer.remark(Remark { at: turn.at, what: What::Alarm(turn) }));
        gatherer.flush(None);
        std::iter::from_fn(|| gatherer.next()).try_for_each(|item| rotation.take(item))
    };
    let mut looked = None;
    for step in steps {
        while let Some(event) = events.next_if(|event| event.seq <= step.seq()) {
            gatherer.event(event);
            alarms.event(event);
        }
        gatherer.state(&step, now);
        alarms.state(&step);
        if step.seq() >= looked.get_or_insert(step.seq()).saturating_add(steps_a_look) {
            looked = Some(step.seq());
            look(&mut gatherer, &mut alarms)?;
        }
    }
    for event in events {
        gatherer.event(event);
    }
    look(&mut gatherer, &mut alarms)
}
