//! The limits that alarms are held against.

use super::{Level, Watch};
use crate::theme::MARGINAL_DAMPING;

/// The share of a limit by which a value must come back.
const MARGIN: f64 = 0.05;

/// Two limits of one value, and the margin by which it must come back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    /// From here on it is a warning.
    pub(crate) warning: f64,
    /// From here on it is an alarm.
    pub(crate) alarm: f64,
    /// By how much it must come back to count as within.
    pub(crate) margin: f64,
    /// Whether little of it is bad, as of damping.
    pub(crate) below: bool,
}

impl Limit {
    /// Bad is what is above.
    pub(crate) fn above(warning: f64, alarm: f64) -> Self {
        Self { warning, alarm, margin: MARGIN * warning.abs().min(alarm.abs()), below: false }
    }

    /// Bad is what is at or below.
    pub(crate) fn below(warning: f64, alarm: f64, margin: f64) -> Self {
        Self { warning, alarm, margin, below: true }
    }

    /// The limit of a level.
    pub(crate) fn at(&self, level: Level) -> f64 {
        if level == Level::Alarm { self.alarm } else { self.warning }
    }

    /// The level of `value`, if it has been at `before`.
    pub(super) fn level(&self, value: f64, before: Level) -> Level {
        let past = |level: Level| {
            let margin = if before >= level { self.margin } else { 0.0 };
            if self.below { value <= self.at(level) + margin } else { value > self.at(level) - margin }
        };
        [Level::Alarm, Level::Warning].into_iter().find(|level| past(*level)).unwrap_or(Level::Fine)
    }

    pub(super) fn is_worse(&self, value: f64, than: f64) -> bool {
        if self.below { value < than } else { value > than }
    }
}

/// All limits, and whether alarms ring.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limits {
    /// Damping ratio. The default warns below a log decrement of 0.1, and alarms where the rotor is unstable.
    pub(crate) damping: Option<Limit>,
    /// Orbit radius in `e_t`: none until somebody says what the machine bears.
    pub(crate) orbit: Option<Limit>,
    /// Control in `m_b w0^2 e_t`: likewise.
    pub(crate) force: Option<Limit>,
    /// Share of steps at the control bearing's limit.
    pub(crate) saturation: Option<Limit>,
    /// Share of steps sent late or given up.
    pub(crate) lateness: Option<Limit>,
    /// Steps lost to us in the last ten seconds.
    pub(crate) losses: Option<Limit>,
    /// Whether the terminal's bell rings.
    pub(crate) bell: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            damping: Some(Limit::below(MARGINAL_DAMPING, 0.0, 0.0005)),
            orbit: None,
            force: None,
            saturation: Some(Limit::above(0.0, 0.1)),
            lateness: Some(Limit::above(0.01, 0.1)),
            losses: Some(Limit::above(0.0, 1000.0)),
            bell: false,
        }
    }
}

impl Limits {
    /// The limit of what is watched, if it has one.
    pub(crate) fn of(&self, watch: Watch) -> Option<Limit> {
        match watch {
            Watch::Damping => self.damping,
            Watch::Orbit => self.orbit,
            Watch::Force => self.force,
            Watch::Saturation => self.saturation,
            Watch::Lateness => self.lateness,
            Watch::Losses => self.losses,
            // A machine trips or does not, and that is always an alarm.
            Watch::Trip => Some(Limit { warning: 0.5, alarm: 0.5, margin: 0.0, below: false }),
        }
    }
}
