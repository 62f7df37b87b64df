//! Critical speeds: peaks of the response to the rotor's own unbalance, their amplification factor by half-power points, and how
//! far each is from the operating range.

use machine::unbalance_response;

use super::{Asked, AssessError, Line, Part, Quantity, Question, Where};
use crate::runup::{ResonancePeak, peaks};
use plot::{Axis, Chart, Color, Look, Series};

/// Peaks this far above the range, in parts of its end, can still be too near.
const BEYOND: f64 = 1.4;

/// One peak for each resonance: peaks of several masses within each other's half-power points are the same, told where it is
/// sharpest.
fn resonances(mut peaks: Vec<(usize, ResonancePeak)>) -> Vec<(usize, ResonancePeak)> {
    peaks.sort_by(|a, b| a.1.speed.total_cmp(&b.1.speed));
    let mut found: Vec<(usize, ResonancePeak)> = Vec::new();
    for (station, peak) in peaks {
        match found.last_mut() {
            Some((at, known)) if *at != station && known.half_power[1].is_some_and(|end| peak.speed < end) => {
                if peak.amplification() > known.amplification() {
                    (*at, *known) = (station, peak);
                }
            }
            _ => found.push((station, peak)),
        }
    }
    found
}

/// What is asked of one critical speed.
fn line(question: &Question<'_>, station: usize, peak: &ResonancePeak) -> Line {
    let limits = question.limits;
    let place = Where::speed(peak.speed).of(station);
    let (factor, source) = ("critical speed, amplification factor", limits.source("amplification"));
    let Some(amplification) = peak.amplification() else {
        let why = "the range has not both half-power points";
        return Line::without(factor, Quantity::Number, why, &source).at(place);
    };
    let Some([below, above]) = limits.separation(amplification) else {
        let asked = Asked::AtMost(limits.amplification);
        let line = Line::judged(factor, Quantity::Number, amplification, asked, &source);
        return line.at(place).noted("no separation asked");
    };
    let [low, high] = question.operating;
    let (found, asked) = if peak.speed < low {
        (100.0 * (low - peak.speed) / low, below)
    } else if peak.speed > high {
        (100.0 * (peak.speed - high) / high, above)
    } else {
        (0.0, below.min(above))
    };
    let inside = if found == 0.0 { ", within the operating range" } else { "" };
    let source = limits.source("separation_above");
    let line = Line::judged("critical speed, separation", Quantity::Percent, found, Asked::AtLeast(asked), &source);
    line.at(place).noted(format!("amplification {amplification:.3}{inside}"))
}

pub(super) fn lines(question: &Question<'_>) -> Result<Part, AssessError> {
    let (rotor, settings, limits) = (question.rotor, question.settings, question.limits);
    let what = "critical speed, separation";
    let source = limits.source("separation_above");
    let range = [question.over[0], question.over[1].max(BEYOND * question.operating[1])];
    let Some(response) = unbalance_response(rotor, settings, range)? else {
        let why = "a sampled loop: its response is not a circle";
        return Ok((vec![Line::without(what, Quantity::Percent, why, &source)], vec![]));
    };
    let speeds: Vec<f64> = response.points.iter().map(|point| point.speed).collect();
    let stations = response.points.first().map_or(0, |point| point.stations.len());
    let heights = |station: usize| -> Vec<f64> { response.points.iter().map(|p| p.stations[station].norm()).collect() };
    let each = (0..stations)
        .flat_map(|station| peaks(&speeds, &heights(station)).into_iter().map(move |peak| (station, peak)));
    let mut lines: Vec<Line> =
        resonances(each.collect()).iter().map(|(station, peak)| line(question, *station, peak)).collect();
    if lines.is_empty() {
        let why = "the response to unbalance has no peak: no critical speed";
        lines.push(Line { passed: Some(true), ..Line::without(what, Quantity::Percent, why, &source) });
    }
    let colors = [Color::BLUE, Color::VERMILLION, Color::GREEN, Color::PURPLE, Color::BLACK];
    let looks = [Look::Solid, Look::Dashed, Look::Dotted];
    let series = (0..stations).map(|station| {
        let points = speeds.iter().copied().zip(heights(station)).collect();
        let (look, color) = (looks[station % looks.len()], colors[station % colors.len()]);
        Series::new(&format!("mass {}", station + 1), look, color, points)
    });
    let top = (0..stations).flat_map(heights).fold(0.0, f64::max);
    let chart = Chart {
        title: "Response to the rotor's unbalance over speed".into(),
        x: Axis::new("R = w / w0", range[0], range[1]),
        y: Axis::new("radius / e_t", 0.0, if top > 0.0 { 1.05 * top } else { 1.0 }),
        equal: false,
        series: series.collect(),
        notes: vec![],
    };
    Ok((lines, vec![chart]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_of_several_masses_within_each_others_half_power_points_are_one_critical_speed() {
        let peak = |speed: f64, half: f64| ResonancePeak {
            speed,
            height: 1.0,
            at: 0,
            width: 4,
            half_power: [Some(speed - half), Some(speed + half)],
        };
        let found =
            resonances(vec![(0, peak(2.0, 0.2)), (1, peak(2.1, 0.1)), (2, peak(3.0, 0.1)), (0, peak(3.05, 0.2))]);
        let told: Vec<(usize, f64)> = found.iter().map(|(station, peak)| (*station, peak.speed)).collect();
        assert_eq!(told, [(1, 2.1), (2, 3.0)]);
    }
}
