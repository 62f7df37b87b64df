//! Whether a motion that a run has found would stay. The run itself cannot tell: what neither its start nor the
//! unbalance excites stays away, stable or not.
//!
//! On a circular orbit, and at rest, the eigenvalues of the linearised motion tell. Where several frequencies beat, a twin
//! is disturbed in every mass, by a part of `1e-7`, and drawn back to that distance again and again: how the distance grows
//! is how the disturbance does.

use std::sync::atomic::{AtomicBool, Ordering};

use machine::{Machine, PolesError, Program};
use rotor::circular::{self, CircularError};
use rotor::{C64, FeedbackError, Stability};

/// How small a disturbance is, as a part of the motion.
const PART: f64 = 1e-7;
/// For how long a disturbance may sort itself out before its growth counts, and for how long it counts, in `tau`.
const WARM_UP: f64 = 300.0;
const WATCHED: f64 = 600.0;
/// A disturbance that beats along with the motion comes and goes by less than this factor.
const COMES_AND_GOES: f64 = 20.0;

/// What becomes of small disturbances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisturbanceGrowth {
    /// In a word.
    pub stability: Stability,
    /// How fast the fastest grows: its size goes as `exp(growth tau)`.
    pub growth: f64,
    /// How this was found.
    pub by: Means,
}

impl DisturbanceGrowth {
    /// In a word that stands out where it must.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self.stability {
            Stability::Stable => "stable",
            Stability::Marginal => "marginal",
            Stability::Unstable => "UNSTABLE",
        }
    }
}

/// How stability was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Means {
    /// From the eigenvalues of the linearised motion: exact.
    Eigenvalues,
    /// By watching a disturbance: one that grows by less than [`slowest_seen`] is not seen.
    Simulation,
}

/// The slowest growth that [`Means::Simulation`] tells from none, per unit of `tau`.
#[must_use]
pub fn slowest_seen() -> f64 {
    COMES_AND_GOES.ln() / WATCHED
}

impl TryFrom<circular::Orbit> for DisturbanceGrowth {
    type Error = CircularError;

    fn try_from(orbit: circular::Orbit) -> Result<Self, CircularError> {
        let growth = orbit.growth?;
        Ok(Self { stability: Stability::of(C64::from(growth)), growth, by: Means::Eigenvalues })
    }
}

/// The rotor at rest in its centre at a speed, bearings with clearance out of action. `None` of a machine whose amplifiers differ along the
/// axes: it is stepped as it is, and has no complex poles that would tell.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(crate) fn of_centre(program: &Program, speed: f64) -> Result<Option<DisturbanceGrowth>, PolesError> {
    if let Some(closed_loop) = program.closed_loop().filter(|closed_loop| closed_loop.speed() == speed) {
        return Ok(Some(circular::centre(closed_loop)?.try_into()?));
    }
    let growth = match program.growth_at_centre(speed) {
        Err(PolesError::Feedback(FeedbackError::Anisotropic { .. })) => return Ok(None),
        growth => growth?,
    };
    Ok(Some(DisturbanceGrowth { stability: Stability::of(C64::from(growth)), growth, by: Means::Eigenvalues }))
}

/// The circular orbit that the rotor is on, if it is on one. Under a loop with states of its own, or at a speed that a drive left it at, orbits are not known
/// exactly: there a disturbance is watched, see [`of_beat`].
///
/// # Errors
/// Eigenvalues that do not converge.
pub(crate) fn of_orbit(program: &Program, rotor: &Machine) -> Result<Option<DisturbanceGrowth>, PolesError> {
    let speed = rotor.sample().speed;
    let known = program.closed_loop().filter(|closed_loop| closed_loop.speed() == speed);
    let Some(closed_loop) = known else { return Ok(None) };
    let motion = rotor.motion();
    let orbit = circular::orbit_of(closed_loop, motion.angle, motion.displacement, motion.velocity)?;
    Ok(orbit.map(TryInto::try_into).transpose()?)
}

/// A motion that has settled and is not circular, going on in steps of `dtau`; `None` if `stop` is raised meanwhile.
pub(crate) fn of_beat(rotor: &mut Machine, dtau: f64, stop: &AtomicBool) -> Option<DisturbanceGrowth> {
    let mut twin = rotor.clone();
    let size = |rotor: &Machine| {
        let motion = rotor.motion();
        motion.displacement.iter().chain(motion.velocity).map(|x| x.norm_sqr()).sum::<f64>().sqrt()
    };
    let distance = PART * size(rotor);
    let masses = rotor.motion().displacement.len();
    // Uneven in every mass and direction: no mode is left out by symmetry.
    let uneven = |i: usize| C64::cis(1.0 + 1.618_033_988_75 * i as f64) * (1.0 + 0.3 * (i as f64).sin());
    let norm = (0..2 * masses).map(|i| uneven(i).norm_sqr()).sum::<f64>().sqrt();
    let apart: Vec<C64> = (0..2 * masses).map(|i| uneven(i) * (distance / norm)).collect();
    place_apart(rotor, &mut twin, &apart);

    let stretch = (1.0 / dtau).ceil();
    let (mut grown, mut from) = (0.0, None);
    let mut elapsed = 0.0;
    while elapsed < WARM_UP + WATCHED {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        (0..stretch as u64).for_each(|_| {
            rotor.step_by(dtau);
            twin.step_by(dtau);
        });
        elapsed += stretch * dtau;
        let (here, there) = (rotor.motion(), twin.motion());
        let pairs = here.displacement.iter().chain(here.velocity).zip(there.displacement.iter().chain(there.velocity));
        let mut apart: Vec<C64> = pairs.map(|(a, b)| b - a).collect();
        let now = apart.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        if !(now.is_finite() && now > 0.0) {
            break;
        }
        grown += (now / distance).ln();
        apart.iter_mut().for_each(|x| *x *= distance / now);
        place_apart(rotor, &mut twin, &apart);
        if elapsed >= WARM_UP && from.is_none() {
            from = Some((elapsed, grown));
        }
    }
    let (began, before) = from.unwrap_or((0.0, 0.0));
    let growth = (grown - before) / (elapsed - began).max(1.0);
    let stability = if grown - before > COMES_AND_GOES.ln() { Stability::Unstable } else { Stability::Stable };
    Some(DisturbanceGrowth { stability, growth, by: Means::Simulation })
}

/// Puts `twin` where `rotor` is, but for `apart` in every displacement and then every velocity.
fn place_apart(rotor: &Machine, twin: &mut Machine, apart: &[C64]) {
    let motion = rotor.motion();
    let (p, v) = apart.split_at(motion.displacement.len());
    let sum = |a: &[C64], b: &[C64]| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<C64>>();
    twin.place(&sum(motion.displacement, p), &sum(motion.velocity, v));
}
