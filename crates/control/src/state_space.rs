//! A controller as matrices, `x' = A x + B y`, `u = C x + D y`, as a filter: the transfer function that it is.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::{Filter, FilterError};

impl Filter {
    /// The filter `C (s - A)^-1 B + D`, by the method of Faddeev and LeVerrier: with `M_0 = 1`, `c_k = -tr(A M_(k-1)) / k` and
    /// `M_k = A M_(k-1) + c_k` the denominator is `s^n + c_1 s^(n-1) + ...` and the numerator `sum C M_(k-1) B s^(n-k)`, beside `D` times
    /// the denominator. Orders are small here; time is measured in the size of `A`, so that powers of it are of one size.
    ///
    /// # Errors
    /// An order that no filter has, matrices that do not fit or are not finite.
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
            let coefficient = -adjugate.trace() / k as f64;
            (0..n).for_each(|i| adjugate[(i, i)] += coefficient);
            denominator.push(coefficient * pace.powi(k as i32));
            numerator.push((through + d * coefficient) * pace.powi(k as i32));
        }
        let made = Self::Transfer { numerator, denominator };
        made.check()?;
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::C64;

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
