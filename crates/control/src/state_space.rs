//! A controller as matrices, `x' = A x + B y`, `u = C x + D y`, as a filter: the transfer function that it is.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::{C64, Filter, FilterError};

/// How near the filter is to its matrices, relative to their answer.
const ALIKE: f64 = 1e-6;
/// Over how many decades of frequency below the size of `A`.
const DECADES: i32 = 6;
/// A coefficient is rounding below so much a state, in units of the powers of the size of `A`.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Filter {
    /// The filter `C (s - A)^-1 B + D`, by the method of Faddeev and LeVerrier: with `M_0 = 1`, `c_k = -tr(A M_(k-1)) / k` and
    /// `M_k = A M_(k-1) + c_k` the denominator is `s^n + c_1 s^(n-1) + ...` and the numerator `sum C M_(k-1) B s^(n-k)`, beside `D` times
    /// the denominator. Orders are small here; time is measured in the size of `A`, so that powers of it are of one size.
    ///
    /// Where the slowest poles are so slow beside `A` that its powers lose them, the filter that comes out does not answer as the matrices
    /// do: that is looked at, and refused.
    ///
    /// # Errors
    /// An order that no filter has, matrices that do not fit or are not finite, or whose poles lie too far apart.
    pub fn of_state_space(
        a: &DMatrix<f64>,
        b: &DVector<f64>,
        c: &RowDVector<f64>,
        d: f64,
    ) -> Result<Self, FilterError> {
        let n = a.nrows();
        if n == 0 || !a.is_square() || b.len() != n || c.len() != n {
            return Err(FilterError::Matrices { rows: n, columns: a.ncols(), inputs: b.len(), outputs: c.len() });
        }
        let size = a.norm();
        let pace = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let scaled = a / pace;
        let mut adjugate = DMatrix::<f64>::identity(n, n);
        let (mut denominator, mut numerator) = (vec![1.0], vec![d]);
        for k in 1..=n {
            // In units of the pace: `B` and `C` together give one power of it.
            let through = (c * &adjugate * b)[0] / pace;
            adjugate = &scaled * adjugate;
            // An integrator beside other poles is one: what the rounding of these sums leaves of its 0 is not its pole.
            let sum = -adjugate.trace() / k as f64;
            let coefficient = if sum.abs() <= ROUNDING * n as f64 { 0.0 } else { sum };
            (0..n).for_each(|i| adjugate[(i, i)] += coefficient);
            denominator.push(coefficient * pace.powi(k as i32));
            numerator.push((through + d * coefficient) * pace.powi(k as i32));
        }
        let made = Self::Transfer { numerator, denominator };
        made.check()?;
        // From the size of `A` down to what is a million times slower.
        let answers = |k: i32| {
            let s = C64::new(0.0, pace * 10f64.powi(-k));
            let mut m = -a.map(C64::from);
            (0..n).for_each(|i| m[(i, i)] += s);
            // On a pole there is no answer to compare.
            let Some(x) = m.lu().solve(&b.map(C64::from)) else { return true };
            let expected = (c.map(C64::from) * x)[0] + d;
            !expected.norm().is_finite() || (made.at(s, 0.0) - expected).norm() <= ALIKE * expected.norm()
        };
        if (0..=DECADES).all(answers) { Ok(made) } else { Err(FilterError::FarApart) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_a_state_space_answers_as_its_matrices_do() {
        let mut random = fastrand::Rng::with_seed(7);
        for n in 1..=8 {
            for pace in [1.0, 3.0e4] {
                let mut number = || random.f64() - 0.5;
                let a = DMatrix::from_fn(n, n, |_, _| pace * number());
                let (b, c) = (DVector::from_fn(n, |_, _| pace * number()), RowDVector::from_fn(n, |_, _| number()));
                let filter = Filter::of_state_space(&a, &b, &c, 0.3).expect("allowed");
                for w in [0.1, 0.9, 4.0] {
                    let s = C64::new(0.0, w * pace);
                    let mut m = -a.map(C64::from);
                    (0..n).for_each(|i| m[(i, i)] += s);
                    let x = m.lu().solve(&b.map(C64::from)).expect("no pole there");
                    let expected = (c.map(C64::from) * x)[0] + 0.3;
                    let found = filter.at(s, 0.0);
                    assert!(
                        (found - expected).norm() < 1e-9 * (1.0 + expected.norm()),
                        "{n} at {w}: {found} {expected}"
                    );
                }
            }
        }
    }

    /// Poles over `decades`, in a basis that mixes them.
    fn graded(decades: f64, n: usize) -> Result<Filter, FilterError> {
        let mixed = DMatrix::from_fn(n, n, |i, k| if i == k { 1.0 } else { 0.3 / (1.0 + i as f64 + 2.0 * k as f64) });
        let poles = DVector::from_fn(n, |i, _| -1e4 * 10f64.powf(-decades * i as f64 / (n - 1) as f64));
        let a = &mixed * DMatrix::from_diagonal(&poles) * mixed.clone().try_inverse().expect("regular");
        Filter::of_state_space(&a, &DVector::from_element(n, 1e4), &RowDVector::from_element(n, 1.0), 0.0)
    }

    #[test]
    fn poles_too_far_apart_are_refused_and_an_integrator_stays_one() {
        assert!(graded(1.0, 6).is_ok());
        assert_eq!(graded(6.0, 7), Err(FilterError::FarApart));
        let mut a = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, -300.0, -500.0]));
        (a[(0, 1)], a[(1, 2)]) = (40.0, 70.0);
        let found = Filter::of_state_space(&a, &DVector::from_element(3, 1.0), &RowDVector::from_element(3, 1.0), 0.0);
        let Ok(Filter::Transfer { denominator, .. }) = found else { panic!("{found:?}") };
        assert_eq!(denominator[3].to_bits(), 0, "a pole at 0");
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let of = |a: DMatrix<f64>, b, c| Filter::of_state_space(&a, &DVector::zeros(b), &RowDVector::zeros(c), 0.0);
        assert!(matches!(of(DMatrix::zeros(2, 2), 1, 2), Err(FilterError::Matrices { .. })));
        assert!(matches!(of(DMatrix::zeros(2, 3), 2, 2), Err(FilterError::Matrices { .. })));
        assert!(matches!(of(DMatrix::zeros(0, 0), 0, 0), Err(FilterError::Matrices { .. })));
        assert!(matches!(of(DMatrix::identity(9, 9), 9, 9), Err(FilterError::Order { found: 9, .. })));
        assert!(matches!(of(DMatrix::from_element(1, 1, f64::NAN), 1, 1), Err(FilterError::Improper)));
    }
}
