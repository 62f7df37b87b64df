//! A ratio of polynomials by its roots.

use nalgebra::{DMatrix, Schur};

use crate::{C64, Filter};

/// Steps that sharpen a root, which an eigenvalue of a matrix of coefficients over many decades may not be to its last digits.
const SHARPENED: usize = 3;

/// `gain s^lift prod (1 - s / zero) / prod (1 - s / pole)`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rational {
    zeros: Factors,
    poles: Factors,
}

/// `lowest s^at_origin prod (1 - s / root)`.
#[derive(Clone, Debug, PartialEq)]
struct Factors {
    lowest: f64,
    at_origin: usize,
    /// By rising size; of a conjugate pair the one above the real axis.
    roots: Vec<C64>,
    /// The first coefficient, of the highest power.
    first: f64,
}

impl Rational {
    pub(super) fn of(numerator: &[f64], denominator: &[f64]) -> Self {
        Self { zeros: Factors::of(numerator), poles: Factors::of(denominator) }
    }

    pub(super) fn names(&self) -> Vec<String> {
        let named = |of: &Factors, name: &str| (1..=of.roots.len()).map(|k| format!("{name}.{k}")).collect::<Vec<_>>();
        [named(&self.zeros, "zero"), named(&self.poles, "pole")].concat()
    }

    pub(super) fn values(&self) -> Vec<f64> {
        self.zeros.roots.iter().chain(&self.poles.roots).map(|root| root.norm()).collect()
    }

    /// Zeros and poles of these sizes.
    fn sized(&self, values: &[f64]) -> [Vec<C64>; 2] {
        let (zeros, poles) = values.split_at(self.zeros.roots.len());
        [(&self.zeros, zeros), (&self.poles, poles)]
            .map(|(of, sizes)| of.roots.iter().zip(sizes).map(|(root, size)| root * (size / root.norm())).collect())
    }

    pub(super) fn filter(&self, values: &[f64]) -> Filter {
        let [zeros, poles] = self.sized(values);
        let (mut numerator, mut denominator) = (self.zeros.polynomial(&zeros), self.poles.polynomial(&poles));
        // The denominator begins as it did.
        let scale = self.poles.first / denominator[0];
        numerator.iter_mut().chain(&mut denominator).for_each(|c| *c *= scale);
        Filter::Transfer { numerator, denominator }
    }

    pub(super) fn at(&self, values: &[f64], s: C64) -> C64 {
        let [zeros, poles] = self.sized(values);
        self.zeros.at(&zeros, s) / self.poles.at(&poles, s)
    }

    /// What [`Rational::at`] changes by with the logarithm of each value.
    pub(super) fn slopes(&self, values: &[f64], s: C64) -> Vec<C64> {
        let [zeros, poles] = self.sized(values);
        let (above, below) = (self.zeros.at(&zeros, s), self.poles.at(&poles, s));
        let of_zero = |k| self.zeros.slope(&zeros, k, s) / below;
        let of_pole = |k| -above / below * (self.poles.slope(&poles, k, s) / below);
        (0..zeros.len()).map(of_zero).chain((0..poles.len()).map(of_pole)).collect()
    }
}

impl Factors {
    /// Of a polynomial in falling powers.
    fn of(falling: &[f64]) -> Self {
        let leading = falling.iter().position(|c| *c != 0.0).unwrap_or(falling.len());
        let trimmed = &falling[leading..];
        let at_origin = trimmed.iter().rev().position(|c| *c != 0.0).unwrap_or(0);
        let trimmed = &trimmed[..trimmed.len() - at_origin];
        let (lowest, first) = (trimmed.last().copied().unwrap_or(0.0), trimmed.first().copied().unwrap_or(0.0));
        match roots(trimmed) {
            Some(mut roots) => {
                roots.retain(|root| root.im >= 0.0);
                roots.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
                Self { lowest, at_origin, roots, first }
            }
            // What has no roots that can be had has no corners, and is what it is.
            None => Self { lowest, at_origin, roots: Vec::new(), first },
        }
    }

    fn factor(root: C64, s: C64) -> C64 {
        let one = |root: C64| C64::ONE - s / root;
        if root.im > 0.0 { one(root) * one(root.conj()) } else { one(root) }
    }

    fn at(&self, roots: &[C64], s: C64) -> C64 {
        let product: C64 = roots.iter().map(|root| Self::factor(*root, s)).product();
        product * s.powu(self.at_origin as u32) * self.lowest
    }

    /// What that changes by with the logarithm of the size of root `k`.
    fn slope(&self, roots: &[C64], k: usize, s: C64) -> C64 {
        let one = |root: C64| s / root;
        let root = roots[k];
        let own = if root.im > 0.0 {
            let (a, b) = (one(root), one(root.conj()));
            a * (C64::ONE - b) + b * (C64::ONE - a)
        } else {
            one(root)
        };
        let others: C64 = (0..roots.len()).filter(|i| *i != k).map(|i| Self::factor(roots[i], s)).product();
        own * others * s.powu(self.at_origin as u32) * self.lowest
    }

    /// In falling powers.
    fn polynomial(&self, roots: &[C64]) -> Vec<f64> {
        let mut rising = vec![self.lowest];
        for root in roots {
            // 1 - s / r, or 1 - 2 Re(r) s / |r|^2 + s^2 / |r|^2.
            let factor = if root.im > 0.0 {
                vec![1.0, -2.0 * root.re / root.norm_sqr(), root.norm_sqr().recip()]
            } else {
                vec![1.0, -root.re.recip()]
            };
            let mut product = vec![0.0; rising.len() + factor.len() - 1];
            for (i, a) in rising.iter().enumerate() {
                factor.iter().enumerate().for_each(|(j, b)| product[i + j] += a * b);
            }
            rising = product;
        }
        let mut falling: Vec<f64> = rising.into_iter().rev().collect();
        falling.extend(vec![0.0; self.at_origin]);
        falling
    }
}

/// The roots of a polynomial in falling powers whose first and last coefficients are not 0; `None` if they cannot be had.
fn roots(falling: &[f64]) -> Option<Vec<C64>> {
    let order = falling.len().saturating_sub(1);
    if order == 0 {
        return Some(Vec::new());
    }
    // In units of the geometric mean of the roots, so that coefficients over many decades are of ordinary size.
    let unit = (falling[order] / falling[0]).abs().powf((order as f64).recip());
    let monic: Vec<f64> = (1..=order).map(|k| falling[k] / falling[0] / unit.powi(k as i32)).collect();
    if !monic.iter().all(|c| c.is_finite()) || unit <= 0.0 {
        return None;
    }
    let companion = DMatrix::from_fn(order, order, |i, j| match i {
        0 => -monic[j],
        _ => f64::from(u8::from(i == j + 1)),
    });
    let found = Schur::try_new(companion, f64::EPSILON, 1000)?.complex_eigenvalues();
    let value = |s: C64| monic.iter().fold((C64::ONE, C64::ZERO), |(p, d), c| (p * s + *c, d * s + p));
    let sharpen = |mut root: C64| {
        for _ in 0..SHARPENED {
            let (p, d) = value(root);
            let step = p / d;
            // Where roots coincide there is nothing to sharpen.
            if step.is_finite() && step.norm() < 1e-6 * root.norm() {
                root -= step;
            }
        }
        root * unit
    };
    // A root on the real axis stays on it.
    Some(found.iter().map(|z| sharpen(C64::new(z.re, z.im))).collect())
}
