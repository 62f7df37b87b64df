//! Which places are the coordinates.

use nalgebra::{DMatrix, RowDVector};

use crate::Drawing;
use crate::model::{FullModel, Place, SpringPart};

/// A place that can be a coordinate, and how much it is wanted: 0 the most.
pub(crate) struct Candidate {
    pub(crate) place: Place,
    rank: i32,
}

/// The places chosen.
pub(crate) struct Chosen {
    /// Indices among the candidates, from left to right.
    pub(crate) places: Vec<usize>,
    /// The inverse of their rows.
    pub(crate) inverse: DMatrix<f64>,
    /// The condition number of their rows.
    pub(crate) condition: f64,
}

/// The condition that wishes may cost: five digits of sixteen.
const CONDITION: f64 = 1e5;

/// Every node and pedestal, and two places inside every element, with its displacement in the shapes of `basis`.
pub(crate) fn candidates(
    full: &FullModel,
    drawing: &Drawing,
    basis: &DMatrix<f64>,
) -> Vec<(Candidate, RowDVector<f64>)> {
    let mut ranks = vec![6; full.nodes.len()];
    let mut want = |node: usize, rank: i32| ranks[node] = ranks[node].min(rank);
    full.station_nodes.iter().for_each(|&node| want(node, 5));
    drawing.discs.iter().for_each(|disc| want(full.station_nodes[disc.station], 4));
    for spring in &full.springs {
        let rank = match spring.part {
            _ if spring.clearance > 0.0 => 1,
            SpringPart::Magnetic(_) | SpringPart::Touchdown(_) => 2,
            SpringPart::Bearing(_) | SpringPart::Seal(_) => 3,
        };
        want(spring.node, rank);
    }
    let sensors = drawing.sensors.iter().map(|sensor| sensor.station);
    let sensors = sensors.chain(drawing.magnetics.iter().map(|magnetic| magnetic.sensor));
    sensors.for_each(|station| want(full.station_nodes[station], 0));

    let nodes = full.nodes.iter().zip(ranks).enumerate().map(|(node, (place, rank))| {
        (Candidate { place: place.clone(), rank }, basis.row(full.displacements[node]).into_owned())
    });
    let inside = full.inside.iter().map(|inside| {
        let row = inside.row * basis.fixed_rows::<4>(2 * inside.node);
        let row = RowDVector::from_iterator(basis.ncols(), row.iter().copied());
        (Candidate { place: Place::inner(inside.position), rank: 7 }, row)
    });
    // Nothing else tells how a pedestal moves.
    let pedestals = full.pedestals.iter().enumerate().map(|(i, place)| {
        (Candidate { place: place.clone(), rank: 0 }, basis.row(full.first_pedestal() + i).into_owned())
    });
    nodes.chain(inside).chain(pedestals).collect()
}

/// `count` places whose rows are far from dependent: one after the other the row of which the others leave most (QR with pivoting),
/// where a place that is wanted more counts for more, as far as the condition allows.
pub(crate) fn choose(candidates: &[Candidate], rows: &[RowDVector<f64>], count: usize) -> Option<Chosen> {
    let with = |weight: f64| {
        let mut places = pivots(candidates, rows, count, weight)?;
        places.sort_by(|&a, &b| candidates[a].place.position.total_cmp(&candidates[b].place.position));
        let square = DMatrix::from_rows(&places.iter().map(|&at| rows[at].clone()).collect::<Vec<_>>());
        let stretch = square.singular_values();
        let condition = stretch.max() / stretch.min();
        let inverse = square.try_inverse()?;
        condition.is_finite().then_some(Chosen { places, inverse, condition })
    };
    let tries = [1000.0, 100.0, 30.0, 10.0, 3.0, 1.5, 1.0].into_iter().filter_map(with);
    let mut best: Option<Chosen> = None;
    for chosen in tries {
        if chosen.condition < CONDITION {
            return Some(chosen);
        }
        if best.as_ref().is_none_or(|best| chosen.condition < best.condition) {
            best = Some(chosen);
        }
    }
    best
}

fn pivots(candidates: &[Candidate], rows: &[RowDVector<f64>], count: usize, weight: f64) -> Option<Vec<usize>> {
    let mut left: Vec<RowDVector<f64>> = rows.to_vec();
    let mut chosen = Vec::with_capacity(count);
    for _ in 0..count {
        let worth = |at: usize| left[at].norm() * weight.powi(-candidates[at].rank);
        let free = (0..left.len()).filter(|at| !chosen.contains(at));
        let next = free.max_by(|&a, &b| worth(a).total_cmp(&worth(b)))?;
        let length = left[next].norm();
        if length <= 0.0 {
            return None;
        }
        let direction = &left[next] / length;
        for row in &mut left {
            let part = row.dot(&direction);
            *row -= &direction * part;
        }
        chosen.push(next);
    }
    Some(chosen)
}
