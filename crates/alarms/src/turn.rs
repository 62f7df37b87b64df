//! A crossing of a limit, either way.

use std::fmt;

use text::number::trimmed;
use wire::Moment;

use crate::{Level, Watch};

/// Something went from one level to another.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelChange {
    /// When: the step whose value that is.
    pub at: Moment,
    /// What.
    pub watch: Watch,
    /// The level it was at.
    pub before: Level,
    /// The level it is at from here on.
    pub level: Level,
    /// The value with which it crossed.
    pub value: f64,
    /// The limit that it crossed: that of the worse of the two levels.
    pub limit: f64,
    /// The worst value since it rose.
    pub worst: f64,
    /// Why, where there is more to say than the value.
    pub cause: String,
}

impl LevelChange {
    /// Whether it is worse than before.
    #[must_use]
    pub fn rises(&self) -> bool {
        self.level > self.before
    }
}

impl fmt::Display for LevelChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { watch, level, value, limit, worst, cause, .. } = self;
        let unit = if *watch == Watch::Orbit { " e_t" } else { "" };
        let (value, limit, worst) = (trimmed(*value, 4), trimmed(*limit, 4), trimmed(*worst, 4));
        match (level, self.rises()) {
            (Level::Fine, _) => write!(f, "{watch} within its limits again: {value}{unit}, at worst {worst}"),
            (_, true) if !cause.is_empty() => write!(f, "{}: {watch}, {cause}", level.name()),
            (_, true) => write!(f, "{}: {watch} {value}{unit}, limit {limit}", level.name()),
            (_, false) => write!(f, "{watch} back to a {}: {value}{unit}, limit {limit}", level.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_told_in_a_line() {
        let turn = |before, level, value, limit| LevelChange {
            at: Moment::default(),
            watch: Watch::Damping,
            before,
            level,
            value,
            limit,
            worst: -0.03,
            cause: String::new(),
        };
        use Level::{Alarm, Fine, Warning};
        for (turn, text) in [
            (turn(Fine, Alarm, -0.030_561, 0.0), "alarm: damping -0.03056, limit 0"),
            (turn(Alarm, Warning, 0.01, 0.0), "damping back to a warning: 0.01, limit 0"),
            (turn(Warning, Fine, 0.05, 0.0159), "damping within its limits again: 0.05, at worst -0.03"),
            (
                LevelChange { watch: Watch::Orbit, ..turn(Fine, Warning, 1234.567, 20.0) },
                "warning: orbit 1235 e_t, limit 20",
            ),
            (
                LevelChange { watch: Watch::Trip, cause: "orbit of mass 2".into(), ..turn(Fine, Alarm, 1.0, 0.5) },
                "alarm: trip, orbit of mass 2",
            ),
        ] {
            assert_eq!(turn.to_string(), text);
        }
    }
}
