//! The limits that alarms are held against.

use rotor::{ControlMasses, MAX_BEARINGS};
use wire::BenchStatus;

use crate::{Level, Reading, Sample, Watch, usual};

/// Damping ratio below which a rotor is stable but only just: API 684 asks for a log decrement of 0.1, which is this.
pub const LOW_DAMPING: f64 = 0.0159;

/// The share of a limit by which a value must come back.
const MARGIN: f64 = 0.05;
/// Margin by which a damping ratio must come back.
const DAMPING_MARGIN: f64 = 0.0005;
/// The share of a limit by which shares and counts over a stretch of time must come back: they tremble by themselves.
const COUNT_MARGIN: f64 = 0.5;

/// Two limits of one value, and the margin by which it must come back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// From here on it is a warning.
    pub warning: f64,
    /// From here on it is an alarm.
    pub alarm: f64,
    /// By how much it must come back to count as within.
    pub margin: f64,
    /// Whether little of it is bad, as of damping.
    pub below: bool,
}

impl Limit {
    /// Bad is what is above.
    #[must_use]
    pub fn above(warning: f64, alarm: f64) -> Self {
        Self { warning, alarm, margin: MARGIN * warning.abs().min(alarm.abs()), below: false }
    }

    /// Bad is what is at or below.
    #[must_use]
    pub fn below(warning: f64, alarm: f64, margin: f64) -> Self {
        Self { warning, alarm, margin, below: true }
    }

    /// The limits of something, warning and alarm, with the margin that goes with it.
    fn of(watch: Watch, [warning, alarm]: [f64; 2]) -> Self {
        let margin = match watch {
            Watch::Damping => DAMPING_MARGIN,
            Watch::Saturation | Watch::Lateness | Watch::Losses => COUNT_MARGIN * warning.abs(),
            _ if watch.is_bad_below() => MARGIN * warning.abs(),
            _ => return Self::above(warning, alarm),
        };
        Self { warning, alarm, margin, below: watch.is_bad_below() }
    }

    /// The limit of a level.
    #[must_use]
    pub fn at(&self, level: Level) -> f64 {
        if level == Level::Alarm { self.alarm } else { self.warning }
    }

    /// The level of `value`, if it has been at `before`.
    pub(crate) fn level(&self, value: f64, before: Level) -> Level {
        let past = |level: Level| {
            let margin = if before >= level { self.margin } else { 0.0 };
            if self.below { value <= self.at(level) + margin } else { value > self.at(level) - margin }
        };
        [Level::Alarm, Level::Warning].into_iter().find(|level| past(*level)).unwrap_or(Level::Fine)
    }

    pub(crate) fn is_worse(&self, value: f64, than: f64) -> bool {
        if self.below { value < than } else { value > than }
    }
}

/// What a person asks for as limits of something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AskedLimit {
    /// None.
    Off,
    /// Those that follow the machine.
    Machine,
    /// Warning and alarm.
    Pair([f64; 2]),
}

impl AskedLimit {
    /// Makes them the limits of something.
    ///
    /// # Errors
    /// Something that has no such limits, or numbers that are not in order.
    pub fn set(self, limits: &mut Limits, watch: Watch) -> Result<(), LimitsError> {
        match self {
            Self::Off => limits.set(watch, None),
            Self::Pair(pair) => limits.set(watch, Some(pair)),
            Self::Machine if !watch.can_follow() => Err(LimitsError::NotOfMachine),
            Self::Machine => {
                *limits = limits.clone().following(watch);
                Ok(())
            }
        }
    }
}

/// Why limits are none. In words it is what was expected instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LimitsError {
    /// There is nothing to limit.
    #[error("something that has limits: a trip is always an alarm")]
    None,
    /// Nothing of the machine says what it bears.
    #[error("a limit of its own: only orbit and force follow the machine")]
    NotOfMachine,
    /// A limit is infinite or no number.
    #[error("finite numbers")]
    NotFinite,
    /// What is to be large would rise to an alarm before it warns.
    #[error("the alarm at or below the warning")]
    AlarmAbove,
    /// What is to be small would warn after it has risen to an alarm.
    #[error("the alarm at or above the warning")]
    AlarmBelow,
}

/// Where the limit of something comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there are a dozen of them, and copies need no memory")]
enum Rule {
    /// It has none.
    None,
    /// Somebody has set it.
    Set(Limit),
    /// It follows the machine; none as long as that is not known, or sets none. Of the force one a control bearing, of all else the
    /// first.
    Machine([Option<Limit>; MAX_BEARINGS]),
}

/// The limits of everything that is watched. What has none is never alarmed.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits([Rule; Watch::COUNT]);

impl Default for Limits {
    /// Damping: a warning below a log decrement of 0.1, an alarm where the rotor is unstable. Sensitivity: a warning from zone C of
    /// ISO 14839-3 on, in which a machine is not to run for long, an alarm from zone D on. Orbit and force follow the machine
    /// ([`Limits::follow`]) until somebody says what it bears. Delay margin: none.
    fn default() -> Self {
        Self::none()
            .having(Watch::Damping, Limit::below(LOW_DAMPING, 0.0, DAMPING_MARGIN))
            .having(Watch::Sensitivity, Limit::above(4.0, 5.0))
            .having(Watch::Saturation, Limit::of(Watch::Saturation, [0.0, 0.1]))
            .having(Watch::Lateness, Limit::of(Watch::Lateness, [0.01, 0.1]))
            .having(Watch::Losses, Limit::of(Watch::Losses, [0.0, 1000.0]))
            .following(Watch::Orbit)
            .following(Watch::Force)
    }
}

impl Limits {
    /// Nothing is an alarm but a trip.
    #[must_use]
    pub fn none() -> Self {
        let mut limits = [Rule::None; Watch::COUNT];
        limits[Watch::Trip as usize] = Rule::Set(Limit { warning: 0.5, alarm: 0.5, margin: 0.0, below: false });
        Self(limits)
    }

    /// The same with another limit.
    #[must_use]
    pub fn having(mut self, watch: Watch, limit: Limit) -> Self {
        self.0[watch as usize] = Rule::Set(limit);
        self
    }

    /// The same with the limit of something that follows the machine, if there is such a limit of it.
    #[must_use]
    pub fn following(mut self, watch: Watch) -> Self {
        if watch.can_follow() {
            self.0[watch as usize] = Rule::Machine([None; MAX_BEARINGS]);
        }
        self
    }

    /// Whether the limit of something follows the machine.
    #[must_use]
    pub fn follows(&self, watch: Watch) -> bool {
        matches!(self.0[watch as usize], Rule::Machine(_))
    }

    /// Takes the machine as a bench tells of it: limits that follow it are those of its settings, at the highest speed that it has or goes
    /// to.
    pub fn follow(&mut self, bench_status: &BenchStatus) {
        let settings = bench_status.settings.get();
        let speed = settings.speed.max(bench_status.analysis.speed);
        let rotor = bench_status.rotor_document();
        let masses = rotor.map(|rotor| ControlMasses::of(rotor.get(), &settings.feedback)).unwrap_or_default();
        let beam = rotor.and_then(|rotor| rotor.get().beam());
        let touchdown: Vec<usize> = beam.map(|beam| beam.touchdown().collect()).unwrap_or_default();
        for watch in Watch::ALL {
            let Rule::Machine(limits) = &mut self.0[watch as usize] else { continue };
            let mut pairs = [None; MAX_BEARINGS];
            match watch {
                Watch::Orbit => pairs[0] = usual::orbit(settings, &touchdown),
                Watch::Force => pairs = usual::forces(settings, &touchdown, speed, &masses),
                _ => {}
            }
            *limits = pairs.map(|pair| pair.map(|pair| Limit::of(watch, pair)));
        }
    }

    /// The limit of something, if it has one; of several control bearings the least.
    #[must_use]
    pub fn of(&self, watch: Watch) -> Option<Limit> {
        match self.0[watch as usize] {
            Rule::None => None,
            Rule::Set(limit) => Some(limit),
            Rule::Machine(limits) => limits.into_iter().flatten().min_by(|a, b| a.warning.total_cmp(&b.warning)),
        }
    }

    /// The limit of the force of a control bearing, counted from 0, as that of the first.
    #[must_use]
    pub fn of_bearing(&self, bearing: usize) -> Option<Limit> {
        match self.0[Watch::Force as usize] {
            Rule::Machine(limits) => limits.get(bearing).copied().flatten(),
            _ => self.of(Watch::Force),
        }
    }

    /// What of a reading is to be held against the limit of something, and that limit: of several control bearings the force that is
    /// nearest to its own.
    pub(crate) fn held(&self, reading: &Reading, watch: Watch) -> Option<(Sample, Option<Limit>)> {
        let known = (reading.get(watch)?, self.of(watch));
        let Rule::Machine(_) = self.0[watch as usize] else { return Some(known) };
        let forces = reading.forces().iter().enumerate().filter(|_| watch == Watch::Force);
        let own = forces.filter_map(|(bearing, sample)| Some(((*sample)?, self.of_bearing(bearing)?)));
        let share = |(sample, limit): &(Sample, Limit)| sample.value / limit.warning;
        let hardest = own.max_by(|a, b| share(a).total_cmp(&share(b)));
        Some(hardest.map_or(known, |(sample, limit)| (sample, Some(limit))))
    }

    /// The same, its warning and its alarm.
    #[must_use]
    pub fn pair(&self, watch: Watch) -> Option<[f64; 2]> {
        self.of(watch).map(|limit| [limit.warning, limit.alarm])
    }

    /// Sets the limits of something, warning and alarm, or takes them away.
    ///
    /// # Errors
    /// Something that has no limits, or numbers that are not in order.
    pub fn set(&mut self, watch: Watch, limits: Option<[f64; 2]>) -> Result<(), LimitsError> {
        let below = watch.is_bad_below();
        let limit = match limits {
            _ if !watch.has_limits() => return Err(LimitsError::None),
            None => None,
            Some(pair) if !pair.iter().all(|limit| limit.is_finite()) => return Err(LimitsError::NotFinite),
            Some(pair) if below && pair[0] >= pair[1] => Some(Limit::of(watch, pair)),
            Some(pair) if !below && pair[0] <= pair[1] => Some(Limit::of(watch, pair)),
            Some(_) if below => return Err(LimitsError::AlarmAbove),
            Some(_) => return Err(LimitsError::AlarmBelow),
        };
        self.0[watch as usize] = limit.map_or(Rule::None, Rule::Set);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_set_in_order_and_a_trip_has_none_to_set() {
        let mut limits = Limits::none();
        for watch in Watch::ALL.into_iter().filter(|watch| watch.has_limits()) {
            assert_eq!(limits.pair(watch), None);
            let pair = if watch.is_bad_below() { [0.2, 0.1] } else { [0.1, 0.2] };
            limits.set(watch, Some(pair)).unwrap();
            assert_eq!(limits.pair(watch), Some(pair));
            let [warning, alarm] = pair;
            assert!(limits.set(watch, Some([alarm, warning])).is_err(), "{watch}");
            assert!(limits.set(watch, Some([0.1, f64::NAN])).is_err(), "{watch}");
            assert_eq!(limits.pair(watch), Some(pair), "what is refused changes nothing");
        }
        assert!(limits.set(Watch::Trip, None).is_err() && limits.of(Watch::Trip).is_some());
        limits.set(Watch::Orbit, None).unwrap();
        assert_eq!(limits.of(Watch::Orbit), None);
    }
}
