//! What is watched, and how bad it is.

use std::fmt;
use std::str::FromStr;

/// What is watched. Arrays over all of it are in the order of [`Watch::ALL`], with `watch as usize` as the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// The machine has tripped.
    Trip,
    /// The smallest damping ratio of the modes that count.
    Damping,
    /// The peak of the loop's sensitivity.
    Sensitivity,
    /// How much longer a delay the loop bears, in `tau`.
    DelayMargin,
    /// The largest distance of any mass from the centre, in `e_t`.
    Orbit,
    /// The largest control, in `m_b w0^2 e_t`.
    Force,
    /// Share of steps with the control bearing at its limit.
    Saturation,
    /// Share of steps sent late or given up.
    Lateness,
    /// Steps that did not reach us.
    Losses,
}

impl Watch {
    /// How many there are.
    pub const COUNT: usize = 9;

    /// All, in the order of panels.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Trip,
        Self::Damping,
        Self::Sensitivity,
        Self::DelayMargin,
        Self::Orbit,
        Self::Force,
        Self::Saturation,
        Self::Lateness,
        Self::Losses,
    ];

    /// Whether it is read off a motion, whose size may rise and fall steadily.
    pub(crate) fn may_beat(self) -> bool {
        matches!(self, Self::Orbit | Self::Force)
    }

    /// Its name in panels, files and the configuration.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trip => "trip",
            Self::Damping => "damping",
            Self::Sensitivity => "sensitivity",
            Self::DelayMargin => "delay-margin",
            Self::Orbit => "orbit",
            Self::Force => "force",
            Self::Saturation => "saturation",
            Self::Lateness => "lateness",
            Self::Losses => "losses",
        }
    }

    /// What its value is, and in which unit.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Trip => "1 while the machine is held after a trip",
            Self::Damping => "smallest damping ratio of the modes that count",
            Self::Sensitivity => "peak of the loop's sensitivity; zones A, B and C of ISO 14839-3 end at 3, 4 and 5",
            Self::DelayMargin => "delay that the loop bears beside its own before it is unstable, in tau",
            Self::Orbit => "largest radius of any mass, in e_t",
            Self::Force => "largest control, in m_b w0^2 e_t",
            Self::Saturation => "share of steps with the control bearing at its limit",
            Self::Lateness => "share of steps of the last ten seconds that were late or given up",
            Self::Losses => "steps of the last ten seconds that did not reach the dashboard, or the recorder",
        }
    }

    /// Whether a person can set limits of it. A machine trips or does not, and that is always an alarm.
    #[must_use]
    pub fn has_limits(self) -> bool {
        self != Self::Trip
    }

    /// Whether its limits can follow the machine.
    #[must_use]
    pub fn can_follow(self) -> bool {
        matches!(self, Self::Orbit | Self::Force)
    }

    /// Whether little of it is bad.
    #[must_use]
    pub fn is_bad_below(self) -> bool {
        matches!(self, Self::Damping | Self::DelayMargin)
    }
}

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Watch {
    type Err = &'static str;

    /// By its name; the error is what was expected.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|watch| watch.name() == name);
        found.ok_or("trip, damping, sensitivity, delay-margin, orbit, force, saturation, lateness or losses")
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Within its limits.
    #[default]
    Fine,
    /// Worth a look.
    Warning,
    /// Worth a hand.
    Alarm,
}

impl Level {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::Warning => "warning",
            Self::Alarm => "alarm",
        }
    }
}

impl FromStr for Level {
    type Err = &'static str;

    /// By its name; the error is what was expected.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let all = [Self::Fine, Self::Warning, Self::Alarm];
        all.into_iter().find(|level| level.name() == name).ok_or("fine, warning or alarm")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_places_are_indices() {
        for (place, watch) in Watch::ALL.into_iter().enumerate() {
            assert_eq!((watch.name().parse(), watch as usize), (Ok(watch), place));
        }
        for level in [Level::Fine, Level::Warning, Level::Alarm] {
            assert_eq!(level.name().parse(), Ok(level));
        }
        assert!("speed".parse::<Watch>().is_err() && "bad".parse::<Level>().is_err());
    }
}
