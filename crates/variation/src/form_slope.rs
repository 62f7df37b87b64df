//! How a machine's matrices change with a parameter, and where that takes a root of its characteristic equation.
//!
//! A simple root of `M(s) = s I - N(s)`, `N = A + B C exp(-s T)`, with vectors `left M = 0` and `M right = 0`, moves by
//!
//! ```text
//! ds/dp = left dN/dp right / (left M'(s) right)
//! ```
//!
//! and a root `z` of a sampled step likewise, with `s = ln(z) / h`.

use control::Feedback;
use linear::DelaySystem;
use nalgebra::DMatrix;
use rotor::{C64, Characteristic, LinearForm};

use crate::model::Model;
use crate::parameter::{Parameter, Quantity};
use crate::sensitivity::NoSlope;
use crate::stencil::{STEP, Weighted, about};
use crate::variation_error::VariationError;

/// A root whose vectors have a product as small as this has no slope: it is several in one.
const SEVERAL: f64 = 1e-7;

/// How matrices change with a parameter.
pub(crate) enum Change {
    /// The matrices about its value.
    Forms(Weighted<LinearForm>),
    /// A part of the loop that is off, and whose first effect is a delay of the command of a bearing (of all if none is said), so many
    /// times as long as the part's number.
    Late { bearing: Option<usize>, times: f64 },
}

impl Change {
    /// What a parameter of a machine does to its matrices.
    pub(crate) fn of(model: &Model, parameter: &Parameter) -> Result<Self, NoSlope> {
        if let Some(late) = Self::of_absent(&model.settings.feedback, model, parameter)? {
            return Ok(late);
        }
        let value = model.value(parameter);
        Ok(Self::Forms(about(value, parameter.step(), |value| model.with(&[(parameter, value)])?.form())?))
    }

    /// A lag that is not there delays like itself at first, and sampling by half its period: until the next sample half of it has passed.
    fn of_absent(feedback: &Feedback, model: &Model, parameter: &Parameter) -> Result<Option<Self>, NoSlope> {
        let Quantity::Setting(key) = parameter.quantity else { return Ok(None) };
        let times = match key.parameter.name {
            "lag" | "sensor_lag" => 1.0,
            "sample" => 0.5,
            _ => return Ok(None),
        };
        if model.value(parameter) > 0.0 {
            return Ok(None);
        }
        // Of a sampled loop the delay of what is held is no delay of its command.
        if feedback.sample() > 0.0 {
            return Err(NoSlope::Absent);
        }
        Ok(Some(Self::Late { bearing: key.index, times }))
    }

    /// The same with more delay in every command.
    pub(crate) fn late_by(self, delay: f64) -> Self {
        match self {
            Self::Forms(forms) => {
                let late = |(weight, form): (f64, LinearForm)| (weight, delayed(form, delay));
                Self::Forms(forms.into_iter().map(late).collect())
            }
            late => late,
        }
    }

    /// The slope of the pole that is `root` of the machine `form`.
    pub(crate) fn of_pole(&self, form: &LinearForm, root: C64) -> Result<C64, NoSlope> {
        let machine = Characteristic::of(form).map_err(VariationError::from)?;
        let system = machine.system();
        let vectors = system.sensitivity(root).ok_or(NoSlope::Several)?;
        let shape = system.a().shape();
        let (change, by_period) =
            match self {
                Self::Late { bearing, times } => {
                    let moved = |k: usize| C64::from(if bearing.is_none_or(|b| b == k) { *times } else { 0.0 });
                    let kept = DMatrix::from_fn(system.b().ncols(), system.b().ncols(), |i, k| {
                        if i == k { moved(k) } else { C64::ZERO }
                    });
                    (system.b() * kept * system.c() * (-root * late(system, root)), 0.0)
                }
                Self::Forms(forms) => {
                    let (mut sum, mut by_period) = (DMatrix::zeros(shape.0, shape.1), 0.0);
                    for (weight, form) in forms {
                        let other = Characteristic::of(form).map_err(VariationError::from)?;
                        let of = other.system();
                        if of.a().shape() != shape || other.period().is_some() != machine.period().is_some() {
                            return Err(NoSlope::OtherStates);
                        }
                        sum += (of.a() + of.b() * of.c() * late(of, root)) * C64::from(*weight);
                        by_period += weight * other.period().unwrap_or(0.0);
                    }
                    (sum, by_period)
                }
            };
        if vectors.give.norm() < SEVERAL {
            return Err(NoSlope::Several);
        }
        let moves = (vectors.left.transpose() * change * &vectors.right)[0] / vectors.give;
        Ok(match machine.period() {
            None => moves,
            Some(period) => moves / (root * period) - root.ln() / (period * period) * by_period,
        })
    }
}

fn late(system: &DelaySystem, s: C64) -> C64 {
    (-s * system.delay()).exp()
}

/// A machine with more delay in every command.
pub(crate) fn delayed(form: LinearForm, delay: f64) -> LinearForm {
    LinearForm { delay: form.delay + delay, ..form }
}

/// What delay does to the matrices of a machine.
pub(crate) fn of_delay(form: &LinearForm) -> Result<Change, NoSlope> {
    let own = form.delay;
    Ok(Change::Forms(about(own, STEP, |delay| -> Result<LinearForm, NoSlope> {
        if delay < 0.0 { Err(NoSlope::Absent) } else { Ok(LinearForm { delay, ..form.clone() }) }
    })?))
}
