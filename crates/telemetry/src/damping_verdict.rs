//! How a smallest damping ratio is told of everywhere: in one word.

/// What a smallest damping ratio means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DampingVerdict {
    /// A mode grows.
    Unstable,
    /// A mode neither grows nor decays: zero but for rounding, which `rotor` tells as exactly zero.
    Marginal,
    /// Every mode decays, but one of them slowly: less than [`alarms::LOW_DAMPING`].
    Low,
    /// Every mode decays.
    Stable,
}

impl DampingVerdict {
    /// Of a smallest damping ratio.
    #[must_use]
    pub fn of(min_damping: f64) -> Self {
        if min_damping < 0.0 {
            Self::Unstable
        } else if min_damping == 0.0 {
            Self::Marginal
        } else if min_damping < alarms::LOW_DAMPING {
            Self::Low
        } else {
            Self::Stable
        }
    }

    /// The word for it; what is bad is in capitals.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Unstable => "UNSTABLE",
            Self::Marginal => "MARGINAL",
            Self::Low => "low",
            Self::Stable => "stable",
        }
    }
}
