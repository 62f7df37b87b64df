//! A condition of a loop that is more than gains and a delay at one bearing of a chain: filters, lags, samples, several bearings, shafts.
//!
//! The machine's matrices are linear in every gain, so they are put together once without any and once with each alone:
//! `A + sum g_k A_k`, `C + sum g_k C_k`. A sampled loop has its step in place of `A`, and `z` for roots.

use nalgebra::{DMatrix, RowDVector};
use rotor::{C64, Characteristic, LinearForm};

use crate::{Problem, delay};

/// The matrices at one condition.
#[derive(Clone, Debug)]
pub(crate) struct Around {
    a: DMatrix<C64>,
    b: DMatrix<C64>,
    c: DMatrix<C64>,
    /// What each gain adds to `A` and to `C`.
    by: Vec<[DMatrix<C64>; 2]>,
    delay: f64,
    period: Option<f64>,
}

/// What the poles of a loop are taken from.
type Matrices = ([DMatrix<C64>; 3], Option<f64>);

fn matrices(form: &LinearForm) -> Option<Matrices> {
    if let Some(step) = form.sampled() {
        return Some(([step.a, DMatrix::zeros(0, 0), DMatrix::zeros(0, 0)], Some(step.period)));
    }
    Some((form.continuous()?, None))
}

impl Around {
    /// At a condition of `problem`; `None` if the loop has nothing of the kind.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Option<Self> {
        let structure = &problem.structure;
        if structure.is_plain() {
            return None;
        }
        let (plant, at) = (problem.family.plant(point), problem.family.operating(point));
        let delay = problem.delay(point);
        let with = |only: Option<usize>| matrices(&LinearForm::of(&plant, &structure.unit(only, delay), &at).ok()?);
        let ([a, b, c], period) = with(None)?;
        let by = (0..structure.gains())
            .map(|k| with(Some(k)).map(|([with_a, _, with_c], _)| [with_a - &a, with_c - &c]))
            .collect::<Option<_>>()?;
        // A sampled loop has its delay in its step.
        let delay = if period.is_some() { 0.0 } else { delay };
        Some(Self { a, b, c, by, delay, period })
    }

    /// The loop closed with these gains.
    pub(crate) fn close(&self, gains: &[f64]) -> Option<Characteristic> {
        let (mut a, mut c) = (self.a.clone(), self.c.clone());
        for (gain, [by_a, by_c]) in gains.iter().zip(&self.by) {
            let gain = C64::from(*gain);
            a.zip_apply(by_a, |a, by| *a += by * gain);
            c.zip_apply(by_c, |c, by| *c += by * gain);
        }
        Characteristic::new([a, self.b.clone(), c], self.delay, self.period).ok()
    }

    /// What `pole` of `closed` moves by with each gain, into `out`.
    pub(crate) fn slopes(&self, closed: &Characteristic, pole: C64, out: &mut [C64]) {
        out.fill(C64::ZERO);
        // s = ln(z) / h.
        let (root, per_root) = match self.period {
            Some(period) => {
                let z = (pole * period).exp();
                (z, (z * period).inv())
            }
            None => (pole, C64::ONE),
        };
        let Some(at) = closed.system().sensitivity(root) else { return };
        // At a defective pole the slope is infinite: large and finite keeps a search going.
        let give = if at.give.norm() < 1e-12 { C64::from(1e-12) } else { at.give };
        let late = (-root * self.delay).exp();
        let through = if self.b.is_empty() { RowDVector::zeros(0) } else { at.left.transpose() * &self.b * late };
        for (out, [by_a, by_c]) in out.iter_mut().zip(&self.by) {
            let moved = at.left.dot(&(by_a * &at.right));
            let fed_back = if self.b.is_empty() { C64::ZERO } else { (&through * (by_c * &at.right))[0] };
            *out = (moved + fed_back) / give * per_root;
        }
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
