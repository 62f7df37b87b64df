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

pub(crate) use rotor::typed::RangeError;

impl FromStr for Range {
    type Err = RangeError;

    fn from_str(typed: &str) -> Result<Self, RangeError> {
        rotor::typed::range(typed).map(|[from, to]| Self { from, to })
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}..{}", self.from, self.to)
    }
}

impl Range {
    /// This range as a part of another: an end that is off one of the other's by no more than rounding, of a value that was typed in another
    /// unit, is that end. `None` of one that reaches beyond.
    #[must_use]
    pub(crate) fn within(self, whole: Self) -> Option<Self> {
        const ROUNDING: f64 = 1e-12;
        let size = whole.from.abs().max(whole.to.abs());
        let snapped = |end: f64| {
            let near = |other: &f64| (end - other).abs() <= ROUNDING * size;
            [whole.from, whole.to].into_iter().find(near).unwrap_or(end)
        };
        let part = Self { from: snapped(self.from), to: snapped(self.to) };
        (part.from >= whole.from && part.to <= whole.to && part.from < part.to).then_some(part)
    }

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
    fn reads_what_a_person_types_and_nothing_that_reads_in_two_ways() {
        assert_eq!("-1.5..2e3".parse(), Ok(Range { from: -1.5, to: 2e3 }));
        assert_eq!("0...3".parse::<Range>(), Err(RangeError::Dots));
        assert_eq!("6..0".parse::<Range>(), Err(RangeError::Form));
    }

    #[test]
    fn a_part_of_a_range_ends_where_the_range_does_whatever_unit_it_was_typed_in() {
        let whole = Range { from: 0.1 + 0.2, to: 314.159_265_358_979_3 };
        let part = Range { from: 0.3, to: whole.to.next_up() };
        assert!(part.to > whole.to && part.from < whole.from);
        assert_eq!(part.within(whole), Some(whole));
        assert_eq!(Range { from: 1.0, to: 2.0 }.within(whole), Some(Range { from: 1.0, to: 2.0 }));
        assert_eq!(Range { from: 1.0, to: 314.16 }.within(whole), None);
        assert_eq!(Range { from: 0.29, to: 2.0 }.within(whole), None);
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
