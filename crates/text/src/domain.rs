//! Which numbers are allowed where one is read.

/// The numbers that are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Finite and greater than 0.
    Positive,
    /// Finite and at least 0.
    NotNegative,
    /// Any finite number.
    Finite,
}

impl Domain {
    /// Whether `number` is in it.
    #[must_use]
    pub fn admits(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Positive => number > 0.0,
                Self::NotNegative => number >= 0.0,
                Self::Finite => true,
            }
    }

    /// It, in words that follow "expected".
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Positive => "a finite number greater than 0",
            Self::NotNegative => "a finite number, not negative",
            Self::Finite => "a finite number",
        }
    }
}
