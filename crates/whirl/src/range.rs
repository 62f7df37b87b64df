//! Ranges as typed on the command line: `A..B`, both ends included.

use std::str::FromStr;

/// A finite range of numbers, `from < to`. Whether its ends may be negative is for the command to say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// The lower end, included.
    pub from: f64,
    /// The upper end, included.
    pub to: f64,
}

/// Why a text is not a range: one message, because what is expected is always the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected A..B with finite numbers A < B, such as 0..6")]
pub(crate) struct RangeError;

impl FromStr for Range {
    type Err = RangeError;

    fn from_str(typed: &str) -> Result<Self, RangeError> {
        let (from, to) = typed.split_once("..").ok_or(RangeError)?;
        let end = |text: &str| text.trim().parse::<f64>().ok().filter(|end| end.is_finite()).ok_or(RangeError);
        let (from, to) = (end(from)?, end(to)?);
        if from < to { Ok(Self { from, to }) } else { Err(RangeError) }
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}..{}", self.from, self.to)
    }
}

impl Range {
    /// `count` evenly spaced points with both ends among them, exactly; a single one is the lower end.
    #[must_use]
    pub(crate) fn points(self, count: usize) -> Vec<f64> {
        let last = count.saturating_sub(1).max(1) as f64;
        // Weighted ends instead of `from + i * step`: the last point is `to` itself, and nothing overflows.
        (0..count).map(|i| i as f64 / last).map(|s| self.from * (1.0 - s) + self.to * s).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_a_person_types() {
        for (typed, from, to) in
            [("0..6", 0.0, 6.0), ("-1.5..2e3", -1.5, 2e3), (" .5 .. 1. ", 0.5, 1.0), ("0...5", 0.0, 0.5)]
        {
            assert_eq!(typed.parse(), Ok(Range { from, to }), "{typed}");
        }
    }

    #[test]
    fn refuses_what_is_empty_backward_or_not_finite() {
        for typed in
            ["", "3", "..", "0..", "..6", "6..0", "2..2", "0..inf", "nan..1", "0..=6", "a..b", "0..1..2", "0-6"]
        {
            assert_eq!(typed.parse::<Range>(), Err(RangeError), "{typed}");
        }
    }

    #[test]
    fn points_hit_both_ends_exactly() {
        let points = Range { from: 0.1, to: 0.7 }.points(7);
        assert_eq!((points.len(), points[0], points[6]), (7, 0.1, 0.7));
        assert!(points.windows(2).all(|w| (w[1] - w[0] - 0.1).abs() < 1e-15));
        assert_eq!(Range { from: 2.0, to: 3.0 }.points(1), [2.0]);
        assert!(Range { from: 2.0, to: 3.0 }.points(0).is_empty());
    }
}
