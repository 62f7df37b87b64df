//! What the smallest damping and every margin do when a parameter changes a little.
//!
//! The smallest damping is the least of several: where more than one mode has it, it falls to one side faster than it rises to the other,
//! and has two slopes.

use machine::{MachineMargins, WORST};
use rayon::prelude::*;
use rotor::{C64, Characteristic, damping_ratio};

use crate::form_slope::Change;
use crate::margin_slope::Critical;
use crate::model::Model;
use crate::parameter::Parameter;
use crate::variation_error::VariationError;

/// Modes whose damping is within this of the smallest, relative to it, share it.
const SHARED: f64 = 1e-9;

/// Roots nearer than this, relative to their size, are one that is several: those of equal parts that do not touch each other.
const COINCIDENT: f64 = 1e-7;

/// Why something has no slope.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSlope {
    /// Several poles in one: they part with infinite slope.
    #[error("the pole is several in one")]
    Several,
    /// A pole at the origin has no damping ratio to change.
    #[error("the pole is at the origin")]
    Origin,
    /// The loop has other states on one side.
    #[error("the loop has other states a little further: a delay passes a whole sampling period")]
    OtherStates,
    /// A part of a sampled loop that is not there.
    #[error("the part is off, and the loop is sampled")]
    Absent,
    /// Machines about this one that cannot be.
    #[error(transparent)]
    Machine(#[from] VariationError),
}

/// The slope of the smallest damping, per unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingSlope {
    /// Its slope towards smaller values: `(f(p) - f(p - h)) / h` for a small `h`.
    pub down: f64,
    /// Its slope towards larger values: `(f(p + h) - f(p)) / h`. The same where one mode has the smallest damping.
    pub up: f64,
}

impl DampingSlope {
    /// The slope where there is but one.
    #[must_use]
    pub fn one(&self) -> Option<f64> {
        (self.down == self.up).then_some(self.up)
    }

    /// The steeper of the two.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        if self.down.abs() > self.up.abs() { self.down } else { self.up }
    }
}

/// What one parameter does.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
    /// The slope of the smallest damping ratio.
    pub min_damping: Result<DampingSlope, NoSlope>,
    /// The slope of each of [`WORST`]: delay in `tau`, factors, angle in radians, peaks. `None` where there is no such margin, or no slope.
    pub margins: [Option<f64>; WORST.len()],
}

impl Sensitivity {
    /// How much the smallest damping changes when the value changes by the part `part` of itself; `None` of what is 0 or has no slope.
    #[must_use]
    pub fn relative(&self, part: f64) -> Option<f64> {
        let slope = self.min_damping.as_ref().ok()?.steepest();
        (self.value != 0.0 && self.value.is_finite()).then_some(slope * self.value * part)
    }
}

/// What all parameters do.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivities {
    /// The smallest damping ratio.
    pub min_damping: f64,
    /// The poles that have it: one, or several but for rounding.
    pub modes: Vec<C64>,
    /// One a parameter, in the order in which they were asked for.
    pub each: Vec<Sensitivity>,
}

impl Sensitivities {
    /// The largest effects of a relative change first; then what is 0, by slope.
    pub fn rank(&mut self) {
        let size = |of: &Sensitivity| match (of.relative(1.0), &of.min_damping) {
            (Some(by), _) => (0, -by.abs()),
            (None, Ok(slope)) => (1, -slope.steepest().abs()),
            (None, Err(_)) => (2, 0.0),
        };
        self.each.sort_by(|a, b| {
            let (a, b) = (size(a), size(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
    }
}

/// The slopes of damping and margins of `model` by each of `parameters`.
///
/// # Errors
/// Poles that cannot be had, or a machine that is not stable, which has no margins.
pub fn sensitivities(model: &Model, parameters: &[Parameter]) -> Result<Sensitivities, VariationError> {
    let margins = machine::margins(&model.rotor, &model.settings, model.settings.speed)?;
    slopes(model, parameters, Some(&margins))
}

/// The slopes of damping alone, of stable machines and others.
///
/// # Errors
/// Poles that cannot be had.
pub fn damping_sensitivities(model: &Model, parameters: &[Parameter]) -> Result<Sensitivities, VariationError> {
    slopes(model, parameters, None)
}

fn slopes(
    model: &Model,
    parameters: &[Parameter],
    margins: Option<&MachineMargins>,
) -> Result<Sensitivities, VariationError> {
    let form = model.form()?;
    let roots = Characteristic::of(&form)?.roots()?;
    let poles = || roots.iter().map(|root| root.pole);
    let counted = model.counted(poles());
    let min_damping = counted.min_damping(poles());
    let within = min_damping + SHARED * min_damping.abs();
    let is_least = |pole: C64| counted.among([pole]).next().is_some() && damping_ratio(pole) <= within;
    let least: Vec<_> = roots.iter().filter(|root| is_least(root.pole)).collect();
    let critical = margins.map(|margins| Critical::of(model, &form, margins)).transpose()?;
    let each = parameters.par_iter().map(|parameter| {
        let change = Change::of(model, parameter);
        let slope = |change: &Change| {
            let mut made = DampingSlope { down: f64::NEG_INFINITY, up: f64::INFINITY };
            for root in &least {
                let apart =
                    |other: &rotor::CharacteristicRoot| (other.root - root.root).norm() / (1.0 + root.root.norm());
                if roots.iter().filter(|other| apart(other) < COINCIDENT).count() > 1 {
                    return Err(NoSlope::Several);
                }
                let slope = of_damping(root.pole, change.of_pole(&form, root.root)?).ok_or(NoSlope::Origin)?;
                made = DampingSlope { down: made.down.max(slope), up: made.up.min(slope) };
            }
            Ok(made)
        };
        let min_damping = change.as_ref().map_err(Clone::clone).and_then(slope);
        let margins =
            critical.as_ref().map_or([None; WORST.len()], |critical| critical.slopes(model, parameter, change));
        Sensitivity { parameter: parameter.clone(), value: model.value(parameter), min_damping, margins }
    });
    Ok(Sensitivities { min_damping, modes: least.iter().map(|root| root.pole).collect(), each: each.collect() })
}

/// The slope of `-Re s / |s|` of a pole that moves by `slope`; `None` at the origin.
fn of_damping(pole: C64, slope: C64) -> Option<f64> {
    let size = pole.norm();
    (size > 0.0).then(|| (pole.re * (pole.conj() * slope).re / (size * size) - slope.re) / size)
}
