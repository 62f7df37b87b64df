//! Whether a motion that was found, by simulation say, would stay: the circular orbit it is on, and the rotor at rest.
//!
//! A simulation cannot tell. What neither its start nor the unbalance excites stays away for ever, stable or not.

use nalgebra::DVector;

use super::problem::Contact;
use super::whirl_equation::Equation;
use super::{CircularError, stability};
use crate::{C64, ClosedLoop, J};

use super::Orbit;

/// Residual of the whirl equation, and departure of the velocity from `j w p`, up to which a motion counts as circular:
/// well above what the integration is off by.
const CIRCULAR: f64 = 1e-5;

/// The circular orbit that a motion is on, with its stability, or the resting centre; `None` if it is on none: it is
/// not circular, or has not settled.
///
/// `angle` is the spin angle, `displacement` and `velocity` hold one value a mass. Where nothing drives the rotor the
/// orbit whirls at a frequency of its own, and the disturbance that only turns it is left out.
///
/// # Errors
/// The eigenvalues that tell stability do not converge, or the coefficients are not finite.
pub fn orbit_of(
    closed_loop: &ClosedLoop,
    angle: f64,
    displacement: &[C64],
    velocity: &[C64],
) -> Result<Option<Orbit>, CircularError> {
    let equation = Equation::of(closed_loop, true);
    let speed = closed_loop.speed;
    let forced = !equation.is_balanced();
    let turn = C64::cis(-angle);
    let c = DVector::from_iterator(displacement.len(), displacement.iter().map(|p| p * turn));
    let v = DVector::from_iterator(velocity.len(), velocity.iter().map(|v| v * turn));
    let widest = c.iter().fold(C64::ZERO, |a, b| if b.norm() > a.norm() { *b } else { a });
    let rests = c.iter().chain(v.iter()).all(|x| *x == C64::ZERO);
    let frequency = if forced {
        speed
    } else if rests {
        0.0
    } else {
        let k = c.iter().position(|c| *c == widest).unwrap_or(0);
        (widest.conj() * v[k]).im / widest.norm_sqr()
    };
    let contact = (0..c.len())
        .filter(|&k| equation.gapped >> k & 1 == 1 && c[k].norm() > closed_loop.deadband[k])
        .fold(0, |set: Contact, k| set | 1 << k);
    let residual = equation.residual(&c, frequency, contact).norm() / equation.scale(&c, frequency);
    let slip = (&v - &c * (J * frequency)).norm() / ((1.0 + frequency.abs()) * c.norm());
    // At rest both are nothing divided by nothing.
    let is_circular = (rests && !forced) || (residual <= CIRCULAR && slip <= CIRCULAR);
    if !is_circular {
        return Ok(None);
    }
    let growth = Ok(stability::growth(&equation, c.as_slice(), frequency, contact, !forced && !rests)?);
    let forces = equation.forces(c.as_slice(), frequency);
    let force = forces.iter().copied().fold(0.0, f64::max);
    let amplitude = c.as_slice().to_vec();
    Ok(Some(Orbit { speed, frequency, amplitude, contact, force, forces, growth }))
}

/// The balanced rotor at rest in its centre, support bearings with clearance out of action: what starts to whirl by
/// itself if it is not stable.
///
/// # Errors
/// As for [`orbit_of`].
pub fn centre(closed_loop: &ClosedLoop) -> Result<Orbit, CircularError> {
    let equation = Equation::of(closed_loop, false);
    let amplitude = vec![C64::ZERO; closed_loop.masses];
    let growth = Ok(stability::growth(&equation, &amplitude, 0.0, 0, false)?);
    Ok(Orbit { speed: closed_loop.speed, frequency: 0.0, amplitude, contact: 0, force: 0.0, forces: vec![0.0], growth })
}
