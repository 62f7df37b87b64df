//! What a reduction has cost.

use crate::{C64, Drawing, FullModel, MAX_COORDINATES, PoleError, Reduced, ReductionError};

/// A pole of the full model and what the reduction makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostPole {
    /// The spin speed in rad/s.
    pub speed: f64,
    /// Of the full model, in 1/s and rad/s.
    pub full: C64,
    /// The nearest one of the reduced model.
    pub reduced: C64,
    /// Their distance beside the size of the pole; beside a thousandth of the highest frequency where the pole is smaller than that.
    pub frequency: f64,
    /// The difference of their damping ratios `-Re / |s|`; 0 for poles as small as that.
    pub damping: f64,
}

/// What a reduction has cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Lost {
    /// Every pole of every speed, slowest first within each.
    pub poles: Vec<LostPole>,
}

impl Lost {
    /// The largest relative error of an eigenvalue.
    #[must_use]
    pub fn worst_frequency(&self) -> f64 {
        self.poles.iter().map(|pole| pole.frequency).fold(0.0, f64::max)
    }

    /// The largest error of a damping ratio.
    #[must_use]
    pub fn worst_damping(&self) -> f64 {
        self.poles.iter().map(|pole| pole.damping).fold(0.0, f64::max)
    }
}

/// Compares the poles of both models at each of `speeds` in rad/s, as far as those of the full one are no larger than
/// `up_to` in rad/s.
///
/// # Errors
/// Those of [`FullModel::eigenvalues`].
pub fn lost(full: &FullModel, reduced: &Reduced, speeds: &[f64], up_to: f64) -> Result<Lost, PoleError> {
    compare(full, reduced, &poles(full, speeds)?, up_to)
}

impl FullModel {
    /// Reduces the rotor to as few coordinates as keep every pole up to `up_to` in rad/s at each of `speeds` in rad/s within the
    /// relative error `within`, and says what they lose. Where even [`MAX_COORDINATES`] do not, those are it. Few coordinates are not only
    /// faster to step: fast modes that mean nothing would force short steps.
    ///
    /// # Errors
    /// Those of [`FullModel::reduce`] and of [`FullModel::eigenvalues`].
    pub fn reduce_within(
        &self,
        drawing: &Drawing,
        speeds: &[f64],
        up_to: f64,
        within: f64,
    ) -> Result<(Reduced, Lost), LostError> {
        let poles = poles(self, speeds)?;
        let mut coordinates = 2;
        loop {
            let reduced = self.reduce(drawing, coordinates)?;
            let lost = compare(self, &reduced, &poles, up_to)?;
            let most = coordinates == MAX_COORDINATES || reduced.coordinates() < coordinates;
            if most || lost.worst_frequency() <= within {
                return Ok((reduced, lost));
            }
            coordinates += 1;
        }
    }
}

/// Why a rotor could not be reduced, or compared with what it was reduced to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LostError {
    /// It could not be reduced.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// Poles were not found.
    #[error(transparent)]
    Poles(#[from] PoleError),
}

fn poles(full: &FullModel, speeds: &[f64]) -> Result<Vec<(f64, Vec<C64>)>, PoleError> {
    speeds.iter().map(|&speed| Ok((speed, full.eigenvalues(speed)?))).collect()
}

fn compare(full: &FullModel, reduced: &Reduced, of: &[(f64, Vec<C64>)], up_to: f64) -> Result<Lost, PoleError> {
    let least = 1e-3 * up_to;
    let mut poles = Vec::new();
    for (speed, all) in of {
        let kept = reduced.eigenvalues(&full.springs, *speed)?;
        for &pole in all.iter().filter(|pole| pole.norm() <= up_to) {
            let distance = |other: &C64| (other - pole).norm();
            // Not one to one: a pole that has no partner must not take that of another.
            let nearest = kept.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let found = nearest.copied().unwrap_or(C64::ZERO);
            let ratio = |s: C64| if s.norm() > least { -s.re / s.norm() } else { 0.0 };
            poles.push(LostPole {
                speed: *speed,
                full: pole,
                reduced: found,
                frequency: (found - pole).norm() / pole.norm().max(least),
                damping: (ratio(found) - ratio(pole)).abs(),
            });
        }
    }
    Ok(Lost { poles })
}
