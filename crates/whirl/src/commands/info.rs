//! `whirl info`: what a recording holds.

use std::fmt::Write as _;
use std::path::PathBuf;

use tape::{AlarmInfo, Info, MomentInfo, Recording};

use crate::failure::Failure;
use crate::output::{self, rounded};
use crate::units::Units;

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

/// Reads the recording whole, and tells.
///
/// # Errors
/// No such file, or no recording of ours.
pub(crate) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let mut recording = Recording::open_row(&args.files)?;
    let info = Info::of(&mut recording)?;
    if args.json { output::print_json(&info) } else { output::print_text(&for_people(&info, &recording)) }
}

/// In words, in the units of the rotor that was recorded.
fn for_people(info: &Info, recording: &Recording) -> String {
    let units = Units::with(recording.scales());
    let (length_unit, force_unit) = (units.length_unit(), units.force_unit());
    // A control is an acceleration: what force it is depends on the mass that carried the bearing then.
    let force_of = |control: f64, at: &MomentInfo| {
        let bearing =
            recording.settings_at(at.step).map_or(0, |revision| revision.settings.feedback.bearings[0].station);
        units.force(control, recording.rotor().masses().get(bearing).map_or(1.0, |mass| mass.mass))
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
