//! `--track`: gains that follow the speed, as a table, a picture, and a feedback file of tables.

use std::sync::atomic::AtomicBool;

use plot::{Axis, Chart, Color, Look, Series};
use rotor::GainKind;
use rotor::file::FeedbackDocument;
use serde::Serialize;
use tuner::{Stop, Tracked, track};

use super::answer::{known, verdict};
use super::question::Asked;
use super::summary::speed_text;
use super::{TuneArgs, Watch, write_file};
use crate::failure::Failure;
use crate::output::{Cell, Table, rounded};
use crate::picture;
use crate::range::Range;
use crate::units::UnitsDocument;

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    /// `null` where a mode is marginal.
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    count_right_of: Option<f64>,
    /// Over the whole range, gains interpolated.
    min_damping: f64,
    worst_speed: f64,
    proven: bool,
    tolerance: f64,
    /// The largest change of any gain per unit of speed.
    steepest: f64,
    speeds: &'a [f64],
    /// At each speed.
    damping: &'a [f64],
    feedback: FeedbackDocument<'a>,
    seconds: f64,
    seed: u64,
    interrupted: bool,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Searches, prints, draws and writes.
pub(super) fn run(args: &TuneArgs, asked: &Asked, flag: &AtomicBool) -> Result<(), Failure> {
    let [(bearing, sensors)] = &asked.choices()[..] else {
        return Err(Failure::Usage("--track is for one place: give --bearing and --sensors by number".into()));
    };
    let problem = asked.problem(*bearing, sensors);
    let (from, to) = asked.family.speeds();
    let speeds = Range { from, to }.points(args.track.unwrap_or(2) as usize);
    let (watch, begun) = (Watch::new(), std::time::Instant::now());
    let found = track(&problem, &speeds, args.stiffness, &args.options(&problem), &|p| watch.say(p), Stop::when(flag))?;
    watch.end();
    let (units, worst) = (asked.units(), &found.evaluated.worst);
    known(asked, &found.evaluated)?;
    let stable = worst.stable();
    let names: Vec<String> = (0..found.evaluated.feedback.signal_count())
        .flat_map(|k| GainKind::ALL.map(|kind| format!("{}.{}", kind.name(), k + 1)))
        .collect();
    let gains_of = |variables: &[f64]| problem.structure.gains_at(variables, from);
    let head = [units.pick("speed", "speed (rpm)"), "min damping"].map(str::to_owned);
    let mut table = Table::new(&[&head[..], &names[..]].concat());
    for (speed, (value, gains)) in found.speeds.iter().zip(found.values.iter().zip(&found.gains)) {
        table.row([units.speed(*speed), *value].into_iter().chain(gains_of(gains)).map(Cell::from));
    }
    let footer = format!(
        "interpolated: min damping {} at {}, {}; no gain changes by more than {} per unit of speed",
        rounded(worst.value),
        speed_text(units, Some(worst.point[0])),
        if worst.proven {
            format!("proven within {:e} over the range", worst.tolerance)
        } else {
            "the worst found".into()
        },
        rounded(found.steepest())
    );
    if let Some(path) = &args.out
        && (stable == Some(true) || args.write_unstable)
    {
        write_file(path, args.force, (found.feedback(), asked.rotor()), std::slice::from_ref(&footer))?;
    }
    if let Some(path) = &args.plot {
        picture::draw(path, args.force, &[chart(asked, &found, &names, &gains_of)])?;
    }
    let document = Document {
        rotor: asked.rotor().name(),
        stable,
        count_right_of: worst.count_right_of,
        min_damping: worst.value,
        worst_speed: worst.point[0],
        proven: worst.proven,
        tolerance: worst.tolerance,
        steepest: found.steepest(),
        speeds: &found.speeds,
        damping: &found.values,
        feedback: FeedbackDocument(found.feedback()),
        seconds: begun.elapsed().as_secs_f64(),
        seed: args.seed,
        interrupted: found.evaluated.interrupted,
        units: units.document(),
    };
    let heading = format!("{}, {}: gains followed over speed", asked.rotor().name(), asked.range_text);
    args.format.print(&document, &heading, &table, &footer)?;
    verdict(asked, &found.evaluated)
}

fn chart(asked: &Asked, found: &Tracked, names: &[String], gains_of: &dyn Fn(&[f64]) -> Vec<f64>) -> Chart {
    let each: Vec<Vec<f64>> = found.gains.iter().map(|variables| gains_of(variables)).collect();
    let looks = [
        (Look::Solid, Color::BLUE),
        (Look::Dashed, Color::VERMILLION),
        (Look::Dotted, Color::GREEN),
        (Look::Thin, Color::PURPLE),
    ];
    let series = names.iter().enumerate().map(|(i, name)| {
        let (look, color) = looks[i % looks.len()];
        let points = found.speeds.iter().zip(&each).map(|(speed, gains)| (*speed, gains[i])).collect();
        Series::new(name, look, color, points)
    });
    let all = || each.iter().flatten();
    let (low, high) = (all().fold(0.0, |a: f64, g| a.min(*g)), all().fold(0.0, |a: f64, g| a.max(*g)));
    let margin = 0.05 * (high - low).max(1e-9);
    let (from, to) = asked.family.speeds();
    Chart {
        title: format!("{}: gains over speed", asked.rotor().name()),
        x: Axis::new("spin speed R", from, to),
        y: Axis::new("gain", low - margin, high + margin),
        equal: false,
        series: series.collect(),
        notes: Vec::new(),
    }
}
