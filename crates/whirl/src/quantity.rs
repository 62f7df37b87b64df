//! Quantities as options take them: a number, or a range of two, which may say what it is counted in.

use std::fmt;
use std::str::FromStr;

use rotor::typed::{RangeError, TypedRange, range_numbers};
use units::{Dimension, Typed, TypedError};

/// A quantity as typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TypedQuantity {
    /// What it is.
    pub dimension: Dimension,
    /// What was typed for it.
    pub typed: Typed,
}

/// A range of a quantity as typed, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuantityRange {
    /// What it is.
    pub dimension: Dimension,
    /// What was typed for it.
    pub typed: TypedRange,
}

/// Reads a quantity, as a parser of an option.
pub(crate) fn of(dimension: Dimension) -> impl Fn(&str) -> Result<TypedQuantity, TypedError> + Clone + Send + Sync {
    move |typed| Typed::read(dimension, typed).map(|typed| TypedQuantity { dimension, typed })
}

/// Reads a range of a quantity, as a parser of an option.
pub(crate) fn range(dimension: Dimension) -> impl Fn(&str) -> Result<QuantityRange, RangeError> + Clone + Send + Sync {
    move |typed| TypedRange::read(dimension, typed).map(|typed| QuantityRange { dimension, typed })
}

impl TypedQuantity {
    /// The number that was typed, whatever it is counted in.
    pub(crate) fn number(self) -> f64 {
        self.typed.number()
    }
}

impl fmt::Display for TypedQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.typed.fmt(f)
    }
}

impl fmt::Display for QuantityRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.typed.fmt(f)
    }
}

/// A range as typed of a quantity that is known only with its machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ends(String);

impl Ends {
    /// The range, now that the quantity is known.
    ///
    /// # Errors
    /// A unit of something else, or at the lower end alone.
    pub(crate) fn of(&self, dimension: Dimension) -> Result<QuantityRange, RangeError> {
        range(dimension)(&self.0)
    }

    /// The number at the lower end, whatever it is counted in.
    pub(crate) fn lowest(&self) -> f64 {
        range_numbers(&self.0).map_or(f64::NAN, |[from, _]| from)
    }
}

impl FromStr for Ends {
    type Err = RangeError;

    fn from_str(typed: &str) -> Result<Self, RangeError> {
        range_numbers(typed).map(|_| Self(typed.trim().to_owned()))
    }
}
