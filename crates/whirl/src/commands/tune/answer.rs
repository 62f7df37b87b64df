//! One answer: the gains, what they are worth, where that is, and how sure it is.

use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use rotor::file::FeedbackDocument;
use rotor::{GainKind, damping_ratio};
use serde::Serialize;
use serde_json::{Map, Value, json};
use tuner::{Measure, Placement, Problem, Stationarity, Stop, Tuned, evaluate, rank};

use super::question::Asked;
use super::{TuneArgs, Watch, write_file};
use crate::failure::Failure;
use crate::output::{Cell, Table, rounded};
use crate::units::{Units, UnitsDocument};

/// The JSON document.
#[derive(Debug, Serialize)]
pub(super) struct Document<'a> {
    rotor: &'a str,
    /// Whether every mode decays at every condition that was asked for; `null` where one is marginal.
    stable: Option<bool>,
    /// Whether a pole is within rounding of the axis.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    marginal: bool,
    /// With a delay there are infinitely many poles: all of those with a real part above this count, and were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    count_right_of: Option<f64>,
    /// The smallest damping ratio over conditions and the modes that count, see `below`.
    min_damping: f64,
    /// The spin speed `R` where that is.
    worst_speed: f64,
    /// The condition where the objective is worst, by name, with the pole.
    worst: Value,
    /// The worst value of the objective: the damping ratio itself unless weights or decay rates were asked for.
    objective: f64,
    /// No condition is worse than `objective` by more than this...
    tolerance: f64,
    /// ...if this is true; otherwise none of those that were looked at is worse.
    proven: bool,
    /// How many boxes of conditions the proof took.
    boxes: u64,
    /// At how many conditions, spread over all, the worst was looked for.
    checked: u64,
    feedback: FeedbackDocument<'a>,
    method: tuner::Method,
    evaluations: u64,
    seconds: f64,
    starts: usize,
    seed: u64,
    /// How many starts ended within 1 % of the best.
    starts_within_1_percent: usize,
    /// What each start ended with, best first.
    values: &'a [f64],
    /// The norm of the smallest convex combination of active slopes: 0 at a local optimum.
    stationarity: &'a Stationarity,
    /// The modes that hold the worst value, with their conditions.
    active: Vec<Value>,
    /// The largest steady control force of the linear rotor, in `w0^2 e_t`, and the condition where it is.
    max_force: f64,
    max_force_at: Value,
    /// Where margins are asked for, the largest peak of the sensitivity and the smallest delay margin, each with its condition.
    #[serde(flatten)]
    margins: Map<String, Value>,
    /// With shaft elements: modes count up to here, in radians per `tau`; those above are to be stable.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    interrupted: bool,
    /// Every choice of bearing and sensors, best first, if they were to be chosen.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ranking: Vec<Value>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Searches, prints and writes.
pub(super) fn run(args: &TuneArgs, asked: &Asked, flag: &AtomicBool) -> Result<(), Failure> {
    let (watch, begun) = (Watch::new(), Instant::now());
    let options = |problem: &Problem| args.options(problem);
    let places =
        rank(&asked.question(), &asked.choices(), &options, &|progress| watch.say(progress), Stop::when(flag))?;
    watch.end();
    let best = &places[0];
    let problem = asked.problem(best.bearing, &best.sensors);
    known(asked, &best.tuned)?;
    let mut document = Document::of(args, asked, &problem, best, &places, Stop::when(flag))?;
    // All of it: every place, and what was evaluated anew.
    document.seconds = begun.elapsed().as_secs_f64();
    let mut footer = summary(asked, &problem, &document).join("\n");
    if places.len() > 1 {
        footer += &ranking(&places);
    }
    if let Some(path) = &args.out
        && (document.stable == Some(true) && short(&problem, &best.tuned).is_none() || args.write_unstable)
    {
        write_file(path, args.force, (&best.tuned.feedback, asked.rotor()), &summary(asked, &problem, &document))?;
    }
    let table = if args.format.csv { gains_in_rows(&best.tuned, asked.family.speeds()) } else { gains(&best.tuned) };
    args.format.print(&document, &heading(asked, best), &table, &footer)?;
    verdict(asked, &best.tuned)?;
    match short(&problem, &best.tuned) {
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
            min_damping,
            worst_speed,
            worst: condition(problem, &tuned.worst.point, Some((tuned.worst.pole, tuned.worst.value))),
            objective: tuned.worst.value,
            tolerance: tuned.worst.tolerance,
            proven: tuned.worst.proven,
            checked: tuned.worst.checked,
            boxes: tuned.worst.boxes,
            feedback: FeedbackDocument(&tuned.feedback),
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
fn short(problem: &Problem, tuned: &Tuned) -> Option<String> {
    /// A limit is kept within this part of it between the conditions that are looked at.
    const NEAR: f64 = 1e-3;
    let [(peak, _), (least, _)] = tuned.margins.as_ref()?;
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

/// What the `k`-th of all signals is called: its number, and of several bearings the bearing's name before its number there.
fn signal_name(tuned: &Tuned, k: usize) -> String {
    match tuned.feedback.place_of_signal(k).filter(|_| tuned.feedback.bearings.len() > 1) {
        Some((bearing, place)) => format!("{}.{}", tuned.feedback.label(bearing), place + 1),
        None => (k + 1).to_string(),
    }
}

/// The gains, one a row; a scheduled one as its file says it.
fn gains(tuned: &Tuned) -> Table {
    let mut table = Table::new(&["signal", "gain", "value"]);
    for (k, signal) in tuned.feedback.signals().enumerate() {
        let name = signal_name(tuned, k);
        for kind in GainKind::ALL {
            let value = match signal.gain(kind) {
                rotor::Gain::Constant(value) => Cell::from(*value),
                rotor::Gain::Linear { at_zero, slope } => Cell::from(&format!("{} {:+.6} R", rounded(*at_zero), slope)),
                rotor::Gain::Table(points) => {
                    let each: Vec<String> = points.iter().map(|(r, v)| format!("{r}: {}", rounded(*v))).collect();
                    Cell::from(&each.join("  "))
                }
            };
            table.row([Cell::from(&name), Cell::from(&kind.name()), value]);
        }
    }
    table
}

/// The same for spreadsheets: a number a row, of a scheduled gain with the speed where it is that; linear between two.
fn gains_in_rows(tuned: &Tuned, (from, to): (f64, f64)) -> Table {
    let mut table = Table::new(&["signal", "gain", "speed", "value"]);
    for (k, signal) in tuned.feedback.signals().enumerate() {
        let name = signal_name(tuned, k);
        for kind in GainKind::ALL {
            let gain = signal.gain(kind);
            let points: Vec<(Cell, f64)> = match gain {
                rotor::Gain::Constant(value) => vec![(Cell::Without("any"), *value)],
                rotor::Gain::Linear { .. } => [from, to].map(|speed| (speed.into(), gain.at(speed))).to_vec(),
                rotor::Gain::Table(points) => points.iter().map(|(speed, value)| ((*speed).into(), *value)).collect(),
            };
            for (speed, value) in points {
                table.row([Cell::from(&name), Cell::from(&kind.name()), speed, value.into()]);
            }
        }
    }
    table
}

/// What a person wants to know of the answer, in lines.
pub(super) fn summary(asked: &Asked, problem: &Problem, document: &Document<'_>) -> Vec<String> {
    let units = asked.units();
    let what = if problem.measure == Measure::default() { "min damping" } else { "objective" };
    let sure = if document.proven {
        format!("proven within {:e} over all conditions ({})", document.tolerance, boxes(document.boxes))
    } else {
        format!("the worst of {} conditions looked at, not proven between them", document.checked)
    };
    let mut lines = vec![format!(
        "{what} {} at {}{}: {sure}",
        rounded(document.objective),
        speed_text(units, document.worst["speed"].as_f64()),
        others(&document.worst)
    )];
    if what == "objective" {
        lines.push(format!(
            "min damping {} at {}",
            rounded(document.min_damping),
            speed_text(units, Some(document.worst_speed))
        ));
    }
    if let Some(below) = document.below {
        let hertz = below / TAU / units.time(1.0);
        lines.push(format!("modes up to {} Hz count; those above are stable if the worth is above 0", rounded(hertz)));
    }
    if document.marginal {
        lines.push("a mode is marginal: within rounding of the axis, neither stable nor unstable".to_owned());
    }
    if let Some(line) = document.count_right_of {
        let per = units.time(1.0);
        lines.push(format!(
            "with delay: every pole right of {} {} there is found and counted; what decays faster is no part of this",
            rounded(line / per),
            units.pick("per tau", "per s")
        ));
    }
    let mass = asked.rotor().control_mass(problem.structure.bearing());
    lines.push(format!(
        "steady control force up to {} {} (linear rotor), at {}{}",
        rounded(units.force(document.max_force, mass)),
        units.force_unit(),
        speed_text(units, document.max_force_at["speed"].as_f64()),
        others(&document.max_force_at)
    ));
    if let (Some(peak), Some(delay)) = (document.margins.get("sensitivity"), document.margins.get("delay")) {
        let place = |of: &Value| format!("{}{}", speed_text(units, of["at"]["speed"].as_f64()), others(&of["at"]));
        let number = |value: &Value| rounded(value.as_f64().unwrap_or(f64::NAN));
        let sure = match peak["below"].as_f64() {
            Some(below) => format!("; proven to be below {} at every condition", rounded(below)),
            None => "; not proven between the conditions looked at".to_owned(),
        };
        lines.push(format!("peak of the sensitivity {} at {}{sure}", number(&peak["peak"]), place(peak)));
        lines.push(match delay["tau"].as_f64() {
            Some(tau) => format!("delay margin {} at {}", units.time_text(tau), place(delay)),
            None => "no delay makes it unstable".to_owned(),
        });
    }
    let s = document.stationarity;
    lines.push(format!(
        "local optimality {:.1e}: {}, {}, {} at the bound",
        s.norm,
        count(s.active, "active mode"),
        count(s.merging, "merging pair"),
        count(s.at_bound, "gain")
    ));
    lines.push(format!(
        "{} of {} starts within 1 % of the best; {} eigenvalue problems in {:.3} s; seed {}",
        document.starts_within_1_percent, document.starts, document.evaluations, document.seconds, document.seed
    ));
    if document.interrupted {
        lines.push("interrupted: the best found until then".to_owned());
    }
    lines
}

/// A speed that was found, not typed: six digits are enough.
pub(super) fn speed_text(units: Units, speed: Option<f64>) -> String {
    units.speed_text((speed.unwrap_or(f64::NAN) * 1e6).round() / 1e6)
}

fn boxes(number: u64) -> String {
    if number == 1 { "1 box".into() } else { format!("{number} boxes") }
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// The coordinates of a condition beside its speed: `, factor.1 = 0, factor.3 = 1`.
fn others(condition: &Value) -> String {
    let known = ["speed", "re", "im", "damping", "value"];
    let each = condition.as_object().into_iter().flatten().filter(|(name, _)| !known.contains(&name.as_str()));
    each.map(|(name, value)| format!(", {name} = {}", rounded(value.as_f64().unwrap_or(f64::NAN)))).collect()
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
