//! `whirl run`: one simulation from rest, offline.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use rotor::{C64, Rotor, Settings};
use serde::Serialize;
use study::run::{Impulse, Observer, Outcome, Plan, RunError, Settle, Settled};
use study::spectrum::{self, Collector, Peak, Spectrum};
use study::step_size::Fastest;
use study::trajectory::{Form, Writer};

use crate::catalog::{self, Machine};
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{Cell, Format, Table, rounded};
use crate::units::Units;

/// Options of `whirl run`.
#[derive(Debug, clap::Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Any other setting, such as deadband.2=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Spin speed R = w / w0
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    speed: f64,
    /// How long, in tau = w0 t
    #[arg(long, value_name = "TAU", allow_negative_numbers = true)]
    duration: f64,
    /// Step of the integration, in tau [default: 126 steps to the fastest turn of any mode or the spin, at most 0.05]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    dtau: Option<f64>,
    /// Take maxima and means from this tau on [default: 0 with impulses, else from where transients have died]
    #[arg(long, value_name = "T0", allow_negative_numbers = true)]
    settle: Option<f64>,
    /// A sudden change of velocity, mass=N[,vy=V][,vz=V][,at=TAU] (repeatable)
    #[arg(long, value_name = "IMPULSE", allow_hyphen_values = true)]
    impulse: Vec<ImpulseArg>,
    /// Write the trajectory to FILE.csv or FILE.parquet
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write one step in every N
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..), requires = "out")]
    every: u64,
    /// Two-sided power spectral density of y + j z at a mass, once settled
    #[arg(long, value_name = "mass=N")]
    psd: Option<MassArg>,
    #[command(flatten)]
    format: Format,
}

/// An impulse as typed, the mass counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ImpulseArg {
    mass: usize,
    change: C64,
    at: f64,
}

impl FromStr for ImpulseArg {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5";
        let (mut mass, mut change, mut at) = (None, C64::ZERO, 0.0);
        for part in typed.split(',') {
            let (key, value) = part.split_once('=').ok_or(expected)?;
            let number = || {
                let parsed = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
                parsed.ok_or_else(|| format!("{key} = '{value}': expected a finite number"))
            };
            match key.trim() {
                "mass" => mass = Some(mass_number(value)?),
                "vy" => change.re = number()?,
                "vz" => change.im = number()?,
                "at" => at = number()?,
                _ => return Err(expected.into()),
            }
        }
        if at < 0.0 {
            return Err(format!("at = {at}: expected a time of 0 or later"));
        }
        Ok(Self { mass: mass.ok_or(expected)?, change, at })
    }
}

/// A mass as typed, `mass=N`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MassArg(usize);

impl FromStr for MassArg {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let number = typed.strip_prefix("mass=").ok_or("expected mass=N, such as mass=1")?;
        mass_number(number).map(Self)
    }
}

fn mass_number(typed: &str) -> Result<usize, String> {
    let parsed = typed.trim().parse().ok().filter(|n| *n > 0);
    parsed.ok_or_else(|| format!("mass = '{typed}': expected a mass, counted from 1"))
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    deadband: &'a [f64],
    dtau: f64,
    steps: u64,
    seconds: f64,
    diverged: bool,
    diverged_at: Option<f64>,
    /// How the motion came to rest; `given` where the command line said from when.
    settled: Settled,
    settled_at: Option<f64>,
    maxima_from: f64,
    max_force: f64,
    max_force_component: f64,
    max_displacement: Vec<f64>,
    mean_radius: Vec<f64>,
    #[serde(rename = "final")]
    last: FinalDocument,
    #[serde(skip_serializing_if = "Option::is_none")]
    psd: Option<PsdDocument>,
}

#[derive(Debug, Serialize)]
struct FinalDocument {
    tau: f64,
    masses: Vec<MassDocument>,
}

#[derive(Debug, Serialize)]
struct MassDocument {
    y: f64,
    z: f64,
    vy: f64,
    vz: f64,
}

/// The spectrum; densities are per radian per unit of tau.
#[derive(Debug, Serialize)]
struct PsdDocument {
    mass: usize,
    window: &'static str,
    segments: usize,
    resolution: f64,
    peaks: Vec<Peak>,
    frequency: Vec<f64>,
    density: Vec<f64>,
}

/// Simulates, and prints what came out.
///
/// # Errors
/// A machine that cannot be made, a step that is too large, a file that cannot be written, an interrupt.
pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let Machine { rotor, mut settings } = Machine::open(&args.machine, Some(args.speed), catalog::Default::Analysis)?;
    for assignment in &args.set {
        catalog::assign(&rotor, Units::of(&rotor), &mut settings, assignment)?;
    }
    settings.check(&rotor)?;
    let plan = plan(args, &rotor, &settings)?;
    let stop = interrupt::flag()?;

    let last_impulse = plan.impulses.iter().map(|i| i.at).filter(|at| *at <= plan.duration).fold(0.0, f64::max);
    let mut collector = args.psd.map(|MassArg(mass)| {
        // A fifth of a radian of the fastest turn between samples keeps what is worth seeing well below Nyquist.
        let fastest = Fastest::of(&plan.closed_loop).map_or(1.0, |f| f.frequency());
        Collector::new(mass - 1, (0.2 / (plan.dtau * fastest)).max(1.0) as u64, last_impulse)
    });
    let mut writer = match &args.out {
        Some(path) => Some(open(path, rotor.len(), args.every)?),
        None => None,
    };
    let mut observers: Vec<&mut dyn Observer> = Vec::new();
    observers.extend(collector.as_mut().map(|c| c as &mut dyn Observer));
    observers.extend(writer.as_mut().map(|w| w as &mut dyn Observer));

    let began = Instant::now();
    let outcome = study::run::run(&plan, &mut observers, &stop)?;
    let seconds = began.elapsed().as_secs_f64();

    let spectrum = match (&collector, args.psd) {
        (Some(collector), Some(MassArg(mass))) => Some(psd(collector, mass, &outcome, settings.speed)?),
        _ => None,
    };
    if let Some(writer) = writer {
        let path = args.out.as_deref().unwrap_or(Path::new(""));
        writer.finish().map_err(|error| cannot_write(path, &error))?;
    }
    print(args, &rotor, &settings, &plan, outcome, seconds, spectrum)
}

/// What to simulate, checked.
fn plan(args: &RunArgs, rotor: &Rotor, settings: &Settings) -> Result<Plan, Failure> {
    let usage = |message: String| Err(Failure::Usage(message));
    if !(args.duration.is_finite() && args.duration > 0.0) {
        return usage(format!("duration = {}: expected a finite number greater than 0", args.duration));
    }
    if let Some(settle) = args.settle
        && !(0.0..=args.duration).contains(&settle)
    {
        return usage(format!("settle = {settle}: expected a number from 0 to the duration, {}", args.duration));
    }
    let masses = args.impulse.iter().map(|i| ("impulse", i.mass)).chain(args.psd.map(|m| ("psd", m.0)));
    for (what, mass) in masses {
        if mass > rotor.len() {
            return usage(format!("{what} at mass {mass}, but {} has masses 1 to {}", rotor.name(), rotor.len()));
        }
    }
    let closed_loop = settings.closed_loop(rotor);
    let fastest = Fastest::of(&closed_loop)?;
    if let Some(dtau) = args.dtau {
        fastest.check(dtau).map_err(|error| Failure::Usage(error.to_string()))?;
    }
    Ok(Plan {
        closed_loop,
        largest_clearance: settings.deadband.iter().copied().fold(0.0, f64::max),
        impulses: args.impulse.iter().map(|i| Impulse { mass: i.mass - 1, change: i.change, at: i.at }).collect(),
        dtau: args.dtau.unwrap_or_else(|| fastest.default_step()),
        duration: args.duration,
        settle: match args.settle {
            Some(from) => Settle::From(from),
            None if args.impulse.is_empty() => Settle::Detect,
            None => Settle::From(0.0),
        },
    })
}

fn open(path: &Path, masses: usize, every: u64) -> Result<Writer, Failure> {
    let form = Form::of(path).map_err(|error| Failure::Usage(error.to_string()))?;
    if path.is_dir() {
        return Err(Failure::Usage(format!("'{}' is a directory: expected a file name", path.display())));
    }
    Writer::create(path, form, masses, every).map_err(|error| cannot_write(path, &error))
}

fn cannot_write(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Work(format!("cannot write '{}': {error}", path.display()))
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Interrupted => Self::Interrupted,
            RunError::TooLong(_) => Self::Usage(error.to_string()),
            RunError::Observer(error) => Self::Work(format!("cannot write the trajectory: {error}")),
        }
    }
}

fn psd(
    collector: &Collector,
    mass: usize,
    outcome: &Outcome,
    speed: f64,
) -> Result<(usize, Spectrum, Vec<Peak>), Failure> {
    let (samples, apart) = collector.samples_from(outcome.maxima_from);
    let spectrum = spectrum::welch(samples, apart, spectrum::segment_length(samples.len()))
        .map_err(|error| Failure::Work(error.to_string()))?;
    let peaks = spectrum.peaks(speed);
    Ok((mass, spectrum, peaks))
}

fn print(
    args: &RunArgs,
    rotor: &Rotor,
    settings: &Settings,
    plan: &Plan,
    outcome: Outcome,
    seconds: f64,
    spectrum: Option<(usize, Spectrum, Vec<Peak>)>,
) -> Result<(), Failure> {
    let mut table = Table::new(&["mass", "max radius", "mean radius", "y", "z", "vy", "vz"]);
    let last = &outcome.last;
    for (k, (p, v)) in last.displacement.iter().zip(&last.velocity).enumerate() {
        let numbers = [outcome.max_displacement[k], outcome.mean_radius[k], p.re, p.im, v.re, v.im];
        table.row([Cell::from(&(k + 1))].into_iter().chain(numbers.map(Cell::from)));
    }
    let heading = format!(
        "{} at R = {}, {} steps of {} to tau = {}; lengths in e_t, times in tau = w0 t",
        rotor.name(),
        settings.speed,
        outcome.steps,
        rounded(plan.dtau),
        rounded(last.tau)
    );
    let mut footer = vec![format!(
        "largest force |u| = {}, largest component {}; maxima and means from tau = {}{}",
        rounded(outcome.max_force),
        rounded(outcome.max_force_component),
        rounded(outcome.maxima_from),
        match outcome.settled {
            Settled::Given => "",
            Settled::Steady => ", where it had settled",
            Settled::Beating => ", beating but bounded",
            Settled::No => ", NOT settled",
        }
    )];
    footer.extend(outcome.diverged_at.map(|at| format!("DIVERGED at tau = {}", rounded(at))));
    if let Some((mass, _, peaks)) = &spectrum {
        footer.push(format!("spectral lines of mass {mass} (order, frequency, radius):"));
        footer.extend(
            peaks.iter().map(|p| format!("  {:>8}  {:>10}  {:>10}", p.name, rounded(p.frequency), rounded(p.radius))),
        );
    }
    let document = Document {
        rotor: rotor.name(),
        speed: settings.speed,
        deadband: &settings.deadband,
        dtau: plan.dtau,
        steps: outcome.steps,
        seconds,
        diverged: outcome.diverged_at.is_some(),
        diverged_at: outcome.diverged_at,
        settled: outcome.settled,
        settled_at: matches!(outcome.settled, Settled::Steady | Settled::Beating).then_some(outcome.maxima_from),
        maxima_from: outcome.maxima_from,
        max_force: outcome.max_force,
        max_force_component: outcome.max_force_component,
        max_displacement: outcome.max_displacement,
        mean_radius: outcome.mean_radius,
        last: FinalDocument {
            tau: last.tau,
            masses: last
                .displacement
                .iter()
                .zip(&last.velocity)
                .map(|(p, v)| MassDocument { y: p.re, z: p.im, vy: v.re, vz: v.im })
                .collect(),
        },
        psd: spectrum.map(|(mass, spectrum, peaks)| PsdDocument {
            mass,
            window: "hann",
            segments: spectrum.segments,
            resolution: spectrum.resolution(),
            peaks,
            frequency: spectrum.frequency,
            density: spectrum.density,
        }),
    };
    args.format.print(&document, &heading, &table, &footer.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impulses_read_as_typed() {
        let read = |typed: &str| typed.parse::<ImpulseArg>();
        assert_eq!(read("mass=1,vy=-2.5"), Ok(ImpulseArg { mass: 1, change: C64::new(-2.5, 0.0), at: 0.0 }));
        assert_eq!(read("vz=1,at=20,mass=3"), Ok(ImpulseArg { mass: 3, change: C64::new(0.0, 1.0), at: 20.0 }));
        for (typed, why) in [
            ("vy=1", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("mass=0,vy=1", "mass = '0': expected a mass, counted from 1"),
            ("mass=1,vy=nan", "vy = 'nan': expected a finite number"),
            ("mass=1,vy=1,at=-3", "at = -3: expected a time of 0 or later"),
        ] {
            assert_eq!(read(typed), Err(why.to_owned()), "{typed}");
        }
    }
}
