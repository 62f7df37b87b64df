//! `whirl info`: what a recording holds.

use std::fmt::Write as _;
use std::path::PathBuf;

use rotor::C64;
use serde::Serialize;
use study::runup::{OrderSample, RecordedCourse, RecordedLeg};
use tape::{AlarmInfo, Info, MomentInfo, Recording, Revision};
use wire::{State, Step};

use super::runup::CriticalDocument;
use crate::failure::Failure;
use crate::output::{self, rounded};
use crate::units::CommandUnits;

/// Options of `whirl info`.
#[derive(Debug, clap::Args)]
pub(crate) struct InfoArgs {
    /// The recording: any part of a split one stands for all; of several files, those alone
    #[arg(value_name = "FILE.rrd", required = true)]
    files: Vec<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    info: &'a Info,
    /// Stretches of the speed, in order; none where it is the same throughout.
    legs: Vec<LegDocument>,
    /// Critical speeds passed on them, as `whirl runup` finds them.
    criticals: Vec<CriticalDocument>,
    /// Why there may be some that are not told.
    #[serde(skip_serializing_if = "Option::is_none")]
    criticals_incomplete: Option<&'static str>,
}

#[derive(Debug, Serialize)]
struct LegDocument {
    steps: [u64; 2],
    tau: [f64; 2],
    speed: [f64; 2],
    rate: [f64; 2],
}

/// What legs without critical speeds are told with.
const TOO_COARSE: &str = "steps are too far apart to be read turn by turn";

/// Reads the recording whole, and tells.
///
/// # Errors
/// No such file, or no recording of ours.
pub(crate) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let mut recording = Recording::open_row(&args.files)?;
    let (info, legs) = read(&mut recording)?;
    if !args.json {
        return output::print_text(&for_people(&info, &legs, &recording));
    }
    let criticals = legs.iter().flat_map(|leg| leg.criticals.iter().flatten()).map(CriticalDocument::from).collect();
    let leg = |leg: &RecordedLeg| LegDocument { steps: leg.steps, tau: leg.tau, speed: leg.speed, rate: leg.rate };
    output::print_json(&Document {
        info: &info,
        legs: legs.iter().map(leg).collect(),
        criticals,
        criticals_incomplete: legs.iter().any(|leg| leg.criticals.is_none()).then_some(TOO_COARSE),
    })
}

/// What is in it, with the legs of its speed, in one pass over its steps.
fn read(recording: &mut Recording) -> Result<(Info, Vec<RecordedLeg>), Failure> {
    let revisions = recording.revisions().to_vec();
    let settings = |seq: u64| {
        let after = revisions.partition_point(|revision| revision.from <= seq);
        revisions.get(after.max(1) - 1).map(|Revision { settings, .. }| settings)
    };
    let mut course = RecordedCourse::new(recording.rotor());
    let mut motion: [Vec<C64>; 2] = Default::default();
    let info = Info::seeing(recording, |state: &State, force| {
        let [displacement, velocity] = &mut motion;
        displacement.clear();
        velocity.clear();
        for point in state.points() {
            displacement.push(C64::new(point.y, point.z));
            velocity.push(C64::new(point.vy, point.vz));
        }
        let sample =
            OrderSample { tau: state.tau(), angle: state.angle(), speed: state.speed(), displacement, velocity, force };
        course.see(state.seq(), &sample, state.speed_rate(), &settings);
    })?;
    Ok((info, course.legs(&settings)))
}

/// Legs and the critical speeds on each, a line each.
fn legs_for_people(legs: &[RecordedLeg], units: CommandUnits) -> Vec<(String, String)> {
    let speed = |value: f64| units.speed_text(rounded(value).parse().unwrap_or(value));
    let mut lines = Vec::new();
    for (k, leg) in legs.iter().enumerate() {
        let ([from, to], [begins, ends]) = (leg.speed, leg.tau);
        let way = if leg.rests() { format!("at {}", speed(to)) } else { format!("{} to {}", speed(from), speed(to)) };
        let lasts = units.time_text(rounded(ends - begins).parse().unwrap_or(ends - begins));
        lines.push((format!("leg {}", k + 1), format!("{way}, for {lasts}, from step {}", leg.steps[0])));
        match &leg.criticals {
            None if !leg.rests() => lines.push(("critical".into(), format!("not known: {TOO_COARSE}"))),
            found => lines.extend(found.iter().flatten().map(|critical| {
                let peak = critical.peak;
                let factor = peak
                    .amplification()
                    .map_or("no half-power points".into(), |factor| format!("amplification {}", rounded(factor)));
                let height = format!("{} {}", rounded(units.length(peak.height)), units.length_unit());
                let mass = critical.station + 1;
                ("critical".into(), format!("{}, mass {mass}: {height}, {factor}", speed(peak.speed)))
            })),
        }
    }
    lines
}

/// In words, in the units of the rotor that was recorded.
fn for_people(info: &Info, legs: &[RecordedLeg], recording: &Recording) -> String {
    let units = CommandUnits::with(recording.scales());
    let (length_unit, force_unit) = (units.length_unit(), units.force_unit());
    // A control is an acceleration: what force it is depends on the mass that carried the first bearing then.
    let force_of = |control: f64, at: &MomentInfo| {
        let bearing =
            recording.settings_at(at.step).map_or(0, |revision| revision.settings.feedback.bearings[0].station);
        units.force(control, recording.rotor().control_mass(bearing))
    };
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<12}{value}");
    };
    let at = |at: &MomentInfo| format!("step {}, tau {}", at.step, rounded(at.tau));
    let more = match &info.parts[..] {
        [_, .., last] => format!(" to {last}, {} parts", info.parts.len()),
        _ => String::new(),
    };
    line("file", format!("{}{more}, {:.1} MB, schema {}", info.file, info.bytes as f64 / 1e6, info.schema));
    let bench = if info.bench.is_empty() { String::new() } else { format!("bench {}, ", info.bench) };
    line(
        "run",
        format!(
            "{} ({}), {bench}{} of whirl {}, recorded by {}",
            info.run_id, info.source, info.rotor, info.simulation, info.whirl
        ),
    );
    let rate = info.measured_rate_hz.map_or(String::new(), |hz| format!(", {hz:.1}/s of {}/s", info.rate_hz));
    line("length", format!("{} steps in {:.1} s{rate}, {} lost", info.steps, info.seconds, info.lost));
    if let (Some(first), Some(last)) = (&info.first, &info.last) {
        line("from", at(first));
        line("to", at(last));
    }
    line(
        "happened",
        format!(
            "changes of settings: {}, trips: {}, alarms: {}, events of any kind: {}",
            info.settings_changes,
            info.trips.len(),
            info.alarm_limits.as_ref().map_or_else(|| "not judged".to_owned(), |_| info.alarms.len().to_string()),
            info.events
        ),
    );
    for (name, told) in legs_for_people(legs, units) {
        line(&name, told);
    }
    for trip in &info.trips {
        line("trip", format!("{}, revision {}: {}", at(&trip.at), trip.revision, trip.why));
    }
    for AlarmInfo { watch, level, worst, limit, from, to } in &info.alarms {
        let to = to.as_ref().map_or_else(|| "the end".to_owned(), at);
        let ([worst, limit], unit) = match *watch {
            "orbit" => ([*worst, *limit].map(|value| units.length(value)), format!(" {length_unit}")),
            "force" => ([*worst, *limit].map(|value| force_of(value, from)), format!(" {force_unit}")),
            _ => ([*worst, *limit], String::new()),
        };
        let past = format!("{watch} at worst {}{unit}, limit {}{unit}", rounded(worst), rounded(limit));
        line(level, format!("{past}, from {} to {to}", at(from)));
    }
    if let Some(damping) = info.min_damping {
        line(
            "damping",
            format!("least {} from {}, revision {}", rounded(damping.value), at(&damping.at), damping.revision),
        );
    }
    if let Some(force) = info.max_force {
        line(
            "force",
            format!("largest {} {force_unit} at {}", rounded(force_of(force.value, &force.at)), at(&force.at)),
        );
    }
    if let Some(radius) = info.max_radius {
        let mass = radius.mass.unwrap_or_default();
        line(
            "radius",
            format!(
                "largest {} {length_unit}, mass {mass}, at {}",
                rounded(units.length(radius.value)),
                at(&radius.at)
            ),
        );
    }
    for notice in &info.notices {
        line("note", notice.clone());
    }
    text
}
