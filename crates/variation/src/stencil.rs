//! Slopes of functions that are smooth and cheap, by differences of fourth order.
//!
//! Only matrices and gains at fixed frequencies go through these: polynomials of low degree, or nearly. The step is a few ten
//! thousandths, so that what is cut off is no more than rounding, some 1e-12 of the value.

/// A step, relative to the value; of 0, absolute.
pub(crate) const STEP: f64 = 3e-4;
/// The same of numbers of a drawing, whose matrices have rounding of their own: a reduced rotor's may know no more than five digits of a
/// slow gain.
pub(crate) const STEP_OF_DRAWINGS: f64 = 1e-2;

/// Weights of values at places, whose sum is the slope.
pub(crate) const CENTRAL: [(f64, f64); 4] = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];
pub(crate) const ONE_SIDED: [(f64, f64); 5] = [(0.0, -25.0), (1.0, 48.0), (2.0, -36.0), (3.0, 16.0), (4.0, -3.0)];

/// A machine with the weight of what it has in a slope.
pub(crate) type Weighted<T> = Vec<(f64, T)>;

/// What `make` makes of values about `value`, each with its weight: on both sides if it can be made there, else on one.
pub(crate) fn about<T, E>(value: f64, step: f64, make: impl Fn(f64) -> Result<T, E>) -> Result<Weighted<T>, E> {
    let h = if value == 0.0 { step } else { step * value.abs() };
    let all = |nodes: &[(f64, f64)], h: f64| -> Result<Weighted<T>, E> {
        nodes.iter().map(|(at, weight)| Ok((weight / (12.0 * h), make(value + at * h)?))).collect()
    };
    all(&CENTRAL, h).or_else(|_| all(&ONE_SIDED, h)).or_else(|_| all(&ONE_SIDED, -h))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_functions_on_either_side_of_an_edge() {
        let slope = |value: f64, lowest: f64, highest: f64| {
            let nodes =
                about(value, STEP, |x| if (lowest..=highest).contains(&x) { Ok(1.0 / (1.0 + x)) } else { Err(()) });
            nodes.map(|nodes| nodes.iter().map(|(weight, y)| weight * y).sum::<f64>())
        };
        for (value, lowest, highest) in [(2.0, 0.0, 9.0), (2.0, 2.0, 9.0), (2.0, 0.0, 2.0), (0.0, 0.0, 9.0)] {
            let exact = -1.0 / (1.0 + value) / (1.0 + value);
            let found = slope(value, lowest, highest).expect("there is room");
            assert!((found / exact - 1.0).abs() < 1e-10, "{value}: {found} {exact}");
        }
        assert!(slope(2.0, 2.0, 2.0).is_err());
    }
}
