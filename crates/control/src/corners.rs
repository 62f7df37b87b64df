//! The frequencies of a filter as numbers that may vary: what they are, the filter with others in their place, and what its
//! response changes by with each.
//!
//! They are positive and span decades, so slopes are by their logarithm. The corners of a transfer function are the sizes of its
//! zeros and poles off the origin, a conjugate pair being one: a corner that moves scales its roots,
//!
//! ```text
//! H = gain s^lift prod (1 - s / zero_i) / prod (1 - s / pole_i)
//! ```
//!
//! so that damping of pairs and the gain far below all corners stay, as those of a lead do.

mod rational;

use std::f64::consts::{FRAC_PI_2, PI};

use units::Dimension;

use self::rational::Rational;
use crate::{C64, FILTERS, Filter, J};

/// A filter with its frequencies apart. What is said of `values` is: one for each of [`Corners::names`], finite and above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Corners {
    filter: Filter,
    /// Of a transfer function.
    rational: Option<Rational>,
}

impl Corners {
    /// Those of `filter`, which must have passed [`Filter::check`].
    #[must_use]
    pub fn of(filter: &Filter) -> Self {
        let rational = match filter {
            Filter::Transfer { numerator, denominator } => Some(Rational::of(numerator, denominator)),
            _ => None,
        };
        Self { filter: filter.clone(), rational }
    }

    /// What they are called in files; of a transfer function `zero.1`, `zero.2`, .. `pole.1`, .. by rising frequency.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match &self.rational {
            Some(rational) => rational.names(),
            None => {
                let keys =
                    FILTERS.iter().find(|(kind, _)| *kind == self.filter.kind()).map_or(&[][..], |(_, keys)| keys);
                keys.iter().filter(|key| **key != "order").map(|key| (*key).to_owned()).collect()
            }
        }
    }

    /// What they measure, and so their unit in files.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        if matches!(self.filter, Filter::Integrator { .. }) { Dimension::Rate } else { Dimension::Frequency }
    }

    /// The values that the filter has.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        match (&self.rational, &self.filter) {
            (Some(rational), _) => rational.values(),
            (None, filter) => filter.positive().into_iter().map(|(_, value)| value).collect(),
        }
    }

    /// The filter with these values.
    ///
    /// # Panics
    /// If there are too few.
    #[must_use]
    pub fn filter(&self, values: &[f64]) -> Filter {
        match self.filter {
            Filter::Lowpass { order, .. } => Filter::Lowpass { corner: values[0], order },
            Filter::Lead { .. } => Filter::Lead { zero: values[0], pole: values[1] },
            Filter::Notch { .. } => Filter::Notch { frequency: values[0], width: values[1] },
            Filter::SynchronousNotch { .. } => Filter::SynchronousNotch { width: values[0] },
            Filter::Integrator { .. } => Filter::Integrator { rate: values[0] },
            Filter::Derivative { .. } => Filter::Derivative { corner: values[0] },
            Filter::Transfer { .. } => match &self.rational {
                Some(rational) => rational.filter(values),
                None => self.filter.clone(),
            },
        }
    }

    /// Its response to `exp(s tau)` with these values at a spin speed, in a loop with this sampling period; 0 is a continuous one.
    ///
    /// # Panics
    /// If there are too few.
    #[must_use]
    pub fn response(&self, values: &[f64], s: C64, speed: f64, period: f64) -> C64 {
        let [p, _] = self.plane(values, s, period);
        match &self.rational {
            Some(rational) => rational.at(values, p),
            None => self.filter(values).at(p, speed),
        }
    }

    /// What that changes by with the logarithm of each value.
    ///
    /// # Panics
    /// If there are too few.
    #[must_use]
    pub fn slopes(&self, values: &[f64], s: C64, speed: f64, period: f64) -> Vec<C64> {
        let [p, follows] = self.plane(values, s, period);
        let at = |filter: &Filter| filter.at(p, speed);
        match self.filter {
            Filter::Lowpass { order, .. } => {
                // Poles on the left half of a circle, every one scaled by the corner.
                let pole =
                    |k: usize| C64::from_polar(values[0], FRAC_PI_2 + PI * (2 * k + 1) as f64 / (2 * order) as f64);
                let sum: C64 = (0..order).map(|k| p / (pole(k) - p)).sum();
                vec![-at(&self.filter(values)) * sum]
            }
            Filter::Lead { .. } => {
                let [zero, pole] = [values[0], values[1]];
                vec![-(p / zero) / (p / pole + 1.0), at(&self.filter(values)) * p / (p + pole)]
            }
            Filter::Notch { .. } => {
                let [frequency, width] = [values[0], values[1]];
                let above = p * p + frequency * frequency;
                let below = above + p * width;
                // Of the trapezoidal rule, which keeps the notch where it is, by way of `p` too.
                let through = p * (p * below * 2.0 - (p * 2.0 + width) * above) * follows;
                let square = below * below;
                vec![(p * (2.0 * frequency * frequency * width) + through) / square, -above * p * width / square]
            }
            Filter::SynchronousNotch { .. } => {
                let half = 0.5 * values[0];
                vec![-at(&self.filter(values)) * half / (p - J * speed + half)]
            }
            Filter::Integrator { .. } => vec![p.inv() * values[0]],
            Filter::Derivative { .. } => {
                let part = p / (p + values[0]);
                vec![part * part * values[0]]
            }
            Filter::Transfer { .. } => self.rational.as_ref().map_or_else(Vec::new, |own| own.slopes(values, p)),
        }
    }

    /// The `s` at which a sampled filter answers as the continuous one does (the trapezoidal rule), and what its logarithm changes
    /// by with that of the first value.
    fn plane(&self, values: &[f64], s: C64, period: f64) -> [C64; 2] {
        if period <= 0.0 {
            return [s, C64::ZERO];
        }
        let middle = (s * (0.5 * period)).tanh();
        match self.filter {
            Filter::Notch { .. } if values[0] * period < PI => {
                let turn = values[0] * period;
                [middle * values[0] / (0.5 * turn).tan(), C64::from(1.0 - turn / turn.sin())]
            }
            _ => [middle * 2.0 / period, C64::ZERO],
        }
    }
}

#[cfg(test)]
mod tests;
