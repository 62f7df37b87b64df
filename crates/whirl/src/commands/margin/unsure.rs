//! What `whirl margin` says of a machine that is not quite what is thought: slopes, the worst of a box, samples.

use std::fmt::Write;

use machine::{CountedModes, WORST};
use serde_json::{Map, Value, json};
use study::sweep::{Simulated, Task};
use tuner::Stop;
use variation::{Distribution, Model, Range, Samples, Sensitivities, Sensitivity, Worst};

use super::simulated::simulated;
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::output::{Cell, Table, rounded};
use crate::varied::{self, By, Varied, percent};

/// Quantiles of the damping of samples that are told.
pub(super) const QUANTILES: [&str; 7] = ["0.01", "0.05", "0.25", "0.5", "0.75", "0.95", "0.99"];
/// A part of a parameter whose effect is told.
const PART: f64 = 0.01;

/// How parameters are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Spread {
    /// All of a range alike
    Uniform,
    /// About its middle, three standard deviations to either end; nothing outside
    Normal,
}

impl From<Spread> for Distribution {
    fn from(spread: Spread) -> Self {
        match spread {
            Spread::Uniform => Self::Uniform,
            Spread::Normal => Self::Normal,
        }
    }
}

/// The options of a machine that is not quite what is thought.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("unsure").multiple(true).args(["wide", "vary"]).conflicts_with("over"))]
pub(super) struct Unsure {
    /// What every parameter does to damping and margins, the largest effects first; `--csv` has these rows
    #[arg(long, conflicts_with = "over", help_heading = "Not quite what is thought")]
    sensitivities: bool,
    /// The worst damping when every parameter of the rotor that is not 0 lies anywhere within so much of its value; of a drawing
    /// the mass and inertias of a disc by one factor (disc.1.inertia), and the moduli of a material (material.1.moduli)
    #[arg(id = "wide", long = "box", value_name = "P%", value_parser = part, help_heading = "Not quite what is thought")]
    wide: Option<f64>,
    /// The same of one parameter: damping.1=0.2..0.3, delay=0..0.1, shaft.2=10%; repeatable, and before what `--box` says. Settings are
    /// typed as for `--set`, a drawing's numbers in SI units, a chain's dimensionless
    #[arg(long, value_name = "KEY=A..B|P%", help_heading = "Not quite what is thought")]
    vary: Vec<Varied>,
    /// How sharply the worst is bounded where it can be proven
    #[arg(
        long,
        value_name = "T",
        default_value_t = 1e-3,
        requires = "unsure",
        help_heading = "Not quite what is thought"
    )]
    tolerance: f64,
    /// Draw so many machines whose parameters lie anywhere there
    #[arg(
        long,
        value_name = "N",
        requires = "unsure",
        value_parser = clap::value_parser!(u64).range(1..=100_000_000),
        help_heading = "Not quite what is thought"
    )]
    samples: Option<u64>,
    /// Simulate each of them from rest, with its clearances and limits, and tell how large orbits and forces get; `--vary` takes
    /// deadband and unbalance too then
    #[arg(long, requires = "samples", help_heading = "Not quite what is thought")]
    simulate: bool,
    /// How they are spread
    #[arg(
        long,
        value_enum,
        default_value = "uniform",
        requires = "samples",
        help_heading = "Not quite what is thought"
    )]
    distribution: Spread,
    /// What random numbers start from; the same seed draws the same machines, on any number of threads
    #[arg(
        long,
        value_name = "S",
        default_value_t = 1,
        requires = "unsure",
        help_heading = "Not quite what is thought"
    )]
    seed: u64,
}

fn part(typed: &str) -> Result<f64, String> {
    percent(typed).ok_or_else(|| format!("'{typed}': expected a part in per cent above 0 and below 100, such as 10%"))
}

/// What has come of them.
#[derive(Debug, Default)]
pub(super) struct UnsureTold {
    /// For scripts: `sensitivities`, `box`, `samples`, those that were asked for.
    pub(super) fields: Map<String, Value>,
    /// For people, after the margins.
    pub(super) text: String,
    /// Rows of the sensitivities, in place of the margins'.
    pub(super) rows: Option<Table>,
}

impl Unsure {
    /// Does what was asked for.
    ///
    /// # Errors
    /// A parameter that is none, or a value that it cannot have.
    pub(super) fn told(&self, machine: &Machine, modes: CountedModes) -> Result<UnsureTold, Failure> {
        let model = Model::new(machine.rotor.clone(), machine.settings.clone()).counting(modes);
        let mut told = UnsureTold::default();
        if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            return Err(Failure::Usage(format!("--tolerance {}: expected a finite number above 0", self.tolerance)));
        }
        if self.sensitivities {
            let mut found = variation::sensitivities(&model, &model.parameters())?;
            found.rank();
            told.fields.insert("sensitivities".into(), found.each.iter().map(|of| slope(of, &found)).collect());
            let table = table(machine, &found);
            told.text += &format!(
                "\nslopes by every parameter, the largest effects of a relative change first\n{}",
                table.to_text()
            );
            told.text += "per 1 %: what 1 % more of it adds to the smallest damping, in tau to the delay margin, to the peak of the sensitivity\n";
            told.text += "what is 0, or off, has the slope that it would begin with; gain: all gains together; factor: what a clearance leaves of a bearing\n";
            told.rows = Some(table);
        }
        let ranges = self.ranges(machine, &model)?;
        if ranges.is_empty() {
            return Ok(told);
        }
        // What plays no part in damping makes no box wider.
        let linear: Vec<Range> = ranges.iter().filter(|range| range.parameter.is_linear()).cloned().collect();
        if !linear.is_empty() {
            let worst = variation::worst(&model, &linear, self.tolerance, self.seed, Stop::NEVER)?;
            let joined = joined(&model, &linear);
            told.fields.insert("box".into(), of_box(&linear, &worst, &joined));
            told.text += &box_text(machine, &linear, &worst, &joined);
        }
        if let Some(count) = self.samples {
            let word = match self.distribution {
                Spread::Uniform => "uniform",
                Spread::Normal => "normal",
            };
            let drawn = variation::samples(&model, &ranges, self.distribution.into(), self.seed, [0, count], &|_| ());
            let samples = Samples::of(drawn.map_err(|error| Failure::Work(error.to_string()))?);
            let quantile = |name: &&str| samples.quantile(name.parse().unwrap_or(0.5));
            let quantiles: Map<String, Value> =
                QUANTILES.iter().map(|name| ((*name).to_owned(), json!(quantile(name)))).collect();
            told.fields.insert(
                "samples".into(),
                json!({
                    "count": count,
                    "seed": self.seed,
                    "distribution": word,
                    "stable_share": samples.stable.share,
                    "interval": samples.stable.interval,
                    "quantiles": quantiles,
                }),
            );
            let [low, high] = samples.stable.interval.map(|end| rounded(100.0 * end));
            let share = rounded(100.0 * samples.stable.share);
            let _ = writeln!(
                told.text,
                "\n{count} samples, {word}, seed {}: {share} % are stable (95 %: {low} to {high} %)",
                self.seed
            );
            let each: Vec<String> =
                QUANTILES.iter().map(|name| format!("{name}: {}", rounded(quantile(name)))).collect();
            let _ = writeln!(told.text, "quantiles of the smallest damping  {}", each.join("  "));
            if self.simulate {
                let drawn = (self.distribution.into(), self.seed);
                let (fields, text) = simulated(machine, &model, &ranges, drawn, count)?;
                told.fields["samples"]["simulated"] = fields;
                told.text += &text;
            }
        }
        Ok(told)
    }

    /// The samples as rows, for a sweep.
    ///
    /// # Errors
    /// No samples, or a parameter that is none.
    pub(super) fn task(&self, machine: &Machine, modes: CountedModes) -> Result<Task, Failure> {
        let model = Model::new(machine.rotor.clone(), machine.settings.clone()).counting(modes);
        let Some(count) = self.samples else {
            return Err(Failure::Usage("expected --samples N: a sweep cuts samples into shards".into()));
        };
        let ranges = self.ranges(machine, &model)?;
        let units = ranges.iter().map(|range| varied::shown(machine, &range.parameter, 1.0)).collect();
        let distribution = self.distribution.into();
        let shown = machine.units();
        let simulated = self
            .simulate
            .then(|| Simulated { orbit: shown.length(1.0), force: shown.force(1.0, machine.bearing_mass()) });
        Ok(Task::Samples { model, ranges, distribution, seed: self.seed, count, units, simulated })
    }

    /// The parameters that vary, each once.
    fn ranges(&self, machine: &Machine, model: &Model) -> Result<Vec<Range>, Failure> {
        let mut ranges: Vec<Range> = Vec::new();
        for varied in &self.vary {
            let range = varied::range(machine, model, varied)?;
            if !range.parameter.is_linear() && !self.simulate {
                let key = &varied.key;
                return Err(Failure::Usage(format!(
                    "--vary {key}: it plays no part in damping: the linear rotor has none; with --samples N --simulate it does"
                )));
            }
            if ranges.iter().any(|other| other.parameter.quantity == range.parameter.quantity) {
                return Err(Failure::Usage(format!("{} is given twice: expected each key once", varied.key)));
            }
            ranges.push(range);
        }
        if let Some(part) = self.wide {
            let said: Vec<_> = ranges.iter().map(|range| &range.parameter).collect();
            for parameter in model.unsure(&said) {
                let varied = Varied { key: parameter.name().to_owned(), by: By::Part(part) };
                ranges.push(varied::range(machine, model, &varied)?);
            }
        }
        Ok(ranges)
    }
}

/// A slope of each margin, under the names that margins have among scripts.
fn margins_of(of: &Sensitivity) -> Map<String, Value> {
    let named = WORST.iter().zip(of.margins).map(|(name, slope)| {
        // An angle is told in degrees.
        let slope = if *name == "phase" { slope.map(f64::to_degrees) } else { slope };
        (name.replace(' ', "_"), json!(slope))
    });
    named.collect()
}

fn slope(of: &Sensitivity, all: &Sensitivities) -> Value {
    let mut made = json!({"parameter": of.parameter.name(), "value": of.value, "margins": margins_of(of)});
    if !of.value.is_finite() {
        made["value_null"] = json!("it is off");
    }
    match &of.min_damping {
        Ok(slope) => {
            made["min_damping"] = json!(slope.one());
            if slope.one().is_none() {
                made["min_damping_null"] = json!(format!("{} modes have the smallest damping", all.modes.len()));
                made["down"] = json!(slope.down);
                made["up"] = json!(slope.up);
            }
        }
        Err(why) => {
            made["min_damping"] = Value::Null;
            made["min_damping_null"] = json!(why.to_string());
        }
    }
    made
}

fn table(machine: &Machine, found: &Sensitivities) -> Table {
    let mut table = Table::new(&[
        "parameter",
        "value",
        "damping per unit",
        "damping per 1 %",
        "delay per 1 %",
        "sensitivity per 1 %",
    ]);
    for of in &found.each {
        let unit = varied::shown(machine, &of.parameter, 1.0);
        let value = varied::shown(machine, &of.parameter, of.value);
        let relative = |slope: Option<f64>| match slope {
            Some(slope) if of.value != 0.0 && of.value.is_finite() => Cell::from(slope * of.value * PART),
            Some(_) => Cell::Without("is 0"),
            None => Cell::Without("none"),
        };
        let per_unit = match &of.min_damping {
            Ok(slope) => Cell::from(slope.steepest() / unit),
            Err(_) => Cell::Without("none"),
        };
        let damping = of.min_damping.as_ref().ok().map(|slope| slope.steepest());
        table.row([
            Cell::from(&of.parameter),
            value.into(),
            per_unit,
            relative(damping),
            relative(of.margins[0]),
            relative(of.margins[4]),
        ]);
    }
    table
}

/// Why the worst of a box is not proven.
const FOUND: &str =
    "the worst that was found: a proof is had of a chain of masses under gains alone, in not too large a box";

/// What moves together, by one factor: its name, and those of its numbers.
fn joined(model: &Model, ranges: &[Range]) -> Vec<(String, Vec<String>)> {
    let of = |range: &Range| {
        let members = model.members(&range.parameter);
        let names: Vec<String> = members.iter().map(|member| member.name().to_owned()).collect();
        (!names.is_empty()).then(|| (range.parameter.name().to_owned(), names))
    };
    ranges.iter().filter_map(of).collect()
}

fn of_box(ranges: &[Range], worst: &Worst, joined: &[(String, Vec<String>)]) -> Value {
    let at: Map<String, Value> =
        ranges.iter().zip(&worst.at).map(|(range, at)| (range.parameter.name().to_owned(), json!(at))).collect();
    let over: Map<String, Value> =
        ranges.iter().map(|range| (range.parameter.name().to_owned(), json!([range.from, range.to]))).collect();
    let mut made = json!({
        "worst_damping": worst.value,
        "at": at,
        "over": over,
        "proven": worst.proven,
        "looked_at": worst.looked_at,
        "boxes": worst.boxes,
    });
    if !joined.is_empty() {
        made["together"] =
            joined.iter().map(|(name, names)| (name.clone(), json!(names))).collect::<Map<_, _>>().into();
    }
    if worst.proven {
        made["tolerance"] = json!(worst.tolerance);
    } else {
        made["not_proven"] = json!(FOUND);
    }
    made
}

fn box_text(machine: &Machine, ranges: &[Range], worst: &Worst, joined: &[(String, Vec<String>)]) -> String {
    let end = |range: &Range, at: f64| {
        let value = rounded(varied::shown(machine, &range.parameter, at));
        format!("{} = {value}", range.parameter.name())
    };
    let at: Vec<String> = ranges.iter().zip(&worst.at).map(|(range, at)| end(range, *at)).collect();
    let how = match worst.proven {
        true => format!("proven within {} over the whole box ({} boxes)", worst.tolerance, worst.boxes),
        false => FOUND.to_owned(),
    };
    let together = match joined {
        [] => String::new(),
        some => {
            // Discs are many, and what is said of one is said of all.
            let mut kinds: Vec<String> = some.iter().map(|(name, names)| kind(name, names)).collect();
            kinds.dedup();
            format!("by one factor each, together: {}\n", kinds.join("; "))
        }
    };
    let stands = if worst.value > 0.0 { "stable" } else { "UNSTABLE" };
    let (count, value) = (ranges.len(), rounded(worst.value));
    format!(
        "\nworst damping when {count} parameters lie anywhere in their ranges: {value}, {stands}\n{how}\nat {}\n{together}",
        at.join(", ")
    )
}

/// What moves together in words, whichever part it is of: `disc.N.inertia = mass, polar_inertia`.
fn kind(name: &str, names: &[String]) -> String {
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let fields: Vec<String> = names.iter().map(|name| last(name)).collect();
    format!("{}.N.{} = {}", name.split('.').next().unwrap_or_default(), last(name), fields.join(", "))
}
