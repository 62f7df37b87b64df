//! The question that stands before every change of a running machine: would a stable rotor lose its stability by it?
//!
//! Whoever changes settings asks it here, a dashboard before it asks the person and the command line before it refuses,
//! so that both judge alike. A rotor that is not stable to begin with cannot lose what it has not.

use std::fmt;

use control::Parts;
use rotor::{Rotor, Settings, Stability};

use crate::MachinePoles;

/// A machine would not be stable any more, as far as can be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The minimum damping ratio now, more than 0; `None` where the poles of the present settings cannot be computed.
    pub now: Option<f64>,
    /// How it would stand after the change, with its minimum damping ratio: not stable; `None` where its poles could not be computed.
    pub then: Option<(Stability, f64)>,
}

/// How a machine stands.
#[derive(Clone, Copy)]
enum Judged {
    /// With its minimum damping.
    Known(Stability, f64),
    /// Its poles cannot be computed: of amplifiers that act along their axes differently, or of a delay with too many.
    Unknown,
    /// The settings do not fit, which others refuse.
    Unfit,
}

impl StabilityLoss {
    /// What a change from `now` to `then` takes from `rotor`, both without deadband, while it spins at the speed `present`: that of
    /// the settings, unless it is on its way there. `None` if it leaves a stable rotor stable, if it was not stable before, and for
    /// settings that do not fit it, which others refuse. Where poles cannot be computed nothing is taken for granted: a change from what
    /// is stable to what nobody can judge is a loss, and so is one to what is not stable from what could not be judged.
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
            let then = match at(then, after) {
                Judged::Known(Stability::Stable, _) | Judged::Unfit => return None,
                Judged::Known(stability, damping) => Some((stability, damping)),
                Judged::Unknown => None,
            };
            match (at(now, before), then) {
                (Judged::Known(Stability::Stable, damping), then) => Some(Self { now: Some(damping), then }),
                (Judged::Unknown, Some(then)) => Some(Self { now: None, then: Some(then) }),
                _ => None,
            }
        });
        losses.min_by(|a, b| a.then_damping().total_cmp(&b.then_damping()))
    }

    /// What is not known counts for less than what is.
    fn then_damping(&self) -> f64 {
        self.then.map_or(f64::INFINITY, |(_, damping)| damping)
    }
}

fn judged(rotor: &Rotor, settings: &Settings) -> Judged {
    if settings.check(rotor).is_err() {
        return Judged::Unfit;
    }
    let mut settings = settings.clone();
    if settings.feedback.is_off() {
        // What nothing is asked of takes no part, whatever is amiss with it.
        settings.feedback = settings.feedback.with_parts(Parts::default());
    }
    let poles = MachinePoles::of(rotor, &settings).ok();
    let least = poles.as_ref().and_then(|poles| poles.modes.first());
    least.map_or(Judged::Unknown, |mode| Judged::Known(mode.stability(), mode.damping()))
}

impl fmt::Display for StabilityLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.now, self.then) {
            (Some(now), Some((stability, then))) => {
                write!(f, "it would make a stable machine {stability}: minimum damping {now:.6} now, {then:.6} then")
            }
            (None, Some((stability, then))) => {
                write!(f, "the machine would be {stability}: minimum damping {then:.6} then, not known now")
            }
            (_, None) => {
                write!(f, "whether a stable machine stays stable cannot be told: its poles cannot be computed then")
            }
        }
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
        assert!(loss.now.unwrap() > 0.0 && loss.then.unwrap().1 < 0.0, "{loss:?}");
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
        assert!(loss.now.unwrap() > 0.0 && loss.then.unwrap().1 < -0.08, "{loss:?}");
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
        let told = StabilityLoss { now: Some(0.25), then: Some((Stability::Marginal, 0.0)) }.to_string();
        assert!(told.starts_with("it would make a stable machine marginal: minimum damping 0.25"), "{told}");
    }

    #[test]
    fn regress_what_cannot_be_judged_is_asked_about() {
        let rotor = builtin::rotor("three-mass").expect("there is");
        let held = Settings::new(&rotor, 4.0, builtin::feedback(&rotor, "individual").expect("there is"));
        // Amplifiers that differ have no complex form, and so no poles.
        let mut lost = held.clone();
        lost.feedback.first_mut().parts.amplifier_y = 0.0;
        let loss = StabilityLoss::between(&rotor, &held, &lost, 4.0).expect("asked");
        assert!(loss.now.is_some() && loss.then.is_none());
        assert!(loss.to_string().contains("cannot be told"), "{loss}");
        // From there to nothing at all, which is unstable at this speed, too.
        let off = Settings { feedback: lost.feedback.off(), ..lost.clone() };
        let loss = StabilityLoss::between(&rotor, &lost, &off, 4.0).expect("asked");
        assert!(loss.now.is_none() && loss.then.expect("known").1 < 0.0);
        assert!(loss.to_string().ends_with("then, not known now"), "{loss}");
        // But not for putting it back, nor for what is as little known.
        assert_eq!(StabilityLoss::between(&rotor, &lost, &held, 4.0), None);
        let mut nudged = lost.clone();
        nudged.trip = 50.0;
        assert_eq!(StabilityLoss::between(&rotor, &lost, &nudged, 4.0), None);
    }
}
