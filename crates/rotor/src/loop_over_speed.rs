//! What of a [`crate::ClosedLoop`] hangs on the speed, at every speed: what a [`crate::Stepper`] needs on a ramp.

use control::LawOverSpeed;

use crate::{C64, Feedback, MAX_MASSES, Rotor, Spin};

/// What the equations of motion need to know of the spin in one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedStage {
    /// Spin speed `R`.
    pub speed: f64,
    /// What the unbalance is a multiple of, `(R^2 - j R') exp(j theta)`.
    pub unbalance: C64,
}

impl SpeedStage {
    /// No spin.
    pub const AT_REST: Self = Self { speed: 0.0, unbalance: C64::ZERO };
}

impl From<Spin> for SpeedStage {
    fn from(spin: Spin) -> Self {
        let Spin { speed, acceleration, direction } = spin;
        Self { speed, unbalance: direction * C64::new(speed * speed, -acceleration) }
    }
}

/// Of a chain under an ideal loop: cross-coupled stiffness `j zeta R`, unbalance `Re (R^2 - j R')`, and the law.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopOverSpeed {
    /// `zeta` per mass; zero beyond the last.
    pub(crate) seal: [f64; MAX_MASSES],
    /// `Re` per mass; zero beyond the last.
    pub(crate) eccentricity: [f64; MAX_MASSES],
    pub(crate) law: LawOverSpeed,
}

impl LoopOverSpeed {
    /// That of a chain under the gains of the first control bearing: see [`crate::ClosedLoop::describes`]. `feedback` must have passed
    /// [`Feedback::check`] for this rotor.
    #[must_use]
    pub fn of(rotor: &Rotor, feedback: &Feedback) -> Self {
        let mut made =
            Self { seal: [0.0; MAX_MASSES], eccentricity: [0.0; MAX_MASSES], law: LawOverSpeed::of(feedback.first()) };
        for ((seal, eccentricity), mass) in made.seal.iter_mut().zip(&mut made.eccentricity).zip(rotor.masses()) {
            (*seal, *eccentricity) = (mass.damping, mass.unbalance);
        }
        made
    }
}
