//! What would be: the poles under settings that are not in force yet.

use machine::{MachinePoles, Pace, Program, ProgramError};
use rotor::{C64, Rotor, Settings};

/// Candidate settings and what follows from them.
#[derive(Clone, Debug, PartialEq)]
pub struct WhatIf {
    /// The settings that would be in force.
    pub settings: Settings,
    /// Their poles, least damped first.
    pub poles: Vec<C64>,
    /// The smallest damping ratio, of the modes that count.
    pub min_damping: f64,
    /// Why the bench would not take them, as far as that is known.
    pub refusal: Option<ProgramError>,
}

impl WhatIf {
    /// What `settings` would mean for `rotor`; nothing if they do not fit it, or have no poles that can be computed.
    pub fn of(rotor: &Rotor, settings: Settings) -> Option<Self> {
        settings.check(rotor).ok()?;
        let found = MachinePoles::of(rotor, &settings).ok().filter(|found| !found.modes.is_empty())?;
        let min_damping = found.counted_damping(rotor, settings.speed);
        let poles = found.modes.iter().map(|mode| mode.pole).collect();
        Some(Self { settings, poles, min_damping, refusal: None })
    }

    /// The same on a bench that makes steps of `dtau`, so many a second.
    pub fn on(mut self, rotor: &Rotor, dtau: f64, rate_hz: f64) -> Self {
        self.refusal = Program::compile(rotor, &self.settings, [self.settings.speed; 2], Pace { dtau, rate_hz }).err();
        self
    }

    /// Whether the rotor would not be stable: a mode grows, or is marginal.
    pub fn is_unstable(&self) -> bool {
        self.min_damping <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;
    use rotor::step::StepError;

    use super::*;

    #[test]
    fn the_candidate_is_what_the_simulation_would_say_of_it() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let bench_status = crate::test_support::bench_status("three-mass", "composite");
        let settings = bench_status.settings.get().clone();
        let same = WhatIf::of(&rotor, settings.clone()).unwrap();
        let told: Vec<C64> = bench_status.analysis.poles().collect();
        assert!(same.poles.iter().zip(&told).all(|(a, b)| (a - b).norm() < 1e-12), "{same:?}");
        assert!((same.min_damping - bench_status.analysis.min_damping).abs() < 1e-12 && !same.is_unstable());
        let off = Settings { feedback: settings.feedback.off(), ..settings.clone() };
        assert!(WhatIf::of(&rotor, off).unwrap().is_unstable());
        assert_eq!(same.on(&rotor, 0.01, 1000.0).refusal, None);
        let mut heavy = settings.clone();
        heavy.assign("cd", "1e6").unwrap();
        let heavy = WhatIf::of(&rotor, heavy).unwrap().on(&rotor, 0.01, 1000.0);
        assert!(matches!(heavy.refusal, Some(ProgramError::Step(StepError::TooLong(_)))), "{heavy:?}");
        let foreign = Settings { deadband: vec![1.0], ..settings };
        assert_eq!(WhatIf::of(&rotor, foreign), None);
    }
}
