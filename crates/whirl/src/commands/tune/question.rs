//! What is asked: options into a family, structures and choices of place, each checked and named in the user's terms.

use std::f64::consts::TAU;
use std::str::FromStr;

use control::{PARTS, Parts};
use rotor::typed::pair;
use rotor::{FIELDS, Feedback, Rotor};
use tuner::{
    Family, FamilyAxis, FamilyError, FamilyQuantity, Measure, Problem, ProblemError, Question, Schedule, Structure,
    choices,
};

use super::{TuneArgs, shafts};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::range::Range;
use crate::units::Units;
use crate::varied::{By, Varied};

/// What drives the bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Signal {
    /// The sum of all sensors, with four gains: the report's
    Composite,
    /// Every sensor by itself, with four gains each
    Individual,
}

/// Which deadband states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Robust {
    /// The factor of each support bearing anywhere from 0 to 1, each by itself
    Deadband,
    /// One factor from 0 to 1 for all support bearings
    DeadbandCommon,
}

/// What a mode is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum MeasureName {
    /// Damping ratio, -Re / |lambda|
    Ratio,
    /// Decay rate, -Re lambda per tau
    Decay,
}

/// Masses, counted from 1, or a choice among all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Places {
    /// These.
    These(Vec<usize>),
    /// These, some of them by name.
    Named(Vec<String>),
    /// Every choice of so many.
    Any(usize),
}

impl FromStr for Places {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = || format!("'{typed}': expected masses counted from 1 such as 1,2, or any, or any:2");
        if let Some(rest) = typed.strip_prefix("any") {
            let count = if rest.is_empty() { Some(1) } else { rest.strip_prefix(':').and_then(|n| n.parse().ok()) };
            return count.filter(|&n| n > 0).map(Self::Any).ok_or_else(expected);
        }
        let names: Vec<String> = typed.split(',').map(|name| name.trim().to_owned()).collect();
        let is_name = |name: &String| name.starts_with(char::is_alphabetic);
        if names.iter().any(is_name) && names.iter().all(|name| !name.is_empty()) {
            return Ok(Self::Named(names));
        }
        let masses: Option<Vec<usize>> =
            typed.split(',').map(|mass| mass.trim().parse().ok().filter(|&mass: &usize| mass > 0)).collect();
        let masses = masses.ok_or_else(expected)?;
        let mut once = masses.clone();
        once.sort_unstable();
        once.dedup();
        if once.len() == masses.len() {
            Ok(Self::These(once))
        } else {
            Err(format!("'{typed}': a mass is named twice"))
        }
    }
}

/// How gains depend on speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gains {
    /// Not at all.
    Fixed,
    /// Linearly.
    Linear,
    /// Through so many values.
    Table(usize),
}

impl FromStr for Gains {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let table = || typed.strip_prefix("table:")?.parse().ok().filter(|n| (2..=64).contains(n)).map(Self::Table);
        match typed {
            "fixed" => Ok(Self::Fixed),
            "linear" => Ok(Self::Linear),
            _ => table().ok_or_else(|| format!("'{typed}': expected fixed, linear, or table:N with N from 2 to 64")),
        }
    }
}

/// One number or a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    from: f64,
    to: f64,
}

impl FromStr for Span {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        if let Ok(Range { from, to }) = typed.parse() {
            return Ok(Self { from, to });
        }
        let number = typed.trim().parse().ok().filter(|x: &f64| x.is_finite());
        number.map(|x| Self { from: x, to: x }).ok_or_else(|| format!("'{typed}': expected a number or a range A..B"))
    }
}

/// The coordinate of a family that a parameter of `rotor` is.
fn axis(varied: &Varied, rotor: &Rotor) -> Result<FamilyAxis, Failure> {
    let unknown = || {
        let names: Vec<&str> = FIELDS.iter().map(|field| field.name).filter(|name| *name != "deadband").collect();
        Failure::Usage(format!(
            "'{}' is no parameter: expected {} or shaft, a dot, and a number from 1, such as damping.1",
            varied.key,
            names.join(", ")
        ))
    };
    let (name, number) = varied.key.split_once('.').ok_or_else(unknown)?;
    let number: usize = number.parse().ok().filter(|&n| n > 0).ok_or_else(unknown)?;
    let missing = || {
        let (masses, shafts) = (rotor.len(), rotor.shafts().len());
        Failure::Usage(format!("'{}': {} has {masses} masses and {shafts} shafts", varied.key, rotor.name()))
    };
    let (quantity, value) = if name == "shaft" {
        (FamilyQuantity::Shaft(number - 1), *rotor.shafts().get(number - 1).ok_or_else(missing)?)
    } else {
        // Clearance has no part in the linear rotor: deadband states are what --robust is for.
        let known = FIELDS.iter().position(|field| field.name == name && name != "deadband");
        let field = known.ok_or_else(unknown)?;
        let mass = rotor.masses().get(number - 1).ok_or_else(missing)?;
        (FamilyQuantity::Parameter { field, mass: number - 1 }, mass.values()[field])
    };
    let (from, to) = match varied.by {
        By::Range(range) => (range.from, range.to),
        By::Part(part) => {
            let width = part * value.abs();
            if width == 0.0 {
                return Err(Failure::Usage(format!("'{}' is 0: a part of it is nothing; give a range", varied.key)));
            }
            (value - width, value + width)
        }
    };
    Ok(FamilyAxis { quantity, from, to })
}

/// The whole question.
#[derive(Debug)]
pub(super) struct Asked {
    /// The operating conditions.
    pub(super) family: Family,
    /// The range as typed, or the speed.
    pub(super) range_text: String,
    parts: Parts,
    template: Option<Feedback>,
    composite: bool,
    schedule: Schedule,
    measure: Measure,
    bound: f64,
    force_limit: Option<f64>,
    max_sensitivity: Option<f64>,
    min_delay: Option<f64>,
    /// In radians per `tau`.
    below: Option<f64>,
    /// Masses for the bearing to choose from, counted from 0.
    pub(super) bearings: Vec<usize>,
    /// Sensor sets to choose from; empty for the default of each bearing.
    sensors: Vec<Vec<usize>>,
}

impl Asked {
    /// Reads the options.
    ///
    /// # Errors
    /// Whatever makes no sense, with what was expected.
    pub(super) fn of(args: &TuneArgs) -> Result<Self, Failure> {
        let machine = MachineArgs {
            rotor: args.rotor.clone(),
            feedback: args.feedback.clone(),
            deadband: None,
            set: args.set.clone(),
        };
        parts_alone(&args.set)?;
        let (machine, from, to, range_text) = match (args.over, args.speed) {
            (Some(over), _) => {
                let (machine, range) = Machine::open_over(&machine, over)?;
                let text = machine.units().range_text(over);
                (machine, range.from, range.to, text)
            }
            (None, typed) => {
                let machine = Machine::open(&machine, typed, crate::catalog::Default::Analysis)?;
                let speed = machine.settings.speed;
                let text = machine.units().speed_text(speed);
                (machine, speed, speed, text)
            }
        };
        let (rotor, units) = (machine.rotor.clone(), machine.units());
        let feedback = machine.settings.feedback.clone();
        if args.delay.is_some() && feedback.delay() > 0.0 {
            return Err(Failure::Usage("--delay: the loop has a delay already: leave one of the two out".into()));
        }
        let mut family = Family::new(&rotor, from, to)?;
        if let Some(robust) = args.robust {
            family.any_deadband(robust == Robust::Deadband)?;
            if family.axes().len() == 1 {
                let name = rotor.name();
                return Err(Failure::Usage(format!("--robust: {name} has no support bearing with stiffness")));
            }
        }
        if let Some(varied) = args.vary.first().filter(|_| !rotor.is_chain()) {
            let name = rotor.name();
            return Err(Failure::Usage(format!(
                "--vary {}: parameters of masses vary, but {name} is of shaft elements",
                varied.key
            )));
        }
        for varied in &args.vary {
            family.push(axis(varied, &rotor)?)?;
        }
        if let Some(Span { from, to }) = args.delay {
            let second = units.time(1.0);
            family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from: from / second, to: to / second })?;
        }
        let schedule = match args.gains {
            Gains::Fixed => Schedule::Fixed,
            _ if from == to => {
                return Err(Failure::Usage("--gains: gains that depend on speed need a range, --over A..B".into()));
            }
            _ if args.track.is_some() => {
                return Err(Failure::Usage("--track makes a table of gains by itself: leave --gains out".into()));
            }
            Gains::Linear => Schedule::Linear { from, to },
            Gains::Table(points) => Schedule::table(from, to, points),
        };
        if args.pareto.is_some() && args.force_limit.is_some() {
            return Err(Failure::Usage("--pareto tries one limit after the other: leave --force-limit out".into()));
        }
        if args.pareto == Some(super::PriceName::Sensitivity) && args.max_sensitivity.is_some() {
            return Err(Failure::Usage("--pareto tries one limit after the other: leave --max-sensitivity out".into()));
        }
        if args.track.is_some() && (args.max_sensitivity.is_some() || args.min_delay.is_some()) {
            return Err(Failure::Usage(
                "--track looks at one speed at a time: leave --max-sensitivity and --min-delay out".into(),
            ));
        }
        for (name, value) in
            [("tolerance", args.tolerance), ("stiffness", args.stiffness), ("spread", args.spread.unwrap_or(1.0))]
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(Failure::Usage(format!("--{name} {value}: expected a finite number above 0")));
            }
        }
        let template = match args.feedback {
            Some(_) => Some(feedback.clone()),
            None if rotor.is_chain() => None,
            None => Some(shafts::template(args, &rotor, &feedback)?),
        };
        let bound = match (args.bound, &template) {
            (Some(bound), _) => bound,
            (None, Some(template)) => {
                let structure = Structure::new(&rotor, template, Schedule::Fixed);
                structure.map_err(|error| Failure::Usage(error.to_string()))?.default_bound()
            }
            (None, None) => 20.0,
        };
        if let Some(spread) = args.spread.filter(|spread| *spread > bound) {
            return Err(Failure::Usage(format!("--spread {spread}: expected at most --bound, which is {bound}")));
        }
        if args.below.is_some() && rotor.is_chain() {
            return Err(Failure::Usage("--below: every mode of a chain of masses counts: leave it out".into()));
        }
        let bearing = args.bearing.clone().unwrap_or(Places::These(vec![1]));
        let bearings = masses(&bearing, &rotor, "bearing")?;
        let sensors = match &args.sensors {
            Some(typed) if rotor.is_chain() => masses(typed, &rotor, "sensors")?,
            _ => Vec::new(),
        };
        if bearings.iter().any(|chosen| chosen.len() != 1) {
            return Err(Failure::Usage("--bearing: there is one control bearing: expected one mass, or any".into()));
        }
        let mut asked = Self {
            family,
            range_text,
            parts: feedback.bearings[0].parts,
            template,
            composite: args.signal != Some(Signal::Individual),
            schedule,
            measure: measure(args)?,
            bound,
            force_limit: None,
            max_sensitivity: args.max_sensitivity,
            min_delay: args.min_delay.map(|least| least / units.time(1.0)),
            below: args.below.map(|hertz| hertz * TAU * units.time(1.0)),
            bearings: bearings.into_iter().flatten().collect(),
            sensors,
        };
        if let Some(limit) = args.force_limit {
            let own = asked.template.as_ref().map(|template| &template.bearings[0].station);
            let only = asked.bearings.first().filter(|_| asked.bearings.len() == 1);
            let Some(&bearing) = own.or(only) else {
                return Err(Failure::Usage("--force-limit needs one --bearing: the force is that on its mass".into()));
            };
            let mass = |bearing: &rotor::ControlBearing| rotor.control_mass(bearing.station);
            let of_all = asked.template.iter().flat_map(|template| &template.bearings).map(mass);
            if of_all.into_iter().any(|other| other != rotor.control_mass(bearing)) {
                return Err(Failure::Usage(
                    "--force-limit: the control bearings carry unequal masses, so no one limit is that of all".into(),
                ));
            }
            asked.force_limit = Some(limit / units.force(1.0, rotor.control_mass(bearing)));
        }
        let (bearing, sensors) = asked.choices().swap_remove(0);
        if asked.below.is_none() && !rotor.is_chain() {
            let plain = asked.problem(bearing, &sensors);
            asked.below = Problem::default_below(&plain.family, &plain.structure);
        }
        asked.problem(bearing, &sensors).check()?;
        Ok(asked)
    }

    /// The rotor.
    pub(super) fn rotor(&self) -> &Rotor {
        self.family.rotor()
    }

    /// Its units.
    pub(super) fn units(&self) -> Units {
        Units::of(self.rotor())
    }

    /// Every choice of bearing and sensors.
    pub(super) fn choices(&self) -> Vec<(usize, Vec<usize>)> {
        if let Some(template) = &self.template {
            let is_read = |k: &usize| {
                template.bearings[0].signals.iter().any(|s| s.displacement[*k] != 0.0 || s.velocity[*k] != 0.0)
            };
            return vec![(template.bearings[0].station, (0..self.rotor().len()).filter(is_read).collect())];
        }
        let of = |&bearing: &usize| {
            let sensors = if self.sensors.is_empty() {
                vec![neighbours(bearing, self.rotor().len())]
            } else {
                self.sensors.clone()
            };
            sensors.into_iter().map(move |sensors| (bearing, sensors))
        };
        self.bearings.iter().flat_map(of).collect()
    }

    /// What is the same for every choice.
    pub(super) fn question(&self) -> Question<'_> {
        Question {
            family: &self.family,
            parts: self.parts,
            template: self.template.clone(),
            composite: self.composite,
            schedule: self.schedule.clone(),
            measure: self.measure,
            bound: self.bound,
            force_limit: self.force_limit,
            max_sensitivity: self.max_sensitivity,
            min_delay: self.min_delay,
            below: self.below,
        }
    }

    /// What the control bearings are called, where there are several or they hang shafts.
    pub(super) fn bearing_names(&self) -> Option<String> {
        let template = self.template.as_ref()?;
        if template.bearings.len() == 1 && self.rotor().is_chain() {
            return None;
        }
        let names: Vec<String> = (0..template.bearings.len()).map(|k| template.label(k)).collect();
        Some(names.join(", "))
    }

    /// The problem for one choice.
    pub(super) fn problem(&self, bearing: usize, sensors: &[usize]) -> Problem {
        self.question().at(bearing, sensors)
    }
}

/// Settings of a search: numbers of the loop that its poles know.
fn parts_alone(set: &[String]) -> Result<(), Failure> {
    const NO_PART: [&str; 7] = ["noise", "quantum", "seed", "limit", "slew", "external", "external_trip"];
    let names = || PARTS.iter().map(|part| part.name).filter(|name| !NO_PART.contains(name));
    for typed in set {
        let key = pair(typed).map_or(typed.as_str(), |(key, _)| key);
        if !names().any(|name| name == key) {
            let known: Vec<&str> = names().collect();
            return Err(Failure::Usage(format!(
                "--set {key}: a search takes the linear parts of the loop: {}. The gains are what it finds",
                known.join(", ")
            )));
        }
    }
    Ok(())
}

/// The sensors that are taken if none are named: the bearing's own mass and the next.
fn neighbours(bearing: usize, masses: usize) -> Vec<usize> {
    match masses {
        1 => vec![0],
        _ if bearing + 1 < masses => vec![bearing, bearing + 1],
        _ => vec![bearing - 1, bearing],
    }
}

/// Every set of masses that `typed` means, counted from 0.
fn masses(typed: &Places, rotor: &Rotor, option: &str) -> Result<Vec<Vec<usize>>, Failure> {
    let n = rotor.len();
    match typed {
        Places::These(masses) => match masses.iter().find(|&&mass| mass > n) {
            Some(mass) => {
                Err(Failure::Usage(format!("--{option}: no mass {mass}: {} has masses 1 to {n}", rotor.name())))
            }
            None => Ok(vec![masses.iter().map(|mass| mass - 1).collect()]),
        },
        Places::Named(names) => Err(Failure::Usage(format!(
            "--{option}: '{}': expected masses counted from 1 such as 1,2, or any, or any:2",
            names.join(",")
        ))),
        Places::Any(count) if *count > n => {
            Err(Failure::Usage(format!("--{option} any:{count}: {} has only {n} masses", rotor.name())))
        }
        Places::Any(count) => Ok(choices(n, *count)),
    }
}

fn measure(args: &TuneArgs) -> Result<Measure, Failure> {
    match (args.measure, args.mode_weights.as_deref()) {
        (MeasureName::Decay, None) => Ok(Measure::Decay),
        (MeasureName::Decay, Some(_)) => {
            Err(Failure::Usage("--mode-weights are weights of damping ratios: not with --measure decay".into()))
        }
        (MeasureName::Ratio, None) => Ok(Measure::default()),
        (MeasureName::Ratio, Some(&[forward, backward])) => Ok(Measure::Ratio { forward, backward }),
        (MeasureName::Ratio, Some(other)) => {
            let count = other.len();
            Err(Failure::Usage(format!("--mode-weights: expected two, forward and backward, found {count}")))
        }
    }
}

impl From<FamilyError> for Failure {
    fn from(error: FamilyError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<ProblemError> for Failure {
    fn from(error: ProblemError) -> Self {
        Self::Usage(error.to_string())
    }
}
