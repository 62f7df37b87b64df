//! What a recording holds, in a page: how long, how fast, how complete, and the moments that matter.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use alarms::{Alarms, Entry, Limits, Watch};
use rotor::ControlMasses;
use serde::Serialize;

use wire::{Happening, Moment, State, Step};

use crate::damage::Damage;
use crate::error::TapeError;
use crate::recording::Recording;
use crate::session::Revision;

/// A recording in short. Lengths in `e_t`, forces in `w0^2 e_t`, times in `tau`, unless a name says otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// The file, of several the first.
    pub file: String,
    /// All its files, in order.
    pub parts: Vec<String>,
    /// Their size.
    pub bytes: u64,
    /// Version of what it holds.
    pub schema: u32,
    /// Version of the program that recorded.
    pub whirl: String,
    /// Version of the program that simulated.
    pub simulation: String,
    /// The run.
    pub run_id: String,
    /// The bench; empty for an offline run.
    pub bench: String,
    /// `live` or `offline`.
    pub source: &'static str,
    /// The rotor's name.
    pub rotor: String,
    /// How many masses it has.
    pub masses: usize,
    /// Steps a second that the simulation paced itself to; 0 for an offline run.
    pub rate_hz: f64,
    /// Steps a second on file, from first to last; null if there are fewer than two, or the run was offline.
    pub measured_rate_hz: Option<f64>,
    /// Advance of `tau` per step.
    pub dtau: f64,
    /// Steps on file.
    pub steps: u64,
    /// The first of them; null if there is none.
    pub first: Option<MomentInfo>,
    /// The last.
    pub last: Option<MomentInfo>,
    /// Seconds on the wall clock from first to last.
    pub seconds: f64,
    /// Steps missing between first and last.
    pub lost: u64,
    /// Changes of settings on file, the first ones not counted.
    pub settings_changes: usize,
    /// Everything that happened on the bench, as far as it is on file.
    pub events: usize,
    /// The trips.
    pub trips: Vec<TripInfo>,
    /// The alarms that rose, trips aside; in order.
    pub alarms: Vec<AlarmInfo>,
    /// What they were held against: warning and alarm, null where there is no limit. Null if nobody judged.
    pub alarm_limits: Option<BTreeMap<&'static str, Option<[f64; 2]>>>,
    /// The smallest damping ratio, of the modes that count, under any settings in force; null if no poles are known, or no steps.
    pub min_damping: Option<DampingInfo>,
    /// The largest control force, of several control bearings as that of the first; null without steps.
    pub max_force: Option<PeakInfo>,
    /// The largest radius of any mass; null without steps.
    pub max_radius: Option<PeakInfo>,
    /// Snapshots of the machine, from which a what-if begins.
    pub snapshots: usize,
    /// Whether all that is on file has checksums; without them a changed number is not noticed.
    pub checksums: bool,
    /// Where the files are not what was written.
    pub damage: Vec<Damage>,
    /// What a reader should know: damaged, steps missing, begun late.
    pub notices: Vec<String>,
}

/// A moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MomentInfo {
    /// Step number.
    pub step: u64,
    /// Dimensionless time.
    pub tau: f64,
    /// Nanoseconds since 1970.
    pub wall_ns: u64,
}

impl From<Moment> for MomentInfo {
    fn from(Moment { seq, tau, wall_ns }: Moment) -> Self {
        Self { step: seq, tau, wall_ns }
    }
}

/// A trip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TripInfo {
    /// When.
    #[serde(flatten)]
    pub at: MomentInfo,
    /// What tripped it.
    pub why: String,
    /// Revision of the settings that it tripped under.
    pub revision: u64,
}

/// An alarm, from where it rose to where it was within its limits again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmInfo {
    /// What was past its limit.
    pub watch: &'static str,
    /// `warning` or `alarm`: the worst that it was.
    pub level: &'static str,
    /// The worst value.
    pub worst: f64,
    /// The limit of that level.
    pub limit: f64,
    /// Where it rose.
    pub from: MomentInfo,
    /// Where it was within its limits again; null if it was not until the end.
    pub to: Option<MomentInfo>,
}

impl From<&Entry> for AlarmInfo {
    fn from(entry: &Entry) -> Self {
        Self {
            watch: entry.watch.name(),
            level: entry.level.name(),
            worst: entry.worst,
            limit: entry.limit,
            from: entry.rose.into(),
            to: entry.fell.map(MomentInfo::from),
        }
    }
}

/// Settings with the smallest damping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingInfo {
    /// The damping ratio.
    pub value: f64,
    /// The first step on file under those settings.
    #[serde(flatten)]
    pub at: MomentInfo,
    /// Their revision.
    pub revision: u64,
}

/// The largest of something, and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PeakInfo {
    /// How large.
    pub value: f64,
    /// When.
    #[serde(flatten)]
    pub at: MomentInfo,
    /// The mass, counted from 1; for a radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass: Option<usize>,
}

impl Info {
    /// Looks through a recording. Reads every step.
    ///
    /// # Errors
    /// The file has changed or cannot be read.
    pub fn of(recording: &mut Recording) -> Result<Self, TapeError> {
        Self::seeing(recording, |_, _| ())
    }

    /// The same, and shows every step of a machine in motion with the size of its largest force, in order: those of one that is held after a trip repeat the step that
    /// tripped it.
    ///
    /// # Errors
    /// As [`Info::of`].
    pub fn seeing(recording: &mut Recording, mut see: impl FnMut(&State, f64)) -> Result<Self, TapeError> {
        let (mut force, mut radius) = (None::<PeakInfo>, None::<PeakInfo>);
        let mut held = false;
        // Of the settings that were in force while steps were recorded; the first do not count as a change.
        let first = recording.span().map_or(0, |span| span.first.seq);
        let revisions = recording.revisions();
        let in_force = revisions.partition_point(|r| r.from <= first).max(1) - 1;
        let in_force: Vec<Revision> = revisions.get(in_force..).unwrap_or_default().to_vec();
        let of = |r: &Revision| (r.from, ControlMasses::of(recording.rotor(), &r.settings.feedback));
        let masses: Vec<(u64, ControlMasses)> = recording.revisions().iter().map(of).collect();
        let last = recording.span().map_or(0, |span| span.last.seq);
        let damped = in_force.iter().filter(|r| !r.poles.is_empty() && r.from <= last);
        let least = damped.min_by(|a, b| a.min_damping.total_cmp(&b.min_damping));
        let mut damping = None::<DampingInfo>;
        let recalled = Alarms::recalled(Limits::none(), &recording.turns());
        let mut alarms: Vec<Entry> = recalled.entries().filter(|entry| entry.watch != Watch::Trip).cloned().collect();
        alarms.reverse();
        recording.visit(0..u64::MAX, 1, |state| {
            let at = MomentInfo { step: state.seq(), tau: state.tau(), wall_ns: state.wall_ns() };
            if let Some(least) = least.filter(|least| damping.is_none() && least.from <= state.seq()) {
                damping = Some(DampingInfo { value: least.min_damping, at, revision: least.revision });
            }
            // A machine that is held repeats the step that tripped it.
            let is_held = std::mem::replace(&mut held, state.flags().stands_still()) && held;
            if is_held {
                return ControlFlow::Continue(());
            }
            let since = masses.partition_point(|(from, _)| *from <= state.seq()).max(1) - 1;
            let own = masses.get(since).map_or_else(ControlMasses::default, |(_, masses)| *masses);
            let sizes = (0..state.bearings()).map(|bearing| state.force(bearing)[1]).map(|[y, z]| y.hypot(z));
            let delivered = own.largest(sizes);
            see(state, delivered);
            // A turn tells the worst until then: that of an alarm that never ended is for us to find.
            for entry in alarms.iter_mut().filter(|entry| entry.fell.is_none() && entry.rose.seq <= state.seq()) {
                let value = match entry.watch {
                    Watch::Orbit => state.largest_radius(),
                    Watch::Force => delivered,
                    _ => continue,
                };
                entry.worst = entry.worst.max(value);
            }
            larger(&mut force, PeakInfo { value: delivered, at, mass: None });
            for (mass, point) in state.points().enumerate() {
                larger(&mut radius, PeakInfo { value: point.radius(), at, mass: Some(mass + 1) });
            }
            ControlFlow::Continue(())
        })?;
        let session = recording.session();
        let span = recording.span();
        let rows = recording.rows();
        let seconds = span.map_or(0.0, |span| span.seconds());
        let counted = span.map_or(0, |span| span.last.seq - span.first.seq);
        let trips = recording.events().iter().filter_map(|event| match &event.happening {
            Happening::Tripped(trip) => {
                Some(TripInfo { at: event.at.into(), why: trip.told(recording.scales()), revision: event.revision })
            }
            _ => None,
        });
        for entry in alarms.iter_mut().filter(|entry| entry.fell.is_none() && entry.watch == Watch::Damping) {
            let since = in_force.iter().filter(|r| r.from >= entry.rose.seq && !r.poles.is_empty());
            entry.worst = since.map(|r| r.min_damping).fold(entry.worst, f64::min);
        }
        let limited = || Watch::ALL.into_iter().filter(|watch| watch.has_limits());
        let pairs = |limits: &Limits| limited().map(|watch| (watch.name(), limits.pair(watch))).collect();
        Ok(Self {
            file: recording.path().display().to_string(),
            parts: recording.paths().iter().map(|path| path.display().to_string()).collect(),
            bytes: recording.bytes(),
            schema: session.schema,
            whirl: session.whirl.clone(),
            simulation: session.simulation.clone(),
            run_id: format!("{:016x}", session.run_id),
            bench: session.bench.clone(),
            source: session.source.name(),
            rotor: recording.rotor().name().to_owned(),
            masses: recording.rotor().len(),
            rate_hz: session.rate_hz,
            measured_rate_hz: (seconds > 0.0 && session.rate_hz > 0.0).then(|| counted as f64 / seconds),
            dtau: session.dtau,
            steps: rows,
            first: span.map(|span| span.first.into()),
            last: span.map(|span| span.last.into()),
            seconds,
            lost: recording.gaps().iter().map(|gap| gap.count).sum(),
            settings_changes: in_force.len().saturating_sub(1),
            events: recording.events().len(),
            trips: trips.collect(),
            alarms: alarms.iter().map(AlarmInfo::from).collect(),
            alarm_limits: session.limits.as_ref().map(pairs),
            min_damping: damping,
            max_force: force,
            max_radius: radius,
            snapshots: recording.snapshots(),
            checksums: recording.has_checksums(),
            damage: recording.damage().to_vec(),
            notices: recording.notices(),
        })
    }
}

fn larger(peak: &mut Option<PeakInfo>, candidate: PeakInfo) {
    if peak.is_none_or(|peak| candidate.value > peak.value) {
        *peak = Some(candidate);
    }
}
