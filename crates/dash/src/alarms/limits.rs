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
pub struct Limits {
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
            damping: Some(Limit::below(MARGINAL_DAMPING, 0.0, DAMPING_MARGIN)),
            orbit: None,
            force: None,
            saturation: Some(Limit::above(0.0, 0.1)),
            lateness: Some(Limit::above(0.01, 0.1)),
            losses: Some(Limit::above(0.0, 1000.0)),
            bell: false,
        }
    }
}

/// Margin by which a damping ratio must come back.
const DAMPING_MARGIN: f64 = 0.0005;

impl Limits {
    /// What is watched, by the names of the configuration, with the meaning and the unit of its limits.
    pub(crate) const KEYS: [(&str, &str); 6] = [
        ("damping", "smallest damping ratio of any mode"),
        ("orbit", "largest radius of any mass, in e_t"),
        ("force", "largest control, in m_b w0^2 e_t"),
        ("saturation", "share of steps with the control bearing at its limit"),
        ("lateness", "share of steps of the last ten seconds that were late or given up"),
        ("losses", "steps of the last ten seconds that did not reach the dashboard"),
    ];

    fn place(&mut self, key: &str) -> Option<&mut Option<Limit>> {
        Some(match key {
            "damping" => &mut self.damping,
            "orbit" => &mut self.orbit,
            "force" => &mut self.force,
            "saturation" => &mut self.saturation,
            "lateness" => &mut self.lateness,
            "losses" => &mut self.losses,
            _ => return None,
        })
    }

    /// The limits of `key`, warning and alarm; `None` if there are none.
    pub(crate) fn get(&self, key: &str) -> Option<[f64; 2]> {
        let mut all = self.clone();
        all.place(key)?.map(|limit| [limit.warning, limit.alarm])
    }

    /// Sets the limits of `key`, or takes them away.
    ///
    /// # Errors
    /// What was expected instead: another key, or numbers in order.
    pub(crate) fn set(&mut self, key: &str, limits: Option<[f64; 2]>) -> Result<(), &'static str> {
        let below = key == "damping";
        let place = self.place(key).ok_or("bell, damping, orbit, force, saturation, lateness or losses")?;
        *place = match limits {
            None => None,
            Some(pair) if !pair.iter().all(|limit| limit.is_finite()) => return Err("finite numbers"),
            Some([warning, alarm]) if below && warning >= alarm => Some(Limit::below(warning, alarm, DAMPING_MARGIN)),
            Some([warning, alarm]) if !below && warning <= alarm => Some(Limit::above(warning, alarm)),
            Some(_) if below => return Err("the alarm at or below the warning"),
            Some(_) => return Err("the alarm at or above the warning"),
        };
        Ok(())
    }

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
