//! What the clearances of the support bearings make of gains that are stable at the centre: the damping that is left whatever part of its
//! stiffness each bearing gives, and the whirl that the rotor can stay on. Exact, at one speed.

use std::sync::Arc;

use rotor::circular::{self, CircularError, Orbit};
use rotor::{Rotor, Settings};
use tuner::Stop;

use crate::comparison::{has_deadband, worst_deadband};
use crate::history::Era;

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct DeadbandRequest {
    rotor: Arc<Rotor>,
    /// Nothing but the feedback, the clearances and the speed counts.
    settings: Settings,
}

impl DeadbandRequest {
    /// What to ask about settings in force, at the speed that the machine runs at; nothing without clearances, or as long as the rotor
    /// is not known.
    pub fn of(era: &Era) -> Option<Self> {
        Self::with(era.rotor.clone()?, &Settings { speed: era.speed, ..era.settings.clone() })
    }

    /// The same of other settings, at the speed that they set.
    pub fn with(rotor: Arc<Rotor>, settings: &Settings) -> Option<Self> {
        let bare = Settings::new(&rotor, settings.speed, settings.feedback.clone());
        let settings = Settings { deadband: settings.deadband.clone(), ..bare };
        has_deadband(&settings).then_some(Self { rotor, settings })
    }
}

/// The whirl that a rotor excites by itself and stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitCycle {
    /// The largest distance of any mass from the centre, in `e_t`.
    pub radius: f64,
    /// The frequency in radians per `tau`, negative for backward whirl.
    pub frequency: f64,
}

/// What the clearances do at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct DeadbandEffects {
    /// The smallest damping ratio with any share of its stiffness left to each support bearing; none where there are too many bearings
    /// to look at.
    pub worst: Option<f64>,
    /// The largest stable limit cycle, none if there is none; or why none can be had, or told among larger ones that cannot be judged.
    pub cycle: Result<Option<LimitCycle>, CircularError>,
}

impl DeadbandEffects {
    /// Computes the answer: some milliseconds for three masses.
    pub fn of(request: &DeadbandRequest) -> Self {
        let DeadbandRequest { rotor, settings } = request;
        let Settings { feedback, deadband, speed, .. } = settings;
        let whirl = |orbit: &Orbit| LimitCycle { radius: orbit.largest_radius(), frequency: orbit.frequency };
        let largest = |orbits: Vec<Vec<Orbit>>| {
            Orbit::largest_stable(orbits.iter().flatten()).map(|orbit| orbit.map(whirl)).map_err(Clone::clone)
        };
        Self {
            worst: worst_deadband(rotor, settings, [*speed, *speed], Stop::NEVER),
            cycle: circular::cycles(rotor, feedback, deadband, &[*speed]).and_then(|found| largest(found.orbits)),
        }
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn effects(feedback: &str, speed: f64) -> DeadbandEffects {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let mut settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
        settings.deadband.fill(1.0);
        DeadbandEffects::of(&DeadbandRequest::with(rotor, &settings).unwrap())
    }

    #[test]
    fn val_gains_that_are_stable_at_the_centre_may_whirl_all_the_same() {
        // As `whirl cycles` has them, whose orbits are held against simulations.
        let composite = effects("composite", 2.5);
        let cycle = composite.cycle.unwrap().unwrap();
        assert!((cycle.radius - 1.564_063).abs() < 1e-6 && (cycle.frequency - 0.090_288).abs() < 1e-6, "{cycle:?}");
        assert!(composite.worst.unwrap() < 0.0, "{:?}", composite.worst);
        // Those of the report for any deadband.
        let individual = effects("individual", 2.5);
        assert!(individual.cycle == Ok(None) && individual.worst.unwrap() > 0.033, "{individual:?}");
    }

    #[test]
    fn without_clearances_there_is_nothing_to_ask_and_a_sampled_loop_says_why() {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
        settings.deadband.fill(0.0);
        assert_eq!(DeadbandRequest::with(rotor.clone(), &settings), None);
        settings.deadband.fill(1.0);
        settings.feedback.bearings[0].parts.sample = 0.1;
        let sampled = DeadbandEffects::of(&DeadbandRequest::with(rotor, &settings).unwrap());
        assert_eq!(sampled.cycle, Err(CircularError::Sampled));
    }
}
