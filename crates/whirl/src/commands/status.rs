//! `whirl status`: which benches run, how well, who is attached, and who records.

use std::time::{Duration, Instant};

use serde::Serialize;
use wire::message::ControlHealth;
use wire::{BenchStatus, Glance, Keeping, MAX_READERS, RecorderState, RecorderStatus, Root, WireError};

use crate::attach;
use crate::failure::Failure;
use crate::logging;
use crate::output::{Cell, Format, Table};
use crate::units::CommandUnits;

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
    benches: Vec<BenchDocument>,
    /// Where dashboards log, if `WHIRL_LOG` asks them to.
    log: String,
}

/// One bench, as scripts read it. Of one that does not answer only the name and the processes are known: the rest is
/// `null`, and `why` says so.
#[derive(Debug, Serialize)]
struct BenchDocument {
    name: String,
    answers: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    rotor: Option<String>,
    speed: Option<f64>,
    /// The same of an SI rotor in rpm.
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_rpm: Option<f64>,
    /// What turns the dimensionless numbers of an SI rotor into those in SI units.
    #[serde(skip_serializing_if = "Option::is_none")]
    scales: Option<rotor::Scales>,
    /// Those in which people are told; scripts read `R`.
    #[serde(skip)]
    units: CommandUnits,
    /// The leg of its profile that the speed is on, and how many there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    leg: Option<[u16; 2]>,
    rate_hz: Option<f64>,
    dtau: Option<f64>,
    /// Runge-Kutta steps that make one step.
    substeps: Option<u32>,
    steps: Option<u64>,
    late: Option<u64>,
    missed: Option<u64>,
    lateness_us: Lateness,
    step_cost_us: Cost,
    min_damping: Option<f64>,
    revision: Option<u64>,
    subscribers: u32,
    /// There is no room for another reader.
    full: bool,
    attached: Vec<Attached>,
    /// Who controls it from outside; `null` where nobody has.
    control: Option<Control>,
    recording: Option<Recording>,
    tripped: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trip: Option<String>,
    run_id: Option<String>,
    pid: u32,
    version: Option<String>,
}

/// How its controller outside does.
#[derive(Debug, Serialize)]
struct Control {
    acting: bool,
    taken: u64,
    late: u64,
    missed: u64,
    refused: u64,
    took_over: u64,
    lost: u64,
    /// How long after their readings commands were sent; `null` where they do not tell.
    age_us: Age,
}

#[derive(Debug, Serialize)]
struct Age {
    p50: Option<f64>,
    p99: Option<f64>,
}

impl Control {
    fn of(health: &ControlHealth) -> Option<Self> {
        let ControlHealth { taken, late, missed, refused, took_over, lost, age_p50_us, age_p99_us, acting, .. } =
            *health;
        let told = |us: f64| Some(us).filter(|us| *us > 0.0);
        let age_us = Age { p50: told(age_p50_us), p99: told(age_p99_us) };
        let acting = acting != 0;
        (taken + refused > 0).then_some(Self { acting, taken, late, missed, refused, took_over, lost, age_us })
    }

    /// How it stands, for people.
    fn state(&self) -> String {
        let Self { taken, late, missed, refused, lost, .. } = self;
        let who = if self.acting { "controlled from outside" } else { "the controller outside does not act" };
        let age = self.age_us.p50.map_or_else(String::new, |us| format!(", age {us:.0} us"));
        format!("{who}: {taken} commands, {late} late, {missed} missed, {refused} refused, lost {lost} times{age}")
    }
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
    p50: Option<f64>,
    p99: Option<f64>,
    max: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Cost {
    p50: Option<f64>,
    p99: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Attached {
    role: String,
    pid: u32,
}

impl Attached {
    /// Whether it reads the motion, and is not the simulation or somebody who looks or asks, as we do.
    fn is_reader(&self) -> bool {
        !["sim", "set", "note", "status", "wire", "clean"].contains(&self.role.as_str())
    }
}

impl BenchDocument {
    /// A bench as its bench status tells it; without one, as it is seen from outside, and why there is none.
    fn new(
        name: String,
        told: Result<Box<BenchStatus>, String>,
        attached: Vec<Attached>,
        recording: Option<Recording>,
    ) -> Self {
        let (bench_status, why) = match told {
            Ok(bench_status) => (Some(bench_status), None),
            Err(why) => (None, Some(why)),
        };
        let bench_status = bench_status.as_deref();
        let health = bench_status.map(|bench_status| &bench_status.health);
        let trip = bench_status.map(|bench_status| bench_status.trip);
        let readers = attached.iter().filter(|process| process.is_reader()).count();
        Self {
            name,
            answers: bench_status.is_some(),
            why,
            rotor: bench_status.map(|bench_status| bench_status.rotor_name.as_str().to_owned()),
            // Which may be on its way to the one that is set.
            speed: bench_status.map(|bench_status| bench_status.present_speed()),
            speed_rpm: bench_status.and_then(|status| Some(status.scales()?.rpm(status.present_speed()))),
            scales: bench_status.and_then(|bench_status| bench_status.scales()),
            units: CommandUnits::with(bench_status.and_then(|bench_status| bench_status.scales())),
            leg: bench_status.map(|bench_status| bench_status.leg).filter(|[_, legs]| *legs > 0),
            rate_hz: bench_status.map(|bench_status| bench_status.rate_hz),
            dtau: bench_status.map(|bench_status| bench_status.dtau),
            substeps: bench_status.map(|bench_status| bench_status.substeps),
            steps: health.map(|health| health.steps),
            late: health.map(|health| health.late),
            missed: health.map(|health| health.missed),
            lateness_us: Lateness {
                p50: health.map(|health| health.lateness_p50_us),
                p99: health.map(|health| health.lateness_p99_us),
                max: health.map(|health| health.lateness_max_us),
            },
            step_cost_us: Cost {
                p50: health.map(|health| health.cost_p50_us),
                p99: health.map(|health| health.cost_p99_us),
            },
            min_damping: bench_status
                .map(|bench_status| bench_status.analysis)
                .filter(|analysis| analysis.count > 0)
                .map(|analysis| analysis.min_damping),
            revision: bench_status.map(|bench_status| bench_status.revision),
            subscribers: readers as u32,
            full: readers.max(health.map_or(0, |health| health.subscribers as usize)) >= MAX_READERS,
            control: bench_status.and_then(|bench_status| Control::of(&bench_status.control)),
            recording,
            tripped: trip.map(|trip| trip.is_tripped()),
            trip: trip
                .filter(|trip| trip.is_tripped())
                .map(|trip| trip.told(bench_status.and_then(|bench_status| bench_status.scales()))),
            run_id: bench_status.map(|bench_status| format!("{:016x}", bench_status.run_id)),
            // Of one that says nothing: iceoryx2 knows it.
            pid: bench_status.map_or_else(
                || attached.iter().find(|process| process.role == "sim").map_or(0, |process| process.pid),
                |bench_status| bench_status.pid,
            ),
            version: bench_status.map(|bench_status| bench_status.version.as_str().to_owned()),
            attached,
        }
    }

    /// How it stands, for people.
    fn state(&self) -> String {
        let mut state = match (&self.why, &self.trip) {
            (Some(why), _) => format!("DOES NOT ANSWER: {why}"),
            (None, Some(why)) => format!("TRIPPED: {why}"),
            (None, None) => "running".into(),
        };
        if let Some([leg, legs]) = self.leg {
            state += &format!("; leg {leg} of {legs} of its profile");
        }
        if self.full {
            state += &format!("; full: no room for more than {MAX_READERS} readers");
        }
        if let Some(control) = &self.control {
            state += &format!("; {}", control.state());
        }
        self.recording.as_ref().map_or(state.clone(), |recording| format!("{state}; {}", recording.state()))
    }
}

/// A cell of what is known; else a dash.
fn known<T>(value: &Option<T>) -> Cell
where
    for<'a> Cell: From<&'a T>,
{
    value.as_ref().map_or_else(|| Cell::Text("-".to_owned()), Cell::from)
}

/// What the recorder says, if it says something in time: it does so at least once a second.
fn first_word(glance: &mut impl Glance) -> Option<Recording> {
    let start = Instant::now();
    while start.elapsed() < RECORDER_PATIENCE {
        match glance.recorder() {
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
        // Even in a full house there is room to look.
        let glance = attach::glance(&carrier, &entry.name);
        if matches!(glance, Err(WireError::NoBench(_))) {
            // One that ends while we look is no longer running.
            continue;
        }
        // A recorder's word may take a moment; where nobody records there is nothing to wait for.
        let recorded = entry.processes.iter().any(|process| process.role == "record");
        let (told, recording) = match glance {
            Ok(mut glance) => {
                let bench_status = attach::first_bench_status(&mut glance, &entry.name);
                let told = bench_status.map_err(|_| "it is stopped, or overloaded".to_owned());
                (told, if recorded { first_word(&mut glance) } else { None })
            }
            Err(error) => (Err(error.to_string()), None),
        };
        let attached =
            entry.processes.into_iter().map(|process| Attached { role: process.role, pid: process.pid }).collect();
        benches.push(BenchDocument::new(entry.name.to_string(), told, attached, recording));
    }
    let mut table = Table::new(&[
        "bench",
        "rotor",
        "speed",
        "rate/s",
        "substeps",
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
            known(&bench.rotor),
            bench.speed.map_or_else(|| Cell::Text("-".to_owned()), |speed| Cell::Text(bench.units.speed_cell(speed))),
            known(&bench.rate_hz),
            known(&bench.substeps),
            known(&bench.steps),
            known(&bench.late),
            known(&bench.missed),
            bench.lateness_us.p50.map_or_else(|| Cell::Text("-".to_owned()), Cell::from),
            bench.lateness_us.p99.map_or_else(|| Cell::Text("-".to_owned()), Cell::from),
            bench.lateness_us.max.map_or_else(|| Cell::Text("-".to_owned()), Cell::from),
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
