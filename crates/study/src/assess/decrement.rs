//! The logarithmic decrement of every mode that counts over the range, `-2 pi Re s / |Im s|`, each where it is smallest.

use std::f64::consts::TAU;

use machine::{MachinePoles, trace};
use plot::{Axis, Chart, Color, Look, Series};
use rotor::C64;
use text::number::counted;

use super::{Asked, AssessError, AssessmentCase, Finding, Findings, Quantity, Where};

/// Modes damped so many times as well as is asked are summed up in one line.
const WELL_DAMPED: f64 = 10.0;
/// A minimum is pinned down to this part of the distance of two speeds looked at: beyond, it is flat.
const NEAR: f64 = 1e-8;
/// Whirl slower than this part of `|s|` is none, but rounding of a multiple pole.
const SLOWEST: f64 = 1e-5;

/// The decrement of a pole; nothing where nothing turns.
pub(super) fn decrement(pole: C64) -> Option<f64> {
    (pole.im.abs() > SLOWEST * pole.norm()).then(|| -TAU * pole.re / pole.im.abs())
}

/// Where a mode is damped least.
struct Least {
    decrement: f64,
    speed: f64,
    pole: C64,
}

pub(super) fn lines(question: &AssessmentCase<'_>) -> Result<Findings, AssessError> {
    let AssessmentCase { rotor, settings, limits, .. } = question;
    let speeds = AssessmentCase::speeds(question.over);
    let branches = trace(rotor, settings, &speeds)?;
    let source = limits.source("log_decrement");
    let asked = Asked::AtLeast(limits.log_decrement);
    let mut least: Vec<Least> = Vec::new();
    for branch in &branches {
        let known = branch.iter().enumerate().filter_map(|(k, pole)| Some((k, (*pole)?, decrement((*pole)?)?)));
        let Some((at, pole, found)) = known.min_by(|a, b| a.2.total_cmp(&b.2)) else { continue };
        least.push(between(question, &speeds, at, Least { decrement: found, speed: speeds[at], pole })?);
    }
    // What does not count is summed up below, unless it grows.
    let counts = |mode: &Least| question.modes.counts(mode.pole) || mode.pole.re >= 0.0;
    let (mut least, fast): (Vec<Least>, Vec<Least>) = least.into_iter().partition(counts);
    least.sort_by(|a, b| a.decrement.total_cmp(&b.decrement));
    let split = least.partition_point(|mode| mode.decrement <= WELL_DAMPED * limits.log_decrement).max(1);
    let mut lines: Vec<Finding> = (least.iter().take(split))
        .map(|mode| {
            let whirl = if mode.pole.im > 0.0 { "forward" } else { "backward" };
            let what = format!("log decrement, {whirl} mode");
            let line = Finding::judged(what, Quantity::Number, mode.decrement, asked, &source);
            line.at(Where::speed(mode.speed).with(mode.pole.im))
        })
        .collect();
    if let Some(next) = least.get(split) {
        let what = match least.len() - split {
            1 => "log decrement, the other mode".to_owned(),
            others => format!("log decrement, {others} other modes"),
        };
        let line = Finding::judged(what, Quantity::Number, next.decrement, asked, &source);
        lines.push(line.at(Where::speed(next.speed).with(next.pole.im)));
    }
    if let Some(next) = fast.iter().min_by(|a, b| a.decrement.total_cmp(&b.decrement)) {
        let what = format!("log decrement, {} faster than what counts", counted(fast.len(), "mode", "modes"));
        let line = Finding::told(what, Quantity::Number, next.decrement, &source);
        lines.push(line.at(Where::speed(next.speed).with(next.pole.im)).noted("decays: no more is asked of it"));
    }
    if lines.is_empty() {
        lines.push(Finding::without("log decrement", Quantity::Number, "no mode whirls: none has one", &source));
    }
    Ok((lines, vec![chart(question, &speeds, &branches)]))
}

/// The least of a mode between the neighbours of the speed at which it was least.
fn between(question: &AssessmentCase<'_>, speeds: &[f64], at: usize, mut least: Least) -> Result<Least, AssessError> {
    let [low, high] = [at.saturating_sub(1), (at + 1).min(speeds.len() - 1)].map(|k| speeds[k]);
    linear::least([low, high], NEAR * (high - low), |speed| -> Result<f64, AssessError> {
        let modes = MachinePoles::at(question.rotor, question.settings, speed)?.modes;
        let near = |mode: &rotor::Mode| (mode.pole - least.pole).norm_sqr();
        let Some(mode) = modes.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else { return Ok(f64::INFINITY) };
        let found = decrement(mode.pole).unwrap_or(f64::INFINITY);
        if found < least.decrement {
            least = Least { decrement: found, speed, pole: mode.pole };
        }
        Ok(found)
    })?;
    Ok(least)
}

/// Decrement over speed, forward and backward, with the line that is asked for.
fn chart(question: &AssessmentCase<'_>, speeds: &[f64], branches: &[Vec<Option<C64>>]) -> Chart {
    let [from, to] = question.over;
    let asked = question.limits.log_decrement;
    // What is well damped would press the rest against the axis.
    let top = WELL_DAMPED * asked;
    let mut series = Vec::new();
    let mut lowest = 0.0_f64;
    for (name, is_forward) in [("forward", true), ("backward", false)] {
        for (k, branch) in branches.iter().enumerate() {
            let of_side = |pole: &C64| (pole.im > 0.0) == is_forward;
            let points: Vec<(f64, f64)> = (speeds.iter().zip(branch))
                .map(|(speed, pole)| (*speed, pole.filter(of_side).and_then(decrement).unwrap_or(f64::NAN)))
                .collect();
            if points.iter().all(|(_, y)| y.is_nan()) {
                continue;
            }
            lowest = points.iter().map(|(_, y)| *y).filter(|y| y.is_finite()).fold(lowest, f64::min);
            let (look, color) = if is_forward { (Look::Solid, Color::BLUE) } else { (Look::Dashed, Color::VERMILLION) };
            let first = !series.iter().any(|s: &Series| s.name == name);
            series.push(Series::new(if first && k < branches.len() { name } else { "" }, look, color, points));
        }
    }
    series.push(Series::new("asked", Look::Dotted, Color::GREY, vec![(from, asked), (to, asked)]));
    Chart {
        title: "Logarithmic decrement over speed".into(),
        x: Axis::new("R = w / w0", from, to),
        y: Axis::new("logarithmic decrement", lowest.max(-top), top),
        equal: false,
        series,
        notes: vec![],
    }
}
