//! One line of the page.

/// What kind of number stands in a line, so that whoever shows it can tell it in its units. All are dimensionless.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A bare number: a ratio, a decrement, a factor.
    Number,
    /// A part of one hundred.
    Percent,
    /// A length in `e_t`.
    Length,
    /// A force as `|u|` in `w0^2 e_t`, on the mass of the first control bearing.
    Force,
    /// A stiffness in `K_t`.
    Stiffness,
}

/// What is asked of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// At least so much.
    AtLeast(f64),
    /// At most so much.
    AtMost(f64),
}

impl Asked {
    /// The number itself.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::AtLeast(value) | Self::AtMost(value) => value,
        }
    }

    /// Whether `found` is enough. What is not a number is not.
    #[must_use]
    pub fn holds(self, found: f64) -> bool {
        match self {
            Self::AtLeast(least) => found >= least,
            Self::AtMost(most) => found <= most,
        }
    }
}

/// Where it was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Where {
    /// At which spin speed `R`.
    pub speed: Option<f64>,
    /// At which mass, counted from 0.
    pub station: Option<usize>,
    /// At which frequency, in radians per `tau`, forward positive.
    pub frequency: Option<f64>,
}

impl Where {
    /// At a speed.
    #[must_use]
    pub fn speed(speed: f64) -> Self {
        Self { speed: Some(speed), ..Self::default() }
    }

    /// The same, of a mass.
    #[must_use]
    pub fn of(self, station: usize) -> Self {
        Self { station: Some(station), ..self }
    }

    /// The same, at a frequency.
    #[must_use]
    pub fn with(self, frequency: f64) -> Self {
        Self { frequency: Some(frequency), ..self }
    }
}

/// One line: what was looked at, what was found, and whether that is what is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was looked at.
    pub what: String,
    /// What was found; nothing where `why` says why there is nothing.
    pub found: Option<f64>,
    /// What is asked of it; nothing where nothing is.
    pub asked: Option<Asked>,
    /// What kind of number both are.
    pub quantity: Quantity,
    /// Whether it is enough; nothing where it cannot be judged.
    pub passed: Option<bool>,
    /// Where.
    pub place: Where,
    /// Where the limit comes from.
    pub source: String,
    /// What else is to be said: a zone, or why there is nothing to be judged.
    pub note: Option<String>,
}

impl Finding {
    /// A line that is judged: by what was found and what is asked.
    #[must_use]
    pub(super) fn judged(what: impl Into<String>, quantity: Quantity, found: f64, asked: Asked, source: &str) -> Self {
        Self {
            what: what.into(),
            found: Some(found),
            asked: Some(asked),
            quantity,
            passed: Some(asked.holds(found)),
            place: Where::default(),
            source: source.to_owned(),
            note: None,
        }
    }

    /// A line of which nothing is asked.
    #[must_use]
    pub(super) fn told(what: impl Into<String>, quantity: Quantity, found: f64, source: &str) -> Self {
        Self { asked: None, passed: None, ..Self::judged(what, quantity, found, Asked::AtLeast(found), source) }
    }

    /// A line that cannot be judged.
    #[must_use]
    pub(super) fn without(what: impl Into<String>, quantity: Quantity, why: impl Into<String>, source: &str) -> Self {
        Self { found: None, note: Some(why.into()), ..Self::told(what, quantity, 0.0, source) }
    }

    /// The same, with its place.
    #[must_use]
    pub(super) fn at(self, place: Where) -> Self {
        Self { place, ..self }
    }

    /// The same, with something beside it.
    #[must_use]
    pub(super) fn noted(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }
}
