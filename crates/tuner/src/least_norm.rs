//! The shortest vector of a convex hull plus a cone: how far a set of slopes is from holding each other.

use crate::quadratic_program::{cholesky, dot, substitute};

/// `min |sum m_k hull_k + sum n_i cone_i|` over `m >= 0` with sum 1 and `n >= 0`.
///
/// By homogeneity it has the weights, but for a factor, of the nonnegative least squares problem
/// `min |sum m_k hull_k + sum n_i cone_i|^2 + (sum m_k - 1)^2`, which an active set method solves in finitely many steps
/// (Lawson & Hanson 1974, ch. 23). `NaN` without a hull.
pub(crate) fn least_norm(hull: &[Vec<f64>], cone: &[Vec<f64>]) -> f64 {
    let Some(n) = hull.first().map(Vec::len) else { return f64::NAN };
    // The slopes' own scale, so that neither term drowns the other; a cone has no scale.
    let scale = hull.iter().map(|g| dot(g, g).sqrt()).fold(0.0, f64::max).max(1e-300);
    let column =
        |vector: &[f64], by: f64, one: f64| -> Vec<f64> { vector.iter().map(|v| v * by).chain([one]).collect() };
    let columns: Vec<Vec<f64>> = hull
        .iter()
        .map(|g| column(g, 1.0 / scale, 1.0))
        .chain(cone.iter().map(|c| column(c, 1.0 / dot(c, c).sqrt().max(1e-300), 0.0)))
        .collect();
    let mut weights = vec![0.0; columns.len()];
    let mut passive: Vec<usize> = Vec::new();
    let residual = |weights: &[f64]| -> Vec<f64> {
        let mut r = vec![0.0; n + 1];
        r[n] = 1.0;
        for (column, weight) in columns.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            r.iter_mut().zip(column).for_each(|(r, c)| *r -= weight * c);
        }
        r
    };
    for _ in 0..3 * columns.len() + 10 {
        let r = residual(&weights);
        let gain = |k: usize| dot(&columns[k], &r);
        let next = (0..columns.len()).filter(|k| !passive.contains(k)).max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        let Some(next) = next.filter(|&k| gain(k) > 1e-15) else { break };
        passive.push(next);
        loop {
            let wanted = solve(&columns, &passive, n);
            if wanted.iter().all(|w| *w > 0.0) {
                passive.iter().zip(&wanted).for_each(|(&k, w)| weights[k] = *w);
                break;
            }
            // As far towards it as no weight turns negative; what turns 0 leaves.
            let step = passive.iter().zip(&wanted).filter(|(_, w)| **w <= 0.0);
            let step = step.map(|(&k, w)| weights[k] / (weights[k] - w)).fold(1.0, f64::min);
            for (&k, w) in passive.iter().zip(&wanted) {
                weights[k] += step * (w - weights[k]);
            }
            let before = passive.len();
            passive.retain(|&k| {
                let stays = weights[k] > 1e-14;
                if !stays {
                    weights[k] = 0.0;
                }
                stays
            });
            if passive.is_empty() || passive.len() == before {
                break;
            }
        }
    }
    let total: f64 = weights[..hull.len()].iter().sum();
    let mut sum = vec![0.0; n];
    for (column, weight) in columns.iter().zip(&weights) {
        sum.iter_mut().zip(column).for_each(|(s, c)| *s += weight / total * c);
    }
    dot(&sum, &sum).sqrt() * scale
}

/// Least squares with the columns `passive`, by the normal equations and one correction.
fn solve(columns: &[Vec<f64>], passive: &[usize], n: usize) -> Vec<f64> {
    let m = passive.len();
    let mut normal = vec![0.0; m * m];
    for (i, &a) in passive.iter().enumerate() {
        for (j, &b) in passive.iter().enumerate() {
            normal[i * m + j] = dot(&columns[a], &columns[b]);
        }
    }
    cholesky(&mut normal, m);
    let mut x = vec![0.0; m];
    for _ in 0..3 {
        let mut r = vec![0.0; n + 1];
        r[n] = 1.0;
        for (&k, weight) in passive.iter().zip(&x) {
            r.iter_mut().zip(&columns[k]).for_each(|(r, c)| *r -= weight * c);
        }
        let mut right: Vec<f64> = passive.iter().map(|&k| dot(&columns[k], &r)).collect();
        substitute(&normal, &mut right, m);
        x.iter_mut().zip(&right).for_each(|(x, d)| *x += d);
    }
    x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn known_ones() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(least_norm(&[vec![3.0, 4.0]], &[]), 5.0);
        close(least_norm(&[vec![1.0, 1.0], vec![1.0, -1.0]], &[]), 1.0);
        close(least_norm(&[vec![1.0, 2.0], vec![-3.0, -6.0]], &[]), 0.0);
        // A bound that holds the first variable.
        close(least_norm(&[vec![1.0, 2.0]], &[vec![-1.0, 0.0]]), 2.0);
        assert!(least_norm(&[], &[]).is_nan());
    }

    proptest! {
        /// No convex combination tried at random is shorter, and no vertex either.
        #[test]
        fn nothing_is_shorter(
            hull in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 3), 1..6),
            weights in prop::collection::vec(0.01..1.0f64, 6),
        ) {
            let least = least_norm(&hull, &[]);
            let total: f64 = weights[..hull.len()].iter().sum();
            let mixed: Vec<f64> = (0..3).map(|i| hull.iter().zip(&weights).map(|(g, w)| g[i] * w / total).sum()).collect();
            prop_assert!(least <= dot(&mixed, &mixed).sqrt() + 1e-9);
            for vertex in &hull {
                prop_assert!(least <= dot(vertex, vertex).sqrt() + 1e-9);
            }
        }
    }
}
