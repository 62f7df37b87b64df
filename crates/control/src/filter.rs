//! Filters of a signal or a bearing: what they are and which are allowed. At work they are [`crate::block::Block`]s.
//!
//! Transfer functions are in `s = d/dtau`, on the complex signal `y + j z`. In a sampled loop they are turned into
//! difference equations by the trapezoidal rule (Tustin), a notch with its frequency kept.

use crate::C64;
use crate::block::{Block, MAX_ORDER};

/// One filter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Filter {
    /// Butterworth's low-pass: `1 / |H|^2 = 1 + (w / corner)^(2 order)`.
    Lowpass {
        /// Where the amplitude has fallen to 0.707.
        corner: f64,
        /// Order, 1 to 8.
        order: usize,
    },
    /// Lead (`zero < pole`) or lag: `(1 + s / zero) / (1 + s / pole)`.
    Lead {
        /// Where the amplitude begins to rise.
        zero: f64,
        /// Where it ends to.
        pole: f64,
    },
    /// A notch for both senses of whirl: `(s^2 + f^2) / (s^2 + width s + f^2)`.
    Notch {
        /// The frequency `f` that it takes out.
        frequency: f64,
        /// Distance of the two frequencies at which the amplitude is 0.707.
        width: f64,
    },
    /// A notch that follows the speed, for forward whirl only: `(s - j R) / (s - j R + width / 2)`.
    SynchronousNotch {
        /// Distance of the two frequencies at which the amplitude is 0.707.
        width: f64,
    },
    /// `1 + rate / s`. It stops integrating while the actuator is at its limit and integrating would lead further.
    Integrator {
        /// `1 / T_i`.
        rate: f64,
    },
    /// `s / (1 + s / corner)`: velocity made of displacement.
    Derivative {
        /// Up to where it differentiates.
        corner: f64,
    },
    /// A ratio of polynomials in falling powers of `s`.
    Transfer {
        /// Numerator, of no higher order than the denominator.
        numerator: Vec<f64>,
        /// Denominator; its first coefficient is not 0.
        denominator: Vec<f64>,
    },
}

/// Every kind of filter and its keys in files, in the order of [`Filter`].
pub const FILTERS: [(&str, &[&str]); 7] = [
    ("lowpass", &["corner", "order"]),
    ("lead", &["zero", "pole"]),
    ("notch", &["frequency", "width"]),
    ("synchronous-notch", &["width"]),
    ("integrator", &["rate"]),
    ("derivative", &["corner"]),
    ("transfer", &["numerator", "denominator"]),
];

/// The transfer function of each of [`FILTERS`] and of [`STATE_SPACE`], in `s = d/dtau`, for people.
pub const TRANSFER_FUNCTIONS: [&str; 8] = [
    "Butterworth's: 1 / |H|^2 = 1 + (w / corner)^(2 order)",
    "(1 + s / zero) / (1 + s / pole)",
    "(s^2 + f^2) / (s^2 + width s + f^2), f the frequency",
    "(s - j R) / (s - j R + width / 2), forward whirl alone",
    "1 + rate / s",
    "s / (1 + s / corner)",
    "numerator / denominator, coefficients in falling powers of s",
    "c (s - a)^-1 b + d",
];

/// A kind more that files have, with its keys: a controller as matrices, which is read as [`Filter::Transfer`]
/// (see [`Filter::of_state_space`]).
pub const STATE_SPACE: (&str, &[&str]) = ("state-space", &["a", "b", "c", "d"]);

/// Why a filter is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// A frequency, width or rate that is not positive and finite.
    #[error("{kind}: {key} = {found}: expected a finite number greater than 0")]
    NotPositive {
        /// Which filter.
        kind: &'static str,
        /// Which of its numbers.
        key: &'static str,
        /// The value.
        found: f64,
    },
    /// An order that is not to be had.
    #[error("{kind} of order {found}: expected 1 to {MAX_ORDER}")]
    Order {
        /// Which filter.
        kind: &'static str,
        /// The order.
        found: usize,
    },
    /// A ratio of polynomials that grows without bound, or has a coefficient that is not finite, or no leading one.
    #[error(
        "transfer: expected finite coefficients, the first of the denominator not 0, and no more of them above than below"
    )]
    Improper,
    /// Matrices of a state space whose slowest poles are lost beside the fastest.
    #[error(
        "state-space whose poles lie too far apart for one transfer function: expected them nearer, or slow and fast ones in filters of their own"
    )]
    FarApart,
    /// Matrices of a state space that do not fit each other.
    #[error(
        "state-space with a of {rows} x {columns}, b of {inputs} and c of {outputs}: expected a square a, and as many numbers in b and c as it has rows"
    )]
    Matrices {
        /// Rows of `A`.
        rows: usize,
        /// Columns of `A`.
        columns: usize,
        /// Numbers of `B`.
        inputs: usize,
        /// Numbers of `C`.
        outputs: usize,
    },
}

impl Filter {
    /// Its name in files.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        let place = match self {
            Self::Lowpass { .. } => 0,
            Self::Lead { .. } => 1,
            Self::Notch { .. } => 2,
            Self::SynchronousNotch { .. } => 3,
            Self::Integrator { .. } => 4,
            Self::Derivative { .. } => 5,
            Self::Transfer { .. } => 6,
        };
        FILTERS[place].0
    }

    /// Its numbers with their keys, all greater than 0; without polynomials and orders.
    #[must_use]
    pub fn positive(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Lowpass { corner, .. } | Self::Derivative { corner } => vec![("corner", corner)],
            Self::Lead { zero, pole } => vec![("zero", zero), ("pole", pole)],
            Self::Notch { frequency, width } => vec![("frequency", frequency), ("width", width)],
            Self::SynchronousNotch { width } => vec![("width", width)],
            Self::Integrator { rate } => vec![("rate", rate)],
            Self::Transfer { .. } => vec![],
        }
    }

    /// The `place`-th of [`Filter::positive`], to change; `None` if there are not so many.
    pub fn positive_mut(&mut self, place: usize) -> Option<&mut f64> {
        let all: [Option<&mut f64>; 2] = match self {
            Self::Lowpass { corner, .. } | Self::Derivative { corner } => [Some(corner), None],
            Self::Lead { zero, pole } => [Some(zero), Some(pole)],
            Self::Notch { frequency, width } => [Some(frequency), Some(width)],
            Self::SynchronousNotch { width } => [Some(width), None],
            Self::Integrator { rate } => [Some(rate), None],
            Self::Transfer { .. } => [None, None],
        };
        all.into_iter().nth(place).flatten()
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// The first that is not allowed, by name.
    pub fn check(&self) -> Result<(), FilterError> {
        let kind = self.kind();
        for (key, found) in self.positive() {
            if !(found.is_finite() && found > 0.0) {
                return Err(FilterError::NotPositive { kind, key, found });
            }
        }
        match self {
            Self::Lowpass { order, .. } if !(1..=MAX_ORDER).contains(order) => {
                Err(FilterError::Order { kind, found: *order })
            }
            Self::Transfer { numerator, denominator } => {
                let finite = numerator.iter().chain(denominator).all(|c| c.is_finite());
                let proper = !numerator.is_empty() && numerator.len() <= denominator.len();
                if !(finite && proper && denominator[0] != 0.0) {
                    return Err(FilterError::Improper);
                }
                match denominator.len() - 1 {
                    found if found > MAX_ORDER => Err(FilterError::Order { kind, found }),
                    _ => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    /// Its response `H(s)` at spin speed `speed`.
    #[must_use]
    pub fn at(&self, s: C64, speed: f64) -> C64 {
        self.blocks().iter().map(|block| block.at(s, speed)).product()
    }

    /// Itself as blocks in a row. It must have passed [`Filter::check`].
    pub(crate) fn blocks(&self) -> Vec<Block> {
        match *self {
            Self::Lowpass { corner, order } => {
                // Poles on the half circle of radius `corner`, in pairs; the odd one on the axis.
                let pairs = (0..order / 2).map(|k| {
                    let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (2 * order) as f64;
                    Block::of(&[corner * corner, 2.0 * angle.sin() * corner], &[corner * corner], 0.0)
                });
                let odd = (order % 2 == 1).then(|| Block::of(&[corner], &[corner], 0.0));
                pairs.chain(odd).collect()
            }
            Self::Lead { zero, pole } => vec![Block::of(&[pole], &[pole / zero * (zero - pole)], pole / zero)],
            Self::Notch { frequency, width } => {
                vec![Block::of(&[frequency * frequency, width], &[0.0, -width], 1.0).exact_at(frequency)]
            }
            Self::SynchronousNotch { width } => {
                vec![Block::of(&[0.5 * width], &[-0.5 * width], 1.0).following_speed()]
            }
            Self::Integrator { rate } => vec![Block::of(&[0.0], &[rate], 1.0).winding_up()],
            Self::Derivative { corner } => vec![Block::of(&[corner], &[-corner * corner], corner)],
            Self::Transfer { ref numerator, ref denominator } => {
                let order = denominator.len() - 1;
                // Rising powers, monic.
                let a: Vec<f64> = denominator.iter().rev().map(|c| c / denominator[0]).collect();
                let mut n: Vec<f64> = numerator.iter().rev().map(|c| c / denominator[0]).collect();
                n.resize(order + 1, 0.0);
                let direct = n[order];
                let b: Vec<f64> = (0..order).map(|i| n[i] - direct * a[i]).collect();
                vec![Block::of(&a[..order], &b, direct)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::J;

    #[test]
    fn val_responses_are_those_of_the_transfer_functions() {
        // Against the formulas themselves, and for the low-pass against Butterworth's magnitude.
        let s = C64::new(0.0, 1.7);
        let speed = 2.5;
        for (filter, expected) in [
            (Filter::Lead { zero: 2.0, pole: 9.0 }, (s / 2.0 + 1.0) / (s / 9.0 + 1.0)),
            (Filter::Notch { frequency: 3.1, width: 0.2 }, (s * s + 9.61) / (s * s + s * 0.2 + 9.61)),
            (Filter::SynchronousNotch { width: 0.2 }, (s - J * speed) / (s - J * speed + 0.1)),
            (Filter::Integrator { rate: 0.3 }, 1.0 + 0.3 / s),
            (Filter::Derivative { corner: 20.0 }, s / (s / 20.0 + 1.0)),
            (
                Filter::Transfer { numerator: vec![2.0, 1.0, 3.0], denominator: vec![4.0, 1.0, 5.0] },
                (s * s * 2.0 + s + 3.0) / (s * s * 4.0 + s + 5.0),
            ),
            (Filter::Transfer { numerator: vec![3.0], denominator: vec![2.0] }, C64::from(1.5)),
        ] {
            filter.check().expect("allowed");
            assert!((filter.at(s, speed) - expected).norm() < 1e-14, "{filter:?}");
        }
        for order in 1..=8 {
            let filter = Filter::Lowpass { corner: 8.0, order };
            for w in [0.1, 5.0, 8.0, 30.0] {
                let magnitude = filter.at(J * w, 0.0).norm();
                let butterworth = (1.0 + (w / 8.0f64).powi(2 * order as i32)).powf(-0.5);
                assert!((magnitude - butterworth).abs() < 1e-13, "order {order} at {w}");
            }
        }
        // The widths are where the amplitude is 0.707.
        let notch = Filter::SynchronousNotch { width: 0.2 };
        assert!((notch.at(J * (speed + 0.1), speed).norm() - 0.5f64.sqrt()).abs() < 1e-14);
        assert!((notch.at(J * -speed, speed).norm() - 1.0).abs() < 1e-3, "backward whirl passes");
    }

    #[test]
    fn what_is_not_allowed_is_named() {
        for (filter, told) in [
            (Filter::Lowpass { corner: 0.0, order: 2 }, "lowpass: corner = 0: expected a finite number greater than 0"),
            (Filter::Lowpass { corner: 1.0, order: 9 }, "lowpass of order 9: expected 1 to 8"),
            (Filter::Lowpass { corner: 1.0, order: 0 }, "lowpass of order 0: expected 1 to 8"),
            (
                Filter::SynchronousNotch { width: f64::NAN },
                "synchronous-notch: width = NaN: expected a finite number greater than 0",
            ),
            (
                Filter::Transfer { numerator: vec![1.0], denominator: vec![1.0; 10] },
                "transfer of order 9: expected 1 to 8",
            ),
        ] {
            assert_eq!(filter.check().unwrap_err().to_string(), told);
        }
        let improper = Filter::Transfer { numerator: vec![1.0, 0.0], denominator: vec![1.0] };
        assert_eq!(improper.check(), Err(FilterError::Improper));
    }
}
