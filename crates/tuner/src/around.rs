//! A condition of a loop that is more than gains and a delay at one bearing of a chain: filters, lags, samples, several bearings, shafts.
//!
//! The machine's matrices are linear in every gain, so they are put together once without any and once with each alone:
//! `A + sum g_k A_k`, `C + sum g_k C_k`. A sampled loop has its step in place of `A`, and `z` for roots. Where corners of filters are
//! searched the matrices are others for every value of them: they are put together anew, and those of the gains when slopes are
//! asked for.

use std::cell::OnceCell;

use nalgebra::{DMatrix, RowDVector};
use rotor::{C64, Characteristic, LinearForm, OperatingPoint, Plant};

use crate::corners::Weights;
use crate::{Problem, Structure, delay};

/// The machine at one condition.
#[derive(Clone, Debug)]
pub(crate) struct Around {
    plant: Plant,
    at: OperatingPoint,
    delay: f64,
    /// Where no corner is searched.
    fixed: Option<Matrices>,
}

/// A loop closed with some variables.
#[derive(Clone, Debug)]
pub(crate) struct Closed {
    pub(crate) characteristic: Characteristic,
    variables: Vec<f64>,
    /// Where corners are searched, once it was asked for.
    by: OnceCell<Vec<[DMatrix<C64>; 2]>>,
}

/// `A`, `B` and `C`, and what each gain adds to `A` and to `C`.
#[derive(Clone, Debug)]
struct Matrices {
    open: [DMatrix<C64>; 3],
    by: Vec<[DMatrix<C64>; 2]>,
    period: Option<f64>,
}

impl Matrices {
    /// With the corners of `variables`.
    fn of(structure: &Structure, variables: &[f64], around: &Around) -> Option<Self> {
        let with = |only: Option<usize>| {
            let feedback = structure.unit(variables, only, around.delay);
            let form = LinearForm::of(&around.plant, &feedback, &around.at).ok()?;
            match form.sampled() {
                Some(step) => Some(([step.a, DMatrix::zeros(0, 0), DMatrix::zeros(0, 0)], Some(step.period))),
                None => Some((form.continuous()?, None)),
            }
        };
        let (open, period) = with(None)?;
        let [a, _, c] = &open;
        let by = (0..structure.gains())
            .map(|k| with(Some(k)).map(|([with_a, _, with_c], _)| [with_a - a, with_c - c]))
            .collect::<Option<_>>()?;
        Some(Self { open, by, period })
    }
}

impl Around {
    /// At a condition of `problem`; `None` if the loop has nothing of the kind.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Option<Self> {
        let structure = &problem.structure;
        if structure.is_plain() {
            return None;
        }
        let (plant, at) = (problem.family.plant(point), problem.family.operating(point));
        let mut made = Self { plant, at, delay: problem.delay(point), fixed: None };
        if structure.corners().is_empty() {
            made.fixed = Some(Matrices::of(structure, &structure.own(), &made)?);
        }
        Some(made)
    }

    /// The loop closed with these variables.
    pub(crate) fn close(&self, structure: &Structure, variables: &[f64]) -> Option<Closed> {
        let characteristic = match &self.fixed {
            Some(Matrices { open: [a, b, c], by, period }) => {
                let (mut a, mut c) = (a.clone(), c.clone());
                for (gain, [by_a, by_c]) in structure.gains_at(variables, self.at.speed).iter().zip(by) {
                    let gain = C64::from(*gain);
                    a.zip_apply(by_a, |a, by| *a += by * gain);
                    c.zip_apply(by_c, |c, by| *c += by * gain);
                }
                // A sampled loop has its delay in its step.
                let delay = if period.is_some() { 0.0 } else { self.delay };
                Characteristic::new([a, b.clone(), c], delay, *period).ok()?
            }
            None => {
                let mut feedback = structure.feedback(variables);
                feedback.set_delay(self.delay);
                Characteristic::of(&LinearForm::of(&self.plant, &feedback, &self.at).ok()?).ok()?
            }
        };
        Some(Closed { characteristic, variables: variables.to_vec(), by: OnceCell::new() })
    }

    /// What `pole` of `closed` moves by with each gain at the speed, and behind them with each corner.
    pub(crate) fn slopes(&self, structure: &Structure, closed: &Closed, pole: C64) -> Vec<C64> {
        let count = structure.gains() + structure.corners().len();
        let Some(mut made) = self.by_gain(structure, closed, pole) else { return vec![C64::ZERO; count] };
        if !structure.corners().is_empty() {
            made.extend(Weights::of(structure, &closed.variables, self.at.speed).follow(pole, &made));
        }
        made
    }

    fn by_gain(&self, structure: &Structure, closed: &Closed, pole: C64) -> Option<Vec<C64>> {
        let by = match &self.fixed {
            Some(fixed) => &fixed.by,
            None => closed.by.get_or_init(|| {
                Matrices::of(structure, &closed.variables, self).map_or_else(Vec::new, |matrices| matrices.by)
            }),
        };
        let system = closed.characteristic.system();
        // s = ln(z) / h.
        let (root, per_root) = match structure.period() {
            period if period > 0.0 => {
                let z = (pole * period).exp();
                (z, (z * period).inv())
            }
            _ => (pole, C64::ONE),
        };
        let at = system.sensitivity(root)?;
        // At a defective pole the slope is infinite: large and finite keeps a search going.
        let give = if at.give.norm() < 1e-12 { C64::from(1e-12) } else { at.give };
        let late = (-root * system.delay()).exp();
        let b = system.b();
        let through = if b.is_empty() { RowDVector::zeros(0) } else { at.left.transpose() * b * late };
        let of = |[by_a, by_c]: &[DMatrix<C64>; 2]| {
            let moved = at.left.dot(&(by_a * &at.right));
            let fed_back = if b.is_empty() { C64::ZERO } else { (&through * (by_c * &at.right))[0] };
            (moved + fed_back) / give * per_root
        };
        Some(by.iter().map(of).collect()).filter(|made: &Vec<C64>| made.len() == structure.gains())
    }
}

/// Every pole of `closed` that counts, and with a delay the line right of which they were counted; `near` may be near them.
pub(crate) fn poles(closed: &Characteristic, near: &[C64]) -> Option<(Vec<C64>, Option<f64>)> {
    let (roots, line) = if closed.system().delay() > 0.0 {
        let found = delay::poles(closed.system(), near).ok()?;
        (found.roots, Some(found.right_of))
    } else {
        (closed.system().roots_right_of(f64::NEG_INFINITY).ok()?.roots, None)
    };
    let poles: Vec<C64> = closed.told(roots).into_iter().map(|root| root.pole).collect();
    (!poles.is_empty()).then_some((poles, line))
}

/// The same for the gains `variables` at one condition, if the loop has anything of the kind.
pub(crate) fn poles_of(problem: &Problem, variables: &[f64], point: &[f64]) -> Option<(Vec<C64>, Option<f64>)> {
    let mut feedback = problem.structure.feedback(variables);
    feedback.set_delay(problem.delay(point));
    let (plant, at) = (problem.family.plant(point), problem.family.operating(point));
    let form = LinearForm::of(&plant, &feedback, &at).ok()?;
    poles(&Characteristic::of(&form).ok()?, &[])
}
