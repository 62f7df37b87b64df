//! The question that stands before every change of a running machine: would a stable rotor lose its stability by it?
//!
//! Whoever changes settings asks it here, a dashboard before it asks the person and the command line before it refuses,
//! so that both judge alike. A rotor that is not stable to begin with cannot lose what it has not.

use std::fmt;

use rotor::{Rotor, Settings, Standing};

use crate::MachinePoles;

/// A stable rotor would not be stable any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The minimum damping ratio now: more than 0.
    pub now: f64,
    /// The minimum damping ratio after the change: 0 or less.
    pub then: f64,
    /// How it would stand after the change: not stable.
    pub standing: Standing,
}

impl StabilityLoss {
    /// What a change from `now` to `then` takes from `rotor`, both without deadband. `None` if it leaves a stable rotor
    /// stable, if it was not stable before, and for settings that do not fit it or whose poles cannot be computed, which
    /// others refuse.
    #[must_use]
    pub fn between(rotor: &Rotor, now: &Settings, then: &Settings) -> Option<Self> {
        let (standing, then) = judged(rotor, then).filter(|(standing, _)| *standing != Standing::Stable)?;
        let (_, now) = judged(rotor, now).filter(|(standing, _)| *standing == Standing::Stable)?;
        Some(Self { now, then, standing })
    }
}

/// How the rotor stands, and its minimum damping.
fn judged(rotor: &Rotor, settings: &Settings) -> Option<(Standing, f64)> {
    settings.check(rotor).ok()?;
    let poles = MachinePoles::of(rotor, settings).ok()?;
    poles.modes.first().map(|mode| (mode.standing(), mode.damping()))
}

impl fmt::Display for StabilityLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { now, then, standing } = self;
        write!(f, "it would make a stable machine {standing}: minimum damping {now:.6} now, {then:.6} then")
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn what_was_stable_is_lost_by_gains_and_by_speed_and_what_was_not_is_not() {
        let rotor = builtin::rotor("three-mass").expect("there is");
        let composite = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").expect("there is"));
        let off = Settings { feedback: composite.feedback.off(), ..composite.clone() };
        let loss = StabilityLoss::between(&rotor, &composite, &off).expect("there is");
        assert!(loss.now > 0.0 && loss.then < 0.0, "{loss:?}");
        let told = loss.to_string();
        assert!(told.starts_with("it would make a stable machine unstable: minimum damping 0."), "{told}");
        assert!(told.contains(" now, -0.") && told.ends_with(" then"), "{told}");
        // By speed alone, too: without control the rotor is stable at rest.
        let slow = Settings { speed: 1.0, ..off.clone() };
        assert!(StabilityLoss::between(&rotor, &slow, &off).is_some());
        for (now, then) in [(&off, &composite), (&off, &off), (&composite, &composite)] {
            assert_eq!(StabilityLoss::between(&rotor, now, then), None);
        }
        let foreign = Settings { deadband: vec![1.0], ..off.clone() };
        assert_eq!(StabilityLoss::between(&rotor, &composite, &foreign), None);
    }

    #[test]
    fn a_machine_at_its_limit_is_not_stable() {
        let told = StabilityLoss { now: 0.25, then: 0.0, standing: Standing::Marginal }.to_string();
        assert!(told.starts_with("it would make a stable machine marginal: minimum damping 0.25"), "{told}");
    }
}
