//! One answer: the gains, what they are worth, where that is, and how sure it is.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use rotor::damping_ratio;
use rotor::file::FeedbackDocument;
use serde::Serialize;
use serde_json::{Map, Value, json};
use tuner::{Measure, Placement, Problem, Stationarity, Stop, Tuned, evaluate, rank};

use super::gain_table::{gains, gains_in_rows};
use super::question::Asked;
use super::summary::{speed_text, summary};
use super::{TuneArgs, Watch, corners, write_file};
use crate::failure::Failure;
use crate::output::rounded;
use crate::units::UnitsDocument;

/// The JSON document.
#[derive(Debug, Serialize)]
pub(super) struct Document<'a> {
    pub(super) rotor: &'a str,
    /// Whether every mode decays at every condition that was asked for; `null` where one is marginal.
    pub(super) stable: Option<bool>,
    /// Whether a pole is within rounding of the axis.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) marginal: bool,
    /// With a delay there are infinitely many poles: all of those with a real part above this count, and were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) count_right_of: Option<f64>,
    /// The answer itself, for what is told of it beside.
    #[serde(skip)]
    pub(super) found: &'a Tuned,
    /// The smallest damping ratio over conditions and the modes that count, see `below`.
    pub(super) min_damping: f64,
    /// The spin speed `R` where that is.
    pub(super) worst_speed: f64,
    /// The condition where the objective is worst, by name, with the pole.
    pub(super) worst: Value,
    /// The worst value of the objective: the damping ratio itself unless weights or decay rates were asked for.
    pub(super) objective: f64,
    /// No condition is worse than `objective` by more than this...
    pub(super) tolerance: f64,
    /// ...if this is true; otherwise none of those that were looked at is worse.
    pub(super) proven: bool,
    /// How many boxes of conditions the proof took.
    pub(super) boxes: u64,
    /// At how many conditions, spread over all, the worst was looked for.
    pub(super) checked: u64,
    pub(super) feedback: FeedbackDocument<'a>,
    /// The frequencies of filters that were searched, in radians per `tau`, with what they were and could be.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) corners: Vec<Value>,
    pub(super) method: tuner::Method,
    pub(super) evaluations: u64,
    pub(super) seconds: f64,
    pub(super) starts: usize,
    pub(super) seed: u64,
    /// How many starts ended within 1 % of the best.
    pub(super) starts_within_1_percent: usize,
    /// What each start ended with, best first.
    pub(super) values: &'a [f64],
    /// The norm of the smallest convex combination of active slopes: 0 at a local optimum.
    pub(super) stationarity: &'a Stationarity,
    /// The modes that hold the worst value, with their conditions.
    pub(super) active: Vec<Value>,
    /// The largest steady control force of the linear rotor, in `w0^2 e_t`, and the condition where it is.
    pub(super) max_force: f64,
    pub(super) max_force_at: Value,
    /// Where margins are asked for, the largest peak of the sensitivity and the smallest delay margin, each with its condition.
    #[serde(flatten)]
    pub(super) margins: Map<String, Value>,
    /// With shaft elements: modes count up to here, in radians per `tau`; those above are to be stable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) below: Option<f64>,
    pub(super) interrupted: bool,
    /// Every choice of bearing and sensors, best first, if they were to be chosen.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) ranking: Vec<Value>,
    #[serde(flatten)]
    pub(super) units: UnitsDocument,
}

/// Searches, prints and writes.
pub(super) fn run(args: &TuneArgs, asked: &Asked, flag: &AtomicBool) -> Result<(), Failure> {
    let (watch, begun) = (Watch::new(), Instant::now());
    let options = |problem: &Problem| args.options(problem);
    let places =
        rank(&asked.question(), &asked.choices(), &options, &|progress| watch.say(progress), Stop::when(flag))?;
    watch.end();
    tell(args, asked, &places, begun, flag)
}

/// Prints and writes what was found at every one of `places`, best first.
pub(super) fn tell(
    args: &TuneArgs,
    asked: &Asked,
    places: &[Placement],
    begun: Instant,
    flag: &AtomicBool,
) -> Result<(), Failure> {
    let best = &places[0];
    let problem = asked.problem(best.bearing, &best.sensors);
    known(asked, &best.tuned)?;
    let mut document = Document::of(args, asked, &problem, best, places, Stop::when(flag))?;
    // All of it: every place, and what was evaluated anew.
    document.seconds = begun.elapsed().as_secs_f64();
    let mut footer = summary(asked, &problem, &document).join("\n");
    if places.len() > 1 {
        footer += &ranking(places);
    }
    let short = short(&problem, &best.tuned);
    let would_be_written = best.tuned.interrupted && args.out.is_some() && !args.write_unstable;
    if let Some(short) = short.as_ref().filter(|_| would_be_written) {
        footer += &format!("\nnot written: {short}");
    }
    if let Some(path) = &args.out
        && (document.stable == Some(true) && short.is_none() || args.write_unstable)
    {
        write_file(path, args.force, (&best.tuned.feedback, asked.rotor()), &summary(asked, &problem, &document))?;
    }
    let mut table = match args.format.csv {
        true => gains_in_rows(&best.tuned, asked.family.speeds()),
        false => gains(&best.tuned),
    };
    corners::add(&mut table, &problem.structure, &best.tuned, asked.units(), args.format.csv);
    args.format.print(&document, &heading(asked, best), &table, &footer)?;
    verdict(asked, &best.tuned)?;
    match short {
        None => Ok(()),
        Some(short) => Err(Failure::Work(format!("no gains were found that keep the margins: with the best {short}"))),
    }
}

impl<'a> Document<'a> {
    /// What was found at the best of `places`.
    pub(super) fn of(
        args: &TuneArgs,
        asked: &'a Asked,
        problem: &Problem,
        best: &'a Placement,
        places: &'a [Placement],
        stop: Stop,
    ) -> Result<Self, Failure> {
        let tuned = &best.tuned;
        let (min_damping, worst_speed) = least_damping(args, problem, tuned, stop)?;
        let options = args.options(problem);
        let near =
            tuned.values.iter().filter(|value| **value >= tuned.values[0] - 0.01 * tuned.values[0].abs()).count();
        Ok(Self {
            rotor: asked.rotor().name(),
            stable: tuned.worst.stable(),
            marginal: tuned.worst.marginal(),
            count_right_of: tuned.worst.count_right_of,
            found: tuned,
            min_damping,
            worst_speed,
            worst: condition(problem, &tuned.worst.point, Some((tuned.worst.pole, tuned.worst.value))),
            objective: tuned.worst.value,
            tolerance: tuned.worst.tolerance,
            proven: tuned.worst.proven,
            checked: tuned.worst.checked,
            boxes: tuned.worst.boxes,
            feedback: FeedbackDocument(&tuned.feedback),
            corners: corners::document(&problem.structure, tuned),
            method: options.method,
            evaluations: places.iter().map(|place| place.tuned.evaluations).sum(),
            seconds: tuned.elapsed.as_secs_f64(),
            starts: options.starts,
            seed: args.seed,
            starts_within_1_percent: near,
            values: &tuned.values,
            stationarity: &tuned.stationarity,
            active: tuned.active.iter().map(|a| condition(problem, &a.point, Some((a.pole, a.value)))).collect(),
            max_force: tuned.force,
            max_force_at: condition(problem, &tuned.force_at, None),
            margins: margins(problem, tuned),
            below: problem.below,
            interrupted: tuned.interrupted,
            ranking: if places.len() > 1 { places.iter().map(rank_row).collect() } else { Vec::new() },
            units: asked.units().document(),
        })
    }
}

/// The smallest damping ratio and its speed: of the answer itself, or evaluated anew where something else was maximised.
fn least_damping(args: &TuneArgs, problem: &Problem, tuned: &Tuned, stop: Stop) -> Result<(f64, f64), Failure> {
    if problem.measure == Measure::default() {
        return Ok((tuned.worst.value, tuned.worst.point[0]));
    }
    let plain = Problem { measure: Measure::default(), ..problem.clone() };
    let evaluated = evaluate(&plain, &args.options(&plain), &tuned.gains, stop)?;
    Ok((evaluated.worst.value, evaluated.worst.point[0]))
}

/// A condition by the names of its coordinates, with a pole if it is about one.
fn condition(problem: &Problem, point: &[f64], pole: Option<(rotor::C64, f64)>) -> Value {
    let mut map = Map::new();
    for (axis, value) in problem.family.axes().iter().zip(problem.family.values(point)) {
        map.insert(axis.quantity.name(), json!(value));
    }
    if let Some((pole, value)) = pole {
        map.insert("re".into(), json!(pole.re));
        map.insert("im".into(), json!(pole.im));
        map.insert("damping".into(), json!(damping_ratio(pole)));
        map.insert("value".into(), json!(value));
    }
    Value::Object(map)
}

/// The worst margins, where they were asked for.
fn margins(problem: &Problem, tuned: &Tuned) -> Map<String, Value> {
    let mut map = Map::new();
    let Some([(peak, at_peak), (least, at_least)]) = &tuned.margins else { return map };
    let (size, frequency) = peak.sensitivity;
    let at = condition(problem, at_peak, None);
    let mut sensitivity = json!({ "peak": size, "frequency": frequency, "at": at, "below": tuned.peak_below });
    if tuned.peak_below.is_none() {
        sensitivity["below_null"] = json!("not proven between the conditions looked at");
    }
    map.insert("sensitivity".into(), sensitivity);
    let at = condition(problem, at_least, None);
    let delay = least.delay.map(|(delay, frequency)| json!({ "tau": delay, "frequency": frequency, "at": at }));
    if delay.is_none() {
        map.insert("delay_null".into(), json!("no delay makes it unstable"));
    }
    map.insert("delay".into(), delay.into());
    map
}

/// What is asked of the margins and was not reached, in words.
pub(super) fn short(problem: &Problem, tuned: &Tuned) -> Option<String> {
    /// A limit is kept within this part of it between the conditions that are looked at.
    const NEAR: f64 = 1e-3;
    if problem.max_sensitivity.is_none() && problem.min_delay.is_none() {
        return None;
    }
    let Some([(peak, _), (least, _)]) = tuned.margins.as_ref() else {
        return Some("margins were not looked at".to_owned());
    };
    let (size, delay) = (peak.sensitivity.0, least.delay.map_or(f64::INFINITY, |(delay, _)| delay));
    if let Some(limit) = problem.max_sensitivity.filter(|limit| size > limit * (1.0 + NEAR)) {
        return Some(format!("the peak of the sensitivity is {}, more than {limit}", rounded(size)));
    }
    let least = problem.min_delay.filter(|least| delay < least * (1.0 - NEAR))?;
    Some(format!("the delay margin is {}, less than {} (in tau)", rounded(delay), rounded(least)))
}

fn rank_row(place: &Placement) -> Value {
    let worst = &place.tuned.worst;
    json!({
        "bearing": place.bearing + 1,
        "sensors": place.sensors.iter().map(|mass| mass + 1).collect::<Vec<_>>(),
        "objective": worst.value,
        "worst_speed": worst.point[0],
        "proven": worst.proven,
        "max_force": place.tuned.force,
        "feedback": FeedbackDocument(&place.tuned.feedback),
    })
}

fn list(masses: &[usize]) -> String {
    masses.iter().map(|mass| (mass + 1).to_string()).collect::<Vec<_>>().join(", ")
}

fn heading(asked: &Asked, best: &Placement) -> String {
    let (rotor, range) = (asked.rotor().name(), &asked.range_text);
    if let Some(names) = asked.bearing_names() {
        return format!("{rotor}, {range}: control bearings {names}");
    }
    format!("{rotor}, {range}: bearing at mass {}, sensors at {}", best.bearing + 1, list(&best.sensors))
}

fn ranking(places: &[Placement]) -> String {
    let mut text = "\n\nbearing  sensors    worst\n".to_owned();
    for place in places {
        text +=
            &format!("{:>7}  {:<9}  {}\n", place.bearing + 1, list(&place.sensors), rounded(place.tuned.worst.value));
    }
    text
}

/// Where the poles cannot all be had there is no answer.
pub(super) fn known(asked: &Asked, tuned: &Tuned) -> Result<(), Failure> {
    if tuned.worst.is_known() {
        return Ok(());
    }
    if tuned.interrupted {
        return Err(Failure::Interrupted);
    }
    Err(Failure::Work(format!(
        "no answer: at {} the poles of the loop cannot all be found; with so long a delay there may be too many to count",
        speed_text(asked.units(), tuned.worst.point.first().copied())
    )))
}

/// What the exit code says: gains that do not hold the rotor are no success, nor is half a search.
pub(super) fn verdict(asked: &Asked, tuned: &Tuned) -> Result<(), Failure> {
    if tuned.interrupted {
        return Err(Failure::Interrupted);
    }
    let units = asked.units();
    match tuned.worst.stable() {
        Some(true) => Ok(()),
        None => Err(Failure::Work(format!(
            "the best gains found leave a marginal mode at {}: within rounding of the axis, neither stable nor unstable",
            speed_text(units, Some(tuned.worst.point[0]))
        ))),
        Some(false) => Err(Failure::Work(format!(
            "no gains were found that hold the rotor at {}: the best leave {} at {}",
            if asked.family.speeds().0 == asked.family.speeds().1 { "that speed" } else { "every speed of the range" },
            rounded(tuned.worst.value),
            speed_text(units, Some(tuned.worst.point[0]))
        ))),
    }
}
