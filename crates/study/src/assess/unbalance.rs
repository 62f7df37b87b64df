//! The response to the unbalance that standards allow: twice the residual of API 617, and that of an ISO 21940 grade. Every mass has
//! the same eccentricity, and the angles between them are the worst there are for each place: with `H_ik` the response of place `i`
//! to a unit of eccentricity at mass `k`, that is `sum_k |H_ik| e_k`.

use std::str::FromStr;

use control::LinearLoop;
use linear::least;
use machine::forced_response;
use nalgebra::DMatrix;
use rotor::{C64, LinearForm, OperatingPoint, Plant, Scales};

use super::{Asked, AssessError, AssessmentCase, Finding, Findings, Quantity, Where};

/// The speed in rpm from which less vibration is allowed (API 617).
const KNEE: f64 = 12_000.0;

/// A balance quality grade of ISO 21940-11: eccentricity times speed, in mm/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade(f64);

/// Why something is no grade.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}': expected a balance quality grade, such as G2.5 (mm/s)")]
pub struct GradeError(String);

impl FromStr for Grade {
    type Err = GradeError;

    fn from_str(typed: &str) -> Result<Self, GradeError> {
        let number = typed.strip_prefix(['G', 'g']).unwrap_or(typed).trim();
        match number.parse::<f64>() {
            Ok(grade) if grade.is_finite() && grade > 0.0 => Ok(Self(grade)),
            _ => Err(GradeError(typed.to_owned())),
        }
    }
}

impl std::fmt::Display for Grade {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "G{}", self.0)
    }
}

impl Grade {
    /// The eccentricity in m that it allows at an angular speed in rad/s.
    #[must_use]
    pub fn eccentricity(self, speed: f64) -> f64 {
        1e-3 * self.0 / speed
    }
}

/// The largest response of a place.
#[derive(Clone, Copy)]
struct Largest {
    radius: f64,
    speed: f64,
    station: usize,
}

pub(super) fn lines(question: &AssessmentCase<'_>) -> Result<Findings, AssessError> {
    let limits = question.limits;
    let (vibration_source, share_source) = (limits.source("vibration"), limits.source("clearance_share"));
    let plain = "vibration under 2 U_r, peak to peak";
    if question.settings.feedback.sample() > 0.0 {
        let why = "a sampled loop: its response is not a circle";
        return Ok((vec![Finding::without(plain, Quantity::Length, why, &vibration_source)], vec![]));
    }
    let Some(scales) = question.rotor.scales().copied() else {
        let why = "needs a rotor in SI units: residual unbalance is told in g mm, vibration in um";
        return Ok((vec![Finding::without(plain, Quantity::Length, why, &vibration_source)], vec![]));
    };
    let mut sensors = Vec::new();
    for bearing in &question.settings.feedback.bearings {
        sensors.extend(LinearLoop::new(bearing, question.rotor.len(), question.operating[1])?.sensors);
    }
    sensors.sort_unstable();
    sensors.dedup();
    let all: Vec<usize> = (0..question.rotor.len()).collect();
    let seen = if sensors.is_empty() { &all } else { &sensors };

    let top = scales.rpm(question.operating[1]);
    let allowed = scales.length(1e-6 * limits.vibration * (KNEE / top).sqrt().min(1.0));
    let eccentricity = scales.length(2e-6 * limits.residual_unbalance / top);
    let at_sensors = largest(question, question.operating, seen)?;
    let amplitude = 2.0 * eccentricity * at_sensors.radius;
    let mut lines = vec![
        Finding::judged(plain, Quantity::Length, amplitude, Asked::AtMost(allowed), &vibration_source)
            .at(at_sensors.place())
            .noted(format!("2 U_r is {:.3} um at every mass", 1e6 * scales.metres(eccentricity))),
    ];
    let scale = limits.scale_factor.min(allowed / amplitude);
    let what = "scaled major axis / clearance";
    lines.push(match question.smallest_clearance() {
        None => Finding::without(what, Quantity::Percent, "no clearance is set", &share_source),
        Some(clearance) => {
            let anywhere = largest(question, question.over, &all)?;
            let share = 100.0 * scale * eccentricity * anywhere.radius / clearance;
            Finding::judged(what, Quantity::Percent, share, Asked::AtMost(limits.clearance_share), &share_source)
                .at(anywhere.place())
                .noted(format!("scaled up {scale:.3} times"))
        }
    });
    if let Some(grade) = question.grade {
        lines.push(graded(question, grade, &scales, &all)?);
    }
    Ok((lines, vec![]))
}

/// The largest orbit of a rotor balanced to a grade, against the zone of orbits that is asked for.
fn graded(question: &AssessmentCase<'_>, grade: Grade, scales: &Scales, all: &[usize]) -> Result<Finding, AssessError> {
    let limits = question.limits;
    let largest = largest(question, question.operating, all)?;
    let radius = scales.length(grade.eccentricity(question.operating[1] * scales.w0)) * largest.radius;
    let what = format!("orbit of a rotor balanced to {grade}");
    let line = match question.smallest_clearance() {
        None => Finding::told(what, Quantity::Length, radius, "ISO 21940-11").noted("no clearance is set"),
        Some(clearance) => {
            let (zone, most) = limits.zone_of(radius / clearance, limits.orbit_zones());
            let source = format!("ISO 21940-11; {}", limits.source("orbit_zone_a"));
            Finding::judged(what, Quantity::Length, radius, Asked::AtMost(most * clearance), &source)
                .noted(format!("zone {zone}"))
        }
    };
    Ok(line.at(largest.place()))
}

impl Largest {
    fn place(self) -> Where {
        Where::speed(self.speed).of(self.station)
    }
}

/// The largest radius at any of `places` over a range, per eccentricity at every mass, at the worst angles.
fn largest(question: &AssessmentCase<'_>, range: [f64; 2], places: &[usize]) -> Result<Largest, AssessError> {
    let plant = Plant::of(question.rotor);
    let at = |speed: f64| -> Result<Largest, AssessError> {
        let radii = worst_radii(
            &plant,
            &LinearForm::of(&plant, &question.settings.feedback, &OperatingPoint::at(speed))?,
            speed,
        );
        let largest = places.iter().map(|station| Largest { radius: radii[*station], speed, station: *station });
        Ok(largest.max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap_or(Largest { radius: 0.0, speed, station: 0 }))
    };
    let speeds = AssessmentCase::speeds(range);
    let found: Vec<Largest> = speeds.iter().map(|speed| at(*speed)).collect::<Result<_, _>>()?;
    let best = (0..found.len()).max_by(|a, b| found[*a].radius.total_cmp(&found[*b].radius)).unwrap_or(0);
    let mut largest = found[best];
    let [low, high] = [best.saturating_sub(1), (best + 1).min(speeds.len() - 1)].map(|k| speeds[k]);
    least([low, high], 1e-9 * (1.0 + high), |speed| -> Result<f64, AssessError> {
        let seen = at(speed)?;
        if seen.radius > largest.radius {
            largest = seen;
        }
        Ok(-seen.radius)
    })?;
    Ok(largest)
}

/// For every station the sum over the masses of its response to a unit of eccentricity there, in magnitude.
fn worst_radii(plant: &Plant, form: &LinearForm, speed: f64) -> Vec<f64> {
    let stations = plant.stations().len();
    let n = form.coordinates;
    let drive = DMatrix::from_diagonal_element(n, n, C64::from(speed * speed));
    // A pole at the very speed: no sampled loop gets here.
    let Some(x) = forced_response(form, speed, &drive) else { return vec![f64::INFINITY; stations] };
    let radius = |station: &rotor::Station| -> f64 {
        x.column_iter().map(|column| station.row.read(column.as_slice()).norm()).sum()
    };
    plant.stations().iter().map(radius).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_a_grade_is_eccentricity_times_speed() {
        // G2.5 at 3000 rpm: 2.5 mm/s over 314.16 rad/s are 7.96 um.
        let grade: Grade = "G2.5".parse().unwrap();
        assert!((grade.eccentricity(100.0 * std::f64::consts::PI) - 7.957_747e-6).abs() < 1e-12);
        assert_eq!(grade.to_string(), "G2.5");
        assert_eq!("2.5".parse(), Ok(grade));
        for wrong in ["G", "G-1", "Gx", "", "Ginf"] {
            assert!(wrong.parse::<Grade>().is_err(), "{wrong}");
        }
    }
}
