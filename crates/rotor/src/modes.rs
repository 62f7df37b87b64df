//! Poles of the linear rotor (deadband neglected), and what they say about stability.

use crate::marginal::Stability;
use crate::quadratic::Quadratic;
use crate::{C64, ClosedLoop, MAX_MASSES};

/// Why there are no poles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleError {
    /// The eigenvalues cannot be had.
    #[error(transparent)]
    Eigenvalues(#[from] linear::EigenvalueError),
    /// A pole or its shape left the range of numbers.
    #[error("the poles are beyond the range of numbers: the values of this machine lie too far apart")]
    OutOfRange,
}

/// The poles of `closed_loop` alone, without their shapes: every support bearing at its full stiffness, least damped
/// first, of equally damped ones the highest `Im` first. A part that is zero but for rounding is exactly zero
/// (see [`Stability`]). Half the cost of [`Modes::of`].
///
/// # Errors
/// Coefficients that are not finite or poles that are not, or an eigenvalue iteration that does not converge.
pub fn poles(closed_loop: &ClosedLoop) -> Result<Vec<C64>, PoleError> {
    sorted(&Quadratic::of(closed_loop))
}

fn sorted(quadratic: &Quadratic) -> Result<Vec<C64>, PoleError> {
    let mut poles = quadratic.poles()?;
    if !poles.iter().all(|pole| is_finite(*pole)) {
        return Err(PoleError::OutOfRange);
    }
    quadratic.settle(&mut poles);
    // Few enough for insertion, which computes each key once.
    let mut keys = [0.0; 2 * MAX_MASSES];
    for i in 0..poles.len() {
        let (pole, key) = (poles[i], damping_ratio(poles[i]));
        let mut at = i;
        while at > 0 && (key < keys[at - 1] || (key == keys[at - 1] && pole.im > poles[at - 1].im)) {
            (poles[at], keys[at]) = (poles[at - 1], keys[at - 1]);
            at -= 1;
        }
        (poles[at], keys[at]) = (pole, key);
    }
    Ok(poles)
}

fn is_finite(z: C64) -> bool {
    z.re.is_finite() && z.im.is_finite()
}

/// Relative damping of a pole, `-Re / |lambda|` (3.42), (4.28): 1 is overdamped, 0 the threshold, negative unstable.
/// A pole at the origin counts as 0. Never -0, so that a marginal pole reads as the zero that it is.
#[must_use]
pub fn damping_ratio(pole: C64) -> f64 {
    let size = pole.norm();
    if size > 0.0 { (0.0 - pole.re) / size } else { 0.0 }
}

/// A pole this near the real axis, relative to its size, is on it: several that coincide are off it by rounding.
const REAL: f64 = 1e-12;

/// The sense in which a mode whirls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Whirl {
    /// With the spin, `Im >= 0`. A pole on the real axis, which does not whirl, counts here.
    Forward,
    /// Against the spin, `Im < 0`.
    Backward,
}

impl std::fmt::Display for Whirl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
        })
    }
}

/// One mode: a pole of the complex form and its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The eigenvalue, per unit of `tau`.
    pub pole: C64,
    /// Complex displacement of each mass, scaled so that the largest is 1.
    pub shape: Vec<C64>,
}

impl Mode {
    /// Relative damping, see [`damping_ratio`].
    #[must_use]
    pub fn damping(&self) -> f64 {
        damping_ratio(self.pole)
    }

    /// Whether it decays, grows, or neither but for rounding.
    #[must_use]
    pub fn stability(&self) -> Stability {
        Stability::of(self.pole)
    }

    /// Logarithmic decrement `2 pi zeta / sqrt(1 - zeta^2)`; infinite for a pole on the real axis, or off it by rounding alone, 0 for a
    /// marginal one.
    #[must_use]
    pub fn log_decrement(&self) -> f64 {
        let C64 { re, im } = self.pole;
        if re == 0.0 {
            return 0.0;
        }
        // The same quotient in terms of the pole, which keeps its digits near zeta = 1.
        let whirls = im.abs() > REAL * re.abs();
        std::f64::consts::TAU * -re / if whirls { im.abs() } else { 0.0 }
    }

    /// Whirl frequency `|Im lambda|`, in radians per unit of `tau`.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.pole.im.abs()
    }

    /// Forward or backward.
    #[must_use]
    pub fn whirl(&self) -> Whirl {
        if self.pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward }
    }
}

/// All modes of the linear rotor at one operating point.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The `2n` modes, least damped first; of equally damped ones the highest `Im` first.
    pub modes: Vec<Mode>,
}

impl Modes {
    /// The modes of `closed_loop`, every support bearing at its full stiffness.
    ///
    /// # Errors
    /// Coefficients that are not finite or poles that are not, or an eigenvalue iteration that does not converge.
    pub fn of(closed_loop: &ClosedLoop) -> Result<Self, PoleError> {
        let quadratic = Quadratic::of(closed_loop);
        let modes: Vec<Mode> =
            sorted(&quadratic)?.into_iter().map(|pole| Mode { pole, shape: shape(&quadratic, pole) }).collect();
        let is_whole = modes.iter().flat_map(|mode| &mode.shape).all(|part| is_finite(*part));
        if is_whole { Ok(Self { modes }) } else { Err(PoleError::OutOfRange) }
    }

    /// The smallest relative damping of any mode: the rotor is stable where it is positive.
    #[must_use]
    pub fn min_damping(&self) -> f64 {
        self.modes.first().map_or(f64::NAN, Mode::damping)
    }

    /// How the least damped mode stands.
    #[must_use]
    pub fn stability(&self) -> Stability {
        self.modes.first().map_or(Stability::Unstable, Mode::stability)
    }

    /// Whether every mode decays, beyond rounding.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.stability() == Stability::Stable
    }
}

/// The shape of the mode of `pole`, scaled so that its largest component is 1.
fn shape(quadratic: &Quadratic, pole: C64) -> Vec<C64> {
    let mut shape = vec![C64::ZERO; quadratic.masses()];
    quadratic.vectors(pole, &mut shape, &mut []);
    scale_to_largest(&mut shape);
    shape
}

/// Divides by the component of largest modulus; of nearly equal ones, by the first.
pub fn scale_to_largest(shape: &mut [C64]) {
    let (_, largest) = shape.iter().fold((0.0, C64::ZERO), |(size, largest), z| {
        let square = z.norm_sqr();
        if square > size * (1.0 + 1e-9) { (square, *z) } else { (size, largest) }
    });
    if largest != C64::ZERO {
        let factor = largest.inv();
        shape.iter_mut().for_each(|z| *z *= factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_off_the_real_axis_by_rounding_has_no_turn_to_decay_in() {
        let decrement = |re, im| Mode { pole: C64::new(re, im), shape: vec![] }.log_decrement();
        assert_eq!([decrement(-10.0, 3e-17), decrement(-10.0, 0.0)], [f64::INFINITY; 2]);
        assert_eq!((decrement(10.0, -1e-15), decrement(0.0, 1.0)), (f64::NEG_INFINITY, 0.0));
        assert!((decrement(-0.1, 1.0) - 0.2 * std::f64::consts::PI).abs() < 1e-15);
    }
}
