//! `whirl run`: one simulation from rest, offline.

mod out;
mod print;
mod typed;

use std::path::PathBuf;
use std::time::Instant;

use machine::Program;
use rotor::profile::Profile;
use study::run::{Impulse, Observer, Outcome, Plan, RunError, Settle};
use study::spectrum::{self, Collector, Peak, Spectrum};
use units::Dimension;

use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::MachineArgs;
use crate::output::Format;
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};

use out::Out;
use typed::{ImpulseArg, MassArg};

/// Options of `whirl run`.
#[derive(Debug, clap::Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speed R = w / w0 (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, required_unless_present = "profile", value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    /// Legs of speed from a file instead of a steady speed
    #[arg(long, value_name = "FILE", conflicts_with = "speed")]
    profile: Option<String>,
    /// How long, in tau = w0 t for any rotor [default: as long as the profile]
    #[arg(long, value_name = "TAU", allow_negative_numbers = true, required_unless_present = "profile", value_parser = quantity::of(Dimension::Time))]
    duration: Option<TypedQuantity>,
    /// Step of the integration, in tau [default: 126 steps to the fastest turn of any mode or the spin, at most 0.05]
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time))]
    dtau: Option<TypedQuantity>,
    /// Take maxima and means from this tau on [default: 0 with impulses or a profile, else from where transients have died]
    #[arg(long, value_name = "T0", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Time))]
    settle: Option<TypedQuantity>,
    /// A sudden change of velocity in w0 e_t (SI rotors: in m/s, or as it says), mass=N[,vy=V][,vz=V][,at=TAU] (repeatable)
    #[arg(long, value_name = "IMPULSE", allow_hyphen_values = true)]
    impulse: Vec<ImpulseArg>,
    /// Write the trajectory, dimensionless for any rotor, to FILE.csv, FILE.parquet or, as a recording, FILE.rrd
    #[arg(long, value_name = "FILE", group = "written")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Write one step in every N
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..), requires = "out")]
    every: u64,
    /// Two-sided power spectral density of y + j z at a mass, once settled
    #[arg(long, value_name = "mass=N")]
    psd: Option<MassArg>,
    #[command(flatten)]
    format: Format,
}

/// Simulates, and prints what came out.
///
/// # Errors
/// A machine that cannot be made, a step that is too large, a file that cannot be written, an interrupt.
pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let mut machine = Machine::open(&args.machine, args.speed, catalog::Default::Analysis)?;
    let profile = args.profile.as_deref().map(|path| catalog::profile(&machine.rotor, path)).transpose()?;
    if let Some(profile) = &profile {
        args.machine.leaves_speed_alone("--profile")?;
        machine.settings.speed = profile.ends_at();
    }
    let plan = plan(args, &machine, profile.as_ref())?;
    let stop = interrupt::flag()?;

    let last_impulse = plan.impulses.iter().map(|i| i.at).fold(0.0, f64::max);
    let mut collector = args.psd.map(|MassArg(mass)| {
        // A fifth of a radian of the fastest turn between samples keeps what is worth seeing well below Nyquist.
        let Machine { rotor, settings, .. } = &machine;
        let fastest = machine::fastest(rotor, settings, settings.speed).map_or(1.0, |f| f.frequency());
        Collector::new(mass - 1, (0.2 / (plan.dtau * fastest)).max(1.0) as u64, last_impulse)
    });
    let mut writer = match &args.out {
        Some(path) => Some(Out::open(path, args.force, &machine, &plan, args.every)?),
        None => None,
    };
    let mut observers: Vec<&mut dyn Observer> = Vec::new();
    observers.extend(collector.as_mut().map(|c| c as &mut dyn Observer));
    observers.extend(writer.as_mut().map(Out::observer));

    let began = Instant::now();
    let outcome = study::run::run(&plan, &mut observers, &stop)?;
    let seconds = began.elapsed().as_secs_f64();

    let spectrum = match (&collector, args.psd) {
        (Some(collector), Some(MassArg(mass))) => Some(psd(collector, mass, &outcome, machine.settings.speed)?),
        _ => None,
    };
    if let Some(writer) = writer {
        writer.finish()?;
    }
    print::print(args.format, &machine, outcome, seconds, spectrum, args.profile.as_deref())
}

/// What to simulate, checked.
fn plan(args: &RunArgs, machine: &Machine, profile: Option<&Profile>) -> Result<Plan, Failure> {
    let (Machine { rotor, settings, .. }, units) = (machine, machine.units());
    let usage = |message: String| Err(Failure::Usage(message));
    let time = |option: &str, typed: Option<TypedQuantity>| {
        typed.map(|typed| units.read_dimensionless(option, typed)).transpose()
    };
    let (settle, dtau) = (time("--settle", args.settle)?, time("--dtau", args.dtau)?);
    let duration = time("--duration", args.duration)?.or(profile.map(Profile::duration)).unwrap_or(f64::NAN);
    if !(duration.is_finite() && duration > 0.0) {
        return usage(format!("duration = {duration}: expected a finite number greater than 0"));
    }
    if let Some(settle) = settle
        && !(0.0..=duration).contains(&settle)
    {
        return usage(format!("settle = {settle}: expected a number from 0 to the duration, {duration}"));
    }
    let masses = args.impulse.iter().map(|i| ("impulse", i.mass)).chain(args.psd.map(|m| ("psd", m.0)));
    for (what, mass) in masses {
        if mass > rotor.len() {
            return usage(format!("{what} at mass {mass}, but {} has masses 1 to {}", rotor.name(), rotor.len()));
        }
    }
    let mut impulses = Vec::new();
    for impulse in &args.impulse {
        let (change, at) = impulse.value(units)?;
        // One at the very end would move nothing that is simulated.
        if at >= duration {
            return usage(format!("impulse at {at}, but the run ends at {duration}: expected a time before its end"));
        }
        impulses.push(Impulse { mass: impulse.mass - 1, change, at });
    }
    if args.psd.is_some() && args.format.csv {
        return usage("--psd has no place in the rows of --csv: --json has the spectrum whole".into());
    }
    // Where the speed changes, the step suits the lowest and the highest.
    let speeds = profile.map_or([settings.speed; 2], Profile::speeds);
    let dtau = match dtau {
        Some(dtau) => {
            // At every speed that it comes to: the leg that is to blame is named.
            let course = profile.map_or_else(|| vec![(0.0, settings.speed)], Profile::course);
            for (k, (_, speed)) in course.into_iter().enumerate() {
                let leg =
                    profile.zip(k.checked_sub(1)).map_or(String::new(), |(profile, leg)| profile.leg_words(leg) + ": ");
                let checked = machine::fastest(rotor, settings, speed)?.check(dtau);
                checked.map_err(|error| Failure::Usage(format!("{leg}{error}")))?;
            }
            dtau
        }
        None => machine::default_step_over(rotor, settings, speeds)?,
    };
    let program = |dtau| {
        let program = Program::in_substeps(rotor, settings, dtau, 1)?;
        Ok::<_, Failure>(match profile {
            Some(profile) => program.along(profile),
            None => program,
        })
    };
    let mut plan = Plan {
        program: program(dtau)?,
        start: None,
        impulses,
        dtau,
        duration,
        settle: match settle {
            Some(from) => Settle::From(from),
            None if args.impulse.is_empty() && profile.is_none() => Settle::Detect,
            None => Settle::From(0.0),
        },
    };
    // For the steps that it makes, as whoever goes on from a recording of it compiles it.
    plan.program = program(plan.longest_step())?;
    Ok(plan)
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Interrupted => Self::Interrupted,
            RunError::TooLong(_) => Self::Usage(error.to_string()),
            RunError::Poles(error) => error.into(),
            RunError::LoopPoles(error) => error.into(),
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
