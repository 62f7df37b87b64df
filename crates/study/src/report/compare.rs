//! One printed number or claim beside ours.

use crate::csv::{Field, Lines};

/// What the report prints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Printed {
    /// A number, as it is printed.
    Number(&'static str),
    /// A statement without a number, or about a plot.
    Claim(&'static str),
}

/// What we compute.
#[derive(Clone, Debug, PartialEq)]
pub enum Ours {
    /// A number, with as many decimals as are sure.
    Number {
        /// The number.
        value: f64,
        /// Decimals shown.
        decimals: usize,
    },
    /// A number that rests on a reconstruction of what the report does not say.
    Reconstructed {
        /// The number.
        value: f64,
        /// Decimals shown.
        decimals: usize,
        /// The relative difference up to which the reconstruction is taken for a good one.
        within: f64,
    },
    /// A statement put to the test.
    Claim {
        /// Whether it holds of our rotor.
        holds: bool,
        /// What was found.
        found: String,
    },
}

/// A number of ours, with as many decimals as are sure.
pub(super) fn number(value: f64, decimals: usize) -> Ours {
    Ours::Number { value, decimals }
}

/// A statement that we put to the test.
pub(super) fn claim(holds: bool, found: String) -> Ours {
    Ours::Claim { holds, found }
}

/// A number as shown: with as many decimals as an error of `off` leaves sure.
pub(super) fn sure(value: f64, off: f64) -> String {
    let decimals = (-(2.0 * off.max(1e-12)).log10()).floor().max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// What should be nothing but rounding, as shown: its digits would be another processor's others.
pub(super) fn under(value: f64, bound: f64) -> String {
    if value < bound { format!("less than {bound:e}") } else { format!("{value:.1e}") }
}

/// How a row agrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Rounded to the digits printed, ours is the printed number.
    EveryDigit,
    /// The last digit printed is off by one.
    LastDigit,
    /// A reconstruction that comes as near as it claims.
    Reconstructed,
    /// Not the same: the note says why.
    Differs,
    /// A statement that holds.
    Holds,
    /// A statement that does not hold of our rotor: the note says why.
    DoesNotHold,
}

impl Verdict {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::EveryDigit => "every printed digit",
            Self::LastDigit => "one off in the last digit",
            Self::Reconstructed => "a reconstruction, near",
            Self::Differs => "differs",
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The number of its chapter, 3 or 4.
    pub chapter: u8,
    /// What it is.
    pub quantity: &'static str,
    /// Where the report has it.
    pub place: &'static str,
    /// What the report has.
    pub printed: Printed,
    /// What we have.
    pub ours: Ours,
    /// What else must be said; may be empty.
    pub note: &'static str,
}

impl Printed {
    /// The printed number, and a unit of its last digit.
    fn number(self) -> Option<(f64, f64)> {
        let Self::Number(text) = self else { return None };
        let decimals = text.split_once('.').map_or(0, |(_, after)| after.len());
        Some((text.parse().ok()?, 10_f64.powi(-(decimals as i32))))
    }
}

impl Ours {
    /// The number, if it is one, and the decimals shown of it.
    #[must_use]
    pub fn number(&self) -> Option<(f64, usize)> {
        match *self {
            Self::Number { value, decimals } | Self::Reconstructed { value, decimals, .. } => Some((value, decimals)),
            Self::Claim { .. } => None,
        }
    }
}

impl Comparison {
    /// Ours less the report's, absolute and relative, where both are numbers.
    #[must_use]
    pub fn difference(&self) -> Option<(f64, f64)> {
        let (Some((printed, _)), Some((value, _))) = (self.printed.number(), self.ours.number()) else { return None };
        Some((value - printed, (value - printed) / printed.abs()))
    }

    /// How it agrees.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match (&self.ours, self.printed.number()) {
            (Ours::Claim { holds: true, .. }, _) => Verdict::Holds,
            (Ours::Claim { holds: false, .. }, _) => Verdict::DoesNotHold,
            (Ours::Number { value, .. }, Some((printed, unit))) => {
                let off = (value - printed).abs() / unit;
                if off <= 0.5 + 1e-9 {
                    Verdict::EveryDigit
                } else if off < 1.5 {
                    Verdict::LastDigit
                } else {
                    Verdict::Differs
                }
            }
            (Ours::Reconstructed { value, within, .. }, Some((printed, _)))
                if (value - printed).abs() <= within * printed.abs() =>
            {
                Verdict::Reconstructed
            }
            (Ours::Number { .. } | Ours::Reconstructed { .. }, _) => Verdict::Differs,
        }
    }

    /// What the report has, as shown.
    #[must_use]
    pub fn printed_words(&self) -> &'static str {
        match self.printed {
            Printed::Number(text) | Printed::Claim(text) => text,
        }
    }

    /// What we have, as shown.
    #[must_use]
    pub fn our_words(&self) -> String {
        match &self.ours {
            Ours::Number { value, decimals } | Ours::Reconstructed { value, decimals, .. } => {
                format!("{value:.decimals$}")
            }
            Ours::Claim { found, .. } => found.clone(),
        }
    }

    /// The difference, absolute and relative, as shown; empty where there is none.
    #[must_use]
    pub fn difference_words(&self) -> (String, String) {
        let (Some((absolute, relative)), Some((_, decimals))) = (self.difference(), self.ours.number()) else {
            return Default::default();
        };
        let percent = 100.0 * relative;
        let relative = if percent.abs() < 0.01 { "below 0.01 %".to_owned() } else { format!("{percent:+.2} %") };
        (format!("{absolute:+.decimals$}"), relative)
    }
}

impl super::Report {
    /// The table of numbers as comma-separated values: ours and the differences with every digit.
    #[must_use]
    pub fn numbers_csv(&self) -> String {
        let names =
            ["chapter", "quantity", "where", "report", "ours", "found", "difference", "relative", "agreement", "note"];
        let mut lines = Lines::new(names);
        for c in &self.comparisons {
            let (difference, relative) = c.difference().unzip();
            let found = c.our_words();
            lines.row([
                Field::Count(c.chapter.into()),
                Field::Text(c.quantity),
                Field::Text(c.place),
                Field::Text(c.printed_words()),
                c.ours.number().map(|(value, _)| value).into(),
                Field::Text(&found),
                difference.into(),
                relative.into(),
                Field::Text(c.verdict().words()),
                Field::Text(c.note),
            ]);
        }
        lines.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_digit_is_shown_that_is_not_sure() {
        assert_eq!(sure(12.0365, 0.012), "12.0");
        assert_eq!(sure(5.225_896, 1e-6), "5.22590");
        assert_eq!(sure(73.3, 0.073), "73");
    }

    #[test]
    fn agreement_is_judged_by_the_digits_that_are_printed() {
        let verdict = |printed, value| {
            let ours = Ours::Number { value, decimals: 6 };
            let printed = Printed::Number(printed);
            Comparison { chapter: 3, quantity: "", place: "", printed, ours, note: "" }.verdict()
        };
        assert_eq!(verdict("2.2", 2.209_975), Verdict::EveryDigit);
        assert_eq!(verdict("-0.44272", -0.442_769), Verdict::Differs);
        assert_eq!(verdict("0.78", 0.790_1), Verdict::LastDigit);
        assert_eq!(verdict("7", 9.0), Verdict::Differs);
    }
}
