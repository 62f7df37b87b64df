//! `--criteria`: one search for each criterion, and what each buys, side by side.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use rotor::file::FeedbackDocument;
use rotor::{Gain, GainKind};
use serde::Serialize;
use study::force::{LONGEST, until_settled};
use study::run::Settled;
use text::number::trimmed;
use tuner::{Measure, Problem, Region, Stop, Tuned, evaluate, tune};

use super::question::{self, Asked};
use super::summary::speed_text;
use super::typed::Criterion;
use super::{TuneArgs, Watch, answer, write_file};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, Table, rounded};
use crate::quantity::TypedQuantity;
use crate::units::UnitsDocument;

/// Speeds of the range that are simulated.
const SPEEDS: usize = 7;
/// The peak of the sensitivity that is kept if nobody says.
const PEAK: f64 = 2.0;
/// Weights of forward and backward whirl if nobody says: it is forward whirl that seals make unstable.
const WEIGHTS: [f64; 2] = [2.0, 1.0];
const REGION: Region = Region { damping: Some(0.1), decay: Some(0.1), frequency: Some(4.0) };
/// Limits that no margin misses: with them margins are told.
const ANY_PEAK: f64 = 1e12;
const ANY_DELAY: f64 = 1e-12;

const UNSTABLE: &str = "not stable at every condition";

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    criteria: &'a [Row<'a>],
    /// Speeds `R` that were simulated.
    speeds: &'a [f64],
    seed: u64,
    interrupted: bool,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// What one criterion came to.
#[derive(Debug, Serialize)]
struct Row<'a> {
    criterion: &'static str,
    /// What was made as large as can be, at its worst condition; `null` where there is no search.
    objective: Option<f64>,
    proven: bool,
    min_damping: Option<f64>,
    worst_speed: Option<f64>,
    /// The slowest decay, per unit of tau.
    decay: Option<f64>,
    /// The largest peak of the sensitivity, and the smallest delay margin, in tau.
    sensitivity: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensitivity_null: Option<&'static str>,
    delay: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    delay_null: Option<&'static str>,
    /// The largest cost of unbalance and noise `J`, in `e_t`.
    cost: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cost_null: Option<&'static str>,
    max_gain: Option<f64>,
    /// One for every clearance.
    simulated: Vec<Simulated>,
    feedback: Option<FeedbackDocument<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// What is wrong with it, or why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
}

/// The largest motion over the speeds, from rest, once transients have died.
#[derive(Debug, Serialize)]
struct Simulated {
    deadband: f64,
    /// Of any mass, in `e_t`; `null` where it left all bounds.
    orbit: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    orbit_null: Option<&'static str>,
    /// In `w0^2 e_t` on the mass of the first control bearing; likewise.
    force: Option<f64>,
    /// Whether it had settled at every speed.
    settled: bool,
}

/// The criteria that are asked for.
fn chosen(args: &TuneArgs) -> Vec<Criterion> {
    if args.criteria.contains(&Criterion::All) { Criterion::EACH.to_vec() } else { args.criteria.clone() }
}

fn file(folder: &Path, criterion: Criterion) -> PathBuf {
    folder.join(format!("{}.toml", criterion.name()))
}

/// Checks that files can be written into `folder`.
///
/// # Errors
/// It is a file, or holds one of them and nobody said `--force`.
pub(super) fn check(args: &TuneArgs, folder: &Path) -> Result<(), Failure> {
    if folder.exists() && !folder.is_dir() {
        return Err(Failure::Usage(format!("'{}' is a file: --criteria writes into a folder", folder.display())));
    }
    if !folder.is_dir() {
        return Ok(());
    }
    chosen(args).into_iter().try_for_each(|criterion| args.force.check(&file(folder, criterion)))
}

impl Criterion {
    /// Its problem.
    fn problem(self, args: &TuneArgs, asked: &Asked, base: &Problem) -> Result<Problem, Failure> {
        let [forward, backward] = WEIGHTS;
        let measure = match self {
            Self::All | Self::Ratio | Self::Sensitivity => Measure::default(),
            Self::Decay => Measure::Decay,
            Self::Weighted => question::weights(args)?.unwrap_or(Measure::Ratio { forward, backward }),
            Self::Region => question::region(args, asked.units())?.unwrap_or(Measure::Region(REGION)),
            Self::Cost => question::cost(args, asked.units())?,
        };
        let max_sensitivity = (self == Self::Sensitivity).then(|| args.max_sensitivity.unwrap_or(PEAK));
        Ok(Problem { measure, max_sensitivity, ..base.clone() })
    }
}

/// Searches, measures, prints and writes.
pub(super) fn run(args: &TuneArgs, asked: &Asked, flag: &AtomicBool) -> Result<(), Failure> {
    let [(bearing, sensors)] = &asked.choices()[..] else {
        return Err(Failure::Usage("--criteria is for one place: give --bearing and --sensors by number".into()));
    };
    let base = Problem { max_sensitivity: None, ..asked.problem(*bearing, sensors) };
    let (criteria, stop) = (chosen(args), Stop::when(flag));
    let clearances = clearances(args)?;
    // What is asked for by name must make sense; of all, what makes none is told.
    let problems: Vec<Problem> =
        criteria.iter().map(|criterion| criterion.problem(args, asked, &base)).collect::<Result<_, _>>()?;
    if !args.criteria.contains(&Criterion::All) {
        problems.iter().try_for_each(Problem::check)?;
    }
    let (from, to) = asked.family.speeds();
    let speeds = if from == to { vec![from] } else { crate::range::Range { from, to }.points(SPEEDS) };
    let watch = Watch::new();
    let found: Vec<OnceLock<Result<Tuned, String>>> = criteria.iter().map(|_| OnceLock::new()).collect();
    let mut rows = Vec::new();
    for ((criterion, problem), found) in criteria.iter().zip(&problems).zip(&found) {
        let searched = match problem.check() {
            Ok(()) => Ok(tune(problem, &args.options(problem), &|progress| watch.say(progress), stop)?),
            Err(error) => Err(error.to_string()),
        };
        watch.end();
        let searched = found.get_or_init(|| searched);
        let mut row = Row::of(*criterion, searched);
        if let Ok(tuned) = searched {
            row.measure(args, asked, problem, tuned, stop)?;
            for clearances in &clearances {
                match simulate(asked, tuned, &speeds, clearances, flag) {
                    Err(Failure::Interrupted) => break,
                    simulated => row.simulated.push(simulated?),
                }
            }
        }
        // A row that was broken off is not what the criterion buys.
        if stop.is_set() {
            break;
        }
        if let Ok(tuned) = searched {
            let is_kept = row.why.is_none() || args.write_unstable;
            if let Some(folder) = args.out.as_ref().filter(|_| is_kept) {
                std::fs::create_dir_all(folder)
                    .map_err(|error| Failure::Usage(format!("cannot make '{}': {error}", folder.display())))?;
                let path = file(folder, *criterion);
                let about = format!("criterion {}, {}", criterion.name(), asked.range_text);
                write_file(&path, args.force, (&tuned.feedback, asked.rotor()), &[about])?;
                row.file = Some(path.display().to_string());
            }
        }
        rows.push(row);
    }
    let told: Vec<&Result<Tuned, String>> = found[..rows.len()].iter().filter_map(OnceLock::get).collect();
    print(args, asked, &rows, &told, &speeds)?;
    if rows.len() < criteria.len() {
        return Err(Failure::Interrupted);
    }
    match told.iter().filter_map(|found| found.as_ref().ok()).find(|tuned| tuned.worst.stable() == Some(true)) {
        Some(_) => Ok(()),
        None => Err(Failure::Work("no criterion led to gains that hold the rotor at every condition".into())),
    }
}

/// Clearances to simulate, of every support bearing.
fn clearances(args: &TuneArgs) -> Result<Vec<Vec<f64>>, Failure> {
    if let Some(twice) = (1..args.deadband.len()).find(|&i| args.deadband[..i].contains(&args.deadband[i])) {
        return Err(Failure::Usage(format!("deadband {} is given twice: expected each once", args.deadband[twice])));
    }
    let each: Vec<Option<TypedQuantity>> =
        if args.deadband.is_empty() { vec![None] } else { args.deadband.iter().copied().map(Some).collect() };
    let of = |deadband: Option<TypedQuantity>| {
        let machine = MachineArgs { rotor: args.rotor.clone(), feedback: None, deadband, set: vec![] };
        let speed =
            args.speed.or(args.over.map(|over| TypedQuantity { dimension: over.dimension, typed: over.typed.from }));
        Ok(Machine::open(&machine, speed, crate::catalog::Default::Analysis)?.settings.deadband)
    };
    each.into_iter().map(of).collect()
}

/// From rest at every speed.
fn simulate(
    asked: &Asked,
    tuned: &Tuned,
    speeds: &[f64],
    clearances: &[f64],
    stop: &AtomicBool,
) -> Result<Simulated, Failure> {
    let deadband = clearances.iter().copied().fold(0.0, f64::max);
    let mut made = Simulated { deadband, orbit: Some(0.0), orbit_null: None, force: Some(0.0), settled: true };
    for &speed in speeds {
        let outcome = until_settled(asked.rotor(), &tuned.feedback, speed, clearances, LONGEST, stop)?;
        made.settled &= outcome.settled != Settled::No;
        if outcome.diverged_at.is_some() {
            (made.orbit, made.force, made.orbit_null) = (None, None, Some("the motion left all bounds"));
            break;
        }
        let orbit = outcome.max_displacement.iter().copied().fold(0.0, f64::max);
        made.orbit = made.orbit.map(|most| most.max(orbit));
        made.force = made.force.map(|most| most.max(outcome.max_force));
    }
    Ok(made)
}

impl<'a> Row<'a> {
    fn of(criterion: Criterion, found: &'a Result<Tuned, String>) -> Self {
        let tuned = found.as_ref().ok();
        Self {
            criterion: criterion.name(),
            objective: tuned.map(|tuned| tuned.worst.value).filter(|value| value.is_finite()),
            proven: tuned.is_some_and(|tuned| tuned.worst.proven),
            min_damping: None,
            worst_speed: None,
            decay: None,
            sensitivity: None,
            sensitivity_null: None,
            delay: None,
            delay_null: None,
            cost: None,
            cost_null: None,
            max_gain: tuned.map(Tuned::largest_gain),
            simulated: Vec::new(),
            feedback: tuned.map(|tuned| FeedbackDocument(&tuned.feedback)),
            file: None,
            why: found.as_ref().err().cloned(),
        }
    }

    /// What the gains are worth by every measure.
    fn measure(
        &mut self,
        args: &TuneArgs,
        asked: &Asked,
        problem: &Problem,
        tuned: &Tuned,
        stop: Stop,
    ) -> Result<(), Failure> {
        let judged = |measure: Measure, margins: bool| -> Result<Option<Tuned>, Failure> {
            let problem = Problem {
                measure,
                max_sensitivity: margins.then_some(ANY_PEAK),
                min_delay: margins.then_some(ANY_DELAY),
                ..problem.clone()
            };
            if problem.check().is_err() {
                return Ok(None);
            }
            let options = tuner::Options { prove: false, ..args.options(&problem) };
            Ok(Some(evaluate(&problem, &options, &tuned.gains, stop)?))
        };
        if let Some(damped) = judged(Measure::default(), false)? {
            (self.min_damping, self.worst_speed) = (Some(damped.worst.value), damped.worst.point.first().copied());
            if damped.worst.stable() != Some(true) {
                self.why = Some(format!("does not hold the rotor at {}", speed_text(asked.units(), self.worst_speed)));
            }
        }
        self.decay = judged(Measure::Decay, false)?.map(|judged| judged.worst.value);
        let holds = self.why.is_none();
        if let Some([(peak, _), (least, _)]) = judged(Measure::default(), true)?.and_then(|judged| judged.margins) {
            self.sensitivity = Some(peak.sensitivity.0).filter(|peak| holds && peak.is_finite());
            self.delay = least.delay.map(|(delay, _)| delay).filter(|_| holds);
        }
        let cost = judged(question::cost(args, asked.units())?, false)?.map(|judged| judged.worst.value);
        self.cost = cost.filter(|worth| *worth > 0.0 && holds).map(|worth| worth.sqrt().recip());
        let why = if holds { "not for such a loop" } else { UNSTABLE };
        self.sensitivity_null = self.sensitivity.is_none().then_some(why);
        let without_delay = if self.sensitivity.is_some() { "no delay makes it unstable" } else { why };
        self.delay_null = self.delay.is_none().then_some(without_delay);
        self.cost_null = self.cost.is_none().then_some(why);
        if holds {
            self.why = answer::short(problem, tuned);
        }
        Ok(())
    }
}

fn print(
    args: &TuneArgs,
    asked: &Asked,
    rows: &[Row<'_>],
    found: &[&Result<Tuned, String>],
    speeds: &[f64],
) -> Result<(), Failure> {
    let units = asked.units();
    let bearing = asked.choices()[0].0;
    let mass = asked.rotor().control_mass(bearing);
    let mut header: Vec<String> = ["criterion", "min damping"].map(String::from).to_vec();
    header.extend(units.pick(["decay", "peak S", "delay"], ["decay (1/s)", "peak S", "delay (s)"]).map(String::from));
    header.push(units.pick("cost", "cost (m)").into());
    header.push("max gain".into());
    let deadbands = rows.iter().find(|row| !row.simulated.is_empty()).map_or(&[][..], |row| &row.simulated);
    for simulated in deadbands {
        let gap = trimmed(units.length(simulated.deadband), 4);
        header.extend([format!("orbit g={gap}"), format!("force g={gap}")]);
    }
    let mut table = Table::new(&header);
    for row in rows {
        let number = |value: Option<f64>, without| value.map_or(Cell::Without(without), Cell::from);
        let mut cells = vec![
            Cell::from(&row.criterion),
            number(row.min_damping, "-"),
            number(row.decay.map(|decay| units.rate(decay)), "-"),
            number(row.sensitivity, "-"),
            number(row.delay.map(|delay| units.time(delay)), if row.sensitivity.is_some() { "any" } else { "-" }),
            number(row.cost.map(|cost| units.length(cost)), "-"),
            number(row.max_gain, "-"),
        ];
        let missing = deadbands.len() - row.simulated.len();
        for simulated in &row.simulated {
            cells.push(number(simulated.orbit.map(|orbit| units.length(orbit)), "diverged"));
            cells.push(number(simulated.force.map(|force| units.force(force, mass)), "diverged"));
        }
        cells.extend((0..2 * missing).map(|_| Cell::Without("-")));
        table.row(cells);
    }
    let mut lines: Vec<String> = Vec::new();
    for (row, found) in rows.iter().zip(found) {
        if let Ok(tuned) = found {
            lines.push(format!("{}: {}", row.criterion, gains(tuned)));
        }
    }
    for row in rows {
        lines.extend(row.why.as_ref().map(|why| format!("{}: {why}", row.criterion)));
        for simulated in row.simulated.iter().filter(|simulated| !simulated.settled) {
            let gap = trimmed(units.length(simulated.deadband), 4);
            lines.push(format!("{}: NOT settled everywhere with a clearance of {gap}", row.criterion));
        }
    }
    lines.push(format!(
        "orbit (of any mass{}) and force{}, with a clearance g: the largest of {} from rest, once transients have died",
        units.pick(", e_t", ", m"),
        units.pick(", w0^2 e_t", ", N"),
        if speeds.len() == 1 { "that speed".to_owned() } else { format!("{} speeds of the range", speeds.len()) },
    ));
    let all = chosen(args);
    let interrupted = rows.len() < all.len();
    if interrupted {
        let missing: Vec<&str> = all[rows.len()..].iter().map(|criterion| criterion.name()).collect();
        lines.push(format!("INTERRUPTED: nothing is told of {}", missing.join(", ")));
    }
    let document = Document {
        rotor: asked.rotor().name(),
        criteria: rows,
        speeds,
        seed: args.seed,
        interrupted,
        units: units.document(),
    };
    let heading = format!("{}, {}: what each criterion buys", asked.rotor().name(), asked.range_text);
    args.format.print(&document, &heading, &table, &lines.join("\n"))
}

/// Constant gains in a line.
fn gains(tuned: &Tuned) -> String {
    let signal = |signal: &rotor::Signal| {
        let gain = |kind: GainKind| match signal.gain(kind) {
            Gain::Constant(value) => format!("{} {}", kind.name(), rounded(*value)),
            _ => format!("{} over speed", kind.name()),
        };
        GainKind::ALL.map(gain).join(", ")
    };
    tuned.feedback.signals().map(signal).collect::<Vec<_>>().join("; ")
}
