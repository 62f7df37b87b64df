//! How bad the smallest damping can get when parameters lie anywhere in ranges of theirs.
//!
//! The worst is sought among the corners of the box, one end after the other, from the corner to which the slopes at the nominal machine
//! point and from random ones, and then along each range, for what is worst inside. Of a chain of masses under gains alone it is then
//! bounded by the proof of the gain search ([`tuner::Certificate`]); else, or where that takes too long, it is the worst that was found.

use rayon::prelude::*;
use rotor::Gain;
use tuner::{Family, FamilyAxis, FamilyQuantity, Problem, Schedule, Stop, Structure};

use crate::model::Model;
use crate::parameter::{Parameter, Quantity};
use crate::samples::draw;
use crate::sensitivity::damping_sensitivities;
use crate::variation_error::VariationError;

/// Corners that the search starts from: of a chain, and of a drawing, which takes a thousand times as long.
const STARTS: [u64; 2] = [48, 4];
/// Rounds over all ranges for what is worst inside, and points looked at on each.
const ROUNDS: usize = 3;
const INSIDE: usize = 8;
/// Boxes of a proof times their corners: what is not proven by then is told as found.
const BUDGET: u64 = 6_000_000;

/// A parameter over a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Which.
    pub parameter: Parameter,
    /// Its least value.
    pub from: f64,
    /// Its greatest, larger than the least.
    pub to: f64,
}

impl Range {
    /// The value so far along it, 0 to 1.
    #[must_use]
    pub fn at(&self, part: f64) -> f64 {
        self.from * (1.0 - part) + self.to * part
    }
}

/// The worst over a box of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The smallest damping ratio found.
    pub value: f64,
    /// The values of the parameters there, in the order of the ranges.
    pub at: Vec<f64>,
    /// Whether it is proven that nothing in the box is worse by more than [`Worst::tolerance`]. Otherwise it is the worst that was found.
    pub proven: bool,
    /// How sharply it is bounded where it is.
    pub tolerance: f64,
    /// At how many machines the damping was looked at.
    pub looked_at: u64,
    /// At how many boxes a proof looked.
    pub boxes: u64,
}

/// The worst of `model` over all values in `ranges`.
///
/// # Errors
/// A value that a parameter cannot have, or poles that cannot be had.
pub fn worst(model: &Model, ranges: &[Range], tolerance: f64, seed: u64, stop: Stop) -> Result<Worst, VariationError> {
    let mut found = search(model, ranges, seed)?;
    found.tolerance = tolerance;
    if let Some((problem, gains)) = provable(model, ranges) {
        let values: Vec<f64> =
            std::iter::once(speed_of(model, ranges, &found.at)).chain(others(ranges, &found.at)).collect();
        let point = problem.family.point(&values);
        let corners = 1_u64 << ranges.len().min(32);
        if let Ok(bound) = tuner::bound(&problem, &gains, &point, tolerance, BUDGET / corners, stop) {
            found.boxes = bound.boxes;
            found.proven = bound.proven;
            if bound.value < found.value {
                let values = problem.family.values(&bound.point);
                let mut rest = values[1..].iter();
                let at = |range: &Range| if is_speed(range) { Some(values[0]) } else { rest.next().copied() };
                (found.value, found.at) = (bound.value, ranges.iter().filter_map(at).collect());
            }
        }
    }
    Ok(found)
}

fn is_speed(range: &Range) -> bool {
    matches!(range.parameter.quantity, Quantity::Setting(key) if key.parameter.name == "speed")
}

fn speed_of(model: &Model, ranges: &[Range], at: &[f64]) -> f64 {
    ranges.iter().zip(at).find(|(range, _)| is_speed(range)).map_or(model.settings.speed, |(_, speed)| *speed)
}

fn others(ranges: &[Range], at: &[f64]) -> impl Iterator<Item = f64> {
    ranges.iter().zip(at).filter(|(range, _)| !is_speed(range)).map(|(_, value)| *value)
}

/// The question of the gain search that a box is, with its gains; `None` where that has no proof of it.
fn provable(model: &Model, ranges: &[Range]) -> Option<(Problem, Vec<f64>)> {
    let speed = ranges.iter().find(|range| is_speed(range));
    let (from, to) = speed.map_or((model.settings.speed, model.settings.speed), |range| (range.from, range.to));
    let mut family = Family::new(&model.rotor, from, to).ok()?;
    for range in ranges.iter().filter(|range| !is_speed(range)) {
        let quantity = match range.parameter.quantity {
            Quantity::Field { field, mass } => FamilyQuantity::Parameter { field, mass },
            Quantity::Shaft(shaft) => FamilyQuantity::Shaft(shaft),
            Quantity::Factor(mass) => FamilyQuantity::Stiffness(vec![mass]),
            _ => return None,
        };
        family.push(FamilyAxis { quantity, from: range.from, to: range.to }).ok()?;
    }
    let mut feedback = model.settings.feedback.clone();
    for gain in feedback.bearings.iter_mut().flat_map(|b| &mut b.signals).flat_map(|signal| &mut signal.gains) {
        match gain {
            Gain::Constant(_) => {}
            scheduled if from == to => *scheduled = Gain::Constant(scheduled.at(from)),
            _ => return None,
        }
    }
    let structure = Structure::new(&model.rotor, &feedback, Schedule::Fixed).ok()?;
    let gains = structure.variables_of(&feedback);
    let bound = gains.iter().fold(1.0_f64, |largest, gain| largest.max(gain.abs()));
    let problem = Problem::new(family, structure, bound);
    problem.is_ideal().then_some((problem, gains))
}

/// Where a search stands: how far along every range, and the damping there.
#[derive(Clone)]
struct SearchPlace {
    parts: Vec<f64>,
    value: f64,
}

fn search(model: &Model, ranges: &[Range], seed: u64) -> Result<Worst, VariationError> {
    let value = |parts: &[f64]| -> Result<f64, VariationError> {
        let changes: Vec<(&Parameter, f64)> =
            ranges.iter().zip(parts).map(|(range, part)| (&range.parameter, range.at(*part))).collect();
        model.with(&changes)?.min_damping()
    };
    let count = ranges.len();
    let first = downhill(model, ranges)?;
    let starts = (0..STARTS[usize::from(!model.rotor.is_chain())]).map(|start| {
        let random = || draw(seed, start, count).into_iter().map(f64::round).collect();
        if start == 0 { first.clone() } else { random() }
    });
    let starts: Vec<Vec<f64>> = starts.collect();
    let each: Result<Vec<(SearchPlace, u64)>, VariationError> = starts
        .into_par_iter()
        .map(|parts| {
            let mut place = SearchPlace { value: value(&parts)?, parts };
            let mut looked_at = 1;
            // Every other end by itself, until none is worse: all of those that are, at once if that is worse still, else the worst alone.
            loop {
                let flipped = |mut parts: Vec<f64>, ends: &[usize]| {
                    ends.iter().for_each(|k| parts[*k] = 1.0 - parts[*k]);
                    parts
                };
                let mut worse: Vec<(f64, usize)> = Vec::new();
                for k in 0..count {
                    let value = value(&flipped(place.parts.clone(), &[k]))?;
                    looked_at += 1;
                    if value < place.value {
                        worse.push((value, k));
                    }
                }
                let Some(&(alone, worst)) = worse.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
                let ends: Vec<usize> = worse.iter().map(|(_, k)| *k).collect();
                let parts = flipped(place.parts.clone(), &ends);
                let together = value(&parts)?;
                looked_at += 1;
                place = if together < alone {
                    SearchPlace { parts, value: together }
                } else {
                    SearchPlace { parts: flipped(place.parts, &[worst]), value: alone }
                };
            }
            Ok((place, looked_at))
        })
        .collect();
    let each = each?;
    let mut looked_at: u64 = each.iter().map(|(_, looked_at)| looked_at).sum();
    let mut best = each.into_iter().map(|(place, _)| place).reduce(|a, b| if b.value < a.value { b } else { a });
    if let Some(place) = &mut best {
        let mut width = 1.0;
        for _ in 0..ROUNDS {
            for k in 0..count {
                looked_at += inside(place, k, width, &value)?;
            }
            width *= 0.5;
        }
    }
    let SearchPlace { parts, value } = best.unwrap_or(SearchPlace { parts: vec![], value: model.min_damping()? });
    let at = ranges.iter().zip(&parts).map(|(range, part)| range.at(*part)).collect();
    Ok(Worst { value, at, proven: false, tolerance: 0.0, looked_at, boxes: 0 })
}

/// Moves a place along range `k`, by up to `width` of it, to where it is worst; to within a millionth.
fn inside(
    place: &mut SearchPlace,
    k: usize,
    width: f64,
    value: &dyn Fn(&[f64]) -> Result<f64, VariationError>,
) -> Result<u64, VariationError> {
    let mut looked_at = 0;
    let mut half = width;
    while half > 1e-6 {
        let middle = place.parts[k];
        let mut better = false;
        for i in 0..=INSIDE {
            let part = (middle + half * (2.0 * i as f64 / INSIDE as f64 - 1.0)).clamp(0.0, 1.0);
            if part == place.parts[k] {
                continue;
            }
            let mut parts = place.parts.clone();
            parts[k] = part;
            let value = value(&parts)?;
            looked_at += 1;
            if value < place.value {
                (*place, better) = (SearchPlace { parts, value }, true);
            }
        }
        if !better && half == width {
            break;
        }
        half *= 2.0 / INSIDE as f64;
    }
    Ok(looked_at)
}

/// The corner to which the damping falls from the nominal machine.
fn downhill(model: &Model, ranges: &[Range]) -> Result<Vec<f64>, VariationError> {
    let parameters: Vec<Parameter> = ranges.iter().map(|range| range.parameter.clone()).collect();
    let found = damping_sensitivities(model, &parameters)?;
    let rises = |slope: &crate::Sensitivity| slope.min_damping.as_ref().is_ok_and(|slope| slope.steepest() > 0.0);
    Ok(found.each.iter().map(|slope| if rises(slope) { 0.0 } else { 1.0 }).collect())
}
