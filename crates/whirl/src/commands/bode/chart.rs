//! Frequency responses as charts: amplitude and phase over the size of the frequency, forward and backward whirl apart; or
//! the response in the complex plane.

use machine::FrequencyPoint;
use plot::{Axis, Chart, Color, Look, Note, Series, Side};
use rotor::C64;

use super::{Show, frequency_label};
use crate::units::CommandUnits;

/// Decades of frequency below the highest.
const DECADES: f64 = 1e-3;
/// Sensitivities whose circles are drawn around -1.
const CIRCLES: [f64; 3] = machine::ISO_14839_3;

/// The charts of a response, from above.
pub(in crate::commands) fn of(
    points: &[FrequencyPoint],
    title: &str,
    show: Show,
    units: CommandUnits,
    scale: f64,
    unit: &str,
    is_loop: bool,
) -> Vec<Chart> {
    match show {
        Show::Nyquist => vec![nyquist(points, title.to_owned(), scale, unit, is_loop)],
        Show::Amplitude => vec![amplitude(points, title.to_owned(), units, scale, unit)],
        Show::Phase => vec![phase(points, title.to_owned(), units)],
        Show::Bode => {
            vec![amplitude(points, title.to_owned(), units, scale, unit), phase(points, String::new(), units)]
        }
    }
}

/// A line of phases in degrees, broken where it passes 180 and goes on at -180.
pub(super) fn wrapped(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        if line.last().is_some_and(|last| (last.1 - point.1).abs() > 180.0) {
            line.push((f64::NAN, f64::NAN));
        }
        line.push(point);
    }
    line
}

fn amplitude(points: &[FrequencyPoint], title: String, units: CommandUnits, scale: f64, unit: &str) -> Chart {
    if unit.is_empty() {
        let decibels = |p: &FrequencyPoint| 20.0 * p.value.norm().max(f64::MIN_POSITIVE).log10();
        let sizes = || points.iter().map(decibels);
        let top = sizes().fold(f64::NEG_INFINITY, f64::max);
        let bottom = sizes().fold(top, f64::min).max(top - 80.0);
        let room = 0.05 * (top - bottom) + 1.0;
        return over(points, title, units, Axis::new("amplitude, dB", bottom - room, top + room), decibels);
    }
    let sizes = || points.iter().map(|p| p.value.norm() * scale).filter(|a| *a > 0.0 && a.is_finite());
    let top = sizes().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let bottom = sizes().fold(top, f64::min).max(1e-4 * top);
    let y = Axis { log: true, ..Axis::new(&format!("amplitude{unit}"), bottom / 1.5, top * 1.5) };
    over(points, title, units, y, |p| p.value.norm() * scale)
}

fn phase(points: &[FrequencyPoint], title: String, units: CommandUnits) -> Chart {
    over(points, title, units, Axis::new("phase, degrees", -180.0, 180.0), |p| p.value.arg().to_degrees())
}

fn over(
    points: &[FrequencyPoint],
    title: String,
    units: CommandUnits,
    y: Axis,
    value: impl Fn(&FrequencyPoint) -> f64,
) -> Chart {
    let top = points.iter().map(|p| units.frequency(p.frequency).abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let x = Axis { log: true, ..Axis::new(frequency_label(units), DECADES * top, top) };
    let wraps = y.label.starts_with("phase");
    let side = |name: &str, look: Look, color: Color, sign: f64| {
        let mut shown: Vec<(f64, f64)> = points
            .iter()
            .filter(|p| p.frequency * sign > 0.0)
            .map(|p| (units.frequency(p.frequency).abs(), value(p)))
            .collect();
        shown.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series::new(name, look, color, if wraps { wrapped(shown) } else { shown })
    };
    let series = vec![
        side("forward whirl", Look::Solid, Color::BLUE, 1.0),
        side("backward whirl", Look::Dashed, Color::VERMILLION, -1.0),
    ];
    Chart { title, x, y, equal: false, series, notes: Vec::new() }
}

/// In the plane of its values; of the loop's gain with the point -1 and circles of one sensitivity around it, which hold there alone.
fn nyquist(points: &[FrequencyPoint], title: String, scale: f64, unit: &str, is_loop: bool) -> Chart {
    let part = |name: &str, look: Look, color: Color, sign: f64| {
        let shown = points.iter().filter(|p| p.frequency * sign >= 0.0);
        Series::new(name, look, color, shown.map(|p| (p.value.re * scale, p.value.im * scale)).collect())
    };
    let mut series = vec![
        part("forward whirl", Look::Solid, Color::BLUE, 1.0),
        part("backward whirl", Look::Dashed, Color::VERMILLION, -1.0),
    ];
    let mut notes = Vec::new();
    let circles = if is_loop { &CIRCLES[..] } else { &[] };
    for (k, sensitivity) in circles.iter().enumerate() {
        let around = (0..=120).map(|i| C64::cis(std::f64::consts::TAU * f64::from(i) / 120.0) / *sensitivity - 1.0);
        let name = if k == 0 { "|S| = 3, 4, 5" } else { "" };
        series.push(Series::new(name, Look::Dotted, Color::GREY, around.map(|z| (z.re, z.im)).collect()));
    }
    let far = points.iter().map(|p| p.value.norm() * scale).filter(|a| a.is_finite()).fold(0.0, f64::max);
    let end = if is_loop {
        series.push(Series::new("", Look::Crosses, Color::BLACK, vec![(-1.0, 0.0)]));
        notes.push(Note { at: (-1.0, 0.0), text: "-1".into(), side: Side::Below });
        // What is far out says nothing of -1.
        (1.1 * far).clamp(1.6, 4.0)
    } else {
        1.1 * far.max(f64::MIN_POSITIVE)
    };
    Chart {
        title,
        x: Axis::new(&format!("Re{unit}"), -end, end),
        y: Axis::new(&format!("Im{unit}"), -end, end),
        equal: true,
        series,
        notes,
    }
}
