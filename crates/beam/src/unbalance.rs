//! Unbalances as numbers, and the whirl that they cause.

use nalgebra::DVector;

use crate::coefficient::RAD_PER_S;
use crate::drawing::Amount;
use crate::{C64, FullModel, PoleError};

impl FullModel {
    /// The unbalance of every station in kg m as `U exp(j angle)`, where `highest` is the spin speed in rad/s that grades without a
    /// speed are for.
    ///
    /// ISO 21940-11 admits `G / w` times the mass of the rotor for the whole of it, which the graded unbalances share evenly.
    #[must_use]
    pub fn unbalance(&self, highest: f64) -> Vec<C64> {
        let graded = self.unbalances.iter().filter(|unbalance| matches!(unbalance.amount, Amount::Grade { .. }));
        let share = self.rotor_mass / graded.count().max(1) as f64;
        let mut all = vec![C64::ZERO; self.station_nodes.len()];
        for unbalance in &self.unbalances {
            let size = match unbalance.amount {
                Amount::GramMillimetres(product) => product * 1e-6,
                Amount::Grade { millimetres_per_second, speed } => {
                    let speed = speed.map_or(highest.abs(), |rpm| rpm * RAD_PER_S);
                    if speed > 0.0 { millimetres_per_second * 1e-3 / speed * share } else { 0.0 }
                }
            };
            all[unbalance.station] += C64::from_polar(size, unbalance.angle.to_radians());
        }
        all
    }

    /// The steady whirl under the unbalances at the spin speed `speed` in rad/s: what `p` and `psi` of every node are to
    /// `exp(j w t)`, in m and rad. Grades without a speed of their own are for this one.
    ///
    /// `(S(w) + j w D(w) - w^2 M) q = w^2 U`, every clearance neglected and touchdown bearings out.
    ///
    /// # Errors
    /// A machine that resonates without any damping at this very speed.
    pub fn unbalance_response(&self, speed: f64) -> Result<Vec<C64>, PoleError> {
        self.response_to(&self.unbalance(speed), speed)
    }

    /// The same under any unbalance of each station, in kg m.
    ///
    /// # Errors
    /// As [`FullModel::unbalance_response`].
    ///
    /// # Panics
    /// If there are not as many unbalances as stations.
    pub fn response_to(&self, unbalance: &[C64], speed: f64) -> Result<Vec<C64>, PoleError> {
        assert_eq!(unbalance.len(), self.station_nodes.len(), "an unbalance for every station");
        let (mass, damping, stiffness) = self.at(speed);
        let square = C64::from(speed * speed);
        let mut force = DVector::from_element(mass.nrows(), C64::ZERO);
        for (&node, &amount) in self.station_nodes.iter().zip(unbalance) {
            force[self.displacements[node]] = square * amount;
        }
        let dynamic = stiffness + damping * C64::new(0.0, speed) - mass * square;
        let whirl = dynamic.lu().solve(&force).filter(|whirl| whirl.iter().all(|q| q.is_finite()));
        whirl.map(|whirl| whirl.iter().copied().collect()).ok_or(PoleError::Singular)
    }
}
