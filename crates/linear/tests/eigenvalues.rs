//! The eigenvalue routine beside nalgebra's Schur decomposition, and on matrices that are known to be hard.

use linear::{C64, EigenvalueError, eigenvalues};
use nalgebra::{DMatrix, Schur};
use proptest::prelude::*;

const J: C64 = C64::new(0.0, 1.0);

/// Every value is an exact eigenvalue of a matrix nearby: `A - lambda I` is singular to `tolerance` times the size of `A`.
#[track_caller]
fn singular_at_each(a: &DMatrix<C64>, values: &[C64], tolerance: f64) {
    let size = a.nrows();
    assert_eq!(values.len(), size);
    let norm = a.norm().max(f64::MIN_POSITIVE);
    for &value in values {
        let scaled = (a - DMatrix::identity(size, size) * value) / C64::from(norm);
        // The last pivot of complete pivoting, near enough to the least singular value; nalgebra's iteration for those has
        // no bound, and finds none of some singular matrices.
        let least = scaled.full_piv_lu().u().diagonal().iter().map(|pivot| pivot.norm()).fold(f64::INFINITY, f64::min);
        assert!(least < tolerance, "{value} is off by {least:e} of {norm:e}");
    }
    let trace: C64 = values.iter().sum();
    assert!((trace - a.trace()).norm() < tolerance * size as f64 * norm, "{trace} is not {}", a.trace());
}

fn matrix(size: usize) -> impl Strategy<Value = DMatrix<C64>> {
    prop::collection::vec((-1.0..1.0, -1.0..1.0, -3i32..3), size * size).prop_map(move |entries| {
        DMatrix::from_iterator(size, size, entries.into_iter().map(|(re, im, p)| C64::new(re, im) * 10f64.powi(p)))
    })
}

proptest! {
    #[test]
    fn val_random_matrices_have_nalgebras_eigenvalues(a in (1usize..=12).prop_flat_map(matrix)) {
        let ours = eigenvalues(a.clone()).expect("converges");
        singular_at_each(&a, &ours, 1e-14);
        let schur = Schur::try_new(a.clone(), f64::EPSILON, 10_000).expect("converges");
        let mut theirs: Vec<C64> = schur.unpack().1.diagonal().iter().copied().collect();
        for value in ours {
            let (at, distance) = theirs.iter().enumerate().map(|(i, t)| (i, (t - value).norm()))
                .min_by(|a, b| a.1.total_cmp(&b.1)).expect("one each");
            // Where eigenvalues are sensitive, both are right about different neighbours of the matrix.
            prop_assert!(distance < 1e-6 * a.norm(), "{value} is not among {theirs:?}");
            theirs.swap_remove(at);
        }
    }

    /// Scaling rows against columns is a similarity, and balancing undoes it.
    #[test]
    fn powers_of_two_on_the_diagonal_change_nothing(a in matrix(6), powers in prop::array::uniform6(-40i32..40)) {
        let scaled = DMatrix::from_fn(6, 6, |i, j| a[(i, j)] * 2f64.powi(powers[i] - powers[j]));
        let straight = eigenvalues(a.clone()).expect("converges");
        for value in eigenvalues(scaled).expect("converges") {
            let distance = straight.iter().map(|s| (s - value).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance < 1e-6 * a.norm());
        }
    }
}

#[test]
fn val_hard_matrices_are_solved() {
    let zero = DMatrix::<C64>::zeros(5, 5);
    assert_eq!(eigenvalues(zero), Ok(vec![C64::ZERO; 5]));
    for size in [2, 3, 6, 12, 32, 70] {
        // A cycle: unshifted QR stands still on it. Eigenvalues are the roots of unity.
        let cycle = DMatrix::from_fn(size, size, |i, j| C64::from(f64::from(u8::from((i + 1) % size == j))));
        let values = eigenvalues(cycle.clone()).expect("converges");
        singular_at_each(&cycle, &values, 1e-13);
        assert!(values.iter().all(|v| (v.norm() - 1.0).abs() < 1e-13));
        // One Jordan block: a single defective eigenvalue.
        let jordan = DMatrix::from_fn(size, size, |i, j| match j.wrapping_sub(i) {
            0 => J * 2.0,
            1 => C64::ONE,
            _ => C64::ZERO,
        });
        singular_at_each(&jordan, &eigenvalues(jordan.clone()).expect("converges"), 1e-13);
        singular_at_each(&jordan.transpose(), &eigenvalues(jordan.transpose()).expect("converges"), 1e-13);
        // Grcar: eigenvalues as sensitive as they come.
        let grcar = DMatrix::from_fn(size, size, |i, j| {
            if i == j + 1 {
                -C64::ONE
            } else if (i..=i + 3).contains(&j) {
                C64::ONE
            } else {
                C64::ZERO
            }
        });
        singular_at_each(&grcar, &eigenvalues(grcar.clone()).expect("converges"), 1e-13);
        let ones = DMatrix::from_element(size, size, C64::ONE);
        singular_at_each(&ones, &eigenvalues(ones.clone()).expect("converges"), 1e-13);
    }
}

#[test]
fn size_does_not_overflow() {
    for scale in [1e-300, 1e-160, 1e160, 1e300] {
        let a = DMatrix::from_fn(4, 4, |i, j| C64::new((i + 2 * j) as f64, (3 * i) as f64 - j as f64));
        let plain = eigenvalues(a.clone()).expect("converges");
        for value in eigenvalues(a * C64::from(scale)).expect("converges") {
            let value = value / scale;
            let distance = plain.iter().map(|p| (p - value).norm()).fold(f64::INFINITY, f64::min);
            assert!(distance < 1e-7, "{value} is not among {plain:?}");
        }
    }
}

#[test]
fn what_is_not_finite_is_named_by_row_and_column() {
    let mut a = DMatrix::<C64>::identity(3, 3);
    a[(0, 2)] = C64::new(0.0, f64::NAN);
    assert_eq!(eigenvalues(a), Err(EigenvalueError::NotFinite { row: 1, column: 3 }));
    assert_eq!(eigenvalues(DMatrix::<C64>::zeros(0, 0)), Ok(vec![]));
}

/// Seven equal masses in three groups that no shaft joins, undamped: three eigenvalues coincide and none has a real part.
/// NumPy's largest is 6e-14. A row that was negligible beside a large diagonal, and no longer beside the small one that came
/// in its place, made it 1.4e-9.
#[test]
fn val_groups_that_nothing_joins_stay_apart() {
    let (mass, cross, bearing) = (7.865029960305856, 134.77187830904398, 0.04601738585044126);
    let shafts = [0.0027858006679425786, 0.0, 1.787589262548095, 0.0, 0.02418524070803068, 0.003194401486339644];
    let n = shafts.len() + 1;
    let mut a = DMatrix::<C64>::zeros(2 * n, 2 * n);
    for i in 0..n {
        a[(i, n + i)] = C64::ONE;
        a[(n + i, i)] = C64::from(-bearing / mass);
        a[(n + i, n + i)] = J * cross;
    }
    for (i, shaft) in shafts.iter().enumerate() {
        let by = shaft / mass;
        for (row, column, sign) in [(i, i, -1.0), (i + 1, i + 1, -1.0), (i, i + 1, 1.0), (i + 1, i, 1.0)] {
            a[(n + row, column)] += sign * by;
        }
    }
    for a in [a.transpose(), a] {
        let values = eigenvalues(a).expect("converges");
        assert!(values.iter().all(|value| value.re.abs() < 1e-12), "{values:?}");
    }
}

/// Few entries, all of them -1, 0 or 1: most of these have several eigenvalues at the origin, in chains, and two in a thousand
/// were refused as not convergent.
#[test]
fn none_is_refused_for_many_eigenvalues_at_the_origin() {
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..10_000 {
        let size = random.usize(2..32);
        let mut entry = || if random.u8(..4) == 0 { f64::from(random.i8(-1..=1)) } else { 0.0 };
        let a = DMatrix::from_fn(size, size, |_, _| C64::from(entry()));
        let values = eigenvalues(a.clone()).expect("converges");
        let trace: C64 = values.iter().sum();
        assert!((trace - a.trace()).norm() <= 1e-13 * a.norm(), "{trace} is not {}", a.trace());
    }
}
