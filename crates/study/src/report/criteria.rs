//! What the report's words are taken to mean, in numbers, where a statement of it is put to the test. The page says so.

use std::ops::RangeInclusive;

/// `about`, `approximately`: the relative difference up to which.
pub(super) const ABOUT: f64 = 0.15;
/// `nearly the same`: the factor, either way, up to which.
pub(super) const NEARLY_THE_SAME: f64 = 1.25;
/// `slight`: the relative variation up to which.
pub(super) const SLIGHT: f64 = 0.05;
/// `nearly linear`: how far from a straight line at most, as a part of the largest.
pub(super) const NEARLY_LINEAR: f64 = 0.1;
/// `an order of magnitude greater`: ten times, from here to here.
pub(super) const ORDER_OF_MAGNITUDE: RangeInclusive<f64> = 8.0..=20.0;
/// `mainly`: the part of the power from which on.
pub(super) const MAINLY: f64 = 0.9;
/// `not detectable`: the part of the power below which.
pub(super) const NOT_DETECTABLE: f64 = 1e-6;

/// Whether `factor` is one of `nearly the same`.
pub(super) fn nearly_the_same(factor: f64) -> bool {
    (1.0 / NEARLY_THE_SAME..=NEARLY_THE_SAME).contains(&factor)
}

/// All of them in a sentence.
pub(super) fn words() -> String {
    format!(
        "Words are taken to mean: \"about\", within {:.0} %; \"nearly the same\", within a factor of {NEARLY_THE_SAME}; \
         \"slight\", up to {:.0} %; \"nearly linear\", off a straight line by up to {:.0} % of the largest; \"an order of \
         magnitude\", {} to {} times; \"mainly\", {:.0} % of the power; \"not detectable\", less than a millionth of it.",
        100.0 * ABOUT,
        100.0 * SLIGHT,
        100.0 * NEARLY_LINEAR,
        ORDER_OF_MAGNITUDE.start(),
        ORDER_OF_MAGNITUDE.end(),
        100.0 * MAINLY
    )
}
