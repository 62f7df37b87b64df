//! Curves on which a function of two numbers has a level: traced through a grid, each crossing of an edge found on the function itself.

use std::collections::HashMap;

use rayon::prelude::*;

/// An edge of the grid: from a corner to its neighbour along x or along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Edge {
    corner: [usize; 2],
    along_y: bool,
}

/// The curves on which a function is `level`, as points `[x, y]` in order; a curve that is closed ends where it begins. `values` are the
/// function at every `xs` (rows) and `ys`; an edge whose ends lie on either side of the level is cut by `between`, which gets both with what
/// is above the level, second. Cells with a value that is not finite are left out.
pub fn trace(
    [xs, ys]: [&[f64]; 2],
    values: &[Vec<f64>],
    level: f64,
    between: &(dyn Fn([f64; 2], [f64; 2]) -> [f64; 2] + Sync),
) -> Vec<Vec<[f64; 2]>> {
    let above = |[i, k]: [usize; 2]| values[i][k] > level;
    let mut pieces: Vec<[Edge; 2]> = Vec::new();
    for i in 0..xs.len().saturating_sub(1) {
        for k in 0..ys.len().saturating_sub(1) {
            let corners = [[i, k], [i + 1, k], [i + 1, k + 1], [i, k + 1]];
            if corners.iter().all(|[i, k]| values[*i][*k].is_finite()) {
                pieces.extend(through(corners, above, || {
                    corners.iter().map(|[i, k]| values[*i][*k]).sum::<f64>() / 4.0 > level
                }));
            }
        }
    }
    let mut edges: Vec<Edge> = pieces.iter().flatten().copied().collect();
    edges.sort_by_key(|edge| (edge.corner, edge.along_y));
    edges.dedup();
    let cut = |edge: &Edge| {
        let [i, k] = edge.corner;
        let other = if edge.along_y { [i, k + 1] } else { [i + 1, k] };
        let at = |[i, k]: [usize; 2]| [xs[i], ys[k]];
        let (low, high) = if above(edge.corner) { (other, edge.corner) } else { (edge.corner, other) };
        (*edge, between(at(low), at(high)))
    };
    let points: HashMap<Edge, [f64; 2]> = edges.par_iter().map(cut).collect();
    chain(&pieces).into_iter().map(|curve| curve.iter().map(|edge| points[edge]).collect()).collect()
}

/// Where a level crosses a cell: pairs of its edges. Corners run around it.
fn through(corners: [[usize; 2]; 4], above: impl Fn([usize; 2]) -> bool, middle: impl Fn() -> bool) -> Vec<[Edge; 2]> {
    let edge = |side: usize| {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        Edge { corner: [a[0].min(b[0]), a[1].min(b[1])], along_y: a[0] == b[0] }
    };
    let crossed: Vec<usize> = (0..4).filter(|side| above(corners[*side]) != above(corners[(side + 1) % 4])).collect();
    match crossed[..] {
        [a, b] => vec![[edge(a), edge(b)]],
        // A saddle: what is in its middle says which corners hang together.
        [a, b, c, d] if above(corners[0]) == middle() => vec![[edge(a), edge(b)], [edge(c), edge(d)]],
        [a, b, c, d] => vec![[edge(d), edge(a)], [edge(b), edge(c)]],
        _ => vec![],
    }
}

/// Pieces put together to curves.
fn chain(pieces: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut at: HashMap<Edge, Vec<usize>> = HashMap::new();
    for (piece, edges) in pieces.iter().enumerate() {
        edges.iter().for_each(|edge| at.entry(*edge).or_default().push(piece));
    }
    let mut used = vec![false; pieces.len()];
    // Curves with ends first, from an end; what is left is closed.
    let is_end = |edge: &Edge| at[edge].len() == 1;
    let mut starts: Vec<usize> = (0..pieces.len()).filter(|piece| pieces[*piece].iter().any(is_end)).collect();
    starts.extend(0..pieces.len());
    let mut curves = Vec::new();
    for start in starts {
        if used[start] {
            continue;
        }
        let [a, b] = pieces[start];
        let (first, mut here) = if is_end(&b) { (b, a) } else { (a, b) };
        used[start] = true;
        let mut curve = vec![first, here];
        while let Some(&next) = at[&here].iter().find(|piece| !used[**piece]) {
            used[next] = true;
            let [a, b] = pieces[next];
            here = if a == here { b } else { a };
            curve.push(here);
        }
        curves.push(curve);
    }
    curves
}

/// Where a function crosses a level between `low`, where it is not above, and `high`, where it is: by halving, so often.
pub fn halve(mut low: [f64; 2], mut high: [f64; 2], times: usize, is_above: impl Fn([f64; 2]) -> bool) -> [f64; 2] {
    for _ in 0..times {
        let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        if is_above(middle) { high = middle } else { low = middle }
    }
    [0, 1].map(|k| 0.5 * (low[k] + high[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(count: usize) -> Vec<f64> {
        (0..count).map(|k| -2.0 + 4.0 * k as f64 / (count - 1) as f64).collect()
    }

    #[test]
    fn a_circle_is_one_closed_curve_whose_points_are_on_it() {
        let (xs, ys) = (grid(31), grid(24));
        let of = |[x, y]: [f64; 2]| x * x + y * y;
        let values: Vec<Vec<f64>> = xs.iter().map(|x| ys.iter().map(|y| of([*x, *y])).collect()).collect();
        let curves = trace([&xs, &ys], &values, 1.7, &|a, b| halve(a, b, 50, |p| of(p) > 1.7));
        assert_eq!(curves.len(), 1);
        let curve = &curves[0];
        assert!(curve.len() > 40 && curve.first() == curve.last());
        assert!(curve.iter().all(|p| (of(*p) - 1.7).abs() < 1e-13));
        // Neighbours are at most a cell apart.
        assert!(curve.windows(2).all(|w| (w[0][0] - w[1][0]).hypot(w[0][1] - w[1][1]) < 0.25));
    }

    #[test]
    fn saddles_and_ends_are_told_apart() {
        let (xs, ys) = (grid(12), grid(13));
        let of = |[x, y]: [f64; 2]| x * y;
        let mut values: Vec<Vec<f64>> = xs.iter().map(|x| ys.iter().map(|y| of([*x, *y])).collect()).collect();
        let curves = |values: &[Vec<f64>]| trace([&xs, &ys], values, 0.1, &|a, b| halve(a, b, 40, |p| of(p) > 0.1));
        let found = curves(&values);
        assert_eq!(found.len(), 2, "two branches of a hyperbola");
        assert!(found.iter().all(|curve| curve.first() != curve.last()));
        // A hole ends a curve at its rim.
        values[9][9] = f64::NAN;
        assert!(curves(&values).iter().flatten().all(|p| (of(*p) - 0.1).abs() < 1e-11));
        assert!(curves(&vec![vec![0.0; 13]; 12]).is_empty());
    }
}
