//! The peak of the sensitivity over the operating range, and its zone.

use machine::{MarginsError, margins_at, worst_among};

use super::{Asked, AssessError, AssessmentCase, Finding, Findings, Quantity, Where};
use plot::{Axis, Chart, Color, Look, Series};

/// The place of the sensitivity among [`machine::WORST`].
const SENSITIVITY: usize = 4;
/// Axes end at so many times the last zone's end.
const TOP: f64 = 1.5;

pub(super) fn lines(question: &AssessmentCase<'_>) -> Result<Findings, AssessError> {
    let (rotor, settings, limits) = (question.rotor, question.settings, question.limits);
    let speeds = AssessmentCase::speeds(question.operating);
    let what = "sensitivity, peak of |S|";
    let source = limits.source("sensitivity_zone_a");
    let zones = limits.sensitivity_zones();
    let asked = Asked::AtMost(limits.zone_of(0.0, zones).1);
    let all = match margins_at(rotor, settings, &speeds) {
        Ok(all) => all,
        Err(MarginsError::Unstable { speed, .. }) => {
            let why = "not stable: there is no margin";
            let line = Finding::without(what, Quantity::Number, why, &source).at(Where::speed(speed));
            return Ok((vec![Finding { passed: Some(false), asked: Some(asked), ..line }], vec![]));
        }
        Err(error) => return Err(error.into()),
    };
    let worst = worst_among(rotor, settings, &speeds, &all)?;
    let mut lines = Vec::new();
    if let Some(found) = &worst[SENSITIVITY] {
        let peak = found.margins.sensitivity();
        let zone = limits.zone_of(peak.amplitude, zones).0;
        let line = Finding::judged(what, Quantity::Number, peak.amplitude, asked, &source);
        lines.push(
            line.at(Where { frequency: peak.frequency, ..Where::speed(found.speed) }).noted(format!("zone {zone}")),
        );
    }
    let points = all.iter().map(|found| (found.speed, found.margins.sensitivity().amplitude));
    let [from, to] = question.operating;
    let top = TOP * zones[2];
    let ends = (zones.iter().zip(["zone A ends", "zone B ends", "zone C ends"])).zip([
        Color::GREEN,
        Color::PURPLE,
        Color::VERMILLION,
    ]);
    let mut series: Vec<Series> = ends
        .map(|((end, name), color)| Series::new(name, Look::Dotted, color, vec![(from, *end), (to, *end)]))
        .collect();
    series.push(Series::new(
        "peak of |S|",
        Look::Solid,
        Color::BLUE,
        points.map(|(x, y)| (x, y.min(10.0 * top))).collect(),
    ));
    let chart = Chart {
        title: "Peak of the sensitivity over speed".into(),
        x: Axis::new("R = w / w0", from, to),
        y: Axis::new("|S|", 0.0, top),
        equal: false,
        series,
        notes: vec![],
    };
    Ok((lines, vec![chart]))
}
