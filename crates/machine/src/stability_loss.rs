//! The question that stands before every change of a running machine: would a stable rotor lose its stability by it?
//!
//! Whoever changes settings asks it here, a dashboard before it asks the person and the command line before it refuses,
//! so that both judge alike. A rotor that is not stable to begin with cannot lose what it has not.

use std::fmt;

use rotor::{Rotor, Settings, Stability};

use crate::MachinePoles;

/// A stable rotor would not be stable any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The minimum damping ratio now: more than 0.
    pub now: f64,
    /// The minimum damping ratio after the change: 0 or less.
    pub then: f64,
    /// How it would stand after the change: not stable.
    pub stability: Stability,
}

impl StabilityLoss {
    /// What a change from `now` to `then` takes from `rotor`, both without deadband, while it spins at the speed `present`: that of
    /// the settings, unless it is on its way there. `None` if it leaves a stable rotor
    /// stable, if it was not stable before, and for settings that do not fit it or whose poles cannot be computed, which
    /// others refuse.
    ///
    /// A speed that is on its way is judged where it is and where it goes: a rotor that is stable now, or would have been there, and
    /// would not be any more.
    #[must_use]
    pub fn between(rotor: &Rotor, now: &Settings, then: &Settings, present: f64) -> Option<Self> {
        let at = |settings: &Settings, speed| judged(rotor, &Settings { speed, ..settings.clone() });
        let same_aim = (then.speed, then.ramp) == (now.speed, now.ramp);
        // Where it is, unless it leaves that at once; and where it goes, beside where it would have gone or is.
        let stays = same_aim || then.ramp.is_finite();
        let pairs =
            [stays.then_some((present, present)), Some((if same_aim { now.speed } else { present }, then.speed))];
        let losses = pairs.into_iter().flatten().filter_map(|(before, after)| {
            let (stability, then) = at(then, after).filter(|(stability, _)| *stability != Stability::Stable)?;
            let (_, now) = at(now, before).filter(|(stability, _)| *stability == Stability::Stable)?;
            Some(Self { now, then, stability })
        });
        losses.min_by(|a, b| a.then.total_cmp(&b.then))
    }
}

/// How the rotor stands, and its minimum damping.
fn judged(rotor: &Rotor, settings: &Settings) -> Option<(Stability, f64)> {
    settings.check(rotor).ok()?;
    let poles = MachinePoles::of(rotor, settings).ok()?;
    poles.modes.first().map(|mode| (mode.stability(), mode.damping()))
}

impl fmt::Display for StabilityLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { now, then, stability } = self;
        write!(f, "it would make a stable machine {stability}: minimum damping {now:.6} now, {then:.6} then")
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
        let loss = StabilityLoss::between(&rotor, &composite, &off, 2.5).expect("there is");
        assert!(loss.now > 0.0 && loss.then < 0.0, "{loss:?}");
        let told = loss.to_string();
        assert!(told.starts_with("it would make a stable machine unstable: minimum damping 0."), "{told}");
        assert!(told.contains(" now, -0.") && told.ends_with(" then"), "{told}");
        // By speed alone, too: without control the rotor is stable at rest.
        let slow = Settings { speed: 1.0, ..off.clone() };
        assert!(StabilityLoss::between(&rotor, &slow, &off, 1.0).is_some());
        for (now, then) in [(&off, &composite), (&off, &off), (&composite, &composite)] {
            assert_eq!(StabilityLoss::between(&rotor, now, then, 2.5), None);
        }
        let foreign = Settings { deadband: vec![1.0], ..off.clone() };
        assert_eq!(StabilityLoss::between(&rotor, &composite, &foreign, 2.5), None);
    }

    #[test]
    fn a_speed_on_its_way_is_judged_where_it_is_and_where_it_goes() {
        // On its way down from 4 to rest: at rest it is stable without control, where it is it is not.
        let rotor = builtin::rotor("three-mass").expect("there is");
        let individual = builtin::feedback(&rotor, "individual").expect("there is");
        let down = Settings { ramp: 0.02, ..Settings::new(&rotor, 0.0, individual) };
        let off = Settings { feedback: down.feedback.off(), ..down.clone() };
        let loss = StabilityLoss::between(&rotor, &down, &off, 3.9).expect("there is");
        assert!(loss.now > 0.0 && loss.then < -0.08, "{loss:?}");
        assert_eq!(StabilityLoss::between(&rotor, &down, &off, 1.0), None);
        // The same of a profile, whose ramp is not among the settings.
        let [down, off] = [down, off].map(|settings| Settings { ramp: f64::INFINITY, ..settings });
        assert!(StabilityLoss::between(&rotor, &down, &off, 3.9).is_some());
        // On its way up through speeds at which it is stable, to one at which it will not be, whatever the gain: not by this.
        let up = Settings { speed: 4.0, ramp: 0.02, ..off.clone() };
        let nudged = Settings { trip: 500.0, ..up.clone() };
        assert_eq!(StabilityLoss::between(&rotor, &up, &nudged, 1.0), None);
        // Sent there: asked.
        let resting = Settings { speed: 1.0, ..off };
        assert!(StabilityLoss::between(&rotor, &resting, &up, 1.0).is_some());
        // Stopped at once where it is stable, while it was not: fine.
        let stop = Settings { speed: 1.0, ramp: f64::INFINITY, ..up.clone() };
        assert_eq!(StabilityLoss::between(&rotor, &up, &stop, 3.0), None);
    }

    #[test]
    fn a_machine_at_its_limit_is_not_stable() {
        let told = StabilityLoss { now: 0.25, then: 0.0, stability: Stability::Marginal }.to_string();
        assert!(told.starts_with("it would make a stable machine marginal: minimum damping 0.25"), "{told}");
    }
}
