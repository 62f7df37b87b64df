//! `whirl status`: which benches run, how well, who is attached, and who records.

use std::time::{Duration, Instant};

use serde::Serialize;
use wire::{Bulletin, Carrier, Keeping, Listener, RecorderState, RecorderStatus, Root, SharedListener};

use crate::attach;
use crate::failure::Failure;
use crate::logging;
use crate::output::{Cell, Format, Table};

/// How long a recorder may take to say how it stands.
const RECORDER_PATIENCE: Duration = Duration::from_millis(1500);

/// Options of `whirl status`.
#[derive(Debug, clap::Args)]
pub(crate) struct StatusArgs {
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document {
    benches: Vec<Bench>,
    /// Where dashboards log, if `WHIRL_LOG` asks them to.
    log: String,
}

/// One bench, as scripts read it. Of one that does not answer only the name and the processes are known: its numbers
/// are `null` or 0.
#[derive(Debug, Serialize)]
struct Bench {
    name: String,
    answers: bool,
    rotor: String,
    speed: f64,
    rate_hz: f64,
    dtau: f64,
    steps: u64,
    late: u64,
    missed: u64,
    lateness_us: Lateness,
    step_cost_us: Cost,
    min_damping: Option<f64>,
    revision: u64,
    subscribers: u32,
    attached: Vec<Attached>,
    recording: Option<Recording>,
    tripped: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    trip: Option<String>,
    run_id: String,
    pid: u32,
    version: String,
}

/// What its recorder tells.
#[derive(Debug, Serialize)]
struct Recording {
    path: String,
    state: &'static str,
    bytes: u64,
    steps: u64,
    lost: u64,
    seconds: f64,
    part: u32,
    keep_s: Option<f64>,
    pretrigger_s: Option<f64>,
    error: Option<String>,
    pid: u32,
}

impl From<&RecorderStatus> for Recording {
    fn from(status: &RecorderStatus) -> Self {
        let (keep_s, pretrigger_s) = match status.keeping() {
            Keeping::All => (None, None),
            Keeping::Last(seconds) => (Some(seconds), None),
            Keeping::Pretrigger(seconds) => (None, Some(seconds)),
        };
        let error = status.error.as_str();
        Self {
            path: status.path.as_str().to_owned(),
            state: match status.state() {
                RecorderState::Recording => "recording",
                RecorderState::Stopped => "stopped",
                RecorderState::Failed => "failed",
                RecorderState::Died => "died",
            },
            bytes: status.bytes,
            steps: status.rows,
            lost: status.lost,
            seconds: status.wall_ns.saturating_sub(status.started_ns) as f64 / 1e9,
            part: status.part,
            keep_s,
            pretrigger_s,
            error: (!error.is_empty()).then(|| error.to_owned()),
            pid: status.pid,
        }
    }
}

impl Recording {
    /// How it stands, for people.
    fn state(&self) -> String {
        let Self { path, state, lost, .. } = self;
        let megabytes = self.bytes as f64 / 1e6;
        match &self.error {
            Some(why) => format!("recording {state}: {path}: {why}"),
            None => format!("{state} {path}, {:.0} s, {megabytes:.1} MB, {lost} lost", self.seconds),
        }
    }
}

#[derive(Debug, Serialize)]
struct Lateness {
    p50: f64,
    p99: f64,
    max: f64,
}

#[derive(Debug, Serialize)]
struct Cost {
    p50: f64,
    p99: f64,
}

#[derive(Debug, Serialize)]
struct Attached {
    role: String,
    pid: u32,
}

impl Bench {
    fn new(name: String, bulletin: &Bulletin, attached: Vec<Attached>, recording: Option<Recording>) -> Self {
        let health = &bulletin.health;
        Self {
            name,
            answers: true,
            rotor: bulletin.rotor_name.as_str().to_owned(),
            speed: bulletin.settings.speed,
            rate_hz: bulletin.rate_hz,
            dtau: bulletin.dtau,
            steps: health.steps,
            late: health.late,
            missed: health.missed,
            lateness_us: Lateness {
                p50: health.lateness_p50_us,
                p99: health.lateness_p99_us,
                max: health.lateness_max_us,
            },
            step_cost_us: Cost { p50: health.cost_p50_us, p99: health.cost_p99_us },
            min_damping: (bulletin.analysis.count > 0).then_some(bulletin.analysis.min_damping),
            revision: bulletin.revision,
            // Our own look at the bench is not one of its readers, nor is a client that sets something.
            subscribers: attached.iter().filter(|party| !["sim", "set", "note"].contains(&party.role.as_str())).count()
                as u32,
            recording,
            attached,
            tripped: bulletin.trip.is_tripped(),
            trip: bulletin.trip.is_tripped().then(|| bulletin.trip.to_string()),
            run_id: format!("{:016x}", bulletin.run_id),
            pid: bulletin.pid,
            version: bulletin.version.as_str().to_owned(),
        }
    }
}

impl Bench {
    /// A bench whose simulation lives but says nothing: it is stopped, or hopelessly behind.
    fn silent(name: String, attached: Vec<Attached>, recording: Option<Recording>) -> Self {
        let unknown = f64::NAN;
        let mut bulletin = Bulletin { rate_hz: unknown, dtau: unknown, ..Bulletin::default() };
        bulletin.settings.speed = unknown;
        let health = &mut bulletin.health;
        for number in [
            &mut health.lateness_p50_us,
            &mut health.lateness_p99_us,
            &mut health.lateness_max_us,
            &mut health.cost_p50_us,
            &mut health.cost_p99_us,
        ] {
            *number = unknown;
        }
        bulletin.pid = attached.iter().find(|party| party.role == "sim").map_or(0, |party| party.pid);
        Self { answers: false, ..Self::new(name, &bulletin, attached, recording) }
    }

    /// How it stands, for people.
    fn state(&self) -> String {
        let state = match &self.trip {
            _ if !self.answers => "DOES NOT ANSWER".into(),
            Some(why) => format!("TRIPPED: {why}"),
            None => "running".into(),
        };
        self.recording.as_ref().map_or(state.clone(), |recording| format!("{state}; {}", recording.state()))
    }
}

/// What the recorder says, if it says something in time: it does so at least once a second.
fn first_word(listener: &mut SharedListener) -> Option<Recording> {
    let start = Instant::now();
    while start.elapsed() < RECORDER_PATIENCE {
        match listener.recorder() {
            Ok(Some(status)) => return Some(Recording::from(&*status)),
            Ok(None) => std::thread::sleep(Duration::from_millis(5)),
            Err(_) => return None,
        }
    }
    None
}

/// Prints the benches; none is an answer too.
///
/// # Errors
/// The root cannot be read.
pub(crate) fn run(args: &StatusArgs) -> Result<(), Failure> {
    let carrier = attach::carrier("status")?;
    let log = logging::file(&Root::from_environment()?).display().to_string();
    let mut benches = Vec::new();
    for entry in carrier.benches()?.into_iter().filter(wire::BenchEntry::is_running) {
        // One that ends while we look is no longer running.
        let Ok(mut listener) = carrier.listen(&entry.name) else { continue };
        let bulletin = attach::first_bulletin(&mut listener, &entry.name);
        // A recorder's word may take a moment; where nobody records there is nothing to wait for.
        let recorded = entry.parties.iter().any(|party| party.role == "record");
        let recording = if recorded { first_word(&mut listener) } else { None };
        let attached = entry.parties.into_iter().map(|party| Attached { role: party.role, pid: party.pid }).collect();
        let name = entry.name.to_string();
        benches.push(match bulletin {
            Ok(bulletin) => Bench::new(name, &bulletin, attached, recording),
            Err(_) => Bench::silent(name, attached, recording),
        });
    }
    let mut table = Table::new(&[
        "bench",
        "rotor",
        "speed",
        "rate/s",
        "steps",
        "late",
        "missed",
        "late p50 us",
        "p99",
        "max",
        "readers",
        "state",
    ]);
    for bench in &benches {
        let readers: Vec<_> =
            bench.attached.iter().filter(|p| p.role != "sim").map(|p| format!("{}:{}", p.role, p.pid)).collect();
        table.row([
            Cell::from(&bench.name),
            Cell::from(&bench.rotor),
            Cell::from(&bench.speed),
            Cell::from(&bench.rate_hz),
            Cell::from(&bench.steps),
            Cell::from(&bench.late),
            Cell::from(&bench.missed),
            Cell::from(bench.lateness_us.p50),
            Cell::from(bench.lateness_us.p99),
            Cell::from(bench.lateness_us.max),
            Cell::from(&readers.join(" ")),
            Cell::from(&bench.state()),
        ]);
    }
    let footer = if benches.is_empty() {
        "no bench is running under this root: `whirl up` starts one".to_owned()
    } else {
        format!("dashboards log to {log} where WHIRL_LOG asks for it")
    };
    args.format.print(&Document { benches, log }, "", &table, &footer)
}
