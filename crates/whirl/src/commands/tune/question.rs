//! What is asked: options into a family, structures and choices of place, each checked and named in the user's terms.

use clap::ValueEnum;
use control::{FAULTS, PARTS, Parts};
use rotor::typed::pair;
use rotor::{Feedback, Rotor};
use tuner::{
    Corner, Cost, Family, FamilyAxis, FamilyError, FamilyQuantity, Measure, PlacementProblem, Problem, ProblemError,
    Schedule, Structure,
};

use super::typed::{Criterion, Gains, MeasureName, Robust, Signal, axis};
use super::{TuneArgs, corners, places, shafts};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::quantity::TypedQuantity;
use crate::units::CommandUnits;

/// The whole question.
#[derive(Debug)]
pub(super) struct Asked {
    /// The operating conditions.
    pub(super) family: Family,
    /// The range as typed, or the speed.
    pub(super) range_text: String,
    parts: Parts,
    template: Option<Feedback>,
    /// Which of its corners are searched too.
    corners: Vec<Corner>,
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
        refuse_what_excludes_itself(args)?;
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
        let template = match args.feedback {
            Some(_) => Some(feedback.clone()),
            None if rotor.is_chain() => None,
            None => Some(shafts::template(args, &rotor, &feedback)?),
        };
        let mut asked = Self {
            family: family(args, &rotor, [from, to])?,
            range_text,
            parts: feedback.first().parts,
            corners: corners::chosen(&args.corners, template.as_ref(), &rotor, units)?,
            bound: bound(args, &rotor, template.as_ref())?,
            template,
            composite: args.signal != Some(Signal::Individual),
            schedule: schedule(args, [from, to])?,
            measure: measure(args, units)?,
            force_limit: None,
            max_sensitivity: args.max_sensitivity,
            min_delay: args.min_delay.map(|least| units.read("--min-delay", least)).transpose()?,
            below: args.below.typed(&rotor)?,
            bearings: places::bearings(args.bearing.as_ref(), &rotor)?,
            sensors: places::sensors(args.sensors.as_ref(), &rotor)?,
        };
        asked.force_limit = args.force_limit.map(|limit| asked.force_limit(limit)).transpose()?;
        let (bearing, sensors) = asked.choices().swap_remove(0);
        if asked.below.is_none() && !rotor.is_chain() {
            let plain = asked.problem(bearing, &sensors);
            asked.below = Problem::default_below(&plain.family, &plain.structure);
        }
        asked.problem(bearing, &sensors).check()?;
        Ok(asked)
    }

    /// A limit of the control force as typed, in `w0^2 e_t`.
    fn force_limit(&self, typed: TypedQuantity) -> Result<f64, Failure> {
        let rotor = self.rotor();
        let own = self.template.as_ref().map(|template| &template.first().station);
        let only = self.bearings.first().filter(|_| self.bearings.len() == 1);
        let Some(&bearing) = own.or(only) else {
            return Err(Failure::Usage("--force-limit needs one --bearing: the force is that on its mass".into()));
        };
        self.units().read_on(rotor.control_mass(bearing), "--force-limit", typed)
    }

    /// The rotor.
    pub(super) fn rotor(&self) -> &Rotor {
        self.family.rotor()
    }

    /// Its units.
    pub(super) fn units(&self) -> CommandUnits {
        CommandUnits::of(self.rotor())
    }

    /// Every choice of bearing and sensors.
    pub(super) fn choices(&self) -> Vec<(usize, Vec<usize>)> {
        if let Some(template) = &self.template {
            let is_read = |k: &usize| template.signals().any(|s| s.displacement[*k] != 0.0 || s.velocity[*k] != 0.0);
            return vec![(template.first().station, (0..self.rotor().len()).filter(is_read).collect())];
        }
        let of = |&bearing: &usize| {
            let sensors = if self.sensors.is_empty() {
                vec![places::neighbours(bearing, self.rotor().len())]
            } else {
                self.sensors.clone()
            };
            sensors.into_iter().map(move |sensors| (bearing, sensors))
        };
        self.bearings.iter().flat_map(of).collect()
    }

    /// What is the same for every choice.
    pub(super) fn question(&self) -> PlacementProblem<'_> {
        PlacementProblem {
            family: &self.family,
            parts: self.parts,
            template: self.template.clone(),
            corners: self.corners.clone(),
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
    let is_part = |name: &&str| !NO_PART.contains(name) && !FAULTS.contains(name);
    let names = || PARTS.iter().map(|part| part.name).filter(is_part);
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

/// Options of which one makes another mean nothing.
fn refuse_what_excludes_itself(args: &TuneArgs) -> Result<(), Failure> {
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
    refuse_idle_criteria(args)?;
    for (name, value) in
        [("tolerance", args.tolerance), ("stiffness", args.stiffness), ("spread", args.spread.unwrap_or(1.0))]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(Failure::Usage(format!("--{name} {value}: expected a finite number above 0")));
        }
    }
    Ok(())
}

/// Criteria that are named twice, and options of a criterion that is not among them.
fn refuse_idle_criteria(args: &TuneArgs) -> Result<(), Failure> {
    let criteria = &args.criteria;
    if let Some((_, twice)) = criteria.iter().enumerate().find(|(k, criterion)| criteria[..*k].contains(criterion)) {
        return Err(Failure::Usage(format!("--criteria: {} is given twice", twice.name())));
    }
    let is_all = criteria.contains(&Criterion::All);
    if is_all && criteria.len() > 1 {
        return Err(Failure::Usage("--criteria: all has every one: leave the others out".into()));
    }
    for (option, is_given, of) in [
        ("--max-sensitivity", args.max_sensitivity.is_some(), Criterion::Sensitivity),
        ("--mode-weights", args.mode_weights.is_some(), Criterion::Weighted),
        ("--region", args.region.is_some(), Criterion::Region),
    ] {
        if is_given && !criteria.is_empty() && !is_all && !criteria.contains(&of) {
            let name = of.name();
            return Err(Failure::Usage(format!("{option} does nothing: {name} is not among --criteria")));
        }
    }
    Ok(())
}

/// The operating conditions.
fn family(args: &TuneArgs, rotor: &Rotor, [from, to]: [f64; 2]) -> Result<Family, Failure> {
    let mut family = Family::new(rotor, from, to)?;
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
        family.push(axis(varied, rotor)?)?;
    }
    if let Some(delay) = args.delay {
        let [from, to] = delay.ends("--delay", CommandUnits::of(rotor))?;
        family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from, to })?;
    }
    Ok(family)
}

/// How gains depend on speed.
fn schedule(args: &TuneArgs, [from, to]: [f64; 2]) -> Result<Schedule, Failure> {
    match args.gains {
        Gains::Fixed => Ok(Schedule::Fixed),
        _ if from == to => Err(Failure::Usage("--gains: gains that depend on speed need a range, --over A..B".into())),
        _ if args.track.is_some() => {
            Err(Failure::Usage("--track makes a table of gains by itself: leave --gains out".into()))
        }
        Gains::Linear => Ok(Schedule::Linear { from, to }),
        Gains::Table(points) => Ok(Schedule::table(from, to, points)),
    }
}

/// The largest gain.
fn bound(args: &TuneArgs, rotor: &Rotor, template: Option<&Feedback>) -> Result<f64, Failure> {
    let bound = match (args.bound, template) {
        (Some(bound), _) => bound,
        (None, Some(template)) => {
            let structure = Structure::new(rotor, template, Schedule::Fixed);
            structure.map_err(|error| Failure::Usage(error.to_string()))?.default_bound()
        }
        (None, None) => 20.0,
    };
    match args.spread.filter(|spread| *spread > bound) {
        Some(spread) => Err(Failure::Usage(format!("--spread {spread}: expected at most --bound, which is {bound}"))),
        None => Ok(bound),
    }
}

/// What is made as good as can be; of several criteria the first of all, damping ratios.
fn measure(args: &TuneArgs, units: CommandUnits) -> Result<Measure, Failure> {
    if !args.criteria.is_empty() {
        return Ok(Measure::default());
    }
    let name = args.measure;
    for (option, is_given, of) in [
        ("--mode-weights are weights of damping ratios", args.mode_weights.is_some(), MeasureName::Ratio),
        ("--region is of --measure region", args.region.is_some(), MeasureName::Region),
        ("--cost is of --measure cost", args.cost.is_some(), MeasureName::Cost),
    ] {
        if is_given && name != of {
            let name = name.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
            return Err(Failure::Usage(format!("{option}: not with --measure {name}")));
        }
    }
    match name {
        MeasureName::Decay => Ok(Measure::Decay),
        MeasureName::Ratio => Ok(weights(args)?.unwrap_or_default()),
        MeasureName::Region => region(args, units)?.ok_or_else(|| {
            Failure::Usage("--measure region: expected --region, such as damping=0.1,decay=0.1,frequency=4".into())
        }),
        MeasureName::Cost => cost(args, units),
    }
}

/// Damping ratios with the weights that are typed.
pub(super) fn weights(args: &TuneArgs) -> Result<Option<Measure>, Failure> {
    match args.mode_weights.as_deref() {
        None => Ok(None),
        Some(&[forward, backward]) => Ok(Some(Measure::Ratio { forward, backward })),
        Some(other) => {
            let count = other.len();
            Err(Failure::Usage(format!("--mode-weights: expected two, forward and backward, found {count}")))
        }
    }
}

/// The region that is typed.
pub(super) fn region(args: &TuneArgs, units: CommandUnits) -> Result<Option<Measure>, Failure> {
    args.region.map(|typed| Ok(Measure::Region(typed.value(units)?))).transpose()
}

/// The cost that is typed, or usual.
pub(super) fn cost(args: &TuneArgs, units: CommandUnits) -> Result<Measure, Failure> {
    args.cost.map_or(Ok(Measure::Cost(Cost::default())), |typed| Ok(Measure::Cost(typed.value(units)?)))
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
