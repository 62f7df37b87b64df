//! Which conditions a search must look at: a coarse grid to start with, and then whichever turn out to be the worst.

use rayon::prelude::*;

use crate::limits::{force_at, in_hand_at, margins_at};
use crate::stop::Stop;
use crate::worst::worst_at;
use crate::{Family, LoopMargins, Problem};

/// Points along each coordinate of a grid of about `total` points, more along the speed than along the others.
pub(crate) fn counts(family: &Family, total: usize) -> Vec<usize> {
    let varying = family.varying().count();
    let mut counts = vec![1; family.axes().len()];
    let has_speed = family.varying().next() == Some(0);
    // With s points of speed and s / 2 of the rest: s^d / 2^(d - 1) = total.
    let others = varying - usize::from(has_speed);
    let side = if varying == 0 { 1.0 } else { (total as f64 * 2.0_f64.powi(others as i32)).powf(1.0 / varying as f64) };
    for axis in family.varying() {
        let wanted = if axis == 0 { side } else { 0.5 * side };
        counts[axis] = (wanted.round() as usize).max(2);
    }
    counts
}

/// Places where the worst mode is worst for `gains`, worst first, with what it is worth; at most `most`.
pub(crate) fn worst_places(
    problem: &Problem,
    gains: &[f64],
    counts: &[usize],
    most: usize,
    stop: &Stop,
) -> Vec<(f64, Vec<f64>)> {
    lowest_places(&problem.family, counts, most, stop, &|point| worst_at(problem, gains, point).value)
}

/// Places where the steady control force is largest, largest first; at most `most`.
pub(crate) fn hardest_places(
    problem: &Problem,
    gains: &[f64],
    counts: &[usize],
    most: usize,
    stop: &Stop,
) -> Vec<(f64, Vec<f64>)> {
    let places = lowest_places(&problem.family, counts, most, stop, &|point| -force_at(problem, gains, point));
    places.into_iter().map(|(value, point)| (-value, point)).collect()
}

/// Places where margins have least in hand of what is asked for, least first; at most `most`.
pub(crate) fn tightest_places(
    problem: &Problem,
    gains: &[f64],
    counts: &[usize],
    most: usize,
    stop: &Stop,
) -> Vec<(f64, Vec<f64>)> {
    lowest_places(&problem.family, counts, most, stop, &|point| in_hand_at(problem, gains, point))
}

/// The places where the peak of the sensitivity is largest and the delay margin smallest, each with the margins there; nothing
/// where nothing could be looked at.
pub(crate) fn worst_margins(
    problem: &Problem,
    gains: &[f64],
    counts: &[usize],
    stop: &Stop,
) -> Option<[(LoopMargins, Vec<f64>); 2]> {
    let peak = |margins: &LoopMargins| -margins.sensitivity.0;
    let delay = |margins: &LoopMargins| margins.delay.map_or(f64::INFINITY, |(delay, _)| delay);
    let worst = |of: &(dyn Fn(&LoopMargins) -> f64 + Sync)| {
        let value = |point: &[f64]| margins_at(problem, gains, point).map_or(f64::INFINITY, |margins| of(&margins));
        let (_, point) = lowest_places(&problem.family, counts, 1, stop, &value).into_iter().next()?;
        Some((margins_at(problem, gains, &point)?, point))
    };
    let sensitivity = worst(&peak)?;
    // Without a delay that matters anywhere, the place of the peak says so.
    let delay = worst(&delay).unwrap_or_else(|| sensitivity.clone());
    Some([sensitivity, delay])
}

/// Local minima of `value` on a grid with `counts`, refined, lowest first; where the grid is too large to walk, the lowest of
/// a sample of its corners. Once stopped, those of the part that was looked at, which may be none.
fn lowest_places(
    family: &Family,
    counts: &[usize],
    most: usize,
    stop: &Stop,
    value: &(dyn Fn(&[f64]) -> f64 + Sync),
) -> Vec<(f64, Vec<f64>)> {
    let points = family.grid(counts);
    // What was not looked at is no minimum.
    let look = |point: &Vec<f64>| if stop.is_set() { f64::INFINITY } else { value(point) };
    let values: Vec<f64> = points.par_iter().map(look).collect();
    let sides: Vec<usize> = (0..counts.len())
        .map(|axis| if family.ends(axis)[0] < family.ends(axis)[1] { counts[axis].max(2) } else { 1 })
        .collect();
    // The last coordinate runs fastest.
    let strides: Vec<usize> = (0..sides.len()).map(|axis| sides[axis + 1..].iter().product()).collect();
    let whole = Family::is_grid(counts);
    let mut places: Vec<usize> = (0..points.len())
        .filter(|&at| values[at] < f64::INFINITY)
        .filter(|&at| {
            !whole
                || sides.iter().zip(&strides).all(|(&side, &stride)| {
                    let place = at / stride % side;
                    (place == 0 || values[at] <= values[at - stride])
                        && (place + 1 == side || values[at] < values[at + stride])
                })
        })
        .collect();
    places.sort_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
    places.truncate(most);
    if stop.is_glance() {
        return places.into_iter().map(|at| (values[at], points[at].clone())).collect();
    }
    let steps: Vec<f64> = sides
        .iter()
        .enumerate()
        .map(|(axis, &side)| (family.ends(axis)[1] - family.ends(axis)[0]) / side.max(2).saturating_sub(1) as f64)
        .collect();
    let mut made: Vec<(f64, Vec<f64>)> =
        places.into_iter().map(|at| refine(family, value, values[at], points[at].clone(), &steps, stop)).collect();
    made.sort_by(|a, b| a.0.total_cmp(&b.0));
    made
}

/// Walks downhill along the coordinates with ever shorter steps, inside the family.
fn refine(
    family: &Family,
    of: &dyn Fn(&[f64]) -> f64,
    mut value: f64,
    mut point: Vec<f64>,
    steps: &[f64],
    stop: &Stop,
) -> (f64, Vec<f64>) {
    let axes: Vec<usize> = family.varying().collect();
    let mut scale = 0.5;
    while scale > 1e-4 {
        let mut moved = false;
        for &axis in &axes {
            if stop.is_set() {
                return (value, point);
            }
            let [from, to] = family.ends(axis);
            for step in [scale * steps[axis], -scale * steps[axis]] {
                let old = point[axis];
                point[axis] = (old + step).clamp(from, to);
                let there = if point[axis] == old { value } else { of(&point) };
                if there < value {
                    (value, moved) = (there, true);
                    break;
                }
                point[axis] = old;
            }
        }
        if !moved {
            scale *= 0.4;
        }
    }
    (value, point)
}
