//! Poles of a machine as it is: ideal, with states of its own in the loop, late, or sampled.
//!
//! * An ideal loop has the rotor's own `2n` poles, by the fast path of crate `rotor`.
//! * A continuous loop has those of the joined matrix; with a delay, infinitely many: all right of a stated line are given,
//!   proven complete by crate `linear`.
//! * A sampled loop has poles `z` of the step from one sample to the next; `s = ln(z) / h` says how fast they decay and turn.

use linear::DelayError;
use nalgebra::DVector;
use rotor::{
    C64, Characteristic, ClosedLoop, LinearForm, Mode, Modes, OperatingPoint, Plant, PoleError, Rotor, Settings,
    damping_ratio,
};

use crate::counted_modes::CountedModes;

/// Why there are no poles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PolesError {
    /// The loop does not fit the rotor.
    #[error(transparent)]
    Feedback(#[from] control::FeedbackError),
    /// Eigenvalues that cannot be had.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// Roots that cannot be had, all of them.
    #[error(transparent)]
    Roots(#[from] DelayError),
    /// Orbits that cannot be had.
    #[error(transparent)]
    Orbits(#[from] rotor::circular::CircularError),
}

/// The poles of a machine at one speed, every support bearing at its full stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct MachinePoles {
    /// The modes, least damped first; shapes are displacements of the masses.
    pub modes: Vec<Mode>,
    /// Of a sampled loop, the pole `z` of each mode.
    pub z: Option<Vec<C64>>,
    /// The line right of which all poles are here, where there are infinitely many.
    pub right_of: Option<f64>,
}

impl MachinePoles {
    /// The poles of `rotor` under `settings`, at their speed.
    ///
    /// # Errors
    /// A loop that does not fit, or poles that cannot be had.
    pub fn of(rotor: &Rotor, settings: &Settings) -> Result<Self, PolesError> {
        Self::at(rotor, settings, settings.speed)
    }

    /// The same at another speed.
    ///
    /// # Errors
    /// A loop that does not fit, or poles that cannot be had.
    pub fn at(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<Self, PolesError> {
        let feedback = &settings.feedback;
        if ClosedLoop::describes(rotor, feedback) {
            let closed_loop = ClosedLoop::new(rotor, feedback, speed, &settings.deadband);
            return Ok(Self { modes: Modes::of(&closed_loop)?.modes, z: None, right_of: None });
        }
        let plant = Plant::of(rotor);
        let form = LinearForm::of(&plant, feedback, &OperatingPoint::at(speed))?;
        let machine = Characteristic::of(&form)?;
        let n = form.coordinates;
        // At a double pole there is no telling one motion as a whole from another: each gets its own, at rest and in drift.
        let mut free = plant.free().iter().cycle();
        let mut mode = |pole: C64, root: C64, motion: Option<DVector<C64>>| {
            let read = |state: &[C64]| plant.stations().iter().map(|station| station.row.read(&state[..n])).collect();
            let as_a_whole = if pole == C64::ZERO { free.next() } else { None };
            let mut shape: Vec<C64> = match as_a_whole {
                Some(motion) => read(motion),
                None => {
                    let state = motion.or_else(|| Some(machine.system().sensitivity(root)?.right));
                    state.map_or_else(Vec::new, |state| read(state.as_slice()))
                }
            };
            rotor::scale_to_largest(&mut shape);
            Mode { pole, shape }
        };
        let roots = machine.roots()?;
        let motions = machine.system().motions(&roots.iter().map(|root| root.root).collect::<Vec<_>>());
        let motions = motions.unwrap_or_else(|| vec![None; roots.len()]);
        let both = roots.iter().zip(motions);
        let mut modes: Vec<(Mode, C64)> =
            both.map(|(root, motion)| (mode(root.pole, root.root, motion), root.root)).collect();
        modes.sort_by(|(a, _), (b, _)| {
            a.damping().total_cmp(&b.damping()).then_with(|| b.pole.im.total_cmp(&a.pole.im))
        });
        let z = machine.period().map(|_| modes.iter().map(|(_, z)| *z).collect());
        Ok(Self { modes: modes.into_iter().map(|(mode, _)| mode).collect(), z, right_of: machine.right_of() })
    }

    /// The same in a form that knows only modes.
    #[must_use]
    pub fn into_modes(self) -> Modes {
        Modes { modes: self.modes }
    }

    /// The smallest damping ratio of those that count ([`CountedModes::at`]) of this rotor, at the speed at which these are its poles.
    #[must_use]
    pub fn counted_damping(&self, rotor: &Rotor, speed: f64) -> f64 {
        let poles = || self.modes.iter().map(|mode| mode.pole);
        CountedModes::at(rotor, speed, poles()).min_damping(poles())
    }
}

/// The smallest damping ratio of `rotor` under `settings` at a speed, of the modes that count there ([`CountedModes::at`]).
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn counted_damping(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<f64, PolesError> {
    damping_among(rotor, settings, speed, |poles| CountedModes::at(rotor, speed, poles.iter().copied()))
}

/// The smallest damping ratio of `rotor` under `settings` at a speed, of all modes.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn min_damping(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<f64, PolesError> {
    damping_among(rotor, settings, speed, |_| CountedModes::ALL)
}

/// The smallest damping ratio of `rotor` under `settings` at a speed, of the modes that count where these are its poles. Of a chain all do.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn damping_among(
    rotor: &Rotor,
    settings: &Settings,
    speed: f64,
    counted: impl FnOnce(&[C64]) -> CountedModes,
) -> Result<f64, PolesError> {
    let feedback = &settings.feedback;
    if ClosedLoop::describes(rotor, feedback) {
        let poles = rotor::poles(&ClosedLoop::new(rotor, feedback, speed, &settings.deadband))?;
        return Ok(poles.first().map_or(f64::NAN, |pole| damping_ratio(*pole)));
    }
    let form = LinearForm::of(&Plant::of(rotor), feedback, &OperatingPoint::at(speed))?;
    let poles: Vec<C64> = Characteristic::of(&form)?.roots()?.iter().map(|root| root.pole).collect();
    Ok(counted(&poles).min_damping(poles.iter().copied()))
}
