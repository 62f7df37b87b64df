//! What a map of basins can lead to: the exact circular orbits of its machine.

use rotor::Stability;
use rotor::circular::{self, Circular, CircularError, Orbit};

use super::{MapPlan, MapQuantity};

/// An exact circular orbit that starts and impulses may lead to, or away from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// What keeps it going.
    pub kind: ReferenceKind,
    /// What of it is mapped: the largest radius of any mass in `e_t`, or the control force in `w0^2 e_t`.
    pub value: f64,
    /// The frequency of whirl, in radians per `tau`, negative backward.
    pub frequency: f64,
    /// What becomes of small disturbances: a motion ends on stable ones, and those that are not stand between basins. `None` where that
    /// cannot be judged.
    pub stability: Option<Stability>,
}

/// What keeps a circular orbit going.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceKind {
    /// The unbalance: it whirls with the spin.
    Synchronous,
    /// Itself: a limit cycle of the balanced rotor, which unbalance makes beat.
    Cycle,
}

impl MapPlan {
    /// The exact circular orbits of the machine, smallest first, where it is the same in every cell and the motion is what is mapped; `None`
    /// where it is not.
    ///
    /// # Errors
    /// A sampled loop, or roots that cannot be had.
    pub fn references(&self, stop: &dyn Fn() -> bool) -> Result<Option<Vec<Reference>>, CircularError> {
        let is_one = self.x.key.is_of_motion() && self.y.key.is_of_motion();
        if !is_one || !self.quantity.row().is_simulated {
            return Ok(None);
        }
        let (rotor, settings) = (&self.model.rotor, &self.model.settings);
        let (feedback, clearances, speeds) = (&settings.feedback, &settings.deadband, [settings.speed]);
        let driven = circular::synchronous_orbits(rotor, feedback, clearances, &speeds, stop)?;
        let cycles = circular::cycles(rotor, feedback, clearances, &speeds)?;
        let mut made = self.read(ReferenceKind::Synchronous, &driven);
        made.extend(self.read(ReferenceKind::Cycle, &cycles));
        made.sort_by(|a, b| a.value.total_cmp(&b.value));
        Ok(Some(made))
    }

    fn read(&self, kind: ReferenceKind, found: &Circular) -> Vec<Reference> {
        let value = |orbit: &Orbit| match self.quantity {
            MapQuantity::Force => orbit.force,
            _ => orbit.largest_radius(),
        };
        let of = |orbit: &Orbit| Reference {
            kind,
            value: value(orbit),
            frequency: orbit.frequency,
            stability: orbit.stability().ok(),
        };
        found.orbits.iter().flatten().map(of).collect()
    }
}
