//! `whirl set`: changes the settings of a running bench, all or nothing, and waits for its answer.

use std::time::Duration;

use machine::{StabilityLoss, TripAtOnce};
use serde::Serialize;
use wire::{Answer, BenchName, BenchStatus, SharedMemory, Step, WireError};

use crate::asking::{NotAccepted, SettingsRequest};
use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::units::CommandUnits;
use crate::{catalog, output};

/// How long the motion is looked at, at least and at most, before a limit comes down on it.
const LEAST_LOOK: Duration = Duration::from_millis(50);
const LOOK: Duration = Duration::from_millis(500);

/// Options of `whirl set`.
#[derive(Debug, clap::Args)]
pub(crate) struct SetArgs {
    /// What to change: speed, deadband, deadband.2 (mass 2), kd cd kc cc (first signal), kd.2 (second signal), trip,
    /// feedback=NAME or FILE; for an SI rotor in rpm, m, N/m and N s/m, or as they say, such as speed=50Hz and kd=2e5N/m
    #[arg(required = true, value_name = "KEY=VALUE")]
    assignments: Vec<String>,
    #[command(flatten)]
    bench: BenchArgs,
    /// Why, for the log of events: `whirl tail --events` shows it
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    why: String,
    /// Make the change even if a stable machine becomes unstable by it, or trips at once
    #[arg(long)]
    force: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The JSON document.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Document {
    Accepted {
        accepted: bool,
        /// False: it was in force already, from that step on.
        changed: bool,
        revision: u64,
        applied_at_step: u64,
        /// Runge-Kutta steps that make one step.
        substeps: u32,
    },
    Refused {
        accepted: bool,
        reason: String,
        /// Refused because of them: the minimum damping now and then.
        #[serde(skip_serializing_if = "Option::is_none")]
        min_damping: Option<Damping>,
        /// Refused because of it: the orbit now, and the limit that it is past, in `e_t`.
        #[serde(skip_serializing_if = "Option::is_none")]
        orbit: Option<Orbit>,
    },
    /// The bench was asked and has not answered: it may yet make the change.
    Unknown { accepted: Option<bool>, reason: String },
}

#[derive(Debug, Serialize)]
struct Damping {
    /// `null` where the poles cannot be computed.
    now: Option<f64>,
    then: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Orbit {
    now: f64,
    limit: f64,
}

/// A change that has been made, or was not needed.
struct Done {
    changed: bool,
    revision: u64,
    step: u64,
    /// Runge-Kutta steps that make one step, now and before.
    substeps: [u32; 2],
}

/// Why nothing was changed, as far as is known.
enum NotDone {
    /// It would make a stable machine unstable.
    Unstable(StabilityLoss),
    /// It would trip the machine at once, and how that is told.
    Trips(TripAtOnce, String),
    /// It was asked for, and no answer came.
    Unanswered(WireError),
    /// Anything else.
    Failed(Failure),
}

impl<F: Into<Failure>> From<F> for NotDone {
    fn from(failure: F) -> Self {
        Self::Failed(failure.into())
    }
}

impl From<NotAccepted> for NotDone {
    fn from(why: NotAccepted) -> Self {
        match why {
            NotAccepted::Unanswered(silence) => Self::Unanswered(silence),
            NotAccepted::Refused(reason) => Self::Failed(Failure::Work(reason)),
            NotAccepted::Failed(failure) => Self::Failed(failure),
        }
    }
}

/// Makes the change.
///
/// # Errors
/// A wrong key or value, no such bench, or a refusal.
pub(crate) fn run(args: &SetArgs) -> Result<(), Failure> {
    let (mut min_damping, mut orbit) = (None, None);
    let reason = match change(args) {
        Ok(Done { changed, revision, step, substeps: [substeps, before] }) => {
            if args.json {
                let document =
                    Document::Accepted { accepted: true, changed, revision, applied_at_step: step, substeps };
                return output::print_json(&document);
            }
            let already = if changed { "" } else { "nothing to change: " };
            let pace = if substeps == before { String::new() } else { format!(", {substeps} substeps a step") };
            return output::print_text(&format!("{already}revision {revision} from step {step}{pace}\n"));
        }
        // What is wrong with a change is a refusal, whoever notices it: the bench, or we before asking it.
        Err(NotDone::Failed(Failure::Usage(reason) | Failure::Work(reason))) => reason,
        Err(NotDone::Failed(failure)) => return Err(failure),
        Err(NotDone::Unanswered(silence)) => {
            if args.json {
                output::print_json(&Document::Unknown { accepted: None, reason: silence.to_string() })?;
            }
            return Err(attach::unanswered(&silence));
        }
        Err(NotDone::Unstable(loss)) => {
            min_damping = Some(Damping { now: loss.now, then: loss.then.map(|(_, damping)| damping) });
            format!("{loss}; --force makes it all the same")
        }
        Err(NotDone::Trips(TripAtOnce { orbit: now, limit }, told)) => {
            orbit = Some(Orbit { now, limit });
            format!("{told}; --force makes it all the same")
        }
    };
    if args.json {
        output::print_json(&Document::Refused { accepted: false, reason: reason.clone(), min_damping, orbit })?;
    }
    Err(Failure::Work(format!("not changed: {reason}")))
}

fn change(args: &SetArgs) -> Result<Done, NotDone> {
    let bench = args.bench.name()?;
    let carrier = attach::carrier("set")?;
    let mut glance = attach::glance(&carrier, &bench)?;
    let mut commander = attach::command(&carrier, &bench)?;
    let who = format!("set:{}", std::process::id());
    let mut asking = SettingsRequest::new(&who, &args.why);
    loop {
        let bench_status = attach::first_bench_status(&mut glance, &bench)?;
        let rotor = bench_status.rotor().map_err(|error| Failure::Work(error.to_string()))?;
        let units = CommandUnits::with(bench_status.scales());
        let before = bench_status.settings.get().clone();
        let mut settings = before.clone();
        catalog::assign_all(&rotor, units, &mut settings, &[], &args.assignments)?;
        settings.check(&rotor)?;
        if !args.force
            && let Some(loss) = StabilityLoss::between(&rotor, &before, &settings, bench_status.present_speed())
        {
            return Err(NotDone::Unstable(loss));
        }
        if !args.force && TripAtOnce::is_possible(&before, &settings) && !bench_status.trip.is_tripped() {
            let orbit = present_orbit(&carrier, &bench, &bench_status)?;
            if let Some(trips) = orbit.and_then(|orbit| TripAtOnce::between(&before, &settings, orbit)) {
                let length = telemetry::units::ScreenUnits::of_machine(&rotor, &before.feedback).length;
                return Err(NotDone::Trips(trips, trips.words(|value| length.told(value, 4))));
            }
        }
        let base_revision = bench_status.revision;
        if let Some(answer) = asking.ask(&mut commander, base_revision, settings)? {
            let changed = answer.revision != base_revision;
            let Answer { revision, applied_at_step: step, substeps, .. } = answer;
            return Ok(Done { changed, revision, step, substeps });
        }
    }
}

/// The largest orbit of any place over a turn of the rotor, or as much of one as there is patience for; nothing where no step comes.
fn present_orbit(carrier: &SharedMemory, bench: &BenchName, status: &BenchStatus) -> Result<Option<f64>, Failure> {
    let turn = std::f64::consts::TAU / status.present_speed().abs() / (status.dtau * status.rate_hz);
    let patience = LEAST_LOOK.max(Duration::try_from_secs_f64(turn).map_or(LOOK, |turn| turn.min(LOOK)));
    let mut listener = attach::listen(carrier, bench)?;
    let mut largest = None;
    let see = |step: &wire::StepRow<'_>| {
        let radius = step.largest_radius();
        largest = Some(largest.map_or(radius, |largest: f64| largest.max(radius)));
    };
    attach::look_at_motion(&mut listener, see, |passed, _| Ok(passed < patience))?;
    Ok(largest)
}
