//! The peak of the sensitivity over a whole family, bounded: no condition between those that were looked at can hide a higher one.
//!
//! For gains that are the same at every speed, at one control bearing, with nothing in the loop but a delay, the matrices of a family
//! over speed and one factor of stiffness are affine in both; [`DelaySystem::covered_peak`] covers them together with the frequency.
//! The speeds are cut into parts, which are covered side by side.

use linear::{AffineTerm, C64, DelaySystem};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::stop::Stop;
use crate::{FamilyQuantity, Problem, Schedule, delay};

/// How far above the highest peak found the bound is, relative to it.
pub(crate) const TOLERANCE: f64 = 1e-3;
/// Parts of the first coordinate.
const PARTS: usize = 32;
/// Cells of frequency and conditions that one part may take.
const BUDGET: u64 = 40_000;
/// More coordinates than this take too many cells.
const MOST_AXES: usize = 2;

/// What no condition of the family exceeds, `known` being a peak that one has; `None` where nothing is proven.
pub(crate) fn peak_below(problem: &Problem, gains: &[f64], known: f64, stop: &Stop) -> Option<f64> {
    let (family, structure) = (&problem.family, &problem.structure);
    let axes: Vec<usize> = family.varying().collect();
    let is_affine =
        |axis: &usize| matches!(family.axes()[*axis].quantity, FamilyQuantity::Speed | FamilyQuantity::Stiffness(_));
    let is_plain = structure.is_plain() && !family.has_delay() && *structure.schedule() == Schedule::Fixed;
    if !is_plain || !known.is_finite() || axes.len() > MOST_AXES || !axes.iter().all(is_affine) {
        return None;
    }
    let parts = if axes.is_empty() { 1 } else { PARTS };
    let covered = |part: usize| -> Option<f64> {
        let ends: Vec<[f64; 2]> = axes
            .iter()
            .enumerate()
            .map(|(k, axis)| {
                let [from, to] = family.ends(*axis);
                let at = |share: f64| from + (to - from) * share / parts as f64;
                if k == 0 { [at(part as f64), at((part + 1) as f64)] } else { [from, to] }
            })
            .collect();
        let mut middle: Vec<f64> = (0..family.axes().len()).map(|axis| family.ends(axis)[0]).collect();
        axes.iter().zip(&ends).for_each(|(axis, [from, to])| middle[*axis] = 0.5 * (from + to));
        let system = loop_at(problem, gains, &middle)?;
        let along: Vec<AffineTerm> = axes
            .iter()
            .zip(&ends)
            .map(|(axis, [from, to])| {
                let at = |value: f64| {
                    let mut point = middle.clone();
                    point[*axis] = value;
                    Some(loop_at(problem, gains, &point)?.a().clone())
                };
                let width = C64::from(to - from);
                let a: DMatrix<C64> = (at(*to)? - at(*from)?) / width;
                Some(AffineTerm { a, reach: 0.5 * (to - from) })
            })
            .collect::<Option<_>>()?;
        let found = system.covered_peak(&along, known, TOLERANCE, BUDGET, &|| stop.is_set()).ok()??;
        Some(found.2)
    };
    let bounds: Option<Vec<f64>> = (0..parts).into_par_iter().map(covered).collect();
    bounds.map(|bounds| bounds.into_iter().fold(1.0, f64::max))
}

/// The loop at a point of the family.
fn loop_at(problem: &Problem, gains: &[f64], point: &[f64]) -> Option<DelaySystem> {
    let row = problem.structure.row(gains, point[0]);
    delay::late(&problem.family.open(point), &row, problem.delay(point)).ok()
}
