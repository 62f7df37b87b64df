//! The steady control force of the linear rotor under its unbalance, exact, with its slope in each gain.
//!
//! Synchronous whirl `p = c exp(j R tau)` solves `Q(j R) c = Re R^2` for the closed loop; the control is
//! `u = -(g + j R h) c`. As the loop closes through one scalar, `u = -v / (1 + w)` needs the open loop alone: with
//! `Q0 c0 = Re R^2` and `Q0 d = e_b`, `v = (g + j R h) c0` and `w = (g + j R h) d`.

use rotor::{C64, ControlRow, Quadratic};

use crate::Structure;

/// What the force at one condition is made from, control off.
#[derive(Clone, Debug)]
pub(crate) struct Synchronous {
    /// Whirl under the unbalance.
    free: Vec<C64>,
    /// Whirl under a unit of control.
    per_force: Vec<C64>,
    speed: f64,
    /// What a delay does to the control: `exp(-j R T)`.
    late: C64,
}

impl Synchronous {
    /// At the condition of the open loop `open`, driven by `unbalance` (`Re R^2` of each mass), control at mass `bearing`
    /// acting late by `delay`.
    pub(crate) fn new(open: &Quadratic, unbalance: &[f64], bearing: usize, speed: f64, delay: f64) -> Self {
        let s = C64::new(0.0, speed);
        let mut free: Vec<C64> = unbalance.iter().map(|&u| C64::from(u)).collect();
        open.respond(s, &mut free);
        let mut per_force = vec![C64::ZERO; unbalance.len()];
        per_force[bearing] = C64::ONE;
        open.respond(s, &mut per_force);
        Self { free, per_force, speed, late: C64::cis(-speed * delay) }
    }

    /// `|u|`, and its slope in each variable of `structure` if there is room for it in `slope`.
    pub(crate) fn force(&self, structure: &Structure, row: &ControlRow, slope: &mut [f64]) -> f64 {
        let s = C64::new(0.0, self.speed);
        let gain = |whirl: &[C64]| {
            let each = whirl.iter().zip(row.displacement.iter().zip(&row.velocity));
            self.late * each.map(|(c, (g, h))| (g + s * h) * c).sum::<C64>()
        };
        let loop_gain = C64::ONE + gain(&self.per_force);
        let force = -gain(&self.free) / loop_gain;
        let size = force.norm();
        if !slope.is_empty() {
            let whirl: Vec<C64> = self.free.iter().zip(&self.per_force).map(|(c, d)| c + force * d).collect();
            let mut changes = vec![C64::ZERO; slope.len()];
            structure.sensitivities(self.speed, &whirl, s, &mut changes);
            // At no force at all there is no direction in which it grows.
            let toward = if size > 0.0 { self.late * force.conj() / size / loop_gain } else { C64::ZERO };
            slope.iter_mut().zip(changes).for_each(|(slope, change)| *slope = -(toward * change).re);
        }
        size
    }
}
