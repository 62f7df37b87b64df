//! Which fixed step a rotor needs, and which steps are refused.
//!
//! Classical Runge-Kutta follows a rotation by the angle `x = |Im lambda| dtau` a step with a relative error of
//! `x^5 / 120`, and is stable for a decaying mode while `|lambda| dtau` stays below about 2.78. The modes are those of
//! the rotor with its bearings at full stiffness and without them: the deadband moves between the two. The spin speed
//! counts as a mode, because the unbalance turns with it.

use rotor::{C64, ClosedLoop, PoleError, eigenvalues};

/// Largest `|lambda| dtau` of any mode, with a margin to the stability limit of 2.78 on the real axis.
pub const STABILITY_LIMIT: f64 = 2.5;
/// Largest angle a step, `|Im lambda| dtau` or `R dtau`: a phase error of 0.3 % of a turn each turn.
pub const ACCURACY_LIMIT: f64 = 0.5;
/// Angle a step of the default step: 126 steps a turn, a relative error of 5e-8 a radian.
const DEFAULT_ANGLE: f64 = 0.05;
/// `|lambda| dtau` of the default step for modes that hardly turn.
const DEFAULT_DECAY: f64 = 0.25;
/// The default step is never longer.
const LONGEST_DEFAULT: f64 = 0.05;

/// The fastest that happens in a rotor at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fastest {
    /// The pole with the largest `|lambda|`.
    pub pole: C64,
    /// The pole with the largest `|Im lambda|`.
    pub turning: C64,
    /// Spin speed `R`.
    pub speed: f64,
}

/// Why a step is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Not a finite number greater than 0.
    #[error("dtau = {0}: expected a finite number greater than 0")]
    Value(f64),
    /// The integration of this mode would not be stable.
    #[error(
        "dtau = {dtau} is too large for the mode at {pole:.4}: |lambda| dtau = {product:.3}, at most {STABILITY_LIMIT} \
         is stable; try {proposed:.3e}"
    )]
    Unstable {
        /// The step asked for.
        dtau: f64,
        /// The mode.
        pole: C64,
        /// What is too large.
        product: f64,
        /// A step that is fine.
        proposed: f64,
    },
    /// The integration of this mode would be stable but wrong.
    #[error(
        "dtau = {dtau} is too large for the mode at {pole:.4}: it turns {product:.3} radians a step, at most \
         {ACCURACY_LIMIT} is accurate; try {proposed:.3e}"
    )]
    Inaccurate {
        /// The step asked for.
        dtau: f64,
        /// The mode.
        pole: C64,
        /// What is too large.
        product: f64,
        /// A step that is fine.
        proposed: f64,
    },
    /// The unbalance would turn too far in a step.
    #[error(
        "dtau = {dtau} is too large for the spin: it turns {product:.3} radians a step, at most {ACCURACY_LIMIT} is \
         accurate; try {proposed:.3e}"
    )]
    Spin {
        /// The step asked for.
        dtau: f64,
        /// What is too large.
        product: f64,
        /// A step that is fine.
        proposed: f64,
    },
}

impl Fastest {
    /// Looks at the modes of `closed_loop` with every support bearing in and out of action.
    ///
    /// # Errors
    /// As for [`eigenvalues`].
    pub fn of(closed_loop: &ClosedLoop) -> Result<Self, PoleError> {
        let mut made = Self { pole: C64::ZERO, turning: C64::ZERO, speed: closed_loop.speed() };
        for factor in [1.0, 0.0] {
            for pole in eigenvalues(closed_loop.state_matrix_with(&vec![factor; closed_loop.masses()]))? {
                if pole.norm() > made.pole.norm() {
                    made.pole = pole;
                }
                if pole.im.abs() > made.turning.im.abs() {
                    made.turning = pole;
                }
            }
        }
        Ok(made)
    }

    /// The fastest rotation, in radians per unit of `tau`.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.turning.im.abs().max(self.speed.abs())
    }

    /// The default step: 126 steps to the fastest turn, a quarter of the fastest decay, at most 0.05.
    #[must_use]
    pub fn default_step(&self) -> f64 {
        (DEFAULT_ANGLE / self.frequency()).min(DEFAULT_DECAY / self.pole.norm()).min(LONGEST_DEFAULT)
    }

    /// Refuses a step that is too large.
    ///
    /// # Errors
    /// Which mode it is too large for, and a step that is not.
    pub fn check(&self, dtau: f64) -> Result<(), StepError> {
        if !(dtau.is_finite() && dtau > 0.0) {
            return Err(StepError::Value(dtau));
        }
        let proposed = self.default_step();
        let (decay, turn, spin) = (self.pole.norm() * dtau, self.turning.im.abs() * dtau, self.speed.abs() * dtau);
        if decay > STABILITY_LIMIT {
            Err(StepError::Unstable { dtau, pole: self.pole, product: decay, proposed })
        } else if turn > ACCURACY_LIMIT {
            Err(StepError::Inaccurate { dtau, pole: self.turning, product: turn, proposed })
        } else if spin > ACCURACY_LIMIT {
            Err(StepError::Spin { dtau, product: spin, proposed })
        } else {
            Ok(())
        }
    }
}
