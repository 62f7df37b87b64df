//! One circular orbit, as it is given to the caller.

use super::CircularError;
use crate::{C64, Stability};

/// An exact circular solution `p_k = c_k exp(j w tau)` at one spin speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// Spin speed `R`.
    pub speed: f64,
    /// Whirl frequency `w` in radians per unit of `tau`, signed: positive forward. It is `R` in a synchronous response.
    pub frequency: f64,
    /// Complex amplitudes `c_k`, in `e_t`.
    pub amplitude: Vec<C64>,
    /// Bit `k` is set while mass `k` presses on a support bearing with clearance.
    pub contact: u32,
    /// The control acceleration `|u|`, constant on the orbit, in `w0^2 e_t`: the largest of the control bearings, as that of the first
    /// ([`crate::ControlMasses`]).
    pub force: f64,
    /// That of each control bearing, on its own mass.
    pub forces: Vec<f64>,
    /// Largest real part among the eigenvalues of the motion linearised about the orbit in the frame that turns with
    /// it; for a limit cycle without the zero that belongs to its free phase. Exactly zero where it is rounding. Or why it cannot be had: with a
    /// delay, a count of roots that has no end. Then nothing is known of the orbit's stability.
    pub growth: Result<f64, CircularError>,
}

impl Orbit {
    /// Orbit radius of every mass, in `e_t`.
    #[must_use]
    pub fn radii(&self) -> Vec<f64> {
        self.amplitude.iter().map(|c| c.norm()).collect()
    }

    /// Whether every small disturbance dies away. An orbit on the margin (a resting rotor that floats free inside its
    /// clearances, say) counts as not stable, and so does one of which nothing is known.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.stability() == Ok(Stability::Stable)
    }

    /// What becomes of small disturbances.
    ///
    /// # Errors
    /// Why that cannot be said.
    pub fn stability(&self) -> Result<Stability, &CircularError> {
        self.growth.as_ref().map(|growth| Stability::of(C64::from(*growth)))
    }

    /// The largest of some orbits that small disturbances leave; nothing where there is none.
    ///
    /// # Errors
    /// Why that cannot be said: an orbit that is larger still cannot be judged.
    pub fn largest_stable<'a>(
        orbits: impl IntoIterator<Item = &'a Self>,
    ) -> Result<Option<&'a Self>, &'a CircularError> {
        let may_last = orbits.into_iter().filter(|orbit| orbit.growth.is_err() || orbit.is_stable());
        let largest = may_last.max_by(|a, b| a.largest_radius().total_cmp(&b.largest_radius()));
        largest.map(|orbit| orbit.growth.as_ref().map(|_| orbit)).transpose()
    }

    /// The largest radius of any mass, in `e_t`.
    #[must_use]
    pub fn largest_radius(&self) -> f64 {
        self.amplitude.iter().map(|c| c.norm()).fold(0.0, f64::max)
    }

    /// The same orbit within a relative tolerance, whatever its branch.
    pub(super) fn is_same(&self, other: &Self, tolerance: f64) -> bool {
        let scale = self.largest_radius().max(other.largest_radius());
        let apart = self.amplitude.iter().zip(&other.amplitude).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        apart <= tolerance * scale + 1e-14
            && (self.frequency - other.frequency).abs() <= tolerance * (1.0 + self.frequency.abs())
    }
}
