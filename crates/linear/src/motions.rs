//! The motions of many roots of one matrix: reduced to Hessenberg form once, each costs as many operations as the matrix has entries, not
//! a factorisation of its own (Wilkinson 1965, ch. 9).

use nalgebra::{DMatrix, DVector, Hessenberg};

use crate::{C64, DelaySystem};

/// Roots nearer to each other than this, beside the matrix, may be one.
const ALIKE: f64 = 1e-9;
/// In radians: its multiples are never near each other for long.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

impl DelaySystem {
    /// The state in the motion `exp(s t)` of each of some roots, in norm 1, as [`DelaySystem::sensitivity`] has it as `right`; nothing for
    /// one whose motion cannot be had, and no motions at all with a delay, which no one matrix has.
    #[must_use]
    pub fn motions(&self, roots: &[C64]) -> Option<Vec<Option<DVector<C64>>>> {
        if self.delay() > 0.0 {
            return None;
        }
        let whole = &self.balanced.a + &self.balanced.b * &self.balanced.c;
        let motions = motions_of(&whole, roots)?.into_iter();
        let unscaled =
            |motion: DVector<C64>| unit(DVector::from_fn(motion.len(), |i, _| motion[i] * self.balanced.scale(i)));
        Some(motions.map(|motion| unscaled(motion?)).collect())
    }
}

/// The null vector of `matrix - s` for each of some roots, in norm 1; nothing at all of a matrix of one row.
pub(crate) fn motions_of(matrix: &DMatrix<C64>, roots: &[C64]) -> Option<Vec<Option<DVector<C64>>>> {
    if matrix.nrows() < 2 {
        return None;
    }
    let size = matrix.norm();
    let (basis, reduced) = Hessenberg::new(matrix.clone()).unpack();
    // Row by row, as elimination goes.
    let rows = reduced.transpose();
    let motion = |(k, root): (usize, &C64)| {
        // A root that is there several times has as many motions, if it has: each is looked for from a start of its own.
        let again = roots[..k].iter().filter(|before| (*before - root).norm() <= ALIKE * size).count();
        Some(&basis * null_vector(&rows, *root, f64::EPSILON * (size + root.norm()), again)?)
    };
    Some(roots.iter().enumerate().map(motion).collect())
}

/// The null vector of `H - s` by inverse iteration; the columns of `rows` are the rows of `H`, which is 0 below its first subdiagonal.
/// Pivots less than `least` are raised to it: they are rounding. Each `start` leads to another vector where there are several.
fn null_vector(rows: &DMatrix<C64>, s: C64, least: f64, start: usize) -> Option<DVector<C64>> {
    let n = rows.nrows();
    let mut upper = rows.clone();
    (0..n).for_each(|i| upper[(i, i)] -= s);
    let mut steps = Vec::with_capacity(n);
    for k in 0..n {
        if k + 1 == n {
            if upper[(k, k)].norm() < least {
                upper[(k, k)] = C64::from(least);
            }
            break;
        }
        let is_swapped = upper[(k, k + 1)].norm_sqr() > upper[(k, k)].norm_sqr();
        if is_swapped {
            upper.swap_columns(k, k + 1);
        }
        if upper[(k, k)].norm() < least {
            upper[(k, k)] = C64::from(least);
        }
        let factor = upper[(k, k + 1)] / upper[(k, k)];
        let (above, mut below) = upper.columns_range_pair_mut(k, k + 1);
        for (b, a) in below.iter_mut().zip(above.iter()).skip(k) {
            *b -= factor * a;
        }
        steps.push((is_swapped, factor));
    }
    let back = |x: &mut DVector<C64>| {
        for i in (0..n).rev() {
            let row = upper.column(i);
            let known: C64 = (i + 1..n).map(|k| row[k] * x[k]).sum();
            x[i] = (x[i] - known) / row[i];
        }
    };
    // From a start that no symmetry makes orthogonal to a mode.
    let turn = |i: usize| C64::from_polar(1.0, GOLDEN_ANGLE * (start * (i + 1)) as f64);
    let mut x = DVector::from_fn(n, |i, _| C64::new(1.0 + 0.37 * i as f64, 0.61 - 0.23 * i as f64) * turn(i));
    back(&mut x);
    x = unit(x)?;
    for (k, (is_swapped, factor)) in steps.iter().enumerate() {
        if *is_swapped {
            x.swap_rows(k, k + 1);
        }
        let above = x[k];
        x[k + 1] -= factor * above;
    }
    back(&mut x);
    unit(x)
}

/// Norm 1; inverse iteration ends on numbers whose squares may overflow.
pub(crate) fn unit(vector: DVector<C64>) -> Option<DVector<C64>> {
    let largest = vector.iter().map(|z| z.re.abs().max(z.im.abs())).fold(0.0, f64::max);
    if !(largest.is_finite() && largest > 0.0) {
        return None;
    }
    let vector = vector / C64::from(largest);
    let norm = vector.norm();
    Some(vector / C64::from(norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigenvalues;

    #[test]
    fn every_motion_solves_its_equation() {
        let mut random = fastrand::Rng::with_seed(11);
        for n in [2, 3, 8, 40, 90] {
            // Rows of very unlike sizes, as those of displacements and of velocities.
            let size = |i: usize| if i.is_multiple_of(2) { 1.0 } else { 1e4 };
            let a =
                DMatrix::from_fn(n, n, |i, k| C64::new(random.f64() - 0.5, random.f64() - 0.5) * (size(i) / size(k)));
            let empty = (DMatrix::zeros(n, 0), DMatrix::zeros(0, n));
            let system = DelaySystem::new(a.clone(), empty.0, empty.1, 0.0).expect("fits");
            let roots = eigenvalues(a.clone()).expect("found");
            let motions = system.motions(&roots).expect("no delay");
            for (root, motion) in roots.iter().zip(motions) {
                let motion = motion.expect("found");
                assert!((motion.norm() - 1.0).abs() < 1e-12);
                let left = &a * &motion - &motion * *root;
                // Row by row beside its own terms.
                for (i, left) in left.iter().enumerate() {
                    let terms: f64 = (0..n).map(|k| a[(i, k)].norm() * motion[k].norm()).sum();
                    assert!(left.norm() < 1e-10 * (terms + root.norm()), "{n}: {left} beside {terms}");
                }
            }
        }
    }

    #[test]
    fn a_delay_has_no_such_motions() {
        let of = |number: f64| DMatrix::from_element(1, 1, C64::from(number));
        let system = DelaySystem::new(of(0.0), of(-1.0), of(1.0), 1.0).expect("fits");
        assert!(system.motions(&[C64::ZERO]).is_none());
    }
}
